"""nofacet: a CAD viewer with no facets. Draws STEP and BREP faces as trimmed rational Bezier patches, exactly."""

from ._native import Cancel
from .cad.load import load
from .camera import Camera
from .errors import Cancelled, InputError
from .frame import Frame
from .model import Model
from .render import methods, render

__all__ = ["Camera", "Cancel", "Cancelled", "Frame", "InputError", "Model", "load", "methods", "render"]
