"""One run: everything is measured, model by model, and written down."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from ..borders import exact_borders
from ..errors import InputError
from ..render import methods
from . import embree, gl, plot, table
from .bars import bars
from .child import ChildFailure, in_child
from .crowd import measure_crowds
from .first_picture import measure_first_picture
from .frames import measure_frames
from .machine import describe
from .mesh_result import measure_mesh
from .mesh_setting import mesh_settings
from .outline import check_outline
from .ray_casting import measure_ray_casting
from .report import Report, SubjectResult
from .subject import Subject, default_names, open_subject

MESHING_LIMIT = 20.0  # seconds a mesh
CHECK_LIMIT = 60.0  # seconds for what OpenCascade's rays are asked
FILES = ("bench.md", "bench.json", "bench.png")
Say = Callable[[str], None]


def run(
    names: Sequence[str],
    resolution: tuple[int, int],
    threads: int,
    quick: bool,
    say: Say,
    meshing_limit: float = MESHING_LIMIT,
) -> Report:
    """Measure the named models, all default ones without names.

    quick: only frames, the floor and the first picture. say: called with a line as each stage begins, and for each
    model that cannot be read. What cannot be measured here gets a line in the report's left_out.
    """
    start = time.perf_counter()
    report = Report(describe(), threads)
    if not quick:
        report.left_out += [reason for reason in (gl.missing(), embree.missing(), plot.missing()) if reason]
    for name in names or default_names():
        try:
            say(f"{time.perf_counter() - start:.0f} s: {name}")
            subject = open_subject(name, resolution)
        except InputError as error:
            say(str(error))
            report.left_out.append(str(error))
            continue
        report.subjects.append(_measure(subject, threads, quick, meshing_limit, report.left_out))
        if not quick:
            say(f"{time.perf_counter() - start:.0f} s: {name}, many of it")
            report.crowds += measure_crowds(subject, threads)
    report.machine["seconds of the run"] = f"{time.perf_counter() - start:.0f}"
    return report


def _measure(subject: Subject, threads: int, quick: bool, meshing_limit: float, left_out: list[str]) -> SubjectResult:
    result = SubjectResult(
        subject.name, subject.resolution, subject.model.face_count, subject.model.placed_patch_count, subject.pixel
    )
    result.first_pictures = [measure_first_picture(subject, count) for count in dict.fromkeys((1, threads))]
    result.frames, result.floor = measure_frames(subject, threads, methods())
    if quick:
        return result
    exact = exact_borders(subject.model, subject.camera, subject.resolution)
    try:
        result.outline = in_child(lambda: check_outline(subject, exact[0]), CHECK_LIMIT)
        result.ray_casting = in_child(lambda: measure_ray_casting(subject), CHECK_LIMIT)
    except (TimeoutError, ChildFailure) as failure:
        left_out.append(f"{subject.name}, OpenCascade's rays: {failure}")
    from ..cad.tessellate import box_sides

    for setting in mesh_settings(subject.pixel, box_sides(subject.shape)):
        mesh = measure_mesh(subject, setting, exact, threads, meshing_limit, left_out)
        result.meshes += [mesh] if mesh else []
    return result


def write(report: Report, folder: Path, plotted: bool) -> str:
    """Put bench.md, bench.json and bench.png (if plotted) into the folder; the Markdown text.

    Raises OSError where they cannot be written.
    """
    found = bars(report)
    markdown = table.text(report, found)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.md").write_text(markdown, encoding="utf-8", errors="backslashreplace")  # for names not in UTF-8
    record = asdict(report) | {"bars": [asdict(bar) | {"verdict": bar.verdict} for bar in found]}
    (folder / "bench.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    if plotted and plot.missing() is None:
        plot.save(report, folder / "bench.png")
    return markdown
