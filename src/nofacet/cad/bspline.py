"""B-splines to Bezier pieces by blossoming (Ramshaw 1989), exact up to rounding, many splines at once.

The Bezier points of a polynomial piece over [a, b] are its blossom values f(a, .., a, b, .., b). They come from the
B-spline's poles d_i = f(t_{k-p+1+i}, .., t_{k+i}) in two triangles: first a replaces the knots left of the span, then
b replaces those right of it (src/native/extract/blossom.h). Neither needs a and b to be knots, so cutting to a box and
continuing the end spans beyond the domain are the same operation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .tables import Index, expand, offsets_of

Array = NDArray[np.float64]

# A span narrower than this part of the wanted interval is dropped and its neighbour continued across it: real files
# hold spans of 2.5e-12 of the range (two writers' rounding of one knot), which no image can show.
SLIVER = 1e-11


@dataclass(frozen=True)
class KnotVectors:
    """The flat knots of n splines: those of spline k are flat[offsets[k] : offsets[k + 1]].

    A span that starts at flat knot j of its own spline depends on the degree + 1 poles from j - degree + first_pole,
    modulo pole_count. degree, first_pole, pole_count: (n,).
    """

    degree: Index
    flat: Array
    offsets: Index
    first_pole: Index
    pole_count: Index


@dataclass(frozen=True)
class Spans:
    """Polynomial spans that intervals meet, m of them, ordered by interval and parameter.

    owner: (m,), the interval; spline: (m,), its spline; flat: (m,), the place of the flat knot where the span starts;
    start, stop: (m,), the ends of the Bezier piece wanted.
    """

    owner: Index
    spline: Index
    flat: Index
    start: Array
    stop: Array


def knot_vectors(
    degree: NDArray[Any], knots: NDArray[Any], counts: NDArray[Any], periodic: NDArray[Any], low: Array, high: Array
) -> KnotVectors:
    """Flat knots of splines, those of a periodic one over all periods that [low, high] touches.

    degree, periodic, low, high: (n,); knots: records (knot, multiplicity) of all splines, `counts` (n,) of each,
    strictly increasing. OpenCascade's conventions: in a periodic spline the first and the last knot are the same place,
    and pole 0 belongs to the span that starts at the last copy of the first knot.
    """
    flat = np.repeat(knots["knot"], knots["multiplicity"])
    ends = offsets_of(counts)
    offsets = offsets_of(knots["multiplicity"])[ends]
    first_pole = np.zeros(len(counts), np.intp)
    pole_count = np.diff(offsets) - degree - 1
    if not periodic.any():
        return KnotVectors(degree, flat, offsets, first_pole, pole_count)
    parts = [flat[i:j] for i, j in zip(offsets, offsets[1:], strict=False)]
    for k in np.flatnonzero(periodic):
        own = knots[ends[k] : ends[k + 1]]
        parts[k], pole_count[k], first_pole[k] = _unroll(
            int(degree[k]), own["knot"], own["multiplicity"], float(low[k]), float(high[k])
        )
    lengths = np.array([len(part) for part in parts])
    return KnotVectors(degree, np.concatenate(parts), offsets_of(lengths), first_pole, pole_count)


def ranges(which: Index, low: Array, high: Array) -> tuple[Array, Array]:
    """For each spline 0, 1, .. the range of all its intervals [low, high] (n,), which (n,) naming the spline."""
    count = int(which.max()) + 1
    lowest, highest = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(lowest, which, low)
    np.maximum.at(highest, which, high)
    return lowest, highest


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


def spans(vectors: KnotVectors, which: Index, low: Array, high: Array) -> Spans:
    """The spans that the intervals [low, high] (n,) of the splines `which` (n,) meet; end spans are continued where an
    interval leaves the domain."""
    flat, offsets = vectors.flat, vectors.offsets
    place = np.flatnonzero(flat[1:] > flat[:-1])
    spline = np.searchsorted(offsets, place, side="right") - 1
    degree = vectors.degree[spline]
    inside = (place >= offsets[spline] + degree) & (place < offsets[spline + 1] - degree - 1)
    place, spline = place[inside], spline[inside]
    owner, candidate = expand(offsets_of(np.bincount(spline, minlength=len(offsets) - 1)), which)
    place = place[candidate]
    left, right = flat[place], flat[place + 1]
    sliver = SLIVER * (high - low)
    begin, end = (low + sliver)[owner], (high - sliver)[owner]
    wanted = np.flatnonzero((right - left > sliver[owner]) & (right > begin) & (left < end))
    owner, place, start = owner[wanted], place[wanted], left[wanted]
    lost = np.flatnonzero(np.bincount(owner, minlength=len(low)) == 0)
    change = owner[1:] != owner[:-1]
    first, last = np.append(True, change)[: len(owner)], np.append(change, True)[: len(owner)]
    start = np.where(first, low[owner], start)
    stop = np.where(last, high[owner], np.append(start[1:], 0.0)[: len(owner)])
    if not len(lost):
        return Spans(owner, which[owner], place, start, stop)
    rows = [_span_outside(vectors, int(which[k]), float(low[k]), float(high[k])) for k in lost]
    owner, place = np.append(owner, lost), np.append(place, [row[0] for row in rows])
    start, stop = np.append(start, [row[1] for row in rows]), np.append(stop, [row[2] for row in rows])
    order = np.argsort(owner, kind="stable")
    return Spans(owner[order], which[owner[order]], place[order], start[order], stop[order])


def _span_outside(vectors: KnotVectors, k: int, low: float, high: float) -> tuple[int, float, float]:
    """The span for an interval that lies outside the domain of spline k, or between two knots a sliver apart."""
    degree = int(vectors.degree[k])
    places = np.arange(vectors.offsets[k] + degree, vectors.offsets[k + 1] - degree - 1)
    filled = places[vectors.flat[places + 1] > vectors.flat[places]]
    place = int(filled[-1] if low >= vectors.flat[filled[-1]] else filled[0])
    middle = 0.5 * float(vectors.flat[place] + vectors.flat[place + 1])
    return place, min(low, middle), max(high, middle)  # blossoming needs one end inside the span


def knots_and_poles(vectors: KnotVectors, spans: Spans, which: Index, degree: int) -> tuple[Array, Index]:
    """For the spans `which` (m,), of splines of one degree p: the knots around each (2 p, m), and the numbers
    (p + 1, m) of the poles that each depends on."""
    spline, flat = spans.spline[which], spans.flat[which]
    around = vectors.flat[flat + np.arange(1 - degree, degree + 1)[:, None]]
    first = flat - vectors.offsets[spline] - degree + vectors.first_pole[spline]
    return around, (first + np.arange(degree + 1)[:, None]) % vectors.pole_count[spline]


def bezier_points(poles: Array, knots: Array, start: Array, stop: Array) -> Array:
    """Bezier points (..., p + 1, m) of m polynomial pieces of degree p over [start, stop].

    poles: (..., p + 1, m) control points of each piece's span, which may become the result; knots: (2 p, m),
    t_{k-p+1} .. t_{k+p} around the span; start, stop: (m,).
    """
    points = np.ascontiguousarray(poles)
    _native.bezier_points(points.reshape(-1, *points.shape[-2:]), knots, start, stop)
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
    records = np.empty(len(knots), [("knot", "<f8"), ("multiplicity", "<i4")])
    records["knot"], records["multiplicity"] = knots, multiplicities
    ends = np.array([low]), np.array([high])
    vectors = knot_vectors(np.array([degree]), records, np.array([len(knots)]), np.array([periodic]), *ends)
    own = spans(vectors, np.array([0]), *ends)
    around, numbers = knots_and_poles(vectors, own, np.arange(len(own.owner)), degree)
    points = bezier_points(np.moveaxis(poles[numbers], 2, 0), around, own.start, own.stop)
    return np.ascontiguousarray(points.transpose(2, 1, 0)), np.append(own.start, own.stop[-1])
