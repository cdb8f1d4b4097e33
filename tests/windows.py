"""A real window for tests, and hands that wait until it has seen what they do: on a busy machine that takes a while."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import nofacet
from xvfb import Hands

MODELS = Path(__file__).resolve().parents[1] / "cad_models"
FLANGE, BALLOON = str(MODELS / "flange.step"), str(MODELS / "balloon.step")
SIZE = (640, 480)


def opened(*files: str, view: str = "exact", size: tuple[int, int] = SIZE, **options: Any) -> Any:
    """An app whose window is open and whose first file, if any, is shown in full quality."""
    from nofacet_viewer.app import App, Options
    from nofacet_viewer.keymap import Keymap
    from nofacet_viewer.state import View

    app = App(Options(files, View(view), size=size, **options), Keymap())
    if files:
        until(app, lambda: app.session.model is not None)
        rest(app)
    return app


def until(app: Any, condition: Callable[[], bool], seconds: float = 240.0) -> None:
    """Let the window live until something has happened."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"nothing happened; notice: {app.session.notice}"
        app.step(0.01)


def rest(app: Any) -> None:
    """Until the exact picture is in full quality, everything that is known is shown and nothing is being done."""
    session = app.session

    def done() -> bool:
        app.step(0.01)
        exact = session.exact
        wanted = session.camera, session.drawn, session.state.sections
        full = exact and exact.is_full and (exact.request.camera, exact.request.model, exact.request.sections) == wanted
        busy = session.tasks.running or session.tessellated.busy or session.inspection.busy or panels_due(app)
        return bool(full and not busy)

    until(app, done)


def panels_due(app: Any) -> bool:
    """Whether panels are to be drawn again, now or soon."""
    return bool(app._clock.patience(time.monotonic()) < math.inf)


def shown(app: Any) -> np.ndarray:
    """The window's pixels (height, width, 3), 8-bit sRGB, as int."""
    return np.asarray(app.window.pixels(app._paint)).astype(int)


def srgb(linear: np.ndarray) -> np.ndarray:
    """Linear values as the window shows them, from 0 to 255."""
    return np.rint(
        255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.clip(linear, 0, 1) ** (1 / 2.4) - 0.055)
    )


def hide_panels(app: Any) -> None:
    """So that every pixel is the picture's."""
    app.on_key("Tab", frozenset())
    until(app, lambda: not panels_due(app))


class User:
    """Hands on an app. Each method returns when the app has taken notice."""

    def __init__(self, app: Any) -> None:
        self._app = app
        self._hands = Hands()
        self.widgets: dict[str, tuple[float, float, float, float]] = {}
        self._watch_widgets()

    def move(self, x: float, y: float) -> None:
        self._hands.move(x, y)
        until(self._app, lambda: self._app.session.cursor == (round(x), round(y)))
        self._app.step(0.01)  # imgui knows of it one picture later

    def hold(self, button: str, down: bool) -> None:
        """Press or let go a mouse button over the picture."""
        self._hands.button(button, down)
        until(self._app, lambda: (self._app.session.controls.drag is not None) == down)

    def click(self, button: str, x: float, y: float) -> None:
        """Over the picture."""
        self.move(x, y)
        self.hold(button, True)
        self.hold(button, False)

    def drag(self, button: str, start: tuple[float, float], by: tuple[float, float], *held: str) -> None:
        """Over the picture, in five steps, with keys held down."""
        self.move(*start)
        for key in held:
            self._hands.key(key, True)
        self.hold(button, True)
        for step in range(1, 6):
            self.move(start[0] + by[0] * step / 5, start[1] + by[1] * step / 5)
        self.hold(button, False)
        for key in held:
            self._hands.key(key, False)

    def wheel(self, direction: str, *held: str) -> None:
        """direction: up or down."""
        before = self._app.session.camera
        for key in held:
            self._hands.key(key, True)
        self._hands.click(f"wheel {direction}")
        until(self._app, lambda: self._app.session.camera is not before)
        for key in held:
            self._hands.key(key, False)

    def press(self, *keysyms: str) -> None:
        """Keys, all at once; what they do is for the caller to wait for."""
        self._hands.press(*keysyms)

    # Panels

    def to_widget(self, label: str, part: float = 0.5) -> None:
        """Over a widget of a panel, at a part of its width."""
        until(self._app, lambda: self._touched() and label in self.widgets)
        left, top, right, bottom = self.widgets[label]
        self.move(left + part * (right - left), (top + bottom) / 2)
        until(self._app, lambda: self._touched() and self._app.window.over_panel)

    def button(self, down: bool) -> None:
        """The left mouse button over a widget."""
        from imgui_bundle import imgui

        self._hands.button("left", down)
        until(self._app, lambda: self._touched() and imgui.is_mouse_down(imgui.MouseButton_.left.value) == down)
        self._app._clock.touch()
        self._app.step(0.01)

    def click_widget(self, label: str) -> None:
        self.to_widget(label)
        self.button(True)
        self.button(False)

    def _touched(self) -> bool:
        """Panels are drawn again in the next step."""
        self._app._clock.touch()
        return True

    def _watch_widgets(self) -> None:
        """Keep where widgets are, by their labels."""
        from imgui_bundle import imgui

        def watched(make: Callable[..., Any]) -> Callable[..., Any]:
            def made(label: str, *arguments: Any) -> Any:
                result = make(label, *arguments)
                low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
                self.widgets[label] = low.x, low.y, high.x, high.y
                return result

            return made

        for name in ("slider_float", "small_button", "collapsing_header", "checkbox"):
            setattr(imgui, name, watched(getattr(imgui, name)))


def expected_pick(app: Any, x: int, y: int) -> nofacet.Pick | None:
    """What is at the centre of a pixel of a window that shows one side."""
    session = app.session
    place = session.camera, session.size, x + 0.5, y + 0.5
    return nofacet.pick(session.drawn, *place, sections=session.state.sections)
