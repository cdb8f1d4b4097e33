"""Curves and surfaces as OpenCascade's binary serialisation holds them, one at a time."""

from __future__ import annotations

from dataclasses import dataclass
from struct import Struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, ...]


@dataclass(slots=True)
class Curve:
    """A curve in 2 or 3 dimensions, by kind, with t OpenCascade's parameter.

    line: origin + t b; circle, ellipse: origin + cos t a + sin t b; hyperbola: origin + cosh t a + sinh t b;
    parabola: origin + t^2 a + t b; bezier (0 <= t <= 1), bspline: poles (n, dim + 1) homogeneous;
    offset: basis moved by `offset` along its normal (2-D: right of the tangent; 3-D: tangent x direction b).
    bounds: the range of a trimmed curve, None where it is the kind's own.
    """

    kind: str
    origin: Vector = ()
    a: Vector = ()
    b: Vector = ()
    degree: int = 0
    poles: Array | None = None
    knots: Array | None = None
    multiplicities: NDArray[np.int32] | None = None
    periodic: bool = False
    rational: bool = False
    basis: Curve | None = None
    offset: float = 0.0
    bounds: tuple[float, float] | None = None


@dataclass(slots=True)
class Surface:
    """A surface in OpenCascade's own parameters (u, v).

    Elementary ones live in the frame (origin, x, y, z), y as stored, so left-handed frames stay so; radii hold
    (radius, 0), cone (reference radius, half angle), torus (major, minor). extrusion: curve(u) + v z; revolution:
    curve(v) turned by u about the axis (origin, z). bezier, bspline: poles (nu, nv, 4) homogeneous.
    bounds: u0, u1, v0, v1 of a rectangular-trimmed surface, else None. offset: distance from `basis`.
    """

    kind: str
    origin: Vector = ()
    x: Vector = ()
    y: Vector = ()
    z: Vector = ()
    radii: tuple[float, float] = (0.0, 0.0)
    curve: Curve | None = None
    degrees: tuple[int, int] = (0, 0)
    poles: Array | None = None
    knots: tuple[Array, Array] | None = None
    multiplicities: tuple[NDArray[np.int32], NDArray[np.int32]] | None = None
    periodic: tuple[bool, bool] = (False, False)
    rational: bool = False
    basis: Surface | None = None
    offset: float = 0.0
    bounds: tuple[float, float, float, float] | None = None


def read_curve(data: bytes, at: int, dim: int) -> Curve:
    """The curve in `dim` dimensions whose record starts at byte `at`."""
    return _curve(_Reader(data, at), dim)


def read_surface(data: bytes, at: int) -> Surface:
    """The surface whose record starts at byte `at`."""
    return _surface(_Reader(data, at))


_INT, _REAL, _SHORT = Struct("<i"), Struct("<d"), Struct("<H")
_REALS = {n: Struct(f"<{n}d") for n in range(1, 17)}
KNOTS = np.dtype([("knot", "<f8"), ("multiplicity", "<i4")])


class _Reader:
    """A position in the bytes."""

    __slots__ = ("data", "at")

    def __init__(self, data: bytes, at: int) -> None:
        self.data = data
        self.at = at

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1]

    def integer(self) -> int:
        self.at += 4
        return int(_INT.unpack_from(self.data, self.at - 4)[0])

    def short(self) -> int:
        self.at += 2
        return int(_SHORT.unpack_from(self.data, self.at - 2)[0])

    def real(self) -> float:
        self.at += 8
        return float(_REAL.unpack_from(self.data, self.at - 8)[0])

    def reals(self, n: int) -> Vector:
        at = self.at
        self.at += 8 * n
        return _REALS[n].unpack_from(self.data, at)

    def array(self, dtype: Any, count: int) -> NDArray[Any]:
        result = np.frombuffer(self.data, dtype, count, self.at).copy()
        self.at += result.nbytes
        return result


CURVES = ("", "line", "circle", "ellipse", "parabola", "hyperbola", "bezier", "bspline", "trimmed", "offset")


def _curve(reader: _Reader, dim: int) -> Curve:
    kind = CURVES[reader.byte()]
    if kind == "line":
        numbers = reader.reals(2 * dim)
        return Curve(kind, numbers[:dim], (), numbers[dim:])
    if kind in ("circle", "ellipse", "parabola", "hyperbola"):
        return _conic(reader, kind, dim)
    if kind == "trimmed":
        bounds = (reader.real(), reader.real())
        basis = _curve(reader, dim)
        basis.bounds = bounds
        return basis
    if kind == "offset":
        offset = reader.real()
        direction = reader.reals(3) if dim == 3 else ()
        return Curve(kind, b=direction, basis=_curve(reader, dim), offset=offset)
    rational = bool(reader.byte())
    if kind == "bezier":
        degree = reader.short()
        return Curve(kind, degree=degree, poles=_poles(reader, (degree + 1,), dim, rational), rational=rational)
    periodic = bool(reader.byte())
    degree, count, knot_count = reader.short(), reader.integer(), reader.integer()
    poles = _poles(reader, (count,), dim, rational)
    knots = reader.array(KNOTS, knot_count)
    return Curve(
        kind,
        degree=degree,
        poles=poles,
        knots=np.ascontiguousarray(knots["knot"]),
        multiplicities=np.ascontiguousarray(knots["multiplicity"]),
        periodic=periodic,
        rational=rational,
    )


def _conic(reader: _Reader, kind: str, dim: int) -> Curve:
    """Conics store their frame (in 3-D with the normal between origin and X), then one or two sizes."""
    origin = reader.reals(dim)
    if dim == 3:
        reader.at += 24
    x, y = reader.reals(dim), reader.reals(dim)
    first = reader.real()
    if kind == "parabola":
        return Curve(kind, origin, tuple(c / (4 * first) for c in x), y)
    second = first if kind == "circle" else reader.real()
    return Curve(kind, origin, tuple(first * c for c in x), tuple(second * c for c in y))


def _poles(reader: _Reader, shape: tuple[int, ...], dim: int, rational: bool) -> Array:
    """Homogeneous poles, shape (*shape, dim + 1), with the last column 1 where there are no weights."""
    width = dim + 1 if rational else dim
    stored = reader.array("<f8", int(np.prod(shape)) * width).reshape(*shape, width)
    poles = np.ones((*shape, dim + 1))
    poles[..., :width] = stored
    if rational:
        poles[..., :dim] *= poles[..., dim:]
    return poles


SURFACES = (
    "",
    "plane",
    "cylinder",
    "cone",
    "sphere",
    "torus",
    "extrusion",
    "revolution",
    "bezier",
    "bspline",
    "trimmed",
    "offset",
)


def _surface(reader: _Reader) -> Surface:
    kind = SURFACES[reader.byte()]
    if kind in ("plane", "cylinder", "cone", "sphere", "torus"):
        n = reader.reals(12)
        radii = (0.0, 0.0)
        if kind in ("cone", "torus"):
            radii = (reader.real(), reader.real())
        elif kind != "plane":
            radii = (reader.real(), 0.0)
        return Surface(kind, n[:3], n[6:9], n[9:12], n[3:6], radii)
    if kind == "extrusion":
        direction = reader.reals(3)
        return Surface(kind, z=direction, curve=_curve(reader, 3))
    if kind == "revolution":
        origin, direction = reader.reals(3), reader.reals(3)
        return Surface(kind, origin, z=direction, curve=_curve(reader, 3))
    if kind == "trimmed":
        bounds = reader.reals(4)
        basis = _surface(reader)
        basis.bounds = (bounds[0], bounds[1], bounds[2], bounds[3])
        return basis
    if kind == "offset":
        offset = reader.real()
        return Surface(kind, basis=_surface(reader), offset=offset)
    rational = bool(reader.byte() | reader.byte())
    if kind == "bezier":
        du, dv = reader.short(), reader.short()
        poles = _poles(reader, (du + 1, dv + 1), 3, rational)
        return Surface(kind, degrees=(du, dv), poles=poles, rational=rational)
    periodic = (bool(reader.byte()), bool(reader.byte()))
    degrees = (reader.short(), reader.short())
    nu, nv, ku, kv = (reader.integer() for _ in range(4))
    poles = _poles(reader, (nu, nv), 3, rational)
    u, v = reader.array(KNOTS, ku), reader.array(KNOTS, kv)
    knots = (np.ascontiguousarray(u["knot"]), np.ascontiguousarray(v["knot"]))
    multiplicities = (np.ascontiguousarray(u["multiplicity"]), np.ascontiguousarray(v["multiplicity"]))
    return Surface(
        kind,
        degrees=degrees,
        poles=poles,
        knots=knots,
        multiplicities=multiplicities,
        periodic=periodic,
        rational=rational,
    )
