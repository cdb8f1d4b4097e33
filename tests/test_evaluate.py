"""Points, normals and curvatures of faces: closed forms, OpenCascade's own, placements, poles, wrong requests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import SHARED_MODELS, model_of, rectangle_group, sphere_group

pytest.importorskip("OCP")

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepLProp import BRepLProp_SLProps
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeOneAxis,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

import nofacet
from nofacet.cad.convert import convert
from nofacet.cad.measure import parameters
from nofacet.cad.read import read_file
from nofacet.model import Model
from test_surfaces import EXACT, bspline_surface, face_of

RADIUS, TUBE, HEIGHT, TOP = 5.0, 1.5, 7.0, 2.0
SLOPE = (RADIUS - TOP) / HEIGHT  # of the cone
OWN = Path(__file__).resolve().parents[1] / "cad_models"
FILES = [
    OWN / "flange.step",
    OWN / "bottle.step",
    *(SHARED_MODELS / name for name in ("nist/nist_ctc_02_asme1_rc.stp", "occt/linkrods.step", "occt/Ball.brep")),
]


@dataclass(frozen=True)
class ClosedForm:
    """A solid's curved face: from OpenCascade's (u, v) the position, the normal, and the two principal curvatures, that
    along the parallel circle first."""

    maker: Callable[[], BRepPrimAPI_MakeOneAxis]
    kind: str
    span: tuple[float, float]  # of v
    surface: Callable[[Any, Any], tuple[Any, Any, Any, Any]]


def ring(u: Any) -> Any:
    return np.stack([np.cos(u), np.sin(u), 0 * u], axis=-1)


def axis(v: Any) -> Any:
    return np.stack([0 * v, 0 * v, v], axis=-1)


def sphere_form(u: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    normal = np.cos(v)[..., None] * ring(u) + axis(np.sin(v))
    return RADIUS * normal, normal, 0 * u - 1 / RADIUS, 0 * u - 1 / RADIUS


def cylinder_form(u: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    return RADIUS * ring(u) + axis(v), ring(u), 0 * u - 1 / RADIUS, 0 * u


def cone_form(u: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    """v runs along the side; the radius shrinks from RADIUS to TOP."""
    flank = sqrt(1 + SLOPE**2)
    radius = RADIUS - v * SLOPE / flank
    position = radius[..., None] * ring(u) + axis(v / flank)
    return position, (ring(u) + axis(SLOPE + 0 * v)) / flank, -1 / (radius * flank), 0 * u


def torus_form(u: Any, v: Any) -> tuple[Any, Any, Any, Any]:
    normal = np.cos(v)[..., None] * ring(u) + axis(np.sin(v))
    return RADIUS * ring(u) + TUBE * normal, normal, -np.cos(v) / (RADIUS + TUBE * np.cos(v)), 0 * u - 1 / TUBE


FORMS = {
    "sphere": ClosedForm(lambda: BRepPrimAPI_MakeSphere(RADIUS), "sphere", (-1.5, 1.5), sphere_form),
    "cylinder": ClosedForm(lambda: BRepPrimAPI_MakeCylinder(RADIUS, HEIGHT), "cylinder", (0, HEIGHT), cylinder_form),
    "cone": ClosedForm(lambda: BRepPrimAPI_MakeCone(RADIUS, TOP, HEIGHT), "cone", (0, 7.6), cone_form),
    "torus": ClosedForm(lambda: BRepPrimAPI_MakeTorus(RADIUS, TUBE), "torus", (0, 2 * pi), torus_form),
}  # fmt: skip


def mirrored_and_moved() -> gp_Trsf:
    mirror, turn, move = gp_Trsf(), gp_Trsf(), gp_Trsf()
    mirror.SetMirror(gp_Ax2(gp_Pnt(1, 1, 1), gp_Dir(1, 0, 2)))
    turn.SetRotation(gp_Ax2(gp_Pnt(0, 2, 0), gp_Dir(1, 2, 3)).Axis(), 0.7)
    move.SetTranslation(gp_Vec(30, -20, 10))
    return move.Multiplied(turn).Multiplied(mirror)


def matrix_of(transformation: gp_Trsf) -> np.ndarray:
    return np.array([[transformation.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)])


@pytest.mark.parametrize("placed", [False, True], ids=["at the origin", "mirrored"])
@pytest.mark.parametrize("name", FORMS)
def test_closed_forms(name: str, placed: bool) -> None:
    form, place = FORMS[name], mirrored_and_moved() if placed else gp_Trsf()
    model = convert(form.maker().Shape().Moved(TopLoc_Location(place), False), name)
    face = [model.surface_type[d] for d in model.face_definition].index(form.kind)
    rng = np.random.default_rng(1)
    u, v = rng.uniform(0, 2 * pi, 500), rng.uniform(*form.span, 500)
    found = nofacet.evaluate(model, np.full(500, face), np.column_stack([u, v]))

    position, normal, around, along = form.surface(u, v)
    matrix = matrix_of(place)
    np.testing.assert_allclose(found.position, position @ matrix[:, :3].T + matrix[:, 3], atol=1e-12 * 40)
    np.testing.assert_allclose(found.normal, normal @ matrix[:, :3].T, atol=2e-14)
    curvatures = np.sort(np.stack([around, along], axis=1), axis=1)[:, ::-1]
    beside_pole = 1 / np.cos(v) ** 2 if name == "sphere" else np.ones(500)  # where digits are lost
    assert (np.abs(found.principal_curvatures - curvatures) <= 1e-13 * beside_pole[:, None]).all()
    assert (np.abs(found.mean_curvature - curvatures.mean(axis=1)) <= 1e-13 * beside_pole).all()
    assert (np.abs(found.gaussian_curvature - around * along) <= 1e-13 * beside_pole).all()

    first, second = found.principal_directions[:, 0], found.principal_directions[:, 1]
    np.testing.assert_allclose(np.cross(first, second), found.normal, atol=1e-14)
    if name != "sphere":  # elsewhere the two differ, and one runs along the parallel circle
        circle = np.where((around > along)[:, None], first, second)
        tangent = np.stack([-np.sin(u), np.cos(u), 0 * u], axis=1) @ matrix[:, :3].T
        np.testing.assert_allclose(np.abs(np.sum(circle * tangent, axis=1)), 1, atol=1e-12)


def test_a_hole_bends_towards_its_normal() -> None:
    cq = pytest.importorskip("cadquery")
    model = nofacet.load(cq.Workplane().box(10, 10, 2).faces(">Z").hole(4))
    face = [model.surface_type[d] for d in model.face_definition].index("cylinder")
    found = nofacet.evaluate(model, [face], [[0.3, 1.0]])
    np.testing.assert_allclose(found.principal_curvatures, [[0.5, 0.0]], atol=1e-15)
    np.testing.assert_allclose(found.normal[0] @ [*found.position[0, :2], 0], -2)  # out of the material: inwards


def faces_of(shape: TopoDS_Shape) -> list[TopoDS_Face]:
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, found)
    return [TopoDS.Face_s(found.FindKey(k)) for k in range(1, found.Extent() + 1)]


def samples(model: Model, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random faces (n,) and parameters (n, 2) in the middle of random patches of each, `count` for each group."""
    rng = np.random.default_rng(seed)
    faces, uv = [], []
    for group in model.groups:
        which = rng.integers(len(group.definition), size=count)
        u, v = parameters(group, which, 33)
        at = rng.integers(4, 29, (2, count))
        uv.append(np.stack([u[np.arange(count), at[0]], v[np.arange(count), at[1]]], axis=1))
        faces += [rng.choice(np.flatnonzero(model.face_definition == d)) for d in group.definition[which]]
    return np.array(faces), np.concatenate(uv)


def check_against_opencascade(shape: TopoDS_Shape, model: Model, count: int) -> None:
    """Position, normal and both curvatures of BRepLProp_SLProps, whose normal is Su x Sv.

    All within what is promised; where patches are not slivers cut off at a knot, to far more digits.
    """
    faces, uv = samples(model, count, 2)
    found = nofacet.evaluate(model, faces, uv)
    size = np.ptp(found.position, axis=0).max()
    shapes, turned, bent = faces_of(shape), [], []
    for k, (face, (u, v)) in enumerate(zip(faces, uv, strict=True)):
        theirs = BRepLProp_SLProps(BRepAdaptor_Surface(shapes[face], False), float(u), float(v), 2, 1e-12)
        point = theirs.Value()
        np.testing.assert_allclose(found.position[k], [point.X(), point.Y(), point.Z()], atol=1e-12 * size)
        if not theirs.IsNormalDefined() or not theirs.IsCurvatureDefined():
            continue
        sense = -1 if shapes[face].Orientation() == TopAbs_REVERSED else 1
        normal = theirs.Normal()
        turned.append(np.abs(found.normal[k] - sense * np.array([normal.X(), normal.Y(), normal.Z()])).max())
        expected = sense * np.array([theirs.MaxCurvature(), theirs.MinCurvature()])[::sense]
        error = np.abs(found.principal_curvatures[k] - expected).max()
        bent.append(error / max(np.abs(expected).max(), 1 / size))
    assert len(bent) > 0.9 * len(faces)
    assert np.quantile(turned, 0.95) < 1e-11 and np.max(turned) < 1e-4
    assert np.mean(np.isnan(bent)) < 0.02
    assert np.nanquantile(bent, 0.9) < 1e-10 and np.nanmax(bent) < 1e-4


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_files_against_opencascade(path: Path) -> None:
    if not path.exists():
        pytest.skip("the shared test models are not beside the repository")
    shape = read_file(str(path)).shape
    check_against_opencascade(shape, convert(shape, path.name), 150)


@pytest.mark.parametrize("name", [name for name in EXACT if name != "spindle torus"])
def test_surfaces_against_opencascade(name: str) -> None:
    make, box = EXACT[name]
    face = face_of(make(), *box)
    check_against_opencascade(face, convert(face, name), 60)


def test_instances_are_where_they_are_placed() -> None:
    """One definition, placed twice: mirrored, its normal still leaves the material."""
    mirror = np.diag([1.0, 1.0, -1.0, 1.0])
    mirror[:3, 3] = 5, 0, 20
    model = replace(
        model_of([sphere_group(2.0)]),
        placements=np.stack([np.eye(4), mirror]),
        face_definition=np.zeros(2, np.int32),
        face_placement=np.arange(2, dtype=np.int32),
        face_outward=np.array([1, -1], np.int8),
    )
    found = nofacet.evaluate(model, [0, 1], [[0.4, 0.6], [0.4, 0.6]])
    direction = np.array([cos(0.6) * cos(0.4), cos(0.6) * sin(0.4), sin(0.6)])
    np.testing.assert_allclose(found.position, [2 * direction, 2 * direction * [1, 1, -1] + [5, 0, 20]], atol=1e-14)
    np.testing.assert_allclose(found.normal, [direction, direction * [1, 1, -1]], atol=1e-14)
    np.testing.assert_allclose(found.principal_curvatures, -0.5, atol=1e-14)


@pytest.mark.parametrize("v", [pi / 2, -pi / 2])
def test_poles_of_a_sphere(v: float) -> None:
    model = convert(BRepPrimAPI_MakeSphere(RADIUS).Shape(), "sphere")
    u = np.linspace(0, 2 * pi, 9)
    found = nofacet.evaluate(model, np.zeros(9, int), np.column_stack([u, np.full(9, v)]))
    up = np.sign(v) * np.array([0, 0, 1])
    np.testing.assert_allclose(found.position, np.tile(RADIUS * up, (9, 1)), atol=1e-14)
    np.testing.assert_allclose(found.normal, np.tile(up, (9, 1)), atol=1e-12)
    assert np.isnan(found.principal_curvatures).all() and np.isnan(found.principal_directions).all()
    beside = nofacet.evaluate(model, np.zeros(9, int), np.column_stack([u, np.full(9, v * (1 - 1e-3))]))
    np.testing.assert_allclose(beside.principal_curvatures, -1 / RADIUS, rtol=1e-9)


def test_tip_of_a_cone() -> None:
    model = convert(BRepPrimAPI_MakeCone(RADIUS, 0.0, HEIGHT).Shape(), "cone")
    face = [model.surface_type[d] for d in model.face_definition].index("cone")
    tip = sqrt(RADIUS**2 + HEIGHT**2)
    found = nofacet.evaluate(model, [face, face], [[0.5, tip], [0.5 + pi, tip]])
    np.testing.assert_allclose(found.position, np.tile([0, 0, HEIGHT], (2, 1)), atol=1e-14)
    normal = np.array(
        [[HEIGHT * cos(0.5), HEIGHT * sin(0.5), RADIUS], [-HEIGHT * cos(0.5), -HEIGHT * sin(0.5), RADIUS]]
    )
    np.testing.assert_allclose(found.normal, normal / tip, atol=1e-12)
    assert np.isnan(found.principal_curvatures).all()


def test_a_patch_with_no_area_has_no_normal() -> None:
    point = model_of([rectangle_group(np.ones((2, 2, 3)))])
    found = nofacet.evaluate(point, [0], [[0.5, 0.5]])
    np.testing.assert_array_equal(found.position, [[1, 1, 1]])
    assert np.isnan(found.normal).all() and np.isnan(found.principal_curvatures).all()


def test_slender_patches_are_no_poles() -> None:
    """A wire a million times longer than thick."""
    model = convert(BRepPrimAPI_MakeCylinder(1e-3, 1e3).Shape(), "wire")
    face = [model.surface_type[d] for d in model.face_definition].index("cylinder")
    found = nofacet.evaluate(model, [face], [[1.0, 500.0]])
    np.testing.assert_allclose(found.principal_curvatures, [[0, -1000]], atol=1e-9)
    np.testing.assert_allclose(found.normal, [[cos(1), sin(1), 0]], atol=1e-12)


def test_every_turn_of_an_angle_is_the_same_point() -> None:
    model = convert(BRepPrimAPI_MakeTorus(RADIUS, TUBE).Shape(), "torus")
    turns = 2 * pi * np.array([[0, 0], [1, 0], [-3, 0], [0, 2], [5, -1]])
    found = nofacet.evaluate(model, np.zeros(5, int), np.array([1.0, 2.0]) + turns)
    np.testing.assert_allclose(found.position, np.tile(found.position[0], (5, 1)), atol=1e-13)
    np.testing.assert_allclose(found.principal_curvatures, np.tile(found.principal_curvatures[0], (5, 1)), atol=1e-13)


def test_order_does_not_matter_at_knots() -> None:
    """Curvature jumps at a knot; the patch behind it answers, whatever was asked before."""
    surface: Geom_BSplineSurface = bspline_surface()
    model = convert(face_of(surface, 0, 3, -1, 4), "bspline")
    uv = np.array([[0.5, 0.0], [1.0, 0.5], [2.9, 3.0], [1.0, 0.5], [2.5, 0.5], [0.2, 0.5]])
    forwards = nofacet.evaluate(model, np.zeros(6, int), uv)
    backwards = nofacet.evaluate(model, np.zeros(6, int), uv[::-1])
    np.testing.assert_array_equal(forwards.principal_curvatures, backwards.principal_curvatures[::-1])
    np.testing.assert_array_equal(forwards.principal_curvatures[1], forwards.principal_curvatures[3])


def test_a_whole_frame_at_once(sphere: Model) -> None:
    camera = nofacet.Camera.fit(sphere, resolution=(64, 48))
    frame = nofacet.render(sphere, camera, (64, 48), buffers=("face", "uv", "depth", "normal"))
    found = nofacet.evaluate(sphere, frame.face, frame.uv)
    seen = frame.face >= 0
    assert found.position.shape == (48, 64, 3) and found.principal_directions.shape == (48, 64, 2, 3)
    assert found.mean_curvature.shape == found.gaussian_curvature.shape == (48, 64)
    np.testing.assert_allclose(found.position[seen], frame.position[seen], atol=1e-11)
    np.testing.assert_allclose(found.normal[seen], frame.normal[seen], atol=1e-6)
    np.testing.assert_allclose(found.gaussian_curvature[seen], 1, atol=1e-10)
    assert np.isnan(found.position[~seen]).all() and np.isnan(found.normal[~seen]).all()


def test_what_is_nowhere_is_nan(sphere: Model) -> None:
    found = nofacet.evaluate(sphere, [-1, 0, 0, 0], np.array([[0, 0], [np.nan, 0], [0, np.inf], [1, 1]]))
    assert np.isnan(found.position).all(axis=1).tolist() == [True, True, True, False]
    bare = replace(sphere, groups=[])
    assert np.isnan(nofacet.evaluate(bare, [0], [[1, 1]]).normal).all()
    assert nofacet.evaluate(sphere, [], np.empty((0, 2))).position.shape == (0, 3)


def test_caps_of_section_planes_are_no_faces(sphere: Model) -> None:
    found = nofacet.evaluate(sphere, [-2, 0, -17, -1], np.array([[np.nan, np.nan], [1, 1], [0, 0], [0, 0]]))
    assert np.isnan(found.position).all(axis=1).tolist() == [True, False, True, True]
    assert np.isfinite(nofacet.evaluate(sphere, np.array([0], np.uint8), [[1, 1]]).normal).all()
    far_below = np.array([-(2**32), -(2**63)])
    assert np.isnan(nofacet.evaluate(sphere, far_below, [[0, 0], [0, 0]]).position).all()


@pytest.mark.parametrize(
    ("face", "uv", "message"),
    [
        ([0, 0], [[0, 0]], r"for face \(n,\) uv must be \(n, 2\)"),
        ([0], [0, 0], r"uv must be \(n, 2\)"),
        ([0.5], [[0, 0]], "must be indices"),
        ([1], [[0, 0]], "face 1: the model has faces 0 to 0"),
        (np.array([2**32]), [[0, 0]], "face 4294967296: the model has faces 0 to 0"),
        (np.array([2**63], np.uint64), [[0, 0]], "face 9223372036854775808: the model has"),
    ],
)
def test_requests_that_make_no_sense(face: Any, uv: Any, message: str, sphere: Model) -> None:
    with pytest.raises(ValueError, match=message):
        nofacet.evaluate(sphere, face, uv)
