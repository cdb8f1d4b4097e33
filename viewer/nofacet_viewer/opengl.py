"""OpenGL's own functions, for the little that moderngl has none for."""

import OpenGL

OpenGL.ERROR_CHECKING = OpenGL.ERROR_LOGGING = False  # a question to the driver after each call, imgui's among them
from OpenGL import GL  # noqa: E402

__all__ = ["GL"]
