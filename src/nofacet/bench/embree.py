"""Primary rays through a mesh with Embree, as the Python package embreex offers it: one ray at a time, no packets."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec

import numpy as np

from ..mesh import Mesh
from .subject import Subject
from .timing import MESH_SECONDS, repeat


def missing() -> str | None:
    """Why nothing can be traced with Embree here; None if it can."""
    return None if find_spec("embreex") else "Embree frames: the package embreex is not installed"


def frame_seconds(mesh: Mesh, subject: Subject, threads: int) -> dict[int, float]:
    """Fastest wall-clock seconds of the primary rays of a whole frame, on one thread and on `threads`.

    The acceleration structure is built before; of each ray the triangle's index comes back and nothing is shaded.
    """
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, mesh.points.astype(np.float32), mesh.triangles)
    origin, direction = subject.camera.rays(subject.resolution)
    origins = origin.reshape(-1, 3).astype(np.float32)
    directions = np.ascontiguousarray(direction.reshape(-1, 3), np.float32)
    scene.run(origins[:1], directions[:1])  # builds the structure

    def trace(count: int) -> float:
        parts = list(zip(np.array_split(origins, count), np.array_split(directions, count), strict=True))
        with ThreadPoolExecutor(count) as pool:  # embreex lets go of the interpreter's lock while it traces
            return repeat(lambda: list(pool.map(lambda part: scene.run(*part), parts)), MESH_SECONDS)[0].fastest

    return {count: trace(count) for count in dict.fromkeys((1, threads))}
