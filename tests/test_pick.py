"""The facts of a picked point: closed forms, agreement with the frame, names and parts, texts."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, isnan, nan

import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS, model_of, rectangle_group, sphere_group
from nofacet.camera import Projection
from nofacet.model import Model, Node
from scenes import ALL_BUFFERS, GENERAL_DIRECTION, extended_rays, look_down, rectangle

RESOLUTION = (160, 120)


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_a_sphere_is_hit_where_the_ray_is(projection: Projection) -> None:
    """Anywhere between pixel centres, also far from the middle of a wide perspective picture."""
    model = replace(model_of([sphere_group(2.0, (3, -2, 5))]), surface_type=["sphere"])
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, RESOLUTION, view_angle=80)
    x, y = np.random.default_rng(1).uniform(0, RESOLUTION, (60, 2)).T
    origin, direction = extended_rays(camera, RESOLUTION, x, y)
    towards = origin - np.array([3, -2, 5])
    b, dd = np.sum(towards * direction, axis=1), np.sum(direction**2, axis=1)
    discriminant = b * b - dd * (np.sum(towards**2, axis=1) - 4)
    hits = 0
    for k in np.flatnonzero(np.abs(discriminant) > 1e-6):
        found = nofacet.pick(model, camera, RESOLUTION, x[k], y[k])
        if discriminant[k] < 0:
            assert found is None
            continue
        depth = (-b[k] - np.sqrt(discriminant[k])) / dd[k]
        point = (origin[k] + depth * direction[k]).astype(float)
        assert found is not None and found.face == 0 and found.surface_type == "sphere"
        np.testing.assert_allclose(found.position, point, atol=1e-9)
        np.testing.assert_allclose(found.normal, (point - [3, -2, 5]) / 2, atol=1e-9)
        assert found.depth == pytest.approx(float(depth), abs=1e-9)
        np.testing.assert_allclose(found.principal_curvatures, -0.5, atol=1e-9)
        np.testing.assert_allclose(found.radii_of_curvature, -2, atol=1e-8)
        hits += 1
    assert 20 < hits < 60


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_pixel_centres_are_the_frames(projection: Projection) -> None:
    path = SHARED_MODELS / "occt" / "linkrods.step"
    if not path.exists():
        pytest.skip("the shared test models are not beside the repository")
    model = nofacet.load(path)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, RESOLUTION)
    frame = nofacet.render(model, camera, RESOLUTION, buffers=ALL_BUFFERS)
    rng = np.random.default_rng(2)
    size = np.nanmax(frame.position) - np.nanmin(frame.position)
    for column, row in zip(rng.integers(RESOLUTION[0], size=80), rng.integers(RESOLUTION[1], size=80), strict=True):
        found = nofacet.pick(model, camera, RESOLUTION, column + 0.5, row + 0.5)
        assert (found.face if found else -1) == frame.face[row, column]
        if found:
            facing = abs(frame.normal[row, column] @ camera.rays(RESOLUTION)[1][row, column])
            np.testing.assert_allclose(found.position, frame.position[row, column], atol=1e-10 * size / facing)
            assert found.depth == pytest.approx(frame.depth[row, column], abs=1e-10 * size / facing)


def two_parts() -> Model:
    corners = np.array([[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]], float)
    groups = [rectangle_group(corners + [2 * k, 0, 0]) for k in range(2)]
    groups[1] = replace(groups[1], definition=np.ones(1, np.int32))
    return replace(
        model_of(groups),
        surface_type=["plane", "plane"],
        face_name=["", "lid"],
        conversion_error=np.array([nan, 2e-13]),
        edge_use_face=np.array([0, 1, 1, 1], np.int32),
        edge_use_deviation=np.array([nan, nan, 3e-6, 1e-7]),
        edge_use_tolerance=np.full(4, 1e-5),
        tree=[
            Node("machine", -1, np.empty(0, np.int32)),
            Node("left", 0, np.array([0], np.int32)),
            Node("", 0, np.array([1], np.int32)),
        ],
    )


def test_what_the_model_says_of_a_face() -> None:
    model, camera = two_parts(), look_down(4.0, (1.5, 0.5, 0))
    left = nofacet.pick(model, camera, (400, 400), 100, 200)
    right = nofacet.pick(model, camera, (400, 400), 300, 200)
    assert left and right
    assert (left.face, left.name, left.part, left.node) == (0, "", ("machine", "left"), 1)
    assert (right.face, right.name, right.part, right.node) == (1, "lid", ("machine", ""), 2)
    assert isnan(left.conversion_error) and isnan(left.trim_deviation)
    assert (right.conversion_error, right.trim_deviation) == (2e-13, 3e-6)
    assert str(right).splitlines() == [
        "face 1 lid, plane",
        "machine / unnamed",
        "(u, v)      0.5, 0.5",
        "point       2.5, 0.5, 0 mm",
        "normal      0.000000, 0.000000, 1.000000",
        "curvature   flat, flat",
        "conversion  within 2.0e-13 mm",
        "trimming    within 3.0e-06 mm",
    ]
    assert "trimming    not measured" in str(left)
    assert "normal      0.000000, 0.600000, 0.800000" in str(replace(left, normal=(-1e-9, 0.6, 0.8)))
    assert nofacet.pick(model, camera, (400, 400), 200, 200) is None  # between the two
    assert nofacet.pick(model, camera, (400, 400), -50, 200) is None  # outside the picture, and nothing there


def test_outside_the_picture_there_is_more() -> None:
    found = nofacet.pick(rectangle(-9, -9, 9, 9), look_down(1.0), (10, 10), 85.0, -20.0)
    assert found and found.part == () and found.node == -1
    np.testing.assert_allclose(found.position, [8, 2.5, 0], atol=1e-12)


def test_texts_of_bends() -> None:
    model = replace(model_of([sphere_group(2.0)]), surface_type=["sphere"])
    found = nofacet.pick(model, look_down(8.0), RESOLUTION, 70.0, 50.0)
    assert found and "curvature   radius 2 mm convex, radius 2 mm convex" in str(found)
    hollow = nofacet.pick(replace(model, face_outward=-model.face_outward), look_down(8.0), RESOLUTION, 70.0, 50.0)
    assert hollow and hollow.bend_texts == ("radius 2 mm concave", "radius 2 mm concave")
    np.testing.assert_allclose(hollow.normal, -np.array(found.normal), atol=1e-15)
    pole = replace(found, principal_curvatures=(nan, nan))
    assert "curvature   not defined, not defined" in str(pole)
    assert all(isnan(radius) for radius in pole.radii_of_curvature)


def test_measure() -> None:
    model = replace(model_of([sphere_group(2.0)]), surface_type=["sphere"])
    first = nofacet.pick(model, look_down(8.0), (800, 800), 400 + 120, 400)  # x = 1.2, z = 1.6
    second = nofacet.pick(model, look_down(8.0), (800, 800), 400 - 120, 400)
    assert first and second
    found = nofacet.measure(first, second)
    assert found.distance == pytest.approx(2.4, abs=1e-9)
    np.testing.assert_allclose(found.offset, [-2.4, 0, 0], atol=1e-9)
    assert found.angle == pytest.approx(degrees(2 * np.arcsin(0.6)), abs=1e-6)
    assert (found.first, found.second) == (first, second)
    assert str(found).splitlines() == [
        "distance    2.4 mm",
        "offset      -2.4, 0, 0 mm",
        "normals     73.7398 degrees apart",
        "at first    radius 2 mm convex, radius 2 mm convex",
        "at second   radius 2 mm convex, radius 2 mm convex",
    ]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1.0, 90.0, 179.999999999, 180.0])
def test_angles_to_rounding(angle: float) -> None:
    found = nofacet.pick(rectangle(-1, -1, 1, 1), look_down(1.0), (10, 10), 5, 5)
    assert found
    turned = replace(found, normal=(float(np.sin(np.radians(angle))), 0.0, float(np.cos(np.radians(angle)))))
    assert nofacet.measure(found, turned).angle == pytest.approx(angle, rel=1e-14, abs=1e-13)


def test_measuring_two_sides_of_a_part() -> None:
    """Wall thickness: opposite normals, the distance between the planes."""
    cq = pytest.importorskip("cadquery")
    model = nofacet.load(cq.Workplane().box(20, 10, 3))
    top = nofacet.pick(model, look_down(40.0), (400, 400), 210, 195)
    below = nofacet.Camera("orthographic", (0, 0, -10), (0, 0, 0), (0, 1, 0), view_height=40)
    bottom = nofacet.pick(model, below, (400, 400), 190, 195)
    assert top and bottom and top.face != bottom.face
    found = nofacet.measure(top, bottom)
    assert found.distance == pytest.approx(3, abs=1e-12) and found.angle == pytest.approx(180, abs=1e-12)
    assert "at first    flat, flat" in str(found)


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_what_is_cut_away_is_not_picked(projection: Projection) -> None:
    cq = pytest.importorskip("cadquery")
    model = nofacet.load(cq.Workplane().box(20, 10, 4).edges("|Z").fillet(1))
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, RESOLUTION, view_angle=50)
    sections = [nofacet.Section((50, 0, 0), (1, 0, 0)), nofacet.Section((1, 2, 0.5), (-0.1, 0.2, 1))]
    frame = nofacet.render(model, camera, RESOLUTION, buffers=ALL_BUFFERS, sections=sections)
    caps = 0
    for row, column in np.random.default_rng(3).integers((RESOLUTION[1], RESOLUTION[0]), size=(80, 2)):
        found = nofacet.pick(model, camera, RESOLUTION, column + 0.5, row + 0.5, sections=sections)
        assert (found.face if found else -1) == frame.face[row, column]
        if found is None:
            continue
        np.testing.assert_allclose(found.position, frame.position[row, column], atol=1e-8)
        assert found.depth == pytest.approx(frame.depth[row, column], abs=1e-8)
        if found.face < 0:
            caps += 1
            assert found.section == 1 and found.normal == sections[1].normal
            assert np.subtract(found.position, sections[1].origin) @ found.normal == pytest.approx(0, abs=1e-10)
            assert str(found).splitlines()[0] == "cap of a section plane" and isnan(found.uv[0])
            other = nofacet.pick(model, camera, RESOLUTION, column + 0.5, row + 0.5)
            assert other and other.section is None and nofacet.measure(found, other).distance > 0
            frame_of_cap = np.array([*found.principal_directions, found.normal])
            np.testing.assert_allclose(np.linalg.det(frame_of_cap), 1, atol=1e-12)
    assert caps > 10


def test_picks_that_make_no_sense(sphere: Model) -> None:
    camera = nofacet.Camera.fit(sphere)
    with pytest.raises(ValueError, match="finite pixel coordinates"):
        nofacet.pick(sphere, camera, RESOLUTION, nan, 3)
    with pytest.raises(ValueError, match="resolution 0 x 5"):
        nofacet.pick(sphere, camera, (0, 5), 1, 3)
    with pytest.raises(nofacet.InputError, match="nothing to draw"):
        nofacet.pick(replace(sphere, groups=[]), camera, RESOLUTION, 1, 3)
