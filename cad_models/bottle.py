"""A lofted bottle: rounded squares that turn into circles towards the neck, hollow, with a lip and a drawn-in foot."""

from __future__ import annotations

import cadquery as cq
import numpy as np

from _shapes import FOLDER, closed_spline, write_step

# Height, half width and exponent of each section |x|^e + |y|^e = w^e: 2 is a circle, 4 nearly a square.
SECTIONS = [
    (0.0, 25.0, 3.0),
    (6.0, 30.0, 3.4),
    (25.0, 32.0, 3.6),
    (60.0, 29.0, 3.4),
    (95.0, 31.0, 3.0),
    (125.0, 22.0, 2.3),
    (145.0, 13.0, 2.0),
    (160.0, 12.0, 2.0),
    (172.0, 12.0, 2.0),
]
WALL = 2.0


def section(height: float, half_width: float, exponent: float) -> cq.Wire:
    """One closed spline on 24 control points; all sections have the same knots, so that the loft stays small."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    reach = half_width / (np.abs(np.cos(angle)) ** exponent + np.abs(np.sin(angle)) ** exponent) ** (1 / exponent)
    points = np.stack([reach * np.cos(angle), reach * np.sin(angle), np.full(24, height)], axis=-1)
    return cq.Wire.assembleEdges([closed_spline(np.round(points, 4))])


def loft(inset: float, floor: float) -> cq.Workplane:
    """The body through all sections, `inset` mm thinner than the outside, its bottom at z = `floor`."""
    wires = [section(z + floor * (1 - z / SECTIONS[-1][0]), w - inset, e) for z, w, e in SECTIONS]
    return cq.Workplane("XY").newObject([cq.Solid.makeLoft(wires)])


def build() -> cq.Assembly:
    """The bottle as one solid."""
    outside = loft(0.0, 0.0)
    # Turned about the z axis, so that its seam does not meet the loft's.
    lip = cq.Workplane("XZ").moveTo(13.0, 167.5).circle(2.2).revolve(360, (0, 0), (0, 1))
    lip = lip.rotate((0, 0, 0), (0, 0, 1), 30)
    bottle = outside.union(lip).cut(loft(WALL, 4.0))
    return cq.Assembly(bottle.val(), name="bottle", color=cq.Color(0.15, 0.55, 0.40))


if __name__ == "__main__":
    write_step(build(), FOLDER / "bottle.step")
