"""The exact picture, refined step by step in a thread of its own.

In motion a frame is drawn at the scale that keeps up with 30 frames a second; once the camera rests, at full
resolution with 1, 4 and 16 samples. A new request ends the refinement at once; a frame in motion is finished first, for
under a mouse that never rests nothing would ever be shown otherwise.

Frames come with their pixels as the window shows them, so that its thread has nothing to compute.
"""

from __future__ import annotations

import atexit
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import nofacet

from .overlays import frame_curvature
from .scale import AdaptiveScale, scaled
from .srgb import RGB, encoded
from .state import WHITE
from .tasks import give_way

REFINEMENTS = (1, 4, 16)  # samples, at full resolution
FULL_SAMPLES = REFINEMENTS[-1]
REST_SECONDS = 0.03  # without another request until refinement begins, which would slow down what shows a motion


@dataclass(frozen=True)
class Request:
    """What the exact picture shows: resolution in pixels, the frame buffers that are needed, whether with edges drawn
    and with the surfaces' curvature, the planes that cut the model, and the background (linear RGB)."""

    model: nofacet.Model
    camera: nofacet.Camera
    resolution: tuple[int, int]
    buffers: tuple[str, ...] = ("color", "depth", "face")
    edges: bool = False
    curvature: bool = False
    sections: tuple[nofacet.Section, ...] = ()
    background: RGB = WHITE

    def moves_on_from(self, other: Request) -> bool:
        """Whether only the camera or the section planes are others."""
        return replace(other, camera=self.camera, sections=self.sections) == self


@dataclass(frozen=True)
class Exact:
    """A finished frame of a request: at which scale of its resolution, with how many samples, and what it took.

    curvature: what overlays.frame_curvature gives for the frame, where it was asked for. pixels: what frame.srgb8 gives
    before the request's background.
    """

    frame: nofacet.Frame
    request: Request
    scale: float
    samples: int
    seconds: float
    curvature: NDArray[np.float32] | None = None
    pixels: NDArray[np.uint8] | None = None

    @property
    def is_full(self) -> bool:
        """Whether no better frame of the request follows."""
        return self.scale == 1.0 and self.samples == FULL_SAMPLES


class Step(NamedTuple):
    scale: float
    samples: int
    moving: bool


class ExactRenderer:
    """Draws what was asked for last, in a thread of its own. Its methods are for one other thread and never wait."""

    def __init__(self, wake: Callable[[], None] = lambda: None, threads: int | None = None) -> None:
        """wake: called in the renderer's thread whenever there is something new in `latest`. threads: as in render."""
        self.scale = AdaptiveScale()
        self._wake = wake
        self._threads = threads
        self._changed = threading.Condition()
        self._request: Request | None = None
        self._number = 0  # of the request
        self._rested = -1  # the number of the last request that rest() was said of
        self._cancel = nofacet.Cancel()
        self._moving = False  # whether what is drawn now is a frame in motion
        self._finished: Exact | str | None = None
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="exact picture", daemon=True)
        self._thread.start()
        atexit.register(self.stop)  # the interpreter must not go while a frame is drawn

    def show(self, request: Request | None) -> None:
        """Draw this from now on; None: nothing. Asking for what is shown already changes nothing."""
        with self._changed:
            if request == self._request:
                return
            before, self._request = self._request, request
            self._number += 1
            only_moved = request and before and request.moves_on_from(before)
            if not (self._moving and only_moved):
                self._cancel.set()
            self._changed.notify()

    def rest(self, request: Request | None) -> None:
        """Draw this, and refine it without waiting whether there is another request: the motion has ended."""
        self.show(request)
        with self._changed:
            self._rested = self._number
            self._changed.notify()

    def latest(self) -> Exact | str | None:
        """The best frame finished since the last call, or one line that says why there is none; None: nothing new."""
        with self._changed:
            finished, self._finished = self._finished, None
            return finished

    def stop(self) -> None:
        """End the thread; returns once it has ended."""
        atexit.unregister(self.stop)
        with self._changed:
            self._stopped = True
            self._cancel.set()
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        give_way()
        done = 0
        while True:
            with self._changed:
                while not self._stopped and self._number == done:
                    self._changed.wait()
                if self._stopped:
                    return
                request, done = self._request, self._number
            if request:
                self._draw(request, done)

    def _draw(self, request: Request, number: int) -> None:
        """All steps of a request, until there is another one."""
        moved = False
        for step in self._steps():
            with self._changed:
                if moved:
                    self._changed.wait_for(
                        lambda: self._stopped or number != self._number or number == self._rested, REST_SECONDS
                    )
                moved = step.moving
                if self._stopped or self._number != number:
                    return
                self._cancel = nofacet.Cancel()
                self._moving = step.moving
            try:
                finished: Exact | str = self._frame(request, step)
            except nofacet.Cancelled:
                return
            except ValueError as error:  # nothing to draw
                finished = str(error)
            with self._changed:
                self._moving = False
                self._finished = finished
            self._wake()
            if isinstance(finished, str):
                return

    def _steps(self) -> Iterator[Step]:
        scale = self.scale.value
        yield Step(scale, 1, True)
        for samples in REFINEMENTS:
            if scale < 1.0 or samples > 1:
                yield Step(1.0, samples, False)

    def _frame(self, request: Request, step: Step) -> Exact:
        start = time.perf_counter()
        frame = nofacet.render(
            request.model,
            request.camera,
            scaled(request.resolution, step.scale),
            samples=step.samples,
            threads=self._threads,
            buffers=request.buffers,
            edges=request.edges,
            sections=request.sections,
            cancel=self._cancel,
        )
        seconds = time.perf_counter() - start
        pixels = frame.srgb8(encoded(request.background))
        if step.moving:
            self.scale.update(time.perf_counter() - start, step.scale)
        curvature = frame_curvature(request.model, frame) if request.curvature else None
        return Exact(frame, request, step.scale, step.samples, seconds, curvature, pixels)
