"""The picture of each side, kept until something it depends on changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .exact_layer import ExactLayer, recoloring
from .line_layer import DepthPicture
from .line_overlays import LineOverlays
from .mesh_arrays import MeshArrays
from .mesh_layer import MeshLayer
from .mesh_picture import MeshPicture
from .overlays import EXACT_LINES, LINE_STYLES, shading_of
from .palette import Palette
from .side_lines import SideLines
from .srgb import RGB
from .targets import SurfaceTarget

Size = tuple[int, int]


@dataclass(frozen=True)
class SidePicture:
    """What a side shows, as textures.

    surfaces: before the background, 8-bit sRGB. top_first: their row 0 is the picture's top.
    lines: what is to be drawn over them, linear RGBA with premultiplied alpha, row 0 at the bottom; None: nothing.
    face, marks: the surfaces' faces and what is still to be mixed into their pictures; None: nothing.
    """

    surfaces: moderngl.Texture
    top_first: bool
    lines: moderngl.Texture | None = None
    face: moderngl.Texture | None = None
    marks: moderngl.Texture | None = None


class ExactSide:
    """The exact frame and the lines over it."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._lines = SideLines(context, overlays)
        self.layer: ExactLayer | None = None
        self._recolored: moderngl.Texture | None = None
        self._recolored_key: Any = None
        self._shaders: dict[str, moderngl.VertexArray] = {}

    def set_frame(
        self,
        frame: nofacet.Frame | None,
        curvature: NDArray[np.float32] | None = None,
        pixels: NDArray[np.uint8] | None = None,
    ) -> None:
        """As ExactLayer takes them."""
        if self.layer:
            self.layer.release()
        self.layer = None if frame is None else ExactLayer(self._context, frame, curvature, pixels)
        self._recolored_key = None

    def picture(
        self, size: Size, names: frozenset[str], palette: Palette, background: RGB, recolor: bool
    ) -> SidePicture | None:
        """The side as its frame's camera sees it, None without a frame. recolor: not in the frame's own colours."""
        layer = self.layer
        if layer is None:
            return None
        shading = shading_of(names)
        if recolor and layer.can_shade(shading):
            surfaces = self._recolor(layer, shading, palette, background)
        else:
            surfaces = layer.picture(background)
        exact = layer.frame.resolution == size
        surfaces.filter = (moderngl.NEAREST, moderngl.NEAREST) if exact else (moderngl.LINEAR, moderngl.LINEAR)
        shown = [name for name in EXACT_LINES if name in names]
        depth, lines = layer.values("depth") if shown else None, None
        if depth:
            lines = self._lines.draw(shown, layer.frame.camera, size, DepthPicture(depth, top_first=True), 0.0)
        if not palette.has_marks:
            return SidePicture(surfaces, True, lines)
        return SidePicture(surfaces, True, lines, layer.values("face"), palette.marks.texture)

    def release(self) -> None:
        self.set_frame(None)
        self._lines.release()
        if self._recolored:
            self._recolored.release()
        for shader in self._shaders.values():
            shader.release()

    def _recolor(self, layer: ExactLayer, shading: str, palette: Palette, background: RGB) -> moderngl.Texture:
        key = shading, palette, background
        if self._recolored is None or self._recolored_key != key:
            if self._recolored:
                self._recolored.release()
            if shading not in self._shaders:
                self._shaders[shading] = recoloring(self._context, shading)
            self._recolored = layer.recolored(self._shaders[shading], palette, background)
            self._recolored_key = key
        return self._recolored


class DrawnSide:
    """OpenCascade's triangles and the lines over them."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._lines = SideLines(context, overlays)
        self._picture = MeshPicture(context)
        self.layer: MeshLayer | None = None
        self._surface: SurfaceTarget | None = None
        self._picture_key: Any = None  # what the pictures depend on, while there are any
        self._surface_key: Any = None
        self._sections: tuple[nofacet.Section, ...] = ()

    def forget(self) -> None:
        """What was drawn is not valid any more."""
        self._picture_key = self._surface_key = None

    @property
    def busy(self) -> bool:
        """Whether refine() has something to do."""
        return self._picture_key is not None and not self._picture.refined

    def set_mesh(self, mesh: nofacet.Mesh | None, arrays: MeshArrays | None = None) -> None:
        """As MeshLayer takes them."""
        if self.layer:
            self.layer.release()
        self.layer = None if mesh is None else MeshLayer(self._context, mesh, arrays)
        self.forget()
        self.cut(self._sections)

    def cut(self, sections: Sequence[nofacet.Section]) -> None:
        """Leave out what lies beyond these planes."""
        self._sections = tuple(sections)
        if self.layer:
            self.layer.sections = self._sections

    def picture(
        self, camera: nofacet.Camera, size: Size, names: frozenset[str], palette: Palette, background: RGB
    ) -> SidePicture | None:
        """The side as the camera sees it, None without a mesh. A picture unlike the one before is drawn fast; refine()
        makes it finer."""
        layer, shading = self.layer, shading_of(names)
        if layer is None:
            return None
        key = camera, size, shading, palette, self._sections, background
        if self._picture_key != key:
            self._picture_key = key

            def draw(resolution: Size) -> None:
                layer.draw(layer.projection(camera, resolution), palette, shading)

            self._picture.begin(draw, size, background)
        shown = [name for name in LINE_STYLES if name in names]
        lines = None
        if shown:
            surface = self.surface(camera, size, palette)
            depth = DepthPicture(surface.depth, top_first=False, shows=self._surface_key)
            lines = self._lines.draw(shown, camera, size, depth, layer.mesh.deflection)
        return SidePicture(self._picture.texture, False, lines)

    def refine(self, seconds: float | None = None) -> bool:
        """Go on with the picture that was asked for last, for a few milliseconds or so many seconds; whether it is
        another one now."""
        return self.busy and (self._picture.refine() if seconds is None else self._picture.refine(seconds))

    def surface(self, camera: nofacet.Camera, size: Size, palette: Palette) -> SurfaceTarget:
        """Depth and face at the pixel centres. Needs a mesh."""
        assert self.layer
        if self._surface is None or self._surface.size != size:
            if self._surface:
                self._surface.release()
            self._surface, self._surface_key = SurfaceTarget(self._context, size), None
        key = camera, palette, self._sections
        if self._surface_key != key:
            self._surface_key = key
            self.layer.draw_surface(self.layer.projection(camera, size), palette, self._surface)
        return self._surface

    def release(self) -> None:
        self.set_mesh(None)
        self._lines.release()
        self._picture.release()
        if self._surface:
            self._surface.release()
