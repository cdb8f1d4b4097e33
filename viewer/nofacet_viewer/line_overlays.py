"""The overlays of lines: made in the background, drawn when they are ready."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from math import floor, log2
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from . import lines
from .line_layer import LineLayer

FLATNESS = 0.1  # pixels between a curve and its chords

Segments = NDArray[np.float64]


class LineOverlays:
    """The lines of one model and one mesh. What is asked for and not there yet is begun; until then there is None."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._executor = ThreadPoolExecutor(1, thread_name_prefix="lines")
        self._model: nofacet.Model | None = None
        self._mesh: nofacet.Mesh | None = None
        self._begun: dict[str, tuple[Any, Future[Segments]]] = {}
        self._ready: dict[str, LineLayer] = {}
        self._drawn: dict[str, Future[Segments]] = {}  # what the layers that are ready were made of
        self._news = False  # set by the executor's thread

    def set_model(self, model: nofacet.Model | None) -> None:
        self._model = model
        self._forget("patch-borders", "control-nets")

    def set_mesh(self, mesh: nofacet.Mesh | None) -> None:
        self._mesh = mesh
        self._forget("mesh-edges", "edges")

    def layer(self, name: str, pixel: float) -> LineLayer | None:
        """The lines of an overlay. pixel: the size of a pixel where it is smallest, model units."""
        task, key = self._task(name, pixel)
        if task is None:
            return None
        if name not in self._begun or self._begun[name][0] != key:
            future = self._executor.submit(task)
            future.add_done_callback(self._note)
            self._begun[name] = key, future
        future = self._begun[name][1]
        if future.done() and self._drawn.get(name) is not future:
            if name in self._ready:
                self._ready[name].release()
            self._ready[name] = LineLayer(self._context, future.result())
            self._drawn[name] = future
        return self._ready.get(name)

    @property
    def busy(self) -> bool:
        """Whether lines are being made, or poll() has not told yet that they are."""
        return self._news or any(not future.done() for _, future in self._begun.values())

    def poll(self) -> bool:
        """Whether lines have been made since the last call."""
        news, self._news = self._news, False
        return news

    def wait(self) -> None:
        """Until no lines are being made."""
        for _, future in self._begun.values():
            future.result()

    def release(self) -> None:
        self._executor.shutdown(cancel_futures=True)
        self._forget(*self._begun)

    def _task(self, name: str, pixel: float) -> tuple[Callable[[], Segments] | None, Any]:
        """What makes the lines, None without model or mesh; and what they depend on beside these."""
        model, mesh = self._model, self._mesh
        if name in ("mesh-edges", "edges"):
            make = lines.mesh_edges if name == "mesh-edges" else lines.face_borders
            return (None if mesh is None else lambda: make(mesh)), None
        if model is None:
            return None, None
        if name == "control-nets":
            return (lambda: lines.control_nets(model)), None
        tolerance = 2.0 ** floor(log2(FLATNESS * pixel))  # zooming by less than two makes no new lines
        return (lambda: lines.patch_borders(model, tolerance)), tolerance

    def _note(self, _: Future[Segments]) -> None:
        self._news = True

    def _forget(self, *names: str) -> None:
        for name in names:
            self._begun.pop(name, None)
            self._drawn.pop(name, None)
            layer = self._ready.pop(name, None)
            if layer:
                layer.release()
