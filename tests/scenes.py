"""Small scenes that several test files draw, and the ways they ask about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import nofacet
from conftest import model_of, rectangle_group
from nofacet.frame import BUFFERS
from nofacet.model import Model
from nofacet.render import DEFAULT_METHOD

ALL_BUFFERS = tuple(BUFFERS)
Array = NDArray[Any]

# Directions in general position: nothing in a picture is symmetric or aligned with its rows.
GENERAL_DIRECTION = (-0.61, 0.53, -0.62)
OTHER_DIRECTION = (0.37, 0.71, -0.83)


def look_down(height: float, centre: Sequence[float] = (0.0, 0.0, 0.0), distance: float = 10.0) -> nofacet.Camera:
    """Orthographic from above: picture right is +X, picture up is +Y, `height` model units from bottom to top."""
    x, y, z = (float(c) for c in centre)
    return nofacet.Camera("orthographic", (x, y, z + distance), (x, y, z), (0, 1, 0), view_height=height)


def rectangle(x0: float, y0: float, x1: float, y1: float, z: float = 0.0, slope: tuple[float, float] = (0, 0)) -> Model:
    """A rectangle in (x, y) on the plane z + slope . (x, y), as one bilinear patch with u = x, v = y."""
    corners = [[[x, y, z + slope[0] * x + slope[1] * y] for y in (y0, y1)] for x in (x0, x1)]
    return model_of([rectangle_group(np.array(corners), (x0, x1, y0, y1))])


def together(*models: Model) -> Model:
    """Several untrimmed models as one, faces in the given order."""
    groups, definition = [], 0
    for model in models:
        for group in model.groups:
            groups.append(replace(group, definition=np.asarray(group.definition + definition, np.int32)))
        definition += model.definition_count
    return model_of(groups)


def coverage_of(
    model: Model, camera: nofacet.Camera, resolution: tuple[int, int], samples: int = 16, method: str = DEFAULT_METHOD
) -> Array:
    """Only the coverage, as float64 (height, width)."""
    frame = nofacet.render(model, camera, resolution, method, samples, buffers=("coverage",))
    return frame.coverage.astype(np.float64)


def extended_rays(camera: nofacet.Camera, resolution: tuple[int, int], x: Array, y: Array) -> tuple[Array, Array]:
    """Origins and directions (n, 3), extended precision, of rays through picture points; parameter = depth."""
    width, height = resolution
    right, up, forward = (axis.astype(np.longdouble) for axis in camera.axes())
    extent = np.longdouble(camera.extent_at_unit_depth())
    offset = (extent * (x - np.longdouble(width) / 2) / height)[:, None] * right
    offset += (extent * (np.longdouble(height) / 2 - y) / height)[:, None] * up
    eye = np.asarray(camera.position, np.longdouble)
    if camera.projection == "orthographic":
        return eye + offset, np.broadcast_to(forward, offset.shape)
    return np.broadcast_to(eye, offset.shape), forward + offset


def polygon_area(points: Array) -> float:
    """Area of a closed polygon (n, 2), positive whichever way it runs."""
    if not len(points):
        return 0.0
    x, y = (points - points.mean(axis=0)).T
    return float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2)


def clipped(polygon: Array, width: float, height: float) -> Array:
    """The part of a polygon (n, 2) inside the picture (Sutherland, Hodgman 1974); its area is right also if concave."""
    for axis, limit, sign in ((0, 0.0, 1), (0, width, -1), (1, 0.0, 1), (1, height, -1)):
        if not len(polygon):
            return polygon
        distance = sign * (polygon[:, axis] - limit)
        following, next_distance = np.roll(polygon, -1, axis=0), np.roll(distance, -1)
        crosses = (distance < 0) != (next_distance < 0)
        part = np.divide(distance, distance - next_distance, out=np.zeros(len(distance)), where=crosses)
        cut = polygon + part[:, None] * (following - polygon)
        keep = np.stack([distance >= 0, crosses], axis=1)
        polygon = np.stack([polygon, cut], axis=1)[keep]
    return polygon


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull of points (n, 2), anticlockwise (Andrew 1979)."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))].tolist()

    def chain(sequence: list[list[float]]) -> list[list[float]]:
        hull: list[list[float]] = []
        for p in sequence:
            while len(hull) > 1:
                (ax, ay), (bx, by) = hull[-2], hull[-1]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                hull.pop()
            hull.append(p)
        return hull[:-1]

    return np.array(chain(order) + chain(order[::-1]))


def compare_methods(model: Model, camera: nofacet.Camera, resolution: tuple[int, int], tied: int = 0) -> None:
    """Both methods show the same at every pixel's centre: two independent ways to the same roots.

    Depths to 1e-8 of their range, and so (u, v) where the face is not nearly edge-on, and normals, which turn fast
    beside silhouettes. `tied`: pixels at which coincident faces may be told apart differently.
    """
    scan, rays = (
        nofacet.render(model, camera, resolution, method, 1, buffers=("depth", "face", "normal", "position"))
        for method in ("bezier_clip_scanline", "bezier_clip_ray")
    )
    assert rays.stats["unresolved"] == 0
    assert (scan.face != rays.face).sum() <= tied
    same = (scan.face == rays.face) & (scan.face >= 0)
    if not same.any():
        return
    # A silhouette between the exact centre and the shifted one: depth is then that of either.
    size = max(np.ptp(scan.depth[same]), camera.extent_at_unit_depth() * (camera.projection == "orthographic"))
    error = np.abs(scan.depth[same] - rays.depth[same])
    facing = np.abs(np.sum(rays.normal[same] * camera.rays(resolution)[1][same], axis=1))
    slope = 1 / np.maximum(facing, 1e-9)
    pixel = camera.extent_at_unit_depth() / resolution[1]
    if camera.projection == "perspective":
        pixel = pixel * scan.depth[same]
    assert (error <= 1e-8 * size + 4e-8 * pixel * slope).all()
    turned = np.linalg.norm(scan.normal[same] - rays.normal[same], axis=1)
    assert (turned <= 1e-5 + 1e-7 * slope).all()
