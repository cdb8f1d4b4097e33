"""The light of every picture, for those who draw with it elsewhere. Its formula is light() in src/native/light.h."""

from __future__ import annotations

from dataclasses import dataclass

from . import _native


@dataclass(frozen=True)
class Light:
    """Shares of the light, and where it comes from.

    direction: unit vector towards the key light in eye space (right, up, forward).
    ambient: from everywhere; sky: from above in the world (+Z); facing: from the eye; key: from the key light.
    gloss: of the highlight, whose cosine is taken to the power gloss_exponent.
    """

    direction: tuple[float, float, float]
    ambient: float
    sky: float
    facing: float
    key: float
    gloss: float
    gloss_exponent: int


LIGHT = Light(**_native.light())
