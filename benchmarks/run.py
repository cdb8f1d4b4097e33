"""The benchmarks (`make bench`): each stage prints one table of time and error, and keeps it in results/.

    python benchmarks/run.py [--runs N] [STAGE...]

Stages: frames, extraction, conversion; all of them without STAGE. README.md says how to read the tables.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import conversion
import extraction
import frames

RESULTS = Path(__file__).parent / "results"
STAGES: dict[str, tuple[str, Callable[[int], list[dict[str, Any]]]]] = {
    "frames": (frames.TITLE, frames.measure),
    "extraction": (extraction.TITLE, extraction.measure),
    "conversion": (conversion.TITLE, lambda runs: conversion.measure()),
}
UNTIMED = ("conversion",)


def table(rows: list[dict[str, Any]]) -> str:
    """Rows of equal keys as a Markdown table."""
    lines = ["| " + " | ".join(rows[0]) + " |", "| " + " | ".join("---" for _ in rows[0]) + " |"]
    lines += ["| " + " | ".join(map(_cell, row.values())) + " |" for row in rows]
    return "\n".join(lines)


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.1e}" if 0 < abs(value) < 1e-4 else f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    return "-" if value is None else str(value)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stages", nargs="*", metavar="STAGE", help=f"some of {', '.join(STAGES)}")
    parser.add_argument("--runs", type=int, default=5, help="repetitions, of which the median is shown (default: 5)")
    options = parser.parse_args()
    unknown = [name for name in options.stages if name not in STAGES]
    if unknown:
        parser.error(f"unknown stage {unknown[0]}; the stages are {', '.join(STAGES)}")
    RESULTS.mkdir(exist_ok=True)
    for name in options.stages or STAGES:
        title, measure = STAGES[name]
        load_before = os.getloadavg()[0]
        rows = measure(options.runs)
        machine = f"{os.cpu_count()} cores, load {load_before:.1f} before and {os.getloadavg()[0]:.1f} after"
        how = "Nothing is timed here." if name in UNTIMED else f"Median of {options.runs} runs on {machine}."
        text = f"{title}\n\n{how}\n\n{table(rows)}\n"
        print(text, flush=True)
        (RESULTS / f"{name}.md").write_text(text, encoding="utf-8")
        record = {"title": title, "how": how, "rows": rows}
        (RESULTS / f"{name}.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
