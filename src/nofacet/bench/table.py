"""A run's results as Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ..render import DEFAULT_METHOD
from .bars import Bar
from .crowd import CrowdTime
from .frames import FrameTime
from .mesh_result import MeshResult
from .report import Report, SubjectResult
from .timing import ratio


def text(report: Report, bars: list[Bar]) -> str:
    """All tables."""
    machine = "; ".join(f"{key} {value}" for key, value in report.machine.items())
    width, height = report.subjects[0].resolution if report.subjects else (0, 0)
    parts = [
        "# Speed and error, measured in one run",
        f"{width} x {height} pixels, orthographic. {machine}.",
        "## Bars",
        _table([_bar_row(bar) for bar in bars]) if bars else "Nothing was measured that a bar is set for.",
        "## Frames and the floor",
        _table([row for result in report.subjects for row in _frame_rows(result)]),
        "## First pictures",
        _table([row for result in report.subjects for row in _first_picture_rows(result)]),
        "## Time and error",
        _table([row for result in report.subjects for row in _error_rows(result, report.threads)]),
    ]
    if report.crowds:
        parts += ["## Many patches", _table([_crowd_row(crowd) for crowd in report.crowds])]
    if report.left_out:
        parts += ["## Not measured", "\n".join(f"- {line}" for line in report.left_out)]
    return "\n\n".join(parts) + "\n"


def _bar_row(bar: Bar) -> dict[str, Any]:
    must, aim = (None if limit is None else f"{'>=' if bar.at_least else '<='} {limit:g}" for limit in bar.limits)
    bound = "> " if bar.open_ended else ""
    measured = f"{bound}{_number(bar.measured)}{f' {bar.unit}' if bar.unit else ''}"
    return {"bar": bar.text, "model": bar.model, "measured": measured, "must": must, "aim": aim, "verdict": bar.verdict}


def _frame_rows(result: SubjectResult) -> Iterator[dict[str, Any]]:
    for frame in result.frames:
        floor = result.floor if frame.threads == 1 and frame.samples == 1 else None
        yield {
            "model": result.name,
            "faces": result.faces,
            "patches": result.patches,
            "method": frame.method,
            "samples": frame.samples,
            "threads": frame.threads,
            "fastest ms": 1e3 * frame.seconds.fastest,
            "median ms": 1e3 * frame.seconds.median,
            "runs": frame.seconds.runs,
            "floor ms": floor and 1e3 * floor.seconds.fastest,
            "ns a sample": floor and floor.samples and 1e9 * floor.seconds.fastest / floor.samples,
            "frame / floor": floor and ratio(frame.seconds, floor.seconds),
            "pieces": frame.pieces,
            "stages ms": _stages(frame.stages),
        }


def _first_picture_rows(result: SubjectResult) -> Iterator[dict[str, Any]]:
    for one in result.first_pictures:
        yield {
            "model": result.name,
            "threads": one.threads,
            "extraction ms": 1e3 * one.extraction,
            "first frame ms": 1e3 * one.frame,
            "together ms": 1e3 * one.seconds,
            "of it preparation ms": 1e3 * one.preparation,
            "fitting a camera ms": 1e3 * one.fit,
        }


def _stages(stages: dict[str, float]) -> str:
    return ", ".join(f"{name} {_number(1e3 * value)}" for name, value in stages.items())


COLUMNS = (
    "model",
    "drawn from",
    "made in s",
    "OpenGL ms",
    "frame ms, 1 thread",
    "frame ms, {threads} threads",
    "outline error max px",
    "RMS px",
    "unmatched / all",
    "triangles or pieces",
    "MB",
)


def _error_rows(result: SubjectResult, threads: int) -> Iterator[dict[str, Any]]:
    columns = [column.format(threads=threads) for column in COLUMNS]

    def row(*values: Any) -> dict[str, Any]:
        return dict(zip(columns, (result.name, *values), strict=True))

    for method in dict.fromkeys(frame.method for frame in result.frames):
        one, several = result.frame(method, 1, 1), result.frame(method, threads, 1)
        yield row(
            f"exact: {method}",
            *_made(result, method),
            None,
            _ms(one),
            _ms(several),
            *_checked(result, method),
            one and one.pieces,
            None,
        )
    for mesh in result.meshes:
        yield row(f"mesh: {mesh.setting.name}", *_mesh_cells(mesh, threads))
    if result.ray_casting:
        frame_ms = 1e3 * result.ray_casting.frame_seconds
        name = f"exact: OpenCascade rays, extrapolated from {result.ray_casting.rays}"
        yield row(name, None, None, frame_ms, *(None,) * 6)


def _made(result: SubjectResult, method: str) -> tuple[float | None]:
    own = result.first_picture(1) if method == DEFAULT_METHOD else None
    return (own.extraction if own else None,)


def _checked(result: SubjectResult, method: str) -> tuple[Any, ...]:
    """Largest difference from OpenCascade's rays; no RMS; borders that these do not show, of those checked."""
    check = result.outline if method == DEFAULT_METHOD else None
    return (check.largest, None, f"{check.not_found} / {check.checked}") if check else (None, None, None)


def _mesh_cells(mesh: MeshResult, threads: int) -> tuple[Any, ...]:
    if mesh.timed_out:
        return (f"> {mesh.seconds:g}", *(None,) * 8)
    outline = mesh.outline
    return (
        mesh.seconds,
        mesh.opengl and 1e3 * mesh.opengl,
        *(mesh.embree.get(count) and 1e3 * mesh.embree[count] for count in (1, threads)),
        outline and outline.largest,
        outline and outline.rms,
        outline and f"{outline.unmatched} / {outline.matched + outline.unmatched}",
        mesh.triangles,
        mesh.megabytes,
    )


def _ms(frame: FrameTime | None) -> float | None:
    return 1e3 * frame.seconds.fastest if frame else None


def _crowd_row(crowd: CrowdTime) -> dict[str, Any]:
    return {
        "model": crowd.model,
        "instances": crowd.instances,
        "patches": crowd.patches,
        "threads": crowd.threads,
        "fastest ms": 1e3 * crowd.seconds.fastest,
        "median ms": 1e3 * crowd.seconds.median,
        "pieces": crowd.pieces,
        "stages ms": _stages(crowd.stages),
    }


def _table(rows: Sequence[dict[str, Any]]) -> str:
    """Rows of equal keys as a Markdown table."""
    if not rows:
        return "Nothing."
    lines = ["| " + " | ".join(rows[0]) + " |", "| " + " | ".join("---" for _ in rows[0]) + " |"]
    lines += ["| " + " | ".join(map(_cell, row.values())) + " |" for row in rows]
    return "\n".join(lines)


def _cell(value: object) -> str:
    return "-" if value is None else _number(value) if isinstance(value, float) else str(value)


def _number(value: float) -> str:
    return f"{value:.1e}" if 0 < abs(value) < 1e-3 else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
