"""Curves to rational Bezier pieces: exact for lines, conics and splines, adaptive for offset curves."""

from __future__ import annotations

from math import ceil, cos, cosh, pi, sin, sinh

import numpy as np
from numpy.typing import NDArray

from .bspline import curve_pieces
from .stream import Curve, Vector

Array = NDArray[np.float64]
Piece = list[Vector]  # homogeneous control points (wx, wy[, wz], w) of one rational Bezier piece

ANGLE_LIMIT = 100 * pi / 180  # of one piece of a circle or ellipse; weights stay above 0.64
HYPERBOLIC_LIMIT = 2.0  # of one piece of a hyperbola; weights stay below 1.6


def is_angular(curve: Curve) -> bool:
    """Whether the curve's parameter is an angle that its pieces' parameter maps to by the half-angle tangent."""
    return curve.kind in ("circle", "ellipse")


def is_rational_in_its_parameter(curve: Curve) -> bool:
    """Whether `pieces` keeps the parameter exactly, linear or angular (a hyperbola's or an offset curve's is lost)."""
    return curve.kind not in ("hyperbola", "offset")


def cut_evenly(low: float, high: float, limit: float) -> list[float]:
    """low .. high in equal parts of at most `limit`; a billionth of a part too many does not count."""
    count = max(1, ceil((high - low) / limit - 1e-9))
    return [low, *(low + (high - low) * k / count for k in range(1, count)), high]


def pieces(curve: Curve, first: float, last: float) -> tuple[list[Piece], list[float]]:
    """Rational Bezier pieces of curve over [first, last] and the n + 1 parameters between them.

    Conic and line pieces have end weights 1. An offset curve is approximated within 1e-10 of its own extent.
    """
    if curve.kind == "line":
        return [_polynomial(curve, first, last)], [first, last]
    if curve.kind == "parabola":
        return [_polynomial(curve, first, last)], [first, last]
    if curve.kind in ("circle", "ellipse"):
        cuts = cut_evenly(first, last, ANGLE_LIMIT)
        return [_arc(curve, s, t, cos, sin) for s, t in zip(cuts, cuts[1:], strict=False)], cuts
    if curve.kind == "hyperbola":
        cuts = cut_evenly(first, last, HYPERBOLIC_LIMIT)
        return [_arc(curve, s, t, cosh, sinh) for s, t in zip(cuts, cuts[1:], strict=False)], cuts
    if curve.kind == "offset":
        from .offset import offset_pieces

        return offset_pieces(curve, first, last)
    if curve.degree == 1 and curve.knots is not None and len(curve.knots) == 2 and not curve.rational:
        return [_straight(curve, first, last)], [first, last]
    points, spans = spline_pieces(curve, first, last)
    return [list(map(tuple, piece)) for piece in points.tolist()], spans.tolist()


def spline_pieces(curve: Curve, first: float, last: float) -> tuple[Array, Array]:
    """pieces() for a Bezier or B-spline curve as one array (m, degree + 1, dim + 1), and the parameters (m + 1,)."""
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


def _polynomial(curve: Curve, s: float, t: float) -> Piece:
    """origin + t b (a line) or origin + t^2 a + t b (a parabola): the control points are the blossom values."""
    if curve.kind == "line":
        return [tuple(o + k * b for o, b in zip(curve.origin, curve.b, strict=True)) + (1.0,) for k in (s, t)]
    ends = ((s * s, s), (s * t, 0.5 * (s + t)), (t * t, t))
    return [
        tuple(o + k2 * a + k * b for o, a, b in zip(curve.origin, curve.a, curve.b, strict=True)) + (1.0,)
        for k2, k in ends
    ]


def _straight(curve: Curve, s: float, t: float) -> Piece:
    """A polynomial B-spline of degree 1 with one span: many files write lines so."""
    assert curve.poles is not None and curve.knots is not None
    ends = curve.poles.tolist()
    k0, k1 = curve.knots.tolist()
    parts = ((s - k0) / (k1 - k0), (t - k0) / (k1 - k0))
    return [tuple([(1 - r) * a + r * b for a, b in zip(*ends, strict=True)]) for r in parts]


def _arc(curve: Curve, s: float, t: float, c: object, d: object) -> Piece:
    """One arc of origin + c(t) a + d(t) b, (c, d) = (cos, sin) or (cosh, sinh), as a rational quadratic."""
    assert callable(c) and callable(d)
    middle, weight = 0.5 * (s + t), c(0.5 * (t - s))
    frame = list(zip(curve.origin, curve.a, curve.b, strict=True))
    ends = []
    for k in (s, t):
        ck, dk = c(k), d(k)
        ends.append(tuple([o + ck * a + dk * b for o, a, b in frame] + [1.0]))
    cm, dm = c(middle), d(middle)
    return [ends[0], tuple([weight * o + cm * a + dm * b for o, a, b in frame] + [weight]), ends[1]]


def projected(curve: Curve, rows: list[list[float]]) -> Curve:
    """A 3-D curve's image in 2-D under an affine map, exact for every kind but offset curves, which it does not take.

    rows: two rows of four numbers, applied to (x, y, z, 1).
    """
    if curve.poles is None:
        x, y, z = curve.origin
        return Curve(
            curve.kind,
            tuple([p * x + q * y + r * z + s for p, q, r, s in rows]),
            tuple([p * curve.a[0] + q * curve.a[1] + r * curve.a[2] for p, q, r, _ in rows]) if curve.a else (),
            tuple([p * curve.b[0] + q * curve.b[1] + r * curve.b[2] for p, q, r, _ in rows]),
        )
    poles = np.empty((len(curve.poles), 3))
    poles[:, :-1] = curve.poles @ np.array(rows).T
    poles[:, -1] = curve.poles[:, -1]
    return Curve(
        curve.kind,
        degree=curve.degree,
        poles=poles,
        knots=curve.knots,
        multiplicities=curve.multiplicities,
        periodic=curve.periodic,
        rational=curve.rational,
    )
