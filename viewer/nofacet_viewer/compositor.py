"""The last step: sides to pixels of the window, in sRGB."""

from __future__ import annotations

import moderngl
import numpy as np

from .color_scale import ColorScale
from .palette import ramp_texture
from .panes import Pane
from .programs import bind, program, set_uniforms
from .sides import SidePicture
from .srgb import RGB
from .targets import SurfaceTarget


class Compositor:
    """Draws pictures into panes of the framebuffer in use."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._show = program(context, "show.vert", "show.frag")
        self._compose = program(context, "fullscreen.vert", "compose.frag")
        self._difference = program(context, "fullscreen.vert", "difference.frag")
        programs = self._show, self._compose, self._difference
        self._arrays = {target: context.vertex_array(target, []) for target in programs}
        self._no_face = context.texture((1, 1), 1, np.full(1, -1, np.int32), dtype="i4")
        self._no_error = context.texture((1, 1), 2, np.zeros(2, np.float32), dtype="f4")
        self._nothing = context.texture((1, 1), 4, np.zeros(4, np.float32), dtype="f4")
        self._no_face.filter = moderngl.NEAREST, moderngl.NEAREST

    def draw(self, picture: SidePicture, pane: Pane) -> None:
        """A side's picture; the framebuffer's scissor says which part of the pane."""
        if picture.lines is None and picture.marks is None:
            set_uniforms(self._show, top_first=picture.top_first)
            bind(self._show, picture=picture.surfaces)
            self._fill(self._show, pane)
            return
        has_marks = picture.face is not None and picture.marks is not None
        set_uniforms(self._compose, top_first=picture.top_first, has_marks=has_marks)
        bind(
            self._compose,
            picture=picture.surfaces,
            lines=picture.lines or self._nothing,
            frame_face=picture.face or self._no_face,
            face_marks=picture.marks or self._nothing,
        )
        self._fill(self._compose, pane)

    def draw_difference(
        self,
        exact: SidePicture,
        frame_face: moderngl.Texture | None,
        drawn: SurfaceTarget | None,
        error: moderngl.Texture | None,
        scale: ColorScale,
        pane: Pane,
        background: RGB,
    ) -> None:
        """The signed outline error `error` over the exact side in pale gray. Where both faces are given, pixels whose
        centres show different ones are tinted."""
        ramp = ramp_texture(self._context, scale)
        set_uniforms(
            self._difference,
            background=background,
            ramp_end=scale.high,
            has_face=frame_face is not None and drawn is not None,
        )
        bind(
            self._difference,
            picture=exact.surfaces,
            error=error or self._no_error,
            ramp=ramp,
            frame_face=frame_face or self._no_face,
            drawn_face=drawn.face if drawn else self._no_face,
        )
        self._fill(self._difference, pane)
        ramp.release()

    def release(self) -> None:
        for held in (*self._arrays.values(), self._no_face, self._no_error, self._nothing):
            held.release()

    def _fill(self, target: moderngl.Program, pane: Pane) -> None:
        self._context.enable_only(moderngl.NOTHING)
        self._context.fbo.viewport = pane.x, 0, pane.width, pane.height
        self._arrays[target].render(moderngl.TRIANGLES, vertices=6)
