"""Lines of models and meshes as segments in space: (n, 2, 3) float64, world coordinates, model units."""

from __future__ import annotations

from collections.abc import Iterator
from math import comb

import numpy as np
from numpy.typing import NDArray

import nofacet

Array = NDArray[np.float64]

FIRST_HALVINGS = 3  # unconditional, so that a symmetric S does not pass for straight
MOST_HALVINGS = 8  # 256 chords a border: within 0.1 px for arcs of up to 20,000 px radius


def mesh_edges(mesh: nofacet.Mesh) -> Array:
    """Every edge of every triangle, once a face."""
    return mesh.points[_edges(mesh)[0]]


def face_borders(mesh: nofacet.Mesh) -> Array:
    """The B-rep's edges as the mesh has them: where a face's triangles end, without seams (where it meets itself)."""
    edges, count, face = _edges(mesh)
    border = edges[count == 1]
    ends = mesh.points[border]
    first = np.argmax(ends[:, 0] != ends[:, 1], axis=1)[:, None]  # the coordinate in which both ends differ
    backwards = np.take_along_axis(ends[:, 0] > ends[:, 1], first, axis=1)
    same_way = np.where(backwards[..., None], ends[:, ::-1], ends)
    place = np.column_stack([face[count == 1], same_way.reshape(-1, 6)])
    _, which, uses = np.unique(place, axis=0, return_inverse=True, return_counts=True)
    return ends[uses[which.reshape(-1)] == 1]


def _edges(mesh: nofacet.Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int32]]:
    """Distinct edges (e, 2) between points, how many triangles have each, and its face. Faces share no points."""
    pairs = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    key, first, count = np.unique(pairs[:, 0] * len(mesh.points) + pairs[:, 1], return_index=True, return_counts=True)
    return np.stack(np.divmod(key, max(1, len(mesh.points))), axis=1), count, mesh.face[first // 3]


def patch_borders(model: nofacet.Model, tolerance: float) -> Array:
    """The four borders of every placed patch, as chords within `tolerance` (model units) of the exact curves."""
    parts = [np.empty((0, 2, 3))]
    for points in _placed_nets(model):
        for border in (points[:, 0], points[:, -1], points[:, :, 0], points[:, :, -1]):
            parts += flatten(border, tolerance)
    return np.concatenate(parts)


def control_nets(model: nofacet.Model) -> Array:
    """The control nets of every placed patch: lines between neighbouring control points."""
    parts = [np.empty((0, 2, 3))]
    for points in _placed_nets(model):
        net = points[..., :3] / points[..., 3:]
        parts.append(np.stack([net[:, :-1], net[:, 1:]], axis=3).reshape(-1, 2, 3))
        parts.append(np.stack([net[:, :, :-1], net[:, :, 1:]], axis=3).reshape(-1, 2, 3))
    return np.concatenate(parts)


def _placed_nets(model: nofacet.Model) -> Iterator[Array]:
    """For every bidegree the control points (n, du + 1, dv + 1, 4), homogeneous, of all placed patches in the world."""
    order = np.argsort(model.face_definition, kind="stable")
    uses = np.bincount(model.face_definition, minlength=model.definition_count)
    first = np.cumsum(uses) - uses
    for group in model.groups:
        count = uses[group.definition]
        patch = np.repeat(np.arange(len(count)), count)
        within = np.arange(len(patch)) - np.repeat(np.cumsum(count) - count, count)
        face = order[first[group.definition[patch]] + within]
        placement = model.placements[model.face_placement[face]]
        yield np.einsum("nab,nijb->nija", placement, group.control_points[patch])


def flatten(curves: Array, tolerance: float) -> list[Array]:
    """Chords of rational Bezier curves (n, degree + 1, 4), homogeneous: arrays (k, 2, 3) that are all of them.

    A curve is halved until the middle of every chord is within tolerance of the curve at its parameter.
    """
    chords = []
    for halvings in range(FIRST_HALVINGS, MOST_HALVINGS + 1):
        points = _evaluate(curves, 2**halvings)
        middles = (points[:, :-2:2] + points[:, 2::2]) / 2
        bend = np.linalg.norm(points[:, 1::2] - middles, axis=2).max(axis=1)
        done = (bend <= tolerance) | (halvings == MOST_HALVINGS)
        chords.append(np.stack([points[done, :-1], points[done, 1:]], axis=2).reshape(-1, 2, 3))
        curves = curves[~done]
        if not len(curves):
            break
    return chords


def _evaluate(curves: Array, chords: int) -> Array:
    """Points (n, chords + 1, 3) at equal steps of the parameter."""
    degree = curves.shape[1] - 1
    t = np.linspace(0, 1, chords + 1)[:, None]
    k = np.arange(degree + 1)
    basis = np.array([comb(degree, i) for i in k]) * t**k * (1 - t) ** (degree - k)
    points = np.einsum("tk,nkc->ntc", basis, curves)
    return points[..., :3] / points[..., 3:]
