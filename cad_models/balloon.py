"""A hot-air balloon whose pattern is made by trim curves alone (the survey's figure 11 b).

All coloured fields are trimmed faces of one and the same B-spline surface: wavy stripes, a cap, a skirt, and a flag: a
disc cut out of its ground and a star cut out of the disc, each filled by a face with the same trim curves. Neighbours
share their (u, v) curves exactly, so there is neither gap nor overlap. The faces are free, nothing is sewn.
"""

from __future__ import annotations

import cadquery as cq
import numpy as np
from numpy.typing import ArrayLike
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BSplineSurface
from OCP.Geom2d import Geom2d_BezierCurve
from OCP.gp import gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt2d
from OCP.TopoDS import TopoDS, TopoDS_Wire

from _shapes import FOLDER, bspline_surface, compound, write_step

GORES = 12  # the surface bulges this many times around; two spans in u for each
# Radius and height of the control rings, from the skirt's hem to the crown: seven spans in v.
OUTLINE = [
    (3.0, 0.0),
    (3.1, 1.2),
    (4.4, 3.6),
    (9.6, 9.2),
    (12.4, 15.0),
    (12.6, 21.0),
    (9.6, 26.4),
    (5.4, 28.4),
    (2.4, 28.5),
    (0.0, 28.5),
]
SKIRT_TOP, CAP_BOTTOM = 1.0, 6.0  # v
FLAG_WIDTH = 3  # gores
FLAG_CENTRE, FLAG_SIZE = (3.0, 3.6), (2.1, 1.1)  # (u, v) of the disc and its half axes
COLORS = {
    "white": (0.95, 0.94, 0.90),
    "red": (0.80, 0.12, 0.10),
    "orange": (0.95, 0.55, 0.10),
    "blue": (0.10, 0.22, 0.55),
    "yellow": (0.98, 0.80, 0.15),
    "wicker": (0.45, 0.28, 0.14),
}
Edges = list[BRepBuilderAPI_MakeEdge]


def envelope() -> Geom_BSplineSurface:
    """The surface of the whole balloon, periodic in u."""
    angle = np.linspace(0, 2 * np.pi, 2 * GORES, endpoint=False)
    bulge = 1 + 0.035 * np.cos(GORES * angle)
    net = [[(r * b * np.cos(a), r * b * np.sin(a), z) for r, z in OUTLINE] for a, b in zip(angle, bulge, strict=True)]
    return bspline_surface(np.round(net, 4), closed=(True, False))


class Pattern:
    """Cuts fields out of the surface."""

    def __init__(self) -> None:
        self.surface = envelope()
        low, high = SKIRT_TOP, CAP_BOTTOM
        heights = np.linspace(low, high, 6)
        waves = [2 * k + np.array([0, 1.3, -2.2, 2.2, -1.3, 0]) for k in range(GORES + 1)]
        self.borders = [self.edge(np.column_stack([u, heights])) for u in waves]
        self.disc = [self.edge(flag_point(arc)) for arc in circle_arcs()]
        self.star = [self.edge(flag_point(side)) for side in star_sides()]

    def edge(self, points: ArrayLike) -> BRepBuilderAPI_MakeEdge:
        """The edge along the Bezier curve with these (u, v) control points."""
        poles = TColgp_Array1OfPnt2d(1, len(np.asarray(points)))
        for i, (u, v) in enumerate(np.asarray(points, dtype=float), 1):
            poles.SetValue(i, gp_Pnt2d(float(u), float(v)))
        return BRepBuilderAPI_MakeEdge(Geom2d_BezierCurve(poles), self.surface)

    def field(self, outline: list[BRepBuilderAPI_MakeEdge], hole: Edges | None = None) -> cq.Face:
        """The face inside the edges `outline` and outside the edges `hole`."""
        made = BRepBuilderAPI_MakeFace(self.surface, wire(outline), True)
        if hole:
            made.Add(TopoDS.Wire_s(wire(hole).Reversed()))
        BRepLib.BuildCurves3d_s(made.Face())
        return cq.Face(made.Face())

    def stripe(self, first: int, last: int, hole: Edges | None = None) -> cq.Face:
        """The field between two wavy borders, from the skirt to the cap."""
        bottom, top = (self.edge([(2 * first, v), (2 * last, v)]) for v in (SKIRT_TOP, CAP_BOTTOM))
        return self.field([bottom, self.borders[last], top, self.borders[first]], hole)

    def ring(self, low: float, high: float) -> cq.Face:
        """The field of all u between two heights."""
        return cq.Face(BRepBuilderAPI_MakeFace(self.surface, 0.0, 2.0 * GORES, low, high, 1e-7).Face())


def wire(edges: Edges) -> TopoDS_Wire:
    """The edges end to end."""
    made = BRepBuilderAPI_MakeWire()
    for edge in edges:
        made.Add(edge.Edge())
    return made.Wire()


def flag_point(points: ArrayLike) -> np.ndarray:
    """(u, v) of points given on the flag, where the disc is the unit circle."""
    return np.round(np.asarray(FLAG_CENTRE) + np.asarray(points) * FLAG_SIZE, 6)


def circle_arcs() -> list[np.ndarray]:
    """Four cubic quarters of the unit circle, anticlockwise."""
    k = 4 / 3 * np.tan(np.pi / 8)
    quarter = np.array([(1, 0), (1, k), (k, 1), (0, 1)])
    return [quarter @ np.linalg.matrix_power(np.array([(0, 1), (-1, 0)]), i) for i in range(4)]


def star_sides() -> list[np.ndarray]:
    """The ten sides of a five-pointed star with hollow sides, quadratic, anticlockwise."""
    angle = np.pi / 2 + np.arange(11) * np.pi / 5
    reach = np.where(np.arange(11) % 2, 0.38, 0.86)
    corners = np.column_stack([reach * np.cos(angle), reach * np.sin(angle)])
    return [np.array([a, (a + b) * 0.46, b]) for a, b in zip(corners[:-1], corners[1:], strict=True)]


def basket() -> cq.Compound:
    """The basket and its four ropes, hung from the skirt's hem."""
    box = cq.Workplane("XY").box(4.4, 4.4, 3.2).edges("|Z").fillet(1.0).faces(">Z").shell(-0.35)
    shapes: list[cq.Shape] = [box.translate((0, 0, -6.5)).val()]
    for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        start, end = cq.Vector(1.65 * x, 1.65 * y, -5.0), cq.Vector(2.07 * x, 2.07 * y, 0.1)
        shapes.append(cq.Solid.makeCylinder(0.07, (end - start).Length, start, end - start))
    return compound(shapes)


def build() -> cq.Assembly:
    """The fields as free faces, one compound a colour, and the basket."""
    pattern = Pattern()
    stripes = [pattern.stripe(k, k + 1) for k in range(FLAG_WIDTH, GORES)]
    fields = {
        "white": [pattern.stripe(0, FLAG_WIDTH, pattern.disc), *stripes[1::3]],
        "red": [pattern.ring(0, SKIRT_TOP), *stripes[0::3]],
        "orange": [pattern.ring(CAP_BOTTOM, 7), *stripes[2::3]],
        "blue": [pattern.field(pattern.disc, pattern.star)],
        "yellow": [pattern.field(pattern.star)],
    }
    balloon = cq.Assembly(name="balloon")
    for name, faces in fields.items():
        balloon.add(compound(faces), name=name, color=cq.Color(*COLORS[name]))
    balloon.add(basket(), name="basket", color=cq.Color(*COLORS["wicker"]))
    return balloon


if __name__ == "__main__":
    write_step(build(), FOLDER / "balloon.step")
