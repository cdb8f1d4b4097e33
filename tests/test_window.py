"""A real window: driven by the X server's input, judged by its state and its pixels."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nofacet
from nofacet import cli, image
from windows import BALLOON, FLANGE, SIZE, User, hide_panels, opened, rest, shown, srgb, until
from xvfb import run_in_window

pytest.importorskip("nofacet_viewer")
pytest.importorskip("glfw")
pytest.importorskip("imgui_bundle")


def moved_from(app: Any, camera: nofacet.Camera) -> None:
    until(app, lambda: app.session.camera is not camera)


def view_is(app: Any, name: str) -> None:
    until(app, lambda: app.session.state.view.value == name)


def blinks_to(app: Any, exact: bool) -> None:
    until(app, lambda: app.session.state.blink_exact is exact)


# Keys and mouse, through the X server


def scenario_keys() -> None:
    app = opened(FLANGE)
    user, session = User(app), app.session
    user.move(300, 240)
    for key, direction in (
        ("1", (0, 1, 0)),
        ("3", (-1, 0, 0)),
        ("7", (0, 0, -1)),
        ("9", np.array((-1, 1, -1)) / 3**0.5),
    ):
        before = session.camera
        user.press(key)
        moved_from(app, before)
        np.testing.assert_allclose(session.camera.direction, direction, atol=1e-9)
    user.press("5")
    until(app, lambda: session.camera.projection == "perspective")
    session.wheel(3.0)
    before = session.camera
    user.press("KP_Enter")
    moved_from(app, before)
    assert session.camera.projection == "perspective"
    user.press("h")
    until(app, lambda: app.panels.help)
    user.press("z")
    until(app, lambda: "zebra" in session.state.overlays)
    for key, view in (("w", "wipe"), ("d", "difference"), ("s", "side-by-side"), ("t", "tessellated"), ("e", "exact")):
        user.press(key)
        view_is(app, view)
    user.press("Control_L", "q")
    until(app, lambda: app.closed)
    app.close()


def scenario_mouse() -> None:
    app = opened(FLANGE)
    user, session = User(app), app.session
    hide_panels(app)
    start = 300, 240
    before = session.camera
    user.drag("left", start, (80, 0))
    assert session.camera.focal_point == before.focal_point
    assert session.camera.position[2] == pytest.approx(before.position[2])
    assert not np.allclose(session.camera.direction, before.direction)
    for button, held in (("middle", ()), ("left", ("Shift_L",))):
        before = session.camera
        user.drag(button, start, (50, 20), *held)
        np.testing.assert_allclose(session.camera.direction, before.direction, atol=1e-12)
        x, y, _, w = session.camera.pixel_from_world(SIZE) @ [*before.focal_point, 1.0]
        assert (x / w, y / w) == pytest.approx((370, 260), abs=0.01)
    before = session.camera
    user.drag("right", start, (0, -60))
    assert session.camera.view_height < before.view_height
    before = session.camera
    user.wheel("up")
    assert session.camera.view_height == pytest.approx(before.view_height / 1.1)


def scenario_cursor() -> None:
    """Ctrl+wheel zooms to the point under the cursor, the middle button centres on it."""
    app = opened(FLANGE)
    user, session = User(app), app.session
    hide_panels(app)
    rest(app)
    faces = session.exact.frame.face
    row, column = (int(value) for value in np.argwhere(faces >= 0)[len(np.argwhere(faces >= 0)) // 2])
    user.move(column, row)
    hover = session.hover
    assert hover and hover.face == faces[row, column]
    user.wheel("up", "Control_L")
    x, y, _, w = session.camera.pixel_from_world(SIZE) @ [*hover.point, 1.0]
    assert (x / w, y / w) == pytest.approx((column + 0.5, row + 0.5), abs=1e-6)
    rest(app)
    hover = session.hover
    user.click("middle", column, row)
    assert session.camera.focal_point == pytest.approx(hover.point)
    app.close()


def scenario_pixels() -> None:
    """The window shows what render() draws, and after a drag again."""
    app = opened(FLANGE)
    user = User(app)
    hide_panels(app)
    for turn in range(2):
        rest(app)
        frame = nofacet.render(app.session.model, app.session.camera, SIZE, samples=16).over((1.0, 1.0, 1.0))
        assert np.abs(shown(app) - srgb(frame.color[..., :3])).max() <= 2
        if turn == 0:
            user.drag("left", (300, 240), (40, 20))


def scenario_wipe() -> None:
    app = opened(FLANGE, view="wipe")
    user, tessellated = User(app), app.session.tessellated
    hide_panels(app)
    until(app, lambda: tessellated.result is not None)
    camera = app.session.camera
    user.drag("left", (320, 100), (160, 0))
    assert app.session.state.wipe == pytest.approx(0.75, abs=0.01)
    assert app.session.camera is camera
    until(app, lambda: tessellated.difference is not None)
    mesh, error = tessellated.result.mesh, tessellated.difference.error
    assert 0 < error.largest < 5
    tessellated.choice = "FreeCAD"
    app.session.mesh()
    until(app, lambda: tessellated.result.mesh is not mesh)
    until(app, lambda: tessellated.difference is not None)
    assert tessellated.difference.error.largest > error.largest  # a coarser mesh
    app.close()


def scenario_blink() -> None:
    app = opened(FLANGE, view="blink")
    until(app, lambda: app.session.tessellated.result is not None)
    for side in (True, False, True):
        blinks_to(app, side)
    app.close()


def scenario_progress() -> None:
    """A progress bar is no reason to draw all the time: reading needs the processor, too."""
    from nofacet_viewer.panel_clock import BUSY_SECONDS, SETTLING_TURNS

    app = opened(FLANGE)
    app.session.reload()
    until(app, lambda: app._clock.patience(time.monotonic()) > 0)
    start, drawn = time.monotonic(), 0
    while app.session.loader.awaited:
        drawn += app.step(0.0)
    assert 0 < drawn <= (time.monotonic() - start) / BUSY_SECONDS + 2 * SETTLING_TURNS
    app.close()


def scenario_panels() -> None:
    """Panels are copied before a picture as imgui draws them; a motion does not draw them anew each time."""
    app = opened(FLANGE, view="side-by-side", size=(960, 540))
    user, panels = User(app), app.window._panels
    copied = shown(app)
    panels._kept = False
    np.testing.assert_array_equal(copied, shown(app))
    panels._kept = True
    hide_panels(app)
    assert (copied != shown(app)).mean() > 0.05  # they were there
    app.on_key("Tab", frozenset())

    calls: list[str] = []
    draw_panels, present = app.panels.draw, app.window.present

    def noted(name: str, call: Callable[[], None]) -> Callable[[], None]:
        def call_it() -> None:
            calls.append(name)
            call()

        return call_it

    app.panels.draw, app.window.present = noted("panels", draw_panels), noted("picture", present)
    user.move(300, 240)
    user.hold("left", True)
    until(app, lambda: app._clock.patience(time.monotonic()) > 0)
    calls.clear()
    for step in range(40):
        user.move(300 + step % 2, 241 + step)
    assert calls.count("panels") < calls.count("picture") / 2
    user.hold("left", False)
    rest(app)
    last = shown(app)
    app.window.draw(app._paint, draw_panels)
    np.testing.assert_array_equal(last, shown(app))  # nothing out of date is left
    app.close()


@pytest.mark.parametrize("scenario", ["keys", "mouse", "cursor", "pixels", "wipe", "blink", "progress", "panels"])
def test_keys_and_mouse(scenario: str) -> None:
    run_in_window("test_window", f"scenario_{scenario}")


# Files


def scenario_files(folder: str) -> None:
    app = opened()
    assert app.session.path is None
    app.step()
    bad = str(Path(folder, "empty.step"))
    Path(bad).write_text("")
    app.on_drop([bad])
    until(app, lambda: app.session.notice is not None)
    line = subprocess.run([sys.executable, "-m", "nofacet", "info", bad], capture_output=True, text=True).stderr
    assert line.strip() == f"nofacet: {app.session.notice.text}"
    assert app.session.notice.text == f"{bad}: is empty; export or copy the model again"
    app.on_drop([FLANGE, BALLOON])
    until(app, lambda: app.session.model is not None)
    rest(app)
    assert app.session.notice is None
    faces = app.session.model.face_count
    app.on_key("Right", frozenset())
    until(app, lambda: app.session.model.source == BALLOON)
    assert app.session.model.face_count != faces
    rest(app)
    app.on_key("Right", frozenset())
    until(app, lambda: app.session.model.source == FLANGE)
    rest(app)
    app.close()


def scenario_watch(folder: str) -> None:
    path = str(Path(folder, "part.step"))
    shutil.copy(FLANGE, path)
    app = opened(path, watch=True)
    faces = app.session.model.face_count
    app.on_key("1", frozenset())
    before = app.session.camera
    moved_from(app, before)
    app.session.wheel(5.0)
    camera = app.session.camera
    shutil.copy(BALLOON, path)
    until(app, lambda: app.session.model.face_count != faces)
    rest(app)
    assert app.session.camera == camera
    Path(path).write_text("no longer a model")
    until(app, lambda: app.session.notice is not None and app.session.notice.is_problem)
    assert app.session.exact.is_full  # what was shown stays
    app.close()


def scenario_cancel() -> None:
    app = opened()
    app.on_drop([FLANGE])
    app.step()
    assert app.session.loader.path == FLANGE
    app.session.cancel_reading()
    assert app.session.notice.text == f"{FLANGE}: reading was called off"
    assert app.session.loader.path is None
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        app.step(0.01)
    assert app.session.model is None  # and none comes
    app.close()


def scenario_pictures(folder: str) -> None:
    import os

    os.chdir(folder)
    app = opened(FLANGE)
    app.on_key("F12", frozenset())
    until(app, lambda: len(app.pictures) == 1)
    app.on_key("F12", frozenset({"Ctrl"}))
    until(app, lambda: len(app.pictures) == 2)
    assert [path.name for path in app.pictures] == ["flange-1.png", "flange-2.png"]
    camera = app.session.camera
    assert nofacet.Camera.load(app.pictures[0]) == nofacet.Camera.load(app.pictures[1]) == camera
    window, _, _ = image.read(app.pictures[0])
    exact, channels, _ = image.read(app.pictures[1])
    assert window.shape[:2] == exact.shape[:2] == (480, 640)
    alpha = exact[..., channels.index("A")]
    coverage = nofacet.render(app.session.model, camera, SIZE, samples=16, buffers=("coverage",)).coverage
    assert np.abs(alpha - coverage).max() <= 0.5 / 255 + 1e-6
    assert len(np.unique(alpha)) > 10  # smooth
    app.close()


def red_pixels(app: Any) -> int:
    rest(app)
    picture = shown(app)
    return int((picture[..., 0] > picture[..., 1] + 50).sum())


def scenario_appearance() -> None:
    app = opened(FLANGE)
    hide_panels(app)
    appearance = app.session.appearance
    handle = np.flatnonzero(appearance.color[:, 0] > 2 * appearance.color[:, 1])  # is red in the file
    red = red_pixels(app)
    assert red > 500
    appearance.show(handle, False)
    app.session.appearance_changed()
    assert red_pixels(app) == 0
    app.on_key("A", frozenset())
    assert red_pixels(app) == red
    app.close()


def scenario_camera_of_a_picture(folder: str) -> None:
    camera = nofacet.Camera("perspective", (150, -200, 90), (5, 6, 7), view_angle=20.0)
    app = opened(FLANGE, camera=camera)
    assert app.session.camera == camera
    app.close()


@pytest.mark.parametrize("scenario", ["files", "watch", "pictures", "camera_of_a_picture"])
def test_files_and_pictures(scenario: str, tmp_path: Path) -> None:
    run_in_window("test_window", f"scenario_{scenario}", str(tmp_path))


def scenario_show() -> None:
    """What comes from Python is shown, with its camera; it has no triangles, and the window says so."""
    import cadquery as cq

    from nofacet_viewer.app import App

    apps: list[Any] = []

    def run(app: Any) -> None:
        apps.append(app)
        rest(app)
        hide_panels(app)
        picture = shown(app)
        assert (picture[240, 100] == 255).all() and (picture[240, 320] < 250).any()
        app.on_key("T", frozenset())
        until(app, lambda: app.session.state.view.value == "tessellated")
        assert "not meshed" in app.session.tessellated.problem
        app.close()

    App.run = run  # type: ignore[assignment,method-assign]
    assert nofacet.show(cq.Workplane().sphere(3), direction="front", width=640, height=480, title="ball") is None
    (session,) = (app.session for app in apps)
    np.testing.assert_allclose(session.camera.direction, (0, 1, 0), atol=1e-12)
    assert session.size == SIZE and session.loader.path is None and session.notice is None


@pytest.mark.parametrize("scenario", ["cancel", "appearance", "show"])
def test_reading_and_appearance(scenario: str) -> None:
    run_in_window("test_window", f"scenario_{scenario}")


# The command line


def test_without_a_display_there_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    command = [sys.executable, "-c", "from nofacet.cli import main; raise SystemExit(main())", "view", FLANGE]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert result.returncode == 1
    assert result.stderr.startswith("nofacet: no window can be opened (")
    assert "--output=FILE.png" in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "nofacet_viewer.app", None)
    monkeypatch.delitem(sys.modules, "glfw", raising=False)
    assert cli.main(["view", FLANGE]) == 1
    line = capsys.readouterr().err
    assert line == "nofacet: the viewer needs the module nofacet_viewer: pip install 'nofacet[viewer]'\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--view=wip", "a.step"], "--view: unknown view 'wip'; did you mean wipe?"),
        (
            ["--camera=missing.json", "a.step"],
            "missing.json: No such file or directory; give a camera file, or a picture that nofacet made",
        ),
        (
            ["--section=0,0,0", "a.step"],
            "argument --section: '0,0,0' is not ORIGIN/NORMAL; write for example 0,0,10/0,0,1 "
            "(see nofacet view --help)",
        ),
        (["--output=a.png", "a.step", "b.step"], "--output draws one model once; give one MODEL and leave out --watch"),
    ],
)
def test_wrong_usage(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["view", *arguments]) == 2
    assert capsys.readouterr().err == f"nofacet: {message}\n"
