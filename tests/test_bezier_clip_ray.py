"""bezier_clip_ray: agreement with bezier_clip_scanline, rays on a grid, shadows and mirror images in closed form."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS, model_of, sphere_group
from nofacet.camera import Projection
from nofacet.model import Model
from scenes import (
    ALL_BUFFERS,
    GENERAL_DIRECTION,
    OTHER_DIRECTION,
    Array,
    compare_methods,
    look_down,
    rectangle,
    together,
)
from test_cases import cases, patch
from test_methods import PROJECTIONS, SCENES, cameras_of, scene

METHOD = "bezier_clip_ray"
CAD_MODELS = Path(__file__).resolve().parents[1] / "cad_models"
KEY = np.array([-0.29, 0.35, -0.89])  # towards the light: right, up, forward (src/native/light.h)


# Agreement with the other method


@pytest.mark.parametrize("name", SCENES)
def test_small_scenes_agree(name: str) -> None:
    resolution = (131, 97)
    for camera in cameras_of(scene(name), resolution):
        compare_methods(scene(name), camera, resolution)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.5707963267948966])
@pytest.mark.parametrize("case", cases("patches"), ids=lambda case: case["name"])
def test_hard_patches_agree(case: dict[str, Any], angle: float) -> None:
    up = (np.sin(angle), np.cos(angle), 0.0)
    camera = nofacet.Camera("orthographic", (0.4, 0.3, 9.0), (0.4, 0.3, 0.0), up, view_height=4.1)
    compare_methods(patch(case["control_points"]), camera, (160, 120))


def check_model(path: Path) -> None:
    """General, along the axes, from within the model, and 1000 times enlarged."""
    model = nofacet.load(path)
    resolution = (160, 120)
    fit = nofacet.Camera.fit
    cameras = [
        fit(model, GENERAL_DIRECTION, resolution=resolution),
        fit(model, OTHER_DIRECTION, "perspective", resolution),
    ]
    cameras += [fit(model, tuple(axis), resolution=resolution) for axis in np.eye(3)]
    first = cameras[0]
    frame = nofacet.render(model, first, resolution, samples=1, buffers=("position", "face"))
    hits = np.argwhere(frame.face >= 0)
    point = frame.position[tuple(hits[len(hits) // 3])]
    eye = point - first.direction * first.extent_at_unit_depth()
    cameras.append(
        replace(first, position=tuple(eye), focal_point=tuple(point), view_height=first.extent_at_unit_depth() / 1000)
    )
    near = point - 0.01 * first.direction * first.extent_at_unit_depth()
    cameras.append(nofacet.Camera("perspective", tuple(near), tuple(near + [0.3, 0.2, 0.1]), view_angle=100))
    for camera in cameras:
        compare_methods(model, camera, resolution)


@pytest.mark.parametrize("name", ["teapot", "bottle", "flange", "crossing"])
def test_our_models_agree(name: str) -> None:
    check_model(CAD_MODELS / f"{name}.step")


@pytest.mark.skipif(not SHARED_MODELS.is_dir(), reason="the shared test models are not beside the repository")
@pytest.mark.parametrize("name", ["nist/nist_ctc_02_asme1_rc.stp", "occt/linkrods.step", "parts/RJ24.stp"])
def test_files_agree(name: str) -> None:
    check_model(SHARED_MODELS / name)


# Rays on a grid


def test_samples_are_rays_on_a_regular_grid() -> None:
    """Coverage is the share of the rays that hit; one sample is the pixel's centre."""
    resolution = (60, 45)
    model = scene("two_spheres")
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=resolution)
    single = nofacet.render(model, camera, resolution, METHOD, 1, buffers=ALL_BUFFERS)
    np.testing.assert_array_equal(single.coverage, single.face >= 0)
    for samples in (2, 3, 4):
        fine_resolution = (samples * resolution[0], samples * resolution[1])
        fine = nofacet.render(model, camera, fine_resolution, METHOD, 1, buffers=("face",))
        expected = (fine.face >= 0).reshape(resolution[1], samples, resolution[0], samples).mean(axis=(1, 3))
        frame = nofacet.render(model, camera, resolution, METHOD, samples, buffers=ALL_BUFFERS)
        np.testing.assert_allclose(frame.coverage, expected, atol=1e-6)
        np.testing.assert_array_equal(frame.face, single.face)


# Shadows and mirror images


SPHERE = np.array([0.3, -0.2, 3.0])


def ball_over_floor() -> Model:
    floor = rectangle(-6, -6, 6, 6)
    ball = model_of([sphere_group(1.0, (0.3, -0.2, 3.0))])
    return together(floor, ball)


def floor_camera(projection: Projection, resolution: tuple[int, int]) -> nofacet.Camera:
    return nofacet.Camera.fit(ball_over_floor(), (0.5, 0.7, -1), projection, resolution)


def meets_ball(origin: Array, direction: Array) -> Array:
    """Whether rays from points outside the ball meet it; NaN origins do not."""
    unit = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    to_ball = SPHERE - origin
    along = np.sum(to_ball * unit, axis=-1)
    return np.asarray((along > 0) & (np.sum(to_ball**2, axis=-1) - along**2 < 1))


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_shadow_of_a_ball_on_a_floor(projection: Projection) -> None:
    resolution = (160, 120)
    model, camera = ball_over_floor(), floor_camera(projection, resolution)
    lit, shaded = (
        nofacet.render(model, camera, resolution, METHOD, 1, buffers=ALL_BUFFERS, shadows=shadows)
        for shadows in (False, True)
    )
    key = KEY @ np.stack(camera.axes())
    darker = lit.color[..., 0] - shaded.color[..., 0] > 1e-3
    floor = lit.face == 0
    expected = meets_ball(lit.position, np.broadcast_to(key, lit.position.shape))
    assert expected[floor].any()
    np.testing.assert_array_equal(darker[floor], expected[floor])
    # The ball casts no shadow on itself: where it faces the light it is lit, elsewhere there was no light to lose.
    np.testing.assert_array_equal(lit.color[lit.face == 1], shaded.color[lit.face == 1])
    np.testing.assert_array_equal(lit.depth, shaded.depth)


@pytest.mark.parametrize("name", ["two_spheres", "drilled_plate"])
def test_a_surface_casts_no_shadow_on_the_place_it_is_at(name: str) -> None:
    """Two spheres only shade each other, and a plate nothing: no speckles, however the rays graze."""
    resolution = (130, 97)
    for camera in cameras_of(scene(name), resolution):
        lit, shaded = (
            nofacet.render(scene(name), camera, resolution, METHOD, 1, buffers=ALL_BUFFERS, shadows=shadows)
            for shadows in (False, True)
        )
        darker = (lit.color[..., 0] - shaded.color[..., 0] > 1e-3) & (lit.face >= 0)
        if name == "drilled_plate":
            assert not darker.any()
            continue
        key = KEY @ np.stack(camera.axes())
        key /= np.linalg.norm(key)
        centres, radii = np.array([[0, 0, 0], [0.7, 0.3, 0.4]]), np.array([1, 0.8])
        other = 1 - np.maximum(lit.face, 0)
        to_other = centres[other] - lit.position
        along = to_other @ key
        gap = np.sum(to_other**2, axis=2) - along**2 - radii[other] ** 2
        certain = (lit.face >= 0) & (np.abs(gap) > 1e-6) & (lit.normal @ key > 1e-2)
        # The other sphere is met ahead, from outside: the nearer root is ahead of a point that is not inside it.
        expected = (gap < 0) & (along > 0)
        np.testing.assert_array_equal(darker[certain], expected[certain])


def test_transparent_faces_cast_no_shadow() -> None:
    resolution = (80, 60)
    model, camera = ball_over_floor(), floor_camera("orthographic", resolution)
    model = replace(model, face_color=np.array([[0.5, 0.5, 0.5, 1], [0.5, 0.5, 0.5, 0.4]], np.float32))
    lit, shaded = (nofacet.render(model, camera, resolution, METHOD, 2, shadows=shadows) for shadows in (False, True))
    np.testing.assert_allclose(lit.color, shaded.color, atol=1e-6)


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_mirror_image_of_a_ball_in_a_floor(projection: Projection) -> None:
    """Where the mirrored ray leaves the model, its share of alpha stays open and the rest is the floor's own colour."""
    resolution, share = (160, 120), 0.25
    model, camera = ball_over_floor(), floor_camera(projection, resolution)
    plain = nofacet.render(model, camera, resolution, METHOD, 1, buffers=ALL_BUFFERS)
    mirror = nofacet.render(model, camera, resolution, METHOD, 1, buffers=ALL_BUFFERS, reflectance=share)
    direction = camera.rays(resolution)[1] * [1, 1, -1]
    seen = meets_ball(plain.position, direction)
    floor = plain.face == 0
    assert seen[floor].any()
    empty = floor & ~seen
    np.testing.assert_allclose(mirror.color[empty], (1 - share) * plain.color[empty], atol=1e-6)
    assert (mirror.color[..., 3][floor & seen] > 1 - share**2 - 1e-6).all()
    own = (1 - share) * plain.color[..., :3]
    assert (mirror.color[..., :3][floor & seen] > own[floor & seen]).all()
    assert (mirror.color[plain.face < 0] == 0).all()


def test_pictures_with_shadows_do_not_depend_on_the_threads() -> None:
    resolution = (67, 50)
    model, camera = ball_over_floor(), floor_camera("perspective", resolution)
    frames = [
        nofacet.render(model, camera, resolution, METHOD, 2, threads, shadows=True, reflectance=0.3)
        for threads in (1, 3)
    ]
    np.testing.assert_array_equal(frames[0].color, frames[1].color)


@pytest.mark.parametrize("wanted", [{"shadows": True}, {"reflectance": 0.5}])
def test_the_scanline_method_refuses_secondary_rays(wanted: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="casts neither shadows nor mirror images; choose bezier_clip_ray"):
        nofacet.render(ball_over_floor(), look_down(5), (8, 6), **wanted)


@pytest.mark.parametrize("reflectance", [-0.1, 1.0, float("nan")])
def test_reflectance_is_a_share(reflectance: float) -> None:
    with pytest.raises(ValueError, match="share from 0 to below 1"):
        nofacet.render(ball_over_floor(), look_down(5), (8, 6), METHOD, reflectance=reflectance)
