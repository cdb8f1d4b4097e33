"""How often something is run, and what of its times is kept."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

FEWEST_RUNS, MOST_RUNS = 3, 25
ENOUGH_SECONDS = 1.0  # of repeating
MESH_SECONDS = 0.4  # the same for a mesh, of which there are many
TOO_SLOW = 10.0  # seconds after which nothing is repeated


@dataclass(frozen=True)
class Timing:
    """Wall-clock seconds of repeated runs."""

    fastest: float
    median: float
    runs: int


def repeat(function: Callable[[], Any], enough: float = ENOUGH_SECONDS) -> tuple[Timing, Any]:
    """Run it a few times, until that took `enough` seconds; the times, and what the fastest run returned."""
    seconds: list[float] = []
    best: Any = None
    while True:
        start = time.perf_counter()
        result = function()
        seconds.append(time.perf_counter() - start)
        if seconds[-1] == min(seconds):
            best = result
        spent = sum(seconds)
        done = len(seconds) >= FEWEST_RUNS and (spent > enough or len(seconds) >= MOST_RUNS)
        if done or spent > TOO_SLOW:
            return Timing(min(seconds), median(seconds), len(seconds)), best
