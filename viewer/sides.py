"""The picture of each side, kept until something it depends on changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .color_scale import ColorScale
from .exact_layer import ExactLayer
from .line_layer import DepthPicture
from .line_overlays import LineOverlays
from .mesh_layer import FaceColors, MeshLayer
from .overlays import EXACT_LINES, LINE_STYLES, shading_of
from .projection import Projection, pixel_size, project
from .targets import SAMPLES, ColorTarget, SurfaceTarget

Size = tuple[int, int]


@dataclass(frozen=True)
class SidePicture:
    """Textures, linear RGBA with premultiplied alpha: the surfaces, and the lines over them (row 0 at the bottom).

    top_first: the surfaces' row 0 is the picture's top.
    """

    surfaces: moderngl.Texture
    top_first: bool
    lines: moderngl.Texture


class Palette:
    """What both sides colour surfaces with: the faces' colours and the ramp of the curvature scale."""

    def __init__(self, context: moderngl.Context, colors: NDArray[np.float32], scale: ColorScale | None) -> None:
        self.faces = FaceColors(context, colors)
        self.end = scale.high if scale else 1.0
        self.ramp = ramp_texture(context, scale)

    def release(self) -> None:
        self.faces.release()
        self.ramp.release()


def ramp_texture(context: moderngl.Context, scale: ColorScale | None) -> moderngl.Texture:
    """The colours of a scale, from low to high; one gray texel without a scale."""
    colors = scale.ramp() if scale else np.full((1, 3), 0.5, np.float32)
    texture = context.texture((len(colors), 1), 3, np.ascontiguousarray(colors, np.float32), dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    return texture


class _Lines:
    """The picture of a side's lines."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._overlays = overlays
        self._none = context.texture((1, 1), 4, np.zeros(4, np.float32), dtype="f4")
        self._target: ColorTarget | None = None

    def draw(
        self, names: list[str], camera: nofacet.Camera, size: Size, surface: DepthPicture, off_surface: float
    ) -> moderngl.Texture:
        """Draw the overlays named. off_surface: how far what hides them may be off the surface, model units."""
        if not names:
            return self._none
        if self._target is None or self._target.size != size:
            self.release_target()
            self._target = ColorTarget(self._context, size)
        self._target.begin()
        for name in names:
            layer = self._overlays.layer(name, _smallest_pixel(camera, size))
            if layer is None or not layer.count:
                continue
            projection = project(camera, size, layer.center, layer.bounds)
            slack = pixel_size(camera, size, max(projection.depth_range[0], 0.0)) / 2 + off_surface
            layer.draw(projection, size, LINE_STYLES[name], surface, slack)
        self._target.finish()
        return self._target.texture

    def release_target(self) -> None:
        if self._target:
            self._target.release()
        self._target = None

    def release(self) -> None:
        self.release_target()
        self._none.release()


def _smallest_pixel(camera: nofacet.Camera, size: Size) -> float:
    """Size of a pixel at a tenth of the way to the focal point: what is nearer is seldom looked at."""
    return pixel_size(camera, size, 0.1 * float(np.linalg.norm(np.subtract(camera.focal_point, camera.position))))


class ExactSide:
    """The exact frame and the lines over it."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._lines = _Lines(context, overlays)
        self.layer: ExactLayer | None = None
        self._recolored: moderngl.Texture | None = None
        self._recolored_key: Any = None

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
        shown = [name for name in EXACT_LINES if name in names and layer.depth]
        surface = DepthPicture(layer.depth or layer.color, top_first=True)
        return SidePicture(surfaces, True, self._lines.draw(shown, layer.frame.camera, size, surface, 0.0))

    def release(self) -> None:
        self.set_frame(None, None)
        self._lines.release()
        if self._recolored:
            self._recolored.release()

    def _recolor(self, layer: ExactLayer, shading: str, palette: Palette) -> moderngl.Texture:
        key = shading, palette
        if self._recolored is None or self._recolored_key != key:
            if self._recolored:
                self._recolored.release()
            self._recolored = layer.recolored(palette.faces, shading, palette.ramp, palette.end)
            self._recolored.repeat_x = self._recolored.repeat_y = False
            self._recolored_key = key
        return self._recolored


class DrawnSide:
    """OpenCascade's triangles and the lines over them."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._overlays = overlays
        self._lines = _Lines(context, overlays)
        self.layer: MeshLayer | None = None
        self._color: ColorTarget | None = None
        self._surface: SurfaceTarget | None = None
        self._drawn_key: Any = None

    def set_mesh(self, mesh: nofacet.Mesh | None) -> None:
        if self.layer:
            self.layer.release()
        self.layer = None if mesh is None else MeshLayer(self._context, mesh)
        self._drawn_key = None

    def picture(
        self, camera: nofacet.Camera, size: Size, names: frozenset[str], palette: Palette
    ) -> SidePicture | None:
        """The side as the camera sees it, None without a mesh."""
        if self.layer is None:
            return None
        key = camera, size, shading_of(names), palette
        if self._color is None or self._drawn_key != key:
            self._color = self._draw(self.layer.projection(camera, size), size, shading_of(names), palette)
            self._drawn_key = key
        shown = [name for name in LINE_STYLES if name in names]
        lines = self._lines.draw([], camera, size, DepthPicture(self._color.texture, False), 0.0)
        if shown:
            depth = DepthPicture(self.surface(camera, size, palette).depth, top_first=False)
            lines = self._lines.draw(shown, camera, size, depth, self.layer.mesh.deflection)
        return SidePicture(self._color.texture, False, lines)

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
        for target in (self._color, self._surface):
            if target:
                target.release()

    def _draw(self, projection: Projection, size: Size, shading: str, palette: Palette) -> ColorTarget:
        assert self.layer
        target = self._color
        if target is None or target.size != size:
            if target:
                target.release()
            target = ColorTarget(self._context, size, SAMPLES)
        target.begin()
        self.layer.draw(projection, palette.faces, shading, palette.ramp, palette.end)
        target.finish()
        return target
