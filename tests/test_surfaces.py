"""Patches lie on OpenCascade's surfaces at OpenCascade's own parameters, to rounding."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from conftest import SHARED_MODELS

pytest.importorskip("OCP")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeTorus
from OCP.BRepTools import BRepTools
from OCP.Geom import (
    Geom_BezierSurface,
    Geom_BSplineCurve,
    Geom_BSplineSurface,
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_Ellipse,
    Geom_Hyperbola,
    Geom_Line,
    Geom_OffsetSurface,
    Geom_Parabola,
    Geom_Plane,
    Geom_RectangularTrimmedSurface,
    Geom_SphericalSurface,
    Geom_Surface,
    Geom_SurfaceOfLinearExtrusion,
    Geom_SurfaceOfRevolution,
    Geom_ToroidalSurface,
)
from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopAbs import TopAbs_OUT
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from nofacet.cad import measure
from nofacet.cad.bspline import curve_pieces
from nofacet.cad.convert import convert
from nofacet.model import Model

AXES = gp_Ax3(gp_Pnt(3, -2, 7), gp_Dir(1, 2, 3), gp_Dir(2, -1, 0))
LEFT_HANDED = gp_Ax3(AXES.Ax2())
LEFT_HANDED.YReverse()
AX2 = AXES.Ax2()


def face_of(surface: Geom_Surface, *box: float) -> TopoDS_Face:
    return BRepBuilderAPI_MakeFace(surface, *box, 1e-7).Face()


def size_of(model: Model) -> float:
    points = np.concatenate(
        [(g.control_points[..., :3] / g.control_points[..., 3:]).reshape(-1, 3) for g in model.groups]
    )
    return float(np.ptp(points, axis=0).max())


def reals(values: np.ndarray) -> TColStd_Array1OfReal:
    result = TColStd_Array1OfReal(1, len(values))
    for k, value in enumerate(values, 1):
        result.SetValue(k, float(value))
    return result


def integers(values: list[int]) -> TColStd_Array1OfInteger:
    result = TColStd_Array1OfInteger(1, len(values))
    for k, value in enumerate(values, 1):
        result.SetValue(k, value)
    return result


def pole_grid(nu: int, nv: int, seed: int) -> tuple[TColgp_Array2OfPnt, TColStd_Array2OfReal]:
    rng = np.random.default_rng(seed)
    poles, weights = TColgp_Array2OfPnt(1, nu, 1, nv), TColStd_Array2OfReal(1, nu, 1, nv)
    for i in range(nu):
        for j in range(nv):
            x, y, z = np.array([10 * i, 10 * j, 0]) + rng.normal(size=3)
            poles.SetValue(i + 1, j + 1, gp_Pnt(x, y, z))
            weights.SetValue(i + 1, j + 1, float(rng.uniform(0.5, 2)))
    return poles, weights


def bspline_surface(periodic: bool = False) -> Geom_BSplineSurface:
    """Rational, degree 3 with a C0 knot by degree 2; or periodic in u with a double first knot."""
    v_knots, v_multiplicities = reals(np.array([-1.0, 0.5, 4.0])), integers([3, 1, 3])
    if periodic:
        poles, weights = pole_grid(7, 4, 2)
        u_knots, u_multiplicities = reals(np.array([0.0, 1.0, 1.5, 3.0, 4.0, 6.0])), integers([2, 1, 2, 1, 1, 2])
    else:
        poles, weights = pole_grid(8, 4, 1)
        u_knots, u_multiplicities = reals(np.array([0.0, 1.0, 2.5, 3.0])), integers([4, 3, 1, 4])
    return Geom_BSplineSurface(
        poles, weights, u_knots, v_knots, u_multiplicities, v_multiplicities, 3, 2, periodic, False
    )


def bspline_curve() -> Geom_BSplineCurve:
    poles = TColgp_Array1OfPnt(1, 6)
    for k, (x, z) in enumerate([(4, 0), (6, 1), (5, 3), (7, 4), (6, 6), (8, 9)], 1):
        poles.SetValue(k, gp_Pnt(x, 1, z))
    return Geom_BSplineCurve(poles, reals(np.array([0.0, 1.0, 3.0])), integers([4, 2, 4]), 3)


def revolution(curve: object) -> Geom_SurfaceOfRevolution:
    return Geom_SurfaceOfRevolution(curve, gp_Ax1(gp_Pnt(0, 0, 1), gp_Dir(0, 0.1, 1)))


def extrusion(curve: object) -> Geom_SurfaceOfLinearExtrusion:
    return Geom_SurfaceOfLinearExtrusion(curve, gp_Dir(1, 1, 4))


EXACT: dict[str, tuple[Callable[[], Geom_Surface], tuple[float, ...]]] = {
    "plane": (lambda: Geom_Plane(LEFT_HANDED), (-3, 2, 1, 9)),
    "cylinder": (lambda: Geom_CylindricalSurface(AXES, 2.0), (0, 2 * pi, -1, 4)),
    "cylinder beyond its period": (lambda: Geom_CylindricalSurface(LEFT_HANDED, 2.0), (5.0, 8.0, -1, 4)),
    "cone through its tip": (lambda: Geom_ConicalSurface(AXES, 0.5, 1.0), (0.3, 4.0, -3, 4)),
    "sphere": (lambda: Geom_SphericalSurface(LEFT_HANDED, 3.0), (0, 2 * pi, -pi / 2, pi / 2)),
    "torus": (lambda: Geom_ToroidalSurface(AXES, 5.0, 2.0), (0, 2 * pi, 0, 2 * pi)),
    "spindle torus": (lambda: Geom_ToroidalSurface(LEFT_HANDED, 1.0, 2.0), (0, 2 * pi, 1, 5)),
    "part of a bezier": (lambda: Geom_BezierSurface(*pole_grid(4, 5, 5)), (0.2, 0.9, 0.5, 0.6)),
    "rational bspline with a kink": (bspline_surface, (0, 3, -1, 4)),
    "part of a bspline": (bspline_surface, (0.9, 2.9, -0.5, 0.6)),
    "periodic bspline": (lambda: bspline_surface(True), (0, 6, -1, 4)),
    "periodic bspline across its period": (lambda: bspline_surface(True), (4.5, 8.0, -1, 4)),
    "trimmed sphere": (
        lambda: Geom_RectangularTrimmedSurface(Geom_SphericalSurface(AXES, 3.0), 1.0, 2.0, -1.0, 0.5),
        (1, 2, -1, 0.5),
    ),
    "revolved bspline": (lambda: revolution(bspline_curve()), (1, 6, 0.5, 3)),
    "revolved circle": (lambda: revolution(Geom_Circle(AX2, 2.0)), (0, 2 * pi, 0, 5)),
    "revolved line": (lambda: revolution(Geom_Line(gp_Pnt(3, 1, 0), gp_Dir(1, 1, 5))), (0, 2 * pi, -3, 5)),
    "revolved parabola": (lambda: revolution(Geom_Parabola(AX2, 0.7)), (0, 3, -2, 3)),
    "extruded ellipse": (lambda: extrusion(Geom_Ellipse(AX2, 4.0, 1.0)), (0, 2 * pi, -1, 6)),
    "extruded bspline": (lambda: extrusion(bspline_curve()), (0, 3, -1, 6)),
}


@pytest.mark.parametrize("name", EXACT)
def test_patches_are_exact_at_opencascades_parameters(name: str) -> None:
    make, box = EXACT[name]
    face = face_of(make(), *box)
    model = convert(face, name)
    assert model.warnings == [] and model.trimmed.tolist() == [0]
    errors = measure.conversion_errors(face, model)
    assert errors.max() <= 1e-13 * size_of(model)
    assert all(group.control_points[..., 3].min() > 0 for group in model.groups)


def test_degree_25_is_exact_where_opencascades_cached_evaluation_is_not() -> None:
    """BRepAdaptor_Surface evaluates a Taylor polynomial of the whole patch: here 2e-4 off, and exact fractions agree
    with Geom_Surface.Value and with us. So this one is compared with the latter."""
    surface = Geom_BezierSurface(*pole_grid(26, 3, 5))
    model = convert(face_of(surface, 0, 1, 0, 1), "degree 25")
    (group,) = model.groups
    assert group.degree == (25, 2)
    ours = measure.evaluate(group, np.array([0]), 9)[0]
    for i, u in enumerate(np.linspace(0, 1, 9)):
        for j, v in enumerate(np.linspace(0, 1, 9)):
            point = surface.Value(float(u), float(v))
            np.testing.assert_allclose(ours[i, j], (point.X(), point.Y(), point.Z()), atol=1e-12)


@pytest.mark.parametrize("name", EXACT)
def test_patches_tile_the_faces_box(name: str) -> None:
    make, box = EXACT[name]
    model = convert(face_of(make(), *box), name)
    domain = np.concatenate([group.domain for group in model.groups])
    np.testing.assert_allclose([*domain.min(axis=0)[::2], *domain.max(axis=0)[1::2]], np.array(box)[[0, 2, 1, 3]])
    area = ((domain[:, 1] - domain[:, 0]) * (domain[:, 3] - domain[:, 2])).sum()
    assert area == pytest.approx((box[1] - box[0]) * (box[3] - box[2]))
    angular = np.concatenate([group.angular for group in model.groups]).astype(bool)
    spans = np.stack([domain[:, 1] - domain[:, 0], domain[:, 3] - domain[:, 2]], axis=1)
    assert (spans[angular] <= 100.001 * pi / 180).all()


@pytest.mark.parametrize(
    "name, make, box",
    [
        ("offset", lambda: Geom_OffsetSurface(extrusion(bspline_curve()), 0.4), (0, 3, 0, 5)),
        ("offset", lambda: Geom_OffsetSurface(Geom_BezierSurface(*pole_grid(4, 4, 3)), -0.7), (0, 1, 0, 1)),
        ("revolution", lambda: revolution(Geom_Hyperbola(AX2, 2.0, 1.0)), (0, 2, -1, 1.5)),
    ],
)
def test_surfaces_that_are_not_rational_carry_their_measured_error(
    name: str, make: Callable[[], Geom_Surface], box: tuple[float, ...]
) -> None:
    face = face_of(make(), *box)
    model = convert(face, name)
    assert model.warnings == [] and model.surface_type == [name]
    assert model.conversion_error[0] <= 1e-9 * size_of(model)
    assert measure.conversion_errors(face, model)[0] <= 3 * model.conversion_error[0]


@pytest.mark.parametrize(
    "path", ["occt/Ball.brep", "aero/resultShape.brep", "parts/test.brep", "occt/MODERN_Sink_1.brep"]
)
def test_real_files_are_exact(path: str) -> None:
    if not (SHARED_MODELS / path).exists():
        pytest.skip(f"{SHARED_MODELS / path} is not there")
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, str(SHARED_MODELS / path), BRep_Builder())
    model = convert(shape, path)
    assert model.warnings == []
    assert measure.conversion_errors(shape, model).max() <= 1e-12 * size_of(model)


def test_outward_is_out_of_the_material_also_when_reversed_mirrored_or_moved() -> None:
    mirror = gp_Trsf()
    mirror.SetMirror(gp_Ax2(gp_Pnt(1, 1, 1), gp_Dir(1, 0, 2)))
    for maker in (
        BRepPrimAPI_MakeBox(1.0, 2.0, 3.0),
        BRepPrimAPI_MakeCylinder(LEFT_HANDED.Ax2(), 1.0, 2.0),
        BRepPrimAPI_MakeTorus(3.0, 1.0),
    ):
        solid = maker.Shape()
        plain = convert(solid, "solid")
        mirrored = convert(solid.Moved(TopLoc_Location(mirror), False), "mirrored")
        np.testing.assert_array_equal(mirrored.face_outward, -plain.face_outward)
        classifier = BRepClass3d_SolidClassifier(solid)
        for group in plain.groups:
            points = measure.evaluate(group, np.arange(len(group.definition)), 5)
            along_u, along_v = points[:, 3, 2] - points[:, 1, 2], points[:, 2, 3] - points[:, 2, 1]
            normal = np.cross(along_u, along_v)
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            normal *= plain.face_outward[group.definition][:, None]  # each definition is placed once
            for point in points[:, 2, 2] + 1e-3 * normal:
                classifier.Perform(gp_Pnt(*map(float, point)), 1e-9)
                assert classifier.State() == TopAbs_OUT


def de_boor(degree: int, flat: np.ndarray, poles: np.ndarray, t: float) -> np.ndarray:
    """The textbook's slow evaluation of a B-spline, one parameter, the end spans continued outside the domain."""
    span = int(np.clip(np.searchsorted(flat, t, side="right") - 1, degree, len(poles) - 1))
    points = poles[span - degree : span + 1].copy()
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            low, high = flat[span - degree + j], flat[span + 1 + j - level]
            points[j] = points[j - 1] + (t - low) / (high - low) * (points[j] - points[j - 1])
    return points[degree]


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_bezier_pieces_of_a_bspline_are_the_bspline(data: st.DataObject) -> None:
    degree = data.draw(st.integers(1, 9))
    steps = data.draw(st.lists(st.floats(1e-3, 3.0), min_size=1, max_size=5))
    inner = data.draw(st.lists(st.integers(1, degree), min_size=len(steps) - 1, max_size=len(steps) - 1))
    knots = np.cumsum([0.5, *steps])
    multiplicities = np.array([degree + 1, *inner, degree + 1], np.int32)
    count = int(multiplicities.sum()) - degree - 1
    poles = np.random.default_rng(data.draw(st.integers(0, 99))).normal(size=(count, 2))
    width = knots[-1] - knots[0]
    low = knots[0] + width * data.draw(st.floats(-0.01, 0.6))
    high = low + width * data.draw(st.floats(0.05, 0.41))
    points, cuts = curve_pieces(degree, poles, knots, multiplicities, False, low, high)
    assert cuts[0] == low and cuts[-1] == high and (np.diff(cuts) > 0).all()
    flat = np.repeat(knots, multiplicities)
    for piece, a, b in zip(points, cuts, cuts[1:], strict=False):
        for s in (0.01, 0.37, 0.99):
            level = piece
            while len(level) > 1:
                level = (1 - s) * level[:-1] + s * level[1:]
            np.testing.assert_allclose(level[0], de_boor(degree, flat, poles, a + s * (b - a)), atol=1e-9, rtol=1e-9)


def test_offset_that_cannot_be_approximated_well_is_named() -> None:
    """An offset beyond the radius of curvature folds back on itself; no spline of the promised quality follows it."""
    points = TColgp_Array2OfPnt(1, 9, 1, 9)
    for i in range(9):
        for j in range(9):
            points.SetValue(i + 1, j + 1, gp_Pnt(i, j, 0.8 * (i % 3) * (j % 2)))
    wavy = GeomAPI_PointsToBSplineSurface(points).Surface()
    face = BRepBuilderAPI_MakeFace(Geom_OffsetSurface(wavy, 2.0), 1e-7).Face()
    model = convert(face, "made here")
    assert model.conversion_error[0] > 1e-8
    assert len(model.warnings) == 1
    assert model.warnings[0].startswith("face 0 (offset): its surface is approximated, and only to within ")
