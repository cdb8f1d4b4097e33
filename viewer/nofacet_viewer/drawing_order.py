"""In which order triangles are drawn: opaque ones first, then transparent ones from back to front."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet


class DrawingOrder:
    """The index buffer of a mesh. It is written again only when something has changed that the order depends on."""

    def __init__(self, context: moderngl.Context, mesh: nofacet.Mesh) -> None:
        self.indices = context.buffer(reserve=max(12, 12 * len(mesh.triangles)))
        self.opaque = self.transparent = 0  # triangles in it, in this order
        self._mesh = mesh
        self._chosen: NDArray[np.int64] = np.zeros(0, np.int64)  # the transparent ones
        self._middles: NDArray[np.float64] = np.zeros((0, 3))  # theirs
        self._parted_by: Any = None
        self._sorted_along: NDArray[np.float64] | None = None

    def part(self, alpha: NDArray[np.float32], blends: bool | None = None) -> None:
        """Sort out what is drawn. alpha: of every face (F,), the same array as long as nothing changes; faces with 0
        are hidden. blends: whether others below 1 are transparent, or opaque like the rest; None: either will do."""
        by = self._parted_by
        if by is not None and by[0] is alpha and blends in (None, by[1]):
            return
        self._parted_by, self._sorted_along = (alpha, bool(blends)), None
        of_triangle = alpha[self._mesh.face]
        is_opaque = of_triangle >= 1 if blends else of_triangle > 0
        self._chosen = np.flatnonzero(~is_opaque & (of_triangle > 0))
        self._middles = self._mesh.points[self._mesh.triangles[self._chosen]].mean(axis=1)
        self.opaque, self.transparent = int(is_opaque.sum()), len(self._chosen)
        self._write(np.concatenate([np.flatnonzero(is_opaque), self._chosen]), 0)

    def sort(self, forward: NDArray[np.float64]) -> None:
        """Bring transparent triangles into order: from the farthest to the nearest along a world direction (3,)."""
        same = self._sorted_along is not None and np.array_equal(self._sorted_along, forward)
        if not self.transparent or same:
            return
        self._sorted_along = forward.copy()
        self._write(self._chosen[np.argsort(-(self._middles @ forward), kind="stable")], self.opaque)

    def release(self) -> None:
        self.indices.release()

    def _write(self, triangles: NDArray[np.int64], first: int) -> None:
        if len(triangles):
            self.indices.write(self._mesh.triangles[triangles], offset=12 * first)
