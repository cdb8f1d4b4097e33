"""A mesh of a model: how long making and drawing it takes, and how far its outline is from the exact one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from ..borders import Borders, mesh_borders
from ..mesh import Mesh
from ..mesh_setting import MeshSetting
from ..outline import OutlineError, compare
from ..tessellation import tessellate
from . import embree, gl
from .child import ChildFailure, in_child
from .subject import Subject

DRAWING_LIMIT = 60.0  # seconds

Result = TypeVar("Result")


@dataclass
class MeshResult:
    """One mesh.

    seconds: wall-clock, OpenCascade's mesher on one thread; the limit where it ran into that (timed_out).
    megabytes: of vertices (float32 position and normal) and indices.
    opengl: seconds a frame. embree: seconds a frame by threads. Empty or None where not measured.
    """

    setting: MeshSetting
    seconds: float
    timed_out: bool = False
    triangles: int = 0
    megabytes: float = 0.0
    opengl: float | None = None
    embree: dict[int, float] = field(default_factory=dict)
    outline: OutlineError | None = None


def measure_mesh(
    subject: Subject,
    setting: MeshSetting,
    exact: tuple[Borders, Borders],
    threads: int,
    limit: float,
    left_out: list[str],
) -> MeshResult | None:
    """Mesh, draw and compare; what fails gets a line in left_out. None without a mesh.

    exact: the exact borders on rows and columns. limit: seconds that meshing may take.
    """
    what = f"{subject.name}, mesh {setting.name}"

    def make() -> Mesh:
        return tessellate(subject.shape, setting)

    try:
        mesh = in_child(make, limit)
    except (TimeoutError, ChildFailure) as failure:
        left_out.append(f"{what}: {failure}")
        return MeshResult(setting, limit, timed_out=True) if isinstance(failure, TimeoutError) else None
    if not len(mesh.triangles):
        left_out.append(f"{what}: no triangles")
        return None
    result = MeshResult(setting, mesh.seconds, triangles=len(mesh.triangles))
    result.megabytes = mesh.display_bytes / 1e6
    if gl.missing() is None:
        result.opengl = _drawn(lambda: gl.frame_seconds(mesh, subject), f"{what}, OpenGL", left_out)
    if embree.missing() is None:
        traced = _drawn(lambda: embree.frame_seconds(mesh, subject, threads), f"{what}, Embree", left_out)
        result.embree = traced or {}
    result.outline = compare(exact, mesh_borders(mesh, subject.camera, subject.resolution))
    return result


def _drawn(draw: Callable[[], Result], what: str, left_out: list[str]) -> Result | None:
    try:
        return in_child(draw, DRAWING_LIMIT)
    except (TimeoutError, ChildFailure) as failure:
        left_out.append(f"{what}: {failure}")
        return None
