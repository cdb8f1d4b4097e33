"""A mesh as the graphics card takes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import nofacet

Array = NDArray[np.float64]

VERTEX = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("face", "i4")])


@dataclass(frozen=True, eq=False)
class MeshArrays:
    """Made where it delays no picture: in the thread that receives the mesh.

    bounds: smallest and largest coordinates (3,), (3,) of the points. center: of the box between them.
    vertices: (n,) VERTEX, a point each, its position relative to `center`.
    """

    bounds: tuple[Array, Array]
    center: Array
    vertices: NDArray[Any]

    @classmethod
    def of(cls, mesh: nofacet.Mesh) -> MeshArrays:
        points = mesh.points
        low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
        center = (low + high) / 2
        vertices = np.zeros(len(points), VERTEX)
        vertices["position"], vertices["normal"] = points - center, mesh.normals
        vertices["face"][mesh.triangles] = mesh.face[:, None]
        return cls((low, high), center, vertices)
