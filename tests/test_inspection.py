"""What the mouse inspects, without a window: hovering, selecting, measuring, cutting along what is under the cursor."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nofacet_viewer")
pytest.importorskip("moderngl")
import nofacet
from conftest import model_of, sphere_group
from nofacet.model import Model, Node
from nofacet_viewer.actions import perform
from nofacet_viewer.controls import DOUBLE_CLICK_SECONDS, Button, DoubleClick
from nofacet_viewer.inspection import part_of
from nofacet_viewer.session import Session
from nofacet_viewer.state import View
from sessions import wait_until, with_frame

LEFT, MIDDLE, RIGHT, NOWHERE = (30.0, 60.0), (60.0, 60.0), (90.0, 60.0), (2.0, 2.0)  # places in the picture


@pytest.fixture
def balls() -> Model:
    """Three balls side by side in the picture, faces 0 to 2 from left to right; the last two are one part."""
    groups = [sphere_group(0.4, (k - 1.0, 0, 0)) for k in range(3)]
    model = model_of([replace(group, definition=np.full(8, k, np.int32)) for k, group in enumerate(groups)])
    faces = [np.array(indices, np.int32) for indices in ([], [0], [1, 2])]
    names, parents = ["all", "single", "pair"], [-1, 0, 0]
    nodes = [Node(*values) for values in zip(names, parents, faces, strict=True)]
    return replace(model, surface_type=["sphere"] * 3, tree=nodes)


@pytest.fixture
def session(balls: Model) -> Iterator[Session]:
    session = with_frame(Session(), balls)
    yield session
    session.close()


def settle(session: Session) -> None:
    session.update(time.monotonic())
    wait_until(session, lambda: not session.inspection.busy)


def click(session: Session, at: tuple[float, float], **modifiers: bool) -> None:
    session.press(Button.LEFT, at, **modifiers)
    session.release(Button.LEFT, at)
    session._double_click = DoubleClick()  # of clicks in the same place only the first is meant
    settle(session)


def selected(session: Session) -> list[int]:
    return np.flatnonzero(session.inspection.selected).tolist()


def test_hovering_gives_the_exact_facts_of_the_pixels_centre(session: Session, balls: Model) -> None:
    session.move((35.2, 61.9))
    settle(session)
    assert session.camera
    found = nofacet.pick(balls, session.camera, (120, 120), 35.5, 61.5)
    assert found and str(session.inspection.hover) == str(found)
    session.move(NOWHERE)
    settle(session)
    assert session.inspection.hover is None
    session.move(LEFT)
    session.over_picture = False
    settle(session)
    assert session.inspection.hover is None


def test_errors_are_told_once_they_are_measured(session: Session, balls: Model) -> None:
    click(session, LEFT)
    assert session.inspection.hover and np.isnan(session.inspection.hover.conversion_error)
    session.described = replace(
        balls,
        conversion_error=np.array([3e-13, 0, 0]),
        edge_use_face=np.zeros(1, np.int32),
        edge_use_deviation=np.array([4e-6]),
    )
    settle(session)
    assert session.inspection.hover.conversion_error == 3e-13
    assert session.inspection.hover.trim_deviation == 4e-6
    session.inspection.learn(session.described)
    assert session.inspection.picked == session.inspection.hover


def test_nothing_is_hovered_while_the_camera_moves(session: Session) -> None:
    session.move(MIDDLE)
    settle(session)
    assert session.inspection.hover and session.camera
    session.camera = session.camera.zoom(2)
    session.update(time.monotonic())
    assert session.inspection.hover is None
    session.state.view = View.TESSELLATED  # no frame to wait for
    settle(session)
    found = session.inspection.hover
    assert found and session.hover and session.hover.point == found.position


def test_clicks_select_faces_and_parts(session: Session) -> None:
    click(session, LEFT)
    assert selected(session) == [0] and session.inspection.picked and session.inspection.picked.face == 0
    click(session, MIDDLE)
    assert selected(session) == [1]
    click(session, MIDDLE, shift=True)
    assert selected(session) == [1, 2]
    click(session, LEFT, ctrl=True)
    assert selected(session) == [0, 1, 2]
    click(session, RIGHT, ctrl=True)
    assert selected(session) == [0, 1]
    click(session, NOWHERE)
    assert selected(session) == [] and session.inspection.picked is None


def test_a_double_click_selects_the_part(session: Session) -> None:
    for _ in range(2):
        session.press(Button.LEFT, RIGHT)
        session.release(Button.LEFT, RIGHT)
    settle(session)
    assert selected(session) == [1, 2]


def test_which_clicks_are_double() -> None:
    clicks = DoubleClick()
    late = 1.01 * DOUBLE_CLICK_SECONDS
    assert [clicks.ends((5, 5), now) for now in (0, 0.1, 0.2, 0.3, 0.3 + late)] == [False, True, False, True, False]
    assert not clicks.ends((50, 5), 0.31 + late)


def test_a_selection_is_another_array() -> None:
    """Who has shown one can tell by that whether there is another."""
    session = Session()
    before = session.inspection.selected
    session.inspection.select(np.zeros(0, np.int32))
    assert session.inspection.selected is not before


def test_the_part_of_a_model_without_a_tree_is_its_body(session: Session, balls: Model) -> None:
    bodies = replace(
        balls,
        tree=[],
        body_offsets=np.array([0, 2, 3]),
        body_face=np.array([2, 0, 1], np.int32),
        body_face_outward=np.ones(3, np.int8),
        body_closed=np.ones(2, np.uint8),
    )
    assert session.camera
    for at, faces in ((LEFT, [2, 0]), (MIDDLE, [1])):
        found = nofacet.pick(bodies, session.camera, (120, 120), *at)
        assert found and part_of(bodies, found).tolist() == faces
        assert part_of(replace(bodies, body_face=np.empty(0, np.int32)), found).tolist() == [found.face]


def test_two_clicks_measure(session: Session) -> None:
    perform(session, "measure")
    click(session, LEFT)
    click(session, NOWHERE)
    assert session.inspection.measurement is None and len(session.inspection.points) == 1
    click(session, RIGHT)
    found = session.inspection.measurement
    assert found and found.distance == pytest.approx(2.0, abs=1e-9) and found.angle == pytest.approx(0, abs=1e-6)
    assert selected(session) == []
    click(session, MIDDLE)
    assert len(session.inspection.points) == 1
    perform(session, "deselect")
    assert not session.inspection.points and not session.inspection.measuring


def test_isolating_shows_the_selection_alone(session: Session) -> None:
    assert perform(session, "isolate") and session.appearance and session.appearance.visible.all()
    click(session, MIDDLE, shift=True)
    assert perform(session, "isolate")
    assert session.appearance.visible.tolist() == [False, True, True]
    assert session.drawn is not session.model
    perform(session, "show-all")
    assert session.drawn is session.model


def test_a_plane_is_put_along_the_face_under_the_cursor(session: Session) -> None:
    session.move((66.5, 55.5))
    perform(session, "section")
    settle(session)
    (plane,) = session.state.sections
    found = np.array([*plane.origin])
    np.testing.assert_allclose(np.linalg.norm(found), 0.4, atol=1e-9)
    np.testing.assert_allclose(plane.normal, found / 0.4, atol=1e-9)
    session.move(NOWHERE)
    perform(session, "section")
    settle(session)
    assert len(session.state.sections) == 1 and session.notice and "no surface" in session.notice.text


def test_what_is_cut_away_is_not_under_the_cursor(session: Session) -> None:
    assert session.bounds and session.camera
    session.state.view = View.TESSELLATED
    session.move(LEFT)
    settle(session)
    assert session.inspection.hover and session.inspection.hover.position[1] == pytest.approx(-0.4, abs=1e-3)
    session.planes.add_through_middle(session.bounds, (0, 1, 0), session.camera.direction)
    settle(session)
    assert session.state.sections[0].normal == (0, -1, 0)  # the eye's side is cut away
    assert session.inspection.hover and session.inspection.hover.position[1] == pytest.approx(0.4, abs=1e-3)
    assert session.difference is None
