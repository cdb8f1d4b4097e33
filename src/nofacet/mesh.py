"""Triangles of a shape, as CAD viewers draw them: what the exact picture is compared with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Mesh:
    """Triangles of every placed face, in world coordinates.

    points: (n, 3) float64, model units; every face has its own.
    normals: (n, 3) float32, unit: the mean of the normals of the face's triangles at the point, weighted by area.
    triangles: (t, 3) int32, indices into points, anticlockwise seen from outside.
    face: (t,) int32, index in the order of TopExp::MapShapes(shape, TopAbs_FACE), as in the Model of the same source.
    seconds: wall-clock time that OpenCascade's mesher took.
    deflection: what the mesher was asked for, model units.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float32]
    triangles: NDArray[np.int32]
    face: NDArray[np.int32]
    seconds: float
    deflection: float = 0.0

    @property
    def display_bytes(self) -> int:
        """Memory that drawing it takes: position and normal in float32, and int32 indices."""
        return 24 * len(self.points) + 12 * len(self.triangles)
