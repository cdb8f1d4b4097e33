"""What the scripts here share: STEP files with the same bytes every time, and free-form faces from arrays."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterable
from pathlib import Path

import cadquery as cq
import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_BezierSurface, Geom_BSplineSurface, Geom_Surface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

FOLDER = Path(__file__).parent
TIME_STAMP = "2024-01-01T00:00:00"


def write_step(assembly: cq.Assembly, path: Path, pcurves: bool = True) -> Path:
    """Write `assembly` to `path`; the same assembly always gives the same bytes.

    OpenCascade puts the present time and the path into the header, both are replaced. `pcurves=False` leaves out the
    trim curves in (u, v), which a reader can rebuild; the file is then about half the size.
    """
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "raw.step"
        assembly.export(str(raw), "STEP", write_pcurves=pcurves)
        text = raw.read_text()
    text = re.sub(r"FILE_NAME\('[^']*','[^']*'", f"FILE_NAME('{path.name}','{TIME_STAMP}'", text, count=1)
    path.write_text(text)
    return path


def points_array(points: ArrayLike) -> TColgp_Array2OfPnt:
    """Control points of shape (m, n, 3) as OpenCascade's array; row index = u."""
    grid = np.asarray(points, dtype=float)
    array = TColgp_Array2OfPnt(1, grid.shape[0], 1, grid.shape[1])
    for i, row in enumerate(grid, 1):
        for j, point in enumerate(row, 1):
            array.SetValue(i, j, gp_Pnt(*map(float, point)))
    return array


def bezier_surface(points: ArrayLike) -> Geom_BezierSurface:
    """The polynomial Bezier surface with control points of shape (degree_u + 1, degree_v + 1, 3), in mm."""
    return Geom_BezierSurface(points_array(points))


def bspline_surface(points: ArrayLike, closed_u: bool = False, closed_v: bool = False) -> Geom_BSplineSurface:
    """The uniform bicubic B-spline surface with control points of shape (m, n, 3), in mm.

    A closed direction is periodic with one span for each control point; an open one has clamped ends and m - 3 spans.
    """
    grid = np.asarray(points, dtype=float)
    (knots_u, mults_u), (knots_v, mults_v) = _knots(grid.shape[0], closed_u), _knots(grid.shape[1], closed_v)
    return Geom_BSplineSurface(points_array(grid), knots_u, knots_v, mults_u, mults_v, 3, 3, closed_u, closed_v)


def _knots(count: int, closed: bool) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    """Uniform knots 0, 1, 2 ... and multiplicities of a cubic with `count` control points."""
    spans = count if closed else count - 3
    knots, mults = TColStd_Array1OfReal(1, spans + 1), TColStd_Array1OfInteger(1, spans + 1)
    for i in range(spans + 1):
        knots.SetValue(i + 1, float(i))
        mults.SetValue(i + 1, 4 if not closed and i in (0, spans) else 1)
    return knots, mults


def interpolate_closed(points: ArrayLike, axis: int) -> NDArray[np.float64]:
    """Control points of the uniform periodic cubic that passes through `points` along `axis`.

    Solves (c[i-1] + 4 c[i] + c[i+1]) / 6 = p[i] by Fourier transform, since the matrix is circulant.
    """
    values = np.asarray(points, dtype=float)
    count = values.shape[axis]
    response = (4 + 2 * np.cos(2 * np.pi * np.fft.fftfreq(count))) / 6
    shape = [1] * values.ndim
    shape[axis] = count
    return np.fft.ifft(np.fft.fft(values, axis=axis) / response.reshape(shape), axis=axis).real


def face(surface: Geom_Surface) -> cq.Face:
    """The whole surface as one face, with seams and poles where it closes or collapses."""
    made = BRepBuilderAPI_MakeFace(surface, 1e-7)
    if not made.IsDone():
        raise ValueError("OpenCascade makes no face of this surface")
    return cq.Face(made.Face())


def compound(shapes: Iterable[cq.Shape]) -> cq.Compound:
    """The shapes side by side: nothing is sewn or fused, so no geometry changes."""
    return cq.Compound.makeCompound(list(shapes))


def write_brep(shape: cq.Shape, path: Path) -> Path:
    """Write `shape` as OpenCascade's own BREP text, without triangles."""
    BRepTools.Write_s(shape.wrapped, str(path))
    return path
