"""A chain coiled into a hat (the survey's figure 9 b): 252 doughnuts of 16 bicubic patches, deformed one by one.

Each link starts as a round doughnut of 4 x 4 patches (cubic quarter circles). Its control points are then carried along
the coil, which stretches and bends it; so no two links are copies. 4,032 patches in 252 faces with C1 knots.
"""

from __future__ import annotations

import cadquery as cq
import numpy as np
from numpy.typing import NDArray

from _shapes import FOLDER, bspline_surface, compound, face, write_step

LINKS = 252
RING_RADIUS, WIRE_RADIUS = 1.0, 0.30
STRETCH = 1.35  # of the ring along the coil
PITCH = 1.78  # coil length for each link
TURN_DISTANCE = 2.0  # between neighbouring turns of the coil
# Half the hat's outline from the brim's edge to the crown's middle: (radius, z), cubic Bezier pieces.
OUTLINE = np.array(
    [
        (13.9, 2.0),
        (12.1, -0.5),
        (9.6, 0.0),
        (8.3, 0.4),
        (6.7, 0.8),
        (7.3, 4.1),
        (6.6, 6.6),
        (5.9, 8.7),
        (2.8, 8.7),
        (0.0, 8.7),
    ]
)


def quarter_circle_points() -> NDArray[np.float64]:
    """(8, 2): the two inner Bezier points of each cubic quarter of the unit circle; with double knots, all of them."""
    k = 4 / 3 * np.tan(np.pi / 8)
    quarter = np.array([(1.0, k), (k, 1.0)])
    turn = np.array([(0.0, -1.0), (1.0, 0.0)])
    points = np.concatenate([quarter @ np.linalg.matrix_power(turn.T, i) for i in range(4)])
    return np.roll(points, -1, axis=0)  # OpenCascade's first span starts between points 0 and 1


def doughnut() -> NDArray[np.float64]:
    """(8, 8, 3) control points of the ring in the plane z = 0."""
    circle = quarter_circle_points()
    ring = RING_RADIUS + WIRE_RADIUS * circle[:, 0]
    return np.stack(
        [
            circle[:, None, 0] * ring,
            circle[:, None, 1] * ring,
            np.broadcast_to(WIRE_RADIUS * circle[:, 1], (8, 8)),
        ],
        axis=-1,
    )


class Coil:
    """The hat's surface with a coil on it, turns TURN_DISTANCE apart, measured by its length from the brim."""

    def __init__(self) -> None:
        t = np.linspace(0, 1, 400, endpoint=False)[:, None]
        pieces = [
            (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
            for a, b, c, d in (OUTLINE[i : i + 4] for i in range(0, len(OUTLINE) - 1, 3))
        ]
        outline = np.concatenate([*pieces, OUTLINE[-1:]])
        along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(outline, axis=0), axis=1))])
        q = np.linspace(0, along[-1], 20001)
        self.radius, self.z = (np.interp(q, along, column) for column in outline.T)
        self.angle = 2 * np.pi * q / TURN_DISTANCE
        slope_r, slope_z = np.gradient(self.radius, q), np.gradient(self.z, q)
        self.normal_r, self.normal_z = -slope_z, slope_r
        step = np.hypot(np.diff(q), 0.5 * (self.radius[1:] + self.radius[:-1]) * np.diff(self.angle))
        self.length = np.concatenate([[0], np.cumsum(step)])

    def frame(self, s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Point, surface normal and in-surface side direction of the coil at the lengths `s`, each s.shape + (3,)."""
        radius, z, angle, normal_r, normal_z = (
            np.interp(s, self.length, column)
            for column in (self.radius, self.z, self.angle, self.normal_r, self.normal_z)
        )
        cos, sin = np.cos(angle), np.sin(angle)
        point = np.stack([radius * cos, radius * sin, z], axis=-1)
        normal = np.stack([normal_r * cos, normal_r * sin, normal_z], axis=-1)
        side = np.stack([-normal_z * cos, -normal_z * sin, normal_r], axis=-1)
        return point, normal, side


def link(coil: Coil, index: int) -> NDArray[np.float64]:
    """(8, 8, 3) control points of one link, every second one turned by a right angle about the coil."""
    ring = doughnut()
    lean = np.pi / 4 if index % 2 else -np.pi / 4
    x, y, z = ring[..., 0] * STRETCH, ring[..., 1], ring[..., 2]
    y, z = y * np.cos(lean) - z * np.sin(lean), y * np.sin(lean) + z * np.cos(lean)
    point, normal, side = coil.frame((index + 1) * PITCH + x)
    return np.round(point + y[..., None] * side + z[..., None] * normal, 3)


def build() -> cq.Assembly:
    """The links as free faces, gold and silver in turn."""
    coil = Coil()
    if coil.length[-1] < (LINKS + 2) * PITCH:
        raise ValueError(f"the coil of {coil.length[-1]:.1f} mm is too short for {LINKS} links")
    faces = [face(bspline_surface(link(coil, i), closed=(True, True), multiplicity=2)) for i in range(LINKS)]
    chain = cq.Assembly(name="chain")
    chain.add(compound(faces[::2]), name="gold", color=cq.Color(0.85, 0.65, 0.25))
    chain.add(compound(faces[1::2]), name="silver", color=cq.Color(0.75, 0.77, 0.80))
    return chain


if __name__ == "__main__":
    write_step(build(), FOLDER / "chain.step")
