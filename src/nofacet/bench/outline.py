"""How far a drawn outline is from the exact one, on every pixel row and column.

A scan line through the pixel centres of a row (or column) meets the model, and a mesh of it, in covered stretches. From
left to right the two differ first at one border and then until the next: if that is the other side's, the two are one
border in two places, and the distance is measured across the mesh's edge there; if it is the same side's, they bound a
sliver that only one side has. Where the outline runs more along the scan line than across it, it is left to the scan
lines of the other direction; borders at the picture's sides count nowhere.
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
STEEP = 0.7  # the least `across` that is measured: a little more than 45 degrees, so that none falls between
MERGED = 1e-6  # px: stretches this close are one; faces of a mesh meet only up to rounding
CHECKED_BORDERS = 100
GRAZING = 1e-3  # px: how far from its silhouette a surface may look hit or missed
FIRST_STEP, LAST_STEP = 1e-7, 1.0  # px: how far from our border OpenCascade's is sought


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


@dataclass(frozen=True)
class OutlineError:
    """Pixels. matched: borders measured. unmatched: borders that only one side has."""

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
    """Measure the distances of matching borders. None if no borders match."""
    distances: list[Array] = []
    unmatched = 0
    for exact_side, drawn_side in zip(exact, drawn, strict=True):
        first, second, alone = _pairs(exact_side, drawn_side)
        unmatched += alone
        across = drawn_side.across[second]
        steep = np.minimum(exact_side.across[first], across) >= STEEP
        distances.append((np.abs(exact_side.x[first] - drawn_side.x[second]) * across)[steep])
    every = np.concatenate(distances)
    if not len(every):
        return None
    return OutlineError(float(every.max()), float(np.sqrt(np.mean(every**2))), len(every), unmatched)


def _pairs(p: Borders, q: Borders) -> tuple[NDArray[np.int64], NDArray[np.int64], int]:
    """Indices of the borders of p and of q that match, and how many of both match nothing.

    Both sides cover nothing before a scan line's first border, so the first and the second bound the first stretch on
    which they differ, the third and the fourth the next, and so on.
    """
    line = np.concatenate([p.line, q.line])
    side = np.repeat([0, 1], [len(p.line), len(q.line)])
    index = np.concatenate([np.arange(len(p.line)), np.arange(len(q.line))])
    order = np.lexsort((np.concatenate([p.x, q.x]), line))
    line, side, index = line[order], side[order], index[order]
    starts = np.searchsorted(line, line)
    place = np.arange(len(line)) - starts
    opens = np.flatnonzero(place % 2 == 0)
    opens = opens[opens + 1 < len(line)]
    opens = opens[(line[opens] == line[opens + 1]) & (side[opens] != side[opens + 1])]
    from_p = np.where(side[opens] == 0, opens, opens + 1)
    from_q = np.where(side[opens] == 0, opens + 1, opens)
    return index[from_p], index[from_q], len(line) - 2 * len(opens)


def check_outline(subject: Subject, rows: Borders) -> OutlineCheck | None:
    """Seek borders of our rows, chosen at random, with OpenCascade's rays: bisection between a ray that hits and one
    that misses. Where a surface turns away there, its silhouette is solved for: grazing rays are found to 1e-5 pixels
    only. Along the scan line, so never less than the distance across the outline. None if no border is found.
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

    def origin(x: float) -> Array:
        return eye + subject.pixel * ((x - width / 2) * right + (height / 2 - down) * up)

    border, inwards = float(rows.x[k]), 1.0 if rows.enters[k] else -1.0
    step = FIRST_STEP
    while not (
        caster.covers(origin(border + inwards * step), forward)
        and not caster.covers(origin(border - inwards * step), forward)
    ):
        step *= 10
        if step > LAST_STEP:
            return None
    inside, outside = border + inwards * step, border - inwards * step
    while abs(inside - outside) > 1e-3 * FIRST_STEP:
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if caster.covers(origin(middle), forward) else (inside, middle)
    change = (inside + outside) / 2
    silhouette = caster.silhouette(origin(inside), forward, up)
    if silhouette is not None:
        solved = width / 2 + (silhouette - eye) @ right / subject.pixel
        if abs(solved - change) < GRAZING:
            change = solved
    return float(abs(change - border))
