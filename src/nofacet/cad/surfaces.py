"""What there is to know of a surface's parameters (u, v): where they begin and end, return, and shrink to a point."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from .geometry import Curve, Surface
from .offset import evaluate

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]  # u0, u1, v0, v1

ELEMENTARY = ("plane", "cylinder", "cone", "sphere", "torus")
INFINITE = 1e100  # OpenCascade writes 2e100 for a bound that is none


def natural_bounds(surface: Surface) -> Box:
    """The box a face without wires covers; infinite where the surface is."""
    if surface.bounds is not None:
        return surface.bounds
    turn, line = (0.0, 2 * pi), (-2 * INFINITE, 2 * INFINITE)
    if surface.kind == "offset":
        assert surface.basis is not None
        return natural_bounds(surface.basis)
    if surface.kind == "bspline":
        assert surface.knots is not None and surface.multiplicities is not None
        ends = [
            _domain(knots, multiplicities, degree, periodic)
            for knots, multiplicities, degree, periodic in zip(
                surface.knots, surface.multiplicities, surface.degrees, surface.periodic, strict=True
            )
        ]
        return (*ends[0], *ends[1])
    if surface.curve is not None:
        curve = _curve_domain(surface.curve)
        return (*turn, *curve) if surface.kind == "revolution" else (*curve, *line)
    u, v = {
        "plane": (line, line),
        "cylinder": (turn, line),
        "cone": (turn, line),
        "sphere": (turn, (-pi / 2, pi / 2)),
        "torus": (turn, turn),
        "bezier": ((0.0, 1.0), (0.0, 1.0)),
    }[surface.kind]
    return (*u, *v)


def periods(surface: Surface) -> tuple[float, float]:
    """The periods in u and v, 0 where the surface is not periodic."""
    turn = 2 * pi
    if surface.kind == "offset":
        assert surface.basis is not None
        return periods(surface.basis)
    if surface.kind == "bspline":
        assert surface.knots is not None
        u, v = (
            float(knots[-1] - knots[0]) if periodic else 0.0
            for knots, periodic in zip(surface.knots, surface.periodic, strict=True)
        )
        return u, v
    along = 0.0
    if surface.curve is not None:
        if surface.curve.bounds is None and surface.curve.kind in ("circle", "ellipse"):
            along = turn
        elif surface.curve.periodic and surface.curve.bounds is None and surface.curve.knots is not None:
            along = float(surface.curve.knots[-1] - surface.curve.knots[0])
    return {
        "cylinder": (turn, 0.0),
        "cone": (turn, 0.0),
        "sphere": (turn, 0.0),
        "torus": (turn, turn),
        "revolution": (turn, along),
        "extrusion": (along, 0.0),
    }.get(surface.kind, (0.0, 0.0))


def _domain(knots: Array, multiplicities: NDArray[np.int32], degree: int, periodic: bool) -> tuple[float, float]:
    if periodic:
        return float(knots[0]), float(knots[-1])
    flat = np.repeat(knots, multiplicities)
    return float(flat[degree]), float(flat[-degree - 1])


def _curve_domain(curve: Curve) -> tuple[float, float]:
    if curve.bounds is not None:
        return curve.bounds
    if curve.kind == "bezier":
        return 0.0, 1.0
    if curve.kind == "bspline":
        assert curve.knots is not None and curve.multiplicities is not None
        return _domain(curve.knots, curve.multiplicities, curve.degree, curve.periodic)
    if curve.kind == "offset":
        assert curve.basis is not None
        return _curve_domain(curve.basis)
    return (0.0, 2 * pi) if curve.kind in ("circle", "ellipse") else (-2 * INFINITE, 2 * INFINITE)


def collapsed(surface: Surface, axis: int, value: float) -> bool:
    """Whether the surface is a single point where parameter `axis` has `value`: poles and tips of turned surfaces."""
    if axis != 1:
        return False
    r1, r2 = surface.radii
    if surface.kind == "sphere":
        return abs(abs(value) - pi / 2) < 1e-6
    if surface.kind == "cone":
        return abs(r1 + value * np.sin(r2)) <= 1e-6 * (abs(r1) + abs(value))
    if surface.kind == "torus":
        return bool(abs(r1 + r2 * np.cos(value)) <= 1e-6 * r2)
    if surface.kind == "revolution":
        assert surface.curve is not None
        spoke = evaluate(surface.curve, np.array([value]))[0][0] - np.array(surface.origin)
        return bool(np.linalg.norm(np.cross(spoke, surface.z)) <= 1e-6 * np.linalg.norm(spoke))
    return False
