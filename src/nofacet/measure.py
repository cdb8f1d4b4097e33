"""Measuring between two picked points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .camera import Vector
from .pick import LABEL_WIDTH, Pick, lengths_text


@dataclass(frozen=True)
class Measurement:
    """From one point on a surface to another. Lengths in model units, mm for STEP files.

    distance: straight through space; offset: the second point minus the first, along x, y and z.
    angle: between the normals, degrees from 0 to 180; NaN where a face has none.
    first, second: what was measured, with its radii_of_curvature.
    """

    distance: float
    offset: Vector
    angle: float
    first: Pick
    second: Pick

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """For people: what each fact is called, and the fact."""
        return (
            ("distance", f"{self.distance:.9g} mm"),
            ("offset", lengths_text(self.offset)),
            ("normals", f"{self.angle:.6g} degrees apart"),
            ("at first", ", ".join(self.first.bend_texts)),
            ("at second", ", ".join(self.second.bend_texts)),
        )

    def __str__(self) -> str:
        """A line for each fact, for people."""
        return "\n".join(f"{label:<{LABEL_WIDTH}}{text}" for label, text in self.facts)


def measure(first: Pick, second: Pick) -> Measurement:
    """Measure between two points that `pick` found, of one model or of two in the same world."""
    offset = np.subtract(second.position, first.position)
    one, other = np.array(first.normal), np.array(second.normal)
    # Kahan's form: to rounding at every angle, where the arc cosine loses half the digits near 0 and 180 degrees.
    angle = 2 * np.arctan2(np.linalg.norm(one - other), np.linalg.norm(one + other))
    x, y, z = (float(value) for value in offset)
    return Measurement(float(np.linalg.norm(offset)), (x, y, z), float(np.degrees(angle)), first, second)
