"""The order of a face's edge uses where it takes judgement: gaps, periods, missing edges at poles, loops that wind.

A stretch is one edge use, or a link where there is none, from start to end in (u, v); it may be moved by whole periods.
"""

from __future__ import annotations

from bisect import bisect
from math import hypot
from typing import NamedTuple

from .loops import SNAP, ParameterSpace

Point = tuple[float, float]


class Stretch(NamedTuple):
    """use: number of the use, -1 for a link; start, end: after the move by `shift`."""

    use: int
    start: Point
    end: Point
    shift: Point = (0.0, 0.0)


def chain_face(wires: list[list[Stretch]], sizes: list[Point], space: ParameterSpace) -> list[list[Stretch]]:
    """The loops of a face from its wires' stretches; sizes: the wires' extents. Gaps are left open, except that loops
    which run along a period are made whole. Raises ValueError where that is impossible."""
    closed: list[list[Stretch]] = []
    winding_loops: list[list[Stretch]] = []
    turns: list[tuple[int, int]] = []
    for stretches, size in zip(wires, sizes, strict=True):
        for loop in chain(stretches, size, space):
            turn = winding(loop, space)
            if turn == (0, 0):
                closed.append(loop)
            else:
                winding_loops.append(loop)
                turns.append(turn)
    return closed + close_winding(winding_loops, turns, space)


def chain(stretches: list[Stretch], size: Point, space: ParameterSpace) -> list[list[Stretch]]:
    """Order the stretches of one wire into loops by nearest start, moving them by whole periods where that joins them.

    Usually one loop; more where the wire's uses close early.
    """
    rest = list(range(len(stretches)))
    loops: list[list[Stretch]] = []
    current: list[Stretch] = []
    hint = 0
    while rest:
        if not current:
            hint = rest.pop(0)
            current = [stretches[hint]]
            continue
        start, end = current[0].start, current[-1].end
        place, gap = _nearest(stretches, rest, hint, end, size)
        closing = _distance(start, end, size)
        if closing <= 1e-3 and gap > 10 * closing + SNAP:
            loops.append(current)
            current = []
            continue
        shift = (0.0, 0.0)
        if gap > 1e-3 and any(space.periods):
            place, shift = _nearest_shifted(stretches, rest, end, size, space, (place, gap))
        hint = rest.pop(place)
        current.append(_moved(stretches[hint], shift) if any(shift) else stretches[hint])
    loops.append(current)
    return loops


def _distance(one: Point, other: Point, size: Point) -> float:
    return hypot((one[0] - other[0]) / size[0], (one[1] - other[1]) / size[1])


def _nearest(stretches: list[Stretch], rest: list[int], hint: int, end: Point, size: Point) -> tuple[int, float]:
    """Place in `rest` of the stretch that starts nearest to `end`, and its distance in parts of the extent.

    The stored neighbours of stretch `hint` are asked first: mostly one of them fits exactly.
    """
    after = bisect(rest, hint) % len(rest)
    for place in (after, after - 1):
        gap = _distance(stretches[rest[place]].start, end, size)
        if gap <= SNAP:
            return place, gap
    gaps = [_distance(stretches[k].start, end, size) for k in rest]
    gap = min(gaps)
    return gaps.index(gap), gap


def _nearest_shifted(
    stretches: list[Stretch],
    rest: list[int],
    end: Point,
    size: Point,
    space: ParameterSpace,
    plain: tuple[int, float],
) -> tuple[int, Point]:
    """Place of the nearest start when stretches may move by whole periods, and the move; `plain` (place, gap) stays if
    that brings nothing.

    A gap of one period at a pole is no shift but a missing degenerate edge, and stays.
    """
    best = (plain[0], plain[1], (0.0, 0.0))
    for place, k in enumerate(rest):
        start = stretches[k].start
        shift = [0.0, 0.0]
        for axis in (0, 1):
            period = space.periods[axis]
            if period:
                shift[axis] = period * round((end[axis] - start[axis]) / period)
                if shift[axis] and space.collapsed(1 - axis, end[1 - axis]):
                    shift[axis] = 0.0
        gap = _distance((start[0] + shift[0], start[1] + shift[1]), end, size)
        if gap < 1e-2 * best[1]:
            best = (place, gap, (shift[0], shift[1]))
    return best[0], best[2]


def _moved(stretch: Stretch, shift: Point) -> Stretch:
    (du, dv), (u0, v0), (u1, v1), (before_u, before_v) = shift, stretch.start, stretch.end, stretch.shift
    return Stretch(stretch.use, (u0 + du, v0 + dv), (u1 + du, v1 + dv), (before_u + du, before_v + dv))


def winding(loop: list[Stretch], space: ParameterSpace) -> tuple[int, int]:
    """How often the loop, open by whole periods, runs along each period: (0, 0) for an ordinary loop."""
    if not any(space.periods):
        return 0, 0
    start, end = loop[0].start, loop[-1].end
    turns = [0, 0]
    for axis, period in enumerate(space.periods):
        if period and not space.collapsed(1 - axis, end[1 - axis]):
            count = round((end[axis] - start[axis]) / period)
            if count and abs(end[axis] - start[axis] - count * period) < 1e-3 * period:
                other = abs(end[1 - axis] - start[1 - axis])
                turns[axis] = count if other <= 1e-3 * (space.periods[1 - axis] or period) else 0
    return turns[0], turns[1]


def close_winding(
    loops: list[list[Stretch]], turns: list[tuple[int, int]], space: ParameterSpace
) -> list[list[Stretch]]:
    """Closed loops from loops that run along a period, so that they bound a region.

    Two loops of opposite winding follow each other: what lies between the two gaps, which become slanted links that are
    translates of each other by the period, is one period of the band between the loops. A loop left alone bounds a cap:
    it is closed over the natural bound on its left (the material side of an edge on a forward face).
    Raises ValueError where a loop finds no partner and the surface no end on that side.
    """
    result: list[list[Stretch]] = []
    open_loops = list(zip(loops, turns, strict=True))
    while open_loops:
        loop, turn = open_loops.pop(0)
        opposite = (-turn[0], -turn[1])
        partner = next((k for k, (_, other) in enumerate(open_loops) if other == opposite), None)
        if partner is not None:
            second, _ = open_loops.pop(partner)
            result.append([*loop, *_brought_near(second, loop[-1].end, space)])
            continue
        axis = 0 if turn[0] else 1
        side = 2 * (1 - axis) + (1 if (turn[axis] > 0) == (axis == 0) else 0)
        bound = space.bounds[side]
        if abs(bound) >= 1e100:
            raise ValueError("an edge loop runs around the surface, and nothing bounds the face on its inner side")
        start, end = loop[0].start, loop[-1].end
        lifted = [(point[0], bound) if axis == 0 else (bound, point[1]) for point in (end, start)]
        result.append([*loop, Stretch(-1, lifted[0], lifted[1])])
    return result


def _brought_near(loop: list[Stretch], end: Point, space: ParameterSpace) -> list[Stretch]:
    """The loop moved by whole periods to start near `end`."""
    start = loop[0].start
    du, dv = (
        period * round((end[axis] - start[axis]) / period) if period else 0.0
        for axis, period in enumerate(space.periods)
    )
    return [_moved(stretch, (du, dv)) for stretch in loop] if du or dv else loop
