"""Frames of the project's own methods, and the floor under them."""

from __future__ import annotations

from dataclasses import dataclass

from .. import _native
from ..camera import Camera
from ..model import Model
from ..render import DEFAULT_METHOD, render
from .subject import Subject
from .timing import Timing, repeat

BUFFERS = ("color", "coverage", "depth", "face")
FLOOR_REPEATS = 25
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

    seconds: float
    samples: int


def measure_frames(subject: Subject, threads: int, methods: tuple[str, ...]) -> list[FrameTime]:
    """Frames on one thread and on `threads`, with one sample a pixel row; of the default method with four, too."""
    return [
        frame_time(subject.model, subject.camera, subject.resolution, method, count, samples)
        for method in methods
        for samples in ((1, 4) if method == DEFAULT_METHOD else (COMPARED_SAMPLES,))
        for count in dict.fromkeys((1, threads))
    ]


def frame_time(
    model: Model, camera: Camera, resolution: tuple[int, int], method: str, threads: int, samples: int
) -> FrameTime:
    """Repeated frames of a prepared model."""
    render(model, camera, (16, 16), samples=1)  # prepares it
    # Only the statistics are kept: a frame that is let go leaves its memory to the next, as in a viewer.
    timing, stats = repeat(lambda: render(model, camera, resolution, method, samples, threads, buffers=BUFFERS).stats)
    stages = {key.removesuffix("_seconds"): value for key, value in stats.items() if key.endswith("_seconds") and value}
    return FrameTime(method, threads, samples, timing, stats.get("pieces", 0), stages)


def measure_floor(model: Model, camera: Camera, resolution: tuple[int, int]) -> Floor:
    """The floor of the frame that the camera sees."""
    frame = render(model, camera, resolution, samples=1, buffers=("face", "uv"))
    result = _native.Scene(model).floor(face=frame.face, uv=frame.uv, repeats=FLOOR_REPEATS)
    return Floor(result["seconds"], result["samples"])
