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

from ..cad.ray_cast import RayCaster
from .borders import ROW_SHIFT, Borders
from .subject import Subject

Array = NDArray[np.float64]

STEEP = 0.7  # the least `across` that is measured: a little more than 45 degrees, so that none falls between
CHECKED_BORDERS = 100
FIRST_STEP, LAST_STEP = 1e-7, 1.0  # px: how far from our border OpenCascade's is sought
GRAZING = 1e-3  # px: how far from its silhouette a surface may look hit or missed


@dataclass(frozen=True)
class OutlineError:
    """Pixels. matched: borders measured. unmatched: borders that only one side has."""

    largest: float
    rms: float
    matched: int
    unmatched: int


@dataclass(frozen=True)
class OutlineCheck:
    """Our own outline against OpenCascade's ray casting along the scan line, pixels: largest and median distance of
    the borders checked, and how many of them OpenCascade's rays do not show within a pixel."""

    largest: float
    median: float
    checked: int
    not_found: int


def compare(exact: tuple[Borders, Borders], drawn: tuple[Borders, Borders]) -> OutlineError | None:
    """Measure the distances of matching borders. None if no borders match."""
    distances: list[Array] = []
    unmatched = 0
    for exact_side, drawn_side in zip(exact, drawn, strict=True):
        first, second, alone = _pairs(exact_side, drawn_side)
        unmatched += alone
        across = drawn_side.across[second]
        steep = np.minimum(exact_side.across[first], across) >= STEEP
        distances.append((np.abs(exact_side.x[first] - drawn_side.x[second]) * across)[steep])
    every = np.concatenate(distances)
    if not len(every):
        return None
    return OutlineError(float(every.max()), float(np.sqrt(np.mean(every**2))), len(every), unmatched)


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


def check_outline(subject: Subject, rows: Borders) -> OutlineCheck | None:
    """Seek borders of our rows, chosen at random, with OpenCascade's rays: bisection between a ray that hits and one
    that misses. Where a surface turns away there, its silhouette is solved for: grazing rays are found to 1e-5 pixels
    only. Along the scan line, so never less than the distance across the outline. None if no border is found.
    """
    caster = RayCaster(subject.shape)
    chosen = np.random.default_rng(1).permutation(len(rows.x))[:CHECKED_BORDERS]
    found = [_distance_to_change(subject, caster, rows, k) for k in chosen.tolist()]
    known = [distance for distance in found if distance is not None]
    if not known:
        return None
    return OutlineCheck(max(known), float(np.median(known)), len(found), len(found) - len(known))


def _distance_to_change(subject: Subject, caster: RayCaster, rows: Borders, k: int) -> float | None:
    """Distance from our border k to where OpenCascade's rays change from hit to miss; None if that is not near."""
    camera, (width, height) = subject.camera, subject.resolution
    right, up, forward = camera.axes()
    eye = np.array(camera.position)
    down = rows.line[k] + 0.5 + ROW_SHIFT

    def origin(x: float) -> Array:
        return eye + subject.pixel * ((x - width / 2) * right + (height / 2 - down) * up)

    border, inwards = float(rows.x[k]), 1.0 if rows.enters[k] else -1.0
    step = FIRST_STEP
    while not (
        caster.covers(origin(border + inwards * step), forward)
        and not caster.covers(origin(border - inwards * step), forward)
    ):
        step *= 10
        if step > LAST_STEP:
            return None
    inside, outside = border + inwards * step, border - inwards * step
    while abs(inside - outside) > 1e-3 * FIRST_STEP:
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if caster.covers(origin(middle), forward) else (inside, middle)
    change = (inside + outside) / 2
    silhouette = caster.silhouette(origin(inside), forward, up)
    if silhouette is not None:
        solved = width / 2 + (silhouette - eye) @ right / subject.pixel
        if abs(solved - change) < GRAZING:
            change = solved
    return float(abs(change - border))
