"""Closed trim loops from a wire's curve uses: chained, welded, made whole across periods.

A use is a list of segments that follow one edge once; a segment is (control points, edge), the control points
homogeneous (wu, wv, w) with end weights 1, edge an index or -1. A loop is a list of segments that share end points
bitwise. Real wires store their edges backwards or in any order, with gaps up to several per cent of the face, so the
next use is the one that starts nearest; corners closes what gap remains.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import comb, hypot

import numpy as np
from numpy.typing import NDArray

from .stream import Vector

Segment = tuple[list[Vector], int]
Use = list[Segment]
Loop = list[Segment]
Box = tuple[float, float, float, float]

# Gaps up to this part of the box are rounding.
SNAP = 1e-9
# A loop is a rectangle when its segments lie on the box's sides within this part of the box.
RECTANGLE = 1e-9


@dataclass(frozen=True)
class ParameterSpace:
    """What chaining needs to know of a surface: periods (0: none), natural bounds, and where it shrinks to a point.

    collapsed(axis, value): whether the surface is one point along the line on which parameter 1 - axis varies and
    parameter `axis` has `value` (a pole, a cone's tip).
    """

    periods: tuple[float, float]
    bounds: Box
    collapsed: Callable[[int, float], bool]


def reverse(use: Use) -> Use:
    """The same use run through the other way."""
    return [(points[::-1], edge) for points, edge in reversed(use)]


def chain(uses: list[Use], space: ParameterSpace) -> list[Loop]:
    """Order the uses of one wire into loops by nearest start, shifting uses by whole periods where that joins them.

    Joints are not welded yet. Usually one loop; more where the wire's uses close early.
    """
    width, height = _extent(uses)
    rest = list(range(len(uses)))
    loops: list[Loop] = []
    current: list[Use] = []
    hint = 0
    while rest:
        if not current:
            hint = rest.pop(0)
            current = [uses[hint]]
            continue
        start, end = current[0][0][0][0], current[-1][-1][0][-1]
        place, gap = _nearest(uses, rest, hint, end, width, height)
        closing = hypot((start[0] - end[0]) / width, (start[1] - end[1]) / height)
        if closing <= 1e-3 and gap > 10 * closing + SNAP:
            loops.append([segment for use in current for segment in use])
            current = []
            continue
        shift = (0.0, 0.0)
        if gap > 1e-3 and any(space.periods):
            place, shift = _nearest_shifted(uses, rest, end, width, height, space, (place, gap))
        hint = rest.pop(place)
        current.append(_moved(uses[hint], *shift) if any(shift) else uses[hint])
    loops.append([segment for use in current for segment in use])
    return loops


def _extent(uses: list[Use]) -> tuple[float, float]:
    us, vs, _ = zip(*[points[k] for use in uses for points, _ in use for k in (0, -1)], strict=True)
    width, height = max(us) - min(us), max(vs) - min(vs)
    largest = max(width, height) or 1.0
    return width or largest, height or largest


def _nearest(
    uses: list[Use], rest: list[int], hint: int, end: Vector, width: float, height: float
) -> tuple[int, float]:
    """Place in `rest` of the use that starts nearest to `end`, and its distance in parts of the extent.

    The stored neighbours of use `hint` are asked first: mostly one of them fits exactly.
    """

    def gap_at(place: int) -> float:
        start = uses[rest[place]][0][0][0]
        return hypot((start[0] - end[0]) / width, (start[1] - end[1]) / height)

    after = bisect(rest, hint) % len(rest)
    for place in (after, after - 1):
        gap = gap_at(place)
        if gap <= SNAP:
            return place, gap
    return min(((place, gap_at(place)) for place in range(len(rest))), key=lambda pair: pair[1])


def _nearest_shifted(
    uses: list[Use],
    rest: list[int],
    end: Vector,
    width: float,
    height: float,
    space: ParameterSpace,
    plain: tuple[int, float],
) -> tuple[int, tuple[float, float]]:
    """Place of the nearest start when uses may move by whole periods, and the move; `plain` (place, gap) stays if that
    brings nothing.

    A gap of one period at a pole is no shift but a missing degenerate edge, and stays.
    """
    best = (plain[0], plain[1], (0.0, 0.0))
    for place, use in enumerate(rest):
        start = uses[use][0][0][0]
        shift = [0.0, 0.0]
        for axis in (0, 1):
            period = space.periods[axis]
            if period:
                shift[axis] = period * round((end[axis] - start[axis]) / period)
                if shift[axis] and space.collapsed(1 - axis, end[1 - axis]):
                    shift[axis] = 0.0
        gap = hypot((start[0] + shift[0] - end[0]) / width, (start[1] + shift[1] - end[1]) / height)
        if gap < 1e-2 * best[1]:
            best = (place, gap, (shift[0], shift[1]))
    return best[0], best[2]


def _moved(use: Use, du: float, dv: float) -> Use:
    return [([(u + du * w, v + dv * w, w) for u, v, w in points], edge) for points, edge in use]


def winding(loop: Loop, space: ParameterSpace) -> tuple[int, int]:
    """How often the loop, open by whole periods, runs along each period: (0, 0) for an ordinary loop."""
    if not any(space.periods):
        return 0, 0
    start, end = loop[0][0][0], loop[-1][0][-1]
    turns = [0, 0]
    for axis, period in enumerate(space.periods):
        if period and not space.collapsed(1 - axis, end[1 - axis]):
            count = round((end[axis] - start[axis]) / period)
            if count and abs(end[axis] - start[axis] - count * period) < 1e-3 * period:
                other = abs(end[1 - axis] - start[1 - axis])
                turns[axis] = count if other <= 1e-3 * (space.periods[1 - axis] or period) else 0
    return turns[0], turns[1]


def close_winding(loops: list[Loop], turns: list[tuple[int, int]], space: ParameterSpace) -> list[Loop]:
    """Closed loops from loops that run along a period, so that even-odd holds.

    Two loops of opposite winding are joined by a pair of slanted links that are translates of each other by the
    period: what lies between the links is one period of the band between the loops. A loop left alone bounds a cap: it
    is closed over the natural bound on its left (the material side of an edge on a forward face).
    Raises ValueError where a loop finds no partner and the surface no end on that side.
    """
    result: list[Loop] = []
    open_loops = list(zip(loops, turns, strict=True))
    while open_loops:
        loop, turn = open_loops.pop(0)
        partner = next((k for k, (_, other) in enumerate(open_loops) if _opposite(turn, other)), None)
        if partner is not None:
            second, _ = open_loops.pop(partner)
            result.append(_joined(loop, second, space))
            continue
        axis = 0 if turn[0] else 1
        side = 2 * (1 - axis) + (1 if (turn[axis] > 0) == (axis == 0) else 0)
        bound = space.bounds[side]
        if abs(bound) >= 1e100:
            raise ValueError("an edge loop runs around the surface, and nothing bounds the face on its inner side")
        start, end = loop[0][0][0], loop[-1][0][-1]
        lifted: list[Vector] = []
        for point in (end, start):
            corner = [point[0], point[1], 1.0]
            corner[1 - axis] = bound
            lifted.append((corner[0], corner[1], 1.0))
        result.append([*loop, ([end, lifted[0]], -1), ([lifted[0], lifted[1]], -1), ([lifted[1], start], -1)])
    return result


def _opposite(one: tuple[int, int], other: tuple[int, int]) -> bool:
    return one == (-other[0], -other[1])


def _joined(first: Loop, second: Loop, space: ParameterSpace) -> Loop:
    """Two loops of opposite winding as one, the second moved by whole periods to start near the first one's end."""
    end, start = first[-1][0][-1], second[0][0][0]
    shift = [
        period * round((end[axis] - start[axis]) / period) if period else 0.0
        for axis, period in enumerate(space.periods)
    ]
    second = _moved(second, shift[0], shift[1]) if any(shift) else second
    return [
        *first,
        ([end, second[0][0][0]], -1),
        *second,
        ([second[-1][0][-1], first[0][0][0]], -1),
    ]


def bounding_box(loops: list[Loop]) -> Box:
    """u0, u1, v0, v1 of all loops: exact for straight segments, at most 1/200 of a segment's own hull too wide else."""
    us, vs, _ = zip(*[points[k] for loop in loops for points, _ in loop for k in (0, -1)], strict=True)
    u0, u1, v0, v1 = min(us), max(us), min(vs), max(vs)
    bulging: dict[int, list[list[Vector]]] = {}
    for loop in loops:
        for points, _ in loop:
            for u, v, w in points[1:-1]:
                if not (u0 * w <= u <= u1 * w and v0 * w <= v <= v1 * w):
                    bulging.setdefault(len(points) - 1, []).append(points)
                    break
    for degree, curves in bulging.items():
        fine = _subdivision(degree) @ np.array(curves)
        u, v = fine[..., 0] / fine[..., 2], fine[..., 1] / fine[..., 2]
        u0, u1 = min(u0, float(u.min())), max(u1, float(u.max()))
        v0, v1 = min(v0, float(v.min())), max(v1, float(v.max()))
    return u0, u1, v0, v1


@cache
def _subdivision(degree: int) -> NDArray[np.float64]:
    """(16 (degree + 1), degree + 1): control points of a Bezier curve's sixteen equal parts from its own."""
    left = np.array([[comb(i, j) / 2.0**i for j in range(degree + 1)] for i in range(degree + 1)])
    halves = np.vstack([left, left[::-1, ::-1]])
    result = np.eye(degree + 1)
    for _ in range(4):
        parts = result.reshape(-1, degree + 1, degree + 1)
        result = (halves @ parts).reshape(-1, degree + 1)
    return result


def is_rectangle(loops: list[Loop], box: Box) -> bool:
    """Whether the loops are one loop once around the box, every segment on one of its sides."""
    if len(loops) != 1:
        return False
    u0, u1, v0, v1 = box
    du, dv = RECTANGLE * (u1 - u0), RECTANGLE * (v1 - v0)
    area = 0.0
    for points, _ in loops[0]:
        first, last = points[0], points[-1]
        for axis, side, tolerance in ((0, u0, du), (0, u1, du), (1, v0, dv), (1, v1, dv)):
            ends_on_it = abs(first[axis] - side) <= tolerance and abs(last[axis] - side) <= tolerance
            if ends_on_it and all(abs(p[axis] - side * p[2]) <= tolerance for p in points[1:-1]):
                break
        else:
            return False
        area += (first[0] - u0) * (last[1] - v0) - (last[0] - u0) * (first[1] - v0)
    whole = (u1 - u0) * (v1 - v0)
    return abs(abs(0.5 * area) - whole) <= 1e-6 * whole
