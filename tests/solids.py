"""Solids with closed forms: where a ray meets them, and the outline they have in a picture.

Rays are intersected in extended precision, in coordinates around the solid's centre.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cadquery as cq
import numpy as np

from scenes import GENERAL_DIRECTION, Array, convex_hull, polygon_area

RADIUS, HEIGHT, TUBE = 5.0, 7.0, 1.5
Hits = tuple[Array, Array]  # depth (n, k) of k candidates a ray, inf where there is none; normal (n, k, 3)
Projection = Callable[[Array], Array]  # pixels (n, 2) from local points (n, 3)
Curves = list[tuple[int, Array]]  # sign and closed polygon (n, 2)


@dataclass(frozen=True)
class Solid:
    """A solid of revolution about z whose centre (cylinder and cone: of the base) is the local origin.

    hits: of rays (origin, direction), all crossings with the surface.
    outline: in the picture, from the projection and the eye (local, homogeneous): closed curves whose areas add up
        with the signs given.
    """

    name: str
    build: Callable[[cq.Vector], cq.Solid]
    size: float
    hits: Callable[[Array, Array], Hits]
    outline: Callable[[Projection, Array], Curves]
    on_outline: Array  # a point that is on the outline when seen along GENERAL_DIRECTION, for zooming in


def roots_of_quadratic(a: Array, b: Array, c: Array) -> Array:
    """Real roots (n, 2) of a t^2 + 2 b t + c, without cancellation; inf where there are none."""
    discriminant = b * b - a * c
    root = np.sqrt(np.where(discriminant >= 0, discriminant, np.nan))
    q = -(b + np.copysign(root, b))
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.stack([q / a, c / q], axis=1)
    return np.where(np.isfinite(found), found, np.inf)


def at(origin: Array, direction: Array, t: Array) -> Array:
    """Points (n, k, 3) at parameters t (n, k); a place far away where t is inf."""
    return origin[:, None] + np.where(np.isfinite(t), t, 1e30)[..., None] * direction[:, None]


def unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors.astype(float), axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def dot(p: Array, q: Array) -> Array:
    return np.sum(p * q, axis=-1)


def sphere_hits(origin: Array, direction: Array) -> Hits:
    t = roots_of_quadratic(dot(direction, direction), dot(origin, direction), dot(origin, origin) - RADIUS**2)
    return t, unit(at(origin, direction, t))


def disc_hits(origin: Array, direction: Array, z: float, radius: float) -> Hits:
    with np.errstate(divide="ignore", invalid="ignore"):
        t = ((z - origin[:, 2]) / direction[:, 2])[:, None]
    p = at(origin, direction, t)
    t = np.where(np.hypot(p[..., 0], p[..., 1]) <= radius, t, np.inf)
    return t, np.broadcast_to(np.array([0.0, 0.0, 1.0]), p.shape)


def slanted_hits(origin: Array, direction: Array, slope: float) -> Hits:
    """The side x^2 + y^2 = (RADIUS - slope z)^2, 0 <= z <= HEIGHT, of a cylinder (slope 0) or cone."""
    shift = dot(np.array([0, 0, HEIGHT]) - origin, direction) / dot(direction, direction)
    origin = origin + shift[:, None] * direction  # near a cone's tip, where the quadratic's terms would cancel
    (ox, oy, oz), (dx, dy, dz) = origin.T, direction.T
    ro, rd = RADIUS - slope * oz, -slope * dz
    t = roots_of_quadratic(dx**2 + dy**2 - rd**2, ox * dx + oy * dy - ro * rd, ox**2 + oy**2 - ro**2)
    p = at(origin, direction, t)
    t = np.where((p[..., 2] >= 0) & (p[..., 2] <= HEIGHT), t, np.inf)
    return t + shift[:, None], unit(p * [1, 1, 0] + [0, 0, 1] * (slope * (RADIUS - slope * p[..., 2:])))


def cylinder_hits(origin: Array, direction: Array) -> Hits:
    return joined(
        slanted_hits(origin, direction, 0.0),
        disc_hits(origin, direction, 0.0, RADIUS),
        disc_hits(origin, direction, HEIGHT, RADIUS),
    )


def cone_hits(origin: Array, direction: Array) -> Hits:
    return joined(slanted_hits(origin, direction, RADIUS / HEIGHT), disc_hits(origin, direction, 0.0, RADIUS))


def joined(*hits: Hits) -> Hits:
    return np.concatenate([t for t, _ in hits], axis=1), np.concatenate([n for _, n in hits], axis=1)


def torus_hits(origin: Array, direction: Array) -> Hits:
    """Roots of the quartic (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2), bracketed by those of its derivative."""
    middle = -dot(origin, direction) / dot(direction, direction)
    near = origin + middle[:, None] * direction  # the ray's point nearest the centre: keeps the coefficients small
    dd, nn = dot(direction, direction), dot(near, near) + RADIUS**2 - TUBE**2
    flat = direction[:, :2]
    one = np.ones_like(dd)
    c4, c3, c2 = dd**2, 0 * one, 2 * dd * nn - 4 * RADIUS**2 * dot(flat, flat)
    c1 = -8 * RADIUS**2 * dot(flat, near[:, :2])
    c0 = nn**2 - 4 * RADIUS**2 * dot(near[:, :2], near[:, :2])
    quartic = np.stack([c0, c1, c2, c3, c4], axis=1)
    reach = 2 * (RADIUS + TUBE) / np.sqrt(dd)
    turning = np.sort(roots_between(np.polynomial.polynomial.polyder(quartic, axis=1), reach), axis=1)
    t = bracketed_roots(quartic, np.concatenate([-reach[:, None], turning, reach[:, None]], axis=1))
    p = at(near, direction, t)
    spine = unit(p * [1, 1, 0]) * RADIUS
    return t + middle[:, None], unit(p - spine)


def roots_between(cubic: Array, reach: Array) -> Array:
    """Real roots (n, 3) of c0 + c1 t + c2 t^2 + c3 t^3 in [-reach, reach]; missing ones are `reach`."""
    bend = roots_of_quadratic(3 * cubic[:, 3], cubic[:, 2], cubic[:, 1])  # of the derivative: 3 c3 t^2 + 2 c2 t + c1
    bend = np.sort(np.clip(np.where(np.isfinite(bend), bend, reach[:, None]), -reach[:, None], reach[:, None]), axis=1)
    found = bracketed_roots(cubic, np.concatenate([-reach[:, None], bend, reach[:, None]], axis=1))
    return np.where(np.isfinite(found), found, reach[:, None])


def bracketed_roots(coefficients: Array, knots: Array) -> Array:
    """The root between each two neighbouring knots (n, k + 1) where the sign changes, else inf: (n, k).

    Bisection in doubles, then Newton's iteration in the precision of the coefficients.
    """
    slope = np.polynomial.polynomial.polyder(coefficients, axis=1)
    low, high = knots[:, :-1], knots[:, 1:]
    below = polynomial(coefficients, low) < 0
    changes = below != (polynomial(coefficients, high) < 0)
    low, high, short = low.astype(float), high.astype(float), coefficients.astype(float)
    for _ in range(60):
        middle = (low + high) / 2
        left = (polynomial(short, middle) < 0) == below
        low, high = np.where(left, middle, low), np.where(left, high, middle)
    t = ((low + high) / 2).astype(knots.dtype)
    for _ in range(4):
        with np.errstate(divide="ignore", invalid="ignore"):
            step = polynomial(coefficients, t) / polynomial(slope, t)
        t = t - np.where(np.abs(step) < 1e-6, step, 0)
    return np.where(changes, t, np.inf)


def polynomial(coefficients: Array, t: Array) -> Array:
    """c0 + c1 t + ... of each row: coefficients (n, d + 1), t (n, k)."""
    result = np.zeros_like(t)
    for k in range(coefficients.shape[1] - 1, -1, -1):
        result = result * t + coefficients[:, k : k + 1]
    return result


def circle(radius: float, z: float, angle: Array) -> Array:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), z)], axis=1)


def full_turn(count: int) -> Array:
    return np.linspace(0, 2 * np.pi, count, endpoint=False)


def angles_of(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    """Both angles with a cos x + b sin x = c."""
    middle, half = np.arctan2(b, a), np.arccos(np.clip(c / np.maximum(np.hypot(a, b), 1e-300), -1, 1))
    return middle + half, middle - half


def sphere_outline(project: Projection, eye: Array) -> Curves:
    """Where tangents from the eye touch: a circle across the line to the eye, RADIUS^2 / distance from the centre."""
    distance = np.linalg.norm(eye[:3])
    axis = eye[:3] / distance
    height = eye[3] * RADIUS**2 / distance
    side = unit(np.cross(axis, [0.3, 0.9, -0.2]))
    x, y, _ = circle(np.sqrt(RADIUS**2 - height**2), 0, full_turn(400_000)).T
    return [(1, project(height * axis + x[:, None] * side + y[:, None] * np.cross(axis, side)))]


def cylinder_outline(project: Projection, eye: Array) -> Curves:
    angle = np.append(full_turn(20_000), angles_of(eye[0], eye[1], eye[3] * RADIUS))
    return [(1, convex_hull(project(np.concatenate([circle(RADIUS, z, angle) for z in (0, HEIGHT)]))))]


def cone_outline(project: Projection, eye: Array) -> Curves:
    angle = np.append(full_turn(20_000), angles_of(eye[0], eye[1], RADIUS * (eye[3] - eye[2] / HEIGHT)))
    return [(1, convex_hull(project(np.concatenate([circle(RADIUS, 0, angle), [[0.0, 0.0, HEIGHT]]]))))]


def torus_outline(project: Projection, eye: Array) -> Curves:
    """At each angle u around the axis two points v of the tube face sideways: normal . (point - eye) = 0.

    They are the outer outline and that of the hole, which must have no cusps (seen from well above the rim's plane).
    """
    u = full_turn(400_000)
    ring = circle(1, 0, u)
    curves = []
    for v in angles_of(eye[3] * RADIUS - ring @ eye[:3], np.full(len(u), -eye[2]), np.full(len(u), -eye[3] * TUBE)):
        curves.append(project(ring * (RADIUS + TUBE * np.cos(v))[:, None] + [0, 0, TUBE] * np.sin(v)[:, None]))
    hole, outer = sorted(curves, key=polygon_area)
    return [(1, outer), (-1, hole)]


UP = cq.Vector(0, 0, 1)
ACROSS = unit(
    np.cross(GENERAL_DIRECTION, [0, 0, 1])
)  # seen along GENERAL_DIRECTION, touches any of the solids sideways
SOLIDS = {
    solid.name: solid
    for solid in (
        Solid("sphere", lambda c: cq.Solid.makeSphere(RADIUS, c, UP, -90, 90, 360), 2 * RADIUS, sphere_hits,
              sphere_outline, RADIUS * ACROSS),
        Solid("cylinder", lambda c: cq.Solid.makeCylinder(RADIUS, HEIGHT, c, UP), 2 * RADIUS, cylinder_hits,
              cylinder_outline, RADIUS * ACROSS + [0, 0, HEIGHT / 3]),
        Solid("cone", lambda c: cq.Solid.makeCone(RADIUS, 0, HEIGHT, c, UP), 2 * RADIUS, cone_hits,
              cone_outline, np.array([0, 0, HEIGHT])),
        Solid("torus", lambda c: cq.Solid.makeTorus(RADIUS, TUBE, c, UP), 2 * (RADIUS + TUBE), torus_hits,
              torus_outline, (RADIUS + TUBE) * ACROSS),
    )
}  # fmt: skip
