"""Small tools for tables whose entries own runs of rows of another table: run k is offsets[k] .. offsets[k + 1]."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _native

Index = NDArray[np.intp]


def offsets_of(counts: NDArray[Any]) -> Index:
    """Offsets (n + 1,) of runs with these lengths (n,)."""
    result = np.zeros(len(counts) + 1, np.intp)
    np.cumsum(counts, out=result[1:])
    return result


def expand(offsets: Index, which: NDArray[Any]) -> tuple[Index, Index]:
    """The rows of the runs `which` (n,), one run behind the other: their places in `which`, and the rows' indices."""
    return expand_runs(offsets[which], offsets[which + 1] - offsets[which])


def expand_runs(start: NDArray[Any], count: NDArray[Any]) -> tuple[Index, Index]:
    """The numbers start[k] .. start[k] + count[k] - 1 for all k: k itself, and the numbers."""
    return _native.expand(start, count)


def distinct(keys: Index) -> tuple[Index, Index]:
    """The distinct ones of keys (n,) in the order of their first appearance: where each stands first (k,), ascending,
    and the place of each key's own there (n,)."""
    return _native.distinct(keys)


def marked(count: int, which: Any) -> NDArray[np.bool_]:
    """(count,), True at the indices `which`, an array or a list."""
    result = np.zeros(count, np.bool_)
    result[np.asarray(which, np.intp)] = True
    return result
