"""Everything that one run measured."""

from __future__ import annotations

from dataclasses import dataclass, field

from .crowd import CrowdTime
from .first_picture import FirstPicture
from .frames import Floor, FrameTime
from .mesh_result import MeshResult
from .outline import OutlineCheck
from .ray_casting import RayCasting


@dataclass
class SubjectResult:
    """What was measured of one model; None or empty where it was not."""

    name: str
    resolution: tuple[int, int]
    faces: int
    patches: int
    pixel: float  # model units
    floor: Floor | None = None
    frames: list[FrameTime] = field(default_factory=list)
    first_pictures: list[FirstPicture] = field(default_factory=list)
    outline: OutlineCheck | None = None
    meshes: list[MeshResult] = field(default_factory=list)
    ray_casting: RayCasting | None = None

    def frame(self, method: str, threads: int, samples: int) -> FrameTime | None:
        """The frames of that method, threads and samples."""
        wanted = (method, threads, samples)
        return next((one for one in self.frames if (one.method, one.threads, one.samples) == wanted), None)

    def first_picture(self, threads: int) -> FirstPicture | None:
        """The first picture on that many threads."""
        return next((one for one in self.first_pictures if one.threads == threads), None)

    def mesh(self, name: str) -> MeshResult | None:
        """The mesh of that setting."""
        return next((mesh for mesh in self.meshes if mesh.setting.name == name), None)


@dataclass
class Report:
    """One run. left_out: a line for everything that could not be measured, and why."""

    machine: dict[str, str]
    threads: int
    subjects: list[SubjectResult] = field(default_factory=list)
    crowds: list[CrowdTime] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
