"""nofacet: a CAD viewer with no facets. Draws STEP and BREP faces as trimmed rational Bezier patches, exactly."""

from ._native import Cancel
from .cad.load import load
from .camera import Camera
from .errors import Cancelled, InputError
from .frame import Frame
from .mesh import Mesh
from .mesh_setting import MESH_SETTINGS, MeshSetting
from .model import Model
from .render import methods, render
from .tessellation import tessellate

__all__ = [
    "MESH_SETTINGS",
    "Camera",
    "Cancel",
    "Cancelled",
    "Frame",
    "InputError",
    "Mesh",
    "MeshSetting",
    "Model",
    "load",
    "methods",
    "render",
    "tessellate",
]
