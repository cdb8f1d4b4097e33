"""Surfaces to rational Bezier patches in OpenCascade's own parameters, cut to the box of (u, v) that a face uses.

Every exact kind is one of three constructions on homogeneous control points (wx, wy, wz, w):
turning a profile by an angle (cylinder, cone, sphere, torus, revolution), moving a curve along a line (extrusion,
plane) and blossoming (Bezier, B-spline). A turn by [u0, u1] is a rational quadratic in s with
u = m + 2 atan(T (2 s - 1)), m = (u0 + u1) / 2, T = tan((u1 - u0) / 4): control points at the angles u0, m, u1 with
the weights 1, cos((u1 - u0) / 2), 1, the middle one on the tangents' meeting point.
"""

from __future__ import annotations

from collections import defaultdict
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model import PatchGroup
from .bspline import surface_pieces
from .curves import ANGLE_LIMIT, cut_evenly, is_angular, is_rational_in_its_parameter, pieces
from .stream import Curve, Surface

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]  # u0, u1, v0, v1

INFINITE = 1e100  # OpenCascade writes 2e100 for a bound that is none
ELEMENTARY = ("plane", "cylinder", "cone", "sphere", "torus")


def is_exact(surface: Surface) -> bool:
    """Whether the surface is rational in its own parameters (or their half-angle tangents)."""
    if surface.kind == "offset":
        return False
    return surface.curve is None or is_rational_in_its_parameter(surface.curve)


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
        if surface.curve.bounds is None and is_angular(surface.curve):
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
    return (0.0, 2 * pi) if is_angular(curve) else (-2 * INFINITE, 2 * INFINITE)


class PatchBuilder:
    """Collects surfaces and their boxes, then makes all patches at once, one group for each bidegree."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[float, ...]]] = defaultdict(list)
        self._parts: dict[tuple[int, int], list[tuple[NDArray[Any], ...]]] = defaultdict(list)

    def add(self, definition: int, surface: Surface, box: Box) -> None:
        """Ask for the patches of definition's surface over box; the surface must be exact (is_exact)."""
        if surface.kind in ELEMENTARY:
            u = cut_evenly(box[0], box[1], np.inf if surface.kind == "plane" else ANGLE_LIMIT)
            v = cut_evenly(box[2], box[3], ANGLE_LIMIT if surface.kind in ("sphere", "torus") else np.inf)
            frame = (*surface.origin, *surface.x, *surface.y, *surface.z, *surface.radii)
            self._rows[surface.kind].extend(
                (definition, u0, u1, v0, v1, *frame)
                for u0, u1 in zip(u, u[1:], strict=False)
                for v0, v1 in zip(v, v[1:], strict=False)
            )
        elif surface.kind == "extrusion":
            self._extrusion(definition, surface, box)
        elif surface.kind == "revolution":
            self._revolution(definition, surface, box)
        else:
            self._spline(definition, surface, box)

    def add_patches(
        self, definition: int, points: Array, u: Array, v: Array, angular: tuple[bool, bool] = (False, False)
    ) -> None:
        """Add patches (mu, mv, du + 1, dv + 1, 4) between the parameters u (mu + 1,) and v (mv + 1,)."""
        mu, mv, du, dv, _ = points.shape
        domain = np.empty((mu, mv, 4))
        domain[..., 0], domain[..., 1] = u[:-1, None], u[1:, None]
        domain[..., 2], domain[..., 3] = v[:-1], v[1:]
        self._part(points.reshape(-1, du, dv, 4), np.full(mu * mv, definition), domain.reshape(-1, 4), angular)

    def groups(self) -> list[PatchGroup]:
        """All patches, one group for each bidegree, ordered by bidegree and inside a group by definition."""
        for kind, rows in self._rows.items():
            self._elementary(kind, np.array(rows))
        self._rows.clear()
        result = []
        for degrees in sorted(self._parts):
            columns = [np.concatenate(column) for column in zip(*self._parts[degrees], strict=True)]
            order = np.argsort(columns[1], kind="stable")
            points, definition, domain, angular = (column[order] for column in columns)
            result.append(PatchGroup(points, definition.astype(np.int32), domain, angular.astype(np.uint8)))
        return result

    def _part(self, points: Array, definition: Array, domain: Array, angular: tuple[bool, bool]) -> None:
        flags = np.tile(np.array(angular, np.uint8), (len(points), 1))
        self._parts[points.shape[1] - 1, points.shape[2] - 1].append((points, definition, domain, flags))

    def _elementary(self, kind: str, rows: Array) -> None:
        """All patches of one elementary kind; the profile in v is turned by u (a plane is moved instead)."""
        definition, domain = rows[:, 0], rows[:, 1:5]
        origin, x, y, z = (rows[:, None, None, k : k + 3] for k in (5, 8, 11, 14))
        v = rows[:, 3:5]
        r1, r2 = rows[:, 17:18], rows[:, 18:19]
        if kind == "plane":
            u, v = rows[:, 1:3, None, None], rows[:, None, 3:5, None]
            points = np.ones((len(rows), 2, 2, 4))
            points[..., :3] = origin + u * x + v * y
            self._part(points, definition, domain, (False, False))
            return
        if kind in ("cylinder", "cone"):
            slope = np.sin(r2) if kind == "cone" else 0.0
            rise = np.cos(r2) if kind == "cone" else 1.0
            radius, height, weight = r1 + v * slope, v * rise, np.ones_like(v)
        else:
            cosine, sine, weight = _arcs(domain[:, 2], domain[:, 3])
            major, minor = (r1, r2) if kind == "torus" else (0.0, r1)
            radius, height = major * weight + minor * cosine, minor * sine
        cosine, sine, turn_weight = (turn[:, :, None, None] for turn in _arcs(domain[:, 0], domain[:, 1]))
        radius, height, weight = (profile[:, None, :, None] for profile in (radius, height, weight))
        w = turn_weight * weight
        points = np.empty((*w.shape[:3], 4))
        points[..., :3] = origin * w + radius * (cosine * x + sine * y) + (turn_weight * height) * z
        points[..., 3:] = w
        self._part(points, definition, domain, (True, kind in ("sphere", "torus")))

    def _extrusion(self, definition: int, surface: Surface, box: Box) -> None:
        assert surface.curve is not None
        curve, cuts = pieces(surface.curve, box[0], box[1])
        profile = np.array(curve)  # (mu, du + 1, 4)
        points = np.repeat(profile[:, None, :, None, :], 2, axis=3)
        points[..., :3] += points[..., 3:] * np.array(box[2:])[:, None] * np.array(surface.z)
        self.add_patches(
            definition, points, np.array(cuts), np.array(box[2:]), angular=(is_angular(surface.curve), False)
        )

    def _revolution(self, definition: int, surface: Surface, box: Box) -> None:
        assert surface.curve is not None
        curve, v = pieces(surface.curve, box[2], box[3])
        profile = np.array(curve)  # (mv, dv + 1, 4)
        w = profile[..., 3:]
        z, origin = np.array(surface.z), np.array(surface.origin)
        spoke = profile[..., :3] - w * origin
        axial = (spoke @ z)[..., None] * z
        x = spoke - axial
        y = np.cross(z, x)
        u = np.array(cut_evenly(box[0], box[1], ANGLE_LIMIT))
        cosine, sine, weight = (turn[:, None, :, None, None] for turn in _arcs(u[:-1], u[1:]))
        points = np.empty((len(u) - 1, len(curve), 3, profile.shape[1], 4))
        points[..., :3] = cosine * x[:, None] + sine * y[:, None] + weight * (axial + w * origin)[:, None]
        points[..., 3:] = weight * w[:, None]
        self.add_patches(definition, points, u, np.array(v), angular=(True, is_angular(surface.curve)))

    def _spline(self, definition: int, surface: Surface, box: Box) -> None:
        assert surface.poles is not None
        if surface.kind == "bezier":
            unit = np.array([0.0, 1.0])
            knots = (unit, unit)
            multiplicities = tuple(np.full(2, degree + 1, np.int32) for degree in surface.degrees)
        else:
            assert surface.knots is not None and surface.multiplicities is not None
            knots, multiplicities = surface.knots, surface.multiplicities
        points, u, v = surface_pieces(
            surface.degrees, surface.poles, knots, (multiplicities[0], multiplicities[1]), surface.periodic, box
        )
        if not surface.rational:
            points[..., 3] = 1.0
        self.add_patches(definition, points, u, v)


def _arcs(start: Array, stop: Array) -> tuple[Array, Array, Array]:
    """Homogeneous control points (cosine, sine, weight), each (n, 3), of the unit circle's arcs [start, stop]."""
    angle = np.stack([start, 0.5 * (start + stop), stop], axis=1)
    weight = np.ones_like(angle)
    weight[:, 1] = np.cos(0.5 * (stop - start))
    return np.cos(angle), np.sin(angle), weight
