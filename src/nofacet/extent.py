"""Where a model is: how far what is drawn of it reaches in a direction, for fitting a camera and measuring a box.

Faces are sampled where they are drawn: whole patches on a grid, trimmed faces along their loops and on the grid points
inside them (src/native/extent.h). A bulge between two samples can stick out by a few per cent of the face's size,
never by more.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from .errors import InputError
from .model import Model

Points = NDArray[np.float64]


def support(model: Model, directions: ArrayLike) -> Points:
    """For each of the world directions (n, 3) the largest scalar product (n,) with a point of the model, model units.

    Raises InputError for a model without surfaces.
    """
    reach = _native.support(model, np.ascontiguousarray(directions, np.float64))
    if not np.isfinite(reach).all():
        raise InputError(f"{model.source}: there is no surface to show; check that the file holds faces")
    return reach


def surface_points(model: Model) -> tuple[Points, NDArray[np.int32]]:
    """The samples: world points (N, 3) on the drawn part of every placed face, model units, and whose they are (N,)."""
    points, first = _native.surface_points(model)
    count = np.diff(first)[model.face_definition]
    face = np.repeat(np.arange(model.face_count, dtype=np.int32), count)
    within = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    placement = model.placements[model.face_placement[face]]
    local = points[first[model.face_definition[face]] + within]
    return np.einsum("nij,nj->ni", placement[:, :3, :3], local) + placement[:, :3, 3], face


def bounding_box(model: Model) -> tuple[Points, Points]:
    """Smallest and largest world coordinates (3,), (3,) of the model, model units.

    Raises InputError for a model without surfaces.
    """
    reach = support(model, [*-np.eye(3), *np.eye(3)])
    return -reach[:3], reach[3:]
