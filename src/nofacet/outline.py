"""How far a drawn outline is from the exact one, on every pixel row and column.

A scan line through the pixel centres of a row (or column) meets the model, and a mesh of it, in covered stretches. From
left to right the two differ first at one border and then until the next: if that is the other side's, the two are one
border in two places, and the distance is measured across the mesh's edge there; if it is the same side's, they bound a
sliver that only one side has. Where the outline runs more along the scan line than across it, it is left to the scan
lines of the other direction; borders at the picture's sides count nowhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .borders import Borders

Array = NDArray[np.float64]

STEEP = 0.7  # the least `across` that is measured: a little more than 45 degrees, so that none falls between


@dataclass(frozen=True)
class MatchedBorders:
    """Borders on the scan lines of one direction that both sides have.

    line: (n,) int64, the scan line. exact, drawn: (n,) pixels along it. distance: (n,) pixels across the drawn outline,
    positive where what is drawn reaches beyond the exact outline. unmatched: how many borders only one side has.
    """

    line: NDArray[np.int64]
    exact: Array
    drawn: Array
    distance: Array
    unmatched: int


@dataclass(frozen=True)
class OutlineError:
    """Pixels. matched: borders measured. unmatched: borders that only one side has."""

    largest: float
    rms: float
    matched: int
    unmatched: int


def match(exact: Borders, drawn: Borders) -> MatchedBorders:
    """The borders of one direction that match and are measured on its scan lines."""
    first, second, unmatched = _pairs(exact, drawn)
    across = drawn.across[second]
    steep = np.minimum(exact.across[first], across) >= STEEP
    first, second, across = first[steep], second[steep], across[steep]
    beyond = np.where(exact.enters[first], 1, -1) * (exact.x[first] - drawn.x[second])
    return MatchedBorders(exact.line[first], exact.x[first], drawn.x[second], beyond * across, unmatched)


def outline_error(matched: tuple[MatchedBorders, MatchedBorders]) -> OutlineError | None:
    """The distances of both directions in numbers. None if no borders match."""
    distances = np.concatenate([one.distance for one in matched])
    if not len(distances):
        return None
    rms = float(np.sqrt(np.mean(distances**2)))
    unmatched = sum(one.unmatched for one in matched)
    return OutlineError(float(np.abs(distances).max()), rms, len(distances), unmatched)


def compare(exact: tuple[Borders, Borders], drawn: tuple[Borders, Borders]) -> OutlineError | None:
    """Measure the distances of matching borders on rows and on columns. None if no borders match."""
    return outline_error((match(exact[0], drawn[0]), match(exact[1], drawn[1])))


def _pairs(p: Borders, q: Borders) -> tuple[NDArray[np.int64], NDArray[np.int64], int]:
    """Indices of the borders of p and of q that match, and how many of both match nothing.

    Both sides cover nothing before a scan line's first border, so the first and the second bound the first stretch on
    which they differ, the third and the fourth the next, and so on.
    """
    line = np.concatenate([p.line, q.line])
    side = np.repeat([0, 1], [len(p.line), len(q.line)])
    index = np.concatenate([np.arange(len(p.line)), np.arange(len(q.line))])
    order = np.lexsort((np.concatenate([p.x, q.x]), line))
    line, side, index = line[order], side[order], index[order]
    starts = np.searchsorted(line, line)
    place = np.arange(len(line)) - starts
    opens = np.flatnonzero(place % 2 == 0)
    opens = opens[opens + 1 < len(line)]
    opens = opens[(line[opens] == line[opens + 1]) & (side[opens] != side[opens + 1])]
    from_p = np.where(side[opens] == 0, opens, opens + 1)
    from_q = np.where(side[opens] == 0, opens + 1, opens)
    return index[from_p], index[from_q], len(line) - 2 * len(opens)
