"""Points, normals and curvatures of a model's faces at OpenCascade's parameters, from the exact surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .model import Model
from .scene import scene_of


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points on faces. "..." stands for the shape of what was asked for: (n,), or (height, width) of a frame.

    position: (..., 3) float64, world, model units.
    normal: (..., 3) float64, unit, world, out of the material, as the face is oriented. At a pole or a cone's tip the
        limit from inside the face.
    principal_curvatures: (..., 2) float64, 1 / model units, the larger first. As OpenCascade has it, positive where the
        surface bends towards its normal: a ball has -1/r twice, a drilled hole 1/r and 0. (BRepLProp_SLProps knows no
        orientation of faces and takes Su x Sv for the normal; where that points into the material, its values are the
        negatives of these, the other way round.) Rounding leaves about 1e-15 of the larger one.
    principal_directions: (..., 2, 3) float64, unit, world, tangent to the surface along its principal curvatures,
        right-handed with the normal. Any right-handed pair where both curvatures are the same.

    Curvatures and directions are NaN where rounding leaves them less than four digits: at poles and tips, where a
    derivative vanishes, and on patches a millionth as wide as their coordinates are large. All is NaN for faces less
    than 0, faces without patches and parameters that are not finite.
    """

    position: NDArray[np.float64]
    normal: NDArray[np.float64]
    principal_curvatures: NDArray[np.float64]
    principal_directions: NDArray[np.float64]

    @property
    def mean_curvature(self) -> NDArray[np.float64]:
        """(...) float64, half the sum of the principal curvatures, 1 / model units."""
        return np.asarray(self.principal_curvatures.mean(axis=-1))

    @property
    def gaussian_curvature(self) -> NDArray[np.float64]:
        """(...) float64, the product of the principal curvatures, 1 / model units squared; does not know the normal."""
        return np.asarray(self.principal_curvatures.prod(axis=-1))


def evaluate(model: Model, face: ArrayLike, uv: ArrayLike) -> SurfacePoints:
    """Evaluate faces at their OpenCascade parameters, whether trimmed away there or not.

    face: (...) int, indices of placed faces, less than 0 for nothing (background, or the cap of a section plane); uv:
    (..., 2), parameters on them. A frame's `face` and `uv` are such arrays. Beyond the box of the face's trim loops in
    (u, v) its nearest patch is continued, which is the same surface for all but B-splines.

    Raises ValueError for shapes that do not match, indices that are not whole numbers, and faces the model has not.
    """
    faces, parameters = np.asarray(face), np.asarray(uv, np.float64)
    if parameters.shape != (*faces.shape, 2):
        raise ValueError(f"face is {faces.shape} and uv {parameters.shape}; for face (n,) uv must be (n, 2)")
    if faces.size and faces.dtype.kind not in "iu":
        raise ValueError(f"face is {faces.dtype}; it must be indices, whole numbers")
    if faces.size and faces.max() >= model.face_count:
        raise ValueError(f"face {faces.max()}: the model has faces 0 to {model.face_count - 1}")
    shape = faces.shape
    index = faces.astype(np.int32)
    index[faces < 0] = -1  # 64-bit ones may have become indices of faces
    result = SurfacePoints(*(np.empty((*shape, *inner)) for inner in ((3,), (3,), (2,), (2, 3))))
    scene_of(model).evaluate(
        index.ravel(),
        np.ascontiguousarray(parameters.reshape(-1, 2)),
        result.position,
        result.normal,
        result.principal_curvatures,
        result.principal_directions,
    )
    return result
