"""How far the patches of every file are from OpenCascade's surfaces, in parts of the model's size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import models
import numpy as np

import nofacet
from nofacet.extent import bounding_box

TITLE = "Conversion error against BRepAdaptor_Surface at equal (u, v), in parts of the model's size"
APPROXIMATED = ("offset",)  # the kinds of surface that are not rational in the measured files
LIMIT = 1e-9  # what the exact kinds must keep


def measure() -> list[dict[str, Any]]:
    """One row a file: counts, the largest relative error of exact and of approximated faces."""
    return [_row(path) for path in [*models.third_party(), *models.own()]]


def _row(path: Path) -> dict[str, Any]:
    model = nofacet.load(path, measure=True)
    low, high = bounding_box(model)
    size = float(np.linalg.norm(high - low))
    relative = model.conversion_error / size
    approximated = np.isin(model.surface_type, APPROXIMATED)
    exact = _largest(relative[~approximated])
    if exact is not None and exact > LIMIT:
        raise SystemExit(f"{path.name}: conversion error {exact:.1e} of the size, above {LIMIT:g}")
    return {
        "file": path.name,
        "faces": model.face_count,
        "distinct": model.definition_count,
        "patches": model.patch_count,
        "size (mm)": size,
        "exact faces": exact,
        "approximated faces": _largest(relative[approximated]),
        "not drawn": sum("not drawn" in warning for warning in model.warnings),
    }


def _largest(errors: np.ndarray) -> float | None:
    measured = errors[np.isfinite(errors)]
    return float(measured.max()) if len(measured) else None
