"""Camera motions: what stays in its place in the picture, and what does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nofacet.camera import VIEWS, Camera

RESOLUTION = (640, 480)
ORTHOGRAPHIC = Camera("orthographic", (30, -40, 25), (1, 2, 3), (0, 0, 1), view_height=20.0)
PERSPECTIVE = Camera("perspective", (30, -40, 25), (1, 2, 3), (0, 0, 1), view_angle=35.0)
BOTH = [ORTHOGRAPHIC, PERSPECTIVE]
angles = st.floats(-400, 400)


def pixel_of(camera: Camera, point: np.ndarray | tuple[float, ...]) -> np.ndarray:
    x, y, _, w = camera.pixel_from_world(RESOLUTION) @ [*point, 1.0]
    return np.array([x / w, y / w])


@pytest.mark.parametrize("camera", BOTH)
@given(azimuth=angles, elevation=angles)
def test_orbit_keeps_the_focal_point_the_distance_and_the_horizon(
    camera: Camera, azimuth: float, elevation: float
) -> None:
    turned = camera.orbit(azimuth, elevation)
    assert turned.focal_point == camera.focal_point
    assert turned.distance == pytest.approx(camera.distance, rel=1e-12)
    right, up, _ = turned.axes()
    assert abs(right[2]) < 1e-9  # level
    assert up[2] > -1e-9  # never upside down


def test_orbit_turns_by_the_angles_it_is_given() -> None:
    front = Camera("orthographic", (0, -10, 0), (0, 0, 0), view_height=1.0)
    np.testing.assert_allclose(front.orbit(90, 0).position, (10, 0, 0), atol=1e-12)
    np.testing.assert_allclose(front.orbit(0, 30).position, (0, -10 * np.cos(np.pi / 6), 5), atol=1e-12)
    top = front.orbit(0, 500)
    np.testing.assert_allclose(top.position, (0, 0, 10), atol=1e-12)
    np.testing.assert_allclose(top.axes()[1], (0, 1, 0), atol=1e-12)
    np.testing.assert_allclose(top.orbit(0, -90).position, (0, -10, 0), atol=1e-12)  # and back the way it came


def test_orbit_leaves_a_camera_that_hangs_upside_down_there() -> None:
    camera = Camera("orthographic", (0, -10, 0), (0, 0, 0), (0, 0, -1), view_height=1.0)
    assert camera.orbit(20, 40).axes()[1][2] < 0


@pytest.mark.parametrize("camera", BOTH)
def test_pan_moves_the_focal_point_by_pixels(camera: Camera) -> None:
    moved = camera.pan(37, -12, RESOLUTION)
    np.testing.assert_allclose(pixel_of(moved, camera.focal_point), [320 + 37, 240 - 12], atol=1e-9)
    np.testing.assert_allclose(moved.direction, camera.direction, atol=1e-12)


@pytest.mark.parametrize("camera", BOTH)
@given(factor=st.floats(0.1, 10), x=st.floats(-300, 900), y=st.floats(-200, 700))
def test_zoom_leaves_a_point_in_its_pixel(camera: Camera, factor: float, x: float, y: float) -> None:
    point = camera.point_at((x, y), RESOLUTION, depth=0.8 * camera.distance)
    zoomed = camera.zoom(factor, point)
    np.testing.assert_allclose(pixel_of(zoomed, point), [x, y], atol=1e-6)
    if camera.projection == "orthographic":
        assert zoomed.view_height == pytest.approx(20 / factor)
        assert zoomed.distance == pytest.approx(camera.distance)


@pytest.mark.parametrize("camera", BOTH)
def test_zoom_enlarges_by_the_factor(camera: Camera) -> None:
    right = camera.axes()[0]
    beside = np.array(camera.focal_point) + 0.5 * right
    before = pixel_of(camera, beside)[0] - 320
    assert pixel_of(camera.zoom(3), beside)[0] - 320 == pytest.approx(3 * before, rel=1e-9)


@pytest.mark.parametrize("factor", [0, -1, float("nan"), 1e300])
def test_zoom_refuses_what_makes_no_camera(factor: float) -> None:
    with pytest.raises(ValueError, match="camera"):
        PERSPECTIVE.zoom(factor)


@pytest.mark.parametrize("camera", BOTH)
def test_centre_on_puts_a_point_in_the_middle(camera: Camera) -> None:
    point = camera.point_at((100, 77), RESOLUTION, depth=0.7 * camera.distance)
    centred = camera.centre_on(point)
    np.testing.assert_allclose(pixel_of(centred, point), [320, 240], atol=1e-9)
    np.testing.assert_allclose(centred.focal_point, point)
    np.testing.assert_allclose(centred.direction, camera.direction, atol=1e-12)
    scale = [pixel_of(c, point + c.axes()[0])[0] - pixel_of(c, point)[0] for c in (camera, centred)]
    assert scale[0] == pytest.approx(scale[1], rel=1e-9)


def test_centre_on_refuses_what_is_behind_the_eye() -> None:
    with pytest.raises(ValueError, match="behind the eye"):
        PERSPECTIVE.centre_on(np.array(PERSPECTIVE.position) - PERSPECTIVE.direction)


@pytest.mark.parametrize("camera", BOTH)
def test_changing_the_projection_keeps_the_size_at_the_focal_point(camera: Camera) -> None:
    other = camera.with_projection("perspective" if camera.projection == "orthographic" else "orthographic")
    assert other.projection != camera.projection
    for step in camera.axes()[:2]:
        point = np.array(camera.focal_point) + 2.5 * step
        np.testing.assert_allclose(pixel_of(other, point), pixel_of(camera, point), atol=1e-9)
    assert camera.with_projection(camera.projection) is camera


def test_changing_the_projection_refuses_what_makes_no_camera() -> None:
    with pytest.raises(ValueError, match="view_angle is 0; it must be between 0 and 180"):
        ORTHOGRAPHIC.with_projection("perspective", 0)
    with pytest.raises(ValueError, match="projection is 'fisheye'"):
        PERSPECTIVE.with_projection("fisheye")  # type: ignore[arg-type]


@pytest.mark.parametrize("camera", BOTH)
def test_point_at_is_on_the_ray_through_the_pixel(camera: Camera) -> None:
    origin, direction = camera.rays(RESOLUTION)
    point = camera.point_at((17.5, 400.5), RESOLUTION, depth=33.0)
    np.testing.assert_allclose(point, origin[400, 17] + 33.0 * direction[400, 17], atol=1e-12)


@pytest.mark.parametrize("name", VIEWS)
def test_orbit_starts_from_every_standard_view(name: str) -> None:
    direction, up = VIEWS[name]
    x, y, z = direction
    camera = Camera("orthographic", (-10 * x, -10 * y, -10 * z), (0, 0, 0), up, view_height=1.0)
    turned = camera.orbit(10, -5 if name == "top" else 5)
    assert abs(turned.axes()[0][2]) < 1e-9
    assert turned != camera
    assert replace(turned, view_height=2.0).view_up == turned.view_up
