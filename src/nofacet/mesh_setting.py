"""How finely OpenCascade is asked to mesh: what CAD viewers use by default, and deflections in pixels.

Viewers' defaults, as their sources have them in 2026:
F3D: vtkF3DOCCTReader, LinearDeflection 0.1 (model units, not relative), AngularDeflection 0.5.
Mayo: OpenCascade's Prs3d::GetDeflection, 4 times a deviation coefficient times the box's largest side; 1e-3 and 20
    degrees for its quality "normal".
ocp-vscode: ocp_tessellate.compute_quality, deviation 0.1: 0.1 times the sum of the box's sides over 300; 0.2 rad.
CQ-editor: Prs3d::GetDeflection with AIS's deviation coefficient 1e-5; 0.1 rad.
cadquery: vis.show, the same formula (through IVtkOCC_ShapeMesher) with a coefficient of 1e-3; 0.1 rad.
FreeCAD: deviation 0.5 % of the mean side of the box, 28.5 degrees.
Some of them mesh on several threads; here everything is meshed on one, as the mesher does by default.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite, radians
from typing import Literal

from .camera import Camera, check_resolution

DEFAULT_ANGLE = 0.5  # radians, BRepMesh_IncrementalMesh's own default


@dataclass(frozen=True)
class MeshSetting:
    """What BRepMesh_IncrementalMesh is asked for.

    deflection: largest distance between an edge or a surface and its triangles that the mesher aims at; model units,
        or a share of that side of the shape's bounding box which `relative_to` names.
    angle: largest angle, radians, between neighbouring segments of an edge, or normals on a face.
    delabella: use that algorithm instead of the default one (Watson).

    Raises ValueError for a deflection or angle that is not a finite positive number, or an unknown side.
    """

    name: str
    deflection: float
    angle: float = DEFAULT_ANGLE
    delabella: bool = False
    relative_to: Literal["largest side", "mean side"] | None = None

    def __post_init__(self) -> None:
        for name, value in (("deflection", self.deflection), ("angle", self.angle)):
            if not (isfinite(value) and value > 0):
                raise ValueError(f"mesh setting {self.name!r}: {name} is {value:g}; it must be finite and positive")
        if self.relative_to not in (None, "largest side", "mean side"):
            raise ValueError(
                f"mesh setting {self.name!r}: relative_to is {self.relative_to!r}; "
                "write 'largest side', 'mean side' or None"
            )

    @classmethod
    def in_pixels(cls, size: float, camera: Camera, resolution: tuple[int, int]) -> MeshSetting:
        """A deflection of `size` pixels of the camera's picture; in perspective, at its focal point.

        Raises ValueError for a size that is not positive or a resolution that is not two whole numbers of at least 1.
        """
        _, height = check_resolution(resolution)
        if not size > 0:
            raise ValueError(f"deflection {size:g} px: it must be positive")
        return cls(f"{size:g} px", size * camera.extent_at(camera.distance) / height)

    def for_box(self, sides: tuple[float, float, float]) -> MeshSetting:
        """The same with its deflection in model units, for a bounding box of these sides."""
        if self.relative_to is None:
            return self
        side = max(sides) if self.relative_to == "largest side" else sum(sides) / 3
        return replace(self, deflection=self.deflection * side, relative_to=None)


MESH_SETTINGS: dict[str, MeshSetting] = {
    setting.name: setting
    for setting in (
        MeshSetting("F3D", 0.1, 0.5),
        MeshSetting("Mayo", 4e-3, radians(20), relative_to="largest side"),
        MeshSetting("ocp-vscode", 1e-3, 0.2, relative_to="mean side"),
        MeshSetting("CQ-editor", 4e-5, 0.1, relative_to="largest side"),
        MeshSetting("cadquery", 4e-3, 0.1, relative_to="largest side"),
        MeshSetting("FreeCAD", 5e-3, radians(28.5), relative_to="mean side"),
    )
}
