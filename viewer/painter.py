"""Placeholder until the painter is merged: shows the exact frame over the whole window."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

import nofacet

from .panes import pane_resolution
from .state import View, ViewState

OVERLAYS = ("mesh-edges", "edges", "patch-borders", "control-nets", "conversion-error", "zebra", "curvature")

VERTICES = """
#version 330
out vec2 place;
void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(place * 2.0 - 1.0, 0.0, 1.0);
}
"""
FRAGMENTS = """
#version 330
uniform sampler2D picture;
uniform vec3 background;
uniform vec2 shown;  // from, to: the part of the width that shows the frame
in vec2 place;
out vec4 color;
void main() {
    vec4 exact = texture(picture, vec2((place.x - shown.x) / (shown.y - shown.x), 1.0 - place.y));
    vec3 linear = exact.rgb + (1.0 - exact.a) * background;
    if (place.x > shown.y) linear = vec3(0.5);
    color = vec4(mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThan(linear, vec3(0.0031308))), 1.0);
}
"""


class Painter:
    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._program = context.program(VERTICES, FRAGMENTS)
        self._array = context.vertex_array(self._program, [])
        self._texture: Any = None

    def set_model(self, model: nofacet.Model | None) -> None: ...

    def set_mesh(self, mesh: Any) -> None: ...

    def set_exact(self, frame: nofacet.Frame | None) -> None:
        if self._texture:
            self._texture.release()
        self._texture = frame and self._context.texture(frame.resolution, 4, np.ascontiguousarray(frame.color), dtype="f4")
        if self._texture:
            self._texture.repeat_x = self._texture.repeat_y = False

    def exact_resolution(self, view: View, size: tuple[int, int]) -> tuple[int, int] | None:
        return pane_resolution(view, size) if view.shows_exact else None

    def exact_buffers(self, state: ViewState) -> tuple[str, ...]:
        return ("color",)

    def paint(
        self, state: ViewState, camera: nofacet.Camera, framebuffer: moderngl.Framebuffer, size: tuple[int, int]
    ) -> None:
        framebuffer.use()
        framebuffer.clear(1.0, 1.0, 1.0, 1.0)
        if self._texture is None or not state.view.shows_exact:
            return
        self._program["background"] = state.background
        end = 0.5 if state.view is View.SIDE_BY_SIDE else 1.0
        self._program["shown"] = (0.0, end)
        self._context.enable_only(moderngl.NOTHING)
        self._texture.use(0)
        self._array.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        self.set_exact(None)
