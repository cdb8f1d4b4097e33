"""What is known of the surfaces under the mouse: hovered, selected, measured. No window here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import nofacet

from .appearance import Faces
from .tasks import Tasks

Then = Callable[[nofacet.Pick | None], None]


@dataclass(frozen=True)
class Place:
    """A place in a picture: all that nofacet.pick() depends on.

    described: `model` with the errors of its conversion, where these are known; the same faces.
    """

    model: nofacet.Model
    described: nofacet.Model
    camera: nofacet.Camera
    resolution: tuple[int, int]
    at: tuple[float, float]
    sections: tuple[nofacet.Section, ...] = ()

    def pick(self) -> nofacet.Pick | None:
        """What is there. The described model only adds to it: another model would have to be prepared for drawing."""
        found = nofacet.pick(self.model, self.camera, self.resolution, *self.at, sections=self.sections)
        return found and with_errors(found, self.described)


class Inspection:
    """Picks in a thread, one place at a time: every click in turn, and where the mouse was last. Never waits.

    hover: what is under the mouse. picked: what was clicked last. selected: (F,) bool, replaced and never changed.
    measuring: whether clicks measure; points: those clicked so far, two of them make a measurement.
    """

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        """wake: called by another thread when poll() has something to do."""
        self.hover: nofacet.Pick | None = None
        self.picked: nofacet.Pick | None = None
        self.selected: NDArray[np.bool_] = np.zeros(0, bool)
        self.measuring = False
        self.points: tuple[nofacet.Pick, ...] = ()
        self._wake = wake
        self._tasks = Tasks(wake)
        self._clicks: list[tuple[Place, Then]] = []
        self._place: Place | None = None  # under the mouse
        self._known: Place | None = None  # whose pick `hover` is

    @property
    def busy(self) -> bool:
        """Whether something is still to be picked."""
        return bool(self._tasks.running or self._clicks or self._place != self._known)

    @property
    def measurement(self) -> nofacet.Measurement | None:
        return nofacet.measure(*self.points) if len(self.points) == 2 else None

    def begin(self, face_count: int) -> None:
        """Forget everything: another model is shown."""
        self.hover = self.picked = self._place = self._known = None
        self.points = ()
        self._clicks.clear()
        self._tasks = Tasks(self._wake)  # what is still being picked comes to nothing
        self.selected = np.zeros(face_count, bool)

    def learn(self, described: nofacet.Model) -> None:
        """The errors of the model's conversion are known now."""
        self.picked = self.picked and with_errors(self.picked, described)
        self.points = tuple(with_errors(point, described) for point in self.points)

    def look(self, place: Place | None) -> None:
        """The mouse is here now; None: over no picture."""
        self._place = place
        if place is None:
            self.hover = self._known = None

    def at(self, place: Place | None) -> nofacet.Pick | None:
        """What is at a place under the mouse, if that is known by now."""
        return self.hover if place is not None and place == self._known else None

    def click(self, place: Place, then: Then) -> None:
        """Pick a place and hand over to `then`, in poll(), what is there."""
        self._clicks.append((place, then))

    def poll(self) -> bool:
        """Take over what has been picked and pick what is next; whether anything has changed."""
        changed = self._tasks.poll()
        while self._clicks and self._clicks[0][0] == self._known:
            self._clicks.pop(0)[1](self.hover)
            changed = True
        if self._tasks.running:
            return changed
        if self._clicks:
            place, then = self._clicks.pop(0)
            self._tasks.run(place.pick, lambda found: then(_pick_or_none(found)))
        elif self._place is not None and self._place != self._known:
            self._find(self._place)
        return changed

    def _find(self, place: Place) -> None:
        def take(found: nofacet.Pick | Exception | None) -> None:
            if self._place is not None:  # else the mouse has left the picture
                self.hover, self._known = _pick_or_none(found), place

        self._tasks.run(place.pick, take)

    # What clicks do

    def select(self, faces: Faces, picked: nofacet.Pick | None = None, add: bool = False) -> None:
        """Select faces in place of what was selected; add: beside it, or no longer if they all are already."""
        selected = self.selected.copy() if add else np.zeros_like(self.selected)
        selected[faces] = not (add and len(faces) and selected[faces].all())
        self.selected, self.picked = selected, picked

    def toggle_measuring(self) -> None:
        self.measuring, self.points = not self.measuring, ()

    def add_point(self, point: nofacet.Pick | None) -> None:
        """A point to measure from or to; after two of them a new measurement begins."""
        if point:
            self.points = (point,) if len(self.points) == 2 else (*self.points, point)

    def clear(self) -> None:
        """Nothing is selected or measured any more."""
        self.select(np.zeros(0, np.int32))
        self.measuring, self.points = False, ()


def part_of(model: nofacet.Model, pick: nofacet.Pick) -> Faces:
    """The faces of the part that a picked face belongs to: of its assembly node, without a tree of its body."""
    if pick.node >= 0:
        return model.tree[pick.node].faces
    holder = np.flatnonzero(model.body_face == pick.face)
    if not len(holder):
        return np.array([pick.face], np.int32)
    body = np.searchsorted(model.body_offsets, holder[0], side="right") - 1
    return model.body_face[model.body_offsets[body] : model.body_offsets[body + 1]]


def with_errors(pick: nofacet.Pick, described: nofacet.Model) -> nofacet.Pick:
    """A pick with what the model knows of its face's conversion."""
    if pick.section is not None:
        return pick
    error = float(described.conversion_error[described.face_definition[pick.face]])
    return replace(pick, conversion_error=error, trim_deviation=described.trim_deviation(pick.face))


def _pick_or_none(found: nofacet.Pick | Exception | None) -> nofacet.Pick | None:
    return None if isinstance(found, Exception) else found
