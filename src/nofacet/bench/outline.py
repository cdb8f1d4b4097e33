"""Our own outline against OpenCascade's rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..borders import ROW_SHIFT, Borders
from ..cad.ray_cast import RayCaster
from .subject import Subject

Array = NDArray[np.float64]

CHECKED_BORDERS = 100
FIRST_STEP, LAST_STEP = 1e-7, 1.0  # px: how far from our border OpenCascade's is sought
GRAZING = 1e-3  # px: how far from its silhouette a surface may look hit or missed


@dataclass(frozen=True)
class OutlineCheck:
    """Our own outline against OpenCascade's ray casting along the scan line, pixels: largest and median distance of
    the borders checked, and how many of them OpenCascade's rays do not show within a pixel."""

    largest: float
    median: float
    checked: int
    not_found: int


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
