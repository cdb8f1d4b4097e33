"""Every third-party model from three cameras each, judged ray by ray by OpenCascade (`make oracle`).

    python tests/oracle_all.py [--seed N] [--samples N] [--resolution W,H] [--processes N] [--timeout S] [MODEL...]

Without MODEL: every file in ../shared/models outside bad/. The judge and the cameras are those of ../shared/oracle
(check_frame.py settles disagreements by evaluating the B-rep itself; run.py with the same seed sees the same cameras).
Prints one line a frame, one line for each faulty pixel, and a total; the exit status is 1 if there is any fault.
Each model has a process of its own, so that one that crashes or hangs costs only itself.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

import nofacet

SHARED = Path(__file__).resolve().parents[2] / "shared"
BUFFERS = ("depth", "face", "uv", "position", "normal")
FAULTS = ("invalid", "missed", "bad_normal", "failed")
RECORD = "#"  # starts the line of JSON that a child process reports with


def models() -> list[Path]:
    """Every file the renderer must draw right, small ones first."""
    files = (path for path in (SHARED / "models").glob("*/*") if path.parent.name != "bad")
    return sorted(files, key=lambda path: path.stat().st_size)


def tolerant_oracle(check_frame: Any, shape: Any) -> Any:
    """The judge, for rays on which OpenCascade's intersector throws (near some edges of HEAD_BACK).

    Such a ray is intersected with each face alone, and only the faces that throw are left out; `gave_up` counts it.
    """
    from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
    from OCP.IntCurvesFace import IntCurvesFace_Intersector

    class TolerantOracle(check_frame.Oracle):
        gave_up = 0

        def first_hit(self, origin: Any, direction: Any) -> Any:
            try:
                return super().first_hit(origin, direction)
            except Exception:  # OCP's exceptions have no other base
                self.gave_up += 1
            length = float(np.linalg.norm(direction))
            line = gp_Lin(gp_Pnt(*map(float, origin)), gp_Dir(*map(float, direction / length)))
            hits = []
            for index, face in enumerate(self.faces):
                with contextlib.suppress(Exception):
                    caster = IntCurvesFace_Intersector(face, 1e-9)
                    caster.Perform(line, 0.0, 1e100)
                    for k in range(1, caster.NbPnt() + 1):
                        hits.append((caster.WParameter(k) / length, index, caster.UParameter(k), caster.VParameter(k)))
            return min((hit for hit in hits if hit[0] > 0), default=None)

    return TolerantOracle(shape)


def judge(path: Path, seed: int, samples: int, resolution: tuple[int, int], threads: int = 1) -> list[dict[str, Any]]:
    """One record a camera: check_frame's result, the file, the camera, stage times and the frame's statistics."""
    sys.path.insert(0, str(SHARED / "oracle"))
    import check_frame  # type: ignore[import-not-found]
    import run  # type: ignore[import-not-found]

    shape = check_frame.load(path)
    oracle = tolerant_oracle(check_frame, shape)
    start = time.perf_counter()
    model = nofacet.load(path)
    load_seconds = time.perf_counter() - start
    rng = np.random.default_rng([seed, sum(path.name.encode())])  # as run.py does
    records = []
    for index, camera in enumerate(run.cameras(shape, oracle, rng)):
        start = time.perf_counter()
        frame = nofacet.render(
            model, nofacet.Camera.from_dict(camera), resolution, samples=1, threads=threads, buffers=BUFFERS
        )
        render_seconds = time.perf_counter() - start
        arrays = {name: getattr(frame, name) for name in BUFFERS}
        start = time.perf_counter()
        record = check_frame.check(shape, arrays, camera, samples, seed, oracle=oracle)
        for fault in record["faults"]:
            fault["surface"] = model.surface_type[model.face_definition[fault["face"]]]
        record |= dict(name=path.name, index=index, camera=camera, failed=0, unresolved=frame.stats["unresolved"])
        record["gave_up"], oracle.gave_up = oracle.gave_up, 0
        record |= dict(load=load_seconds, render=render_seconds, check=time.perf_counter() - start)
        records.append(record)
    return records


def judge_in_child(path: Path, options: argparse.Namespace) -> list[dict[str, Any]]:
    """The records of one model, or a single one that says why there are none."""
    command = [sys.executable, __file__, "--child", f"--seed={options.seed}", f"--samples={options.samples}"]
    command += [f"--resolution={options.resolution[0]},{options.resolution[1]}", str(path)]
    try:
        child = subprocess.run(command, capture_output=True, text=True, timeout=options.timeout)
    except subprocess.TimeoutExpired:
        return [dict(name=path.name, failed=1, why=f"not done after {options.timeout:g} s")]
    records = [json.loads(line[1:]) for line in child.stdout.splitlines() if line.startswith(RECORD)]
    if child.returncode or not records:
        why = (child.stderr.strip().splitlines() or ["no message"])[-1]
        return [dict(name=path.name, failed=1, why=f"exit status {child.returncode}: {why}")]
    return records


def report(record: dict[str, Any]) -> None:
    if "why" in record:
        print(f"{record['name']}: FAILED: {record['why']}", flush=True)
        return
    counts = " ".join(
        f"{key}={record[key]}" for key in ("invalid", "missed", "bad_normal", "unresolved", "ambiguous", "gave_up")
    )
    times = " ".join(f"{key}={record[key]:.2f}s" for key in ("load", "render", "check"))
    worst = f"worst={record['max_position_px']:.1e}px,{record['max_normal_deg']:.1e}deg"
    print(f"{record['name']} camera {record['index']}: {counts} hits={record['hits']} {worst} {times}", flush=True)
    if record["faults"]:
        print(f"  camera {json.dumps(record['camera'])}")
    for fault in record["faults"]:
        where = f"{fault['kind']} at pixel ({fault['col']}, {fault['row']}), face {fault['face']} ({fault['surface']})"
        known = ("kind", "row", "col", "face", "surface")
        print(
            f"  {where}: " + ", ".join(f"{key} {value}" for key, value in fault.items() if key not in known), flush=True
        )


def size(text: str) -> tuple[int, int]:
    width, height = (int(part) for part in text.split(","))
    return width, height


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, default=4000, help="rays a frame")
    parser.add_argument("--resolution", type=size, default=(640, 480), metavar="W,H")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=3600, help="seconds a model may take")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        for record in judge(options.models[0], options.seed, options.samples, options.resolution):
            print(RECORD + json.dumps(record))
        return 0
    chosen = options.models or models()
    if not chosen:
        print(f"no models: {SHARED / 'models'} is not there", file=sys.stderr)
        return 1
    total: Counter[str] = Counter()
    with ThreadPoolExecutor(options.processes) as pool:
        for records in pool.map(lambda path: judge_in_child(path, options), chosen):
            for record in records:
                report(record)
                total.update({key: record.get(key, 0) for key in ("samples", "ambiguous", "gave_up", *FAULTS)})
                total["frames"] += "why" not in record
    print(f"{len(chosen)} models, " + ", ".join(f"{count} {key}" for key, count in total.items()))
    return 1 if any(total[key] for key in FAULTS) else 0


if __name__ == "__main__":
    sys.exit(main())
