"""Closed trim loops of many faces at once: put together from edge uses, welded, measured.

A loop is a run of segments that share end points bitwise; a segment is the control points of a rational Bezier curve,
homogeneous (wu, wv, w) with end weights 1. Real wires store their edges backwards or in any order, with gaps up to
several per cent of the face. Where every use's end meets exactly one other's start the order is plain; the rest is
left to `chains`, which looks at one face at a time. The work is done in C++: src/native/extract/use_order.h,
trim_loops.h and, for gaps that are corners, corners.h.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .edges import Segments
from .tables import Index, expand, offsets_of

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]

# Gaps up to this part of the box are rounding (kSnap in corners.h).
SNAP = 1e-9


@dataclass(frozen=True)
class Loops:
    """L loops of S segments with M points, ordered by face; every face's loops stand together.

    face: (L,); loop_offsets: (L + 1,) into segments; segment_offsets: (S + 1,) into points; points: (M, 3);
    edge: (S,), what the segment runs along, -1 for none.
    """

    face: Index
    loop_offsets: Index
    segment_offsets: Index
    points: Array
    edge: NDArray[np.int32]


@dataclass(frozen=True)
class ParameterSpace:
    """What chaining needs to know of a surface: periods (0: none), natural bounds, and where it shrinks to a point.

    collapsed(axis, value): whether the surface is one point along the line on which parameter 1 - axis varies and
    parameter `axis` has `value` (a pole, a cone's tip).
    """

    periods: tuple[float, float]
    bounds: Box
    collapsed: Callable[[int, float], bool]


@dataclass(frozen=True)
class Ordered:
    """Uses in the order of their loops: use (I,), loop (I,), equal for the uses of one loop.

    unclear: wires left out.
    """

    use: Index
    loop: Index
    unclear: Index


def use_ends(wire: Index, reversed_: NDArray[np.bool_], segments: Segments) -> tuple[Array, Array, Array]:
    """Where the uses of segments begin and end in (u, v), and the extents of their wires, each (U, 2).

    wire: (U,) ascending; reversed_: (U,), whether the wire runs against the segments. Extents are by the segments'
    ends, and nowhere zero.
    """
    return _native.use_ends(wire, reversed_, segments)


def order_uses(wire: Index, start: Array, end: Array, size: Array) -> Ordered:
    """The order of uses (U,) within their wires where it is plain.

    wire: (U,) ascending; start, end: (U, 2), where each use begins and ends; size: (U, 2), the extent of its wire.
    """
    return Ordered(*_native.order_uses(wire, start, end, size))


@dataclass(frozen=True)
class Runs:
    """L loops of S segments, ordered by face, before their joints are welded.

    face: (L,); loop_offsets: (L + 1,); segment: (S,), its number in the table of segments; backwards: (S,), whether the
    loop runs against it; shift: (S, 2), to be added to its (u, v); edge: (S,).
    """

    face: Index
    loop_offsets: Index
    segment: Index
    backwards: NDArray[np.bool_]
    shift: Array
    edge: Index


def runs(
    segments: Segments, face: Index, loop: Index, use: Index, against: NDArray[np.bool_], shift: Array, edge: Index
) -> Runs:
    """Loops from uses in order: face, loop, use (I,), face and loop ascending; against: (I,), run backwards; shift:
    (I, 2), to be added to (u, v); edge: (I,), of the segments."""
    item, segment = expand(segments.offsets, use)
    low, high = segments.offsets[use], segments.offsets[use + 1]
    backwards = against[item]
    segment = np.where(backwards, (low + high - 1)[item] - segment, segment)
    new_loop = np.flatnonzero(np.append(True, loop[1:] != loop[:-1])[: len(loop)])
    before = offsets_of(high - low)
    loop_offsets = np.append(before[new_loop], before[-1])
    return Runs(face[new_loop], loop_offsets, segment, backwards, shift[item], edge[item])


def bounding_boxes(runs: Runs, segments: Segments, count: int) -> Array:
    """u0, u1, v0, v1 (count, 4) of each face's loops, NaN without any: exact for straight segments, at most 1/200 of a
    segment's own hull too wide else."""
    return _native.bounding_boxes(runs, segments, count)


def corner_gaps(runs: Runs, segments: Segments, boxes: Array) -> Index:
    """The segments behind which there is a gap that may be a corner, on faces with these boxes (F, 4)."""
    return _native.corner_gaps(runs, segments, boxes)


def closed(
    runs: Runs, segments: Segments, boxes: Array, kept: NDArray[np.bool_], at_pole: NDArray[np.bool_]
) -> tuple[Loops, Array]:
    """The loops of the faces that are `kept` (F,) with segments that start bitwise where the one before ends, and the
    faces' boxes.

    boxes: (F, 4), which gaps are measured by; at_pole: (S,), whether the joint behind a segment is on a line of (u, v)
    that is one point in space. Small gaps are moved away, corners cut or led on to, other gaps get a straight link.
    """
    *columns, boxes = _native.close_loops(runs, segments, boxes, kept, at_pole)
    return Loops(*columns), boxes


def rectangles(loops: Loops, boxes: Array) -> NDArray[np.bool_]:
    """Whether each face's (F,) loops are one loop once around its box (F, 4), every segment on one of its sides."""
    return _native.rectangles(loops, boxes)


def merged(tables: list[Loops]) -> Loops:
    """The loops of several tables as one, ordered by face."""
    face = np.concatenate([table.face for table in tables])
    return _chosen(tables, np.argsort(face, kind="stable"))


def without(loops: Loops, faces: Index) -> Loops:
    """The loops of all faces but these."""
    return _chosen([loops], np.flatnonzero(~np.isin(loops.face, faces)))


def _chosen(tables: list[Loops], which: Index) -> Loops:
    """Some of the loops of tables, counted through, in the order given."""
    face = np.concatenate([table.face for table in tables])[which]
    sizes = np.concatenate([np.diff(table.segment_offsets) for table in tables])
    loops = offsets_of(np.concatenate([np.diff(table.loop_offsets) for table in tables]))
    _, segment = expand(loops, which)
    _, point = expand(offsets_of(sizes), segment)
    points = np.concatenate([table.points for table in tables]).take(point, axis=0)
    edge = np.concatenate([table.edge for table in tables])[segment]
    return Loops(face, offsets_of(np.diff(loops)[which]), offsets_of(sizes[segment]), points, edge)
