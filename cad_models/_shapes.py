"""What the scripts here share: STEP files with the same bytes every time, and free-form faces from arrays."""

from __future__ import annotations

import itertools
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path

import cadquery as cq
import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BezierSurface, Geom_BSplineCurve, Geom_BSplineSurface, Geom_Surface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopoDS import TopoDS_Shell

FOLDER = Path(__file__).parent
TIME_STAMP = "2024-01-01T00:00:00"
# In this order, each refers only to kinds before it.
SHARED_KINDS = ("CARTESIAN_POINT", "DIRECTION", "VECTOR", "LINE", "( GEOMETRIC_REPRESENTATION_CONTEXT(2)")


def write_step(assembly: cq.Assembly, path: Path, pcurves: bool = True) -> Path:
    """Write `assembly` to `path`; the same assembly always gives the same bytes.

    OpenCascade puts the present time and the path into the header and orders colours by memory address; all are
    replaced. Coordinates are rounded to 1e-9 mm, a hundredth of OpenCascade's tolerance. `pcurves=False` leaves out
    the trim curves in (u, v) and lets the reader rebuild them.
    """
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "raw.step"
        assembly.export(str(raw), "STEP", write_pcurves=pcurves)
        text = raw.read_text()
    text = re.sub(r"FILE_NAME\('[^']*','[^']*'", f"FILE_NAME('{path.name}','{TIME_STAMP}'", text, count=1)
    head, data = text.split("DATA;\n", 1)
    data, tail = data.split("ENDSEC;\n", 1)
    entities = {int(n): re.sub(r"\n\s*", "", body) for n, body in re.findall(r"#(\d+) = (.*?);\n", data, re.DOTALL)}
    usages = itertools.count(1)  # OpenCascade numbers the parts of all assemblies of a process
    text_of_usage = re.compile(r"(?<=^NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+")
    entities = {n: text_of_usage.sub(lambda _: str(next(usages)), body) for n, body in entities.items()}
    entities = {n: rounded(body) if body.startswith("CARTESIAN") else body for n, body in entities.items()}
    lines = [f"#{n}={body};\n" for n, body in order_colors(share_equal_entities(entities)).items()]
    path.write_text(head + "DATA;\n" + "".join(lines) + "ENDSEC;\n" + tail)
    return path


def rounded(body: str) -> str:
    """A STEP entity with its numbers rounded to nine decimals."""
    return re.sub(r"-?\d+\.\d*(E[+-]\d+)?", lambda match: f"{round(float(match[0]), 9) + 0.0:.9f}".rstrip("0"), body)


def share_equal_entities(entities: dict[int, str]) -> dict[int, str]:
    """The STEP entities with equal points, directions, lines and (u, v) contexts only once; no number changes.

    A closed B-spline surface, for one, is written with its first control points again as its last ones. Free-form
    files get about a third smaller.
    """
    same: dict[int, int] = {}
    for kind in SHARED_KINDS:
        first: dict[str, int] = {}
        for number in [n for n, body in entities.items() if body.startswith(kind)]:
            if (kept := first.setdefault(renamed(entities[number], same), number)) != number:
                same[number] = kept
    return {n: renamed(body, same) for n, body in entities.items() if n not in same}


def order_colors(entities: dict[int, str]) -> dict[int, str]:
    """The STEP entities with the colours, which stand last, in the order of what they colour."""
    roots = [n for n, body in entities.items() if body.startswith("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION")]
    if not roots:
        return entities
    fixed = {n: body for n, body in entities.items() if n < roots[0]}
    order: list[int] = []

    def visit(number: int) -> None:
        if number in fixed or number in order:
            return
        order.append(number)
        for child in references(entities[number]):
            visit(child)

    for root in sorted(roots, key=lambda n: references(entities[n])[-1]):
        *items, context = references(entities[root])
        items.sort(key=lambda n: references(entities[n])[-1])
        entities[root] = re.sub(r",\(.*", f",({','.join(f'#{n}' for n in items)}),#{context})", entities[root])
        visit(root)
    if len(order) + len(fixed) != len(entities):
        raise ValueError("the STEP file has entities after the colours that no colour refers to")
    number_of = {old: new for new, old in enumerate(order, roots[0])}
    return fixed | {number_of[n]: renamed(entities[n], number_of) for n in order}


def references(body: str) -> list[int]:
    """The numbers of the entities that this one refers to."""
    return [int(n) for n in re.findall(r"#(\d+)", body)]


def renamed(body: str, number_of: dict[int, int]) -> str:
    """The entity with every reference replaced that `number_of` has a new number for."""
    return re.sub(r"#(\d+)", lambda match: f"#{number_of.get(int(match[1]), int(match[1]))}", body)


def points_array(points: ArrayLike) -> TColgp_Array2OfPnt:
    """Control points of shape (m, n, 3) as OpenCascade's array; row index = u."""
    grid = np.asarray(points, dtype=float)
    array = TColgp_Array2OfPnt(1, grid.shape[0], 1, grid.shape[1])
    for i, row in enumerate(grid, 1):
        for j, point in enumerate(row, 1):
            array.SetValue(i, j, gp_Pnt(*map(float, point)))
    return array


def bezier_surface(points: ArrayLike) -> Geom_BezierSurface:
    """The polynomial Bezier surface with control points of shape (degree_u + 1, degree_v + 1, 3), in mm."""
    return Geom_BezierSurface(points_array(points))


def bspline_surface(
    points: ArrayLike, closed: tuple[bool, bool] = (False, False), multiplicity: int = 1
) -> Geom_BSplineSurface:
    """The bicubic B-spline surface over uniform knots with control points of shape (m, n, 3), in mm.

    `multiplicity` is that of every inner knot: 1 smooth (C2), 2 for C1, 3 for Bezier patches side by side (C0).
    A direction that is `closed` is periodic: m / multiplicity spans; an open one ends at its outer points.
    """
    grid = np.asarray(points, dtype=float)
    (knots_u, mults_u), (knots_v, mults_v) = (
        _knots(count, periodic, multiplicity) for count, periodic in zip(grid.shape, closed, strict=False)
    )
    return Geom_BSplineSurface(points_array(grid), knots_u, knots_v, mults_u, mults_v, 3, 3, *closed)


def closed_spline(points: ArrayLike) -> cq.Edge:
    """The uniform periodic cubic B-spline curve with control points of shape (n, 3), in mm."""
    array = TColgp_Array1OfPnt(1, len(np.asarray(points)))
    for i, point in enumerate(np.asarray(points, dtype=float), 1):
        array.SetValue(i, gp_Pnt(*map(float, point)))
    return cq.Edge(BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(array, *_knots(array.Length(), True, 1), 3, True)).Edge())


def _knots(count: int, closed: bool, multiplicity: int) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    """Knots 0, 1, 2 ... and multiplicities of a cubic with `count` control points."""
    spans, rest = divmod(count if closed else count - 4 + multiplicity, multiplicity)
    if rest:
        raise ValueError(f"{count} control points do not divide into spans of {multiplicity}")
    knots, mults = TColStd_Array1OfReal(1, spans + 1), TColStd_Array1OfInteger(1, spans + 1)
    for i in range(spans + 1):
        knots.SetValue(i + 1, float(i))
        mults.SetValue(i + 1, 4 if not closed and i in (0, spans) else multiplicity)
    return knots, mults


def spans(faces: Iterable[cq.Shape]) -> int:
    """Bezier patches in these B-spline or Bezier faces: the spans between distinct knots, counted on whole surfaces."""
    total = 0
    for shape in faces:
        surface = BRep_Tool.Surface_s(shape.wrapped)
        bspline = isinstance(surface, Geom_BSplineSurface)
        total += (surface.NbUKnots() - 1) * (surface.NbVKnots() - 1) if bspline else 1
    return total


def face(surface: Geom_Surface) -> cq.Face:
    """The whole surface as one face, with seams and poles where it closes or collapses."""
    made = BRepBuilderAPI_MakeFace(surface, 1e-7)
    if not made.IsDone():
        raise ValueError("OpenCascade makes no face of this surface")
    return cq.Face(made.Face())


def compound(shapes: Iterable[cq.Shape]) -> cq.Compound:
    """The shapes side by side: nothing is sewn or fused, so no geometry changes."""
    return cq.Compound.makeCompound(list(shapes))


def solid(closed: cq.Face) -> cq.Solid:
    """The body inside one closed face."""
    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    builder.Add(shell, closed.wrapped)
    shell.Closed(True)
    return cq.Solid.makeSolid(cq.Shell(shell))


def hull(sections: ArrayLike, first: ArrayLike, last: ArrayLike) -> cq.Solid:
    """A smooth body on control rings of shape (m, n, 3), closing at the points `first` and `last`; u runs around.

    The rings next to the ends must lie in the planes of the end points, or the body has corners there.
    """
    rings = np.asarray(sections, dtype=float)
    ends = [np.broadcast_to(np.asarray(end, dtype=float), rings[:1].shape) for end in (first, last)]
    net = np.concatenate([ends[0], rings, ends[1]]).swapaxes(0, 1)
    return solid(face(bspline_surface(net, closed=(True, False))))


def rings_along_x(sections: ArrayLike, around: int, square: float) -> NDArray[np.float64]:
    """(m, around, 3) control rings from sections (x, height of the middle, half width, half height), in mm.

    `square` is 0 for elliptic sections and goes towards 1 for rectangles.
    """
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    across, up = (np.sign(c) * np.abs(c) ** (1 - square) for c in (np.cos(angle), np.sin(angle)))
    x, middle, half_width, half_height = np.asarray(sections, dtype=float).T[:, :, None]
    return np.round(np.stack([x + 0 * angle, half_width * across, middle + half_height * up], axis=-1), 4)


def pill(length: float, width: float, height: float) -> cq.Solid:
    """A smooth flattened ball of this size about the origin, its poles on the x axis."""
    shares = [(-0.5, 0.4), (-0.5, 1.0), (0.0, 1.2), (0.5, 1.0), (0.5, 0.4)]
    rings = rings_along_x([(s * length, 0, r * width / 2, r * height / 2) for s, r in shares], 12, 0.0)
    return hull(rings, (-length / 2, 0, 0), (length / 2, 0, 0))
