"""A real window: hovering, selecting, isolating, measuring and cutting, judged by its state and its pixels."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nofacet
from nofacet import image
from windows import FLANGE, User, expected_pick, hide_panels, opened, rest, shown, srgb, until
from xvfb import run_in_window

pytest.importorskip("nofacet_viewer")
pytest.importorskip("glfw")
pytest.importorskip("imgui_bundle")

WIDE = (1000, 620)  # room for the picture beside the panels
MARGIN = 3  # pixels


def inner_pixels(face: np.ndarray) -> np.ndarray:
    """Where a frame shows the same all around, as (n, 2) rows and columns."""
    inside = np.zeros(face.shape, bool)
    middle = face[MARGIN:-MARGIN, MARGIN:-MARGIN]
    height, width = middle.shape
    steps = range(2 * MARGIN + 1)
    same = [face[dy : dy + height, dx : dx + width] == middle for dy in steps for dx in steps]
    inside[MARGIN:-MARGIN, MARGIN:-MARGIN] = np.all(same, axis=0)
    return np.argwhere(inside)


def places(app: Any, count: int) -> list[tuple[int, int]]:
    """Columns and rows in the middle of the largest faces that the frame shows, one of each."""
    face = app.session.exact.frame.face
    inner = inner_pixels(face)
    shown_faces = face[tuple(inner.T)]
    names, sizes = np.unique(shown_faces[shown_faces >= 0], return_counts=True)
    largest = names[np.argsort(-sizes)][:count]
    found = [inner[shown_faces == name] for name in largest]
    return [(int(pixels[len(pixels) // 2][1]), int(pixels[len(pixels) // 2][0])) for pixels in found]


def is_marked(pixels: np.ndarray) -> np.ndarray:
    return (pixels[..., 0] > pixels[..., 2] + 60) & (pixels[..., 1] > 60)


def scenario_hover_and_select() -> None:
    app = opened(FLANGE)
    user, session, inspection = User(app), app.session, app.session.inspection
    hide_panels(app)
    until(app, lambda: bool(np.isfinite(session.described.conversion_error).all()))
    (x, y), (x2, y2) = places(app, 2)
    user.move(x, y)
    rest(app)
    expected = expected_pick(app, x, y)
    assert expected and inspection.hover.face == expected.face == session.exact.frame.face[y, x]
    assert str(inspection.hover).splitlines()[:5] == str(expected).splitlines()[:5]
    assert 0 <= inspection.hover.conversion_error < 1e-10 and inspection.hover.trim_deviation < 1e-3

    rest(app)
    plain = shown(app)
    user.click("left", x, y)
    rest(app)
    assert np.flatnonzero(inspection.selected).tolist() == [expected.face] and inspection.picked == inspection.hover
    marked, inner = shown(app), tuple(inner_pixels(session.exact.frame.face).T)
    chosen = session.exact.frame.face[inner] == expected.face
    assert is_marked(marked[inner][chosen]).all()
    assert (marked[inner][~chosen] == plain[inner][~chosen]).all()

    user.press("t")
    until(app, lambda: session.state.view.value == "tessellated" and session.tessellated.result is not None)
    until(app, lambda: bool(is_marked(shown(app))[inner][chosen].all()))
    user.press("e")
    rest(app)

    user.press("i")
    until(app, lambda: session.drawn is not session.model)
    rest(app)
    assert np.unique(session.exact.frame.face).tolist() == [-1, expected.face]
    assert (shown(app)[y2, x2] == 255).all()
    user.press("a")
    until(app, lambda: session.drawn is session.model)
    rest(app)
    user.press("Escape")
    until(app, lambda: not inspection.selected.any())
    rest(app)
    assert (shown(app) == plain).all()
    app.close()


def scenario_select_in_tree() -> None:
    """What is clicked in the picture is found in the assembly tree, and its part with it."""
    app = opened(FLANGE, size=WIDE)
    user, session, inspection = User(app), app.session, app.session.inspection
    user.click_widget("Assembly")
    panel = app.panels._assembly
    x, y = next(place for place in places(app, 20) if place[0] < 650)
    user.click("left", x, y)
    rest(app)
    face = inspection.picked.face
    until(app, lambda: app._clock.touch() or any(row.face == face for row in panel._rows.rows))
    node = session.model.tree[inspection.picked.node]
    user.click("left", x + 40, y)  # elsewhere, so that the next click is no double click
    user._hands.key("Shift_L", True)
    user.click("left", x, y)
    user._hands.key("Shift_L", False)
    rest(app)
    assert np.flatnonzero(inspection.selected).tolist() == sorted(node.faces.tolist())
    app.close()


def scenario_measure() -> None:
    app = opened(FLANGE)
    user, inspection = User(app), app.session.inspection
    hide_panels(app)
    first, second = places(app, 2)
    rest(app)
    plain = shown(app)
    user.press("m")
    until(app, lambda: inspection.measuring)
    user.click("left", *first)
    until(app, lambda: len(inspection.points) == 1)
    user.click("left", *second)
    until(app, lambda: inspection.measurement is not None)
    picks = [expected_pick(app, *place) for place in (first, second)]
    assert picks[0] and picks[1]
    expected = nofacet.measure(picks[0], picks[1])
    assert str(inspection.measurement) == str(expected) and expected.distance > 1
    assert not inspection.selected.any()
    rest(app)
    changed = (shown(app) != plain).any(axis=2)
    ends = np.array([first, second], float)
    along = ends[0] + np.linspace(0, 1, 200)[:, None] * (ends[1] - ends[0]) + 0.5
    columns, rows = along.astype(int).T
    assert changed[rows, columns].mean() > 0.95  # the line, and its length in the middle
    run = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    away = np.argwhere(changed)[:, ::-1] - ends[0]
    assert np.abs(away[:, 0] * run[1] - away[:, 1] * run[0]).max() < 60 and changed.sum() < 6000  # and nothing else
    user.press("Escape")
    until(app, lambda: not inspection.points)
    rest(app)
    assert (shown(app) == plain).all()
    app.close()


def cap_pixel(app: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Colour that the window should show inside a cap left of the panels, and the one that it does; None without."""
    exact = app.session.shown_exact
    caps = inner_pixels(exact.frame.face)
    scale = exact.frame.width / app.session.size[0]
    caps = caps[(exact.frame.face[tuple(caps.T)] < -1) & (caps[:, 1] < 650 * scale)]
    if not len(caps):
        return None
    row, column = caps[len(caps) // 2]
    place = int((row + 0.5) / scale), int((column + 0.5) / scale)
    return srgb(exact.frame.color[row, column, :3]), shown(app)[place]


def scenario_sections() -> None:
    """A plane is added, dragged, flipped, switched off and removed in the panel; every picture on the way is exact."""
    app = opened(FLANGE, size=WIDE)
    user, session = User(app), app.session
    user.click_widget("Sections")
    user.click_widget("Y")
    until(app, lambda: len(session.state.sections) == 1)
    rest(app)
    assert session.state.sections[0].normal == (0, -1, 0)
    user.to_widget("along")
    user.button(True)
    left, _, right, _ = user.widgets["along"]
    seen = []
    for part in (0.47, 0.44, 0.41, 0.38):
        x, y = left + part * (right - left), session.cursor[1]
        user.move(x, y)
        until(app, lambda: app._clock.touch() or session.state.sections not in seen)
        seen.append(session.state.sections)
        until(app, lambda: session.shown_exact is not None and session.shown_exact.request.sections == seen[-1])
        expected, found = cap_pixel(app) or (0, 9)
        np.testing.assert_allclose(found, expected, atol=2)
        assert app._painted.state.sections == seen[-1]  # both sides
    user.button(False)
    rest(app)
    (section,) = session.state.sections
    assert abs(section.origin[1] - session.bounds.middle[1]) > 0.05 * session.bounds.reach((0, 1, 0))
    frame = nofacet.render(session.drawn, session.camera, WIDE, samples=16, buffers=("face",), sections=[section])
    np.testing.assert_array_equal(session.exact.frame.face, frame.face)
    user.click_widget("flip")
    until(app, lambda: session.state.sections[0].normal == (0, 1, 0))
    user.click_widget("cuts")
    until(app, lambda: not session.state.sections)
    rest(app)
    assert session.exact.frame.face.min() == -1
    user.click_widget("remove")
    until(app, lambda: not session.planes.planes)
    app.close()


def scenario_section_along_a_face() -> None:
    """The key cuts along the face under the cursor; what is cut away is no longer found; an open body is named."""
    app = opened(FLANGE)
    user, session, inspection = User(app), app.session, app.session.inspection
    hide_panels(app)
    x, y = places(app, 1)[0]
    user.move(x, y)
    rest(app)
    pick = inspection.hover
    user.press("n")
    until(app, lambda: len(session.state.sections) == 1)
    assert session.state.sections[0] == nofacet.Section(pick.position, pick.normal)
    (plane,) = session.planes.planes
    session.planes.planes[0] = plane.at_distance(-2.0, plane.origin)
    rest(app)
    expected = expected_pick(app, x, y)
    assert expected and inspection.hover == expected and expected.face != pick.face
    assert not session.warnings
    handle = np.flatnonzero(session.appearance.color[:, 0] > 2 * session.appearance.color[:, 1])
    session.appearance.show(handle[:1], False)
    session.appearance_changed()
    session.planes.add_through_middle(session.bounds, (0, 1, 0), session.camera.direction)
    rest(app)
    assert len(session.warnings) == 1 and "not a closed volume" in session.warnings[0]
    app.close()


def scenario_section_pictures(folder: str) -> None:
    """Planes given at the start cut the first picture, and the clean picture that the user takes."""
    os.chdir(folder)
    section = nofacet.Section((0, 0, 0), (0, -1, 0))
    app = opened(FLANGE, sections=[section])
    assert app.session.exact.frame.face.min() == -2
    app.on_key("F12", frozenset({"Ctrl"}))
    until(app, lambda: len(app.pictures) == 1)
    pixels, channels, _ = image.read(app.pictures[0])
    frame = nofacet.render(
        app.session.model, app.session.camera, app.session.size, samples=16, buffers=("coverage",), sections=[section]
    )
    assert np.abs(pixels[..., channels.index("A")] - frame.coverage).max() <= 0.5 / 255 + 1e-6
    app.on_drop([FLANGE])
    until(app, lambda: app.session.loader.path is None)
    assert app.session.state.sections == (section,)  # the same file
    app.close()


@pytest.mark.parametrize(
    "scenario", ["hover_and_select", "select_in_tree", "measure", "sections", "section_along_a_face"]
)
def test_inspecting(scenario: str) -> None:
    run_in_window("test_window_inspection", f"scenario_{scenario}")


def test_pictures_with_sections(tmp_path: Path) -> None:
    run_in_window("test_window_inspection", "scenario_section_pictures", str(tmp_path))
