"""How long OpenCascade takes to read a file, and how long we then take to make patches and trim loops of it, to prepare
them for drawing, and to open the file again."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any
from unittest.mock import patch

import models
import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Shape

import nofacet
from nofacet import _native, cache
from nofacet.cad import stream
from nofacet.cad.convert import convert
from nofacet.cad.measure import conversion_errors
from nofacet.extent import bounding_box

TITLE = "Patch extraction against OpenCascade's reading, files that draw over 100 faces"
FEWEST = 100


def measure(runs: int) -> list[dict[str, Any]]:
    """One row a file: median CPU seconds of `runs` of each stage, ratios, the conversion error."""
    rows = [_row(path, runs) for path in [*models.third_party(), *models.own()]]
    return [row for row in rows if row]


def _median(runs: int, work: Callable[[], object]) -> float:
    """Median CPU seconds."""
    seconds = []
    for _ in range(runs):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return median(seconds)


def _row(path: Path, runs: int) -> dict[str, Any]:
    shape = _read(path)
    model = convert(shape, str(path))
    if model.face_count <= FEWEST:
        return {}
    reading = _median(runs, lambda: _read(path))
    streaming = _median(runs, lambda: stream.read(shape))
    extraction = _median(runs, lambda: convert(shape, str(path)))
    low, high = bounding_box(model)
    errors = conversion_errors(shape, model) / np.linalg.norm(high - low)
    return {
        "file": path.name,
        "faces": model.face_count,
        "patches": model.patch_count,
        "reading CPU s": reading,
        "extraction CPU s": extraction,
        "of it stream": streaming,
        "extraction / reading": extraction / reading,
        "fit CPU s": _median(runs, lambda: nofacet.Camera.fit(model)),
        "prepare CPU s": _median(runs, lambda: _native.Scene(model)),
        "opening again CPU s": _opening_again(path, runs),
        "error / size": float(np.nanmax(errors)) if np.isfinite(errors).any() else None,
    }


def _opening_again(path: Path, runs: int) -> float:
    """Median CPU seconds of load() where the cache holds the model."""
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, {cache.SETTING: folder}):
        nofacet.load(path)
        return _median(runs, lambda: nofacet.load(path))


def _read(path: Path) -> TopoDS_Shape:
    """OpenCascade's own reading, without colours and names."""
    if path.suffix == ".brep":
        shape = TopoDS_Shape()
        BRepTools.Read_s(shape, str(path), BRep_Builder())
        return shape
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()
