"""The two shapes that are measured without a file."""

from __future__ import annotations

from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.TopoDS import TopoDS_Shape


def sphere(radius: float = 50.0) -> TopoDS_Shape:
    """A solid sphere around the origin, mm."""
    return BRepPrimAPI_MakeSphere(radius).Shape()


def torus(radius: float = 40.0, tube: float = 15.0) -> TopoDS_Shape:
    """A solid torus around the z axis, mm."""
    return BRepPrimAPI_MakeTorus(radius, tube).Shape()
