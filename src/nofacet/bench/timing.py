"""How often something is run, and what of its times is kept."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

FEWEST_RUNS, MOST_RUNS = 3, 15
ENOUGH_SECONDS = 1.5  # of repeating
TOO_SLOW = 10.0  # seconds after which nothing is repeated


@dataclass(frozen=True)
class Timing:
    """Wall-clock seconds of repeated runs."""

    fastest: float
    median: float
    runs: int


def repeat(function: Callable[[], Any]) -> tuple[Timing, Any]:
    """Run it a few times; the times, and what the fastest run returned."""
    seconds: list[float] = []
    best: Any = None
    while True:
        start = time.perf_counter()
        result = function()
        seconds.append(time.perf_counter() - start)
        if seconds[-1] == min(seconds):
            best = result
        spent = sum(seconds)
        enough = len(seconds) >= FEWEST_RUNS and (spent > ENOUGH_SECONDS or len(seconds) >= MOST_RUNS)
        if enough or spent > TOO_SLOW:
            return Timing(min(seconds), median(seconds), len(seconds)), best
