"""Trim loops: closed, and inside exactly where OpenCascade's own classifier says inside."""

from __future__ import annotations

from collections.abc import Callable
from math import comb, pi

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import SHARED_MODELS

pytest.importorskip("OCP")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_CylindricalSurface, Geom_Plane, Geom_SphericalSurface, Geom_Surface
from OCP.Geom2d import (
    Geom2d_BSplineCurve,
    Geom2d_Circle,
    Geom2d_Curve,
    Geom2d_Ellipse,
    Geom2d_Hyperbola,
    Geom2d_Line,
    Geom2d_OffsetCurve,
    Geom2d_Parabola,
    Geom2d_TrimmedCurve,
)
from OCP.gp import gp_Ax2, gp_Ax2d, gp_Ax3, gp_Circ, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt2d
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopAbs import TopAbs_IN, TopAbs_ON
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from nofacet.cad import measure
from nofacet.cad.chains import Point, Stretch, chain
from nofacet.cad.convert import convert
from nofacet.cad.loops import Loops, ParameterSpace, order_uses
from nofacet.model import Model
from trim_loops import closed_by_box, weld

FLAT = gp_Ax3(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0))
Points = NDArray[np.float64]


def segments_of(model: Model, definition: int) -> list[list[Points]]:
    """The loops of a definition, each a list of control point arrays (degree + 1, 3)."""
    loops = []
    for loop in range(model.definition_loops[definition], model.definition_loops[definition + 1]):
        span = range(model.loop_offsets[loop], model.loop_offsets[loop + 1])
        loops.append([model.segment_points[model.segment_offsets[s] : model.segment_offsets[s + 1]] for s in span])
    return loops


def polyline(points: Points, parts: int = 48) -> Points:
    """Points along one rational Bezier segment."""
    degree = len(points) - 1
    t = np.linspace(0, 1, parts if degree > 1 else 2)[:, None]
    k = np.arange(degree + 1)
    homogeneous = (np.array([comb(degree, j) for j in k]) * t**k * (1 - t) ** (degree - k)) @ points
    return np.asarray(homogeneous[:, :2] / homogeneous[:, 2:])


def inside(loops: list[list[Points]], points: Points) -> tuple[NDArray[np.bool_], Points]:
    """Even-odd answer for each point, and its distance to the loops in parts of their box."""
    lines = [polyline(segment) for loop in loops for segment in loop]
    start, stop = np.concatenate([x[:-1] for x in lines]), np.concatenate([x[1:] for x in lines])
    size = np.ptp(np.concatenate([start, stop]), axis=0)
    answers, distances = np.zeros(len(points), bool), np.empty(len(points))
    for k, (u, v) in enumerate(points):
        crossing = (start[:, 1] > v) != (stop[:, 1] > v)
        a, b = start[crossing], stop[crossing]
        answers[k] = (a[:, 0] + (v - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]) > u).sum() % 2
        along, to = (stop - start) / size, ((u, v) - start) / size
        part = np.clip((along * to).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0, 1)
        distances[k] = np.linalg.norm(part[:, None] * along - to, axis=1).min()
    return answers, distances


def disagreements(shape: TopoDS_Shape, model: Model, count: int = 25, margin: float = 2e-3) -> list[str]:
    """Random (u, v) around each face where even-odd and BRepClass_FaceClassifier differ, away from the boundary."""
    rng = np.random.default_rng(5)
    result, seen = [], set()
    for index, face in enumerate(measure._faces(shape)):
        definition = int(model.face_definition[index])
        loops = segments_of(model, definition)
        if definition in seen or not loops:
            continue
        seen.add(definition)
        corners = np.concatenate([polyline(s) for loop in loops for s in loop])
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        points = low + size * rng.uniform(-0.02, 1.02, (count, 2))
        for point, ours, distance in zip(points, *inside(loops, points), strict=True):
            if distance > margin:
                state = BRepClass_FaceClassifier(face, gp_Pnt2d(*map(float, point)), 1e-9).State()
                if ours != (state in (TopAbs_IN, TopAbs_ON)):
                    result.append(f"face {index} at {point}: ours {ours}, {distance:.3g} from the boundary")
    return result


def assert_closed(model: Model) -> None:
    """Ends have weight 1, weights are positive, neighbours share their end bitwise, and so do last and first."""
    starts, stops = model.segment_offsets[:-1], model.segment_offsets[1:] - 1
    points = model.segment_points
    assert (points[:, 2] > 0).all() and np.isfinite(points).all()
    assert (points[starts, 2] == 1).all() and (points[stops, 2] == 1).all()
    following = np.arange(1, len(starts) + 1)
    following[model.loop_offsets[1:] - 1] = model.loop_offsets[:-1]
    np.testing.assert_array_equal(points[stops], points[starts[following]])


@pytest.mark.parametrize(
    "path",
    [
        "occt/Ball.brep",  # poles, left-handed placements
        "occt/hammer.brep",
        "occt/MODERN_Sink_1.brep",  # edges in any order, faces with their own location
        "aero/resultShape.brep",  # a seam and a C0 knot line
        "aero/wing_assy.brep",  # pcurve ranges that are part of the knot range, trimmed pcurves
    ],
)
def test_loops_of_real_files(path: str) -> None:
    if not (SHARED_MODELS / path).exists():
        pytest.skip(f"{SHARED_MODELS / path} is not there")
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, str(SHARED_MODELS / path), BRep_Builder())
    model = convert(shape, path)
    assert model.warnings == []
    assert_closed(model)
    assert disagreements(shape, model, 4 if model.face_count > 100 else 25) == []


@pytest.mark.parametrize(
    "shape",
    [
        BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(),
        BRepPrimAPI_MakeSphere(2.0).Shape(),
        BRepPrimAPI_MakeCone(2.0, 0.0, 3.0).Shape(),
    ],
    ids=["box", "sphere", "cone"],
)
def test_iso_parameter_rectangles_need_no_trimming(shape: TopoDS_Shape) -> None:
    model = convert(shape, "solid")
    assert_closed(model)
    for kind, trimmed in zip(model.surface_type, model.trimmed, strict=True):
        assert trimmed == (1 if kind == "plane" and "cone" in model.surface_type else 0)


def test_seams_and_degenerate_edges_are_not_drawn_as_edges() -> None:
    model = convert(BRepPrimAPI_MakeSphere(2.0).Shape(), "sphere")
    assert model.segment_edge.tolist() == [-1] * 4
    model = convert(BRepPrimAPI_MakeCone(2.0, 1.0, 3.0).Shape(), "cone")
    assert set(model.segment_edge.tolist()) == {-1, 0, 1}  # two circles, each in two faces, and the seam


PLANE = Geom_Plane(FLAT)


def plane_face(*wires: TopoDS_Wire) -> TopoDS_Face:
    face = TopoDS_Face()
    builder = BRep_Builder()
    builder.MakeFace(face, PLANE, 1e-7)
    for wire in wires:
        builder.Add(face, wire)
    return face


def circle_wire(x: float, y: float, radius: float) -> TopoDS_Wire:
    circle = gp_Circ(gp_Ax2(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1)), radius)
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()


def polygon_wire(*corners: tuple[float, float], order: list[int] | None = None) -> TopoDS_Wire:
    """A closed polygon whose wire stores its edges in any order."""
    edges = [
        BRepBuilderAPI_MakeEdge(gp_Pnt(*a, 0), gp_Pnt(*b, 0)).Edge()
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)
    ]
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for k in order or range(len(edges)):
        builder.Add(wire, edges[k])
    return wire


def area(model: Model, definition: int = 0) -> float:
    """Signed area inside the loops."""
    total = 0.0
    for loop in segments_of(model, definition):
        line = np.concatenate([polyline(s, 2000)[:-1] for s in loop])
        following = np.roll(line, -1, axis=0)
        total += 0.5 * float((line[:, 0] * following[:, 1] - line[:, 1] * following[:, 0]).sum())
    return total


def test_planes_without_pcurves_and_with_a_hole() -> None:
    hole = circle_wire(1, 1, 0.5)
    face = plane_face(polygon_wire((0, 0), (4, 0), (4, 3), (0, 3), order=[2, 0, 3, 1]), hole.Reversed())
    model = convert(face, "plate")
    assert_closed(model)
    assert len(segments_of(model, 0)) == 2 and model.trimmed[0] == 1
    assert area(model) == pytest.approx(12 - pi * 0.25, abs=1e-5)
    assert disagreements(face, model, 200) == []


def test_edges_that_stop_short_are_led_on_to_their_corner_which_the_box_covers() -> None:
    edges = [
        BRepBuilderAPI_MakeEdge(gp_Pnt(*a), gp_Pnt(*b)).Edge()
        for a, b in [((0, 0, 0), (3, 0, 0)), ((3, 0.01, 0), (0, 2, 0)), ((0, 2, 0), (0, 0, 0))]
    ]
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    model = convert(plane_face(wire), "gap")
    assert_closed(model)
    assert model.segment_edge.tolist() == [0, -1, -1, 1, 2]
    corner = 3 + 0.01 * 3 / 1.99
    np.testing.assert_allclose(model.segment_points[3], (corner, 0, 1), atol=1e-15)
    assert model.groups[0].domain[:, 1].max() == pytest.approx(corner)


def pcurve_face(curve: Geom2d_Curve, first: float, last: float) -> TopoDS_Face:
    """A face of the plane bounded by a 2-D curve and its chord, both given as pcurves."""
    a, b = curve.Value(first), curve.Value(last)
    edges = [BRepBuilderAPI_MakeEdge(curve, PLANE, first, last).Edge()]
    if a.Distance(b) > 1e-9:
        direction = gp_Dir2d(a.X() - b.X(), a.Y() - b.Y())
        edges.append(BRepBuilderAPI_MakeEdge(Geom2d_Line(b, direction), PLANE, 0.0, a.Distance(b)).Edge())
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    return plane_face(wire)


def spline2d() -> Geom2d_BSplineCurve:
    poles, weights = TColgp_Array1OfPnt2d(1, 6), TColStd_Array1OfReal(1, 6)
    for k, (u, v, w) in enumerate([(0, 0, 2), (1, 2, 1), (3, 3, 0.5), (4, -1, 3), (6, 2, 1), (7, 0, 0.4)], 1):
        poles.SetValue(k, gp_Pnt2d(u, v))
        weights.SetValue(k, w)
    knots, multiplicities = TColStd_Array1OfReal(1, 3), TColStd_Array1OfInteger(1, 3)
    for k, (knot, multiplicity) in enumerate([(0.0, 4), (1.0, 2), (3.0, 4)], 1):
        knots.SetValue(k, knot)
        multiplicities.SetValue(k, multiplicity)
    return Geom2d_BSplineCurve(poles, weights, knots, multiplicities, 3)


AXIS = gp_Ax2d(gp_Pnt2d(1, 2), gp_Dir2d(2, 1))
PCURVES: dict[str, tuple[Callable[[], Geom2d_Curve], float, float]] = {
    "circle": (lambda: Geom2d_Circle(AXIS, 2.0), 0.0, 2 * pi),
    "circle run clockwise": (lambda: Geom2d_Circle(AXIS, 2.0, False), 0.4, 5.0),
    "ellipse": (lambda: Geom2d_Ellipse(AXIS, 3.0, 1.0), -1.0, 2.5),
    "parabola": (lambda: Geom2d_Parabola(AXIS, 0.7), -2.0, 3.0),
    "hyperbola": (lambda: Geom2d_Hyperbola(AXIS, 2.0, 1.0), -2.0, 2.5),
    "rational spline, part of it": (spline2d, 0.3, 2.8),
    "trimmed circle": (lambda: Geom2d_TrimmedCurve(Geom2d_Circle(AXIS, 2.0), 0.5, 3.0), 0.5, 3.0),
    "offset spline": (lambda: Geom2d_OffsetCurve(spline2d(), 0.1), 0.0, 3.0),
    "offset ellipse": (lambda: Geom2d_OffsetCurve(Geom2d_Ellipse(AXIS, 3.0, 1.0), 0.3), 0.0, 2.0),
}


@pytest.mark.parametrize("name", PCURVES)
def test_every_kind_of_pcurve_is_followed(name: str) -> None:
    make, first, last = PCURVES[name]
    curve = make()
    model = convert(pcurve_face(curve, first, last), name)
    assert model.warnings == []
    assert_closed(model)
    (loop,) = segments_of(model, 0)
    line = np.concatenate([polyline(s, 2000) for s, edge in zip(loop, model.segment_edge, strict=True) if edge == 0])
    size = np.ptp(line, axis=0).max()
    for t in np.linspace(first, last, 41):
        point = curve.Value(float(t))
        start, along = line[:-1], np.diff(line, axis=0)
        to = (point.X(), point.Y()) - start
        part = np.clip((along * to).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0, 1)
        assert np.linalg.norm(part[:, None] * along - to, axis=1).min() <= 1e-6 * size  # the chords of the line


def band(surface: Geom_Surface, *circles: gp_Circ) -> TopoDS_Face:
    """A face whose loops run once around: no seam and no pcurves, each circle a wire of its own."""
    face, builder = TopoDS_Face(), BRep_Builder()
    builder.MakeFace(face, surface, 1e-7)
    for k, circle in enumerate(circles):
        wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()
        builder.Add(face, wire.Reversed() if k else wire)
    return face


def level(z: float, radius: float, turn: float = 0.0) -> gp_Circ:
    return gp_Circ(gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1), gp_Dir(np.cos(turn), np.sin(turn), 0)), radius)


def covered(model: Model) -> float:
    """Area in (u, v) inside the loops, folded into one period."""
    return abs(area(model))


@pytest.mark.parametrize("turn", [0.0, 1.0, 4.0])
def test_a_band_without_a_seam_is_closed_by_slanted_links(turn: float) -> None:
    model = convert(band(Geom_CylindricalSurface(FLAT, 2.0), level(0, 2.0), level(3, 2.0, turn)), "band")
    assert model.warnings == []
    assert_closed(model)
    loops = segments_of(model, 0)
    assert len(loops) == 1 and covered(model) == pytest.approx(2 * pi * 3)
    u = np.linspace(-7, 14, 300)
    for v in (0.2, 1.5, 2.9):
        points = np.stack([u, np.full_like(u, v)], axis=1)
        folded = np.array([inside(loops, points + (2 * pi * k, 0))[0] for k in range(-4, 5)]).sum(axis=0)
        assert (folded == 1).all()  # every place of the cylinder exactly once
    low, high = (
        fold(np.concatenate([group.domain for group in model.groups])[:, k]) for k, fold in ((0, np.min), (1, np.max))
    )
    corners = np.concatenate([segment for loop in loops for segment in loop])
    assert low <= corners[:, 0].min() and high >= corners[:, 0].max()


@pytest.mark.parametrize("upper", [True, False])
def test_a_cap_without_a_pole_edge_reaches_the_pole(upper: bool) -> None:
    height = 1.0
    face = band(Geom_SphericalSurface(FLAT, 2.0), level(height, np.sqrt(4 - height**2)))
    if not upper:
        face = TopoDS_Face()
        builder = BRep_Builder()
        builder.MakeFace(face, Geom_SphericalSurface(FLAT, 2.0), 1e-7)
        wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(level(height, np.sqrt(3.0))).Edge()).Wire()
        builder.Add(face, wire.Reversed())
    model = convert(face, "cap")
    assert model.warnings == []
    assert_closed(model)
    latitude = np.arcsin(height / 2)
    assert covered(model) == pytest.approx(2 * pi * (pi / 2 - latitude if upper else pi / 2 + latitude))


def test_a_face_without_wires_is_drawn_to_its_natural_bounds_or_named() -> None:
    face, builder = TopoDS_Face(), BRep_Builder()
    builder.MakeFace(face, Geom_SphericalSurface(FLAT, 2.0), 1e-7)
    model = convert(face, "sphere")
    assert model.trimmed.tolist() == [0] and model.patch_count == 8 and len(model.segment_edge) == 0
    builder.MakeFace(face, Geom_Plane(FLAT), 1e-7)
    model = convert(face, "plane")
    assert model.patch_count == 0
    assert model.warnings == ["face 0 (plane) is not drawn: it has no edges, and its surface has no end"]


def test_missing_pcurves_are_built() -> None:
    """A quarter of a cylinder whose four edges have 3-D curves only."""
    edges = [
        BRepBuilderAPI_MakeEdge(level(0, 2.0), 0.0, pi / 2).Edge(),
        BRepBuilderAPI_MakeEdge(gp_Pnt(0, 2, 0), gp_Pnt(0, 2, 3)).Edge(),
        BRepBuilderAPI_MakeEdge(level(3, 2.0), 0.0, pi / 2).Edge().Reversed(),
        BRepBuilderAPI_MakeEdge(gp_Pnt(2, 0, 3), gp_Pnt(2, 0, 0)).Edge(),
    ]
    face, wire, builder = TopoDS_Face(), TopoDS_Wire(), BRep_Builder()
    builder.MakeFace(face, Geom_CylindricalSurface(FLAT, 2.0), 1e-7)
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    builder.Add(face, wire)
    model = convert(face, "quarter")
    assert model.warnings == []
    assert_closed(model)
    assert covered(model) == pytest.approx(3 * pi / 2)


def stretches(*ends: tuple[Point, Point]) -> list[Stretch]:
    return [Stretch(use, start, end) for use, (start, end) in enumerate(ends)]


def test_uses_shifted_by_a_period_are_chained_but_a_missing_pole_edge_is_not_a_shift() -> None:
    turn = 2 * pi
    shifted = stretches(((0, 0), (3, 0)), ((3 + turn, 0), (3 + turn, 1)), ((3, 1), (0, 1)), ((0, 1), (0, 0)))
    cylinder = ParameterSpace((turn, 0.0), (0, turn, -2e100, 2e100), lambda axis, value: False)
    (loop,) = chain(shifted, (3 + turn, 1), cylinder)
    assert [stretch.use for stretch in loop] == [0, 1, 2, 3]
    assert max(u for stretch in loop for u, _ in (stretch.start, stretch.end)) == pytest.approx(3)
    assert loop[1].shift == pytest.approx((-turn, 0))
    uses = stretches(((0, 0), (turn, 0)), ((turn, 0), (turn, 1)), ((0, 1), (0, 0)))
    cone = ParameterSpace((turn, 0.0), (0, turn, -2e100, 2e100), lambda axis, value: axis == 1 and value == 1)
    (loop,) = chain(uses, (turn, 1), cone)
    assert loop == uses
    whole = weld([([(*stretch.start, 1.0), (*stretch.end, 1.0)], 0) for stretch in loop], turn, 1.0)
    assert ([(turn, 1, 1.0), (0, 1, 1.0)], -1) in whole


def square() -> Loops:
    """The unit square, one segment a side, from (0, 0)."""
    corners = [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0, 0, 1)]
    points = np.array([[a, b] for a, b in zip(corners, corners[1:], strict=False)], float).reshape(-1, 3)
    return Loops(np.array([0]), np.array([0, 4]), 2 * np.arange(5), points, np.arange(4, dtype=np.int32))


def test_small_gaps_are_moved_away_and_wide_ones_get_a_link() -> None:
    box = (0.0, 1.0, 0.0, 1.0)
    loops = square()
    loops.points[2] += (1e-12, 0, 0)
    loops.points[7] += (0, 1e-12, 0)
    whole = closed_by_box(loops, box)
    np.testing.assert_array_equal(whole.points[1], whole.points[2])
    np.testing.assert_array_equal(whole.points[7], whole.points[0])
    np.testing.assert_array_equal(whole.edge, [0, 1, 2, 3])
    loops = square()
    loops.points[4] -= (0.1, 0, 0)
    whole = closed_by_box(loops, box)
    np.testing.assert_array_equal(whole.edge, [0, 1, -1, 2, 3])
    np.testing.assert_array_equal(whole.points[4:6], [(1, 1, 1), (0.9, 1, 1)])
    np.testing.assert_array_equal(whole.loop_offsets, [0, 5])


def test_uses_in_any_order_make_loops() -> None:
    """A square whose sides are stored in any order, and a triangle with one side missing."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    sides = [(corners[k], corners[(k + 1) % 4]) for k in (0, 2, 1, 3)]
    gap = [((1, 0), (0, 1)), ((0, 0), (1, 0))]
    start, end = np.array(sides + gap, float).swapaxes(0, 1)
    ordered = order_uses(np.array([0, 0, 0, 0, 1, 1]), start, end, np.ones((6, 2)))
    np.testing.assert_array_equal(ordered.use, [0, 2, 1, 3, 4, 5])
    np.testing.assert_array_equal(ordered.loop, [0, 0, 0, 0, 1, 1])
    assert not len(ordered.unclear)
