"""From nofacet's camera to OpenGL's clip space, so that both sides of the window agree to the pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import nofacet

Array = NDArray[np.float64]

NEAREST = 1e-4  # of the farthest depth: what is nearer to a perspective eye is clipped
DEPTH_MARGIN = 0.01  # of the depth range, on both ends


@dataclass(frozen=True)
class Projection:
    """One camera's matrices for points given relative to a center of float64, as float32 alone would lose the digits of
    a model far from the origin.

    clip_from_local: (4, 4) float64. Its x and y are pixel_from_world's, its w too.
    eye_from_local: (4, 4) float64, rigid: right, up and forward from the eye; its third coordinate is the depth.
    depth_range: smallest and largest depth that is drawn, model units.
    perspective: whether the eye is a point.
    """

    clip_from_local: Array
    eye_from_local: Array
    depth_range: tuple[float, float]
    perspective: bool


def project(
    camera: nofacet.Camera, resolution: tuple[int, int], center: Array, bounds: tuple[Array, Array]
) -> Projection:
    """The projection of `camera` for a picture of `resolution`; bounds: smallest and largest world coordinates (3,) of
    what is drawn."""
    width, height = resolution
    world_from_local = np.eye(4)
    world_from_local[:3, 3] = center
    eye_from_world = np.eye(4)
    eye_from_world[:3, :3] = camera.axes()
    eye_from_world[:3, 3] = -eye_from_world[:3, :3] @ np.array(camera.position)
    perspective = camera.projection == "perspective"
    near, far = _depth_range(eye_from_world, bounds, perspective)
    low, high = (-1 / near, -1 / far) if perspective else (near, far)
    clip_from_pixel = np.diag([2 / width, -2 / height, 2 / (high - low), 1.0])
    clip_from_pixel[:3, 3] = -1, 1, -(high + low) / (high - low)
    return Projection(
        clip_from_pixel @ camera.pixel_from_world(resolution) @ world_from_local,
        eye_from_world @ world_from_local,
        (near, far),
        perspective,
    )


def _depth_range(eye_from_world: Array, bounds: tuple[Array, Array], perspective: bool) -> tuple[float, float]:
    corners = np.array(np.meshgrid(*np.stack(bounds, axis=1), indexing="ij")).reshape(3, -1)
    depth = eye_from_world[2, :3] @ corners + eye_from_world[2, 3]
    near, far = float(depth.min()), float(depth.max())
    margin = DEPTH_MARGIN * (far - near) or max(abs(far), 1.0) * DEPTH_MARGIN
    near, far = near - margin, far + margin
    if perspective:
        far = max(far, margin)
        near = max(near, NEAREST * far)
    return near, far


def pixel_size(camera: nofacet.Camera, resolution: tuple[int, int], depth: float) -> float:
    """Size of a pixel in model units at a depth."""
    return camera.extent_at_unit_depth() * (depth if camera.projection == "perspective" else 1.0) / resolution[1]
