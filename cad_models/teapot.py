"""The Utah teapot: Martin Newell's 32 bicubic Bezier patches (1975), each one face, its control points unchanged.

Published as 306 vertices and 32 x 16 indices (F. Crow, "The Origins of the Teapot", IEEE CG&A 7(1), 1987). The same
points are written here as what they are made from: profiles turned by quarter circles, and half nets mirrored at y = 0.
Rim, body, lid and bottom are turned about the z axis; handle and spout are tubes of two rows of two half patches.
Patches only touch, as in the original: handle and spout pass through the body, and the lid leaves a gap.
"""

from __future__ import annotations

import cadquery as cq
import numpy as np
from numpy.typing import NDArray

from _shapes import FOLDER, bezier_surface, compound, face, write_step

# Cubic quarter circles: the inner control points stand at this fraction of the radius.
ROUND = 0.56
KNOB_RADIUS, KNOB_INNER = 0.8, 0.45  # the lid's knob is the exception

# Turned patches: (radius, z) of each of the four rows of control points.
RIM = [(1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4)]
BODY_UPPER = [(1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9)]
BODY_LOWER = [(2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15)]
LID_KNOB = [(0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7)]
LID_PLATE = [(0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4)]
BOTTOM = [(1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0)]

# Tube patches: (x, z) of the side towards the body's axis or mouth, (x, z) of the far side, half width.
HANDLE = [
    [
        ((-1.6, 2.025), (-1.5, 2.25), 0.3),
        ((-2.3, 2.025), (-2.5, 2.25), 0.3),
        ((-2.7, 2.025), (-3.0, 2.25), 0.3),
        ((-2.7, 1.8), (-3.0, 1.8), 0.3),
    ],
    [
        ((-2.7, 1.8), (-3.0, 1.8), 0.3),
        ((-2.7, 1.575), (-3.0, 1.35), 0.3),
        ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
        ((-2.0, 0.9), (-1.9, 0.6), 0.3),
    ],
]
SPOUT = [
    [
        ((1.7, 1.425), (1.7, 0.6), 0.66),
        ((2.6, 1.425), (3.1, 0.825), 0.66),
        ((2.3, 2.1), (2.4, 2.025), 0.25),
        ((2.7, 2.4), (3.3, 2.4), 0.25),
    ],
    [
        ((2.7, 2.4), (3.3, 2.4), 0.25),
        ((2.8, 2.475), (3.525, 2.49375), 0.25),
        ((2.9, 2.475), (3.45, 2.5125), 0.15),
        ((2.8, 2.4), (3.2, 2.4), 0.15),
    ],
]
COLOR = cq.Color(0.62, 0.71, 0.78)


def turned(profile: list[tuple[float, float]]) -> list[NDArray[np.float64]]:
    """Four patches (4, 4, 3): the profile (radius, z) once for each quarter turn about the z axis."""
    patches = []
    for (ax, ay), (bx, by) in [((1, 0), (0, -1)), ((0, -1), (-1, 0)), ((-1, 0), (0, 1)), ((0, 1), (1, 0))]:
        net = np.zeros((4, 4, 3))
        for row, (radius, z) in zip(net, profile, strict=True):
            inner = KNOB_INNER if radius == KNOB_RADIUS else round(radius * ROUND, 12)
            for point, (a, b) in zip(row, [(radius, 0), (radius, inner), (inner, radius), (0, radius)], strict=True):
                point[:] = a * ax + b * bx, a * ay + b * by, z
        patches.append(net)
    return patches


def mirrored(rows: list[tuple[tuple[float, float], tuple[float, float], float]]) -> list[NDArray[np.float64]]:
    """Two patches (4, 4, 3): a half tube at y <= 0 and its mirror image, whose rows run back to the start."""
    net = np.array([[(a, 0, b), (a, -w, b), (c, -w, d), (c, 0, d)] for (a, b), (c, d), w in rows])
    return [net, (net * (1, -1, 1))[:, ::-1]]


def patches() -> dict[str, list[NDArray[np.float64]]]:
    """The 32 control nets, each (4, 4, 3), by part, in the published order: du x dv points inward."""
    return {
        "body": turned(RIM) + turned(BODY_UPPER) + turned(BODY_LOWER) + turned(BOTTOM),
        "handle": [net for rows in HANDLE for net in mirrored(rows)],
        "spout": [net for rows in SPOUT for net in mirrored(rows)],
        "lid": turned(LID_KNOB) + turned(LID_PLATE),
    }


def build() -> cq.Assembly:
    """One compound of free faces, reversed so that they look outward, for each of body, handle, spout and lid."""
    pot = cq.Assembly(name="teapot")
    for name, nets in patches().items():
        faces = [cq.Face(face(bezier_surface(net)).wrapped.Reversed()) for net in nets]
        pot.add(compound(faces), name=name, color=COLOR)
    return pot


if __name__ == "__main__":
    write_step(build(), FOLDER / "teapot.step")
