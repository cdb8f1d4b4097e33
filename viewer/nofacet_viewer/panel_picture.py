"""What imgui has drawn, kept as a picture: blending its windows and text anew takes longer than the rest of a frame."""

from __future__ import annotations

from typing import Any

import moderngl
from imgui_bundle import imgui

from .programs import bind, program, set_uniforms
from .targets import picture_texture

BACKGROUNDS = imgui.Col_.window_bg, imgui.Col_.popup_bg, imgui.Col_.title_bg_collapsed
Box = tuple[int, int, int, int]  # left, bottom, width and height in pixels


class PanelPicture:
    """imgui's windows, opaque rectangles, copied before any number of pictures.

    What imgui draws elsewhere, over the picture, cannot be kept: then all of it is drawn each time.
    """

    def __init__(self, context: moderngl.Context, renderer: Any) -> None:
        """renderer: imgui's back end for OpenGL. Makes windows opaque in the present context of imgui."""
        style = imgui.get_style()
        for background in BACKGROUNDS:
            color = style.color_(background)
            style.set_color_(background, imgui.ImVec4(color.x, color.y, color.z, 1.0))
        self._context = context
        self._renderer = renderer
        self._show = program(context, "show.vert", "show.frag")
        self._corners = context.vertex_array(self._show, [])
        self._texture: moderngl.Texture | None = None
        self._target: moderngl.Framebuffer | None = None
        self._boxes: list[Box] = []  # of the windows
        self._kept = False

    def update(self, size: tuple[int, int]) -> None:
        """Take over what imgui.render() has made, for pictures of this size in pixels."""
        self._boxes, self._kept = _window_boxes(size), not _beside_windows()
        if not self._kept:
            return
        if self._target is None or self._target.size != size:
            self.release()
            self._texture = picture_texture(self._context, size)
            self._texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._target = self._context.framebuffer([self._texture])
        self._target.use()
        self._renderer.render(imgui.get_draw_data())

    def draw(self, framebuffer: moderngl.Framebuffer) -> None:
        """Before what is in the framebuffer's lower left corner, as large as update() was told."""
        framebuffer.use()
        if self._texture is None or not self._kept:
            self._renderer.render(imgui.get_draw_data())
            return
        set_uniforms(self._show, top_first=False)
        bind(self._show, picture=self._texture)
        self._context.enable_only(moderngl.NOTHING)
        framebuffer.viewport = 0, 0, *self._texture.size
        for box in self._boxes:
            framebuffer.scissor = box
            self._corners.render(moderngl.TRIANGLES, vertices=6)
        framebuffer.scissor = None

    def release(self) -> None:
        """Free what is on the graphics card."""
        if self._texture and self._target:
            self._target.release()
            self._texture.release()
        self._texture = self._target = None


def _beside_windows() -> bool:
    viewport = imgui.get_main_viewport()
    lists = imgui.get_background_draw_list(viewport), imgui.get_foreground_draw_list(viewport)
    return any(drawn.vtx_buffer.size() for drawn in lists)


def _window_boxes(size: tuple[int, int]) -> list[Box]:
    """Where imgui's windows show, in a picture of `size` pixels."""
    scale, (width, height) = imgui.get_io().display_framebuffer_scale, size
    boxes = []
    for window in imgui.get_current_context().windows:
        if not window.active or window.hidden or window.flags & imgui.WindowFlags_.child_window.value:
            continue
        rect = window.rect()
        left, right = (min(max(round(x * scale[0]), 0), width) for x in (rect.min.x, rect.max.x))
        top, bottom = (min(max(round(y * scale[1]), 0), height) for y in (rect.min.y, rect.max.y))
        boxes.append((left, height - bottom, right - left, bottom - top))
    return boxes
