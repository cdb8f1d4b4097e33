"""Trim loops made whole where neighbouring edges do not meet.

Gaps of the size of rounding are moved away. Wider ones are corners that the two edges overshot or fell short of: a
straight link between the ends would add or take away a triangle there. So the corner is looked for on both edges and
on their tangents beyond the ends: a crossing of the edges themselves, else the crossing nearest to the two ends, if it
is near at all. An edge is cut at the corner, or led on to it by a straight segment. Where there is none (edges that
run on side by side, missing edges) the straight link remains.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import hypot, inf

from .geometry import Vector
from .loops import SNAP, Loop, ParameterSpace, Segment, reverse

Points = list[Vector]
Plane = tuple[float, float]
Place = tuple[int, float]  # a segment of a run and a parameter of it
Tail = list[tuple[int | None, Points]]  # segments with their places in a run; None: the tangent beyond its end
Corner = tuple[Vector, Place | None, Place | None]  # the point, and where the two runs are cut if they are

# Gaps below this part of the box stay straight: no picture shows them, and where curves all but touch, their crossing
# would be rounding. Gaps beyond the other part are missing edges, not corners.
NARROWEST, WIDEST = 1e-7, 0.1
# A corner lies within this many gap widths of both ends: where the edges themselves cross, and where tangents do.
CROSSING_REACH = 30.0
REACH = 2.0
# A tangent longer than this part of the other edge's overshoot is no corner: the link is as good.
SHORT = 0.2
# Tangents that together are less than this many gap widths long run along the link: the link is as good.
DETOUR = 1.1
# A corner within this part of the gap from an end is that end.
SAME = 1e-6
# Curves that stray from their chord by less than this part of it are straight for a first guess.
FLAT = 0.02
# Directions whose cross product is this small beside its terms are parallel.
PARALLEL = 1e-12
# Pairs of parts looked at for crossings of two segments: edges that run on top of each other would take for ever.
PAIRS = 400


def weld(loop: Loop, width: float, height: float, space: ParameterSpace) -> Loop:
    """The loop with neighbouring segments, the last and the first too, sharing their end points bitwise.

    width, height: the face's box. space: tells the gaps that are a missing edge along a pole, which stay straight.
    """
    runs = _runs(loop, SNAP * width, SNAP * height)
    end, start = runs[-1][-1][0][-1], runs[0][0][0][0]
    if start != end and _near(start, end, SNAP * width, SNAP * height) and len(loop) > 1:
        points, edge = runs[-1][-1]
        runs[-1][-1] = ([*points[:-1], start], edge)
        end = start
    closed, scale = start == end, (1 / width, 1 / height)
    if closed and len(runs) == 1:
        return runs[0]
    if len(runs) == 1:  # a single gap: both its sides are the same run
        half = len(loop) // 2
        if not half:
            return [*loop, ([end, start], -1)]
        after, before = runs[0][:half], runs[0][half:]
        before, between, after = _joined(before, after, scale, space)
        return [*after, *before, *between]
    links: list[list[Segment]] = [[] for _ in runs]
    for k in range(len(runs) - 1 if closed else len(runs)):
        following = (k + 1) % len(runs)
        runs[k], links[k], runs[following] = _joined(runs[k], runs[following], scale, space)
    return [segment for run, between in zip(runs, links, strict=True) for segment in (*run, *between)]


def _runs(loop: Loop, du: float, dv: float) -> list[Loop]:
    """The loop's segments up to each gap, small gaps moved away."""
    runs: list[Loop] = [[loop[0]]]
    end = loop[0][0][-1]
    for points, edge in loop[1:]:
        start = points[0]
        if start != end:
            if _near(start, end, du, dv):
                points = [end, *points[1:]]
            else:
                runs.append([])
        runs[-1].append((points, edge))
        end = points[-1]
    return runs


def _near(one: Vector, other: Vector, du: float, dv: float) -> bool:
    return abs(one[0] - other[0]) <= du and abs(one[1] - other[1]) <= dv


@dataclass(frozen=True)
class _Gap:
    """The two ends that do not meet, their distance, and 1 / width, 1 / height of the box that lengths are parts of."""

    ends: tuple[Vector, Vector]
    scale: tuple[float, float]

    @cached_property
    def width(self) -> float:
        return self.length(*self.ends)

    def lengths(self, point: Vector) -> tuple[float, float]:
        """Distances of a point from the two ends."""
        return self.length(point, self.ends[0]), self.length(point, self.ends[1])

    def length(self, one: Vector, other: Vector) -> float:
        """Distance of two homogeneous points in parts of the box."""
        return hypot(
            (one[0] / one[2] - other[0] / other[2]) * self.scale[0],
            (one[1] / one[2] - other[1] / other[2]) * self.scale[1],
        )


def _joined(
    before: Loop, after: Loop, scale: tuple[float, float], space: ParameterSpace
) -> tuple[Loop, list[Segment], Loop]:
    """The runs on both sides of a gap, cut at their corner, and the segments that lead from the first to the second."""
    # seen from the gap, the run that follows is another one that ends there
    other = reverse(after)
    end, start = before[-1][0][-1], other[-1][0][-1]
    gap = _Gap((end, start), scale)
    along_pole = any(space.collapsed(axis, point[axis]) for axis in (0, 1) for point in gap.ends)
    corner = None if along_pole or not NARROWEST <= gap.width <= WIDEST else _corner(before, other, gap)
    if corner is None:
        return before, [([end, start], -1)], after
    point, one, two = corner
    between: list[Segment] = []
    if one is not None:
        before = _cut(before, one, point)
    elif point != end:
        between.append(([end, point], -1))
    if two is not None:
        after = reverse(_cut(other, two, point))
    elif point != start:
        between.append(([point, start], -1))
    return before, between, after


def _corner(one: Loop, two: Loop, gap: _Gap) -> Corner | None:
    """Where two runs that end at a gap meet, and the places to cut each at: None for a run that ends short of it."""
    tails = [_tail(run, gap) for run in (one, two)]
    corners = list(_corners(tails[0], tails[1], gap, CROSSING_REACH))
    if not corners:
        tangents = [_tangent(run[-1][0], gap) for run in (one, two)]
        corners = list(_corners(tangents[0], tangents[1], gap, REACH))
        corners = [corner for corner in corners if sum(gap.lengths(corner[0])) >= DETOUR * gap.width]
        for over, short in ((0, 1), (1, 0)):
            pair = [tails[k] if k == over else tangents[k] for k in (0, 1)]
            for corner in _corners(pair[0], pair[1], gap, REACH):
                lengths = gap.lengths(corner[0])
                if lengths[short] <= SHORT * lengths[over]:
                    corners.append(corner)
    if not corners:
        return None
    point, cut_one, cut_two = min(corners, key=lambda corner: sum(gap.lengths(corner[0])))
    lengths = gap.lengths(point)
    if lengths[0] <= SAME * gap.width:
        return gap.ends[0], None, cut_two
    if lengths[1] <= SAME * gap.width:
        return gap.ends[1], cut_one, None
    return point, cut_one, cut_two


def _tail(run: Loop, gap: _Gap) -> Tail:
    """The segments of the run's last edge that can hold a corner, the last one first."""
    end, edge = run[-1][0][-1], run[-1][1]
    tail: Tail = []
    for place in range(len(run) - 1, -1, -1):
        points, number = run[place]
        if number != edge:
            break
        tail.append((place, points))
        if gap.length(points[0], end) > CROSSING_REACH * gap.width:
            break
    return tail


def _tangent(points: Points, gap: _Gap) -> Tail:
    """The straight segment that leads on from a curve's end as far as a corner may lie."""
    end = points[-1]
    for point in points[-2::-1]:
        length = gap.length(point, end)
        if length > SNAP:
            factor = 1.01 * REACH * gap.width / length
            du, dv = end[0] - point[0] / point[2], end[1] - point[1] / point[2]
            return [(None, [end, (end[0] + factor * du, end[1] + factor * dv, 1.0)])]
    return []


def _corners(one: Tail, two: Tail, gap: _Gap, reach: float) -> Iterator[Corner]:
    """Crossings at most `reach` gap widths from both ends."""
    for i, p in one:
        for j, q in two:
            for s, t in _crossings(p, q, gap):
                point = (*_point_and_derivative(p, s)[0], 1.0)
                if max(gap.lengths(point)) <= reach * gap.width:
                    yield point, None if i is None else (i, s), None if j is None else (j, t)


def _crossings(one: Points, two: Points, gap: _Gap) -> Iterator[tuple[float, float]]:
    """Parameters of the points where two rational Bezier segments cross."""
    stack = [(one, 0.0, 1.0, two, 0.0, 1.0)]
    for _ in range(PAIRS):
        if not stack:
            return
        p, s0, s1, q, t0, t1 = stack.pop()
        if _apart(p, q):
            continue
        bend_p, bend_q = _bend(p, gap), _bend(q, gap)
        if max(bend_p, bend_q) <= FLAT:
            guess = _step(*_chord(p), *_chord(q))
            if guess and all(-0.1 <= part <= 1.1 for part in guess):
                found = _polished(one, two, s0 + guess[0] * (s1 - s0), t0 + guess[1] * (t1 - t0))
                if found:
                    yield found
        elif bend_p >= bend_q:
            middle = 0.5 * (s0 + s1)
            low, high = _split(p, 0.5)
            stack += [(high, middle, s1, q, t0, t1), (low, s0, middle, q, t0, t1)]
        else:
            middle = 0.5 * (t0 + t1)
            low, high = _split(q, 0.5)
            stack += [(p, s0, s1, high, middle, t1), (p, s0, s1, low, t0, middle)]


def _polished(one: Points, two: Points, s: float, t: float) -> tuple[float, float] | None:
    """Newton's method from a guess at a crossing's parameters; None where it leaves the segments or does not settle."""
    for _ in range(12):
        step = _step(*_point_and_derivative(one, s), *_point_and_derivative(two, t))
        if step is None:
            return None
        s, t = s + step[0], t + step[1]
        if not (-0.5 <= s <= 1.5 and -0.5 <= t <= 1.5):
            return None
        if max(abs(step[0]), abs(step[1])) <= 1e-13:
            inside = -1e-9 <= s <= 1 + 1e-9 and -1e-9 <= t <= 1 + 1e-9
            return (min(max(s, 0.0), 1.0), min(max(t, 0.0), 1.0)) if inside else None
    return None


def _step(p: Plane, dp: Plane, q: Plane, dq: Plane) -> Plane | None:
    """s, t with p + s dp = q + t dq; None for parallel directions."""
    determinant = dp[1] * dq[0] - dp[0] * dq[1]
    if abs(determinant) <= PARALLEL * (abs(dp[1] * dq[0]) + abs(dp[0] * dq[1])):
        return None
    du, dv = q[0] - p[0], q[1] - p[1]
    return (dv * dq[0] - du * dq[1]) / determinant, (dv * dp[0] - du * dp[1]) / determinant


def _chord(points: Points) -> tuple[Plane, Plane]:
    """The first point and the way from there to the last."""
    (u0, v0, w0), (u1, v1, w1) = points[0], points[-1]
    u0, v0 = u0 / w0, v0 / w0
    return (u0, v0), (u1 / w1 - u0, v1 / w1 - v0)


def _point_and_derivative(points: Points, t: float) -> tuple[Plane, Plane]:
    """Of a rational Bezier segment at t, where the weight is not 0; t may lie outside [0, 1]."""
    degree = len(points) - 1
    while len(points) > 2:
        points = _between(points, t)
    (u0, v0, w0), (u1, v1, w1) = points
    ((u, v, w),) = _between(points, t)
    factor = degree * w0 * w1 / (w * w)
    return (u / w, v / w), (factor * (u1 / w1 - u0 / w0), factor * (v1 / w1 - v0 / w0))


def _between(points: Points, t: float) -> Points:
    """One step of de Casteljau's algorithm."""
    r = 1.0 - t
    return [
        (r * u0 + t * u1, r * v0 + t * v1, r * w0 + t * w1)
        for (u0, v0, w0), (u1, v1, w1) in zip(points, points[1:], strict=False)
    ]


def _split(points: Points, t: float) -> tuple[Points, Points]:
    """The parts of a Bezier segment up to t and from t on."""
    low, high = [points[0]], [points[-1]]
    while len(points) > 1:
        points = _between(points, t)
        low.append(points[0])
        high.append(points[-1])
    return low, high[::-1]


def _cut(run: Loop, place: Place, point: Vector) -> Loop:
    """The run up to a place, its last point set to `point`, which is that place but for rounding."""
    index, t = place
    points, edge = run[index]
    points = _split(points, t)[0]
    # a Moebius change of parameter makes the end weight 1 and leaves the curve as it is
    ratio = points[-1][2] ** (-1 / (len(points) - 1))
    points = [(u * ratio**k, v * ratio**k, w * ratio**k) for k, (u, v, w) in enumerate(points)]
    return [*run[:index], ([*points[:-1], point], edge)]


def _apart(one: Points, two: Points) -> bool:
    """Whether the boxes of the control points do not touch."""
    for axis in (0, 1):
        a, b = ([p[axis] / p[2] for p in points] for points in (one, two))
        if min(a) > max(b) or max(a) < min(b):
            return True
    return False


def _bend(points: Points, gap: _Gap) -> float:
    """How far the control points are from even spacing along the chord, in parts of its length: 0 for a line."""
    degree = len(points) - 1
    if degree == 1:
        return 0.0
    (u0, v0), (du, dv) = _chord(points)
    chord = gap.length(points[0], points[-1])
    off = max(gap.length((u0 + k / degree * du, v0 + k / degree * dv, 1.0), points[k]) for k in range(1, degree))
    return off / chord if chord else inf
