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
    """Wall-clock seconds of repeated runs, of all and of each."""

    fastest: float
    median: float
    runs: int
    each: tuple[float, ...]

    @classmethod
    def of(cls, each: list[float]) -> Timing:
        return cls(min(each), median(each), len(each), tuple(each))


def ratio(one: Timing, other: Timing) -> float:
    """How many times as long one takes as the other, both timed by the same repeat_in_turn: the median over its rounds,
    because within one the machine's speed hardly changes; the fastest runs of both may be minutes apart."""
    return median(a / b for a, b in zip(one.each, other.each, strict=True))


def repeat(function: Callable[[], Any], enough: float = ENOUGH_SECONDS) -> tuple[Timing, Any]:
    """Run it a few times, until that took `enough` seconds; the times, and what the fastest run returned."""
    return repeat_in_turn([function], enough)[0]


def repeat_in_turn(functions: list[Callable[[], Any]], enough: float = ENOUGH_SECONDS) -> list[tuple[Timing, Any]]:
    """The same for several whose times are to be compared: one after the other in each round, because a machine's
    speed drifts. Rounds go on until they took `enough` seconds for each."""
    seconds: list[list[float]] = [[] for _ in functions]
    best: list[Any] = [None for _ in functions]
    while True:
        for k, function in enumerate(functions):
            start = time.perf_counter()
            result = function()
            seconds[k].append(time.perf_counter() - start)
            if seconds[k][-1] == min(seconds[k]):
                best[k] = result
        spent, rounds = sum(map(sum, seconds)), len(seconds[0])
        done = rounds >= FEWEST_RUNS and (spent > enough * len(functions) or rounds >= MOST_RUNS)
        if done or spent > TOO_SLOW * len(functions):
            return [(Timing.of(times), kept) for times, kept in zip(seconds, best, strict=True)]
