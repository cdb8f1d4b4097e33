"""The mouse: what pressing, moving, releasing and turning it do to the camera. No window here; as F3D does it."""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass

from nofacet import Camera

from .panes import Pane

ORBIT_DEGREES = 200.0  # for a drag over the pane's smaller side
DRAG_ZOOM = 4.0  # factor for a drag over half the pane's height
WHEEL_ZOOM = 1.1  # factor for one notch
CLICK_PIXELS = 3.0  # a press that moves no farther is a click
DOUBLE_CLICK_SECONDS = 0.4  # between two clicks in the same place, at most

Point = tuple[float, float]


class Button(enum.Enum):
    LEFT = "left"
    MIDDLE = "middle"
    RIGHT = "right"


class Motion(enum.Enum):
    ORBIT = "orbit"
    PAN = "pan"
    ZOOM = "zoom"
    WIPE = "wipe"


@dataclass
class Drag:
    """A button that is held down: where it was pressed and where it is now, in the window's pixels."""

    button: Button
    motion: Motion
    pane: Pane
    pressed: Point
    at: Point
    click: bool = True  # as long as it has not moved

    @property
    def moves_divider(self) -> bool:
        return self.motion is Motion.WIPE and not self.click


class DoubleClick:
    """Which clicks are the second one of two."""

    def __init__(self) -> None:
        self._last: tuple[Point, float] | None = None

    def ends(self, at: Point, now: float) -> bool:
        """Whether a click ends a double click. now: seconds of any clock."""
        last = self._last
        if (
            last
            and now - last[1] <= DOUBLE_CLICK_SECONDS
            and max(abs(at[0] - last[0][0]), abs(at[1] - last[0][1])) <= CLICK_PIXELS
        ):
            self._last = None
            return True
        self._last = at, now
        return False


class Controls:
    """Turns the mouse's events into camera motions. One drag at a time: other buttons do nothing until it ends."""

    def __init__(self) -> None:
        self.drag: Drag | None = None

    def press(self, button: Button, at: Point, pane: Pane, shift: bool = False, on_divider: bool = False) -> None:
        """A button goes down at a position in the window, over a pane or over the divider of a wipe."""
        if self.drag is not None:
            return
        motion = {Button.LEFT: Motion.ORBIT, Button.MIDDLE: Motion.PAN, Button.RIGHT: Motion.ZOOM}[button]
        if button is Button.LEFT and shift:
            motion = Motion.PAN
        if button is Button.LEFT and on_divider:
            motion = Motion.WIPE
        self.drag = Drag(button, motion, pane, at, at)

    def move(self, at: Point, camera: Camera) -> Camera:
        """The camera after the mouse has moved to a position; the same one if no drag moves it."""
        drag = self.drag
        if drag is None:
            return camera
        if drag.click and max(abs(at[0] - drag.pressed[0]), abs(at[1] - drag.pressed[1])) <= CLICK_PIXELS:
            return camera
        drag.click = False
        x, y = at[0] - drag.at[0], at[1] - drag.at[1]
        drag.at = at
        width, height = drag.pane.size
        if drag.motion is Motion.ORBIT:
            degrees = ORBIT_DEGREES / min(width, height)
            return _possible(lambda: camera.orbit(-x * degrees, y * degrees), camera)
        if drag.motion is Motion.PAN:
            return _possible(lambda: camera.pan(x, y, drag.pane.size), camera)
        if drag.motion is Motion.ZOOM:
            return _possible(lambda: camera.zoom(DRAG_ZOOM ** (-2 * y / height)), camera)
        return camera

    def release(self, button: Button) -> Drag | None:
        """A button goes up. Returns the drag that ends; its `click` says whether the mouse has stayed in place."""
        drag = self.drag
        if drag is None or drag.button is not button:
            return None
        self.drag = None
        return drag


def zoom_wheel(camera: Camera, notches: float, about: tuple[float, float, float] | None = None) -> Camera:
    """The camera after the wheel has turned; about: the world point that stays in place, None: the focal point."""
    return _possible(lambda: camera.zoom(WHEEL_ZOOM**notches, about), camera)


def _possible(motion: Callable[[], Camera], camera: Camera) -> Camera:
    """The camera after a motion, or as it was where the motion leads to none: zoomed in beyond what numbers hold."""
    try:
        return motion()
    except ValueError:
        return camera
