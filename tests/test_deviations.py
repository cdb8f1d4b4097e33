"""Edges in space against the curves that trim: exact cases, and the bulk evaluation that measures them."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import pytest

from conftest import SHARED_MODELS

pytest.importorskip("OCP")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.BRepTools import BRepTools
from OCP.Geom import (
    Geom_BezierCurve,
    Geom_Circle,
    Geom_Curve,
    Geom_CylindricalSurface,
    Geom_Ellipse,
    Geom_Hyperbola,
    Geom_OffsetCurve,
    Geom_OffsetSurface,
    Geom_Parabola,
    Geom_Surface,
)
from OCP.Geom2d import Geom2d_BezierCurve
from OCP.gp import gp_Dir, gp_Pnt, gp_Pnt2d, gp_Trsf, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from nofacet import cli
from nofacet.cad import stream as brep
from nofacet.cad.convert import convert
from nofacet.cad.deviations import edge_deviations
from nofacet.cad.evaluate import Curves, Surfaces
from nofacet.cad.load import load
from test_surfaces import AX2, EXACT, bspline_curve, extrusion, face_of
from test_trims import FLAT, PCURVES, PLANE, level, pcurve_face, plane_face

SURFACES: dict[str, tuple[Callable[[], Geom_Surface], tuple[float, ...]]] = {
    **EXACT,
    "offset": (lambda: Geom_OffsetSurface(extrusion(bspline_curve()), 0.4), (0, 3, 0, 5)),
}


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces_are_evaluated_as_by_opencascade(name: str) -> None:
    make, box = SURFACES[name]
    surface = make()
    rng = np.random.default_rng(1)
    u, v = rng.uniform(box[0], box[1], 40), rng.uniform(box[2], box[3], 40)
    u[:4], v[:4] = [box[0], box[0], box[1], box[1]], [box[2], box[3], box[2], box[3]]
    ours = Surfaces(brep.read(face_of(surface, *box)).surfaces[1:])(np.zeros(40, np.int64), u, v)
    theirs = [surface.Value(*place) for place in zip(u.tolist(), v.tolist(), strict=True)]
    np.testing.assert_allclose(ours, [(p.X(), p.Y(), p.Z()) for p in theirs], atol=1e-7 if name == "offset" else 1e-12)


@pytest.mark.parametrize("name", PCURVES)
def test_curves_in_the_plane_are_evaluated_as_by_opencascade(name: str) -> None:
    make, first, last = PCURVES[name]
    curve = make()
    t = np.linspace(first, last, 37)
    ours = Curves(brep.read(pcurve_face(curve, first, last)).curves2d[1:2], 2)(np.zeros(37, np.int64), t)
    theirs = [curve.Value(x) for x in t.tolist()]
    np.testing.assert_allclose(ours, [(p.X(), p.Y()) for p in theirs], atol=1e-7 if "offset" in name else 1e-13)


def bezier(*poles: tuple[float, float, float]) -> Geom_BezierCurve:
    array = TColgp_Array1OfPnt(1, len(poles))
    for k, pole in enumerate(poles, 1):
        array.SetValue(k, gp_Pnt(*pole))
    return Geom_BezierCurve(array)


def bezier2d(*poles: tuple[float, float]) -> Geom2d_BezierCurve:
    array = TColgp_Array1OfPnt2d(1, len(poles))
    for k, pole in enumerate(poles, 1):
        array.SetValue(k, gp_Pnt2d(*pole))
    return Geom2d_BezierCurve(array)


@pytest.mark.parametrize(
    ("curve", "first", "last"),
    [
        (Geom_Circle(AX2, 2.0), -1.0, 4.0),
        (Geom_Ellipse(AX2, 3.0, 1.0), 0.0, 6.0),
        (Geom_Hyperbola(AX2, 2.0, 1.0), -1.0, 2.0),
        (Geom_Parabola(AX2, 0.7), -1.0, 2.0),
        (bezier((0, 0, 0), (1, 2, 3), (2, 0, 1), (5, 5, 5)), 0.0, 1.0),
        (bspline_curve(), 0.2, 2.9),
        (Geom_OffsetCurve(Geom_Circle(AX2, 2.0), 0.3, gp_Dir(0, 0.6, 0.8)), 0.5, 3.0),
    ],
    ids=["circle", "ellipse", "hyperbola", "parabola", "bezier", "bspline", "offset"],
)
def test_curves_in_space_are_evaluated_as_by_opencascade(curve: Geom_Curve, first: float, last: float) -> None:
    edge = BRepBuilderAPI_MakeEdge(curve, first, last).Edge()
    t = np.linspace(first, last, 23)
    ours = Curves(brep.read(edge).curves[1:], 3)(np.zeros(23, np.int64), t)
    theirs = [curve.Value(x) for x in t.tolist()]
    np.testing.assert_allclose(ours, [(p.X(), p.Y(), p.Z()) for p in theirs], atol=1e-7)


def wire_of(*edges: TopoDS_Edge) -> TopoDS_Wire:
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    return wire


def segment(start: tuple[float, float, float], stop: tuple[float, float, float]) -> TopoDS_Edge:
    return BRepBuilderAPI_MakeEdge(gp_Pnt(*start), gp_Pnt(*stop)).Edge()


def triangle(first: TopoDS_Edge) -> TopoDS_Face:
    """A face of the plane z = 0 with corners (0, 0), (1, 0), (0, 1), its edge along x given."""
    return plane_face(wire_of(first, segment((1, 0, 0), (0, 1, 0)), segment((0, 1, 0), (0, 0, 0))))


def along_x(curve: Geom_Curve, pcurve: Geom2d_BezierCurve) -> TopoDS_Edge:
    """An edge from x = 0 to 1 with a curve in space and one in the plane, which need not be the same."""
    edge = BRepBuilderAPI_MakeEdge(curve, 0.0, 1.0).Edge()
    BRep_Builder().UpdateEdge(edge, pcurve, PLANE, TopLoc_Location(), 1e-7)
    return edge


STRAIGHT = bezier2d((0, 0), (1, 0))
HEIGHT = 0.01
CASES: dict[str, tuple[TopoDS_Edge, float]] = {
    "on the plane": (segment((0, 0, 0), (1, 0, 0)), 0.0),
    "above the plane": (segment((0, 0, HEIGHT), (1, 0, HEIGHT)), HEIGHT),
    "rising from the plane": (segment((0, 0, 0), (1, 0, HEIGHT)), HEIGHT),
    "above its pcurve": (along_x(bezier((0, 0, HEIGHT), (1, 0, HEIGHT)), STRAIGHT), HEIGHT),
    "beside its pcurve": (along_x(bezier((0, 0, 0), (1, 0, 0)), bezier2d((0, HEIGHT), (1, HEIGHT))), HEIGHT),
    # its highest point, 27/4 t^2 (1 - t) of HEIGHT, is at t = 2/3, between the samples
    "bulging": (along_x(bezier((0, 0, 0), (1 / 3, 0, 0), (2 / 3, 0, 2.25 * HEIGHT), (1, 0, 0)), STRAIGHT), HEIGHT),
    # 0.25 apart at equal parameter, and the same line
    "at another speed": (along_x(bezier((0, 0, 0), (1, 0, 0)), bezier2d((0, 0), (0, 0), (1, 0))), 0.0),
    "above, at another speed": (
        along_x(bezier((0, 0, HEIGHT), (1, 0, HEIGHT)), bezier2d((0, 0), (0.1, 0), (1, 0))),
        HEIGHT,
    ),
    # the pcurve runs on to x = 1.1 and comes back: nothing of the edge is near its turning point
    "too short": (along_x(bezier((0, 0, 0), (1, 0, 0)), bezier2d((0, 0), (1.2, 0), (1, 0))), 1.2**2 / 1.4 - 1),
}


@pytest.mark.parametrize("name", CASES)
def test_exact_cases(name: str) -> None:
    edge, expected = CASES[name]
    found = edge_deviations(triangle(edge))
    assert found.face.tolist() == [0, 0, 0] and found.face.dtype == np.int32
    assert found.distance[0] == pytest.approx(expected, rel=5e-3, abs=1e-11)
    assert found.distance[1:].max() <= 1e-15
    assert found.tolerance == pytest.approx(1e-7)


def test_an_arc_of_another_radius() -> None:
    edge = BRepBuilderAPI_MakeEdge(level(0, 2.0 + HEIGHT), 0.3, 5.0).Edge()
    face, builder = TopoDS_Face(), BRep_Builder()
    surface = Geom_CylindricalSurface(FLAT, 2.0)
    builder.MakeFace(face, surface, 1e-7)
    builder.UpdateEdge(edge, bezier2d((0.3, 0), (2.0, 0), (5.0, 0)), surface, TopLoc_Location(), 1e-7)
    builder.Range(edge, surface, TopLoc_Location(), 0.0, 1.0)  # the angle's speed differs too
    builder.Add(face, wire_of(edge))
    assert edge_deviations(face).distance == pytest.approx([HEIGHT], rel=1e-3)


def test_every_placed_face_has_its_uses_in_world_lengths() -> None:
    face = triangle(CASES["above the plane"][0])
    moved, scaled = gp_Trsf(), gp_Trsf()
    moved.SetTranslation(gp_Vec(0, 0, 5))
    scaled.SetScaleFactor(3.0)
    both, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(both)
    builder.Add(both, face.Moved(TopLoc_Location(moved)))
    builder.Add(both, face)
    found = edge_deviations(both)
    assert found.face.tolist() == [0, 0, 0, 1, 1, 1]
    assert found.distance == pytest.approx(2 * [HEIGHT, 0, 0], abs=1e-15)
    assert edge_deviations(face.Moved(TopLoc_Location(scaled), False)).distance[0] == pytest.approx(3 * HEIGHT)


def test_seams_count_twice_and_degenerate_edges_not_at_all() -> None:
    cylinder = edge_deviations(BRepPrimAPI_MakeCylinder(1.0, 2.0).Shape())
    assert len(cylinder.face) == 6 and cylinder.distance.max() <= 1e-12  # two circles twice, the seam twice
    assert len(edge_deviations(BRepPrimAPI_MakeSphere(2.0).Shape()).face) == 2


def test_pcurves_that_had_to_be_built_are_measured() -> None:
    edges = [
        BRepBuilderAPI_MakeEdge(level(0, 2.0), 0.0, pi / 2).Edge(),
        segment((0, 2, 0), (0, 2, 3)),
        BRepBuilderAPI_MakeEdge(level(3, 2.0), 0.0, pi / 2).Edge().Reversed(),
        segment((2, 0, 3), (2, 0, 0)),
    ]
    face = TopoDS_Face()
    BRep_Builder().MakeFace(face, Geom_CylindricalSurface(FLAT, 2.0), 1e-7)
    BRep_Builder().Add(face, wire_of(*edges))
    found = edge_deviations(face)
    assert len(found.face) == 4 and found.distance.max() <= 1e-9


def test_a_model_holds_what_was_measured_and_info_prints_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    face = triangle(CASES["above the plane"][0])
    assert len(convert(face, "not measured").edge_use_face) == 0
    model = load(face, measure=True)
    assert model.edge_use_deviation == pytest.approx([HEIGHT, 0, 0], abs=1e-15)
    assert model.edge_use_face.tolist() == [0, 0, 0] and model.edge_use_tolerance == pytest.approx(1e-7)
    path = tmp_path / "triangle.brep"
    assert BRepTools.Write_s(face, str(path))
    assert cli.main(["info", str(path), "--faces"]) == 0
    text = capsys.readouterr().out
    assert "3 edge uses measured, at most 1.0e-02 mm from the curves that trim (face 0); 1 exceeds its" in text
    assert text.splitlines()[-1].split()[-3:] == ["1.0e-02", "mm", "1"]


def read_brep(path: str) -> TopoDS_Shape:
    if not (SHARED_MODELS / path).exists():
        pytest.skip(f"{SHARED_MODELS / path} is not there")
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, str(SHARED_MODELS / path), BRep_Builder())
    return shape


def test_edges_of_a_real_file_run_beside_their_pcurves() -> None:
    found = edge_deviations(read_brep("occt/MODERN_Sink_1.brep"))
    assert 1e-5 < found.distance.max() <= found.tolerance.max()


def test_a_peak_near_an_end_is_found() -> None:
    """Face 27 of the hammer: 2.48 mm at 1.8 % of a 10 m edge, three times its tolerance."""
    found = edge_deviations(read_brep("occt/hammer.brep"))
    assert found.face[found.distance.argmax()] == 27
    assert found.distance.max() == pytest.approx(2.4839, rel=1e-2)
