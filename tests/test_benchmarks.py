"""The scripts in benchmarks/: each stage still makes its rows."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FLANGE = ROOT / "cad_models" / "flange.step"


@pytest.fixture(autouse=True)
def _scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))


def test_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = importlib.import_module("frames")
    monkeypatch.setattr(frames, "RESOLUTION", (160, 120))
    monkeypatch.setattr(frames, "CHECKED", 50)
    rows = frames._rows(FLANGE, 1)
    assert [(row["samples"], row["threads"]) for row in rows] == list(frames.CASES)
    for row in rows:
        assert row["error px"] < 1e-6
        assert row["unresolved"] == 0
        assert sum(row[f"{stage} s"] for stage in frames.STAGES) > 0


def test_extraction(monkeypatch: pytest.MonkeyPatch) -> None:
    extraction = importlib.import_module("extraction")
    monkeypatch.setattr(extraction, "FEWEST", 0)
    row = extraction._row(FLANGE, 1)
    assert row["patches"] >= row["faces"] > 0
    assert row["error / size"] < 1e-12
    assert all(row[key] >= 0 for key in row if key.endswith("CPU s"))


def test_conversion() -> None:
    row = importlib.import_module("conversion")._row(FLANGE)
    assert row["exact faces"] < 1e-12
    assert row["not drawn"] == 0
