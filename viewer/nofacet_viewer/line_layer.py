"""Fine lines on and around surfaces, hidden by a picture of the surfaces' depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from .programs import bind, program, set_uniforms
from .projection import Projection

RULES = {"on surface": 0, "in front": 1, "faint behind": 2}


@dataclass(frozen=True)
class LineStyle:
    """How an overlay's lines look.

    color: linear RGB. width: pixels. rule: of RULES: lines on a surface show where it does, others also before it or,
    faintly, behind it.
    """

    color: tuple[float, float, float]
    width: float
    opacity: float = 0.85
    rule: str = "on surface"


@dataclass(frozen=True)
class DepthPicture:
    """What hides lines: depth at pixel centres. top_first: its row 0 is the picture's top. shows: what is in it, where
    one texture holds one after another."""

    texture: moderngl.Texture
    top_first: bool
    shows: Any = None


class LineLayer:
    """Segments (n, 2, 3) float64, world, on the graphics card."""

    def __init__(self, context: moderngl.Context, segments: NDArray[np.float64]) -> None:
        self.count = len(segments)
        ends = segments.reshape(-1, 3)
        low, high = (ends.min(axis=0), ends.max(axis=0)) if self.count else (np.zeros(3), np.zeros(3))
        self.bounds = low, high
        self.center = (low + high) / 2
        self._context = context
        self._buffer = context.buffer((ends - self.center).astype(np.float32).tobytes() or bytes(24))
        self._program = program(context, "line.vert", "line.frag")
        self._array = context.vertex_array(self._program, [(self._buffer, "3f 3f/i", "start", "end")])

    def draw(
        self,
        projection: Projection,
        size: tuple[int, int],
        style: LineStyle,
        surface: DepthPicture,
        tolerance: float,
    ) -> None:
        """Draw into the framebuffer in use, a linear RGBA picture with premultiplied alpha.

        tolerance: how far the lines may be off the surfaces that they lie on, model units.
        """
        near = projection.depth_range[0]
        set_uniforms(
            self._program,
            clip_from_local=projection.clip_from_local,
            eye_from_local=projection.eye_from_local,
            perspective=projection.perspective,
            nearest=near if projection.perspective else 0.5,
            size=tuple(map(float, size)),
            half_width=style.width / 2,
            line_color=style.color,
            opacity=style.opacity,
            rule=RULES[style.rule],
            tolerance=tolerance,
            top_first=surface.top_first,
        )
        bind(self._program, surface=surface.texture)
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.ONE, moderngl.ONE
        self._context.blend_equation = moderngl.MAX  # chords that overlap where they meet count once
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self.count)
        self._context.blend_equation = moderngl.FUNC_ADD

    def release(self) -> None:
        for held in (self._array, self._buffer):
            held.release()
