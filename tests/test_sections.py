"""Section planes: what they leave, where their caps are, and what they say of what cannot be capped."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape

import nofacet
from conftest import SHARED_MODELS, model_of, rectangle_group
from nofacet import Section
from nofacet.camera import Projection
from nofacet.extent import bounding_box
from nofacet.model import Model
from scenes import Array, extended_rays, look_down

RESOLUTION = (160, 120)
VALUES = ("depth", "face", "normal", "uv")
FLANGE = Path(__file__).resolve().parents[1] / "cad_models" / "flange.step"
ASSEMBLY = SHARED_MODELS / "cax" / "as1-oc-214.stp"


def looking_along(section: Section, centre: Array, height: float, projection: str = "orthographic") -> nofacet.Camera:
    """Head-on, from the side that is cut away, `height` model units from bottom to top."""
    normal = np.array(section.normal)
    up = (0, 0, 1) if abs(normal[2]) < 0.9 else (0, 1, 0)
    eye, target = tuple(centre + 3 * height * normal), tuple(centre)
    if projection == "orthographic":
        return nofacet.Camera("orthographic", eye, target, up, view_height=height)
    return nofacet.Camera("perspective", eye, target, up, view_angle=float(np.degrees(2 * np.arctan(1 / 6))))


def cut_area(model: Model, section: Section, resolution: int = 400) -> float:
    """Area of the model's cut: the coverage of a slab far thinner than any pixel, seen head-on."""
    low, high = bounding_box(model)
    size = float(np.linalg.norm(high - low))
    normal = np.array(section.normal)
    centre = (low + high) / 2
    centre = centre - normal * ((centre - section.origin) @ normal)
    below = Section(tuple(np.array(section.origin) - 1e-8 * size * normal), tuple(-normal))
    camera = looking_along(section, centre, 1.02 * size)
    frame = nofacet.render(model, camera, (resolution, resolution), samples=16, buffers=("coverage",),
                           sections=[section, below])  # fmt: skip
    assert frame.stats["unresolved"] == 0
    return float(frame.coverage.sum(dtype=float)) * (1.02 * size / resolution) ** 2


def test_a_section_has_a_unit_normal_and_refuses_nonsense() -> None:
    assert Section((1, 2, 3), (0, 0, 1e300)).normal == (0, 0, 1)
    assert Section((1, 2, 3), (3, 0, 4)).normal == pytest.approx((0.6, 0, 0.8), rel=1e-15)
    with pytest.raises(ValueError, match="the normal is 0, 0, 0"):
        Section((0, 0, 0), (0, 0, 0))
    with pytest.raises(ValueError, match="three finite numbers"):
        Section((0, 0, float("nan")), (0, 0, 1))
    with pytest.raises(ValueError, match="three finite numbers"):
        Section((0, 0), (0, 0, 1))  # type: ignore[arg-type]


SPHERE = cq.Workplane().sphere(5).val()
CYLINDER = cq.Workplane().circle(4).extrude(10).val()
TORUS = cq.Solid.makeTorus(6, 2)
SLANTED = (0.3, -0.4, 0.8)
AREAS = {
    "sphere": (SPHERE, (0, 0, 3), (0, 0, 1), np.pi * 16),
    "sphere, slanted": (SPHERE, (0, 0, 0), SLANTED, np.pi * 25),
    "cylinder, lengthwise": (CYLINDER, (1, 0, 0), (-1, 0, 0), 10 * 2 * np.sqrt(15)),
    "cylinder, ellipse": (CYLINDER, (0, 0, 5), SLANTED, np.pi * 16 * np.linalg.norm(SLANTED) / 0.8),
    "torus, two discs": (TORUS, (0, 0, 0), (0, 1, 0), 2 * np.pi * 4),
    "torus, ring": (TORUS, (0, 0, 1), (0, 0, 1), np.pi * 4 * 6 * np.sqrt(3)),
    # Where a plane touches the torus twice from inside, it cuts it in two circles of the large radius (Villarceau),
    # 4 apart: what one of their discs covers, and not both.
    "torus, two circles": (
        TORUS,
        (0, 0, 0),
        (0, 1 / 3, np.sqrt(8) / 3),
        2 * (36 * np.pi - 72 * np.arccos(1 / 3) + 2 * np.sqrt(144 - 16)),
    ),
}


@pytest.mark.parametrize("case", AREAS)
def test_the_area_of_the_cut_of_simple_solids(case: str) -> None:
    shape, origin, normal, area = AREAS[case]
    assert cut_area(nofacet.load(shape), Section(origin, normal)) == pytest.approx(area, rel=3e-5)


def occ_area(shape: TopoDS_Shape, section: Section, size: float) -> float:
    """OpenCascade's area of the cut through every solid of a shape."""
    plane = gp_Pln(gp_Pnt(*section.origin), gp_Dir(*section.normal))
    face = BRepBuilderAPI_MakeFace(plane, -size, size, -size, size).Face()
    area, explorer = 0.0, TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    while explorer.More():
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(BRepAlgoAPI_Common(explorer.Current(), face).Shape(), properties, 1e-9)
        area += properties.Mass()
        explorer.Next()
    return area


@pytest.mark.parametrize("normal", [(1, 0, 0), (0, 1, 0), (0, 0, 1), SLANTED])
@pytest.mark.parametrize("path", [FLANGE, ASSEMBLY], ids=["flange", "assembly"])
def test_the_area_of_the_cut_is_opencascades(path: Path, normal: tuple[float, float, float]) -> None:
    if not path.exists():
        pytest.skip("the shared test models are not beside the repository")
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    model = nofacet.load(path)
    low, high = bounding_box(model)
    section = Section(tuple(low + (high - low) * [0.47, 0.55, 0.39]), normal)
    expected = occ_area(reader.OneShape(), section, float(np.linalg.norm(high - low)))
    # Parts of the assembly that touch share no area, so that the cuts' areas add up.
    assert cut_area(model, section, 1000) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_every_pixel_of_a_cut_sphere(projection: str) -> None:
    section = Section((0.3, 0.2, 0.4), (0.4, -0.3, 1))
    model = nofacet.load(SPHERE)
    camera = looking_along(Section((0, 0, 0), (0.2, 0.1, 1)), np.zeros(3), 11.0, projection)
    frame = nofacet.render(model, camera, RESOLUTION, buffers=VALUES, sections=[section])
    y, x = np.indices(RESOLUTION[::-1]) + 0.5
    origin, direction = (rays.astype(float) for rays in extended_rays(camera, RESOLUTION, x.ravel(), y.ravel()))
    a, b = (direction * direction).sum(1), (origin * direction).sum(1)
    discriminant = b * b - a * ((origin * origin).sum(1) - 25)
    root = np.sqrt(np.maximum(discriminant, 0))
    enters, leaves = (-b - root) / a, (-b + root) / a
    normal = np.array(section.normal)
    along, distance = direction @ normal, (origin - section.origin) @ normal
    plane = -distance / along  # the rays come from the side that is cut away
    depth = np.where(enters > plane, enters, np.where(leaves > plane, plane, np.inf))
    depth = np.where(discriminant < 0, np.inf, depth)
    cap = np.isfinite(depth) & (depth == plane)
    shown = frame.depth.ravel()
    assert np.array_equal(np.isfinite(shown), np.isfinite(depth))
    assert np.abs(shown[np.isfinite(depth)] - depth[np.isfinite(depth)]).max() < 1e-9
    assert np.array_equal(frame.face.ravel() == -2, cap)
    assert np.abs((frame.position.reshape(-1, 3)[cap] - section.origin) @ normal).max() < 1e-12 * 10
    assert np.abs(frame.normal.reshape(-1, 3)[cap] - normal).max() < 1e-6
    assert np.isnan(frame.uv.reshape(-1, 2)[cap]).all() and not np.isnan(frame.uv.reshape(-1, 2)[~cap]).any()
    again = nofacet.render(model, camera, RESOLUTION, buffers=VALUES, sections=[section], threads=3)
    assert all(np.array_equal(getattr(frame, name), getattr(again, name), equal_nan=True) for name in VALUES)


def box_model(*corner: float) -> Model:
    return nofacet.load(cq.Workplane().box(*corner, centered=False).val())


def test_several_planes_cut_a_corner_out_of_each_other() -> None:
    model = box_model(10, 10, 10)
    planes = [Section((6, 0, 0), (1, 0, 0)), Section((0, 7, 0), (0, 1, 0)), Section((0, 0, 8), (0, 0, 1))]
    frame = nofacet.render(model, look_down(12, (5, 5, 5)), (120, 120), samples=16,
                           buffers=("coverage", "face", "depth"), sections=planes)  # fmt: skip
    assert frame.coverage.sum(dtype=float) * 0.01 == pytest.approx(42, rel=1e-5)
    assert set(np.unique(frame.face)) == {-4, -1}  # the top is the third plane's cap
    camera = nofacet.Camera.fit(model, direction=(-1, -1, -1), resolution=RESOLUTION)
    frame = nofacet.render(model, camera, RESOLUTION, buffers=("face", "depth"), sections=planes)
    assert set(np.unique(frame.face)) == {-4, -3, -2, -1}
    for number, plane in enumerate(planes):
        off = (frame.position[frame.face == -2 - number] - plane.origin) @ np.array(plane.normal)
        assert np.abs(off).max() < 1e-12 * 10


def test_planes_in_and_beside_planar_faces() -> None:
    model, camera = box_model(10, 10, 10), look_down(12, (5, 5, 5))

    def shown(*planes: Section) -> tuple[float, set[int]]:
        frame = nofacet.render(model, camera, (60, 60), samples=8, buffers=("coverage", "face"), sections=planes)
        return float(frame.coverage.sum(dtype=float)) * 0.04, set(np.unique(frame.face).tolist())

    up, down = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
    top = next(iter(shown()[1] - {-1}))
    assert shown(Section((0, 0, 10.1), up)) == (pytest.approx(100, rel=1e-6), {-1, top})  # misses
    assert shown(Section((0, 0, 10), up)) == (pytest.approx(100, rel=1e-6), {-1, -2})  # in the top: its cap
    assert shown(Section((0, 0, 10), down)) == (0, {-1})  # takes away all, the top itself too
    assert shown(Section((0, 0, 0), up)) == (0, {-1})
    assert shown(Section((0, 0, -1), up)) == (0, {-1})
    assert shown(Section((0, 0, 0), down)) == (pytest.approx(100, rel=1e-6), {-1, top})
    assert shown(Section((5, 0, 0), (1, 0, 0))) == (pytest.approx(50, rel=1e-6), {-1, top})  # edge-on
    assert shown(Section((0, 0, 5), up), Section((0, 0, 5), up))[0] == pytest.approx(100, rel=1e-6)  # twice the same
    assert shown(Section((0, 0, 5), up), Section((0, 0, 5), down)) == (0, {-1})  # nothing between them


@pytest.mark.parametrize("normal", [(1, 0, 0), (0.6, 0.8, 0), (0, 0, 1)])
def test_planes_that_touch_a_round_body(normal: tuple[float, float, float]) -> None:
    model = nofacet.load(SPHERE)
    camera = nofacet.Camera.fit(model, direction=(-1, 0.3, -0.5), resolution=RESOLUTION)
    whole = nofacet.render(model, camera, RESOLUTION, buffers=("coverage", "face"))
    touching = Section(tuple(5 * np.array(normal)), normal)
    frame = nofacet.render(model, camera, RESOLUTION, buffers=("coverage", "face"), sections=[touching])
    assert np.abs(frame.coverage - whole.coverage).max() < 1e-6
    opposite = Section(touching.origin, tuple(-np.array(normal)))
    nothing = nofacet.render(model, camera, RESOLUTION, buffers=("coverage", "face"), sections=[opposite])
    assert nothing.coverage.max() < 1e-6


def test_each_body_has_its_own_cap_and_a_cavity_none() -> None:
    hollow = cq.Workplane().sphere(5).cut(cq.Workplane().sphere(3))
    inner = cq.Workplane().sphere(2)
    assembly = cq.Assembly().add(hollow, color=cq.Color(1, 0, 0)).add(inner, color=cq.Color(0, 0, 1))
    model = nofacet.load(assembly)
    section = Section((0, 0, 0.5), (0, 0, 1))
    frame = nofacet.render(model, look_down(12), (120, 120), buffers=("color", "face"), sections=[section])
    middle = frame.color[60]
    reds, blues = np.flatnonzero(middle[:, 0] > 2 * middle[:, 2]), np.flatnonzero(middle[:, 2] > 2 * middle[:, 0])
    assert (frame.face[60, 58:62] == -2).all() and {58, 61} <= set(blues) and {12, 107} <= set(reds)
    ring = frame.face[60, 85]  # between the bodies: the cavity's wall below the plane
    assert ring >= 0
    area = np.pi * (25 - 9 + 4 - 0.25)
    assert cut_area(model, section) == pytest.approx(area, rel=3e-5)


def test_a_removed_face_hides_nothing_and_a_hidden_one_is_cut() -> None:
    plate, ball = cq.Workplane("XY", origin=(0, 0, 8)).box(20, 20, 1), cq.Workplane().sphere(5)
    model = nofacet.load(cq.Assembly().add(plate).add(ball))
    frame = nofacet.render(model, look_down(12), (120, 120), buffers=("face", "depth"),
                           sections=[Section((0, 0, 7), (0, 0, 1))])  # fmt: skip
    alone = nofacet.render(nofacet.load(ball), look_down(12), (120, 120), buffers=("face", "depth"))
    assert np.array_equal(frame.depth, alone.depth)


@pytest.mark.parametrize("direction", [(1, 0.2, -0.2), (-0.3, 1, -0.1), (0.9, -0.7, 0.05), (0.1, 0.05, -1)])
def test_a_cap_that_reaches_behind_the_eye(direction: tuple[float, float, float]) -> None:
    model = nofacet.load(cq.Workplane().box(10, 10, 10).val())
    eye = np.array([0.3, 0.4, 1.5])
    camera = nofacet.Camera("perspective", tuple(eye), tuple(eye + direction), (0.1, 0.05, 1), view_angle=70)
    frame = nofacet.render(model, camera, RESOLUTION, samples=4, buffers=("coverage", "face", "depth"),
                           sections=[Section((0, 0, 0), (0, 0, 1))])  # fmt: skip
    y, x = np.indices(RESOLUTION[::-1]) + 0.5
    origin, rays = (part.astype(float) for part in extended_rays(camera, RESOLUTION, x.ravel(), y.ravel()))
    t = -origin[:, 2] / rays[:, 2]
    hit = origin + t[:, None] * rays
    on_cap = (t > 0) & (np.abs(hit[:, :2]) < 5).all(axis=1)
    assert np.array_equal(frame.face.ravel() == -2, on_cap)
    assert np.array_equal(frame.face.ravel() == -1, ~on_cap)
    assert np.abs(frame.depth.ravel() - t)[on_cap].max() < 1e-9
    assert frame.stats["section_gaps"] == 0


def test_an_open_shell_shows_no_cap_and_says_so() -> None:
    box = cq.Workplane().box(10, 10, 10).faces(">X or <X or >Y").vals()
    model = nofacet.load(cq.Shell.makeShell(box))
    assert model.body_closed.tolist() == [0]
    named = replace(model, face_name=["lid", *model.face_name[1:]])
    frame = nofacet.render(named, look_down(12), (60, 60), buffers=("face",), sections=[Section((0, 0, 0), (0, 0, 1))])
    assert (frame.face >= -1).all()
    assert frame.stats["warnings"] == ["faces 0 to 2 (lid): not a closed volume, so section planes show no cap there"]
    far = nofacet.render(named, look_down(12), (60, 60), buffers=("face",), sections=[Section((0, 0, 9), (0, 0, 1))])
    assert far.stats["warnings"] == []


@pytest.mark.parametrize("method", nofacet.methods())
@pytest.mark.parametrize("normal", [(1, 0, 0), (0, 1, 0), (1, 2, 0), (0, 0, 1)])
def test_an_open_shell_says_so_however_the_plane_is_seen(normal: tuple[float, float, float], method: str) -> None:
    """The first three planes are seen edge-on, the second one along the picture's rows; so are most of the faces."""
    box = cq.Workplane().box(10, 10, 10).faces(">Z or |X or |Y").vals()
    shell = cq.Shell.makeShell(box)
    tube = cq.Workplane(origin=(0, 0, -5)).circle(5).extrude(10).faces("%CYLINDER").val()
    for source, faces in ((shell, "faces 0 to 4"), (tube, "face 0")):
        model = nofacet.load(source)
        expected = [f"{faces}: not a closed volume, so section planes show no cap there"]
        for offset, warnings in ((0, expected), (9, [])):
            origin = tuple(offset * np.array(normal))
            frame = nofacet.render(model, look_down(12), (30, 20), method, 1, buffers=("face",),
                                   sections=[Section(origin, normal)])  # fmt: skip
            assert frame.stats["warnings"] == warnings


def test_a_model_without_bodies_is_cut_open() -> None:
    model = model_of([rectangle_group(np.array([[[-1, -1, -1], [-1, 1, -1]], [[1, -1, 1], [1, 1, 1]]]))])
    frame = nofacet.render(model, look_down(3), (30, 30), buffers=("coverage",), samples=8,
                           sections=[Section((0, 0, 0), (0, 0, 1))])  # fmt: skip
    assert frame.coverage.sum(dtype=float) * 0.01 == pytest.approx(2, rel=1e-6)
    assert frame.stats["warnings"] == ["face 0: not a closed volume, so section planes show no cap there"]


def test_transparent_bodies_have_transparent_caps() -> None:
    model = box_model(4, 4, 4)
    glass = replace(model, face_color=np.tile(np.array([0.2, 0.4, 0.8, 0.5], np.float32), (6, 1)))
    frame = nofacet.render(glass, look_down(6, (2, 2, 2)), (60, 60), buffers=("color", "face"),
                           sections=[Section((0, 0, 2), (0, 0, 1))])  # fmt: skip
    assert frame.face[30, 30] == -2
    assert frame.color[30, 30, 3] == pytest.approx(0.75)  # the cap, and the bottom behind it


def test_bodies_of_shells_solids_and_loose_faces() -> None:
    box, ball = cq.Workplane().box(2, 2, 2), cq.Workplane("XY", origin=(5, 0, 0)).sphere(1)
    face = cq.Workplane("XY", origin=(9, 0, 0)).rect(1, 1).extrude(1).faces(">Z").val()
    model = nofacet.load(cq.Compound.makeCompound([box.val(), ball.val(), face]))
    assert model.body_offsets.tolist() == [0, 6, 7, 8]
    assert model.body_closed.tolist() == [1, 1, 0]
    assert np.array_equal(model.body_face, np.arange(8))
    assert np.array_equal(model.body_face_outward, model.face_outward)


def test_two_solids_that_share_a_face() -> None:
    left, right = cq.Workplane().box(2, 2, 2), cq.Workplane("XY", origin=(2, 0, 0)).box(2, 2, 2)
    from OCP.BOPAlgo import BOPAlgo_Builder

    builder = BOPAlgo_Builder()
    for part in (left, right):
        builder.AddArgument(part.val().wrapped)
    builder.Perform()
    model = nofacet.load(builder.Shape())
    assert model.face_count == 11 and len(model.body_face) == 12 and model.body_closed.tolist() == [1, 1]
    shared = np.flatnonzero(np.bincount(model.body_face) == 2)
    assert sorted(model.body_face_outward[np.isin(model.body_face, shared)].tolist()) == [-1, 1]
    assert cut_area(model, Section((0, 0, 0.2), (0, 0, 1))) == pytest.approx(8, rel=3e-5)


def test_combined_models_keep_their_bodies() -> None:
    box = cq.Workplane("XY", origin=(12, 0, 0)).box(2, 2, 2)
    model = nofacet.combine([nofacet.load(SPHERE), nofacet.load(box)])
    assert model.body_offsets.tolist() == [0, 1, 7] and model.body_face.tolist() == list(range(7))
    assert cut_area(model, Section((0, 0, 0), (0, 0, 1))) == pytest.approx(25 * np.pi + 4, rel=3e-5)


def test_edges_are_cut_off_too() -> None:
    model, section = box_model(10, 10, 10), Section((0, 0, 5), (0, 0, 1))
    camera = nofacet.Camera.fit(model, direction=(-1, -2, -1), resolution=RESOLUTION)
    frame = nofacet.render(model, camera, RESOLUTION, buffers=("color", "coverage"), sections=[section], edges=True)
    outside = frame.coverage == 0
    near = np.zeros_like(outside)  # lines reach a pixel beyond the outline
    for dy in (-2, -1, 0, 1, 2):
        for dx in (-2, -1, 0, 1, 2):
            near |= np.roll(frame.coverage > 0, (dy, dx), (0, 1))
    assert frame.color[outside & ~near].max() == 0


CUTS = {
    "one plane": [Section((0.3, 0.2, 0.4), (0.4, -0.3, 1))],
    "three planes": [Section((1, 0, 0), (1, 0.2, 0)), Section((0, 1, 0), (0, 1, 0.1)), Section((0, 0, 1), (0.1, 0, 1))],
}


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_both_methods_show_the_same_cut(cut: str, projection: Projection) -> None:
    hollow = cq.Workplane().sphere(5).cut(cq.Workplane().box(4, 4, 4))
    model = nofacet.load(cq.Assembly().add(hollow, color=cq.Color(1, 0, 0)).add(TORUS).add(cq.Workplane().sphere(1)))
    camera = nofacet.Camera.fit(model, (-1, -1.3, -1.1), projection=projection, resolution=RESOLUTION)
    first, second = (
        nofacet.render(model, camera, RESOLUTION, method, 2, buffers=("color", *VALUES), sections=CUTS[cut])
        for method in nofacet.methods()
    )
    assert np.array_equal(first.face, second.face)
    assert {-1, -2} <= set(np.unique(first.face))
    seen = first.face != -1
    assert np.abs(first.depth[seen] - second.depth[seen]).max() < 1e-9
    assert np.abs(first.normal - second.normal).max() < 1e-6
    assert np.abs(first.color - second.color).mean() < 0.005


def test_sections_with_shadows_or_mirrors_are_refused(sphere: Model) -> None:
    with pytest.raises(ValueError, match="section planes cut neither shadows nor mirror images"):
        nofacet.render(sphere, look_down(3), (30, 30), "bezier_clip_ray", sections=CUTS["one plane"], shadows=True)
