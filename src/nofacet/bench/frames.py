"""Frames of the project's own methods, and the floor under them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

from .. import _native
from ..camera import Camera
from ..model import Model
from ..render import DEFAULT_METHOD, render
from .subject import Subject
from .timing import Timing, repeat, repeat_in_turn

BUFFERS = ("color", "coverage", "depth", "face")
FLOOR_REPEATS = 3  # a round
# Of the methods that are only compared, the frames of this many samples are measured.
COMPARED_SAMPLES = 1


@dataclass(frozen=True)
class FrameTime:
    """One method's frames with some threads and samples.

    stages: seconds by stage of the fastest frame, as the renderer reports them.
    """

    method: str
    threads: int
    samples: int
    seconds: Timing
    pieces: int
    stages: dict[str, float]


@dataclass(frozen=True)
class Floor:
    """Seconds that evaluating position, both derivatives and unit normal at every visible sample takes, on one thread,
    where (u, v) are known."""

    seconds: Timing
    samples: int


def measure_frames(subject: Subject, threads: int, methods: tuple[str, ...]) -> tuple[list[FrameTime], Floor]:
    """Frames on one thread and on `threads`, with one sample a pixel row; of the default method with four, too. And the
    floor of the same frame. All in turn, so that the ratios hold whatever the machine's speed does meanwhile."""
    model, camera, resolution = subject.model, subject.camera, subject.resolution
    wanted = [
        (method, count, samples)
        for method in methods
        for samples in ((1, 4) if method == DEFAULT_METHOD else (COMPARED_SAMPLES,))
        for count in dict.fromkeys((1, threads))
    ]
    shown = render(model, camera, resolution, samples=1, buffers=("face", "uv"))  # prepares the model, too
    scene = _native.Scene(model)
    floors: list[dict[str, Any]] = []
    _, *frames = repeat_in_turn(
        [
            lambda: floors.append(scene.floor(face=shown.face, uv=shown.uv, repeats=FLOOR_REPEATS)),
            *(functools.partial(_draw, model, camera, resolution, *request) for request in wanted),
        ]
    )
    times = [_frame_time(request, *measured) for request, measured in zip(wanted, frames, strict=True)]
    return times, Floor(Timing.of([floor["seconds"] for floor in floors]), floors[0]["samples"])


def frame_time(
    model: Model, camera: Camera, resolution: tuple[int, int], method: str, threads: int, samples: int
) -> FrameTime:
    """Repeated frames of a prepared model."""
    render(model, camera, (16, 16), samples=1)  # prepares it
    request = (method, threads, samples)
    return _frame_time(request, *repeat(lambda: _draw(model, camera, resolution, *request)))


def _draw(
    model: Model, camera: Camera, resolution: tuple[int, int], method: str, threads: int, samples: int
) -> dict[str, Any]:
    # Only the statistics are kept: a frame that is let go leaves its memory to the next, as in a viewer.
    return render(model, camera, resolution, method, samples, threads, buffers=BUFFERS).stats


def _frame_time(request: tuple[str, int, int], timing: Timing, stats: dict[str, Any]) -> FrameTime:
    stages = {key.removesuffix("_seconds"): value for key, value in stats.items() if key.endswith("_seconds") and value}
    return FrameTime(*request, timing, stats.get("pieces", 0), stages)
