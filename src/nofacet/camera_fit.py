"""Fitting a camera: from how far the model reaches to the camera that sees all of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .camera import Camera, Vector, as_vector
from .extent import support
from .model import Model


def fit_orthographic(model: Model, forward: NDArray[np.float64], up: Vector, aspect: float, zoom: float) -> Camera:
    """The camera along the unit vector `forward`; aspect: the picture's width over its height; zoom as Camera.fit's."""
    right, true_up, _ = Camera("orthographic", (0.0, 0.0, 0.0), as_vector(forward), up, view_height=1.0).axes()
    basis = np.stack([right, true_up, forward])
    middle, size = _box(support(model, [*basis, *-basis]))
    focal_point = middle @ basis
    radius = float(np.linalg.norm(size)) / 2 or 1.0
    height = max(size[1], size[0] / aspect) or 2 * radius  # a single point or line of sight still makes a picture
    return Camera(
        "orthographic", as_vector(focal_point - 2 * radius * forward), as_vector(focal_point), up, height / zoom
    )


def fit_perspective(
    model: Model, forward: NDArray[np.float64], up: Vector, aspect: float, view_angle: float, zoom: float
) -> Camera:
    """The same in perspective; view_angle: degrees, vertical."""
    half = float(np.tan(np.radians(view_angle) / 2))
    camera = Camera("perspective", (0.0, 0.0, 0.0), as_vector(forward), up, view_angle=view_angle)
    basis = np.stack(camera.axes())
    slopes = [half * aspect * min(zoom, 1.0), half * min(zoom, 1.0)]
    # The four sides of the view's pyramid each touch the model: |x - eye_x| <= slope * (z - eye_z) for all points.
    sides = [sign * basis[axis] - slope * basis[2] for axis, slope in enumerate(slopes) for sign in (1, -1)]
    reach = support(model, [*basis, *-basis, *sides])
    middle, size = _box(reach[:6])
    radius = float(np.linalg.norm(size)) / 2 or 1.0
    eye = np.zeros(3)  # in the basis, from the middle
    depth_limits = []
    for axis, slope in enumerate(slopes):
        high, low = reach[6 + 2 * axis : 8 + 2 * axis] - (middle[axis], -middle[axis]) + slope * middle[2]
        eye[axis] = (high - low) / 2
        depth_limits.append(-(high + low) / (2 * slope))
    eye[2] = min(*depth_limits, -size[2] / 2 - 1e-3 * radius)  # in front of the model even if it is flat
    focal_point = np.array([eye[0], eye[1], 0.0])
    if zoom > 1:
        view_angle = float(np.degrees(2 * np.arctan(half / zoom)))
    position, target = (as_vector((point + middle) @ basis) for point in (eye, focal_point))
    return Camera("perspective", position, target, up, view_angle=view_angle)


def _box(reach: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Middle and size (3,), (3,) of a box, from how far it reaches along three directions and their opposites (6,)."""
    return (reach[:3] - reach[3:]) / 2, reach[:3] + reach[3:]
