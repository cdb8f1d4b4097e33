"""Camera: axes, matrix and rays agree; fits touch the border; bad values are named."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import model_of, rectangle_group, sphere_group
from nofacet import image
from nofacet.camera import METADATA_KEY, VIEWS, Camera
from nofacet.errors import InputError
from nofacet.extent import bounding_box, surface_points
from nofacet.frame import Frame
from nofacet.model import Model

ORTHOGRAPHIC: dict[str, Any] = {
    "projection": "orthographic",
    "position": [83, 61, 47],
    "focal_point": [0, 0, 0],
    "view_up": [0, 0, 1],
    "view_height": 40.0,
}
PERSPECTIVE: dict[str, Any] = {
    "projection": "perspective",
    "position": [40, 30, 23],
    "focal_point": [0, 0, 0],
    "view_up": [0, 0, 1],
    "view_angle": 40.0,
}
BOTH = [ORTHOGRAPHIC, PERSPECTIVE]


def project(camera: Camera, resolution: tuple[int, int], points: np.ndarray) -> np.ndarray:
    """Pixels (n, 2) of world points (n, 3)."""
    pixels = np.column_stack([points, np.ones(len(points))]) @ camera.pixel_from_world(resolution).T
    return pixels[:, :2] / pixels[:, 3:]


@pytest.mark.parametrize("values", BOTH)
def test_camera_file_round_trip(values: dict[str, Any]) -> None:
    assert Camera.from_dict(json.loads(json.dumps(values))).to_dict() == values


@pytest.mark.parametrize("values", BOTH)
def test_depth_along_a_ray_is_the_point_in_the_pixel(values: dict[str, Any]) -> None:
    camera, resolution = Camera.from_dict(values), (7, 5)
    depth = np.linspace(50, 120, 35).reshape(5, 7)
    points = camera.position_from_depth(depth)
    x, y = np.meshgrid(np.arange(7) + 0.5, np.arange(5) + 0.5)
    np.testing.assert_allclose(
        project(camera, resolution, points.reshape(-1, 3)), np.c_[x.ravel(), y.ravel()], atol=1e-12
    )
    np.testing.assert_allclose((points - camera.position) @ camera.direction, depth, rtol=1e-14)
    depth[0, 0] = np.inf
    assert np.isnan(camera.position_from_depth(depth)[0, 0]).all()


@pytest.mark.parametrize("values", BOTH)
def test_third_row_orders_by_depth(values: dict[str, Any]) -> None:
    camera = Camera.from_dict(values)
    points = np.array(camera.position) + np.linspace(1, 200, 9)[:, None] * camera.direction
    z = np.column_stack([points, np.ones(9)]) @ camera.pixel_from_world((640, 480)).T
    depth = z[:, 2] / z[:, 3] if values is ORTHOGRAPHIC else -1 / (z[:, 2] / z[:, 3])
    np.testing.assert_allclose(depth, np.linspace(1, 200, 9), rtol=1e-12)


def test_axes_are_right_up_forward() -> None:
    camera = Camera("orthographic", (0, -10, 0), (0, 0, 0), (0, 0, 1), view_height=2)
    np.testing.assert_allclose(camera.axes(), [[1, 0, 0], [0, 0, 1], [0, 1, 0]], atol=1e-15)
    assert project(camera, (200, 100), np.array([[1.0, 0, 1]])).tolist() == [[150, 0]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"projection": "fisheye"}, "projection is 'fisheye'"),
        ({"view_height": 0}, "view_height is 0"),
        ({"view_height": None}, "view_height is missing"),
        ({"view_height": float("nan")}, "finite"),
        ({"view_angle": 30}, "view_angle does not belong"),
        ({"position": [0, 0, 0]}, "same point"),
        ({"position": [1, 2]}, "three numbers"),
        ({"position": [1, 2, "x"]}, "finite number"),
        ({"position": [10**400, 61, 47]}, "position is 10+; it must be a finite number"),
        ({"position": [1e308, 61, 47], "focal_point": [-1e308, 0, 0]}, "too far apart"),
        ({"view_up": [83, 61, 47]}, "along the viewing direction"),
        ({"view_up": [0, 0, 0]}, "is zero"),
        ({"zoom": 2}, "unknown entry 'zoom'"),
    ],
)
def test_bad_values_are_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Camera.from_dict({**ORTHOGRAPHIC, **change})


def test_whole_numbers_of_any_size() -> None:
    camera = Camera.from_dict({**ORTHOGRAPHIC, "position": [10**20, 61, np.int64(47)], "view_height": 10**21})
    assert camera.position == (1e20, 61, 47) and camera.view_height == 1e21


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-310, 1e-200, 1e160, 1e200, 1e308])
def test_lengths_whose_squares_are_no_numbers(size: float, sphere: Model) -> None:
    far = Camera("orthographic", (0, -size, 0), (0, 0, 0), (0, 0, size), view_height=2)
    assert far.distance == size
    np.testing.assert_array_equal(far.axes(), [[1, 0, 0], [0, 0, 1], [0, 1, 0]])
    assert Camera.fit(sphere, (0, size, 0), view_up=(0, 0, size)).direction.tolist() == [0, 1, 0]


def test_perspective_angle_has_limits() -> None:
    with pytest.raises(ValueError, match="between 0 and 180"):
        Camera.from_dict({**PERSPECTIVE, "view_angle": 180})


def test_load_names_file_and_fault(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text("{")
    with pytest.raises(ValueError, match=r"camera\.json: this is not a JSON camera file"):
        Camera.load(path)
    path.write_text('{"projection": "orthographic"}')
    with pytest.raises(ValueError, match=r"camera\.json: .*'position' is missing"):
        Camera.load(path)
    path.write_text(json.dumps(PERSPECTIVE))
    assert Camera.load(path).to_dict() == PERSPECTIVE


@pytest.mark.parametrize("values", BOTH)
@pytest.mark.parametrize("name", ["shot.png", "shot.exr", "SHOT.PNG"])
def test_pictures_give_their_camera_back(name: str, values: dict[str, Any], tmp_path: Path) -> None:
    camera = replace(Camera.from_dict(values), position=(-7e9, 1e-17, 1 / 3))  # every digit counts
    Frame(camera, {"color": np.zeros((4, 6, 4), np.float32)}).save(tmp_path / name)
    assert Camera.load(tmp_path / name) == camera


def test_pictures_without_a_camera(tmp_path: Path) -> None:
    pixels = np.zeros((2, 2, 3), np.float32)
    for suffix, dtype in (("png", np.uint8), ("exr", np.float32)):
        path = tmp_path / f"plain.{suffix}"
        image.write(path, pixels.astype(dtype), ("R", "G", "B"), {})
        with pytest.raises(
            ValueError, match=rf"plain\.{suffix}: no nofacet:camera in its metadata; only pictures made"
        ):
            Camera.load(path)
        for text, message in (("{nonsense", "nofacet:camera in its metadata is damaged"), ("[]", "not a JSON object")):
            image.write(path, pixels.astype(dtype), ("R", "G", "B"), {METADATA_KEY: text})
            with pytest.raises(ValueError, match=rf"plain\.{suffix}: .*{message}"):
                Camera.load(path)
        path.write_text("hello")
        with pytest.raises(ValueError, match=rf"plain\.{suffix}: this is not a whole picture$"):
            Camera.load(path)
        with pytest.raises(FileNotFoundError, match="No such file"):
            Camera.load(tmp_path / f"missing.{suffix}")


@given(
    direction=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda d: np.linalg.norm(d) > 1e-3),
    scale=st.sampled_from([1e-6, 1.0, 1e6]),
    wide=st.booleans(),
)
def test_orthographic_fit_touches_the_border(direction: tuple[float, float, float], scale: float, wide: bool) -> None:
    model = model_of([sphere_group(scale, (3 * scale, -2 * scale, 5 * scale))])
    resolution = (400, 200) if wide else (200, 400)
    camera = Camera.fit(model, direction, resolution=resolution, zoom=1.0)
    assert camera.view_height == pytest.approx(2 * scale if wide else 4 * scale, rel=0.08)  # sampled: slightly too near
    pixels = project(camera, resolution, surface_points(model)[0])
    assert pixels.min() > -1e-6 and (pixels.max(axis=0) < np.array(resolution) + 1e-6).all()


@given(
    direction=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda d: np.linalg.norm(d) > 1e-3),
    view_angle=st.floats(1, 120),
    wide=st.booleans(),
)
def test_perspective_fit_touches_the_border(
    direction: tuple[float, float, float], view_angle: float, wide: bool
) -> None:
    model = model_of([sphere_group(2.0, (3, -2, 5))])
    resolution = (400, 200) if wide else (200, 400)
    camera = Camera.fit(model, direction, "perspective", resolution, view_angle=view_angle, zoom=1.0)
    pixels = project(camera, resolution, surface_points(model)[0])
    assert camera.view_angle == view_angle
    assert pixels.min() > -1e-6 and (pixels.max(axis=0) < np.array(resolution) + 1e-6).all()
    border = np.concatenate([pixels, np.array(resolution) - pixels]).min(axis=0)
    assert border.min() == pytest.approx(0, abs=1e-6)


def test_zoom(sphere: Model) -> None:
    near, far = (Camera.fit(sphere, zoom=zoom) for zoom in (1.0, 0.5))
    assert near.view_height is not None and far.view_height == pytest.approx(2 * near.view_height)
    whole, part = (Camera.fit(sphere, projection="perspective", zoom=zoom) for zoom in (1.0, 20.0))
    assert whole.position == part.position  # the eye does not enter the model
    assert np.tan(np.radians(whole.view_angle or 0) / 2) == pytest.approx(
        20 * np.tan(np.radians(part.view_angle or 0) / 2)
    )


@pytest.mark.parametrize("name", VIEWS)
def test_standard_views(name: str, sphere: Model) -> None:
    direction, up = VIEWS[name]
    camera = Camera.fit(sphere, direction, view_up=up)
    np.testing.assert_allclose(camera.direction, np.array(direction) / np.linalg.norm(direction), atol=1e-12)
    assert camera.view_up == up


def test_looking_along_up_takes_another_up(sphere: Model) -> None:
    assert Camera.fit(sphere, (0, 0, -1)).view_up == (0, 1, 0)
    assert Camera.fit(sphere, (0, 1, 0), view_up=(0, 1, 0)).view_up == (0, 0, 1)


def test_fit_of_flat_models() -> None:
    corners = np.array([[[0, 0, 0], [0, 2, 0]], [[1, 0, 0], [1, 2, 0]]])
    flat = model_of([rectangle_group(corners)])
    for projection in ("orthographic", "perspective"):
        for direction in ((0, 1, 0), (0, 0, -1), (1, 1, -1)):
            camera = Camera.fit(flat, direction, projection)
            assert np.isfinite(camera.pixel_from_world((64, 48))).all()
    point = model_of([rectangle_group(np.ones((2, 2, 3)))])
    assert Camera.fit(point).view_height is not None


def test_fit_refuses() -> None:
    model = model_of([sphere_group()])
    with pytest.raises(ValueError, match="direction is zero"):
        Camera.fit(model, (0, 0, 0))
    with pytest.raises(ValueError, match="zoom is -1"):
        Camera.fit(model, zoom=-1)
    for projection in ("perspektive", None):
        with pytest.raises(ValueError, match=rf"projection is {projection!r}; write 'orthographic'"):
            Camera.fit(model, projection=projection)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="view_angle is 180; it must be between 0 and 180"):
        Camera.fit(model, projection="perspective", view_angle=180)
    with pytest.raises(InputError, match="no surface"):
        Camera.fit(replace(model, groups=[]))


@pytest.mark.parametrize("resolution", [(0, 0), (-10, 10), (float("nan"), 10), (64.0, 48.0), (64,), 64])
def test_fit_refuses_what_is_no_resolution(resolution: Any, sphere: Model) -> None:
    with pytest.raises(ValueError, match=r"^resolution .*: give "):
        Camera.fit(sphere, resolution=resolution)


def test_fit_takes_numpys_integers(sphere: Model) -> None:
    resolution = np.array([64, 48])
    assert Camera.fit(sphere, resolution=(resolution[0], resolution[1])) == Camera.fit(sphere, resolution=(64, 48))


def test_extent_follows_the_trim_loops() -> None:
    """A disc on a large square, and a window cut out of a sphere, are as large as what is drawn of them."""
    angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    corners = np.array([[[-9, -9, 0], [-9, 9, 0]], [[9, -9, 0], [9, 9, 0]]])
    disc = model_of([rectangle_group(corners, (-9, 9, -9, 9))], {0: [circle]})
    low, high = bounding_box(disc)
    np.testing.assert_allclose([low, high], [[-1, -1, 0], [1, 1, 0]], atol=1e-3)

    window = np.array([[0.5, 0.2], [1.0, 0.2], [1.0, 0.6], [0.5, 0.6]])
    cut = model_of([sphere_group()], {0: [window]})
    points, _ = surface_points(cut)
    longitude, latitude = np.arctan2(points[:, 1], points[:, 0]), np.arcsin(points[:, 2])
    np.testing.assert_allclose([longitude.min(), longitude.max()], [0.5, 1.0], atol=1e-9)
    np.testing.assert_allclose([latitude.min(), latitude.max()], [0.2, 0.6], atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1)


def test_extent_of_placed_faces(sphere: Model) -> None:
    moved = np.eye(4)
    moved[:3, 3] = 10, 20, 30
    twice = replace(
        sphere,
        placements=np.stack([np.eye(4), moved]),
        face_definition=np.array([0, 0], np.int32),
        face_placement=np.array([0, 1], np.int32),
    )
    low, high = bounding_box(twice)
    np.testing.assert_allclose([low, high], [[-1, -1, -1], [11, 21, 31]], atol=0.1)
