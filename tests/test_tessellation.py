"""OpenCascade's triangles for those who compare with them: settings, normals, a process of their own."""

from __future__ import annotations

import time
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.IMeshTools import IMeshTools_Parameters

import nofacet
from nofacet.cad.tessellate import box_sides
from nofacet.tessellation import read_shape
from scenes import look_down
from surface_distance import F3D_TEAPOT, FREECAD_FLANGE, MESHER_CHECKS, lattice, meshed_triangles, triangles_of

pytest.importorskip("moderngl")

from nofacet_viewer.meshing import Mesher, MeshResult

COARSE = nofacet.MeshSetting("coarse", 0.1)
LIMIT = 60.0  # seconds for a child process to start and mesh


def answer_of(mesher: Mesher) -> MeshResult | str:
    end = time.monotonic() + LIMIT
    while (answer := mesher.poll()) is None:
        assert time.monotonic() < end, "the mesher did not answer"
        time.sleep(0.02)
    return answer


def test_settings_of_viewers() -> None:
    sides = (10.0, 20.0, 60.0)
    deflection = {name: setting.for_box(sides).deflection for name, setting in nofacet.MESH_SETTINGS.items()}
    expected = {"F3D": 0.1, "Mayo": 0.24, "ocp-vscode": 0.03, "CQ-editor": 0.0024, "cadquery": 0.24, "FreeCAD": 0.15}
    assert deflection == pytest.approx(expected)


def test_deflection_in_pixels() -> None:
    assert nofacet.MeshSetting.in_pixels(0.5, look_down(10.0), (400, 200)).deflection == pytest.approx(0.025)
    near = nofacet.Camera("perspective", (0, 0, 5), (0, 0, 0), (0, 1, 0), view_angle=90.0)
    assert nofacet.MeshSetting.in_pixels(1.0, near, (400, 200)).deflection == pytest.approx(0.05)
    with pytest.raises(ValueError, match="positive"):
        nofacet.MeshSetting.in_pixels(0.0, near, (400, 200))
    with pytest.raises(ValueError, match="resolution 0 x 0: give"):
        nofacet.MeshSetting.in_pixels(1.0, near, (0, 0))


@pytest.mark.parametrize("value", [0.0, -0.1, float("nan"), float("inf")])
def test_settings_are_positive_and_finite(value: float) -> None:
    with pytest.raises(ValueError, match="mesh setting 'x': deflection is .*; it must be finite and positive"):
        nofacet.MeshSetting("x", value)
    with pytest.raises(ValueError, match="mesh setting 'x': angle is .*; it must be finite and positive"):
        nofacet.MeshSetting("x", 0.1, value)


def test_settings_are_relative_to_known_sides() -> None:
    with pytest.raises(ValueError, match="relative_to is 'smallest side'; write 'largest side', 'mean side' or None"):
        nofacet.MeshSetting("x", 0.1, relative_to="smallest side")  # type: ignore[arg-type]


@pytest.mark.parametrize("setting", [nofacet.MeshSetting("x", 9e-8), nofacet.MeshSetting("x", 0.1, 9e-13)])
def test_settings_that_are_0_to_opencascade(setting: nofacet.MeshSetting) -> None:
    with pytest.raises(ValueError, match="OpenCascade needs at least 1e-07 model units and 1e-12 radians"):
        nofacet.tessellate(cq.Workplane().box(1, 1, 1), setting)


def test_mesher_checks_free_form_faces_at_few_points() -> None:
    """BRepMesh splits a triangle whose sides' middles or centroid are too far from the surface, and looks nowhere else.

    Faces 8 to 11 of the teapot are quarters of one belt. As F3D meshes it, an inner edge between the belt's two borders
    is farthest from the surface at three eighths of its length.
    """
    source, setting = "cad_models/teapot.step", nofacet.MESH_SETTINGS["F3D"]
    model, triangles = nofacet.load(source), triangles_of(source, setting).of_faces(range(8, 12))
    assert triangles.distances(model, MESHER_CHECKS).max() < 0.97 * setting.deflection
    everywhere = triangles.distances(model, lattice(16)).max(axis=1)
    assert 1.03 * setting.deflection < everywhere.max() < F3D_TEAPOT * setting.deflection
    assert set(triangles.face[everywhere > setting.deflection]) == {8, 9, 10, 11}


def test_mesher_does_not_check_tori() -> None:
    """BRepMesh places points on spheres, cylinders, cones and tori by their radii and then looks at no triangle, unless
    it is told to (EnableControlSurfaceDeflectionAllSurfaces), which no viewer does by default. On the flange's fillets
    triangles run from border to border and miss the torus at the very places where it looks elsewhere."""
    shape = read_shape("cad_models/flange.step")
    model, setting = nofacet.load(shape), nofacet.MESH_SETTINGS["FreeCAD"].for_box(box_sides(shape))
    nofacet.tessellate(shape, setting)
    fillet = meshed_triangles(shape).of_faces([5])
    assert model.surface_type[model.face_definition[5]] == "torus"
    excess = fillet.distances(model, lattice(16)).max() / setting.deflection
    assert 1.58 < fillet.distances(model, MESHER_CHECKS).max() / setting.deflection <= excess < FREECAD_FLANGE
    parameters = IMeshTools_Parameters()
    parameters.Deflection, parameters.Angle = setting.deflection, setting.angle
    parameters.EnableControlSurfaceDeflectionAllSurfaces = True
    BRepTools.Clean_s(shape)
    BRepMesh_IncrementalMesh(shape, parameters)
    assert meshed_triangles(shape).of_faces([5]).distances(model, lattice(16)).max() < setting.deflection


def test_normals_are_the_surfaces_and_point_outwards() -> None:
    mesh = nofacet.tessellate(cq.Workplane().sphere(2).translate((5, 0, 0)), COARSE)
    out = (mesh.points - (5, 0, 0)) / 2
    assert mesh.normals == pytest.approx(out, abs=1e-6)
    hole = nofacet.tessellate(cq.Workplane().box(4, 4, 1).faces(">Z").hole(2), COARSE)
    distance = np.hypot(*hole.points[:, :2].T)
    inside = (distance < 1.01) & (np.abs(hole.normals[:, 2]) < 0.5)
    assert inside.any() and hole.normals[inside, :2] == pytest.approx(-hole.points[inside, :2], abs=1e-6)
    mirrored = nofacet.tessellate(cq.Workplane().sphere(2).mirror("XY"), COARSE)
    assert mirrored.normals == pytest.approx(mirrored.points / 2, abs=1e-6)


def test_relative_deflection_and_figures_of_a_mesh() -> None:
    setting = nofacet.MeshSetting("relative", 0.01, relative_to="largest side")
    mesh = nofacet.tessellate(cq.Workplane().box(1, 2, 4), setting)
    assert mesh.deflection == pytest.approx(0.04, rel=1e-3)
    assert mesh.display_bytes == 24 * 24 + 12 * 12 and mesh.seconds > 0


def test_mesher_keeps_the_shape_for_the_next_setting() -> None:
    mesher = Mesher()
    source = cq.Workplane().sphere(1)
    counts: list[int] = []
    for deflection in (0.1, 0.001):
        mesher.start(source, nofacet.MeshSetting("test", deflection))
        assert mesher.busy
        answer = answer_of(mesher)
        assert isinstance(answer, MeshResult) and not mesher.busy
        counts.append(len(answer.mesh.triangles))
        assert mesher.poll() is None
    mesher.cancel()
    assert counts[1] > 5 * counts[0]


def test_mesher_is_cancelled_and_starts_again() -> None:
    mesher = Mesher()
    mesher.start(cq.Workplane().sphere(100), nofacet.MeshSetting("hopeless", 1e-6, 1e-4))
    time.sleep(0.2)
    begin = time.monotonic()
    mesher.start(cq.Workplane().box(1, 1, 1), COARSE)
    assert time.monotonic() - begin < 10
    answer = answer_of(mesher)
    assert isinstance(answer, MeshResult) and len(answer.mesh.triangles) == 12
    mesher.cancel()
    assert mesher.poll() is None and not mesher.busy


def test_mesher_says_in_a_line_what_is_wrong(tmp_path: Path) -> None:
    broken = tmp_path / "broken.step"
    broken.write_text("ISO-10303-21;\nHEADER;\n")
    mesher = Mesher()
    mesher.start(str(broken), COARSE)
    answer = answer_of(mesher)
    assert isinstance(answer, str) and "broken.step" in answer and "\n" not in answer and not mesher.busy
    with pytest.raises(nofacet.InputError, match="cannot draw"):
        mesher.start(3, COARSE)
