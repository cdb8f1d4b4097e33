"""nofacet: a CAD viewer with no facets. Draws STEP and BREP faces as trimmed rational Bezier patches, exactly."""

from ._native import Cancel
from .cad.load import load
from .camera import Camera
from .combine import combine
from .errors import Cancelled, InputError
from .evaluate import SurfacePoints, evaluate
from .frame import Frame
from .measure import Measurement, measure
from .mesh import Mesh
from .mesh_setting import MESH_SETTINGS, MeshSetting
from .model import Model
from .pick import Pick, pick
from .render import methods, render
from .section import Section
from .show import show
from .tessellation import tessellate

__all__ = [
    "MESH_SETTINGS",
    "Camera",
    "Cancel",
    "Cancelled",
    "Frame",
    "InputError",
    "Measurement",
    "Mesh",
    "MeshSetting",
    "Model",
    "Pick",
    "Section",
    "SurfacePoints",
    "combine",
    "evaluate",
    "load",
    "measure",
    "methods",
    "pick",
    "render",
    "show",
    "tessellate",
]
