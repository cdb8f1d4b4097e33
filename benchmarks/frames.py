"""How long a frame takes, stage by stage, and how far its points are from the exact surface and the pixel's ray."""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median
from typing import Any

import models
import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

import nofacet
from nofacet.cad.convert import convert
from nofacet.cad.read import read_file

TITLE = "Frames of 1920 x 1080, buffers color, coverage, depth and face, edge lines"
RESOLUTION = (1920, 1080)
CASES = ((4, 2), (4, 1), (1, 2))  # (samples, threads)
STAGES = ("subdivide", "span", "visibility", "shade", "average", "edge")
OWN = ("flange", "teapot", "bottle", "chain")
THIRD_PARTY = ("nist_ctc_02_asme1_rc.stp", "linkrods.step")
CHECKED = 4000  # pixels whose point is compared


def measure(runs: int) -> list[dict[str, Any]]:
    """One row for each model, samples and threads: median seconds of `runs` frames, the worst error found."""
    paths = models.own(*OWN) + [path for path in models.third_party() if path.name in THIRD_PARTY]
    return [row for path in paths for row in _rows(path, runs)]


def _rows(path: Path, runs: int) -> list[dict[str, Any]]:
    file = read_file(str(path))
    model = file.appearance.applied_to(convert(file.shape, str(path)))
    camera = nofacet.Camera.fit(model, resolution=RESOLUTION)
    error = _error(file.shape, model, camera)  # prepares the model too: that is not part of a frame's time
    rows = []
    for samples, threads in CASES:
        seconds, cpu_seconds, stats = [], [], []
        for _ in range(runs):
            start, cpu_start = time.perf_counter(), time.process_time()
            frame = nofacet.render(model, camera, RESOLUTION, samples=samples, threads=threads, edges=True)
            seconds.append(time.perf_counter() - start)
            cpu_seconds.append(time.process_time() - cpu_start)
            stats.append(frame.stats)
        row: dict[str, Any] = {"model": path.name, "samples": samples, "threads": threads, "pieces": stats[0]["pieces"]}
        row |= {f"{stage} s": median(one[f"{stage}_seconds"] for one in stats) for stage in STAGES}
        row |= {"frame s": median(seconds), "CPU s": median(cpu_seconds)}
        rows.append(row | {"error px": error, "unresolved": stats[0]["unresolved"]})
    return rows


def _error(shape: TopoDS_Shape, model: nofacet.Model, camera: nofacet.Camera) -> float:
    """Largest distance, in pixels, of OpenCascade's surface at the shown (u, v) from the shown point on the ray."""
    frame = nofacet.render(model, camera, RESOLUTION, samples=1, buffers=("depth", "face", "uv"))
    shown = np.argwhere(frame.face >= 0)
    shown = shown[np.random.default_rng(1).integers(0, len(shown), CHECKED)]
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    pixel = camera.extent_at_unit_depth() / RESOLUTION[1]  # orthographic: the same everywhere
    position, worst = frame.position, 0.0
    for row, column in shown:
        face = TopoDS.Face_s(faces.FindKey(int(frame.face[row, column]) + 1))
        point = BRepAdaptor_Surface(face, False).Value(*map(float, frame.uv[row, column]))
        distance = np.linalg.norm(position[row, column] - (point.X(), point.Y(), point.Z()))
        worst = max(worst, float(distance) / pixel)
    return worst
