"""How long OpenCascade takes to read a file, and how long we then take to make patches and trim loops of it."""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median
from typing import Any

import models
import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Shape

from nofacet.cad import stream
from nofacet.cad.convert import convert
from nofacet.cad.measure import conversion_errors
from nofacet.extent import bounding_box

TITLE = "Patch extraction against OpenCascade's reading, files that draw over 100 faces"
FEWEST = 100


def measure(runs: int) -> list[dict[str, Any]]:
    """One row a file: median CPU seconds of `runs` readings and extractions, their ratio, the conversion error."""
    rows = [_row(path, runs) for path in [*models.third_party(), *models.own()]]
    return [row for row in rows if row]


def _row(path: Path, runs: int) -> dict[str, Any]:
    start = time.process_time()
    shape = _read(path)
    reading = [time.process_time() - start]
    model = convert(shape, str(path))
    if model.face_count <= FEWEST:
        return {}
    for _ in range(1, runs):
        start = time.process_time()
        shape = _read(path)
        reading.append(time.process_time() - start)
    streaming, extraction = [], []
    for _ in range(runs):
        start = time.process_time()
        stream.read(shape)
        streaming.append(time.process_time() - start)
        start = time.process_time()
        model = convert(shape, str(path))
        extraction.append(time.process_time() - start)
    low, high = bounding_box(model)
    errors = conversion_errors(shape, model) / np.linalg.norm(high - low)
    return {
        "file": path.name,
        "faces": model.face_count,
        "patches": model.patch_count,
        "reading CPU s": median(reading),
        "extraction CPU s": median(extraction),
        "of it stream": median(streaming),
        "extraction / reading": median(extraction) / median(reading),
        "error / size": float(np.nanmax(errors)) if np.isfinite(errors).any() else None,
    }


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
