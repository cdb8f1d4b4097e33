"""The files that are measured: the project's own, and third-party ones where they lie beside the repository."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OWN = ROOT / "cad_models"
SHARED = ROOT.parent / "shared" / "models"


def own(*names: str) -> list[Path]:
    """The project's own models of these names, all of them without names; those that are missing are left out."""
    paths = [OWN / f"{name}.step" for name in names] if names else sorted(OWN.glob("*.step"))
    return [path for path in paths if path.exists()]


def third_party() -> list[Path]:
    """Every third-party model but the damaged ones, by folder and name; none where they are not there."""
    return sorted(path for path in SHARED.glob("*/*") if path.parent.name != "bad")
