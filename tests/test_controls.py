"""The mouse without a window: which drag moves the camera how."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("nofacet_viewer")
from nofacet import Camera
from nofacet_viewer.controls import Button, Controls, Motion, zoom_wheel
from nofacet_viewer.panes import panes
from nofacet_viewer.state import View

CAMERA = Camera("orthographic", (0, -10, 0), (0, 0, 0), view_height=4.0)
(PANE,) = panes(View.EXACT, (400, 400))


def dragged(button: Button, by: tuple[float, float], shift: bool = False, camera: Camera = CAMERA) -> Camera:
    controls = Controls()
    controls.press(button, (100, 100), PANE, shift)
    for part in (0.5, 1.0):
        camera = controls.move((100 + part * by[0], 100 + part * by[1]), camera)
    drag = controls.release(button)
    assert drag and not drag.click
    return camera


def test_left_drag_to_the_right_shows_the_left_side() -> None:
    assert dragged(Button.LEFT, (100, 0)).position[0] < -1


def test_left_drag_downwards_raises_the_camera() -> None:
    assert dragged(Button.LEFT, (0, 100)).position[2] > 1


@pytest.mark.parametrize(("button", "shift"), [(Button.MIDDLE, False), (Button.LEFT, True)])
def test_pan_follows_the_mouse(button: Button, shift: bool) -> None:
    moved = dragged(button, (60, 20), shift)
    np.testing.assert_allclose(moved.focal_point, (-0.6, 0, 0.2), atol=1e-12)
    np.testing.assert_allclose(moved.direction, CAMERA.direction)


def test_right_drag_upwards_enlarges() -> None:
    assert dragged(Button.RIGHT, (0, -100)).view_height == pytest.approx(2.0)
    assert dragged(Button.RIGHT, (0, 100)).view_height == pytest.approx(8.0)


def test_a_drag_ends_where_it_began_if_the_mouse_does() -> None:
    controls = Controls()
    controls.press(Button.LEFT, (100, 100), PANE)
    camera = controls.move((180, 140), CAMERA)
    camera = controls.move((100, 100), camera)
    np.testing.assert_allclose(camera.position, CAMERA.position, atol=1e-9)


def test_a_press_that_stays_in_place_is_a_click() -> None:
    controls = Controls()
    controls.press(Button.MIDDLE, (100, 100), PANE)
    assert controls.move((102, 99), CAMERA) is CAMERA
    drag = controls.release(Button.MIDDLE)
    assert drag and drag.click and drag.motion is Motion.PAN
    assert controls.release(Button.MIDDLE) is None


def test_a_second_button_waits_for_the_first() -> None:
    controls = Controls()
    controls.press(Button.LEFT, (100, 100), PANE)
    controls.press(Button.RIGHT, (100, 100), PANE)
    assert controls.release(Button.RIGHT) is None
    assert controls.drag and controls.drag.button is Button.LEFT


def test_the_divider_takes_the_left_button_only() -> None:
    controls = Controls()
    controls.press(Button.LEFT, (200, 10), PANE, on_divider=True)
    assert controls.move((300, 10), CAMERA) is CAMERA
    assert controls.drag and controls.drag.moves_divider
    controls.release(Button.LEFT)
    controls.press(Button.RIGHT, (200, 10), PANE, on_divider=True)
    assert controls.drag and controls.drag.motion is Motion.ZOOM


def test_the_wheel_goes_in_and_out_and_stops_where_numbers_end() -> None:
    assert zoom_wheel(zoom_wheel(CAMERA, 3), -3).view_height == pytest.approx(4.0)
    camera = Camera("perspective", (0, -10, 0), (0, 0, 0), view_angle=30.0)
    for _ in range(200):
        camera = zoom_wheel(camera, 30)
    assert camera.distance > 0
