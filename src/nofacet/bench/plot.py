"""The run's plot: time against outline error."""

from __future__ import annotations

from pathlib import Path

from ..render import DEFAULT_METHOD
from .report import Report, SubjectResult

Point = tuple[float, float]  # seconds, pixels


def missing() -> str | None:
    """Why nothing can be plotted here; None if it can."""
    from importlib.util import find_spec

    return None if find_spec("matplotlib") else "the plot: the package matplotlib is not installed"


def save(report: Report, path: Path) -> None:
    """Two log-log diagrams as one PNG: outline error against the time to the first picture, and against a later frame's
    time. A colour is a model; dots are OpenCascade's meshes, stars our own frames."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 6), layout="constrained")
    FigureCanvasAgg(figure)
    titles = ("first picture: meshing and one OpenGL frame, or extraction and one frame", "later frames, all cores")
    for axes, title, first in zip(figure.subplots(1, 2, sharey=True), titles, (True, False), strict=True):
        for index, result in enumerate(report.subjects):
            color = f"C{index}"
            meshes = _mesh_points(result, first)
            axes.plot([x for x, _ in meshes], [y for _, y in meshes], "o", color=color, alpha=0.6, label=result.name)
            own = _own_points(result, report.threads, first)
            axes.plot([x for x, _ in own], [y for _, y in own], "*", color=color, markersize=14)
        axes.set(xscale="log", yscale="log", xlabel="seconds", title=title)
        axes.grid(True, which="major", alpha=0.3)
    figure.axes[0].set_ylabel("largest outline error, pixels")
    labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(*labels, title="dots: meshes\nstars: nofacet", fontsize="small", loc="outside right upper")
    figure.savefig(path, dpi=100)


def _mesh_points(result: SubjectResult, first: bool) -> list[Point]:
    return [
        (mesh.seconds + mesh.opengl if first else mesh.opengl, mesh.outline.largest)
        for mesh in result.meshes
        if mesh.opengl and mesh.outline and mesh.outline.largest > 0
    ]


def _own_points(result: SubjectResult, threads: int, first: bool) -> list[Point]:
    picture, frame = result.first_picture(threads), result.frame(DEFAULT_METHOD, threads, 1)
    if not result.outline or not picture or not frame:
        return []
    seconds = picture.seconds if first else frame.seconds.fastest
    return [(seconds, result.outline.largest)] if result.outline.largest > 0 else []
