"""The tessellated side: how OpenCascade meshes the file, the mesh, and how far its outline is from the exact one."""

from __future__ import annotations

from dataclasses import dataclass

import nofacet

from .difference import OutlineDifference, outline_difference
from .loading import one_line
from .meshing import Mesher, MeshResult
from .tasks import Tasks

IN_PIXELS = "pixels"  # the choice that is no viewer's preset
CHOICES = (IN_PIXELS, *nofacet.MESH_SETTINGS)
PIXEL_RANGE = (0.03, 10.0)
POLL_SECONDS = 0.05  # between looks whether a mesh is there


@dataclass(frozen=True, eq=False)
class Subject:
    """What an outline was compared for."""

    model: nofacet.Model
    mesh: nofacet.Mesh
    camera: nofacet.Camera
    resolution: tuple[int, int]

    def is_same(self, other: Subject) -> bool:
        """Whether both would give the same comparison; models and meshes are the same only if they are one object."""
        same = self.model is other.model and self.mesh is other.mesh
        return same and (self.camera, self.resolution) == (other.camera, other.resolution)


class Tessellated:
    """Meshes one file at a time in a process of its own. Its methods never wait.

    choice: of CHOICES. pixels: the deflection where the choice is IN_PIXELS, of the picture in which it was chosen.
    """

    def __init__(self, tasks: Tasks, choice: str = "F3D", pixels: float = 0.3) -> None:
        self.choice = choice
        self.pixels = pixels
        self.result: MeshResult | None = None
        self.problem: str | None = None  # one line: why there is no mesh
        self.difference: OutlineDifference | None = None
        self._mesher = Mesher()
        self._tasks = tasks
        self._compared: Subject | None = None

    @property
    def busy(self) -> bool:
        """Whether a mesh is on its way."""
        return self._mesher.busy

    def start(self, path: str, camera: nofacet.Camera, resolution: tuple[int, int]) -> None:
        """Mesh a file with the present choice."""
        self.problem = None
        if self.choice == IN_PIXELS:
            setting = nofacet.MeshSetting.in_pixels(self.pixels, camera, resolution)
        else:
            setting = nofacet.MESH_SETTINGS[self.choice]
        try:
            self._mesher.start(path, setting)
        except (ValueError, OSError) as error:
            self.problem = one_line(error)

    def forget(self) -> None:
        """Stop meshing and drop the mesh: another file is shown."""
        self._mesher.cancel()
        self.result = self.problem = self.difference = self._compared = None

    def poll(self) -> bool:
        """Take over a finished mesh; whether anything has changed."""
        answer = self._mesher.poll()
        if answer is None:
            return False
        if isinstance(answer, str):
            self.problem = answer
        else:
            self.result, self.difference = answer, None
        return True

    def compare(self, model: nofacet.Model, camera: nofacet.Camera, resolution: tuple[int, int]) -> None:
        """Measure the outline for a camera at rest, once; what comes of it is in `difference` later."""
        if self.result is None or self._tasks.running:
            return
        subject = Subject(model, self.result.mesh, camera, resolution)
        if self._compared is not None and subject.is_same(self._compared):
            return
        self._compared = subject

        def take(found: OutlineDifference | Exception) -> None:
            if self._compared is subject:
                self.difference = found if isinstance(found, OutlineDifference) else None

        self._tasks.run(lambda: outline_difference(model, subject.mesh, camera, resolution), take)
