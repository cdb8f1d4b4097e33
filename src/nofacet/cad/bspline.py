"""B-splines to Bezier pieces by blossoming (Ramshaw 1989), exact up to rounding and vectorised over spans.

The Bezier points of a polynomial piece over [a, b] are its blossom values f(a, .., a, b, .., b). They come from the
B-spline's poles d_i = f(t_{k-p+1+i}, .., t_{k+i}) in two triangles: first a replaces the knots left of the span, then
b replaces those right of it. Neither needs a and b to be knots, so cutting to a box and continuing the end spans
beyond the domain are the same operation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# A span narrower than this part of the wanted interval is dropped and its neighbour continued across it: real files
# hold spans of 2.5e-12 of the range (two writers' rounding of one knot), which no image can show.
SLIVER = 1e-11


@dataclass(frozen=True)
class Spans:
    """The polynomial spans that meet an interval, m of them.

    knots: (m, 2 p), t_{k-p+1} .. t_{k+p} around each span; poles: (m, p + 1), the poles each span depends on;
    cuts: (m + 1,), the wanted interval cut at the knots.
    """

    knots: Array
    poles: NDArray[np.int64]
    cuts: Array


def spans(
    degree: int, knots: Array, multiplicities: NDArray[np.int32], periodic: bool, low: float, high: float
) -> Spans:
    """The spans that [low, high] meets; the end spans are continued where it leaves a domain that is not periodic.

    knots (k,) strictly increasing with multiplicities (k,), OpenCascade's conventions: in a periodic spline the first
    and the last knot are the same place, and pole 0 belongs to the span that starts at the last copy of the first knot.
    """
    if periodic:
        flat, pole_count, first_pole = _unroll(degree, knots, multiplicities, low, high)
    else:
        flat, first_pole = np.repeat(knots, multiplicities), 0
        pole_count = len(flat) - degree - 1
    inside = np.arange(degree, len(flat) - degree - 1)
    left, right = flat[inside], flat[inside + 1]
    sliver = SLIVER * (high - low)
    wanted = inside[(right - left > sliver) & (right > low + sliver) & (left < high - sliver)]
    cuts = np.append(low, np.append(flat[wanted[1:]], high))
    if len(wanted) == 0:  # the interval lies outside the domain, or between two knots a sliver apart
        filled = inside[right > left]
        wanted = filled[-1:] if low >= flat[filled[-1]] else filled[:1]
        middle = 0.5 * float(flat[wanted[0]] + flat[wanted[0] + 1])
        cuts = np.array([min(low, middle), max(high, middle)])  # blossoming needs one end inside the span
    around = np.arange(1 - degree, degree + 1)
    poles = wanted[:, None] + np.arange(-degree, 1) + first_pole
    return Spans(flat[wanted[:, None] + around], poles % pole_count, cuts)


def _unroll(
    degree: int, knots: Array, multiplicities: NDArray[np.int32], low: float, high: float
) -> tuple[Array, int, int]:
    """Flat knots of a periodic spline over all periods that [low, high] touches, pole count, pole of flat knot 0."""
    once = np.repeat(knots[:-1], multiplicities[:-1])
    count, period = len(once), knots[-1] - knots[0]
    first_period = int(np.floor((low - knots[0]) / period))
    last_period = int(np.ceil((high - knots[0]) / period))
    # flat knot p is the last copy of the first knot; one period and the degree are added at both ends
    index = np.arange((first_period - 1) * count, (last_period + 1) * count + 2 * degree + 2)
    shifted = index - degree + int(multiplicities[0]) - 1
    return once[shifted % count] + period * (shifted // count), count, int(index[0])


def bezier_points(poles: Array, knots: Array, start: Array, stop: Array) -> Array:
    """Bezier points of m polynomial pieces of degree p over [start, stop].

    poles: (m, p + 1, ...) control points of each piece's span; knots: (m, 2 p) as in Spans; start, stop: (m,).
    Returns (m, p + 1, ...).
    """
    degree = poles.shape[1] - 1
    if (knots[:, :degree] == start[:, None]).all() and (knots[:, degree:] == stop[:, None]).all():
        return poles
    extra = (1,) * (poles.ndim - 2)
    t = knots.reshape(*knots.shape, *extra)
    a = start.reshape(-1, 1, *extra)
    b = stop.reshape(-1, 1, *extra)
    current = poles
    points = np.empty_like(poles)
    points[:, degree] = current[:, -1]
    for r in range(1, degree + 1):  # f(a^r, t_{k-p+1+i} .. t_{k+i-r}) for i = r .. p
        low, high = t[:, r - 1 : degree], t[:, degree : 2 * degree - r + 1]
        s = (a - low) / (high - low)
        current = (1 - s) * current[:, :-1] + s * current[:, 1:]
        points[:, degree - r] = current[:, -1]
    current = points.copy()  # f(a^(p-i), t_{k+1} .. t_{k+i})
    for r in range(1, degree + 1):  # f(a^(p-i), b^r, t_{k+1} .. t_{k+i-r}) for i = r .. p
        high = t[:, degree : 2 * degree - r + 1]
        s = (b - a) / (high - a)
        current = (1 - s) * current[:, :-1] + s * current[:, 1:]
        points[:, r] = current[:, 0]
    return points


def curve_pieces(
    degree: int,
    poles: Array,
    knots: Array,
    multiplicities: NDArray[np.int32],
    periodic: bool,
    low: float,
    high: float,
) -> tuple[Array, Array]:
    """Bezier pieces (m, p + 1, c) of a curve with poles (n, c) over [low, high], the parameters (m + 1,) between."""
    where = spans(degree, knots, multiplicities, periodic, low, high)
    return bezier_points(poles[where.poles], where.knots, where.cuts[:-1], where.cuts[1:]), where.cuts


def surface_pieces(
    degrees: tuple[int, int],
    poles: Array,
    knots: tuple[Array, Array],
    multiplicities: tuple[NDArray[np.int32], NDArray[np.int32]],
    periodic: tuple[bool, bool],
    box: tuple[float, float, float, float],
) -> tuple[Array, Array, Array]:
    """Bezier patches (mu, mv, du + 1, dv + 1, c) of a surface with poles (nu, nv, c) over box = (u0, u1, v0, v1).

    Also returns the parameters between the patches, (mu + 1,) and (mv + 1,).
    """
    u = spans(degrees[0], knots[0], multiplicities[0], periodic[0], box[0], box[1])
    v = spans(degrees[1], knots[1], multiplicities[1], periodic[1], box[2], box[3])
    rows = bezier_points(poles[u.poles], u.knots, u.cuts[:-1], u.cuts[1:])  # (mu, du + 1, nv, c)
    columns = np.moveaxis(rows, 2, 0)[v.poles]  # (mv, dv + 1, mu, du + 1, c)
    patches = bezier_points(columns, v.knots, v.cuts[:-1], v.cuts[1:])
    return np.ascontiguousarray(patches.transpose(2, 0, 3, 1, 4)), u.cuts, v.cuts
