"""Bodies: which faces bound one piece of material together, and whether they close it.

A body is a solid, a shell that is in no solid, or a face that is in no shell, where it stands in the shape.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .orientation import composed
from .stream import EDGE, FACE, REVERSED, SHELL, SOLID, Stream
from .tables import Index, expand_runs, offsets_of


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
        starts = np.flatnonzero((body < 0) & np.isin(kind, (SOLID, SHELL, FACE)))
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
        _, first, which = np.unique(place, return_index=True, return_inverse=True)
        used = np.flatnonzero((first[which[body]] == body) & (orientation <= REVERSED))
        found, first_use, number = np.unique(body[used], return_index=True, return_inverse=True)
        order = np.argsort(first_use)
        rank = np.empty(len(order), np.intp)
        rank[order] = np.arange(len(order))
        number = rank[number]
        sort = np.argsort(number, kind="stable")
        uses = used[sort]
        offsets = offsets_of(np.bincount(number, minlength=len(found)))
        return Bodies(offsets, face[uses], orientation[uses] == REVERSED, shape[found[order]])


def are_closed(stream: Stream, shapes: Index) -> NDArray[np.bool_]:
    """Whether the faces of each body's shape (B,) close a volume: every edge is used as often in one direction as in
    the other. Degenerate edges, and what is of internal or external orientation, bound nothing."""
    distinct, which = np.unique(shapes, return_inverse=True)
    below = stream.children
    owner, shape, location = np.arange(len(distinct)), distinct, np.zeros(len(distinct), np.intp)
    orientation = np.zeros(len(distinct), np.uint8)
    while (inner := stream.kinds[shape] < EDGE).any():
        count = np.where(inner, np.diff(below.offsets)[shape], 1)
        parent, k = expand_runs(np.where(inner, below.offsets[shape], 0), count)
        outer = parent[inner[parent]]
        k = k[inner[parent]]
        keep = ~inner
        owner = np.concatenate([owner[keep], owner[outer]])
        location = np.concatenate([location[keep], stream.locations.compose_all(location[outer], below.location[k])])
        orientation = np.concatenate([orientation[keep], composed(orientation[outer], below.orientation[k])])
        shape = np.concatenate([shape[keep], below.shape[k]])
        bounding = (orientation <= REVERSED) & (stream.kinds[shape] <= EDGE)
        owner, shape, location, orientation = (column[bounding] for column in (owner, shape, location, orientation))
    own = ~stream.edges.degenerated[shape]
    owner, shape, location, orientation = (column[own] for column in (owner, shape, location, orientation))
    _, edge = np.unique(np.stack([owner, shape, location], axis=1), axis=0, return_inverse=True)
    edge = edge.ravel()
    balance = np.bincount(edge, np.where(orientation == REVERSED, -1.0, 1.0))
    closed = np.bincount(owner, minlength=len(distinct)) > 0
    closed[owner[balance[edge] != 0]] = False
    result: NDArray[np.bool_] = closed[which.ravel()]
    return result
