"""From an OpenCascade shape to the first frame of it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from .. import _native
from ..cad.convert import convert
from ..camera import Camera
from ..render import DEFAULT_METHOD, render
from .child import in_child
from .frames import BUFFERS
from .subject import Subject

RUNS = 3


@dataclass(frozen=True)
class FirstPicture:
    """Wall-clock seconds of taking patches and trim loops out of the shape, and of the first frame on so many threads.

    preparation: what preparing the patches for drawing took when it was done once more; the first frame contains it.
    fit: of fitting a camera, which is not part of the sum.
    """

    threads: int
    extraction: float
    frame: float
    preparation: float
    fit: float

    @property
    def seconds(self) -> float:
        """Extraction and first frame, the camera being given."""
        return self.extraction + self.frame


def measure_first_picture(subject: Subject, threads: int) -> FirstPicture:
    """The fastest of a few runs, each in a process that has OpenCascade and the shape and has drawn nothing of it."""
    runs = [in_child(lambda: _first_picture(subject, threads), 300.0) for _ in range(RUNS)]
    return min(runs, key=lambda run: run.seconds)


def _first_picture(subject: Subject, threads: int) -> FirstPicture:
    _native.release_frame_buffers()  # a new process has none; the parent's would be copied page by page
    start = time.perf_counter()
    model = convert(subject.shape, subject.name)
    extracted = time.perf_counter()
    render(model, subject.camera, subject.resolution, DEFAULT_METHOD, 1, threads, BUFFERS)
    drawn = time.perf_counter()
    _native.Scene(model)
    prepared = time.perf_counter()
    Camera.fit(model, resolution=subject.resolution)
    fitted = time.perf_counter()
    return FirstPicture(threads, extracted - start, drawn - extracted, prepared - drawn, fitted - prepared)
