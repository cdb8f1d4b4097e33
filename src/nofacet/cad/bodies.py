"""Bodies: which faces bound one piece of material together, and whether they close it.

A body is a solid, a shell that is in no solid, or a face that is in no shell, where it stands in the shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .orientation import composed
from .stream import EDGE, FACE, REVERSED, SOLID, Stream
from .tables import Index, distinct, expand_runs, offsets_of


@dataclass(frozen=True)
class Bodies:
    """B bodies in the order of their first faces, with N uses of placed faces.

    offsets: (B + 1,), body b has the uses offsets[b] .. offsets[b + 1]; face: (N,), the placed face; reversed: (N,),
    whether the body uses it against its surface; shape: (B,), index of the body's shape in the stream.
    """

    offsets: Index
    face: Index
    reversed: NDArray[np.bool_]
    shape: Index


class BodyFinder:
    """Follows the bodies while a shape is taken apart from its root down to its faces."""

    def __init__(self) -> None:
        self._shape: list[Index] = []
        self._location: list[Index] = []
        self._count = 0

    def enter(self, kind: NDArray[np.uint8], shape: Index, location: Index, body: Index) -> Index:
        """The body each row (n,) is part of, given that of the row it came from (-1: none yet)."""
        starts = np.flatnonzero((body < 0) & (kind >= SOLID) & (kind <= FACE))
        body = body.copy()
        body[starts] = self._count + np.arange(len(starts))
        self._count += len(starts)
        self._shape.append(shape[starts])
        self._location.append(location[starts])
        return body

    def bodies(self, body: Index, face: Index, orientation: NDArray[np.uint8]) -> Bodies:
        """The bodies from their uses of faces (n,): each row's body, placed face and orientation.

        A body that stands twice in the same place counts once; faces of internal or external orientation bound none.
        """
        shape, location = np.concatenate(self._shape), np.concatenate(self._location)
        place = shape * (location.max(initial=0) + 1) + location
        first, which = distinct(place)
        used = np.flatnonzero((first[which[body]] == body) & (orientation <= REVERSED))
        first_use, number = distinct(body[used])
        uses = used[np.argsort(number, kind="stable")]
        offsets = offsets_of(np.bincount(number, minlength=len(first_use)))
        return Bodies(offsets, face[uses], orientation[uses] == REVERSED, shape[body[used[first_use]]])


def are_closed(stream: Stream, shapes: Index) -> NDArray[np.bool_]:
    """Whether the faces of each body's shape (B,) close a volume: every edge is used as often in one direction as in
    the other. Degenerate edges, and what is of internal or external orientation, bound nothing."""
    first, which = distinct(shapes)
    owner, edge, location, orientation = _edge_uses(stream, shapes[first])
    place = (owner * len(stream.kinds) + edge) * (location.max(initial=0) + 1) + location
    _, place = distinct(place)
    balance = np.bincount(place, np.where(orientation == REVERSED, -1.0, 1.0))
    closed = np.bincount(owner, minlength=len(first)) > 0
    closed[owner[balance[place] != 0]] = False
    result: NDArray[np.bool_] = closed[which]
    return result


def _edge_uses(stream: Stream, shapes: Index) -> tuple[Index, Index, Index, NDArray[Any]]:
    """Every use of an edge that bounds something in the shapes (n,): the shape's place, the edge, its location in the
    shape and its orientation."""
    below = stream.children
    owner, shape = np.arange(len(shapes)), shapes
    location, orientation = np.zeros(len(shapes), np.intp), np.zeros(len(shapes), np.intp)
    while (holds := stream.kinds[shape] < EDGE).any():
        # each solid, shell, face and wire makes way for its children, an edge stays
        count = np.where(holds, np.diff(below.offsets)[shape], 1)
        parent, k = expand_runs(np.where(holds, below.offsets[shape], 0), count)
        inner = np.flatnonzero(holds[parent])
        k, outer = k[inner], parent[inner]
        shapes, locations, orientations = shape[parent], location[parent], orientation[parent]
        shapes[inner] = below.shape[k]
        locations[inner] = stream.locations.compose_all(location[outer], below.location[k])
        orientations[inner] = composed(orientation[outer], below.orientation[k])
        bounds = np.flatnonzero((orientations <= REVERSED) & (stream.kinds[shapes] <= EDGE))
        owner, shape = owner[parent[bounds]], shapes[bounds]
        location, orientation = locations[bounds], orientations[bounds]
    own = np.flatnonzero(~stream.edges.degenerated[shape])
    return owner[own], shape[own], location[own], orientation[own]
