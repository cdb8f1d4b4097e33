"""What the window works on: files, model, camera and view, and what keys and mouse do to them. No window here."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import floor

import numpy as np

import nofacet
from nofacet.camera import Vector, as_vector

from .appearance import Appearance
from .controls import Button, Controls, DoubleClick, Motion, Point, zoom_wheel
from .difference import OutlineDifference
from .exact import Exact
from .hover import Hover, hover_in
from .inspection import Inspection, Place, part_of
from .loading import Fit, Loaded, Loader, fit_camera
from .panes import Pane, pane_resolution, panes
from .section_planes import Bounds, SectionPlanes
from .state import View, ViewState
from .tasks import Tasks
from .tessellated import Tessellated
from .watch import FileWatch

NOTICE_SECONDS = 5.0
BLINK_SECONDS = 0.6  # that each side is shown
DIVIDER_REACH = 6.0  # pixels from a wipe's divider within which the mouse takes it


@dataclass(frozen=True)
class Notice:
    """One line for the user; a problem stays until another file is opened."""

    text: str
    is_problem: bool = False
    until: float = 0.0  # time.monotonic()


class Session:
    """The state of the viewer. Its methods belong to one thread and never wait for what takes longer than a frame."""

    def __init__(
        self,
        files: Sequence[str] = (),
        view: View = View.SIDE_BY_SIDE,
        camera: nofacet.Camera | None = None,
        size: tuple[int, int] = (1280, 720),
        watch: bool = False,
        wake: Callable[[], None] = lambda: None,
        sections: Sequence[nofacet.Section] = (),
        fit: Fit = fit_camera,
        timeout: float = 300.0,
    ) -> None:
        """files: models to show, the first one now. camera: for the first one, None: fitted by `fit`. size: of the
        window in pixels. wake: called by other threads when update() has something to do. sections: that cut the first
        model. timeout: seconds that reading a file may take."""
        self.planes = SectionPlanes(sections)
        self.state = ViewState(view, sections=self.planes.sections)
        self.size = size
        self.watches = watch
        self.loader = Loader(wake, fit, timeout)
        self.tasks = Tasks(wake)
        self.tessellated = Tessellated(self.tasks)
        self.controls = Controls()
        self.camera = camera
        self.appearance: Appearance | None = None
        self.drawn: nofacet.Model | None = None  # the model as it is drawn: appearance.applied()
        self.described: nofacet.Model | None = None  # the same, with the errors of its conversion once they are known
        self.exact: Exact | None = None  # the frame shown last
        self.bounds: Bounds | None = None  # of the model
        self.inspection = Inspection(wake)
        self.notice: Notice | None = None
        self.cursor: Point = (0.0, 0.0)
        self.over_picture = True  # the cursor: not over a panel
        self._double_click = DoubleClick()
        self._adds = False  # the click that has begun: to what is selected
        self._came_with_camera = False  # the cursor where it is: it moved the camera
        self._anchor: Vector | None = None  # what Ctrl+wheel zooms to, until the mouse moves
        self.files: list[str] = []
        self.index = 0
        self._watch: FileWatch | None = None
        self._keeps_camera = camera is not None
        self._to_measure: str | None = None  # a file that is shown and still to be read again, measured
        self._blinked = 0.0
        if files:
            self.open(files, keep_camera=camera is not None)

    # Files

    @property
    def path(self) -> str | None:
        """The file that is shown or being read."""
        return self.files[self.index] if self.files else None

    @property
    def model(self) -> nofacet.Model | None:
        """The model as it was read."""
        return self.appearance.model if self.appearance else None

    @property
    def warnings(self) -> list[str]:
        """What is said of the model by its reader, and of how section planes cut it."""
        cuts = self.exact.frame.stats.get("warnings", []) if self.exact else []
        return [*(self.model.warnings if self.model else []), *cuts]

    def open(self, files: Sequence[str], keep_camera: bool = False) -> None:
        """Show the first of these files and step through them from now on."""
        self.files, self.index = list(files), 0
        self._read(keep_camera)

    def show(self, model: nofacet.Model) -> None:
        """Show a model that comes from no file, so that there is nothing to mesh."""
        self.files, self.index = [], 0
        self._keeps_camera = self.camera is not None
        camera = self.camera or fit_camera(model, self.pane_size)
        self._take(Loaded(model.source, model, camera, Bounds.of(model)))

    def step_file(self, step: int) -> None:
        """Show the file `step` places on; after the last one comes the first."""
        if len(self.files) > 1:
            self.index = (self.index + step) % len(self.files)
            self._read(keep_camera=False)

    def reload(self) -> None:
        """Read the file again and keep camera and appearance."""
        if self.files:
            self._read(keep_camera=True)

    def cancel_reading(self) -> None:
        """Stop reading; what was shown before stays."""
        if self.loader.path:
            self.say(f"{self.loader.path}: reading was called off")
        self.loader.cancel()

    def _read(self, keep_camera: bool) -> None:
        assert self.path
        self._keeps_camera = keep_camera
        self.notice = self._to_measure = None
        self._watch = FileWatch(self.path)
        self.loader.start(self.path, self.pane_size)

    def _take(self, loaded: Loaded) -> None:
        """Show what was read, or say why there is nothing."""
        if loaded.problem is not None:
            if not loaded.measured:
                self.notice = Notice(loaded.problem, is_problem=True)
            return
        assert loaded.model
        same_file = self.model is not None and self.model.source == loaded.model.source
        keeps = same_file and (self._keeps_camera or loaded.measured)
        self.appearance = (
            self.appearance.carried_to(loaded.model) if self.appearance and keeps else Appearance(loaded.model)
        )
        if loaded.measured:  # looks the same: nothing has to be drawn again
            self.described = self.appearance.applied()
            self.inspection.learn(self.described)
            return
        if self.bounds and not same_file:
            self.planes = SectionPlanes()
        self.bounds = loaded.bounds
        self.inspection.begin(loaded.model.face_count)
        self.appearance_changed()
        if self.camera is None or not self._keeps_camera:
            self.camera = loaded.camera
        self.tessellated.forget()
        self.mesh()
        self._to_measure = self.path

    def mesh(self) -> None:
        """Mesh the file as `tessellated` is set to."""
        if self.path and self.camera and self.model is not None:
            self.tessellated.start(self.path, self.camera, self.pane_size)
        elif self.model is not None:
            self.tessellated.problem = "objects from Python are not meshed: save them to a file and open that"

    # Messages and time

    def say(self, text: str) -> None:
        """Show a line for some seconds."""
        self.notice = Notice(text, until=time.monotonic() + NOTICE_SECONDS)

    def update(self, now: float) -> bool:
        """Take over what other threads have finished and what time brings about; whether anything has changed.

        now: time.monotonic().
        """
        self.state.sections = self.planes.sections
        looks = self.over_picture and self._at_rest and not self._refines
        self.inspection.look(self._place(self.cursor) if looks else None)
        changed = self.tasks.poll() | self.tessellated.poll() | self.inspection.poll()
        if self._to_measure and not self.tessellated.busy and self.loader.path is None:
            self.loader.start(self._to_measure, self.pane_size, measured=True)
            self._to_measure = None
        loaded = self.loader.poll()
        if loaded:
            self._take(loaded)
            changed = True
        if self.watches and self._watch and self._watch.changed(now):
            self.reload()
            changed = True
        if self.notice and not self.notice.is_problem and now > self.notice.until:
            self.notice = None
            changed = True
        if self.state.view is View.BLINK and now - self._blinked >= BLINK_SECONDS:
            self._blinked = now
            self.state.blink_exact = not self.state.blink_exact
            changed = True
        return changed

    def close(self) -> None:
        """Stop what is going on in the background."""
        self.loader.cancel()
        self.tessellated.forget()

    # What keys do: viewer/actions.py

    def show_view(self, view: View) -> None:
        self.state.view = view
        self._blinked = time.monotonic()

    def toggle_projection(self) -> None:
        if self.camera:
            other = "perspective" if self.camera.projection == "orthographic" else "orthographic"
            self.camera = self.camera.with_projection("perspective" if other == "perspective" else "orthographic")

    def appearance_changed(self) -> None:
        """To be called after a change of `appearance`."""
        if self.appearance:
            self.drawn = self.described = self.appearance.applied()

    def cut_along_face(self) -> None:
        """Add a section plane through the point under the cursor, with the normal that its face has there."""

        def cut(pick: nofacet.Pick | None) -> None:
            if pick:
                self.planes.add(pick.position, pick.normal)
            else:
                self.say("there is no surface under the cursor to cut along")

        place = self._place(self.cursor)
        if place:
            self.inspection.click(place, cut)

    # What the window shows by now

    @property
    def shown_exact(self) -> Exact | None:
        """The exact frame that the view shows; both sides show its camera and its section planes, so that they move
        together."""
        exact = self.exact
        shows = exact and self.state.view.shows_exact and exact.request.model is self.drawn
        return exact if shows else None

    @property
    def difference(self) -> OutlineDifference | None:
        """The outline error of what is shown; None with section planes: it is measured of whole models."""
        found, exact = self.tessellated.difference, self.exact
        if self.state.sections or (found and exact and found.camera != exact.request.camera):
            return None
        return found

    # The mouse

    @property
    def pane_size(self) -> tuple[int, int]:
        """Width and height in pixels of what the camera is fitted to."""
        return pane_resolution(self.state.view, self.size)

    def pane_at(self, x: float) -> Pane:
        """The pane at x in the window."""
        found = panes(self.state.view, self.size)
        return next((pane for pane in reversed(found) if x >= pane.x), found[0])

    def on_divider(self, x: float) -> bool:
        """Whether the mouse at x takes the divider of a wipe."""
        return self.state.view is View.WIPE and abs(x - self.state.wipe * self.size[0]) <= DIVIDER_REACH

    def press(self, button: Button, at: Point, shift: bool = False, ctrl: bool = False) -> None:
        self.cursor, self._adds = at, ctrl
        self.controls.press(button, at, self.pane_at(at[0]), shift, self.on_divider(at[0]))

    def move(self, at: Point) -> None:
        if at != self.cursor:
            self._anchor = None
            self._came_with_camera = False
        self.cursor = at
        drag, camera = self.controls.drag, self.camera
        if camera:
            self.camera = self.controls.move(at, camera)
            self._came_with_camera |= self.camera is not camera
        if drag and drag.moves_divider:
            self.state.move_wipe(at[0], self.size[0])

    def release(self, button: Button, at: Point) -> None:
        self.move(at)
        drag = self.controls.release(button)
        hover = self.hover
        if drag is None or not drag.click or self.camera is None:
            return
        if button is Button.MIDDLE and hover:
            self.camera = self.camera.centre_on(hover.point)
        elif button is Button.LEFT:
            self._click(at, whole_part=self._double_click.ends(at, time.monotonic()) or drag.motion is Motion.PAN)

    def _click(self, at: Point, whole_part: bool) -> None:
        """Measure from or to what is there, or select it, once it is known."""
        place, inspection, add = self._place(at), self.inspection, self._adds
        if place is None:
            return

        def select(pick: nofacet.Pick | None) -> None:
            faces = np.array([pick.face] if pick and pick.section is None else [], np.int32)
            inspection.select(part_of(place.model, pick) if pick and len(faces) and whole_part else faces, pick, add)

        inspection.click(place, inspection.add_point if inspection.measuring else select)

    def wheel(self, notches: float, to_cursor: bool = False) -> None:
        if self.camera is None:
            return
        if to_cursor and self._anchor is None:
            self._anchor = self._zoom_centre()
        self.camera = zoom_wheel(self.camera, notches, self._anchor if to_cursor else None)
        self._came_with_camera = True

    @property
    def hover(self) -> Hover | None:
        """What is under the cursor; None on background, while the camera moves, and where it is not known yet."""
        if not self._at_rest:
            return None
        if self.shown_exact:
            return hover_in(self.shown_exact.frame, self.pane_at(self.cursor[0]), self.cursor)
        pick = self.inspection.at(self._place(self.cursor))
        return Hover(pick.face, pick.position) if pick else None

    @property
    def _at_rest(self) -> bool:
        """Whether what is shown is what is to be shown, so that the surfaces are where they are seen."""
        exact = self.shown_exact
        if exact is None:
            return not self.state.view.shows_exact and self.controls.drag is None
        return (exact.request.camera, exact.request.sections) == (self.camera, self.state.sections)

    @property
    def _refines(self) -> bool:
        """Whether a motion has ended, and nobody asks yet for more than the picture in full quality."""
        exact = self.shown_exact
        return self._came_with_camera and exact is not None and not exact.is_full

    def _place(self, at: Point) -> Place | None:
        """The centre of the pixel at a place in the window; None without a model."""
        if self.drawn is None or self.described is None or self.camera is None:
            return None
        pane = self.pane_at(at[0])
        centre = floor(at[0] - pane.x) + 0.5, floor(at[1]) + 0.5
        return Place(self.drawn, self.described, self.camera, pane.size, centre, self.state.sections)

    def _zoom_centre(self) -> Vector:
        """The world point that zooming to the cursor leaves in place; on background one at the focal point's depth."""
        assert self.camera
        hover, pane = self.hover, self.pane_at(self.cursor[0])
        if hover:
            return hover.point
        return as_vector(self.camera.point_at((self.cursor[0] - pane.x, self.cursor[1]), pane.size))
