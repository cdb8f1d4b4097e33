"""What surfaces are coloured with."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from .color_scale import ColorScale

COLOR_ROW = 1024  # faces a row of the texture of their colours
MARK = (1.0, 0.27, 0.0, 0.55)  # of what is selected: linear RGB, and how much of it is mixed in


class FaceColors:
    """A texture of the faces' colours, linear RGBA."""

    def __init__(self, context: moderngl.Context, colors: NDArray[np.float32]) -> None:
        rows = max(1, -(-len(colors) // COLOR_ROW))
        padded = np.zeros((rows * COLOR_ROW, 4), np.float32)
        padded[: len(colors)] = colors
        self.texture = context.texture((COLOR_ROW, rows), 4, padded.tobytes(), dtype="f4")
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.alpha = padded[:, 3]

    def release(self) -> None:
        self.texture.release()


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
