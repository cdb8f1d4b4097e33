"""Offset curves: not rational, so interpolated by Bezier pieces that are halved until they are close enough."""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from .geometry import Curve

Array = NDArray[np.float64]

TOLERANCE = 1e-10  # distance of the pieces from the offset curve, in parts of its extent
DEGREE = 7  # of the pieces: high, because offsets of smooth curves are smooth
DEPTH = 24  # halvings at most: a kink of the basis curve cannot be interpolated and stops here


def offset_pieces(curve: Curve, first: float, last: float) -> tuple[Array, Array]:
    """Polynomial Bezier pieces (m, p + 1, dim + 1) of an offset curve over [first, last], the parameters (m + 1,)."""
    ends = [first, *_kinks(curve, first, last), last]
    sample = _evaluate(curve, np.linspace(first, last, 65))
    tolerance = TOLERANCE * float(np.ptp(sample, axis=0).max())
    result = []
    cuts = [first]
    work = [(a, b, DEPTH) for a, b in zip(ends, ends[1:], strict=False)][::-1]
    while work:
        a, b, depth = work.pop()
        points = _interpolate(_evaluate(curve, a + (b - a) * _nodes()))
        t = np.linspace(0.0, 1.0, 2 * DEGREE + 2)[1:-1]
        error = np.abs(_bernstein(t) @ points - _evaluate(curve, a + (b - a) * t)).max()
        if error > tolerance and depth:
            middle = 0.5 * (a + b)
            work += [(middle, b, depth - 1), (a, middle, depth - 1)]
            continue
        result.append(np.column_stack([points, np.ones(len(points))]))
        cuts.append(b)
    return np.array(result), np.array(cuts)


def _evaluate(curve: Curve, t: Array) -> Array:
    """Points (n, dim) of the offset curve: the basis point moved along the normal, right of the tangent in 2-D,
    tangent x direction in 3-D."""
    assert curve.basis is not None
    point, tangent = evaluate(curve.basis, t)
    normal = np.cross(tangent, curve.b) if curve.b else tangent[:, ::-1] * (1.0, -1.0)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.asarray(point + curve.offset * normal / np.where(length > 0, length, 1.0))


def evaluate(curve: Curve, t: Array) -> tuple[Array, Array]:
    """Points and first derivatives, both (n, dim), of a curve at its parameters t (n,)."""
    column = t[:, None]
    origin, a, b = (np.array(v) for v in (curve.origin, curve.a, curve.b))
    if curve.kind == "line":
        return origin + column * b, np.broadcast_to(b, (len(t), len(b)))
    if curve.kind == "parabola":
        return origin + column**2 * a + column * b, 2 * column * a + b
    if curve.kind in ("circle", "ellipse"):
        c, s = np.cos(column), np.sin(column)
        return origin + c * a + s * b, c * b - s * a
    if curve.kind == "hyperbola":
        c, s = np.cosh(column), np.sinh(column)
        return origin + c * a + s * b, s * a + c * b
    if curve.kind == "offset":
        step = 1e-6 * (float(np.ptp(t)) or 1.0)
        return _evaluate(curve, t), (_evaluate(curve, t + step) - _evaluate(curve, t - step)) / (2 * step)
    return _evaluate_spline(curve, t)


def _evaluate_spline(curve: Curve, t: Array) -> tuple[Array, Array]:
    from .curves import spline_pieces

    pieces, cuts = spline_pieces(curve, float(t.min()), max(float(t.max()), float(t.min()) + 1e-12))
    which = np.clip(np.searchsorted(cuts, t, side="right") - 1, 0, len(pieces) - 1)
    width = (cuts[1:] - cuts[:-1])[which][:, None]
    s = (t[:, None] - cuts[which][:, None]) / width
    level = pieces[which]
    while level.shape[1] > 2:
        level = (1 - s[..., None]) * level[:, :-1] + s[..., None] * level[:, 1:]
    degree = pieces.shape[1] - 1
    value = (1 - s) * level[:, 0] + s * level[:, 1]
    slope = degree * (level[:, 1] - level[:, 0]) / width
    point = value[:, :-1] / value[:, -1:]
    return point, (slope[:, :-1] - point * slope[:, -1:]) / value[:, -1:]


def _kinks(curve: Curve, first: float, last: float) -> list[float]:
    """The basis curve's knots inside the interval, where its derivatives may jump."""
    basis = curve.basis
    while basis is not None and basis.kind == "offset":
        basis = basis.basis
    if basis is None or basis.knots is None:
        return []
    return [float(k) for k in basis.knots if first < k < last]


@cache
def _nodes() -> Array:
    """Chebyshev-Lobatto parameters in [0, 1]: both ends are nodes, so that pieces join."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE))


def _bernstein(t: Array) -> Array:
    k = np.arange(DEGREE + 1)
    binomial = np.array([comb(DEGREE, j) for j in k], float)
    return np.asarray(binomial * t[:, None] ** k * (1 - t[:, None]) ** (DEGREE - k))


def _interpolate(values: Array) -> Array:
    """Control points (DEGREE + 1, dim) of the Bezier curve through values at the nodes, the ends exact."""
    points = np.linalg.solve(_bernstein(_nodes()), values)
    points[0], points[-1] = values[0], values[-1]
    return np.asarray(points)
