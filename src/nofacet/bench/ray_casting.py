"""OpenCascade's exact ray casting, measured on some pixels and extrapolated to the frame."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from ..cad.ray_cast import RayCaster
from .subject import Subject

RAYS, CHUNK = 2000, 20
ENOUGH_SECONDS = 5.0


@dataclass(frozen=True)
class RayCasting:
    """seconds: of `rays` rays through random pixels; frame_seconds: extrapolated to every pixel."""

    rays: int
    seconds: float
    frame_seconds: float


def measure_ray_casting(subject: Subject) -> RayCasting:
    """As many rays as a few seconds allow, on one thread."""
    width, height = subject.resolution
    caster = RayCaster(subject.shape)
    right, up, forward = subject.camera.axes()
    eye = np.array(subject.camera.position)
    places = np.random.default_rng(1).random((RAYS, 2)) * (width, height) - (width / 2, height / 2)
    origins = eye + subject.pixel * (places[:, :1] * right - places[:, 1:] * up)
    seconds, rays = 0.0, 0
    while rays < RAYS and seconds < ENOUGH_SECONDS:
        start = time.perf_counter()
        for origin in origins[rays : rays + CHUNK]:
            caster.depth(origin, forward)
        seconds += time.perf_counter() - start
        rays += CHUNK
    return RayCasting(rays, seconds, seconds / rays * width * height)
