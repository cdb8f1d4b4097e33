"""Trim loops made by hand: lists of segments in and out of the tables that nofacet.cad.loops closes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nofacet.cad.edges import Segments
from nofacet.cad.loops import Loops, Runs, closed

Segment = tuple[list[tuple[float, ...]], int]  # control points (wu, wv, w) and edge, -1 for none
Loop = list[Segment]


def as_runs(loops: Loops) -> tuple[Runs, Segments]:
    """Loops, closed or not, as runs of segments of their own."""
    first, last = loops.segment_offsets[:-1], loops.segment_offsets[1:] - 1
    number = np.arange(len(first))
    segments = Segments(np.arange(len(first) + 1), first, last - first, loops.points)
    shift = np.zeros((len(first), 2))
    return Runs(loops.face, loops.loop_offsets, number, number < 0, shift, loops.edge.astype(np.intp)), segments


def one_loop(loop: Loop) -> Loops:
    """The table of a single loop, of face 0."""
    return Loops(
        np.array([0]),
        np.array([0, len(loop)]),
        np.cumsum([0, *(len(points) for points, _ in loop)]),
        np.array([point for points, _ in loop for point in points], float),
        np.array([edge for _, edge in loop], np.int32),
    )


def closed_by_box(loops: Loops, box: tuple[float, float, float, float], at_pole: np.ndarray | None = None) -> Loops:
    """Loops of one face, their gaps closed as on a face with this box (u0, u1, v0, v1)."""
    runs, segments = as_runs(loops)
    poles = np.zeros(len(loops.edge), bool) if at_pole is None else at_pole
    return closed(runs, segments, np.array([box], float), np.ones(1, bool), poles)[0]


def weld(loop: Loop, width: float, height: float, at_pole: Callable[[float], bool] = lambda v: False) -> Loop:
    """One loop closed, on a face with a box of this size; at_pole: whether the face is one point at a height v."""
    following = [*loop[1:], loop[0]]
    poles = [at_pole(one[-1][1]) or at_pole(two[0][1]) for (one, _), (two, _) in zip(loop, following, strict=True)]
    whole = closed_by_box(one_loop(loop), (0, width, 0, height), np.array(poles))
    points = list(map(tuple, whole.points.tolist()))
    ends = zip(whole.segment_offsets.tolist(), whole.segment_offsets[1:].tolist(), whole.edge.tolist(), strict=False)
    return [(points[low:high], edge) for low, high, edge in ends]


def reverse(loop: Loop) -> Loop:
    """The same segments run through the other way."""
    return [(points[::-1], edge) for points, edge in reversed(loop)]
