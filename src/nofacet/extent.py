"""Where a model is: points on its visible surface, close enough together to fit a camera or measure a box.

Faces are sampled where they are drawn: whole patches on a grid, trimmed faces along their loops and on the grid points
inside them. A bulge between two samples can stick out by a few per cent of the face's size, never by more.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import comb

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .model import Model, PatchGroup

Points = NDArray[np.float64]

GRID = 5  # samples along a curved side of a patch: a quarter circle bulges 2 % of its radius between two of them
COARSE_GRID = 2  # the same for groups of many patches, which are small parts of their faces: their corners
MANY_PATCHES = 10_000
LOOP_SAMPLES = 4  # samples on a curved trim segment, its start included
MANY_PAIRS = 4_000_000  # (loop corner, patch) pairs of one face, or (point, loop edge) pairs tested in one array


def surface_points(model: Model) -> Points:
    """World points (N, 3) on the drawn part of every placed face, model units; N = 0 for a model without surfaces."""
    points, definition = _definition_points(model)
    order = np.argsort(definition, kind="stable")
    points, first = points[order], np.searchsorted(definition[order], np.arange(model.definition_count + 1))
    count = np.diff(first)[model.face_definition]
    face = np.repeat(np.arange(model.face_count), count)
    within = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    placement = model.placements[model.face_placement[face]]
    local = points[first[model.face_definition[face]] + within]
    return np.einsum("nij,nj->ni", placement[:, :3, :3], local) + placement[:, :3, 3]


def bounding_box(model: Model) -> tuple[Points, Points]:
    """Smallest and largest world coordinates (3,), (3,) of the model, model units, from `surface_points`.

    Raises InputError for a model without surfaces.
    """
    points = surface_points(model)
    if not len(points):
        raise InputError(f"{model.source}: there is no surface to show; check that the file holds faces")
    return points.min(axis=0), points.max(axis=0)


def _definition_points(model: Model) -> tuple[Points, NDArray[np.int32]]:
    """Points (N, 3) in the coordinates of their definitions, and the definition (N,) of each."""
    loops = _Loops(model)
    pieces: list[Points] = [np.empty((0, 3))]
    owners: list[NDArray[np.int32]] = [np.empty(0, np.int32)]
    for group in model.groups:
        grid, uv = _grid(group)
        keep = np.repeat(model.trimmed[group.definition] == 0, grid.shape[1]).reshape(grid.shape[:2])
        for definition, patches in _patches_by_definition(group):
            if not model.trimmed[definition]:
                continue
            edges = loops.edges(definition)
            if len(patches) * len(edges) > MANY_PAIRS:  # then each patch is a small part of the face
                keep[patches] = True
                continue
            if group.degree != (1, 1):  # a flat face reaches no further than its border
                keep[patches] = _inside(uv[patches].reshape(-1, 2), edges).reshape(len(patches), -1)
            border = _evaluate(group, patches, edges[:, 0])
            pieces.append(border)
            owners.append(np.full(len(border), definition, np.int32))
        pieces.append(grid[keep])
        owners.append(np.broadcast_to(group.definition[:, None], keep.shape)[keep])
    return np.concatenate(pieces), np.concatenate(owners)


def _patches_by_definition(group: PatchGroup) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Each definition of the group with the indices of its patches."""
    order = np.argsort(group.definition, kind="stable")
    definitions, first = np.unique(group.definition[order], return_index=True)
    for definition, patches in zip(definitions, np.split(order, first[1:]), strict=False):
        yield int(definition), patches


def _bernstein(degree: int, t: Points) -> Points:
    """Bernstein polynomials B_i(t), (len(t), degree + 1)."""
    i = np.arange(degree + 1)
    binomial = np.array([comb(degree, int(k)) for k in i], dtype=float)
    return binomial * t[:, None] ** i * (1 - t[:, None]) ** (degree - i)


def _grid(group: PatchGroup) -> tuple[Points, Points]:
    """Surface points (n, k, 3) on a grid over each patch, and their face parameters (n, k, 2)."""
    curved = COARSE_GRID if len(group.definition) > MANY_PATCHES else GRID
    s, t = (np.linspace(0, 1, 2 if degree == 1 else curved) for degree in group.degree)
    weights = [_bernstein(degree, x) for degree, x in zip(group.degree, (s, t), strict=True)]
    points = np.einsum("ai,nijc,bj->nabc", weights[0], group.control_points, weights[1], optimize=True)
    u = _face_parameter(group, 0, s)[:, :, None]
    v = _face_parameter(group, 1, t)[:, None, :]
    uv = np.stack(np.broadcast_arrays(u, v), axis=-1)
    n = len(group.definition)
    return (points[..., :3] / points[..., 3:]).reshape(n, -1, 3), uv.reshape(n, -1, 2)


def _face_parameter(group: PatchGroup, axis: int, s: Points) -> Points:
    """OpenCascade's parameter (n, len(s)) at the patch parameters s along one axis of every patch."""
    low, high = group.domain[:, 2 * axis, None], group.domain[:, 2 * axis + 1, None]
    half = np.where(group.angular[:, axis, None] == 1, high - low, 0.0) / 4
    angle = (low + high) / 2 + 2 * np.arctan(np.tan(half) * (2 * s - 1))
    return np.where(group.angular[:, axis, None] == 1, angle, low + s * (high - low))


def _evaluate(group: PatchGroup, patches: NDArray[np.int64], uv: Points) -> Points:
    """Surface points (at most q, 3) at face parameters uv (q, 2) that lie on the given patches of one face."""
    domain, angular = group.domain[patches], group.angular[patches]
    low, high = domain[:, 0::2], domain[:, 1::2]
    outside = np.maximum(low - uv[:, None], uv[:, None] - high).max(axis=2)
    patch = outside.argmin(axis=1)
    span = high - low
    on_patch = outside[np.arange(len(uv)), patch] <= 1e-6 * span[patch].max(axis=1)
    uv, patch = uv[on_patch], patch[on_patch]
    low, high, span = low[patch], high[patch], span[patch]
    angle = angular[patch] == 1
    quarter = np.where(angle, span, 1.0) / 4
    linear = (uv - low) / np.where(span == 0, 1.0, span)
    s = np.where(angle, (1 + np.tan((uv - (low + high) / 2) / 2) / np.tan(quarter)) / 2, linear)
    weights = [_bernstein(degree, s[:, axis]) for axis, degree in enumerate(group.degree)]
    points = np.einsum("qi,qijc,qj->qc", weights[0], group.control_points[patches[patch]], weights[1], optimize=True)
    return points[:, :3] / points[:, 3:]


def _inside(uv: Points, edges: Points) -> NDArray[np.bool_]:
    """Even-odd test of points (q, 2) against closed polygons given as edges (m, 2, 2)."""
    inside = np.zeros(len(uv), bool)
    step = max(1, MANY_PAIRS // max(1, len(edges)))
    (u0, v0), (u1, v1) = edges[:, 0].T, edges[:, 1].T
    slope = (u1 - u0) / np.where(v1 == v0, 1.0, v1 - v0)
    for start in range(0, len(uv), step):
        u, v = uv[start : start + step, 0, None], uv[start : start + step, 1, None]
        crosses = ((v0 > v) != (v1 > v)) & (u < u0 + (v - v0) * slope)
        inside[start : start + step] = crosses.sum(axis=1) % 2 == 1
    return inside


class _Loops:
    """The model's trim loops as polygons with LOOP_SAMPLES corners on every curved segment."""

    def __init__(self, model: Model) -> None:
        offsets = model.segment_offsets
        degree = np.diff(offsets) - 1
        count = np.where(degree == 1, 1, LOOP_SAMPLES)
        first = np.concatenate([[0], np.cumsum(count)])
        self._corners = np.empty((first[-1], 2))
        for d in np.unique(degree):
            chosen = np.flatnonzero(degree == d)
            samples = 1 if d == 1 else LOOP_SAMPLES
            weights = _bernstein(int(d), np.arange(samples) / samples)
            control = model.segment_points[offsets[chosen, None] + np.arange(d + 1)]
            points = np.einsum("ai,nic->nac", weights, control)
            self._corners[first[chosen, None] + np.arange(samples)] = points[..., :2] / points[..., 2:]
        self._loop_first = first[model.loop_offsets]  # first corner of each loop
        self._next = np.arange(1, first[-1] + 1)
        filled = self._loop_first[1:] > self._loop_first[:-1]
        self._next[self._loop_first[1:][filled] - 1] = self._loop_first[:-1][filled]
        self._definition_first = self._loop_first[model.definition_loops]

    def edges(self, definition: int) -> Points:
        """Polygon edges (m, 2, 2): start and end (u, v), all loops of one definition together."""
        corners = slice(self._definition_first[definition], self._definition_first[definition + 1])
        return np.stack([self._corners[corners], self._corners[self._next[corners]]], axis=1)
