"""Draws the pictures of the viewer in docs/images again: xvfb-run -s "-screen 0 1400x900x24" python docs/view_images.py

Those with panels are taken of a real window and need a display; the others are drawn off screen.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import nofacet
from nofacet_viewer.app import App, Options
from nofacet_viewer.controls import Button
from nofacet_viewer.keymap import Keymap
from nofacet_viewer.offscreen import side_resolution, write_view
from nofacet_viewer.panel_clock import SETTLING_TURNS
from nofacet_viewer.session import Session
from nofacet_viewer.state import View

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
SIZE = (960, 540)
WINDOW = (1280, 720)
MEASURED = (421.0, 208.0), (640.0, 497.0)  # places in the window
PATIENCE = 120.0  # seconds for a window's picture
OWN = ROOT / "cad_models"
CTC_02 = ROOT.parent / "shared" / "models" / "nist" / "nist_ctc_02_asme1_rc.stp"  # third-party, beside the repository

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Picture:
    """direction: from the eye into the scene. setting: of nofacet.MESH_SETTINGS."""

    source: Path
    view: View
    direction: Vector
    overlays: tuple[str, ...] = ()
    setting: str = "Mayo"


FLANGE, TEAPOT, BOTTLE = (OWN / f"{name}.step" for name in ("flange", "teapot", "bottle"))
FROM_FLANGE, FROM_TEAPOT, FROM_BOTTLE, FROM_CTC = (-1, 1, -0.8), (0.6, 1, -0.4), (-1, 1, -0.4), (-1, 1, -0.9)

# Blink shows the exact and the tessellated picture in turn, so these two are its pictures.
VIEWS = {
    f"view_{view.value.replace('-', '_')}_{name}": Picture(source, view, direction, setting=setting)
    for name, source, direction, setting in (
        ("flange", FLANGE, FROM_FLANGE, "FreeCAD"),
        ("ctc_02", CTC_02, FROM_CTC, "F3D"),
        ("teapot", TEAPOT, FROM_TEAPOT, "F3D"),
    )
    for view in View
    if view is not View.BLINK
}
OVERLAYS = {
    "view_edges_ctc_02": Picture(CTC_02, View.SIDE_BY_SIDE, FROM_CTC, ("edges",)),
    "view_mesh_edges": Picture(TEAPOT, View.WIPE, FROM_TEAPOT, ("mesh-edges",), "F3D"),
    "view_zebra": Picture(BOTTLE, View.SIDE_BY_SIDE, FROM_BOTTLE, ("zebra",)),
    "view_curvature": Picture(FLANGE, View.WIPE, FROM_FLANGE, ("curvature",)),
    "view_control_nets": Picture(TEAPOT, View.EXACT, FROM_TEAPOT, ("control-nets", "patch-borders")),
    "view_patch_borders": Picture(FLANGE, View.SIDE_BY_SIDE, FROM_FLANGE, ("patch-borders",)),
    "view_conversion_error": Picture(FLANGE, View.EXACT, FROM_FLANGE, ("conversion-error",)),
}


def main() -> None:
    with TemporaryDirectory() as folder:
        os.chdir(folder)  # where F12 writes
        draw_windows()  # before OpenGL without a window
        os.chdir(ROOT)
    for name, picture in (VIEWS | OVERLAYS).items():
        if not picture.source.exists():
            print(f"{name}: {picture.source} is not there, so its picture stays as it is")
            continue
        model = nofacet.load(picture.source, measure=True)
        camera = nofacet.Camera.fit(model, picture.direction, resolution=side_resolution(picture.view, SIZE))
        setting = nofacet.MESH_SETTINGS[picture.setting]
        path = IMAGES / f"{name}.png"
        write_view(picture.source, path, picture.view, SIZE, camera, picture.overlays, setting, model=model)


def draw_windows() -> None:
    """The window with its panels, with its list of keys, and with a cut that is measured."""
    try:
        app = App(Options([str(FLANGE)], size=WINDOW), Keymap())
    except nofacet.InputError as problem:
        print(f"pictures of the window stay as they are: {problem}")
        return
    session = app.session
    session.tessellated.choice = "FreeCAD"
    wait(app, lambda: session.difference is not None and is_measured(session))
    assert session.camera
    camera = session.camera.orbit(20, 10)
    session.camera = camera.zoom(1.5)  # drawn again, while nothing else goes on
    wait(app, lambda: session.difference is not None and is_full(session))
    screenshot(app, "window")
    app.on_key("H", frozenset())
    screenshot(app, "window_help")
    app.on_key("H", frozenset())
    app.on_key("E", frozenset())
    session.camera = camera.zoom(1.4).pan(-130, 30, WINDOW)
    session.planes.add((0.0, 0.0, 0.0), (0.0, -1.0, 0.0))
    wait(app, lambda: is_full(session))
    app.on_key("M", frozenset())
    for at in MEASURED:
        app.on_move(at)
        app.on_press(Button.LEFT, at, frozenset())
        app.on_release(Button.LEFT, at)
        wait(app, lambda: not session.inspection.busy)
    screenshot(app, "window_section")
    app.close()


def is_full(session: Session) -> bool:
    """Whether the picture is in full quality."""
    exact = session.exact
    return exact is not None and exact.is_full and exact.request.camera == session.camera


def is_measured(session: Session) -> bool:
    """Whether the errors of the conversion are known."""
    return session.described is not None and bool(np.isfinite(session.described.conversion_error).any())


def screenshot(app: App, name: str) -> None:
    """What F12 writes, moved to the pictures."""
    for _ in range(SETTLING_TURNS + 1):
        app.step(0.0)
    app.session.notice = None
    before = len(app.pictures)
    app.on_key("F12", frozenset())
    wait(app, lambda: len(app.pictures) > before)
    shutil.move(app.pictures[-1], IMAGES / f"{name}.png")


def wait(app: App, done: Callable[[], bool]) -> None:
    """Let the window live until `done`."""
    end = time.monotonic() + PATIENCE
    while not done():
        if time.monotonic() > end:
            raise TimeoutError(f"the window did not come to rest; notice: {app.session.notice}")
        app.step(0.01)


if __name__ == "__main__":
    main()
