"""Section planes for triangles: OpenGL clips them, and shows no caps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .programs import set_uniforms

MOST_PLANES = 8  # OpenGL has that many everywhere; mesh.vert knows the number
_CLIP_DISTANCE0 = 0x3000  # GL_CLIP_DISTANCE0


@contextmanager
def clipped(
    context: moderngl.Context,
    target: moderngl.Program,
    sections: Sequence[nofacet.Section],
    center: NDArray[np.float64],
) -> Iterator[None]:
    """Cut what is drawn with a program of mesh.vert by the first MOST_PLANES planes. center: the origin of the
    program's coordinates, world."""
    planes = np.zeros((MOST_PLANES, 4))
    for plane, section in zip(planes, sections, strict=False):
        plane[:3] = section.normal
        plane[3] = plane[:3] @ (center - section.origin)
    set_uniforms(target, sections=[tuple(plane) for plane in planes.tolist()])
    distances = [_CLIP_DISTANCE0 + k for k in range(min(len(sections), MOST_PLANES))]
    for distance in distances:
        context.enable_direct(distance)
    try:
        yield
    finally:
        for distance in distances:
            context.disable_direct(distance)
