"""Points of many curves and surfaces at many parameters, in numpy, straight from the parsed stream.

One OpenCascade call a point costs microseconds; here all points of one kind (for splines: of one degree) are computed
together. Splines by de Boor's algorithm on homogeneous poles, everything else by its closed form in OpenCascade's own
parameters. Beyond its domain a spline that is not periodic continues with its end span.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from .geometry import Curve, Surface

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Kind = str | int | tuple[int, int]  # a name, or of splines the degree or degrees
Item = TypeVar("Item", Curve, Surface)

_DIFFERENCE = 1e-7  # central difference for the normals of offset geometry: right to about 1e-8
_CHUNK = 1 << 22  # numbers that one step of de Boor's algorithm may hold

_CONICS: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
    "line": (np.zeros_like, lambda t: t),
    "circle": (np.cos, np.sin),
    "ellipse": (np.cos, np.sin),
    "parabola": (np.square, lambda t: t),
    "hyperbola": (np.cosh, np.sinh),
}


@dataclass(frozen=True)
class _Knots:
    """Flat knots of many splines of one degree, one after the other; `first` (n,) and `count` (n,): their spans."""

    degree: int
    flat: Array
    start: Index
    count: Index
    period: Array

    @classmethod
    def of(cls, degree: int, splines: Sequence[tuple[Array, NDArray[np.int32], bool]]) -> _Knots:
        """splines: knots, multiplicities, periodic."""
        flats = [_flat_knots(degree, *spline) for spline in splines]
        sizes = np.array([len(flat) for flat in flats])
        period = np.array([knots[-1] - knots[0] if periodic else 0.0 for knots, _, periodic in splines])
        return cls(degree, np.concatenate(flats), np.cumsum(sizes) - sizes, sizes - 2 * degree - 1, period)

    def locate(self, spline: Index, t: Array) -> tuple[Index, Array, Array]:
        """Each parameter's span, counted from its spline's first, t within the period, the knots around (2 p, n)."""
        low = self.start[spline] + self.degree
        high = low + self.count[spline]
        period, begin = self.period[spline], self.flat[low]
        t = np.where(period > 0, begin + np.mod(t - begin, np.where(period > 0, period, 1.0)), t)
        first = low
        while (high - low > 1).any():  # bisection: flat[low] <= t < flat[high], or t beyond an end
            middle = (low + high) // 2
            right = (self.flat[middle] <= t) & (high - low > 1)
            low, high = np.where(right, middle, low), np.where(right, high, np.maximum(middle, low + 1))
        # at the end of the domain, and at a knot of full multiplicity, step back to a span that is not empty
        while (empty := (self.flat[low + 1] <= self.flat[low]) & (low > first)).any():
            low = np.where(empty, low - 1, low)
        around = self.flat[low + np.arange(1 - self.degree, self.degree + 1)[:, None]]
        return low - first, t, around

    def reduce(self, points: Array, around: Array, t: Array) -> Array:
        """De Boor's triangle: points (..., p + 1, n) of each span to values (..., n)."""
        for level in range(self.degree):
            low, high = around[level : self.degree], around[self.degree : 2 * self.degree - level]
            part = (t - low) / (high - low)
            points = (1 - part) * points[..., :-1, :] + part * points[..., 1:, :]
        return points[..., 0, :]


def _flat_knots(degree: int, knots: Array, multiplicities: NDArray[np.int32], periodic: bool) -> Array:
    """One flat knot vector; a periodic spline's covers one period, its flat[degree] the last copy of the first knot."""
    if not periodic:
        return np.repeat(knots, multiplicities)
    once = np.repeat(knots[:-1], multiplicities[:-1])
    index = np.arange(len(once) + 2 * degree + 1) - degree + int(multiplicities[0]) - 1
    return np.asarray(once[index % len(once)] + (knots[-1] - knots[0]) * (index // len(once)))


def _unit_knots(degree: int) -> tuple[Array, NDArray[np.int32]]:
    """A Bezier curve's knots as a B-spline."""
    return np.array([0.0, 1.0]), np.full(2, degree + 1, np.int32)


class _Kinds(Generic[Item]):
    """Items sorted by kind. members: kind -> its items; of item k, number[k] says which kind, place[k] where in it."""

    def __init__(self, items: Sequence[Item], kind_of: Callable[[Item], Kind]) -> None:
        self.members: dict[Kind, list[Item]] = defaultdict(list)
        self.number, self.place = np.empty(len(items), np.int64), np.empty(len(items), np.int64)
        numbers: dict[Kind, int] = {}
        for k, item in enumerate(items):
            kind = kind_of(item)
            self.number[k] = numbers.setdefault(kind, len(numbers))
            self.place[k] = len(self.members[kind])
            self.members[kind].append(item)

    def chosen(self, which: Index) -> Iterator[tuple[Kind, Index, Index]]:
        """For each kind among items `which`: the kind, the positions in `which`, the items' places in their kind."""
        numbers = self.number[which]
        for number, kind in enumerate(self.members):
            positions = np.nonzero(numbers == number)[0]
            if len(positions):
                yield kind, positions, self.place[which[positions]]


class Curves:
    """Curves of one dimension (2 or 3), evaluated together. curves: n of them, any kinds."""

    def __init__(self, curves: Sequence[Curve], dimension: int) -> None:
        self.dimension = dimension
        self._kinds = _Kinds(curves, lambda curve: curve.kind if curve.poles is None else curve.degree)
        self._tables: dict[Kind, tuple[Array, ...]] = {}
        self._splines: dict[Kind, tuple[_Knots, Array, Index, Index]] = {}
        self._bases: dict[Kind, Curves] = {}
        for kind, own in self._kinds.members.items():
            if isinstance(kind, int):
                self._splines[kind] = _spline_tables(kind, own)
            elif kind == "offset":
                self._bases[kind] = Curves([curve.basis for curve in own if curve.basis], dimension)
            else:
                zero = (0.0,) * dimension
                rows = [(curve.origin, curve.a or zero, curve.b) for curve in own]
                self._tables[kind] = tuple(np.array(column) for column in zip(*rows, strict=True))

    def __call__(self, which: Index, t: Array) -> Array:
        """Points (m, dimension) of curves `which` (m,) at OpenCascade's parameters t (m,)."""
        result = np.empty((len(t), self.dimension))
        for kind, chosen, place in self._kinds.chosen(which):
            result[chosen] = self._points(kind, place, t[chosen])
        return result

    def _points(self, kind: Kind, place: Index, t: Array) -> Array:
        if kind in self._splines:
            knots, poles, first_pole, pole_count = self._splines[kind]
            span, t, around = knots.locate(place, t)
            index = first_pole[place] + (span + np.arange(knots.degree + 1)[:, None]) % pole_count[place]
            homogeneous = knots.reduce(poles[:, index], around, t)
            return np.asarray((homogeneous[:-1] / homogeneous[-1]).T)
        if kind == "offset":
            return self._offset(place, t)
        f, g = _CONICS[str(kind)]
        origin, a, b = self._tables[kind]
        return np.asarray(origin[place] + f(t)[:, None] * a[place] + g(t)[:, None] * b[place])

    def _offset(self, place: Index, t: Array) -> Array:
        basis, own = self._bases["offset"], self._kinds.members["offset"]
        tangent = basis(place, t + _DIFFERENCE) - basis(place, t - _DIFFERENCE)
        if self.dimension == 2:
            normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        else:
            normal = np.cross(tangent, np.array([curve.b for curve in own])[place])
        distance = np.array([curve.offset for curve in own])[place, None]
        return np.asarray(basis(place, t) + distance * normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _spline_tables(degree: int, curves: list[Curve]) -> tuple[_Knots, Array, Index, Index]:
    """Knots, poles (dim + 1, all curves' one after the other), each curve's first pole and number of poles."""
    splines, poles = [], []
    for curve in curves:
        assert curve.poles is not None
        if curve.knots is None or curve.multiplicities is None:
            splines.append((*_unit_knots(degree), False))
        else:
            splines.append((curve.knots, curve.multiplicities, curve.periodic))
        poles.append(curve.poles)
    count = np.array([len(own) for own in poles])
    columns = np.ascontiguousarray(np.concatenate(poles).T)
    return _Knots.of(degree, splines), columns, np.cumsum(count) - count, count


class Surfaces:
    """Surfaces evaluated together, in their own coordinates. surfaces: n of them, any kinds."""

    def __init__(self, surfaces: Sequence[Surface]) -> None:
        self._kinds = _Kinds(surfaces, lambda surface: surface.kind if surface.poles is None else surface.degrees)
        self._curves: dict[Kind, Curves] = {}
        self._bases: dict[Kind, Surfaces] = {}
        self._frames: dict[Kind, Array] = {}
        self._splines: dict[Kind, tuple[_Knots, _Knots, Array, Index, Index, Index]] = {}
        for kind, own in self._kinds.members.items():
            if isinstance(kind, tuple):
                self._splines[kind] = _surface_tables(own)
            elif kind == "offset":
                self._bases[kind] = Surfaces([surface.basis for surface in own if surface.basis])
            else:
                zero = (0.0, 0.0, 0.0)
                rows = [(s.origin or zero, s.x or zero, s.y or zero, s.z, (*s.radii, 0.0)) for s in own]
                self._frames[kind] = np.array(rows)
                if kind in ("extrusion", "revolution"):
                    self._curves[kind] = Curves([surface.curve for surface in own if surface.curve], 3)

    def __call__(self, which: Index, u: Array, v: Array) -> Array:
        """Points (m, 3) of surfaces `which` (m,) at OpenCascade's parameters u, v, each (m,)."""
        result = np.empty((len(u), 3))
        for kind, chosen, place in self._kinds.chosen(which):
            result[chosen] = self._points(kind, place, u[chosen], v[chosen])
        return result

    def _points(self, kind: Kind, place: Index, u: Array, v: Array) -> Array:
        if kind in self._splines:
            return self._spline(kind, place, u, v)
        if kind == "offset":
            basis = self._bases[kind]
            along_u = basis(place, u + _DIFFERENCE, v) - basis(place, u - _DIFFERENCE, v)
            along_v = basis(place, u, v + _DIFFERENCE) - basis(place, u, v - _DIFFERENCE)
            normal = np.cross(along_u, along_v)
            distance = np.array([surface.offset for surface in self._kinds.members[kind]])[place, None]
            return np.asarray(basis(place, u, v) + distance * normal / np.linalg.norm(normal, axis=1, keepdims=True))
        origin, x, y, z, radii = (self._frames[kind][place, k] for k in range(5))
        if kind == "extrusion":
            return np.asarray(self._curves[kind](place, u) + v[:, None] * z)
        if kind == "revolution":
            spoke = self._curves[kind](place, v) - origin
            axial = (spoke * z).sum(axis=1, keepdims=True) * z
            x, y, radius, height = spoke - axial, np.cross(z, spoke), np.ones_like(u), np.zeros_like(u)
            origin = origin + axial
        elif kind == "plane":
            return np.asarray(origin + u[:, None] * x + v[:, None] * y)
        else:
            r1, r2 = radii[:, 0], radii[:, 1]
            radius, height = {
                "cylinder": lambda: (r1, v),
                "cone": lambda: (r1 + v * np.sin(r2), v * np.cos(r2)),
                "sphere": lambda: (r1 * np.cos(v), r1 * np.sin(v)),
                "torus": lambda: (r1 + r2 * np.cos(v), r2 * np.sin(v)),
            }[str(kind)]()
        cosine, sine = (radius * np.cos(u))[:, None], (radius * np.sin(u))[:, None]
        return np.asarray(origin + cosine * x + sine * y + height[:, None] * z)

    def _spline(self, kind: Kind, place: Index, u: Array, v: Array) -> Array:
        along_u, along_v, poles, first_pole, rows, columns = self._splines[kind]
        result = np.empty((len(u), 3))
        step = max(1, _CHUNK // (4 * (along_u.degree + 1) * (along_v.degree + 1)))
        for begin in range(0, len(u), step):
            part = slice(begin, begin + step)
            own = place[part]
            row, s, around_u = along_u.locate(own, u[part])
            column, t, around_v = along_v.locate(own, v[part])
            i = (row + np.arange(along_u.degree + 1)[:, None]) % rows[own]
            j = (column + np.arange(along_v.degree + 1)[:, None]) % columns[own]
            index = first_pole[own] + i * columns[own] + j[:, None]
            homogeneous = along_v.reduce(along_u.reduce(poles[:, index], around_u, s), around_v, t)
            result[part] = (homogeneous[:3] / homogeneous[3]).T
        return result


def _surface_tables(surfaces: list[Surface]) -> tuple[_Knots, _Knots, Array, Index, Index, Index]:
    """Knots in u and v, poles (4, all surfaces'), each surface's first pole and numbers of poles in u and v."""
    knots = []
    for axis in (0, 1):
        degree = surfaces[0].degrees[axis]
        splines = [
            (*_unit_knots(degree), False)
            if s.knots is None or s.multiplicities is None
            else (s.knots[axis], s.multiplicities[axis], s.periodic[axis])
            for s in surfaces
        ]
        knots.append(_Knots.of(degree, splines))
    poles = [surface.poles for surface in surfaces if surface.poles is not None]
    rows, columns = (np.array([own.shape[k] for own in poles]) for k in (0, 1))
    flat = np.ascontiguousarray(np.concatenate([own.reshape(-1, 4) for own in poles]).T)
    return knots[0], knots[1], flat, np.cumsum(rows * columns) - rows * columns, rows, columns
