"""How far a drawn outline is from the exact one, on every pixel row and column.

A scan line through the pixel centres of a row (or column) meets the model, and a mesh of it, in covered stretches. The
stretches' borders are matched, and the distance between two matched borders is measured across the mesh's edge there.
Borders where the mesh's edge runs more along the scan line than across it are left to the scan lines of the other
direction; borders at the picture's sides count nowhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _native
from ..cad.ray_cast import RayCaster
from ..cad.tessellate import Mesh
from ..camera import Camera
from .subject import Subject

Array = NDArray[np.float64]

ROW_SHIFT = 1.3093e-8  # px: how far below the pixel centres the renderer's scan planes run (raster/scan_planes.h)
MERGED = 1e-6  # px: stretches this close are one; faces of a mesh meet only up to rounding
CHECKED_BORDERS = 100
FIRST_STEP, LAST_STEP = 1e-7, 1.0  # px: how far from our border OpenCascade's is sought


@dataclass(frozen=True)
class Borders:
    """Where the scan lines of one direction enter and leave what is drawn.

    line: (n,) int64, the scan line. x: (n,) pixels along it. enters: (n,) whether the stretch begins here.
    across: (n,) the cosine between the scan line and the normal of the edge that makes the border; 1 if unknown.
    """

    line: NDArray[np.int64]
    x: Array
    enters: NDArray[np.bool_]
    across: Array


@dataclass(frozen=True)
class OutlineError:
    """Pixels. unmatched: borders that only one side has, in slivers narrower than the error, of all borders."""

    largest: float
    rms: float
    matched: int
    unmatched: int


@dataclass(frozen=True)
class OutlineCheck:
    """Our own outline against OpenCascade's ray casting along the scan line, pixels: largest and median distance of
    the borders checked, and how many of them OpenCascade's rays do not show within a pixel."""

    largest: float
    median: float
    checked: int
    not_found: int


def turned(camera: Camera, resolution: tuple[int, int]) -> tuple[Camera, tuple[int, int]]:
    """The orthographic camera turned by 90 degrees about its axis, whose rows are the columns of the first's picture:
    row k is column k."""
    width, height = resolution
    right, _, _ = camera.axes()
    up = (-float(right[0]), -float(right[1]), -float(right[2]))
    extent = camera.extent_at_unit_depth() * width / height
    return Camera("orthographic", camera.position, camera.focal_point, up, extent), (height, width)


def exact_borders(subject: Subject) -> tuple[Borders, Borders]:
    """On rows and on columns, from the exact surfaces."""
    scene = _native.Scene(subject.model)
    return (
        _exact(scene, subject.camera, subject.resolution),
        _exact(scene, *turned(subject.camera, subject.resolution)),
    )


def _exact(scene: _native.Scene, camera: Camera, resolution: tuple[int, int]) -> Borders:
    width, height = resolution
    offsets, ends = scene.outline(
        eye=tuple(camera.position),
        axes=np.array(camera.axes()),
        scale=height / camera.extent_at_unit_depth(),
        perspective=False,
        width=width,
        height=height,
    )
    line = np.repeat(np.arange(height), np.diff(offsets))
    return _borders(line, _merged(line, ends, np.ones_like(ends)), width)


def mesh_borders(mesh: Mesh, subject: Subject) -> tuple[Borders, Borders]:
    """On rows and on columns, from the mesh's triangles."""
    places, triangles = _welded(mesh)
    return (
        _drawn(places, triangles, subject.camera, subject.resolution),
        _drawn(places, triangles, *turned(subject.camera, subject.resolution)),
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
    pixels = places @ matrix[:2, :3].T + matrix[:2, 3]
    edges, weight = _outline_edges(pixels, triangles)
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
    cover = np.cumsum(weight[edge])
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


def compare(exact: tuple[Borders, Borders], drawn: tuple[Borders, Borders]) -> OutlineError | None:
    """Match borders of the same kind on the same scan line, each the other's nearest, and measure their distances.

    None if no borders match.
    """
    distances: list[Array] = []
    unmatched = 0
    for exact_side, drawn_side in zip(exact, drawn, strict=True):
        for kind in (True, False):
            p, q = (_of_kind(borders, kind) for borders in (exact_side, drawn_side))
            nearest_p, nearest_q = _nearest(p, q), _nearest(q, p)
            index = np.arange(len(p.x))
            mutual = nearest_p >= 0
            mutual[mutual] = nearest_q[nearest_p[mutual]] == index[mutual]
            partner = nearest_p[mutual]
            unmatched += len(p.x) + len(q.x) - 2 * len(partner)
            across = q.across[partner]
            steep = across >= np.sqrt(0.5)
            distances.append((np.abs(p.x[mutual] - q.x[partner]) * across)[steep])
    all_distances = np.concatenate(distances)
    if not len(all_distances):
        return None
    rms = float(np.sqrt(np.mean(all_distances**2)))
    return OutlineError(float(all_distances.max()), rms, len(all_distances), unmatched)


def _of_kind(borders: Borders, enters: bool) -> Borders:
    chosen = borders.enters == enters
    return Borders(borders.line[chosen], borders.x[chosen], borders.enters[chosen], borders.across[chosen])


def _nearest(of: Borders, among: Borders) -> NDArray[np.int64]:
    """For each border the index of the nearest one on its scan line; -1 where the line has none."""
    if not len(among.x):
        return np.full(len(of.x), -1)
    spread = 4.0 * (1.0 + max(of.x.max(initial=0.0), among.x.max()))
    keys = among.line * spread + among.x
    above = np.searchsorted(keys, of.line * spread + of.x)
    candidates = np.stack([np.clip(above - 1, 0, len(keys) - 1), np.clip(above, 0, len(keys) - 1)])
    distance = np.where(among.line[candidates] == of.line, np.abs(among.x[candidates] - of.x), np.inf)
    best = np.argmin(distance, axis=0)
    column = np.arange(len(of.x))
    return np.where(np.isfinite(distance[best, column]), candidates[best, column], -1)


def check_outline(subject: Subject, rows: Borders) -> OutlineCheck | None:
    """Seek borders of our rows, chosen at random, with OpenCascade's rays: bisection between a ray that hits and one
    that misses. Along the scan line, so never less than the distance across the outline. None if no border is found.
    """
    caster = RayCaster(subject.shape)
    chosen = np.random.default_rng(1).permutation(len(rows.x))[:CHECKED_BORDERS]
    found = [_distance_to_change(subject, caster, rows, k) for k in chosen.tolist()]
    known = [distance for distance in found if distance is not None]
    if not known:
        return None
    return OutlineCheck(max(known), float(np.median(known)), len(found), len(found) - len(known))


def _distance_to_change(subject: Subject, caster: RayCaster, rows: Borders, k: int) -> float | None:
    """Distance from our border k to where OpenCascade's rays change from hit to miss; None if that is not near."""
    camera, (width, height) = subject.camera, subject.resolution
    right, up, forward = camera.axes()
    eye = np.array(camera.position)
    down = rows.line[k] + 0.5 + ROW_SHIFT

    def covered(x: float) -> bool:
        origin = eye + subject.pixel * ((x - width / 2) * right + (height / 2 - down) * up)
        return caster.covers(origin, forward)

    border, inwards = float(rows.x[k]), 1.0 if rows.enters[k] else -1.0
    step = FIRST_STEP
    while not (covered(border + inwards * step) and not covered(border - inwards * step)):
        step *= 10
        if step > LAST_STEP:
            return None
    inside, outside = border + inwards * step, border - inwards * step
    while abs(inside - outside) > 1e-3 * FIRST_STEP:
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if covered(middle) else (inside, middle)
    return abs((inside + outside) / 2 - border)
