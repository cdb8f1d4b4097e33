"""Section planes: what of a model is cut away."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .model import Model

Vector = tuple[float, float, float]


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


def uncapped_warnings(model: Model, faces: Sequence[int]) -> list[str]:
    """One line for each body that section planes cut open, because it is not closed; faces: those cut."""
    if not len(faces):
        return []
    body = np.repeat(np.arange(len(model.body_closed)), np.diff(model.body_offsets))
    is_open = model.body_closed[body] == 0
    of_face = np.full(model.face_count, -1)
    of_face[model.body_face[is_open]] = body[is_open]
    lines = []
    for number in np.unique(of_face[list(faces)]).tolist():
        own = model.body_face[model.body_offsets[number] : model.body_offsets[number + 1]] if number >= 0 else faces
        lines.append(f"{_naming(model, list(own))}: not a closed volume, so section planes show no cap there")
    return lines


def _naming(model: Model, faces: list[int]) -> str:
    """What a user knows faces by: their numbers, and the name of the first one or of the part it is in."""
    name = model.face_name[faces[0]] or next((n.name for n in model.tree if faces[0] in n.faces and n.name), "")
    numbers = f"face {faces[0]}" if len(faces) == 1 else f"faces {min(faces)} to {max(faces)}"
    return f"{numbers} ({name})" if name else numbers
