"""Conformance: what every rendering method must do, on small scenes with exact answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import nofacet
from conftest import model_of, rectangle_group, sphere_group
from nofacet.camera import Projection
from nofacet.frame import BUFFERS
from nofacet.model import Model, PatchGroup
from scenes import (
    ALL_BUFFERS,
    GENERAL_DIRECTION,
    OTHER_DIRECTION,
    Array,
    clipped,
    coverage_of,
    extended_rays,
    look_down,
    polygon_area,
    rectangle,
    together,
)

METHODS = nofacet.methods()
PROJECTIONS: tuple[Projection, ...] = ("orthographic", "perspective")
every_method = pytest.mark.parametrize("method", METHODS)


def two_spheres() -> Model:
    return model_of(
        [
            sphere_group(1.0),
            replace(sphere_group(0.8, (0.7, 0.3, 0.4)), definition=np.ones(8, np.int32)),
        ]
    )


def crossing_planes() -> Model:
    """Two rectangles that pass through each other in the line x = y / 4 at z = 0."""
    return together(rectangle(-3, -2, 3, 2, slope=(1.0, -0.25)), rectangle(-2.5, -1.7, 2.9, 1.8, slope=(-0.5, 0.125)))


def drilled_plate(radius: float = 1.0) -> Model:
    """The square |x|, |y| <= 2 with a round hole, its loop an exact circle of four rational quadratic arcs."""
    half = np.sqrt(0.5)
    arc = np.array([[1, 0, 1], [half, half, half], [0, 1, 1]])
    turns = [np.array([[c, -s], [s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    arcs = [np.column_stack([radius * arc[:, :2] @ turn.T, arc[:, 2]]) for turn in turns]
    model = rectangle(-2, -2, 2, 2)
    square = np.array([[-2, -2], [2, -2], [2, 2], [-2, 2]], float)
    sides = [np.column_stack([[p, q], [1, 1]]) for p, q in zip(square, np.roll(square, -1, axis=0), strict=True)]
    return replace(
        model,
        trimmed=np.ones(1, np.uint8),
        definition_loops=np.array([0, 2]),
        loop_offsets=np.array([0, 4, 8]),
        segment_offsets=np.array([0, 2, 4, 6, 8, 11, 14, 17, 20]),
        segment_points=np.concatenate(sides + arcs),
        segment_edge=np.arange(8, dtype=np.int32),
    )


def triangles() -> Model:
    """A face of two triangles as CONTRACT's triangle-only faces are stored: parallelograms cut by a diagonal."""
    corners = np.array([[[0, 0, 0], [3, 0, 1], [0, 2, 0.5]], [[3, 2, 0], [0, 2, 0.5], [3, 0, 1]]], float)
    patches, loops = [], []
    for k, (a, b, c) in enumerate(corners):
        patches.append([[a, c], [b, b + c - a]])
        loops.append(np.array([[0, 2 * k], [1, 2 * k], [0, 2 * k + 1]], float))
    group = rectangle_group(np.array(patches[0]))
    points = np.concatenate([np.array(patches), np.ones((2, 2, 2, 1))], axis=3)
    domain = np.array([[0, 1, 0, 1], [0, 1, 2, 3]], float)
    group = replace(
        group,
        control_points=points,
        domain=domain,
        definition=np.zeros(2, np.int32),
        angular=np.zeros((2, 2), np.uint8),
    )
    return replace(model_of([group], {0: loops}), surface_type=["triangles"])


SCENES: dict[str, Callable[[], Model]] = {
    "two_spheres": two_spheres,
    "crossing_planes": crossing_planes,
    "drilled_plate": drilled_plate,
    "triangles": triangles,
}


@cache
def scene(name: str) -> Model:
    return SCENES[name]()


def cameras_of(model: Model, resolution: tuple[int, int]) -> list[nofacet.Camera]:
    return [
        nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=resolution),
        nofacet.Camera.fit(model, OTHER_DIRECTION, "perspective", resolution, view_angle=50),
        nofacet.Camera.fit(model, (0, 0, -1), resolution=resolution),
    ]


# Threads and buffers


@every_method
@pytest.mark.parametrize("name", SCENES)
def test_no_pixel_depends_on_the_number_of_threads(name: str, method: str) -> None:
    resolution = (67, 50)
    for camera in cameras_of(scene(name), resolution):
        frames = [
            nofacet.render(scene(name), camera, resolution, method, 3, threads, ALL_BUFFERS) for threads in (1, 2, 5)
        ]
        for buffer in ALL_BUFFERS:
            first = getattr(frames[0], buffer).tobytes()
            assert all(getattr(frame, buffer).tobytes() == first for frame in frames[1:]), buffer


@every_method
@pytest.mark.parametrize("name", SCENES)
def test_a_buffer_alone_equals_that_among_others(name: str, method: str) -> None:
    resolution = (67, 50)
    for camera in cameras_of(scene(name), resolution)[:2]:
        whole = nofacet.render(scene(name), camera, resolution, method, 4, buffers=ALL_BUFFERS)
        for buffer, (dtype, channels, _) in BUFFERS.items():
            frame = nofacet.render(scene(name), camera, resolution, method, 4, buffers=(buffer,))
            assert set(frame.buffers) == ({"depth", "position"} if buffer in ("depth", "position") else {buffer})
            array = getattr(frame, buffer)
            assert array.dtype == dtype
            assert array.shape == ((50, 67) if channels == 1 else (50, 67, channels))
            # The same to rounding: points are solved in groups, and which other planes are cut decides on the groups.
            rounding = 1e-6 if dtype == np.float32 else 1e-12
            np.testing.assert_allclose(array, getattr(whole, buffer), rounding, rounding, err_msg=buffer)


@every_method
@pytest.mark.parametrize("name", SCENES)
def test_buffers_agree_with_each_other(name: str, method: str) -> None:
    resolution = (66, 51)
    for camera in cameras_of(scene(name), resolution):
        frame = nofacet.render(scene(name), camera, resolution, method, 5, buffers=ALL_BUFFERS)
        hit = frame.face >= 0
        np.testing.assert_array_equal(np.isfinite(frame.depth), hit)
        np.testing.assert_array_equal(np.isfinite(frame.position).all(axis=2), hit)
        np.testing.assert_array_equal(frame.color[..., 3], frame.coverage)
        assert (frame.color[..., :3] <= frame.coverage[..., None] + 1e-6).all()  # premultiplied
        assert (frame.color >= 0).all()
        assert (frame.coverage >= 0).all() and (frame.coverage <= 1).all()
        assert (frame.face[frame.coverage == 0] == -1).all()
        np.testing.assert_allclose(np.linalg.norm(frame.normal[hit], axis=1), 1, atol=1e-6)
        _, direction = camera.rays(resolution)
        assert (np.sum(frame.normal * direction, axis=2)[hit] <= 1e-6).all()
        assert (frame.face < scene(name).face_count).all()
        assert not frame.uv[~hit].any() and not frame.normal[~hit].any()


# Coverage


def covered_along_x(method: str, begin: Array, end: Array, width: int, samples: int) -> Array:
    """Share of each pixel (..., width) between begin and end (...): exact, or that of `samples` rays side by side."""
    begin, end = np.asarray(begin)[..., None], np.asarray(end)[..., None]
    if method != "bezier_clip_ray":
        columns = np.arange(width)
        return np.asarray(np.clip(end - columns, 0, 1) - np.clip(begin - columns, 0, 1))
    rays = (np.arange(width * samples) + 0.5) / samples
    hit = (rays > begin) & (rays < end)
    return np.asarray(hit.reshape(*hit.shape[:-1], width, samples).mean(axis=-1))


@every_method
@pytest.mark.parametrize("samples", [1, 4, 16])
def test_coverage_of_a_rectangle_is_exact(method: str, samples: int) -> None:
    """Edges anywhere along x; along y where the scan planes resolve them, at whole samples. Rays: every one of them."""
    width, height = 24, 16
    x0, x1 = 3.3137, 20.0071
    y0, y1 = 2 + 1 / samples, 13 - 1 / samples
    model = rectangle(x0 - width / 2, height / 2 - y1, x1 - width / 2, height / 2 - y0)
    coverage = coverage_of(model, look_down(height), (width, height), samples, method)
    along_x = covered_along_x(method, np.array(x0), np.array(x1), width, samples)
    along_y = np.clip(y1 - np.arange(height), 0, 1) - np.clip(y0 - np.arange(height), 0, 1)
    np.testing.assert_allclose(coverage, along_y[:, None] * along_x, atol=1e-6)


@every_method
@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_coverage_of_a_tilted_plane(method: str, projection: str) -> None:
    """The mean over the scan planes of the exact length along x inside each pixel; within its bound of the area."""
    resolution, samples = (40, 30), 8
    model = rectangle(-2, -1, 3, 1.5, slope=(0.4, -0.7))
    camera = cameras_of(model, resolution)[projection == "perspective"]
    corners = np.array([[-2, -1], [3, -1], [3, 1.5], [-2, 1.5]])
    points = np.column_stack([corners, corners @ [0.4, -0.7], np.ones(4)]) @ camera.pixel_from_world(resolution).T
    polygon = points[:, :2] / points[:, 3:]
    coverage = coverage_of(model, camera, resolution, samples, method)
    planes = (np.arange(30 * samples) + 0.5) / samples
    spans = np.array([sorted(crossings(polygon, y)) or [0, 0] for y in planes])
    lengths = covered_along_x(method, spans[:, 0], spans[:, 1], 40, samples)
    np.testing.assert_allclose(coverage, lengths.reshape(30, samples, 40).mean(axis=1), atol=1e-6)
    areas = [
        [polygon_area(clipped(polygon - [column, row], 1, 1)) for column in range(40)] for row in range(resolution[1])
    ]
    np.testing.assert_allclose(coverage, areas, atol=1.0 / samples)
    np.testing.assert_allclose(coverage.sum(), polygon_area(polygon), atol=0.02 if method != "bezier_clip_ray" else 0.3)


def crossings(polygon: Array, y: float) -> list[float]:
    """Where the line at height y cuts a polygon's sides."""
    found = []
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if (ay <= y) != (by <= y):
            found.append(float(ax + (y - ay) / (by - ay) * (bx - ax)))
    return found


@every_method
def test_coverage_of_a_hole(method: str) -> None:
    """A drilled plate covers 16 - pi square units, seen from above and (by the cosine) obliquely."""
    resolution = (120, 90)
    for camera in cameras_of(scene("drilled_plate"), resolution)[::2]:
        coverage = coverage_of(scene("drilled_plate"), camera, resolution, 16, method)
        unit = resolution[1] / camera.extent_at_unit_depth()
        expected = (16 - np.pi) * unit**2 * abs(camera.direction[2])
        outline = ((coverage > 1e-5) & (coverage < 1 - 1e-5)).sum()
        assert abs(coverage.sum() - expected) < 1e-3 * outline


@every_method
def test_a_triangle_only_face(method: str) -> None:
    """Triangle-only faces: the area of the triangles, the depth of their planes, no gap along the diagonal."""
    resolution = (80, 60)
    model = scene("triangles")
    camera = nofacet.Camera.fit(model, (0, 0, -1), resolution=resolution)
    frame = nofacet.render(model, camera, resolution, method, 16, buffers=ALL_BUFFERS)
    unit = resolution[1] / camera.extent_at_unit_depth()
    np.testing.assert_allclose(frame.coverage.sum(dtype=float), 6 * unit**2, atol=0.1)
    x, y, z = np.moveaxis(frame.position, 2, 0)
    first = x / 3 + y / 2 < 1
    plane = np.where(first, x / 3 + y / 4, (1 - y / 2) + (1 - x / 3) / 2)
    hit = frame.face == 0
    assert (hit == ((x > 0) & (x < 3) & (y > 0) & (y < 2))).all()
    np.testing.assert_allclose(z[hit], plane[hit], atol=1e-12)


# Visibility


@every_method
def test_planes_pass_through_each_other_in_the_exact_line(method: str) -> None:
    """At pixel centres the nearer plane; inside a pixel the colours' shares are the areas on either side."""
    resolution, samples = (96, 72), 16
    model = scene("crossing_planes")
    model = replace(model, face_color=np.array([[1, 0, 0, 1], [0, 0, 1, 1]], np.float32))
    camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=3.0)
    frame = nofacet.render(model, camera, resolution, method, samples, buffers=ALL_BUFFERS)
    x, y = np.moveaxis(frame.position[..., :2], 2, 0)
    difference = x - y / 4
    clear = np.abs(difference) > 1e-6 * 3.0 / resolution[1]
    np.testing.assert_array_equal(frame.face[clear], np.where(difference > 0, 0, 1)[clear])
    np.testing.assert_allclose(frame.coverage, 1, atol=1e-6)
    pure = [frame.color[10, -1, :3].astype(float), frame.color[10, 0, :3].astype(float)]
    share = (frame.color[..., :3] - pure[1]) @ (pure[0] - pure[1]) / ((pure[0] - pure[1]) ** 2).sum()
    expected = np.zeros_like(share)
    for row in range(resolution[1]):
        for k in range(samples):
            cut = resolution[0] / 2 + (resolution[1] / 2 - row - (k + 0.5) / samples) / 4
            expected[row] += np.clip(np.arange(resolution[0]) + 1 - cut, 0, 1) / samples
    np.testing.assert_allclose(share, expected, atol=1e-5)


@every_method
@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_spheres_pass_through_each_other(method: str, projection: str) -> None:
    """Every pixel shows the nearer of two closed forms, up to 1e-6 px beside the circle where they meet."""
    resolution = (130, 97)
    model = scene("two_spheres")
    camera = cameras_of(model, resolution)[projection == "perspective"]
    frame = nofacet.render(model, camera, resolution, method, buffers=("face", "depth"))
    rows, columns = np.indices(frame.face.shape).reshape(2, -1)

    def truth(dx: float, dy: float) -> tuple[Array, Array]:
        origin, direction = extended_rays(camera, resolution, columns + 0.5 + dx, rows + 0.5 + dy)
        depth = np.stack(
            [sphere_depth(origin - np.array(c), direction, r) for c, r in (((0, 0, 0), 1), ((0.7, 0.3, 0.4), 0.8))]
        )
        return np.where(np.isfinite(depth.min(axis=0)), depth.argmin(axis=0), -1), depth.min(axis=0)

    face, depth = truth(0, 0)
    shown = frame.face.reshape(-1)
    for k in np.flatnonzero(shown != face):
        around = [truth(dx, dy)[0][k] for dx in (-1e-6, 1e-6) for dy in (-1e-6, 1e-6)]
        assert shown[k] in around, f"pixel ({columns[k]}, {rows[k]})"
    same = (shown == face) & (face >= 0)
    np.testing.assert_allclose(frame.depth.reshape(-1)[same], depth[same].astype(float), rtol=1e-9)
    assert {0, 1} <= set(face)


def sphere_depth(origin: Array, direction: Array, radius: float, far: bool = False) -> Array:
    """Depth of the nearer (or farther) point of a sphere around 0 in front of the eye; inf where there is none."""
    a, b = np.sum(direction**2, axis=-1), np.sum(origin * direction, axis=-1)
    discriminant = b * b - a * (np.sum(origin**2, axis=-1) - np.longdouble(radius) ** 2)
    root = np.sqrt(np.maximum(discriminant, 0))
    depth = (-b + (root if far else -root)) / a
    return np.where((discriminant >= 0) & (depth > 0), depth, np.inf)


@every_method
def test_coincident_faces_show_the_lower_index(method: str) -> None:
    """The same surface in different patches: bilinear whole, in two parts, and of a higher degree."""
    slope = (0.3, -0.2)
    whole = rectangle(-2, -1, 2, 1, slope=slope)
    halves = together(rectangle(-2, -1, 0.37, 1, slope=slope), rectangle(0.37, -1, 2, 1, slope=slope))
    cubic = model_of([raised(whole.groups[0])])
    resolution = (61, 40)
    rng = np.random.default_rng(5)
    for direction in [np.array([0, 0, -1.0]), *rng.normal(size=(6, 3))]:
        for model, winners in (
            (together(whole, cubic), {0}),
            (together(cubic, whole), {0}),
            (together(halves, whole), {0, 1}),
            (together(whole, halves), {0}),
        ):
            for projection in PROJECTIONS:
                camera = nofacet.Camera.fit(model, tuple(direction), projection, resolution)
                frames = [
                    nofacet.render(model, camera, resolution, method, threads=threads, buffers=("face",))
                    for threads in (1, 3)
                ]
                np.testing.assert_array_equal(frames[0].face, frames[1].face)
                assert set(np.unique(frames[0].face)) - {-1} == winners


def raised(group: PatchGroup) -> PatchGroup:
    """The same bilinear patch as one of degree (2, 3)."""
    across = np.array([[1, 0], [0.5, 0.5], [0, 1]])
    along = np.array([[1, 0], [2 / 3, 1 / 3], [1 / 3, 2 / 3], [0, 1]])
    return replace(group, control_points=np.einsum("ij,njkc,lk->nilc", across, group.control_points, along))


# Symmetric views: edges that run exactly through pixel centres


@every_method
@pytest.mark.parametrize("resolution", [(40, 30), (41, 31), (40, 31), (41, 30)])
def test_edges_through_pixel_centres_leave_no_cracks(method: str, resolution: tuple[int, int]) -> None:
    """Four plates that meet in a cross, all their edges on pixel centres or borders: nothing shines through."""
    width, height = resolution
    for shift in (0.0, 0.5):
        low, high = -9.0 - shift, 8.0 + shift
        plates = [
            rectangle(x0, y0, x1, y1)
            for x0, x1 in ((low, shift), (shift, high))
            for y0, y1 in ((low, shift), (shift, high))
        ]
        camera = look_down(height)
        frame = nofacet.render(together(*plates), camera, resolution, method, 4, buffers=ALL_BUFFERS)
        x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
        inside = (x > low) & (x < high) & (y > low) & (y < high)
        outside = (x < low) | (x > high) | (y < low) | (y > high)
        assert (frame.face[inside] >= 0).all()
        assert (frame.face[outside] == -1).all()
        np.testing.assert_allclose(frame.coverage.sum(dtype=float), (high - low) ** 2, atol=0.25 * 4 * (high - low) / 4)
        deep = (x > low + 1) & (x < high - 1) & (y > low + 1) & (y < high - 1)
        np.testing.assert_allclose(frame.coverage[deep], 1, atol=1e-6)


def box(x0: float, y0: float, z0: float, x1: float, y1: float, z1: float) -> Model:
    """Six rectangles: -x, +x, -y, +y, -z, +z."""
    low, high = np.array([x0, y0, z0]), np.array([x1, y1, z1])
    faces = []
    for axis in range(3):
        for side in (low, high):
            corners = np.empty((2, 2, 3))
            corners[..., axis] = side[axis]
            for other, along in zip([k for k in range(3) if k != axis], (0, 1), strict=True):
                shape = (2, 1) if along == 0 else (1, 2)
                corners[..., other] = np.reshape([low[other], high[other]], shape)
            faces.append(model_of([rectangle_group(corners)]))
    return together(*faces)


@every_method
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("resolution", [(40, 30), (41, 31)])
def test_faces_seen_edge_on_cover_nothing(method: str, axis: int, resolution: tuple[int, int]) -> None:
    model = box(-3, -4, -5, 3, 4, 5)
    direction = np.eye(3)[axis]
    up = (0, 0, 1) if axis < 2 else (0, 1, 0)
    camera = nofacet.Camera("orthographic", tuple(-20 * direction), (0, 0, 0), up, view_height=15)
    frame = nofacet.render(model, camera, resolution, method, 16, buffers=ALL_BUFFERS)
    half = np.array([3, 4, 5])
    assert set(np.unique(frame.face)) == {-1, 2 * axis}
    np.testing.assert_allclose(frame.depth[frame.face >= 0], 20 - half[axis], rtol=1e-14)
    unit = resolution[1] / 15
    across = [k for k in range(3) if k != axis]
    outline = 2 * unit * 2 * (half[across[0]] + half[across[1]])
    expected = 4 * half[across[0]] * half[across[1]] * unit**2
    np.testing.assert_allclose(frame.coverage.sum(dtype=float), expected, atol=outline / 32)


# Perspective: surfaces around and behind the eye


@every_method
def test_a_sphere_around_the_eye(method: str) -> None:
    """Every pixel shows the inside, at the closed form's depth; part of each patch lies behind the eye."""
    resolution = (60, 45)
    model = model_of([sphere_group(2.0)])
    rng = np.random.default_rng(3)
    rows, columns = np.indices((45, 60)).reshape(2, -1)
    for view_angle in (20.0, 90.0, 160.0):
        eye = rng.uniform(-0.9, 0.9, 3)
        target = eye + rng.normal(size=3)
        camera = nofacet.Camera("perspective", tuple(eye), tuple(target), view_angle=view_angle)
        frame = nofacet.render(model, camera, resolution, method, buffers=ALL_BUFFERS)
        origin, direction = extended_rays(camera, resolution, columns + 0.5, rows + 0.5)
        expected = sphere_depth(origin, direction, 2.0, far=True).astype(float)
        np.testing.assert_allclose(frame.depth.reshape(-1), expected, rtol=1e-12)
        np.testing.assert_allclose(frame.coverage, 1, atol=1e-6)
        np.testing.assert_allclose(frame.normal, -frame.position / 2, atol=3e-7)


@every_method
def test_a_floor_that_reaches_behind_the_eye(method: str) -> None:
    """A floor one unit below the eye is seen up to its far edge, whatever of it lies beside and behind."""
    resolution = (64, 48)
    model = rectangle(-500, -500, 500, 500)
    for pitch in (-0.02, -0.4, -1.5, 0.2):
        camera = nofacet.Camera("perspective", (3, -2, 1), (3.1, -1, 1 + pitch), view_angle=60)
        frame = nofacet.render(model, camera, resolution, method, 8, buffers=ALL_BUFFERS)
        origin, direction = camera.rays(resolution)
        with np.errstate(divide="ignore"):
            depth = -1 / direction[..., 2]
        hit = (direction[..., 2] < 0) & (np.abs(origin + depth[..., None] * direction)[..., :2].max(axis=2) < 500)
        np.testing.assert_array_equal(frame.face >= 0, hit)
        np.testing.assert_allclose(frame.depth[hit], depth[hit], rtol=1e-12)
        np.testing.assert_allclose(frame.uv[hit], frame.position[hit][:, :2], rtol=1e-9, atol=1e-9)
        deep = hit & np.roll(hit, 1, axis=0)
        deep[0] = hit[0] & hit[1]
        np.testing.assert_allclose(frame.coverage[deep], 1, atol=1e-6)


@every_method
def test_what_lies_behind_the_eye_is_not_seen(method: str) -> None:
    model = together(rectangle(-1, -1, 1, 1, z=5.0), rectangle(-1, -1, 1, 1, z=-5.0))
    camera = nofacet.Camera("perspective", (0, 0, 0), (0, 0, -1), (0, 1, 0), view_angle=90)
    frame = nofacet.render(model, camera, (40, 40), method, buffers=ALL_BUFFERS)
    assert set(np.unique(frame.face)) == {-1, 1}
    assert (frame.face == 1).sum() == 64  # 2 / (2 * 5) of 40 pixels, squared
    np.testing.assert_allclose(frame.coverage.sum(dtype=float), 64, atol=1e-5)


# Small and empty pictures


@every_method
@pytest.mark.parametrize("resolution", [(1, 1), (1, 33), (33, 1)])
def test_a_picture_of_one_row_or_column(method: str, resolution: tuple[int, int]) -> None:
    """It equals the middle of a picture three times as wide and high."""
    width, height = resolution
    camera = nofacet.Camera("orthographic", (3, 2, 5), (0.1, 0.1, 0.3), view_height=2.0 * height / max(resolution))
    larger = replace(camera, view_height=3 * 2.0 * height / max(resolution))
    small = nofacet.render(scene("two_spheres"), camera, resolution, method, buffers=ALL_BUFFERS)
    large = nofacet.render(scene("two_spheres"), larger, (3 * width, 3 * height), method, buffers=ALL_BUFFERS)
    assert small.face.max() >= 0
    for buffer in ALL_BUFFERS:
        middle = getattr(large, buffer)[height : 2 * height, width : 2 * width]
        np.testing.assert_allclose(getattr(small, buffer), middle, rtol=1e-9, atol=2e-6, err_msg=buffer)


@every_method
def test_faces_outside_the_picture(method: str) -> None:
    """They leave no trace, neither alone nor beside one that is inside."""
    resolution = (40, 30)
    camera = look_down(6.0)
    inside = rectangle(-1.03, -1.07, 1.21, 0.94)
    around = [
        rectangle(x, y, x + 2, y + 2, z) for x, y, z in ((7, 0, 0), (-9, 0, 1), (0, 4, 0), (0, -6, -1), (9, 9, 2))
    ]
    alone = nofacet.render(inside, camera, resolution, method, buffers=ALL_BUFFERS)
    among = nofacet.render(together(inside, *around), camera, resolution, method, buffers=ALL_BUFFERS)
    for buffer in ALL_BUFFERS:
        np.testing.assert_array_equal(getattr(among, buffer), getattr(alone, buffer), err_msg=buffer)
    empty = nofacet.render(together(*around), camera, resolution, method, buffers=ALL_BUFFERS)
    assert (empty.face == -1).all()
    assert np.isinf(empty.depth).all()
    assert not empty.coverage.any() and not empty.color.any()
