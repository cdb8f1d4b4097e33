"""Reading a file while the window lives on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import nofacet

from .section_planes import Bounds
from .tasks import give_way

Fit = Callable[[nofacet.Model, tuple[int, int]], nofacet.Camera]  # (model, resolution) -> camera; ValueError if none


def fit_camera(model: nofacet.Model, resolution: tuple[int, int]) -> nofacet.Camera:
    """A camera that sees all of the model."""
    return nofacet.Camera.fit(model, resolution=resolution)


@dataclass(frozen=True)
class Loaded:
    """A file that was read, its box and a camera that sees all of it; only one of `model` and `problem` is not None.

    problem: one line, as on the command line. measured: the errors of its conversion are in the model.
    """

    path: str
    model: nofacet.Model | None = None
    camera: nofacet.Camera | None = None
    bounds: Bounds | None = None
    problem: str | None = None
    measured: bool = False


class Loader:
    """Reads one file at a time in a thread; starting another one cancels it. Its methods never wait.

    The file itself is read in a process of its own (nofacet.load), so the interpreter's lock is free meanwhile.
    """

    def __init__(self, wake: Callable[[], None] = lambda: None, fit: Fit = fit_camera, timeout: float = 300.0) -> None:
        """wake: called in the loader's thread when something has changed. fit: the camera of a file that nobody has
        chosen one for. timeout: seconds for a file."""
        self._wake = wake
        self._fit = fit
        self._timeout = timeout
        self._lock = threading.Lock()
        self._cancel: nofacet.Cancel | None = None
        self._loaded: list[Loaded] = []
        self.path: str | None = None  # what is being read; None: nothing
        self.measured = False  # whether its conversion is measured, too
        self.started = 0.0  # time.monotonic()
        self.stage = ""

    def start(self, path: str, resolution: tuple[int, int], measured: bool = False) -> None:
        """Read a file. resolution: pixels of the picture that the camera is to fill; measured: as load's measure."""
        self.cancel()
        cancel = nofacet.Cancel()
        self._cancel, self.path, self.measured = cancel, path, measured
        self.started, self.stage = time.monotonic(), ""
        arguments = (path, resolution, measured, cancel)
        threading.Thread(target=self._read, args=arguments, name="reading").start()

    def cancel(self) -> None:
        """Stop reading; nothing comes of what was begun."""
        with self._lock:
            if self._cancel:
                self._cancel.set()
            self._cancel = self.path = None
            self._loaded.clear()

    @property
    def awaited(self) -> bool:
        """Whether what is being read is still to be shown."""
        return self.path is not None and not self.measured

    def poll(self) -> Loaded | None:
        """What has been read since the last call."""
        with self._lock:
            return self._loaded.pop() if self._loaded else None

    def _read(self, path: str, resolution: tuple[int, int], measured: bool, cancel: nofacet.Cancel) -> None:
        give_way()  # and so does the process that reads
        try:
            model = nofacet.load(
                path, timeout=self._timeout, progress=self._show_stage, measure=measured, cancel=cancel
            )
            camera = self._fit(model, resolution)
            loaded = Loaded(path, model, camera, Bounds.of(model), measured=measured)
        except nofacet.Cancelled:
            return
        except (ValueError, OSError) as error:
            loaded = Loaded(path, problem=one_line(error))
        except Exception as error:  # the window outlives whatever a file may bring about
            loaded = Loaded(path, problem=f"{path}: {type(error).__name__}: {one_line(error)}; please report this")
        with self._lock:
            if cancel.is_set():
                return
            self._loaded, self._cancel, self.path = [loaded], None, None
        self._wake()

    def _show_stage(self, line: str) -> None:
        self.stage = line
        self._wake()


def one_line(error: Exception) -> str:
    """What the command line says of an error."""
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return " ".join(str(error).split())
