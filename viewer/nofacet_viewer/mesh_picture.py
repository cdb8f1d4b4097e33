"""The picture of the triangles: at once in motion, as fine as can be at rest.

In motion it has one sample a pixel and the resolution at which drawing it leaves the window its rate; at rest it is
drawn again strip by strip, with SAMPLES a pixel: so the window never waits long, even where a processor draws.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import moderngl

from .programs import bind, program, set_uniforms
from .scale import SMALLEST, AdaptiveScale, scaled
from .srgb import RGB
from .targets import SAMPLES, ColorTarget, picture_texture

Size = tuple[int, int]
Draw = Callable[[Size], None]  # draws a picture of that size into the viewport of the framebuffer in use, linear

MOTION_SECONDS = 0.012  # for a picture in motion: less than half of a frame's time, the rest is for the exact side
STRIP_ROWS = (16, 256)  # the least and the most at a time
TURN_SECONDS = 0.012  # for a strip, and after which refine() leaves the rest to the next call


class MeshPicture:
    """Keeps what was drawn until begin() is called for another picture."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._encode = program(context, "fullscreen.vert", "encode.frag")
        self._encoded = context.vertex_array(self._encode, [])
        self._scale = AdaptiveScale(MOTION_SECONDS, MOTION_SECONDS, SMALLEST)
        self._linear: dict[int, ColorTarget] = {}  # by samples a pixel
        self._finished: dict[int, moderngl.Framebuffer] = {}  # the same, sRGB
        self._draw: Draw | None = None
        self._size: Size = (0, 0)
        self._background: RGB = (1.0, 1.0, 1.0)
        self._rows = STRIP_ROWS[0]  # of the next strip
        self._row = 0  # from which on the fine picture is still to be drawn

    @property
    def refined(self) -> bool:
        """Whether the picture is as fine as it gets."""
        return self._row >= self._size[1]

    @property
    def texture(self) -> moderngl.Texture:
        """The best picture there is, before the background, 8-bit sRGB; row 0 is the bottom. After begin()."""
        texture = self._finished[SAMPLES if self.refined else 1].color_attachments[0]
        assert isinstance(texture, moderngl.Texture)
        fits = texture.size == self._size
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST) if fits else (moderngl.LINEAR, moderngl.LINEAR)
        return texture

    def begin(self, draw: Draw, size: Size, background: RGB) -> None:
        """Make another picture, of that size, with `draw`; what it shows must stay the same until the next begin()."""
        self._draw, self._size, self._background, self._row = draw, size, background, 0
        scale = self._scale.value
        small = scaled(size, scale)
        start = time.perf_counter()
        target = self._target(1, small)
        target.begin()
        draw(small)
        self._finish(target, 1, small, 0)
        self._context.finish()
        self._scale.update(time.perf_counter() - start, scale)

    def refine(self, seconds: float = TURN_SECONDS) -> bool:
        """Go on with the fine picture, for about so long; whether that is done now."""
        if self._draw is None or self.refined:
            return False
        end = time.perf_counter() + seconds
        while not self.refined and time.perf_counter() < end:
            start = time.perf_counter()
            self._draw_strip(self._draw)
            self._adapt(time.perf_counter() - start)
        return self.refined

    def release(self) -> None:
        for target in self._linear.values():
            target.release()
        for framebuffer in self._finished.values():
            framebuffer.color_attachments[0].release()
            framebuffer.release()
        self._encoded.release()

    def _draw_strip(self, draw: Draw) -> None:
        width, height = self._size
        target = self._target(SAMPLES, (width, self._rows))
        target.begin((0, -self._row, width, height))
        draw(self._size)
        target.finish()
        self._finish(target, SAMPLES, self._size, self._row)
        self._row += self._rows
        self._context.finish()

    def _adapt(self, seconds: float) -> None:
        """Choose the next strip's height by what one has taken."""
        least, most = STRIP_ROWS
        if seconds > TURN_SECONDS:
            self._rows = max(self._rows // 2, least)
        elif seconds < TURN_SECONDS / 2:
            self._rows = min(self._rows * 2, most)

    def _target(self, samples: int, size: Size) -> ColorTarget:
        target = self._linear.get(samples)
        if target is None or target.size != size:
            if target:
                target.release()
            target = self._linear[samples] = ColorTarget(self._context, size, samples)
        return target

    def _finish(self, source: ColorTarget, samples: int, size: Size, row: int) -> None:
        """Put what was drawn into the finished picture of that size, from a row on."""
        framebuffer = self._finished.get(samples)
        if framebuffer is None or framebuffer.size != size:
            if framebuffer:
                framebuffer.color_attachments[0].release()
                framebuffer.release()
            framebuffer = self._finished[samples] = self._context.framebuffer([picture_texture(self._context, size)])
        framebuffer.use()
        framebuffer.viewport = 0, row, size[0], min(source.size[1], size[1] - row)
        self._context.enable_only(moderngl.NOTHING)
        set_uniforms(self._encode, from_bottom=row, background=self._background)
        bind(self._encode, picture=source.texture)
        self._encoded.render(moderngl.TRIANGLES, vertices=6)
