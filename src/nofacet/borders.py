"""Where scan lines through the pixel centres enter and leave a model, or a mesh of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan, degrees

import numpy as np
from numpy.typing import NDArray

from . import _native
from .camera import Camera
from .mesh import Mesh
from .model import Model

Array = NDArray[np.float64]

ROW_SHIFT = 1.3093e-8  # px: how far below the pixel centres the renderer's scan planes run (raster/scan_planes.h)
MERGED = 1e-6  # px: stretches this close are one; faces of a mesh meet only up to rounding


@dataclass(frozen=True)
class Borders:
    """Where the scan lines of one direction enter and leave what is drawn.

    line: (n,) int64, the scan line. x: (n,) pixels along it. enters: (n,) whether the stretch begins here.
    across: (n,) the cosine between the scan line and the outline's normal there.
    """

    line: NDArray[np.int64]
    x: Array
    enters: NDArray[np.bool_]
    across: Array


def turned(camera: Camera, resolution: tuple[int, int]) -> tuple[Camera, tuple[int, int]]:
    """The camera turned by 90 degrees about its axis, whose rows are the columns of the first's picture: row k is
    column k."""
    width, height = resolution
    right, _, _ = camera.axes()
    up = (-float(right[0]), -float(right[1]), -float(right[2]))
    extent = camera.extent_at_unit_depth() * width / height
    if camera.projection == "orthographic":
        return replace(camera, view_up=up, view_height=extent), (height, width)
    return replace(camera, view_up=up, view_angle=2 * degrees(atan(extent / 2))), (height, width)


def exact_borders(model: Model, camera: Camera, resolution: tuple[int, int]) -> tuple[Borders, Borders]:
    """On rows and on columns, from the exact surfaces."""
    scene = _native.Scene(model)
    return _exact(scene, camera, resolution), _exact(scene, *turned(camera, resolution))


def _exact(scene: _native.Scene, camera: Camera, resolution: tuple[int, int]) -> Borders:
    width, height = resolution
    offsets, ends = scene.outline(
        eye=tuple(camera.position),
        axes=np.array(camera.axes()),
        scale=height / camera.extent_at_unit_depth(),
        perspective=camera.projection == "perspective",
        width=width,
        height=height,
    )
    line = np.repeat(np.arange(height), np.diff(offsets))
    return _with_slopes(_borders(line, _merged(line, ends, np.ones_like(ends)), width))


def _with_slopes(borders: Borders) -> Borders:
    """The same with `across` from the next border of the same kind on the two neighbouring scan lines."""
    across = np.zeros(len(borders.x))
    for kind in (True, False):
        chosen = np.flatnonzero(borders.enters == kind)
        line, x = borders.line[chosen], borders.x[chosen]
        run = np.minimum(_nearest_distance(line - 1, x, line, x), _nearest_distance(line + 1, x, line, x))
        across[chosen] = 1 / np.hypot(1.0, run)
    return Borders(borders.line, borders.x, borders.enters, across)


def _nearest_distance(line: NDArray[np.int64], x: Array, lines: NDArray[np.int64], xs: Array) -> Array:
    """For places x on scan lines the distance (n,) to the nearest of the places xs on the same line, sorted by line and
    place; +inf on a line without any."""
    if not len(xs):
        return np.full(len(x), np.inf)
    spread = 4.0 * (1.0 + max(x.max(initial=0.0), xs.max()))
    after = np.searchsorted(lines * spread + xs, line * spread + x)
    candidates = np.clip(np.stack([after - 1, after]), 0, len(xs) - 1)
    return np.where(lines[candidates] == line, np.abs(xs[candidates] - x), np.inf).min(axis=0)


def mesh_borders(mesh: Mesh, camera: Camera, resolution: tuple[int, int]) -> tuple[Borders, Borders]:
    """On rows and on columns, from the mesh's triangles. Those that reach behind a perspective eye are left out."""
    places, triangles = _welded(mesh)
    return (
        _drawn(places, triangles, camera, resolution),
        _drawn(places, triangles, *turned(camera, resolution)),
    )


def _welded(mesh: Mesh) -> tuple[Array, NDArray[np.int64]]:
    """Distinct points (p, 3) and triangles (t, 3) between them: neighbouring faces share the points on their edge."""
    order = np.lexsort(mesh.points.T)
    points = mesh.points[order]
    new = np.ones(len(points), bool)
    new[1:] = (points[1:] != points[:-1]).any(axis=1)
    place = np.empty(len(points), np.int64)
    place[order] = np.cumsum(new) - 1
    return points[new], place[mesh.triangles]


def _drawn(places: Array, triangles: NDArray[np.int64], camera: Camera, resolution: tuple[int, int]) -> Borders:
    """Every triangle, turned anticlockwise in the picture, adds one inside its outline. Summed over all triangles, an
    edge between two neighbours that lie on its two sides adds nothing; what is left are few edges, and on a scan line
    their sum from the left says how many triangles cover a place."""
    width, height = resolution
    matrix = camera.pixel_from_world(resolution)
    weight = places @ matrix[3, :3] + matrix[3, 3]
    triangles = triangles[(weight > 0)[triangles].all(axis=1)]
    pixels = (places @ matrix[:2, :3].T + matrix[:2, 3]) / np.where(weight > 0, weight, 1)[:, None]
    edges, more = _outline_edges(pixels, triangles)
    low, high = pixels[edges[:, 0]], pixels[edges[:, 1]]  # low y first
    first = np.maximum(np.ceil(low[:, 1] - 0.5 - ROW_SHIFT), 0).astype(np.int64)
    last = np.minimum(np.ceil(high[:, 1] - 0.5 - ROW_SHIFT), height).astype(np.int64)  # not included
    count = np.maximum(last - first, 0)
    edge = np.repeat(np.arange(len(edges)), count)
    line = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    run = high - low
    part = (line + 0.5 + ROW_SHIFT - low[edge, 1]) / run[edge, 1]
    x = low[edge, 0] + part * run[edge, 0]
    order = np.lexsort((x, line))
    line, x, edge = line[order], x[order], edge[order]
    cover = np.cumsum(more[edge])
    before = np.concatenate([[0], cover[:-1]])
    enters, leaves = (before == 0) & (cover > 0), (before > 0) & (cover == 0)
    across = np.abs(run[:, 1]) / np.hypot(run[:, 0], run[:, 1])
    ends = np.stack([x[enters], x[leaves]], axis=1)
    return _borders(
        line[enters], _merged(line[enters], ends, np.stack([across[edge[enters]], across[edge[leaves]]], 1)), width
    )


def _outline_edges(pixels: Array, corners: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Edges (e, 2), the end with the smaller y first, whose two sides differ in the number of triangles that cover
    them; and how many more cover the right side (e,)."""
    a, b, c = (pixels[corners[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    corners = np.where((area < 0)[:, None], corners[:, ::-1], corners)[area != 0]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    downwards = pixels[start, 1] < pixels[end, 1]
    level = pixels[start, 1] == pixels[end, 1]
    low, high = np.where(downwards, start, end)[~level], np.where(downwards, end, start)[~level]
    # y grows downwards, so with positive area an edge that runs upwards has the triangle on its right.
    weight = np.where(downwards, -1, 1)[~level]
    key, edge = np.unique(low * len(pixels) + high, return_inverse=True)
    sums = np.bincount(edge.reshape(-1), weight, len(key)).astype(np.int64)
    key, sums = key[sums != 0], sums[sums != 0]
    return np.stack([key // len(pixels), key % len(pixels)], axis=1), sums


def _merged(line: NDArray[np.int64], ends: Array, across: Array) -> tuple[NDArray[np.bool_], Array, Array]:
    """Which stretches begin anew, with neighbours less than MERGED apart joined: (mask, ends, across) of the joined."""
    if not len(line):
        return np.zeros(0, bool), ends, across
    new = np.ones(len(line), bool)
    new[1:] = (line[1:] != line[:-1]) | (ends[1:, 0] > ends[:-1, 1] + MERGED)
    final = np.roll(new, -1)
    final[-1] = True
    return new, np.stack([ends[new, 0], ends[final, 1]], 1), np.stack([across[new, 0], across[final, 1]], 1)


def _borders(line: NDArray[np.int64], joined: tuple[NDArray[np.bool_], Array, Array], width: int) -> Borders:
    """The stretches' ends that lie inside the picture."""
    new, ends, across = joined
    line = np.repeat(line[new], 2)
    x, across = ends.ravel(), across.ravel()
    enters = np.tile([True, False], len(ends))
    inside = (x > 0) & (x < width)
    return Borders(line[inside], x[inside], enters[inside], across[inside])
