"""The picture of each side, kept until something it depends on changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .color_scale import ColorScale
from .exact_layer import ExactLayer, recoloring
from .line_layer import DepthPicture
from .line_overlays import LineOverlays
from .mesh_layer import FaceColors, MeshLayer
from .overlays import EXACT_LINES, LINE_STYLES, shading_of
from .projection import Projection
from .side_lines import SideLines
from .targets import SAMPLES, ColorTarget, SurfaceTarget

Size = tuple[int, int]

MARK = (1.0, 0.27, 0.0, 0.55)  # of what is selected: linear RGB, and how much of it is mixed in


@dataclass(frozen=True)
class SidePicture:
    """Textures, linear RGBA with premultiplied alpha: the surfaces, and the lines over them (row 0 at the bottom).

    top_first: the surfaces' row 0 is the picture's top.
    face, marks: the surfaces' faces and what is still to be mixed into their pictures; None: nothing.
    """

    surfaces: moderngl.Texture
    top_first: bool
    lines: moderngl.Texture
    face: moderngl.Texture | None = None
    marks: moderngl.Texture | None = None


class Palette:
    """What both sides colour surfaces with: the faces' colours and the ramp of the curvature scale; and what marks the
    faces that are selected (F,)."""

    def __init__(
        self,
        context: moderngl.Context,
        colors: NDArray[np.float32],
        scale: ColorScale | None,
        selected: NDArray[np.bool_],
    ) -> None:
        self.faces = FaceColors(context, colors)
        self.marks = FaceColors(context, np.where(selected[:, None], np.array(MARK, np.float32), np.float32(0)))
        self.has_marks = bool(selected.any())
        self.end = scale.high if scale else 1.0
        self.ramp = ramp_texture(context, scale)

    def release(self) -> None:
        self.faces.release()
        self.marks.release()
        self.ramp.release()


def ramp_texture(context: moderngl.Context, scale: ColorScale | None) -> moderngl.Texture:
    """The colours of a scale, from low to high; one gray texel without a scale."""
    colors = scale.ramp() if scale else np.full((1, 3), 0.5, np.float32)
    texture = context.texture((len(colors), 1), 3, np.ascontiguousarray(colors, np.float32), dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    return texture


class ExactSide:
    """The exact frame and the lines over it."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._lines = SideLines(context, overlays)
        self.layer: ExactLayer | None = None
        self._recolored: moderngl.Texture | None = None
        self._recolored_key: Any = None
        self._shaders: dict[str, moderngl.VertexArray] = {}

    def set_frame(self, frame: nofacet.Frame | None, curvature: NDArray[np.float32] | None) -> None:
        if self.layer:
            self.layer.release()
        self.layer = None if frame is None else ExactLayer(self._context, frame, curvature)
        self._recolored_key = None

    def picture(self, size: Size, names: frozenset[str], palette: Palette, recolor: bool) -> SidePicture | None:
        """The side as its frame's camera sees it, None without a frame. recolor: not in the frame's own colours."""
        layer = self.layer
        if layer is None:
            return None
        surfaces = layer.color
        shading = shading_of(names)
        if recolor and layer.can_shade(shading):
            surfaces = self._recolor(layer, shading, palette)
        exact = layer.frame.resolution == size
        surfaces.filter = (moderngl.NEAREST, moderngl.NEAREST) if exact else (moderngl.LINEAR, moderngl.LINEAR)
        shown = [name for name in EXACT_LINES if name in names]
        lines = self._lines.none
        if shown and layer.depth:
            lines = self._lines.draw(shown, layer.frame.camera, size, DepthPicture(layer.depth, top_first=True), 0.0)
        if not palette.has_marks:
            return SidePicture(surfaces, True, lines)
        return SidePicture(surfaces, True, lines, layer.face, palette.marks.texture)

    def release(self) -> None:
        self.set_frame(None, None)
        self._lines.release()
        if self._recolored:
            self._recolored.release()
        for shader in self._shaders.values():
            shader.program.release()
            shader.release()

    def _recolor(self, layer: ExactLayer, shading: str, palette: Palette) -> moderngl.Texture:
        key = shading, palette
        if self._recolored is None or self._recolored_key != key:
            if self._recolored:
                self._recolored.release()
            if shading not in self._shaders:
                self._shaders[shading] = recoloring(self._context, shading)
            self._recolored = layer.recolored(self._shaders[shading], palette.faces, palette.ramp, palette.end)
            self._recolored.repeat_x = self._recolored.repeat_y = False
            self._recolored_key = key
        return self._recolored


class DrawnSide:
    """OpenCascade's triangles and the lines over them."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._overlays = overlays
        self._lines = SideLines(context, overlays)
        self.layer: MeshLayer | None = None
        self._colors: dict[int, ColorTarget] = {}  # by samples a pixel
        self._surface: SurfaceTarget | None = None
        self._drawn_key: Any = None
        self._refined = True
        self._sections: tuple[nofacet.Section, ...] = ()

    @property
    def busy(self) -> bool:
        """Whether the next picture, of the same camera, is better than the last."""
        return self.layer is not None and not self._refined

    def set_mesh(self, mesh: nofacet.Mesh | None) -> None:
        if self.layer:
            self.layer.release()
        self.layer = None if mesh is None else MeshLayer(self._context, mesh)
        self._drawn_key = None
        self.cut(self._sections)

    def cut(self, sections: Sequence[nofacet.Section]) -> None:
        """Leave out what lies beyond these planes."""
        self._sections = tuple(sections)
        if self.layer:
            self.layer.sections = self._sections

    def picture(
        self, camera: nofacet.Camera, size: Size, names: frozenset[str], palette: Palette
    ) -> SidePicture | None:
        """The side as the camera sees it, None without a mesh. A picture unlike the one before is drawn fast,
        with one sample a pixel; asked for once more, it is drawn with SAMPLES."""
        if self.layer is None:
            return None
        key = camera, size, shading_of(names), palette, self._sections
        samples = SAMPLES if self._drawn_key == key else 0
        if not (samples and self._refined):
            self._draw(self.layer.projection(camera, size), size, shading_of(names), palette, samples)
        self._drawn_key, self._refined = key, bool(samples)
        color = self._colors[samples].texture
        shown = [name for name in LINE_STYLES if name in names]
        lines = self._lines.none
        if shown:
            depth = DepthPicture(self.surface(camera, size, palette).depth, top_first=False)
            lines = self._lines.draw(shown, camera, size, depth, self.layer.mesh.deflection)
        return SidePicture(color, False, lines)

    def surface(self, camera: nofacet.Camera, size: Size, palette: Palette) -> SurfaceTarget:
        """Depth and face at the pixel centres. Needs a mesh."""
        assert self.layer
        if self._surface is None or self._surface.size != size:
            if self._surface:
                self._surface.release()
            self._surface = SurfaceTarget(self._context, size)
        self.layer.draw_surface(self.layer.projection(camera, size), palette.faces, self._surface)
        return self._surface

    def release(self) -> None:
        self.set_mesh(None)
        self._lines.release()
        for target in (*self._colors.values(), self._surface):
            if target:
                target.release()

    def _draw(self, projection: Projection, size: Size, shading: str, palette: Palette, samples: int) -> None:
        assert self.layer
        target = self._colors.get(samples)
        if target is None or target.size != size:
            if target:
                target.release()
            target = self._colors[samples] = ColorTarget(self._context, size, samples)
        target.begin()
        self.layer.draw(projection, palette.faces, palette.marks, shading, palette.ramp, palette.end)
        target.finish()
