"""Curves to rational Bezier pieces, many at once: exact for lines, conics and splines, adaptive for offset curves."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .bspline import curve_pieces
from .geometry import Curve
from .records import BSPLINE, CIRCLE, ELLIPSE, LINE, Curves, gather_reals
from .tables import Index

Array = NDArray[np.float64]

ANGLE_LIMIT = 100 * pi / 180  # of one piece of a circle or ellipse; weights stay above 0.64
HYPERBOLIC_LIMIT = 2.0  # of one piece of a hyperbola; weights stay below 1.6


@dataclass(frozen=True)
class Cuts:
    """Intervals in pieces: owner (m,), the interval, sorted; start, stop (m,), the piece's ends."""

    owner: Index
    start: Array
    stop: Array


def cut_evenly(low: Array, high: Array, limit: float) -> Cuts:
    """Each interval [low, high] (n,) in equal pieces of at most `limit`; a billionth of a piece too many is none."""
    return Cuts(*_native.cut_evenly(low, high, limit))


@dataclass(frozen=True)
class Pieces:
    """Rational Bezier pieces of one degree p, sorted by owner and, for each owner, by parameter.

    owner: (m,); start, stop: (m,), the curve's parameters at the ends; points: (m, p + 1, dim + 1) homogeneous, the
    end weights of conics' and lines' pieces being 1.
    """

    owner: Index
    start: Array
    stop: Array
    points: Array


def pieces(curves: Curves, which: Index, first: Array, last: Array) -> list[Pieces]:
    """Pieces of the curves `which` (n,) over [first, last] (n,); the owner is the place in `which`.

    Every owner's pieces are in one of the results. An offset curve is approximated within 1e-10 of its own extent.
    """
    result = []
    kinds = curves.kind[which]
    present = np.bincount(kinds)
    for kind in np.flatnonzero(present).tolist():
        owner = np.flatnonzero(kinds == kind)
        wanted = (curves, which[owner], first[owner], last[owner])
        if kind == LINE:
            parts = [_lines(*wanted)]
        elif kind in (CIRCLE, ELLIPSE):
            parts = [_arcs(*wanted, kind)]
        elif kind == BSPLINE:
            parts = _splines(*wanted)
        else:
            parts = _others(*wanted)
        result += [Pieces(owner[part.owner], part.start, part.stop, part.points) for part in parts]
    return result


def _lines(curves: Curves, which: Index, first: Array, last: Array) -> Pieces:
    numbers = gather_reals(curves.data, curves.at[which], 2 * curves.dim)
    origin, direction = numbers[:, None, : curves.dim], numbers[:, None, curves.dim :]
    points = np.ones((len(which), 2, curves.dim + 1))
    points[..., :-1] = origin + np.stack([first, last], axis=1)[..., None] * direction
    return Pieces(np.arange(len(which)), first, last, points)


def _arcs(curves: Curves, which: Index, first: Array, last: Array, kind: int) -> Pieces:
    dim = curves.dim
    skipped = 3 if dim == 3 else 0  # the normal
    numbers = gather_reals(curves.data, curves.at[which], 3 * dim + skipped + (1 if kind == CIRCLE else 2))
    origin, x, y = (numbers[:, k : k + dim] for k in (0, dim + skipped, 2 * dim + skipped))
    a, b = numbers[:, 3 * dim + skipped, None] * x, numbers[:, -1, None] * y
    cuts = cut_evenly(first, last, ANGLE_LIMIT)
    cosine, sine, weight = unit_arcs(cuts.start, cuts.stop)
    points = np.empty((len(cuts.owner), 3, dim + 1))
    points[..., -1] = weight
    center, a, b = (vector[cuts.owner, None] for vector in (origin, a, b))
    points[..., :-1] = weight[..., None] * center + cosine[..., None] * a + sine[..., None] * b
    return Pieces(cuts.owner, cuts.start, cuts.stop, points)


def unit_arcs(start: Array, stop: Array) -> tuple[Array, Array, Array]:
    """Homogeneous control points (cosine, sine, weight), each (n, 3), of the unit circle's arcs [start, stop]."""
    angle = np.stack([start, 0.5 * (start + stop), stop], axis=1)
    weight = np.ones_like(angle)
    weight[:, 1] = np.cos(0.5 * (stop - start))
    return np.cos(angle), np.sin(angle), weight


def _splines(curves: Curves, which: Index, first: Array, last: Array) -> list[Pieces]:
    return [Pieces(*part) for part in _native.spline_pieces(curves.data, curves.dim, curves.at[which], first, last)]


def _others(curves: Curves, which: Index, first: Array, last: Array) -> list[Pieces]:
    """The rare kinds, one curve at a time."""
    result = []
    for owner, (index, low, high) in enumerate(zip(which.tolist(), first.tolist(), last.tolist(), strict=True)):
        points, cuts = curve_of_rare_kind(curves[index], low, high)
        result.append(Pieces(np.full(len(points), owner), cuts[:-1], cuts[1:], points))
    return result


def curve_of_rare_kind(curve: Curve, first: float, last: float) -> tuple[Array, Array]:
    """Pieces (m, p + 1, dim + 1) of a parabola, hyperbola, Bezier or offset curve, the parameters (m + 1,) between."""
    if curve.kind == "offset":
        from .offset import offset_pieces

        return offset_pieces(curve, first, last)
    if curve.kind == "bezier":
        return spline_pieces(curve, first, last)
    origin, a, b = (np.array(vector) for vector in (curve.origin, curve.a, curve.b))
    if curve.kind == "parabola":
        squares, middles = np.array([first**2, first * last, last**2]), np.array([first, 0.5 * (first + last), last])
        return _weighted(origin + np.outer(squares, a) + np.outer(middles, b))[None], np.array([first, last])
    cuts = cut_evenly(np.array([first]), np.array([last]), HYPERBOLIC_LIMIT)
    t = np.stack([cuts.start, 0.5 * (cuts.start + cuts.stop), cuts.stop], axis=1)[..., None]
    weight = np.ones_like(t)
    weight[:, 1, 0] = np.cosh(0.5 * (cuts.stop - cuts.start))
    points = np.concatenate([weight * origin + np.cosh(t) * a + np.sinh(t) * b, weight], axis=-1)
    return points, np.append(cuts.start, last)


def _weighted(points: Array) -> Array:
    return np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1)


def spline_pieces(curve: Curve, first: float, last: float) -> tuple[Array, Array]:
    """Pieces (m, p + 1, dim + 1) of one Bezier or B-spline curve, and the parameters (m + 1,) between."""
    assert curve.poles is not None
    if curve.kind == "bezier":
        knots, multiplicities = np.array([0.0, 1.0]), np.full(2, curve.degree + 1, np.int32)
    else:
        assert curve.knots is not None and curve.multiplicities is not None
        knots, multiplicities = curve.knots, curve.multiplicities
    points, cuts = curve_pieces(curve.degree, curve.poles, knots, multiplicities, curve.periodic, first, last)
    if not curve.rational:
        points[..., -1] = 1.0
    return points, cuts
