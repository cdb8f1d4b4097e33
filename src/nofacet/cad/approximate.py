"""Surfaces that are not rational (offsets, sweeps of hyperbolas): B-splines close to them, the distance measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import stream as brep
from .records import Surfaces
from .surfaces import Box

if TYPE_CHECKING:
    from OCP.Geom import Geom_Surface
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

TOLERANCE = 1e-10  # wanted distance, in parts of the face's size
CHECKED = 41  # the distance is measured at CHECKED x CHECKED parameters


def approximate(shape: TopoDS_Shape, index: int, box: Box) -> tuple[Surfaces, float, float]:
    """A B-spline for the surface of face `index` over box, at the same parameters.

    Also the largest distance found between the two, and the size of the face (its box's longest side). The B-spline is
    the result's surface 1.

    Raises ValueError where OpenCascade finds none.
    """
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_RectangularTrimmedSurface
    from OCP.GeomAbs import GeomAbs_C2
    from OCP.GeomConvert import GeomConvert_ApproxSurface
    from OCP.TopLoc import TopLoc_Location

    surface = BRep_Tool.Surface_s(face_of(shape, index), TopLoc_Location())
    try:
        trimmed = Geom_RectangularTrimmedSurface(surface, *_inside(surface, box))
        exact = _sample(trimmed, box)
        size = float(np.ptp(exact.reshape(-1, 3), axis=0).max())
        maker = GeomConvert_ApproxSurface(trimmed, TOLERANCE * size, GeomAbs_C2, GeomAbs_C2, 14, 14, 200, 0)
        if not maker.HasResult():
            raise ValueError("OpenCascade finds no approximation of its surface")
        spline = maker.Surface()
        face = BRepBuilderAPI_MakeFace(spline, TOLERANCE * size).Face()
    except ValueError:
        raise
    except Exception as failure:  # OCP's exceptions share no narrower base
        raise ValueError(f"OpenCascade cannot approximate its surface ({type(failure).__name__})") from failure
    error = float(np.linalg.norm(_sample(spline, box) - exact, axis=-1).max())
    return brep.read(face).surfaces, error, size


def face_of(shape: TopoDS_Shape, index: int) -> TopoDS_Face:
    """Face `index` (from 0) of TopExp::MapShapes(shape, TopAbs_FACE)."""
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedMapOfShape

    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    return TopoDS.Face_s(faces.FindKey(index + 1))


def _inside(surface: Geom_Surface, box: Box) -> Box:
    """The box cut to the surface's domain where that ends (a periodic direction does not)."""
    u0, u1, v0, v1 = surface.Bounds()
    if not surface.IsUPeriodic():
        box = (max(box[0], u0), min(box[1], u1), box[2], box[3])
    if not surface.IsVPeriodic():
        box = (box[0], box[1], max(box[2], v0), min(box[3], v1))
    return box


def _sample(surface: Geom_Surface, box: Box) -> NDArray[np.float64]:
    """(CHECKED, CHECKED, 3) points over the box."""
    points = [
        [surface.Value(float(u), float(v)) for v in np.linspace(box[2], box[3], CHECKED)]
        for u in np.linspace(box[0], box[1], CHECKED)
    ]
    return np.array([[(p.X(), p.Y(), p.Z()) for p in row] for row in points])
