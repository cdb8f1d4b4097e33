"""Closed trim loops of many faces at once: put together from edge uses, welded, measured.

A loop is a run of segments that share end points bitwise; a segment is the control points of a rational Bezier curve,
homogeneous (wu, wv, w) with end weights 1. Real wires store their edges backwards or in any order, with gaps up to
several per cent of the face. Where every use's end meets exactly one other's start the order is plain; the rest is
left to `chains`, which looks at one face at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .edges import Segments
from .geometry import Vector
from .tables import Index, expand, expand_runs, offsets_of

Array = NDArray[np.float64]
Segment = tuple[list[Vector], int]  # control points and edge, -1 for none
Loop = list[Segment]
Box = tuple[float, float, float, float]

# Gaps up to this part of the box are rounding: the next segment's end is moved. Wider ones get a link.
SNAP = 1e-9
# A loop is a rectangle when its segments lie on the box's sides within this part of the box.
RECTANGLE = 1e-9
# An end that meets only one start within this part of a wire's extent is taken to belong to it.
_JOINT = 1e-3
_LONGEST_MATCHED = 64  # uses of a wire whose ends are compared each with each


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


def order_uses(wire: Index, start: Array, end: Array, size: Array) -> Ordered:
    """The order of uses (U,) within their wires where it is plain.

    wire: (U,) ascending; start, end: (U, 2), where each use begins and ends; size: (U, 2), the extent of its wire.
    """
    first = np.flatnonzero(np.append(True, wire[1:] != wire[:-1])[: len(wire)])
    count = np.diff(np.append(first, len(wire)))
    following = np.arange(1, len(wire) + 1)
    following[first + count - 1] = first
    plain = (count == 1) | every(_gap(end, start[following], size) <= SNAP, first)
    rank, cycle = np.arange(len(wire)), np.zeros(len(wire), np.intp)
    for tolerance in (SNAP, _JOINT):
        rest = np.flatnonzero(~plain & (count <= _LONGEST_MATCHED))
        if len(rest):
            plain[rest], found, numbers = _cycles(first[rest], count[rest], start, end, size, tolerance)
            rank[found], cycle[found] = np.arange(len(found)), numbers
    clear = np.flatnonzero(np.repeat(plain, count))
    order = clear[np.lexsort((rank[clear], cycle[clear], wire[clear]))]
    loops_before = offsets_of(np.maximum.reduceat(cycle, first) + 1 if len(wire) else count)
    loop = np.repeat(loops_before[:-1], count) + cycle
    return Ordered(order, loop[order], wire[first[~plain]])


def every(conditions: Any, first: Index) -> NDArray[np.bool_]:
    """Whether the conditions hold in all of each run, first (n,) being where the runs start."""
    return np.logical_and.reduceat(conditions, first) if len(first) else np.zeros(0, bool)


def _gap(one: Array, other: Array, size: Array) -> Array:
    gap = (one - other) / size
    return np.asarray(np.hypot(gap[:, 0], gap[:, 1]))


def _cycles(
    first: Index, count: Index, start: Array, end: Array, size: Array, tolerance: float
) -> tuple[NDArray[np.bool_], list[int], list[int]]:
    """Which wires fall into cycles of uses that each meet exactly one other within a tolerance, in parts of the wire's
    extent, one gap allowed; their uses in order, each's cycle.

    first, count: (W,), the wires' first uses and numbers of uses.
    """
    wire, use = expand_runs(first, count)
    place, other = expand_runs(first[wire], count[wire])
    one = use[place]
    meeting = np.flatnonzero(_gap(end[one], start[other], size[one]) <= tolerance)
    one, other = one[meeting], other[meeting]
    ends, starts = (np.bincount(uses, minlength=len(start))[use] for uses in (one, other))
    runs = offsets_of(count)[:-1]
    plain = every((ends <= 1) & (starts <= 1), runs)
    loose_ends, loose_starts = (np.add.reduceat(number == 0, runs, dtype=np.intp) for number in (ends, starts))
    plain &= (loose_ends == loose_starts) & (loose_ends <= 1)
    following = np.zeros(len(start), np.intp)
    following[one] = other
    bridged = plain[wire] & (loose_ends == 1)[wire]  # what is left can only follow each other
    following[use[bridged & (ends == 0)]] = use[bridged & (starts == 0)]
    after = following.tolist()
    order: list[int] = []
    numbers: list[int] = []
    seen = bytearray(len(start))
    for begin, number_of_uses in zip(first[plain].tolist(), count[plain].tolist(), strict=True):
        number = 0
        for use_of_wire in range(begin, begin + number_of_uses):
            k = use_of_wire
            if seen[k]:
                continue
            while not seen[k]:
                seen[k] = 1
                order.append(k)
                numbers.append(number)
                k = after[k]
            number += 1
    return plain, order, numbers


@dataclass(frozen=True)
class Runs:
    """L loops of S segments, ordered by face, before their joints are welded.

    face: (L,); loop_offsets: (L + 1,); segment: (S,), its number in the table of segments; backwards: (S,), whether the
    loop runs against it; shift: (S, 2), to be added to its (u, v); edge: (S,); start, end: (S, 2).
    """

    face: Index
    loop_offsets: Index
    segment: Index
    backwards: NDArray[np.bool_]
    shift: Array
    edge: Index
    start: Array
    end: Array


def runs(
    segments: Segments, face: Index, loop: Index, use: Index, against: NDArray[np.bool_], shift: Array, edge: Index
) -> Runs:
    """Loops from uses in order: face, loop, use (I,), face and loop ascending; against: (I,), run backwards; shift:
    (I, 2), to be added to (u, v); edge: (I,), of the segments."""
    item, segment = expand(segments.offsets, use)
    backwards, shift = against[item], shift[item]
    low, high = segments.offsets[use][item], segments.offsets[use + 1][item]
    segment = np.where(backwards, low + high - 1 - segment, segment)
    first = segments.first_point[segment]
    ends = segments.points[np.stack([first, first + segments.degree[segment]]), :2] + shift
    start, end = np.where(backwards[:, None], ends[::-1], ends)
    new_loop = np.flatnonzero(np.append(True, loop[1:] != loop[:-1])[: len(loop)])
    before = offsets_of(np.diff(segments.offsets)[use])
    loop_offsets = np.append(before[new_loop], before[-1])
    return Runs(face[new_loop], loop_offsets, segment, backwards, shift, edge[item], start, end)


def bounding_boxes(runs: Runs, segments: Segments, count: int) -> Array:
    """u0, u1, v0, v1 (count, 4) of each face's loops, NaN without any: exact for straight segments, at most 1/200 of a
    segment's own hull too wide else."""
    boxes = np.full((count, 4), np.nan)
    if not len(runs.face):
        return boxes
    first = np.flatnonzero(np.append(True, runs.face[1:] != runs.face[:-1]))
    which = runs.face[first]
    first_segment = runs.loop_offsets[first]
    boxes[which, ::2] = np.minimum.reduceat(np.minimum(runs.start, runs.end), first_segment)
    boxes[which, 1::2] = np.maximum.reduceat(np.maximum(runs.start, runs.end), first_segment)
    face = np.repeat(runs.face, np.diff(runs.loop_offsets))
    low, high = (corner[runs.segment] + runs.shift for corner in (segments.low, segments.high))
    outside = (low < boxes[face, ::2]) | (high > boxes[face, 1::2])
    degree = segments.degree[runs.segment]
    bulging = np.flatnonzero(outside.any(axis=1) & (degree > 1))
    for p in np.flatnonzero(np.bincount(degree[bulging])):
        own = bulging[degree[bulging] == p]
        hull = segments.points[segments.first_point[runs.segment[own]][:, None] + np.arange(p + 1)]
        fine = _subdivision(int(p)) @ hull
        fine = fine[..., :2] / fine[..., 2:] + runs.shift[own, None]
        for axis in (0, 1):
            np.minimum.at(boxes[:, 2 * axis], face[own], fine[..., axis].min(axis=1))
            np.maximum.at(boxes[:, 2 * axis + 1], face[own], fine[..., axis].max(axis=1))
    return boxes


@cache
def _subdivision(degree: int) -> Array:
    """(16 (degree + 1), degree + 1): control points of a Bezier curve's sixteen equal parts from its own."""
    left = np.array([[comb(i, j) / 2.0**i for j in range(degree + 1)] for i in range(degree + 1)])
    halves = np.vstack([left, left[::-1, ::-1]])
    result = np.eye(degree + 1)
    for _ in range(4):
        parts = result.reshape(-1, degree + 1, degree + 1)
        result = (halves @ parts).reshape(-1, degree + 1)
    return result


@dataclass(frozen=True)
class Joints:
    """The joint behind each segment (S,) of runs: the segment that follows; whether the joint is open at all; whether
    the gap is one of rounding; the gap's width (S,) in parts of the face's box."""

    following: Index
    is_open: NDArray[np.bool_]
    small: NDArray[np.bool_]
    width: Array


def joints(runs: Runs, boxes: Array) -> Joints:
    """The joints of loops on faces with these boxes (F, 4)."""
    segment_count = np.diff(runs.loop_offsets)
    following = np.arange(1, len(runs.segment) + 1)
    following[runs.loop_offsets[1:] - 1] = runs.loop_offsets[:-1]
    gap = np.abs(runs.start[following] - runs.end)
    size = np.repeat((boxes[:, 1::2] - boxes[:, ::2])[runs.face], segment_count, axis=0)
    alone = np.repeat(segment_count == 1, segment_count)
    small = np.all(gap <= SNAP * size, axis=1) & ~alone
    return Joints(following, np.asarray(np.any(gap > 0, axis=1)), np.asarray(small), np.hypot(*(gap / size).T))


def welded(runs: Runs, segments: Segments, joints: Joints) -> Loops:
    """Loops in which every segment starts bitwise where the one before it ends: small gaps are moved away, wider ones
    get a straight link."""
    following = joints.following
    segment_count = np.diff(runs.loop_offsets)
    links = np.flatnonzero(joints.is_open & ~joints.small)
    segment, backwards, shift, edge, added = runs.segment, runs.backwards, runs.shift, runs.edge, 0 * segment_count
    if len(links):
        ends = np.stack([runs.end[links], runs.start[following[links]]], axis=1)
        segment = np.insert(segment, links + 1, segments.offsets[-1] + np.arange(len(links)))
        segments = segments.with_links(ends)
        backwards, edge = np.insert(backwards, links + 1, False), np.insert(edge, links + 1, -1)
        shift = np.insert(shift, links + 1, 0.0, axis=0)
        loop = np.searchsorted(runs.loop_offsets, links, side="right") - 1
        added = np.bincount(loop, minlength=len(segment_count))
    offsets, points = _gathered(segments, segment, backwards, shift)
    moved = np.flatnonzero(joints.is_open & joints.small)
    place = np.arange(len(following)) + np.searchsorted(links, np.arange(len(following)))
    before, after = offsets[place[moved] + 1] - 1, offsets[place[following[moved]]]
    back = following[moved] <= moved
    points[after[~back]] = points[before[~back]]
    points[before[back]] = points[after[back]]
    return Loops(runs.face, offsets_of(segment_count + added), offsets, points, edge.astype(np.int32))


def reverse(loop: Loop) -> Loop:
    """The same segments run through the other way."""
    return [(points[::-1], edge) for points, edge in reversed(loop)]


def as_list(runs: Runs, segments: Segments, loop: int) -> Loop:
    """The segments of one loop one by one."""
    own = slice(runs.loop_offsets[loop], runs.loop_offsets[loop + 1])
    offsets, points = _gathered(segments, runs.segment[own], runs.backwards[own], runs.shift[own])
    flat = list(map(tuple, points.tolist()))
    ends = zip(offsets.tolist(), offsets[1:].tolist(), runs.edge[own].tolist(), strict=False)
    return [(flat[low:high], edge) for low, high, edge in ends]


def from_lists(loops: list[tuple[int, Loop]]) -> Loops:
    """A table of welded loops, each with its face."""
    segments = [segment for _, loop in loops for segment in loop]
    return Loops(
        np.array([face for face, _ in loops], np.intp),
        offsets_of(np.array([len(loop) for _, loop in loops], np.intp)),
        offsets_of(np.array([len(points) for points, _ in segments], np.intp)),
        np.array([point for points, _ in segments for point in points], float).reshape(-1, 3),
        np.array([edge for _, edge in segments], np.int32),
    )


def as_runs(loops: Loops) -> tuple[Runs, Segments]:
    """Welded loops as runs of segments of their own."""
    first, last = loops.segment_offsets[:-1], loops.segment_offsets[1:] - 1
    count = len(first)
    controls = loops.points[:, :2] / loops.points[:, 2:]
    low, high = (bound.reduceat(controls, first) if count else controls for bound in (np.minimum, np.maximum))
    number = np.arange(count)
    segments = Segments(np.arange(count + 1), first, last - first, low, high, loops.points)
    ends = loops.points[first, :2], loops.points[last, :2]
    edge = loops.edge.astype(np.intp)
    return Runs(loops.face, loops.loop_offsets, number, number < 0, np.zeros((count, 2)), edge, *ends), segments


def _gathered(segments: Segments, segment: Index, backwards: NDArray[np.bool_], shift: Array) -> tuple[Index, Array]:
    """Segments' points (M, 3), one behind the other, and where each one's begin (S + 1,)."""
    degree = segments.degree[segment]
    size = degree + 1
    offsets = offsets_of(size)
    step = np.where(backwards, -1, 1)
    start = segments.first_point[segment] + np.where(backwards, degree, 0) - step * offsets[:-1]
    points = segments.points.take(np.repeat(start, size) + np.repeat(step, size) * np.arange(offsets[-1]), axis=0)
    if shift.any():
        points[:, :2] += np.repeat(shift, size, axis=0) * points[:, 2:]
    return offsets, points


def rectangles(loops: Loops, boxes: Array) -> NDArray[np.bool_]:
    """Whether each face's (F,) loops are one loop once around its box, every segment on one of the box's sides."""
    result = np.zeros(len(boxes), bool)
    single = np.flatnonzero(np.bincount(loops.face, minlength=len(boxes))[loops.face] == 1)
    loop, segment = expand(loops.loop_offsets, single)
    box = boxes[loops.face[single]]
    low, width = box[:, ::2], box[:, 1::2] - box[:, ::2]
    ends = loops.points[np.stack([loops.segment_offsets[segment], loops.segment_offsets[segment + 1] - 1]), :2]
    first, last = (ends - low[loop]) / width[loop]
    runs = offsets_of(np.diff(loops.loop_offsets)[single])[:-1]
    near = [np.abs(first - side) <= RECTANGLE for side in (0, 1)]
    near = [one & (np.abs(last - side) <= RECTANGLE) for side, one in zip((0, 1), near, strict=True)]
    beside = np.concatenate(near, axis=1)  # (S, 4): u0, v0, u1, v1
    area = 0.5 * np.add.reduceat(first[:, 0] * last[:, 1] - last[:, 0] * first[:, 1], runs) if len(runs) else runs
    candidate = every(np.any(beside, axis=1), runs) & (np.abs(np.abs(area) - 1) <= 1e-6)
    kept = np.flatnonzero(candidate[loop])
    owner, point = expand(loops.segment_offsets, segment[kept])
    of_loop = loop[kept][owner]
    u, v, w = loops.points[point].T
    u, v = (u - low[of_loop, 0] * w) / width[of_loop, 0], (v - low[of_loop, 1] * w) / width[of_loop, 1]
    on_side = np.abs(np.stack([u, v, u - w, v - w], axis=1)) <= RECTANGLE
    starts = offsets_of(np.diff(loops.segment_offsets)[segment[kept]])[:-1]
    straight = np.logical_and.reduceat(on_side, starts).any(axis=1) if len(starts) else np.zeros(0, bool)
    bent = np.bincount(loop[kept][~straight], minlength=len(single)) > 0
    result[loops.face[single]] = candidate & ~bent
    return result


def merged(tables: list[Loops]) -> Loops:
    """The loops of several tables as one, ordered by face."""
    face = np.concatenate([table.face for table in tables])
    return _chosen(tables, np.argsort(face, kind="stable"))


def replaced(loops: Loops, new: Loops) -> Loops:
    """The loops with those of the faces in `new` taken from there."""
    face = np.append(loops.face, new.face)
    order = np.argsort(face, kind="stable")
    kept = np.append(~np.isin(loops.face, new.face), np.full(len(new.face), True))
    return _chosen([loops, new], order[kept[order]])


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
