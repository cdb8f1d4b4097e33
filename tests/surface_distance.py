"""How far points are from the exact surfaces, and OpenCascade's triangles from the faces they stand for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

import nofacet
from nofacet.tessellation import read_shape
from scenes import Array

# Deflections that OpenCascade's triangles are off the surfaces, rounded up, where that is more than the one asked for.
F3D_TEAPOT, FREECAD_FLANGE = 1.04, 1.61
STEPS = 8
DIFFERENCE = 1e-6  # of a face's range of parameters, for tangents: they only have to lead to the nearest point
DAMPING = 1e-12  # of the tangents' lengths: where one of them vanishes, at a pole, the other leads on


def surface_distance(model: nofacet.Model, face: Array, uv: Array, points: Array) -> Array:
    """Distance (n,) of points (n, 3) from the surfaces of their faces (n,), model units.

    Gauss-Newton from the parameters uv (n, 2), within the box that the face's patches fill. The smallest distance on
    the way counts, so that what is returned is never less than the true distance, and more only if it led astray.
    """
    low, high = (box[model.face_definition[face]] for box in _parameter_boxes(model))
    shift = DIFFERENCE * (high - low)
    at, best = np.clip(uv, low, high), np.full(len(points), np.inf)
    for _ in range(STEPS):
        from_point = nofacet.evaluate(model, face, at).position - points
        best = np.minimum(best, np.linalg.norm(from_point, axis=1))
        tangents = np.stack([_tangent(model, face, at, shift, axis) for axis in (0, 1)], axis=2)
        normal_matrix = np.einsum("nki,nkj->nij", tangents, tangents)
        normal_matrix += DAMPING * np.trace(normal_matrix, axis1=1, axis2=2)[:, None, None] * np.eye(2)
        slope = np.einsum("nki,nk->ni", tangents, from_point)
        step = np.linalg.solve(normal_matrix, slope[..., None])[..., 0]
        at = np.clip(at - step * (high - low), low, high)
    return best


def _tangent(model: nofacet.Model, face: Array, at: Array, shift: Array, axis: int) -> Array:
    """Derivative (n, 3) by one parameter, in shares of its range."""
    aside = np.zeros_like(at)
    aside[:, axis] = shift[:, axis]
    after, before = (nofacet.evaluate(model, face, at + sign * aside).position for sign in (1, -1))
    return (after - before) / (2 * DIFFERENCE)


def _parameter_boxes(model: nofacet.Model) -> tuple[Array, Array]:
    """Least and largest (u, v) (D, 2) of the patches of every definition."""
    low, high = np.full((model.definition_count, 2), np.inf), np.full((model.definition_count, 2), -np.inf)
    for group in model.groups:
        np.minimum.at(low, group.definition, group.domain[:, [0, 2]])
        np.maximum.at(high, group.definition, group.domain[:, [1, 3]])
    return low, high


@dataclass(frozen=True)
class Triangles:
    """OpenCascade's triangles with the parameters of their corners.

    face: (t,) index of the placed face. corners: (t, 3, 3), world, model units. uv: (t, 3, 2).
    """

    face: Array
    corners: Array
    uv: Array

    def of_faces(self, faces: Iterable[int]) -> Triangles:
        """Those of these faces."""
        here = np.isin(self.face, list(faces))
        return Triangles(self.face[here], self.corners[here], self.uv[here])

    def at(self, weights: Array) -> Triangles:
        """The points at barycentric coordinates (m, 3) of every triangle: corners (t, m, 3) and uv (t, m, 2)."""
        return Triangles(self.face, *(np.einsum("mk,tkc->tmc", weights, values) for values in (self.corners, self.uv)))

    def distances(self, model: nofacet.Model, weights: Array) -> Array:
        """Distance (t, m) of those points from the surfaces."""
        points, count = self.at(weights), len(weights)
        found = surface_distance(
            model, np.repeat(self.face, count), points.uv.reshape(-1, 2), points.corners.reshape(-1, 3)
        )
        return found.reshape(-1, count)


def triangles_of(source: Any, setting: nofacet.MeshSetting) -> Triangles:
    """Of the source's faces, as nofacet.tessellate() makes them."""
    shape = read_shape(source)
    nofacet.tessellate(shape, setting)
    return meshed_triangles(shape)


def meshed_triangles(shape: Any) -> Triangles:
    """Of a shape (TopoDS_Shape) that is meshed."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedMapOfShape

    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    index, corners, uv = [], [], []
    for number in range(faces.Extent()):
        location = TopLoc_Location()
        found = BRep_Tool.Triangulation_s(TopoDS.Face_s(faces.FindKey(number + 1)), location)
        placed = location.Transformation()
        nodes = [found.Node(k).Transformed(placed) for k in range(1, found.NbNodes() + 1)]
        parameters = [found.UVNode(k) for k in range(1, found.NbNodes() + 1)]
        triangles = np.array([found.Triangle(k).Get() for k in range(1, found.NbTriangles() + 1)]) - 1
        index.append(np.full(len(triangles), number))
        corners.append(np.array([(p.X(), p.Y(), p.Z()) for p in nodes])[triangles])
        uv.append(np.array([(p.X(), p.Y()) for p in parameters])[triangles])
    return Triangles(*(np.concatenate(values) for values in (index, corners, uv)))


def lattice(parts: int) -> Array:
    """Barycentric coordinates (m, 3) of a triangle's points where lines cut its sides into equal parts."""
    steps = [(i, j, parts - i - j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    return np.array(steps) / parts


MESHER_CHECKS = np.array([(1, 1, 0), (0, 1, 1), (1, 0, 1), (2 / 3, 2 / 3, 2 / 3)]) / 2  # middles of sides, centroid
