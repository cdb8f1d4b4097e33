"""The curves or surfaces of a stream: where each record starts, and many records of one kind read together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .geometry import CURVES, SURFACES, Curve, Surface, read_curve, read_surface

Array = NDArray[np.float64]
Index = NDArray[np.intp]

LINE, CIRCLE, ELLIPSE, BEZIER, BSPLINE, TRIMMED, OFFSET = (
    CURVES.index(kind) for kind in ("line", "circle", "ellipse", "bezier", "bspline", "trimmed", "offset")
)
BEZIER_SURFACE = SURFACES.index("bezier")

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


class Curves(Sequence[Curve]):
    """Curves in `dim` dimensions. Entry 0 is none, for records count from 1.

    kind: (n,), index into CURVES, of the curve itself where it is trimmed; at: (n,), the byte after that kind.
    """

    def __init__(self, data: bytes, dim: int, start: Index, kind: NDArray[np.uint8], at: Index) -> None:
        """start: (n,), the byte where each record starts."""
        self.data = data
        self.dim = dim
        self._start = start
        self.kind = kind
        self.at = at

    def __len__(self) -> int:
        return len(self._start)

    @overload
    def __getitem__(self, index: int) -> Curve: ...
    @overload
    def __getitem__(self, index: slice) -> list[Curve]: ...
    def __getitem__(self, index: int | slice) -> Curve | list[Curve]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        return read_curve(self.data, int(self._start[index]), self.dim)


def scan_curves(data: bytes, at: int, dim: int, count: int) -> tuple[Curves, int]:
    """The `count` curve records from byte `at`, and the byte after them."""
    start, kind, after, end = _native.scan_curves(data, at, dim, count)
    return Curves(data, dim, start, kind, after), end


class Surfaces(Sequence[Surface]):
    """Surfaces. Entry 0 is none, for records count from 1.

    kind: (n,), index into SURFACES, of the surface itself where it is trimmed; at: (n,), the byte after that kind.
    profiles: the curves of swept surfaces; profile: (n,), the index there, 0 for none.
    """

    def __init__(
        self, data: bytes, start: Index, kind: NDArray[np.uint8], at: Index, profiles: Curves, profile: Index
    ) -> None:
        """start: (n,), the byte where each record starts."""
        self.data = data
        self._start = start
        self.kind = kind
        self.at = at
        self.profiles = profiles
        self.profile = profile

    def __len__(self) -> int:
        return len(self._start)

    @overload
    def __getitem__(self, index: int) -> Surface: ...
    @overload
    def __getitem__(self, index: slice) -> list[Surface]: ...
    def __getitem__(self, index: int | slice) -> Surface | list[Surface]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        return read_surface(self.data, int(self._start[index]))

    def may_be_periodic(self, which: NDArray[Any]) -> NDArray[np.bool_]:
        """Whether surfaces `which` (n,) may have a period; planes, Bezier and most B-spline surfaces have none."""
        kind = self.kind[which]
        result = (kind != SURFACES.index("plane")) & (kind != BEZIER_SURFACE)
        splines = np.flatnonzero(kind == SURFACES.index("bspline"))
        headers = gather(self.data, self.at[which[splines]], SPLINE_NET)
        result[splines] = headers["periodic"].any(axis=1)
        return result


def scan_surfaces(data: bytes, at: int, count: int) -> tuple[Surfaces, int]:
    """The `count` surface records from byte `at`, and the byte after them."""
    (start, kind, after), profiles, profile, end = _native.scan_surfaces(data, at, count)
    return Surfaces(data, start, kind, after, Curves(data, 3, *profiles), profile), end
