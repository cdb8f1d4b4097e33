"""The picture of a side's lines: each overlay of them over the one before."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

import nofacet

from .line_layer import DepthPicture
from .line_overlays import LineOverlays
from .overlays import EXACT_LINES, LINE_STYLES
from .programs import bind, program
from .projection import pixel_size, project
from .targets import ColorTarget

Size = tuple[int, int]


class SideLines:
    """Lines that overlap within an overlay count once; so each is drawn alone and then put over the others."""

    def __init__(self, context: moderngl.Context, overlays: LineOverlays) -> None:
        self._context = context
        self._overlays = overlays
        self._copy = program(context, "fullscreen.vert", "copy.frag")
        self._copied = context.vertex_array(self._copy, [])
        self._targets: tuple[ColorTarget, ColorTarget] | None = None
        self._drawn_key: Any = None  # what the lines that are drawn depend on

    def draw(
        self, names: list[str], camera: nofacet.Camera, size: Size, surface: DepthPicture, off_surface: float
    ) -> moderngl.Texture:
        """Linear RGBA with premultiplied alpha, row 0 at the bottom. off_surface: how far what hides the lines may be
        off the exact surfaces, model units; the mesh's own lines lie on its triangles."""
        layers = {name: self._overlays.layer(name, _smallest_pixel(camera, size)) for name in names}
        one, whole = self._sized(size)
        key = layers, camera, size, surface, off_surface
        if key == self._drawn_key:
            return whole.texture
        self._drawn_key = key
        whole.begin()
        for name, layer in layers.items():
            if layer is None or not layer.count:
                continue
            projection = project(camera, size, layer.center, layer.bounds)
            slack = pixel_size(camera, size, max(projection.depth_range[0], 0.0)) / 2
            slack += off_surface if name in EXACT_LINES else 0.0
            one.begin()
            layer.draw(projection, size, LINE_STYLES[name], surface, slack)
            whole.use()
            self._context.enable_only(moderngl.BLEND)
            self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
            bind(self._copy, picture=one.texture)
            self._copied.render(moderngl.TRIANGLES, vertices=6)
        return whole.texture

    def release(self) -> None:
        for held in (*(self._targets or ()), self._copied):
            held.release()

    def _sized(self, size: Size) -> tuple[ColorTarget, ColorTarget]:
        if self._targets is None or self._targets[0].size != size:
            for target in self._targets or ():
                target.release()
            self._targets = ColorTarget(self._context, size), ColorTarget(self._context, size)
        return self._targets


def _smallest_pixel(camera: nofacet.Camera, size: Size) -> float:
    """Size of a pixel at a tenth of the way to the focal point: what is nearer is seldom looked at."""
    return pixel_size(camera, size, 0.1 * float(np.linalg.norm(np.subtract(camera.focal_point, camera.position))))
