"""Section planes: what of a model is cut away."""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .extent import surface_points
from .model import Model

Vector = tuple[float, float, float]

SIDE = 1e-11  # of the model's size: planes are moved as far before they are cut along (docs/sections.md)

_samples: weakref.WeakKeyDictionary[Model, tuple[NDArray[np.float64], NDArray[np.int32], float]] = (
    weakref.WeakKeyDictionary()
)


@dataclass(frozen=True)
class Section:
    """A plane that cuts away what lies on the side its normal points to: the points p with (p - origin) . normal > 0.

    origin: a point of the plane, model units; normal: of any length but 0, kept with length 1.
    Raises ValueError for a normal without direction or a number that is not finite.
    """

    origin: Vector
    normal: Vector

    def __post_init__(self) -> None:
        origin, normal = (tuple(float(c) for c in vector) for vector in (self.origin, self.normal))
        if len(origin) != 3 or len(normal) != 3 or not all(map(math.isfinite, origin + normal)):
            raise ValueError(f"section plane {origin} / {normal}: give three finite numbers each, origin and normal")
        largest = max(map(abs, normal))
        if largest == 0:
            raise ValueError("section plane: the normal is 0, 0, 0; give the direction that is cut away")
        scaled = [c / largest for c in normal]
        length = math.hypot(*scaled)
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "normal", tuple(c / length for c in scaled))


def uncapped_warnings(model: Model, sections: Sequence[Section], seen: Sequence[int]) -> list[str]:
    """One line for each body that section planes cut open, because it is not closed.

    seen: faces that were found cut while a picture was drawn. Pictures miss what they show edge-on, so faces with
    samples on both sides of a plane count, too.
    """
    faces = np.union1d(np.asarray(seen, np.int32), _cut_faces(model, sections))
    if not len(faces):
        return []
    body = np.repeat(np.arange(len(model.body_closed)), np.diff(model.body_offsets))
    is_open = model.body_closed[body] == 0
    of_face = np.full(model.face_count, -1)
    of_face[model.body_face[is_open]] = body[is_open]
    lines = []
    for number in np.unique(of_face[faces]).tolist():
        own = model.body_face[model.body_offsets[number] : model.body_offsets[number + 1]] if number >= 0 else faces
        lines.append(f"{_naming(model, own.tolist())}: not a closed volume, so section planes show no cap there")
    return lines


def _cut_faces(model: Model, sections: Sequence[Section]) -> NDArray[np.int32]:
    """Faces that bound no closed body and have samples on both sides of a plane."""
    points, face, room = _open_samples(model)
    cut = np.zeros(model.face_count, bool)
    for section in sections:
        distance = (points - section.origin) @ np.array(section.normal)
        kept, removed = np.zeros((2, model.face_count), bool)
        kept[face[distance < -room]] = True
        removed[face[distance > room]] = True
        cut |= kept & removed
    return np.flatnonzero(cut).astype(np.int32)


def _open_samples(model: Model) -> tuple[NDArray[np.float64], NDArray[np.int32], float]:
    """Points (N, 3) on the faces that bound no closed body, their faces (N,), and how far from a plane a point of this
    model must be to lie on one of its sides."""
    if model not in _samples:
        points, face = surface_points(model)
        closed = np.zeros(model.face_count, bool)
        closed[model.body_face[np.repeat(model.body_closed, np.diff(model.body_offsets)) == 1]] = True
        room = SIDE * float(np.ptp(points, axis=0).max()) if len(points) else 0.0
        _samples[model] = points[~closed[face]], face[~closed[face]], room
    return _samples[model]


def _naming(model: Model, faces: list[int]) -> str:
    """What a user knows faces by: their numbers, and the name of the first one or of the part it is in."""
    name = model.face_name[faces[0]] or next((n.name for n in model.tree if faces[0] in n.faces and n.name), "")
    numbers = f"face {faces[0]}" if len(faces) == 1 else f"faces {min(faces)} to {max(faces)}"
    return f"{numbers} ({name})" if name else numbers
