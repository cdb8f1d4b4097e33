"""The viewer: one session in one window.

The main thread handles input, paints and draws panels; reading, meshing, exact frames and everything else that takes
longer than a few milliseconds goes on elsewhere and wakes it when there is something new.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nofacet

from .actions import perform
from .controls import Button, Point
from .exact import Exact, ExactRenderer, Request
from .keymap import Keymap, KeymapError
from .loading import Fit, fit_camera
from .meshing import MeshResult
from .painter import Painter
from .panel_clock import SETTLING_TURNS, PanelClock
from .panels.all import Panels
from .pictures import picture_path, save_exact, save_window
from .session import BLINK_SECONDS, Session
from .srgb import encoded
from .state import View, ViewState
from .tessellated import POLL_SECONDS as MESH_POLL_SECONDS
from .window import Window

TITLE = "nofacet"
SIZE = (1280, 720)
IDLE_SECONDS = 0.25  # between looks at the clock and at files
POLL_SECONDS = 0.01  # between looks whether the painter can go on
REST_SECONDS = 0.1  # without a motion until the painter refines what it has painted


@dataclass(frozen=True)
class Options:
    """What the command line of `nofacet view` says. size: of the window. camera: None fits the model by `fit`.
    timeout: seconds for reading a file."""

    files: Sequence[str] = ()
    view: View = View.SIDE_BY_SIDE
    camera: nofacet.Camera | None = None
    size: tuple[int, int] = SIZE
    watch: bool = False
    sections: Sequence[nofacet.Section] = ()
    fit: Fit = fit_camera
    timeout: float = 300.0


@dataclass
class Painted:
    """What the painter has been given, and what the picture shows."""

    model: nofacet.Model | None = None
    meshed: MeshResult | None = None
    difference: Any = None
    exact: Exact | None = None
    selected: Any = None
    state: ViewState = field(default_factory=ViewState)
    camera: nofacet.Camera | None = None
    size: tuple[int, int] = (0, 0)


class App:
    """Opens the window at once. `session` is what it shows."""

    def __init__(self, options: Options, keymap: Keymap | None = None) -> None:
        """Raises InputError where no window can be opened."""
        self.window = Window(TITLE, options.size)
        self.session = Session(
            options.files,
            options.view,
            options.camera,
            self.window.size,
            options.watch,
            self.window.wake,
            options.sections,
            options.fit,
            options.timeout,
        )
        self.keymap, problem = (keymap, None) if keymap else _user_keymap()
        if problem:
            self.session.say(problem)
        self.exact = ExactRenderer(self.window.wake)
        self.painter = Painter(self.window.context)
        self.panels = Panels(self.session, self.keymap)
        self.pictures: list[Path] = []  # that were written
        self._painted = Painted()
        self._moved = 0.0  # time.monotonic() at which another picture was asked for
        self._clock = PanelClock()
        self._screenshot = False
        self._quit = False
        for _ in range(SETTLING_TURNS):  # the window is to be seen before anything that takes time
            self._draw()
        self.painter.warm(self.window.context.screen)
        self.window.attach(self)

    def run(self) -> None:
        """Until the window is closed."""
        try:
            while not self.closed:
                self.step()
        finally:
            self.close()

    @property
    def closed(self) -> bool:
        return self._quit or self.window.should_close

    def close(self) -> None:
        """Stop everything and close the window."""
        self.exact.stop()
        self.session.close()
        self.painter.release()
        self.window.close()

    def step(self, wait: float | None = None) -> bool:
        """Wait for something to do and do it. wait: seconds at most, None: as long as is sensible.

        Returns whether the picture was drawn again.
        """
        self.window.wait(self._patience() if wait is None else wait)
        self._update()
        if 0 in self.session.size:
            return False
        if self._picture_changed():
            painted = self._painted
            if painted.camera:
                self.painter.prepare(painted.state, painted.camera, painted.size)
            self.window.wait(0.0)  # input need not wait for both
            self.exact.show(self._request())  # nor need what it asks for
        elif self._clock.patience(time.monotonic()):
            return False
        self._draw()
        return True

    # Input

    def on_key(self, key: str, modifiers: frozenset[str]) -> None:
        action = self.keymap.action(key, modifiers)
        self._clock.touch()
        if action is None:
            return
        if action == "help":
            self.panels.help = not self.panels.help
        elif action == "panels":
            self.panels.shown = not self.panels.shown
        elif action == "screenshot":
            self._screenshot = True
        elif action == "exact-picture":
            self._save_exact()
        elif action == "quit":
            self._quit = True
        else:
            perform(self.session, action)

    def on_press(self, button: Button, at: Point, modifiers: frozenset[str]) -> None:
        self._clock.touch()
        self.session.press(button, at, shift="Shift" in modifiers, ctrl="Ctrl" in modifiers)

    def on_release(self, button: Button, at: Point) -> None:
        drag = self.session.controls.drag
        if drag is None or drag.click:
            self._clock.touch()
        else:
            self._clock.follow_picture()  # of the motion that ends: its refinement is what panels show next
        self.session.release(button, at)
        self.exact.rest(self._request())

    def on_move(self, at: Point) -> None:
        if self.session.controls.drag is None:  # else panels stay as they are: what moves is the picture
            self._clock.touch()
        self.session.move(at)

    def on_wheel(self, notches: float, modifiers: frozenset[str]) -> None:
        self._clock.touch()
        self.session.wheel(notches, to_cursor="Ctrl" in modifiers)

    def on_drop(self, paths: Sequence[str]) -> None:
        self._clock.touch()
        if paths:
            self.session.open(paths)

    # One step

    def _patience(self) -> float:
        """Seconds that nothing needs to be done if no input comes and no thread wakes us."""
        seconds = [IDLE_SECONDS, self._clock.patience(time.monotonic())]
        if self.painter.busy:
            seconds.append(POLL_SECONDS)
        if self.session.tessellated.busy:
            seconds.append(MESH_POLL_SECONDS)
        if self.session.state.view is View.BLINK:
            seconds.append(BLINK_SECONDS / 4)
        return min(seconds)

    def _update(self) -> None:
        """Take over what other threads have finished, and ask them for what is needed next."""
        session = self.session
        session.over_picture = not self.window.over_panel
        if self.window.resized:
            self.window.resized = False
            session.size = self.window.size
            self._clock.touch()
        if session.update(time.monotonic()):
            self._clock.touch()
        if session.loader.awaited:
            self._clock.follow_progress()
        self.exact.show(self._request())
        latest = self.exact.latest()
        if isinstance(latest, str):
            session.say(latest)
            self._clock.touch()
        elif latest and latest.request.model is session.drawn:
            session.exact = latest
            self._clock.follow_picture()
        exact = session.exact
        whole = exact and exact.is_full and exact.request.model is session.drawn and not session.state.sections
        if exact and whole and session.state.view.shows_mesh:
            session.tessellated.compare(exact.request.model, exact.request.camera, exact.request.resolution)

    def _request(self) -> Request | None:
        """What the exact picture is to be now."""
        session = self.session
        resolution = self.painter.exact_resolution(session.state.view, session.size)
        if session.drawn is None or session.camera is None or resolution is None or 0 in session.size:
            return None
        overlays = session.state.overlays
        needed = (*self.painter.exact_buffers(session.state), "color", "depth", "face")
        return Request(
            session.drawn,
            session.camera,
            resolution,
            tuple(dict.fromkeys(needed)),
            edges="edges" in overlays,
            curvature="curvature" in overlays,
            sections=session.state.sections,
            background=session.state.background,
        )

    def _picture_changed(self) -> bool:
        """Whether the painter would paint another picture now than it did last, or than it does after refining that."""
        session, painted = self.session, self._painted
        given = self._give_to_painter()
        camera, state, exact = session.camera, session.state.copy(), session.shown_exact
        if exact:
            camera, state.sections = exact.request.camera, exact.request.sections
        now = time.monotonic()
        if (state, camera, session.size) != (painted.state, painted.camera, painted.size):
            painted.state, painted.camera, painted.size = state, camera, session.size
            self._moved = now
            return True
        return given or (now - self._moved >= REST_SECONDS and self.painter.refine())

    def _paint(self, framebuffer: Any) -> None:
        painted = self._painted
        if painted.camera:
            self.painter.paint(painted.state, painted.camera, framebuffer, painted.size)
        else:
            framebuffer.clear(*encoded(painted.state.background))

    def _give_to_painter(self) -> bool:
        """Hand over what is new; whether anything was."""
        session, painted, before = self.session, self._painted, self._painted.__dict__.copy()
        if painted.model is not session.described:
            painted.model = session.described
            self.painter.set_model(session.described)
        meshed = session.tessellated.result
        if painted.meshed is not meshed:
            painted.meshed, painted.difference = meshed, None
            self.painter.set_mesh(*(meshed.mesh, meshed.arrays) if meshed else (None,))
        difference = session.difference
        if painted.difference is not difference:
            painted.difference = difference
            self.painter.set_difference(difference)
        if painted.selected is not session.inspection.selected:
            painted.selected = session.inspection.selected
            self.painter.set_selected(painted.selected)
        if painted.exact is not session.exact:
            painted.exact = session.exact
            exact = session.exact
            self.painter.set_exact(*(exact.frame, exact.curvature, exact.pixels) if exact else (None,))
        return any(before[name] is not value for name, value in painted.__dict__.items())

    def _draw(self) -> None:
        """Show the picture with the panels before it: as they were, where they are not due."""
        now = time.monotonic()
        moves_along = bool(self.session.inspection.points)  # what is measured is drawn over the picture
        if moves_along or self._clock.due(now):
            self._clock.drawn(now)
            self.window.draw(self._paint, self.panels.draw)
        else:
            self.window.draw(self._paint)
        if self._screenshot:
            self._screenshot = False
            self._save_window()
        self.window.present()

    def _save_window(self) -> None:
        session, pixels = self.session, self.window.pixels(self._paint)
        path = picture_path(session.path, Path.cwd())
        session.tasks.run(lambda: save_window(path, pixels, session.camera), self._saved)

    def _save_exact(self) -> None:
        session = self.session
        model, camera, size, sections = session.drawn, session.camera, session.size, session.state.sections
        if model is None or camera is None:
            return
        path = picture_path(session.path, Path.cwd())
        session.say(f"{path.name}: being drawn")
        session.tasks.run(lambda: save_exact(path, model, camera, size, sections), self._saved)

    def _saved(self, result: Path | Exception) -> None:
        if isinstance(result, Path):
            self.pictures.append(result)
            self.session.say(f"written: {os.path.relpath(result)}")
        else:
            self.session.say(" ".join(str(result).split()))


def view(options: Options) -> None:
    """Open the window and return when it is closed. Raises InputError where no window can be opened."""
    App(options).run()


def open_window(
    model: nofacet.Model,
    camera: nofacet.Camera | None = None,
    title: str = TITLE,
    sections: Sequence[nofacet.Section] = (),
    size: tuple[int, int] = SIZE,
) -> None:
    """Show a model and return when the window is closed. Raises InputError where no window can be opened."""
    app = App(Options(view=View.EXACT, camera=camera, size=size, sections=sections))
    app.window.set_title(title)
    app.session.show(model)
    app.run()


def _user_keymap() -> tuple[Keymap, str | None]:
    """The user's keymap, or the default one and why."""
    try:
        return Keymap.load(), None
    except KeymapError as error:
        return Keymap(), f"{error}; the default keys are used"
