"""How far the patches are from OpenCascade's surfaces; everything that is measured of a model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..model import Model, PatchGroup
from .surfaces import ELEMENTARY

if TYPE_CHECKING:
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


def measured(shape: TopoDS_Shape, model: Model, enter_stage: Callable[[str], None] = lambda stage: None) -> Model:
    """model with conversion_error and the edge uses filled in. model must be shape's model.

    enter_stage is called with a few words as each stage begins.
    """
    from .deviations import edge_deviations

    enter_stage("measuring the conversion error")
    errors = conversion_errors(shape, model)
    enter_stage("measuring the edges")
    edges = edge_deviations(shape)
    return replace(
        model,
        conversion_error=errors,
        edge_use_face=edges.face,
        edge_use_deviation=edges.distance,
        edge_use_tolerance=edges.tolerance,
    )


def conversion_errors(shape: TopoDS_Shape, model: Model) -> Array:
    """Largest distance (D,), model units, between each definition's patches and BRepAdaptor_Surface at equal (u, v).

    Every patch is compared at a grid of parameters with its borders: 9 x 9, on faces of over 64 patches and on the
    elementary surfaces (their patches are quadratic at most) 5 x 5, on faces of over 1000 patches 3 x 3. NaN for
    definitions without a surface or without patches. model must be shape's model.
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
            few = len(which) <= 64 and model.surface_type[definition] not in ELEMENTARY
            samples = 9 if few else 5 if len(which) <= 1000 else 3
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


def _faces(shape: TopoDS_Shape) -> list[TopoDS_Face]:
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedMapOfShape

    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    return [TopoDS.Face_s(faces.FindKey(k)) for k in range(1, faces.Extent() + 1)]
