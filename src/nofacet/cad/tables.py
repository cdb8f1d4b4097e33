"""Small tools for tables whose entries own runs of rows of another table: run k is offsets[k] .. offsets[k + 1]."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    before = np.cumsum(count) - count
    owner = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) + (start - before)[owner]


def rank_in_run(owner: NDArray[Any]) -> Index:
    """The place of each row among the rows of its owner, for rows that are sorted by owner."""
    places = np.arange(len(owner))
    first = np.append(True, owner[1:] != owner[:-1])[: len(owner)]
    return places - np.maximum.accumulate(np.where(first, places, 0))
