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
from xvfb import Hands, run_in_window

pytest.importorskip("nofacet_viewer")
pytest.importorskip("glfw")
pytest.importorskip("imgui_bundle")

MODELS = Path(__file__).resolve().parents[1] / "cad_models"
FLANGE, BALLOON = str(MODELS / "flange.step"), str(MODELS / "balloon.step")
SIZE = (640, 480)


def opened(*files: str, view: str = "exact", **options: Any) -> Any:
    """An app whose window is open and whose first file, if any, is shown in full quality."""
    from nofacet_viewer.app import App, Options
    from nofacet_viewer.keymap import Keymap
    from nofacet_viewer.state import View

    app = App(Options(files, View(view), size=SIZE, **options), Keymap())
    if files:
        until(app, lambda: app.session.model is not None)
        rest(app)
    return app


def until(app: Any, condition: Callable[[], bool], seconds: float = 120.0) -> None:
    """Let the window live until something has happened."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"nothing happened; notice: {app.session.notice}"
        app.step(0.01)


def rest(app: Any) -> None:
    """Until the exact picture is in full quality and everything that is known is shown."""
    session = app.session

    def done() -> bool:
        exact = session.exact
        full = (
            exact and exact.is_full and (exact.request.camera, exact.request.model) == (session.camera, session.drawn)
        )
        return bool(full and not session.tasks.running and not session.tessellated.busy and not app._frames_due)

    until(app, done)


def live(app: Any, seconds: float = 0.3) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        app.step(0.01)


def moved_from(app: Any, camera: nofacet.Camera) -> None:
    until(app, lambda: app.session.camera is not camera)


def view_is(app: Any, name: str) -> None:
    until(app, lambda: app.session.state.view.value == name)


def blinks_to(app: Any, exact: bool) -> None:
    until(app, lambda: app.session.state.blink_exact is exact)


def shown(app: Any) -> np.ndarray:
    """The window's pixels (height, width, 3)."""
    return app.window.pixels(app._picture)


# Keys and mouse, through the X server


def scenario_keys() -> None:
    app, hands = opened(FLANGE), Hands()
    hands.move(300, 240)
    for key, direction in (
        ("1", (0, 1, 0)),
        ("3", (-1, 0, 0)),
        ("7", (0, 0, -1)),
        ("9", np.array((-1, 1, -1)) / 3**0.5),
    ):
        before = app.session.camera
        hands.press(key)
        moved_from(app, before)
        np.testing.assert_allclose(app.session.camera.direction, direction, atol=1e-9)
    hands.press("5")
    until(app, lambda: app.session.camera.projection == "perspective")
    hands.press("KP_Enter")
    live(app)
    assert app.session.camera.projection == "perspective"
    hands.press("h")
    until(app, lambda: app.panels.help)
    hands.press("z")
    until(app, lambda: "zebra" in app.session.state.overlays)
    for key, view in (("w", "wipe"), ("d", "difference"), ("s", "side-by-side"), ("t", "tessellated"), ("e", "exact")):
        hands.press(key)
        view_is(app, view)
    hands.press("Control_L", "q")
    until(app, lambda: app.closed)
    app.close()


def scenario_mouse() -> None:
    app, hands = opened(FLANGE), Hands()
    app.on_key("Tab", frozenset())
    live(app)
    session = app.session

    def drag(button: str, x: float, y: float, *held: str) -> None:
        hands.move(300, 240)
        live(app, 0.1)
        for key in held:
            hands.key(key, True)
        hands.button(button, True)
        for step in range(1, 6):
            hands.move(300 + x * step / 5, 240 + y * step / 5)
            live(app, 0.05)
        hands.button(button, False)
        for key in held:
            hands.key(key, False)
        live(app, 0.1)

    before = session.camera
    drag("left", 80, 0)
    assert session.camera.focal_point == before.focal_point
    assert session.camera.position[2] == pytest.approx(before.position[2])
    assert not np.allclose(session.camera.direction, before.direction)
    for button, held in (("middle", ()), ("left", ("Shift_L",))):
        before = session.camera
        drag(button, 50, 20, *held)
        np.testing.assert_allclose(session.camera.direction, before.direction, atol=1e-12)
        x, y, _, w = session.camera.pixel_from_world(SIZE) @ [*before.focal_point, 1.0]
        assert (x / w, y / w) == pytest.approx((370, 260), abs=0.01)
    before = session.camera
    drag("right", 0, -60)
    assert session.camera.view_height < before.view_height
    before = session.camera
    hands.click("wheel up")
    until(app, lambda: session.camera.view_height == pytest.approx(before.view_height / 1.1))
    rest(app)
    faces = session.exact.frame.face
    row, column = (int(values.mean()) for values in np.nonzero(faces >= 0))
    row, column = next(
        (r, c) for r, c in zip(*np.nonzero(faces >= 0), strict=True) if abs(r - row) + abs(c - column) < 90
    )
    hands.move(column, row)
    live(app, 0.2)
    hover, before = session.hover, session.camera
    assert hover and hover.face == faces[row, column]
    hands.key("Control_L", True)
    hands.click("wheel up")
    until(app, lambda: session.camera is not before)
    hands.key("Control_L", False)
    x, y, _, w = session.camera.pixel_from_world(SIZE) @ [*hover.point, 1.0]
    assert (x / w, y / w) == pytest.approx((column + 0.5, row + 0.5), abs=1e-6)
    rest(app)
    hover = session.hover
    hands.click("middle")
    until(app, lambda: session.camera.focal_point == pytest.approx(hover.point))
    app.close()


def scenario_pixels() -> None:
    """The window shows what render() draws, and after a drag again."""
    app, hands = opened(FLANGE), Hands()
    app.on_key("Tab", frozenset())
    for turn in range(2):
        rest(app)
        live(app)
        frame = nofacet.render(app.session.model, app.session.camera, SIZE, samples=16).over((1.0, 1.0, 1.0))
        linear = frame.color[..., :3]
        srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.clip(linear, 0, 1) ** (1 / 2.4) - 0.055)
        assert np.abs(shown(app) - np.rint(255 * srgb)).max() <= 2
        if turn == 0:
            hands.move(300, 240)
            hands.button("left", True)
            hands.move(340, 260)
            live(app)
            hands.button("left", False)


def scenario_wipe() -> None:
    app, hands = opened(FLANGE, view="wipe"), Hands()
    app.on_key("Tab", frozenset())
    until(app, lambda: app.session.tessellated.result is not None)
    camera = app.session.camera
    hands.move(320, 100)
    live(app, 0.1)
    hands.button("left", True)
    hands.move(400, 100)
    live(app, 0.1)
    hands.move(480, 100)
    live(app, 0.1)
    hands.button("left", False)
    live(app)
    assert app.session.state.wipe == pytest.approx(0.75, abs=0.01)
    assert app.session.camera is camera
    until(app, lambda: app.session.tessellated.difference is not None)
    mesh, error = app.session.tessellated.result.mesh, app.session.tessellated.difference.error
    assert 0 < error.largest < 5
    app.session.tessellated.choice = "FreeCAD"
    app.session.mesh()
    until(app, lambda: app.session.tessellated.result.mesh is not mesh)
    until(app, lambda: app.session.tessellated.difference is not None)
    assert app.session.tessellated.difference.error.largest > error.largest  # a coarser mesh
    app.close()


def scenario_blink() -> None:
    app = opened(FLANGE, view="blink")
    until(app, lambda: app.session.tessellated.result is not None)
    for side in (True, False, True):
        blinks_to(app, side)
    app.close()


@pytest.mark.parametrize("scenario", ["keys", "mouse", "pixels", "wipe", "blink"])
def test_keys_and_mouse(scenario: str) -> None:
    run_in_window("test_window", f"scenario_{scenario}")


# Files


def scenario_files(folder: str) -> None:
    app = opened()
    assert app.session.path is None
    live(app, 0.1)
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
    live(app, 0.15)
    assert app.session.loader.path == FLANGE
    app.session.cancel_reading()
    live(app, 0.5)
    assert app.session.model is None
    assert app.session.notice.text == f"{FLANGE}: reading was called off"
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


def scenario_appearance() -> None:
    app = opened(FLANGE)
    app.on_key("Tab", frozenset())
    appearance = app.session.appearance
    handle = np.flatnonzero(appearance.color[:, 0] > 2 * appearance.color[:, 1])  # is red in the file
    rest(app)
    live(app)
    picture = shown(app).astype(int)
    red = (picture[..., 0] > picture[..., 1] + 50).sum()
    assert red > 500
    appearance.show(handle, False)
    app.session.appearance_changed()
    rest(app)
    live(app)
    picture = shown(app).astype(int)
    assert (picture[..., 0] > picture[..., 1] + 50).sum() == 0
    app.on_key("A", frozenset())
    rest(app)
    live(app)
    picture = shown(app).astype(int)
    assert (picture[..., 0] > picture[..., 1] + 50).sum() == red
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
        live(app)
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
        (["--camera=missing.json", "a.step"], "missing.json: No such file or directory"),
        (["--output=a.png", "a.step", "b.step"], "--output draws one model once; give one MODEL and leave out --watch"),
    ],
)
def test_wrong_usage(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["view", *arguments]) == 2
    assert capsys.readouterr().err == f"nofacet: {message}\n"
