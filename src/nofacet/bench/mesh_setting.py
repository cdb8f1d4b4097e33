"""The meshes that are measured: deflections in pixels, and what CAD viewers use by default.

Viewers' defaults, as their sources have them in 2026:
F3D: vtkF3DOCCTReader, LinearDeflection 0.1 (model units, not relative), AngularDeflection 0.5.
ocp-vscode: ocp_tessellate.compute_quality, deviation 0.1: 0.1 times the sum of the box's sides over 300; 0.2 rad.
CQ-editor: AIS deviation coefficient 1e-5, 0.1 rad; OpenCascade's Prs3d::GetDeflection makes that 4 times the
    coefficient times the box's largest side.
Mayo: the same formula with a coefficient of 1e-3, 20 degrees, for its quality "normal".
FreeCAD: deviation 0.5 % of the mean side of the box, 28.5 degrees.
Some of them mesh on several threads; here everything is meshed on one, as the mesher does by default.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

from ..cad.tessellate import DEFAULT_ANGLE

PIXELS = (1.0, 0.3, 0.1, 0.03)
DELABELLA_PIXELS = 0.1


@dataclass(frozen=True)
class MeshSetting:
    """deflection: model units; angle: radians."""

    name: str
    deflection: float
    angle: float
    delabella: bool = False


def mesh_settings(pixel: float, sides: tuple[float, float, float]) -> list[MeshSetting]:
    """All settings for a model of the bounding box's sides (model units) seen with pixels of that size."""
    settings = [MeshSetting(f"{size:g} px", size * pixel, DEFAULT_ANGLE) for size in PIXELS]
    name = f"{DELABELLA_PIXELS:g} px, Delabella"
    settings.append(MeshSetting(name, DELABELLA_PIXELS * pixel, DEFAULT_ANGLE, delabella=True))
    mean, largest = sum(sides) / 3, max(sides)
    return [
        *settings,
        MeshSetting("F3D", 0.1, 0.5),
        MeshSetting("ocp-vscode", 0.1 * mean / 100, 0.2),
        MeshSetting("CQ-editor", 4e-5 * largest, 0.1),
        MeshSetting("Mayo", 4e-3 * largest, radians(20)),
        MeshSetting("FreeCAD", 0.5 * mean / 100, radians(28.5)),
    ]
