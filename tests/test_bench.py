"""nofacet bench: what it measures is right where a closed form says so, and a run tells all it should."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

import nofacet
from conftest import model_of, rectangle_group
from nofacet import MeshSetting, _native, borders
from nofacet.bench import embree, gl
from nofacet.bench.bars import Bar
from nofacet.bench.child import ChildFailure, in_child
from nofacet.bench.crowd import crowd
from nofacet.bench.outline import check_outline
from nofacet.bench.run import run, write
from nofacet.bench.subject import Subject, open_subject
from nofacet.bench.timing import MOST_RUNS, Timing, ratio, repeat
from nofacet.cad.ray_cast import RayCaster
from nofacet.cad.tessellate import box_sides, tessellate
from nofacet.cli import main
from nofacet.mesh import Mesh
from nofacet.outline import compare

RESOLUTION = (160, 120)


@pytest.fixture(scope="module")
def ball() -> Subject:
    return open_subject("sphere", RESOLUTION)


def fan(subject: Subject, radius: float, sides: int) -> Mesh:
    """A regular polygon around the origin that faces the camera, as a fan of triangles."""
    right, up, forward = subject.camera.axes()
    angle = 0.3 + 2 * np.pi * np.arange(sides) / sides
    rim = radius * (np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up)
    corners = np.arange(1, sides + 1)
    triangles = np.stack([np.zeros(sides, int), corners, np.roll(corners, -1)], axis=1)
    points = np.vstack([np.zeros(3), rim])
    normals = np.broadcast_to(-forward, points.shape).astype(np.float32)
    return Mesh(points, normals, triangles.astype(np.int32), np.zeros(sides, np.int32), 0.0)


# --- meshes ---


def test_box_has_twelve_triangles_that_face_outwards() -> None:
    shape = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()
    mesh = tessellate(shape, 0.1)
    assert mesh.triangles.shape == (12, 3) and mesh.points.shape == (24, 3)
    assert np.bincount(mesh.face).tolist() == [2] * 6
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normal, (a + b + c) / 3 - (0.5, 1.0, 1.5)) > 0).all()
    volume = np.einsum("ij,ij->i", normal, a).sum() / 6
    assert volume == pytest.approx(6.0, rel=1e-12)
    assert box_sides(shape) == pytest.approx((1.0, 2.0, 3.0), abs=1e-6)


def test_finer_deflection_means_more_triangles_nearer_to_the_surface(ball: Subject) -> None:
    counts, errors = [], []
    for deflection in (1.0, 0.1):
        mesh = tessellate(ball.shape, deflection)
        counts.append(len(mesh.triangles))
        middles = mesh.points[mesh.triangles].mean(axis=1)
        errors.append(50 - np.linalg.norm(middles, axis=1).min())
        assert np.linalg.norm(mesh.points, axis=1) == pytest.approx(50.0, rel=1e-9)
    assert counts[0] < counts[1] and errors[0] > 5 * errors[1] > 0


def test_triangles_of_a_moved_instance_are_where_it_is() -> None:
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    move = gp_Trsf()
    move.SetTranslation(gp_Vec(10.0, 20.0, 30.0))
    shape = BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Shape().Moved(TopLoc_Location(move))
    mesh = tessellate(shape, 0.1)
    assert mesh.points.min(axis=0) == pytest.approx((10, 20, 30)) and mesh.points.max(axis=0) == pytest.approx(
        (11, 21, 31)
    )


# --- outlines ---


def test_exact_outline_of_a_sphere_is_a_circle(ball: Subject) -> None:
    radius = 50.0 / ball.pixel
    for found, (width, height) in zip(
        borders.exact_borders(ball.model, ball.camera, RESOLUTION), (RESOLUTION, RESOLUTION[::-1]), strict=True
    ):
        y = found.line + 0.5 + borders.ROW_SHIFT - height / 2
        expected = width / 2 + np.where(found.enters, -1, 1) * np.sqrt(radius**2 - y**2)
        assert len(found.x) == 2 * 108
        assert found.x == pytest.approx(expected, abs=1e-9)


def test_outline_error_of_a_polygon_is_that_of_its_sagitta(ball: Subject) -> None:
    sides, radius = 24, 50.0 / ball.pixel
    error = compare(
        borders.exact_borders(ball.model, ball.camera, RESOLUTION),
        borders.mesh_borders(fan(ball, 50.0, sides), ball.camera, RESOLUTION),
    )
    assert error
    sagitta = radius * (1 - np.cos(np.pi / sides))
    # The distance of a circle from its chord, as seen along the edge, is almost a parabola: its mean square is 8/15.
    assert error.largest == pytest.approx(sagitta, rel=0.02) and error.largest <= sagitta
    assert error.rms == pytest.approx(sagitta * np.sqrt(8 / 15), rel=0.03)
    assert error.unmatched == 0


def test_outline_error_of_a_smaller_disc_is_the_difference_of_the_radii(ball: Subject) -> None:
    mesh = fan(ball, 50.0 - 0.1 * ball.pixel, 2000)
    error = compare(
        borders.exact_borders(ball.model, ball.camera, RESOLUTION), borders.mesh_borders(mesh, ball.camera, RESOLUTION)
    )
    assert error and error.largest == pytest.approx(0.1, rel=0.02) and error.rms == pytest.approx(0.1, rel=0.02)


def test_a_sliver_that_only_one_side_has_is_counted_not_measured(ball: Subject) -> None:
    disc = fan(ball, 50.0, 500)
    right, up, _ = ball.camera.axes()
    wire = np.array([56.0 * right - 20 * up, 56.1 * right - 20 * up, 56.0 * right + 20 * up])
    points = np.vstack([disc.points, wire])
    triangles = np.vstack([disc.triangles, [len(disc.points) + np.arange(3)]]).astype(np.int32)
    mesh = Mesh(points, np.zeros(points.shape, np.float32), triangles, np.zeros(len(triangles), np.int32), 0.0)
    exact = borders.exact_borders(ball.model, ball.camera, RESOLUTION)
    plain, with_wire = (compare(exact, borders.mesh_borders(one, ball.camera, RESOLUTION)) for one in (disc, mesh))
    rows = round(40.0 / ball.pixel)
    assert plain and with_wire
    assert with_wire.unmatched - plain.unmatched == pytest.approx(2 * rows, abs=6)
    assert with_wire.largest == plain.largest


def test_rows_do_not_measure_what_runs_along_them(ball: Subject) -> None:
    """A slab with an almost level top, drawn a tenth of a pixel too low: on one row its end is tens of pixels off."""
    right, up, _ = ball.camera.axes()
    slabs = []
    for top in (20.0, 20.0 - 0.1 * ball.pixel):
        corners = [x * right + y * up for x, y in ((-40, -20), (40, -20), (40, top + 0.1), (-40, top))]
        triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
        mesh = Mesh(np.array(corners), np.zeros((4, 3), np.float32), triangles, np.zeros(2, np.int32), 0.0)
        slabs.append(borders.mesh_borders(mesh, ball.camera, RESOLUTION))
    error = compare(slabs[0], slabs[1])
    assert error and error.largest == pytest.approx(0.1, rel=1e-3)


def test_mesh_with_holes_and_overlaps_is_covered_where_any_triangle_is(ball: Subject) -> None:
    """Two overlapping rectangles side by side, one of them turned over: one stretch a row from end to end."""
    right, up, _ = ball.camera.axes()
    corners = []
    for x0, x1 in ((-40.0, 5.0), (0.0, 30.0)):
        corners += [x * right + y * up for x, y in ((x0, -20.0), (x1, -20.0), (x1, 20.0), (x0, 20.0))]
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]], np.int32)
    mesh = Mesh(np.array(corners), np.zeros((8, 3), np.float32), triangles, np.zeros(4, np.int32), 0.0)
    rows, columns = borders.mesh_borders(mesh, ball.camera, RESOLUTION)
    assert rows.enters.tolist() == [True, False] * (len(rows.x) // 2)
    assert rows.x[rows.enters] == pytest.approx(80 - 40 / ball.pixel, abs=1e-9)
    assert rows.x[~rows.enters] == pytest.approx(80 + 30 / ball.pixel, abs=1e-9)
    assert len(columns.x) == pytest.approx(2 * 70 / ball.pixel, abs=2)


def test_opencascades_rays_see_our_outline(ball: Subject) -> None:
    check = check_outline(ball, borders.exact_borders(ball.model, ball.camera, RESOLUTION)[0])
    assert check and check.not_found == 0 and check.largest < 1e-10


def test_opencascades_rays_see_an_outline_that_is_off(ball: Subject) -> None:
    rows, _ = borders.exact_borders(ball.model, ball.camera, RESOLUTION)
    off = borders.Borders(rows.line, rows.x + 0.01, rows.enters, rows.across)
    check = check_outline(ball, off)
    assert check and check.median == pytest.approx(0.01, abs=1e-8)


def test_rays_meet_a_sphere_at_its_surface(ball: Subject) -> None:
    caster = RayCaster(ball.shape)
    assert caster.depth(np.array([0.0, 0.0, 100.0]), np.array([0.0, 0.0, -1.0])) == pytest.approx(50.0)
    assert caster.depth(np.array([60.0, 0.0, 100.0]), np.array([0.0, 0.0, -1.0])) == np.inf


# --- the floor ---


def test_floor_evaluates_what_the_frame_shows(ball: Subject) -> None:
    frame = nofacet.render(ball.model, ball.camera, RESOLUTION, samples=1, buffers=("face", "uv"))
    floor = _native.Scene(ball.model).floor(face=frame.face, uv=frame.uv, repeats=2)
    shown = int((frame.face >= 0).sum())
    assert floor["samples"] == shown and floor["seconds"] > 0
    # position . normal is the radius everywhere, with one sign.
    assert abs(floor["checksum"]) == pytest.approx(50.0 * shown, rel=1e-12)


@pytest.mark.parametrize("name", ["bottle", "flange"])
def test_floor_of_rational_and_high_degree_patches(name: str) -> None:
    """The same sum from the frame's own position and normal; outwards is where the model says so."""
    subject = open_subject(str(Path(__file__).parents[1] / "cad_models" / f"{name}.step"), RESOLUTION)
    model, camera = subject.model, subject.camera
    frame = nofacet.render(model, camera, RESOLUTION, samples=1, buffers=("face", "uv", "depth", "normal"))
    floor = _native.Scene(model).floor(face=frame.face, uv=frame.uv, repeats=1)
    shown = frame.face >= 0
    dots = np.einsum("ij,ij->i", frame.position[shown], frame.normal[shown].astype(float))
    sign = model.face_outward[frame.face[shown]]
    assert floor["checksum"] == pytest.approx((sign * dots).sum(), abs=1e-4 * np.abs(dots).sum())


def test_floor_of_an_empty_frame_is_nothing(ball: Subject) -> None:
    floor = _native.Scene(ball.model).floor(face=np.full((3, 4), -1, np.int32), uv=np.zeros((3, 4, 2)), repeats=1)
    assert floor["samples"] == 0 and floor["checksum"] == 0.0


# --- children, crowds, bars ---


def test_child_returns_fails_and_is_stopped() -> None:
    assert in_child(lambda: np.arange(3).sum(), 60.0) == 3
    with pytest.raises(ChildFailure, match="ZeroDivisionError"):
        in_child(lambda: 1 // 0, 60.0)
    with pytest.raises(ChildFailure, match="status"):
        in_child(lambda: __import__("os")._exit(7), 60.0)
    with pytest.raises(TimeoutError):
        in_child(lambda: __import__("time").sleep(60), 0.2)


def test_what_is_fast_is_repeated_often() -> None:
    calls = iter(range(1000))
    timing, result = repeat(lambda: next(calls))
    assert timing.runs == next(calls) == MOST_RUNS and 0 <= result < MOST_RUNS
    assert 0 <= timing.fastest <= timing.median


def test_ratios_compare_what_was_run_together() -> None:
    """A machine that is twice as fast for a while changes no ratio, though it makes one of the fastest runs."""
    one, other = Timing.of([2.0, 1.0, 2.0, 2.0]), Timing.of([1.0, 0.5, 1.0, 0.9])
    assert ratio(one, other) == 2.0
    assert repeat(lambda: __import__("time").sleep(0.02), enough=0.05)[0].runs == 3


def test_crowd_is_side_by_side_and_all_in_the_picture() -> None:
    square = model_of([rectangle_group(np.array([[[x, y, 0.0] for y in (0, 1)] for x in (0, 1)]))])
    camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=4.0)
    many = crowd(square, 7, camera)
    assert many.face_count == 7 and many.placed_patch_count == 7
    frame = nofacet.render(many, nofacet.Camera.fit(many, (0, 0, -1), resolution=RESOLUTION), RESOLUTION, samples=1)
    faces, areas = np.unique(frame.face, return_counts=True)
    assert faces.tolist() == [-1, *range(7)]
    assert areas[1:].max() < 1.3 * areas[1:].min()  # none hides another


def test_verdicts() -> None:
    assert Bar("", "", 3.0, (3.5, 2.0), at_least=False).verdict == "met"
    assert Bar("", "", 1.9, (3.5, 2.0), at_least=False).verdict == "aim met"
    assert Bar("", "", 3.6, (3.5, 2.0), at_least=False).verdict == "missed"
    assert Bar("", "", 9.0, (10.0, None), at_least=True).verdict == "missed"
    assert Bar("", "", 0.5, (None, 1.0), at_least=True).verdict == "aim missed"
    assert Bar("", "", 9.0, (10.0, None), at_least=True, open_ended=True).verdict == "not settled"
    assert Bar("", "", 11.0, (10.0, None), at_least=True, open_ended=True).verdict == "met"


# --- whole runs ---


def test_quick_run_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "sphere", "nowhere.step", "--quick", "--resolution=160,120", f"--output={tmp_path}"]) == 0
    markdown = capsys.readouterr().out
    assert markdown == (tmp_path / "bench.md").read_text()
    assert "| frame / floor, one thread | sphere |" in markdown
    assert "nowhere.step is not there" in markdown
    record = json.loads((tmp_path / "bench.json").read_text())
    (result,) = record["subjects"]
    assert result["floor"]["seconds"]["fastest"] > 0 and result["first_pictures"][0]["extraction"] > 0
    assert {(frame["samples"], frame["threads"]) for frame in result["frames"]} == {(1, 1), (1, 2), (4, 1), (4, 2)}
    assert {bar["text"] for bar in record["bars"]} >= {"frame / floor, one thread", "one thread / two threads"}
    assert not (tmp_path / "bench.png").exists()


def test_without_a_model_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bench.md").write_text("of an earlier run")
    assert main(["bench", "nowhere.step", "--quick", f"--output={tmp_path}"]) == 1
    out, err = capsys.readouterr()
    assert out == "" and "nofacet: nowhere.step: nowhere.step is not there" in err
    assert (tmp_path / "bench.md").read_text() == "of an earlier run" and len(list(tmp_path.iterdir())) == 1


def test_the_folder_is_checked_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nofacet.bench.run.open_subject", None)
    (tmp_path / "file").touch()
    for folder, message in (("file", "is a file, and --output needs a folder"), ("file/sub", "Not a directory")):
        assert main(["bench", "sphere", "--quick", f"--output={tmp_path / folder}"]) == 1
        (line,) = capsys.readouterr().err.splitlines()
        assert f"{tmp_path / folder}: " in line and message in line


def test_whole_run_of_one_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = [MeshSetting("1 px", 0.5, 0.5), MeshSetting("0.1 px", 0.1, 0.5), MeshSetting("hopeless", 1e-7, 0.5)]
    monkeypatch.setattr("nofacet.bench.run.mesh_settings", lambda pixel, sides: settings)
    report = run(["sphere"], RESOLUTION, 2, quick=False, say=lambda line: None, meshing_limit=4.0)
    write(report, tmp_path, plotted=True)
    (result,) = report.subjects
    coarse, fine, hopeless = result.meshes
    assert hopeless.timed_out and "hopeless: more than 4 s" in "".join(report.left_out)
    assert coarse.outline and fine.outline and coarse.outline.largest > 3 * fine.outline.largest > 0
    assert (coarse.opengl is None) == (gl.missing() is not None)
    assert (coarse.embree == {}) == (embree.missing() is not None)
    assert result.outline and result.outline.largest < 1e-10
    assert result.ray_casting and result.ray_casting.frame_seconds > 0
    assert "meshing at 0.1 px / first picture on 2 threads" in (tmp_path / "bench.md").read_text()
    assert (tmp_path / "bench.png").stat().st_size > 10_000
