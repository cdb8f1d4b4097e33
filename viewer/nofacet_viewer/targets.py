"""Framebuffers that pictures are made in before they are put together."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from .opengl import GL

SAMPLES = 4  # a pixel of the tessellated side, where the card can do it
BACKGROUND_DEPTH = 1e30  # stands for infinity, which some cards do not clear to


def picture_texture(
    context: moderngl.Context, size: tuple[int, int], pixels: NDArray[np.uint8] | None = None
) -> moderngl.Texture:
    """A picture as it will be seen: opaque 8-bit sRGB. pixels: (height, width, 4), row 0 is the texture's.

    Its memory has the order of bytes that screens have: where a processor draws, a picture is shown in a third of the
    time then.
    """
    texture = context.texture(size, 4)
    GL.glBindTexture(GL.GL_TEXTURE_2D, texture.glo)
    GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, GL.GL_RGBA, *size, 0, GL.GL_BGRA, GL.GL_UNSIGNED_BYTE, None)
    if pixels is not None:
        texture.write(pixels)
    texture.repeat_x = texture.repeat_y = False
    return texture


class ColorTarget:
    """A linear RGBA picture, alpha premultiplied, with a depth buffer; multisampled where the card can do that."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int], samples: int = 0) -> None:
        self.size = size
        self.texture = context.texture(size, 4, dtype="f2")
        self._resolved = context.framebuffer([self.texture])
        self._context = context
        samples = min(samples, context.max_samples)
        self._drawn = (
            context.framebuffer(
                [context.renderbuffer(size, 4, samples=samples, dtype="f2")],
                context.depth_renderbuffer(size, samples=samples),
            )
            if samples > 1
            else self._resolved
        )

    def begin(self, viewport: tuple[int, int, int, int] | None = None) -> None:
        """Clear it and draw into it from now on; viewport: all of it, if not given."""
        self._drawn.use()
        self._drawn.clear()
        self._drawn.viewport = viewport or (0, 0, *self.size)

    def use(self) -> None:
        """Draw into it from now on, over what is there."""
        self._drawn.use()

    def finish(self) -> None:
        """Average the samples into `texture`."""
        if self._drawn is not self._resolved:
            self._context.copy_framebuffer(self._resolved, self._drawn)

    def release(self) -> None:
        for framebuffer in {id(self._drawn): self._drawn, id(self._resolved): self._resolved}.values():
            for held in (*framebuffer.color_attachments, framebuffer.depth_attachment, framebuffer):
                if held is not None:
                    held.release()


class SurfaceTarget:
    """Depth (model units, BACKGROUND_DEPTH where there is nothing) and face (-1) at every pixel's centre."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self.size = size
        self.depth = context.texture(size, 1, dtype="f4")
        self.face = context.texture(size, 1, dtype="i4")
        for texture in (self.depth, self.face):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._framebuffer = context.framebuffer([self.depth, self.face], context.depth_renderbuffer(size))

    def clear(self) -> None:
        """Empty it and draw into it from now on."""
        width, height = self.size
        self._framebuffer.clear()
        self.depth.write(np.full(width * height, BACKGROUND_DEPTH, np.float32).tobytes())
        self.face.write(np.full(width * height, -1, np.int32).tobytes())
        self._framebuffer.use()

    def read(self) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Depth and face (height, width), row 0 at the top; depth +inf where there is nothing."""
        width, height = self.size
        depth = np.frombuffer(self.depth.read(), np.float32).reshape(height, width)[::-1]
        face = np.frombuffer(self.face.read(), np.int32).reshape(height, width)[::-1]
        return np.where(face < 0, np.float32(np.inf), depth), face

    def release(self) -> None:
        depth_buffer = self._framebuffer.depth_attachment
        for held in (self._framebuffer, self.depth, self.face, depth_buffer):
            held.release()
