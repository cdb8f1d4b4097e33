"""The viewer's state without a window: files, appearance, views, scale, rows of the assembly."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("nofacet_viewer")
pytest.importorskip("moderngl")
import nofacet
from conftest import model_of, sphere_group
from nofacet.model import Model, Node
from nofacet_viewer.actions import perform
from nofacet_viewer.appearance import Appearance
from nofacet_viewer.assembly_rows import AssemblyRows
from nofacet_viewer.controls import Button
from nofacet_viewer.scale import HALF, SLACK, SMALLEST, STEP, AdaptiveScale, scaled
from nofacet_viewer.session import Session
from nofacet_viewer.state import View, ViewState
from nofacet_viewer.tasks import Tasks
from nofacet_viewer.watch import SETTLED, FileWatch
from sessions import wait_until, with_frame

FLANGE = Path(__file__).resolve().parents[1] / "cad_models" / "flange.step"


@pytest.fixture
def spheres() -> Model:
    """Three unit spheres in a row, two of them in a subassembly."""
    groups = [sphere_group(1.0, (3.0 * k, 0, 0)) for k in range(3)]
    model = model_of([replace(group, definition=np.full(8, k, np.int32)) for k, group in enumerate(groups)])
    faces = [np.array(indices, np.int32) for indices in ([], [0], [], [1], [2])]
    names, parents = ["all", "first", "pair", "second", ""], [-1, 0, 0, 2, 2]
    return replace(model, tree=[Node(*values) for values in zip(names, parents, faces, strict=True)])


@pytest.fixture
def session() -> Iterator[Session]:
    session = Session()
    yield session
    session.close()


# Appearance


def test_hidden_faces_keep_the_others_indices(spheres: Model) -> None:
    appearance = Appearance(spheres)
    assert appearance.applied() is spheres
    appearance.show(np.array([0], np.int32), False)
    model = appearance.applied()
    camera = nofacet.Camera.fit(spheres, direction=(0, 1, 0), resolution=(90, 30))
    before = nofacet.render(spheres, camera, (90, 30), buffers=("face",)).face
    after = nofacet.render(model, camera, (90, 30), buffers=("face",)).face
    assert set(np.unique(before)) == {-1, 0, 1, 2}
    np.testing.assert_array_equal(after, np.where(before == 0, -1, before))


def test_a_camera_fits_what_is_visible(spheres: Model) -> None:
    appearance = Appearance(spheres)
    appearance.isolate(appearance.faces_of(3))
    camera = nofacet.Camera.fit(appearance.applied(), direction=(0, 1, 0), resolution=(100, 100), zoom=1)
    np.testing.assert_allclose(camera.focal_point, (3, 0, 0), atol=1e-9)
    assert camera.view_height == pytest.approx(2.0)
    appearance.show_all()
    assert appearance.applied() is spheres


def test_colour_and_transparency_of_a_node(spheres: Model) -> None:
    appearance = Appearance(spheres)
    pair = appearance.faces_of(2)
    assert sorted(pair) == [1, 2]
    appearance.paint(pair, (1.0, 0.0, 0.0))
    appearance.set_opacity(pair, 0.25)
    color = appearance.applied().face_color
    np.testing.assert_allclose(color[1:], [[1, 0, 0, 0.25]] * 2)
    np.testing.assert_array_equal(color[0], spheres.face_color[0])
    carried = appearance.carried_to(replace(spheres))
    np.testing.assert_array_equal(carried.color, appearance.color)
    appearance.restore(pair)
    assert appearance.applied() is spheres


def test_rows_show_what_is_open(spheres: Model) -> None:
    rows = AssemblyRows(Appearance(spheres))
    assert [row.label for row in rows.rows] == ["all", "first", "pair"]  # a single root is open
    rows.toggle(rows.rows[2])
    assert [(row.label, row.depth) for row in rows.rows[2:]] == [("pair", 1), ("second", 2), ("part 4", 2)]
    rows.toggle(rows.rows[3])
    assert rows.rows[4].face == 1 and rows.rows[4].depth == 3
    assert list(rows.faces_of(rows.rows[4])) == [1]
    rows.toggle(rows.rows[0])
    assert len(rows.rows) == 1
    index = rows.reveal(2, 4)
    assert rows.rows[index].face == 2
    assert [row.label for row in rows.rows][-2:] == ["part 4", "face 2"]


def test_rows_without_a_tree_are_faces(sphere: Model) -> None:
    assert [row.label for row in AssemblyRows(Appearance(sphere)).rows] == ["face 0"]


# Views


def test_the_wipe_stays_within_the_window() -> None:
    state = ViewState(View.WIPE)
    state.move_wipe(320, 1280)
    assert state.wipe == 0.25
    state.move_wipe(2000, 1280)
    assert state.wipe == 1.0


def test_keys_change_view_and_overlays(session: Session) -> None:
    assert perform(session, "difference") and session.state.view is View.DIFFERENCE
    assert perform(session, "zebra") and session.state.overlays == {"zebra"}
    assert perform(session, "zebra") and not session.state.overlays
    assert not perform(session, "screenshot")


def test_blink_shows_one_side_after_the_other(session: Session) -> None:
    perform(session, "blink")
    now = time.monotonic()
    shown = []
    for step in range(4):
        session.update(now + 10 * step)
        shown.append(session.state.blink_exact)
    assert shown[1:] == [not value for value in shown[:-1]]


# The mouse on a picture


def test_the_cursor_finds_the_point_of_the_surface(session: Session, sphere: Model) -> None:
    with_frame(session, sphere).move((75.2, 60.4))
    hover = session.hover
    assert hover and hover.face == 0
    assert np.linalg.norm(hover.point) == pytest.approx(1.0, abs=1e-9)  # on the sphere, at the pixel's centre
    assert hover.point[0] == pytest.approx((75.5 - 60) / 30)
    session.move((2, 2))
    assert session.hover is None


def test_a_middle_click_centres(session: Session, sphere: Model) -> None:
    with_frame(session, sphere)
    session.press(Button.MIDDLE, (75, 60))
    session.release(Button.MIDDLE, (75, 60))
    assert session.camera
    assert session.camera.focal_point[0] == pytest.approx(15.5 / 30)


def test_ctrl_wheel_keeps_the_point_under_the_cursor(session: Session, sphere: Model) -> None:
    with_frame(session, sphere).move((75, 60))
    hover, camera = session.hover, session.camera
    assert hover and camera
    for _ in range(5):  # frames lag behind: none is rendered in between
        session.wheel(1.0, to_cursor=True)
    zoomed = session.camera
    assert zoomed
    for seen in (camera, zoomed):
        x, y, _, w = seen.pixel_from_world((120, 120)) @ [*hover.point, 1.0]
        assert (x / w, y / w) == pytest.approx((75.5, 60.5), abs=1e-6)
    assert zoomed.view_height == pytest.approx(4.0 / 1.1**5)


def test_dragging_the_divider_moves_no_camera(session: Session, sphere: Model) -> None:
    with_frame(session, sphere).state.view = View.WIPE
    camera = session.camera
    session.press(Button.LEFT, (61, 30))
    session.move((90, 30))
    session.release(Button.LEFT, (90, 30))
    assert session.state.wipe == 0.75
    assert session.camera is camera


# Files


def test_a_file_is_read_meshed_and_measured_in_the_background(session: Session) -> None:
    session.open([str(FLANGE)])
    assert session.model is None  # not yet
    wait_until(session, lambda: session.model is not None)
    assert session.camera and session.drawn is session.model
    drawn = session.drawn
    wait_until(session, lambda: session.described is not drawn)
    assert session.described and np.isfinite(session.described.conversion_error).all()
    assert session.drawn is drawn  # nothing has to be drawn again
    wait_until(session, lambda: session.tessellated.result is not None)


def test_a_bad_file_leaves_what_was_shown(session: Session, sphere: Model, tmp_path: Path) -> None:
    with_frame(session, sphere)
    path = tmp_path / "empty.step"
    path.write_text("")
    session.open([str(path)])
    wait_until(session, lambda: session.notice is not None)
    assert session.notice and session.notice.is_problem
    assert session.notice.text == f"{path}: is empty; export or copy the model again"
    assert session.model is sphere


def test_reading_can_be_cancelled(session: Session) -> None:
    session.open([str(FLANGE)])
    session.cancel_reading()
    assert session.loader.path is None
    time.sleep(0.3)
    session.update(time.monotonic())
    assert session.model is None


def test_arrow_keys_step_round_the_files(session: Session) -> None:
    session.open(["a.step", "b.step", "c.step"])
    perform(session, "previous-file")
    assert session.path == "c.step"
    perform(session, "next-file")
    assert session.path == "a.step"


def test_a_change_of_the_file_counts_once_it_has_settled(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text("1")
    watch = FileWatch(str(path))
    assert not watch.changed(0.0)
    path.write_text("22")
    assert not watch.changed(1.0)
    path.write_text("333")
    assert not watch.changed(1.2)
    assert not watch.changed(1.2 + SETTLED / 2)
    assert watch.changed(1.2 + SETTLED)
    assert not watch.changed(9.0)
    path.unlink()
    assert not watch.changed(10.0)
    assert not watch.changed(20.0)


def test_tasks_hand_results_and_errors_to_who_polls() -> None:
    tasks = Tasks()
    results: list[object] = []
    tasks.run(lambda: 1 / 0, results.append)
    tasks.run(lambda: 7, results.append)
    end = time.monotonic() + 10
    while tasks.running and time.monotonic() < end:
        tasks.poll()
        time.sleep(0.001)
    assert 7 in results
    assert any(isinstance(result, ZeroDivisionError) for result in results)


# The scale in motion


@pytest.mark.parametrize(("fixed", "area"), [(0.0, 0.02), (0.0, 0.1), (0.01, 0.2), (0.018, 0.04), (0.001, 2.0)])
def test_the_scale_settles_within_the_budget(fixed: float, area: float) -> None:
    scale = AdaptiveScale(budget=0.028, quick=0.028)
    times = []
    for _ in range(60):
        seconds = fixed + area * scale.value**2
        times.append(seconds)
        scale.update(seconds, scale.value)
    assert max(times[-10:]) <= 0.028 or scale.value == SMALLEST
    assert len(set(times[-10:])) == 1  # at rest
    best = min(1.0, (((1.0 - SLACK) * 0.028 - fixed) / area) ** 0.5)
    assert scale.value > best - STEP


@pytest.mark.parametrize(("area", "value"), [(0.01, 1.0), (0.03, 0.8), (0.07, 0.5), (0.1, 0.5), (0.2, 0.37)])
def test_more_than_half_the_resolution_only_if_it_follows_fast(area: float, value: float) -> None:
    """Frames take area * scale^2: 1/50 s may be used beyond a half, 28 ms up to there."""
    scale = AdaptiveScale(budget=0.028, quick=0.02)
    for _ in range(100):
        scale.update(area * scale.value**2, scale.value)
    assert abs(scale.value - value) <= 2 * STEP
    assert area * scale.value**2 <= (0.028 if scale.value <= HALF else 0.02)


def test_one_slow_frame_does_not_ruin_the_picture() -> None:
    scale = AdaptiveScale(budget=0.028, quick=0.028)
    scale.value = 1.0
    scale.update(3.0, 1.0)
    assert scale.value > 0.5


@pytest.mark.parametrize("resolution", [(1280, 720), (639, 718), (1, 1), (1917, 1003)])
@pytest.mark.parametrize("scale", [0.125, 0.3, 0.5, 0.77, 1.0])
def test_scaled_resolutions_keep_their_shape(resolution: tuple[int, int], scale: float) -> None:
    width, height = scaled(resolution, scale)
    assert 1 <= width <= resolution[0] and 1 <= height <= resolution[1]
    assert abs(width - height * resolution[0] / resolution[1]) <= 0.5
    assert abs(height - scale * resolution[1]) <= 4.5
