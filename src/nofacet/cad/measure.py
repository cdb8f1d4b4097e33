"""How far the patches are from OpenCascade's surfaces, and the file's edges from their own curves in (u, v)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..model import Model, PatchGroup

if TYPE_CHECKING:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

Array = NDArray[np.float64]


@cache
def _bernstein(degree: int, samples: int) -> Array:
    """(samples, degree + 1) Bernstein polynomials at equally spaced parameters, both ends included."""
    s = np.linspace(0.0, 1.0, samples)[:, None]
    k = np.arange(degree + 1)
    binomial = np.array([comb(degree, j) for j in k], float)
    return binomial * s**k * (1 - s) ** (degree - k)


def evaluate(group: PatchGroup, which: NDArray[np.int64], samples: int) -> Array:
    """Points (n, samples, samples, 3) of patches `which` at equally spaced patch parameters, borders included."""
    points = group.control_points[which]
    du, dv = group.degree
    homogeneous = np.einsum("ai,nijc,bj->nabc", _bernstein(du, samples), points, _bernstein(dv, samples), optimize=True)
    return np.asarray(homogeneous[..., :3] / homogeneous[..., 3:])


def parameters(group: PatchGroup, which: NDArray[np.int64], samples: int) -> tuple[Array, Array]:
    """OpenCascade's u and v, each (n, samples), at equally spaced patch parameters of patches `which`."""
    s = np.linspace(0.0, 1.0, samples)
    result = []
    for axis in (0, 1):
        low, high = (group.domain[which, 2 * axis + k, None] for k in (0, 1))
        linear = low + s * (high - low)
        tangent = np.tan(np.clip(0.25 * (high - low), -1.5, 1.5))
        angle = 0.5 * (low + high) + 2 * np.arctan(tangent * (2 * s - 1))
        result.append(np.where(group.angular[which, axis, None] == 1, angle, linear))
    return result[0], result[1]


def conversion_errors(shape: TopoDS_Shape, model: Model) -> Array:
    """Largest distance (D,), model units, between each definition's patches and BRepAdaptor_Surface at equal (u, v).

    Every patch is compared at a grid of parameters with its borders: 9 x 9, on faces of over 64 patches 5 x 5, of
    over 1000 patches 3 x 3. NaN for definitions without a surface or without patches. model must be shape's model.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface

    errors = np.full(model.definition_count, np.nan)
    faces = _faces(shape)
    first_face = np.full(model.definition_count, -1)
    first_face[model.face_definition[::-1]] = np.arange(model.face_count)[::-1]
    for group in model.groups:
        starts = np.searchsorted(group.definition, np.arange(model.definition_count + 1))
        for definition in np.unique(group.definition):
            if model.surface_type[definition] == "triangles":
                continue
            which = np.arange(starts[definition], starts[definition + 1])
            samples = 9 if len(which) <= 64 else 5 if len(which) <= 1000 else 3
            placement = model.placements[model.face_placement[first_face[definition]]]
            ours = evaluate(group, which, samples) @ placement[:3, :3].T + placement[:3, 3]
            surface = BRepAdaptor_Surface(faces[first_face[definition]], False)
            u, v = parameters(group, which, samples)
            theirs = np.empty_like(ours)
            for patch, (us, vs) in enumerate(zip(u.tolist(), v.tolist(), strict=True)):
                points = [surface.Value(a, b) for a in us for b in vs]
                theirs[patch] = np.reshape([(p.X(), p.Y(), p.Z()) for p in points], (samples, samples, 3))
            errors[definition] = np.fmax(errors[definition], np.linalg.norm(ours - theirs, axis=-1).max())
    return errors


@dataclass(frozen=True)
class EdgeDeviations:
    """One entry for each use of an edge in a placed face, in OpenCascade's exploration order.

    face: (n,) int32, index of the placed face. distance: (n,) float64, model units, the largest distance of the edge's
    3-D curve from its curve on the face's surface. tolerance: (n,) float64, what the file's reader recorded.
    """

    face: NDArray[np.int32]
    distance: Array
    tolerance: Array


def edge_deviations(shape: TopoDS_Shape, samples: int = 23) -> EdgeDeviations:
    """Measure how far each edge's 3-D curve runs from the curve in (u, v) that trimming follows.

    At equal parameter first, at `samples` parameters, which bounds the distance from above. Where that exceeds 1e-7 of
    the edge's extent the curves are compared as curves: each point of the one with a chord polyline through ten times
    as many points of the other. Degenerate edges and edges without a 3-D curve are left out.
    """
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    rows = []
    for index, face in enumerate(_faces(shape)):
        if BRep_Tool.Surface_s(face) is None:
            continue
        explorer = TopExp_Explorer(face, TopAbs_EDGE)
        while explorer.More():
            edge = TopoDS.Edge_s(explorer.Current())
            explorer.Next()
            if BRep_Tool.Degenerated_s(edge) or not BRep_Tool.IsGeometric_s(edge):
                continue
            tolerance = BRep_Tool.Tolerance_s(edge)
            curves = BRepAdaptor_Curve(edge), BRepAdaptor_Curve(edge, face)
            rows.append((index, _distance(*curves, samples), tolerance))
    columns = np.array(rows, float).reshape(-1, 3)
    return EdgeDeviations(columns[:, 0].astype(np.int32), columns[:, 1], columns[:, 2])


def _faces(shape: TopoDS_Shape) -> list[TopoDS_Face]:
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedMapOfShape

    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    return [TopoDS.Face_s(faces.FindKey(k)) for k in range(1, faces.Extent() + 1)]


def _points(curve: BRepAdaptor_Curve, samples: int) -> Array:
    """(samples, 3) points at equally spaced parameters."""
    t = np.linspace(curve.FirstParameter(), curve.LastParameter(), samples).tolist()
    points = [curve.Value(x) for x in t]
    return np.array([(p.X(), p.Y(), p.Z()) for p in points])


def _distance(space: BRepAdaptor_Curve, on_surface: BRepAdaptor_Curve, samples: int) -> float:
    one = _points(space, samples)
    at_equal_parameter = np.linalg.norm(one - _points(on_surface, samples), axis=1)
    if at_equal_parameter.max() <= 1e-7 * np.ptp(one, axis=0).max():
        return float(at_equal_parameter.max())
    line = _points(on_surface, 10 * samples)
    start, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    part = np.clip(((one[:, None] - start) * along).sum(axis=-1) / squared, 0, 1)
    nearest = np.linalg.norm(start + part[..., None] * along - one[:, None], axis=-1).min(axis=1)
    return float(np.minimum(nearest, at_equal_parameter).max())
