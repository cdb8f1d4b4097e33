"""The curves or surfaces of a stream: where each record starts, and many records of one kind read together."""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .geometry import CURVES, KNOTS, SURFACES, Curve, Surface, read_curve, read_surface

Array = NDArray[np.float64]
Index = NDArray[np.intp]

LINE, CIRCLE, ELLIPSE, BEZIER, BSPLINE, TRIMMED, OFFSET = (
    CURVES.index(kind) for kind in ("line", "circle", "ellipse", "bezier", "bspline", "trimmed", "offset")
)
_LAST_CONIC = CURVES.index("hyperbola")
BEZIER_SURFACE = SURFACES.index("bezier")

_BEZIER = Struct("<BH")  # rational, degree
_SPLINE = Struct("<BBHii")  # rational, periodic, degree, poles, knots
SPLINE = np.dtype([("rational", "?"), ("periodic", "?"), ("degree", "<u2"), ("poles", "<i4"), ("knots", "<i4")])
_BEZIER_NET = Struct("<BBHH")
BEZIER_NET = np.dtype([("rational", "?", 2), ("degree", "<u2", 2)])
_SPLINE_NET = Struct("<BBBBHHiiii")
SPLINE_NET = np.dtype(
    [("rational", "?", 2), ("periodic", "?", 2), ("degree", "<u2", 2), ("poles", "<i4", 2), ("knots", "<i4", 2)]
)


def gather(data: bytes, at: Index, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The records (n,) of a packed dtype that start at the bytes `at` (n,)."""
    size = dtype.itemsize
    everywhere: NDArray[Any] = np.ndarray((max(len(data) - size + 1, 0),), f"V{size}", data, strides=(1,))
    return everywhere[at].view(dtype)


def gather_reals(data: bytes, at: Index, count: int) -> Array:
    """`count` numbers from each of the bytes `at` (n,): (n, count)."""
    return gather(data, at, np.dtype(f"V{8 * count}")).view("<f8").reshape(-1, count)


def joined(data: bytes, start: Index, size: Index, dtype: Any) -> NDArray[Any]:
    """The arrays of `size` bytes from each of the bytes `start`, one behind the other."""
    ranges = zip(start.tolist(), (start + size).tolist(), strict=True)
    return np.frombuffer(b"".join([data[low:high] for low, high in ranges]), dtype)


class Curves(Sequence[Curve]):
    """Curves in `dim` dimensions. Entry 0 is none, for records count from 1.

    kind: (n,), index into CURVES, of the curve itself where it is trimmed; at: (n,), the byte after that kind.
    """

    def __init__(self, data: bytes, dim: int, start: list[int], kind: list[int], at: list[int]) -> None:
        self.data = data
        self.dim = dim
        self._start = start
        self.kind = np.array(kind, np.uint8)
        self.at = np.array(at, np.intp)

    def __len__(self) -> int:
        return len(self._start)

    @overload
    def __getitem__(self, index: int) -> Curve: ...
    @overload
    def __getitem__(self, index: slice) -> list[Curve]: ...
    def __getitem__(self, index: int | slice) -> Curve | list[Curve]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        return read_curve(self.data, self._start[index], self.dim)


def scan_curves(data: bytes, at: int, dim: int, count: int) -> tuple[Curves, int]:
    """The `count` curve records from byte `at`, and the byte after them."""
    sizes = _conic_sizes(dim)
    starts, kinds, places = [0], [0], [0]
    for _ in range(count):
        starts.append(at)
        kind = data[at]
        at += 1
        while kind == TRIMMED:
            kind = data[at + 16]
            at += 17
        kinds.append(kind)
        places.append(at)
        at = at + sizes[kind] if kind <= _LAST_CONIC else _end_of_curve(data, at, dim, kind)
    return Curves(data, dim, starts, kinds, places), at


def _conic_sizes(dim: int) -> tuple[int, ...]:
    """Bytes of a line, circle, ellipse, parabola, hyperbola record behind its kind."""
    frame = 8 * (3 * dim + (3 if dim == 3 else 0))
    return 0, 16 * dim, frame + 8, frame + 16, frame + 8, frame + 16


def _end_of_curve(data: bytes, at: int, dim: int, kind: int) -> int:
    if kind == BSPLINE:
        rational, _, _, poles, knots = _SPLINE.unpack_from(data, at)
        return at + 12 + 8 * poles * (dim + rational) + KNOTS.itemsize * knots
    if kind == BEZIER:
        rational, degree = _BEZIER.unpack_from(data, at)
        return int(at + 3 + 8 * (degree + 1) * (dim + rational))
    if kind == OFFSET:
        return scan_curves(data, at + (8 if dim == 2 else 32), dim, 1)[1]
    raise InputError(f"OpenCascade's binary format has an unknown kind of curve {kind}")


class Surfaces(Sequence[Surface]):
    """Surfaces. Entry 0 is none, for records count from 1.

    kind: (n,), index into SURFACES, of the surface itself where it is trimmed; at: (n,), the byte after that kind.
    profiles: the curves of swept surfaces; profile: (n,), the index there, 0 for none.
    """

    def __init__(self, data: bytes, start: list[int], kind: list[int], at: list[int], profile: list[int]) -> None:
        self.data = data
        self._start = start
        self.kind = np.array(kind, np.uint8)
        self.at = np.array(at, np.intp)
        starts = [0, *(s for s in profile if s)]
        records = [scan_curves(data, s, 3, 1)[0] for s in starts[1:]]
        self.profiles = Curves(
            data, 3, starts, [0, *(int(r.kind[1]) for r in records)], [0, *(int(r.at[1]) for r in records)]
        )
        self.profile = np.where(np.array(profile) > 0, np.cumsum(np.array(profile) > 0), 0)

    def __len__(self) -> int:
        return len(self._start)

    @overload
    def __getitem__(self, index: int) -> Surface: ...
    @overload
    def __getitem__(self, index: slice) -> list[Surface]: ...
    def __getitem__(self, index: int | slice) -> Surface | list[Surface]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        return read_surface(self.data, self._start[index])

    def may_be_periodic(self, which: NDArray[Any]) -> NDArray[np.bool_]:
        """Whether surfaces `which` (n,) may have a period; planes, Bezier and most B-spline surfaces have none."""
        kind = self.kind[which]
        result = (kind != SURFACES.index("plane")) & (kind != BEZIER_SURFACE)
        splines = np.flatnonzero(kind == SURFACES.index("bspline"))
        headers = gather(self.data, self.at[which[splines]], SPLINE_NET)
        result[splines] = headers["periodic"].any(axis=1)
        return result


_ELEMENTARY_SIZES = (0, 96, 104, 112, 104, 112)  # plane, cylinder, cone, sphere, torus


def scan_surfaces(data: bytes, at: int, count: int) -> tuple[Surfaces, int]:
    """The `count` surface records from byte `at`, and the byte after them."""
    starts, kinds, places, profiles = [0], [0], [0], [0]
    for _ in range(count):
        starts.append(at)
        kind = data[at]
        at += 1
        while SURFACES[kind] == "trimmed":
            kind = data[at + 32]
            at += 33
        kinds.append(kind)
        places.append(at)
        profiles.append({"extrusion": at + 24, "revolution": at + 48}.get(SURFACES[kind], 0))
        elementary = kind < len(_ELEMENTARY_SIZES)
        at = at + _ELEMENTARY_SIZES[kind] if elementary else _end_of_surface(data, at, SURFACES[kind])
    return Surfaces(data, starts, kinds, places, profiles), at


def _end_of_surface(data: bytes, at: int, kind: str) -> int:
    if kind == "extrusion":
        return scan_curves(data, at + 24, 3, 1)[1]
    if kind == "revolution":
        return scan_curves(data, at + 48, 3, 1)[1]
    if kind == "offset":
        return scan_surfaces(data, at + 8, 1)[1]
    if kind == "bezier":
        u, v, du, dv = _BEZIER_NET.unpack_from(data, at)
        return int(at + 6 + 8 * (du + 1) * (dv + 1) * (3 + (u | v)))
    u, v, _, _, _, _, nu, nv, ku, kv = _SPLINE_NET.unpack_from(data, at)
    return int(at + 24 + 8 * nu * nv * (3 + (u | v)) + KNOTS.itemsize * (ku + kv))
