"""The window's content as a picture file, drawn with no display: for documents and tests."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet
from nofacet import image
from nofacet.camera import METADATA_KEY
from nofacet.frame import SOFTWARE_KEY

from .caption import caption_height, draw_caption, draw_legend
from .difference import OutlineDifference, outline_difference
from .figures import exact_figures, mesh_figures
from .meshing import Mesher, MeshResult
from .overlays import OVERLAYS, frame_curvature
from .painter import Painter
from .panes import pane_resolution, panes
from .state import View, ViewState

Size = tuple[int, int]

DEFAULT_SETTING = nofacet.MESH_SETTINGS["F3D"]
SAMPLES = 16
LEAST_SIDE = 16  # pixels
POLL = 0.02  # seconds between looks whether the mesh is there
TIMEOUT = 300.0  # seconds


def write_view(
    source: Any,
    output: str | Path,
    view: View | str = View.SIDE_BY_SIDE,
    resolution: Size = (1280, 720),
    camera: nofacet.Camera | None = None,
    overlays: Sequence[str] = (),
    setting: nofacet.MeshSetting = DEFAULT_SETTING,
    wipe: float = 0.5,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    sections: Sequence[nofacet.Section] = (),
    model: nofacet.Model | None = None,
    timeout: float = TIMEOUT,
) -> None:
    """Draw what the window would show of `source` (what nofacet.load takes), its figures below, into a PNG file.

    view: a View or its value. resolution: width and height of the whole picture. camera: by default it fits the model;
    the picture carries it in its metadata. overlays: names from painter.OVERLAYS. setting: how OpenCascade meshes.
    wipe: fraction of the width that the exact side has in that view. background: linear RGB. sections: planes that cut
    the model; the outline error, which is of whole models, is left out then. model: what
    nofacet.load(source, measure=True) gave, where that is known. timeout: seconds for reading, and again for meshing.

    Raises InputError if there is nothing to show or no way to draw off screen, ValueError for a view, overlay,
    resolution or file name that makes no sense, OSError where the file cannot be written.
    """
    output = Path(output)
    check_picture(output, resolution)
    state = ViewState(_view(view), wipe, overlays=_known(overlays), background=background, sections=tuple(sections))
    with _offscreen_context(resolution) as context:
        model = model or nofacet.load(source, timeout, measure=True)
        camera = camera or nofacet.Camera.fit(model, resolution=side_resolution(state.view, resolution))
        meshed = None if state.view is View.EXACT else _mesh_of(source, setting, timeout)
        picture = _Scene(model, camera, _size_above_caption(resolution), state, meshed).draw(context, resolution)
    attributes = {METADATA_KEY: json.dumps(camera.to_dict()), SOFTWARE_KEY: f"nofacet {version('nofacet')}"}
    image.write(output, picture, ("R", "G", "B"), attributes)


def check_picture(output: Path, resolution: Size) -> None:
    """Raises ValueError for a file or a resolution that write_view() cannot write."""
    if output.suffix.lower() != ".png":
        raise ValueError(f"{output}: pictures of views are written as .png")
    if min(_size_above_caption(resolution)) < LEAST_SIDE:
        raise ValueError(f"resolution {resolution[0]} x {resolution[1]}: too small for a view and its figures")


def side_resolution(view: View | str, resolution: Size) -> Size:
    """Width and height in pixels of a side in a picture of `resolution` that write_view() writes: to fit cameras to."""
    return pane_resolution(_view(view), _size_above_caption(resolution))


def _size_above_caption(resolution: Size) -> Size:
    return resolution[0], resolution[1] - caption_height(resolution[1])


@contextmanager
def _offscreen_context(resolution: Size) -> Iterator[moderngl.Context]:
    """An OpenGL context without a window. Raises InputError where there is none, or none for so large a picture."""
    try:
        context = moderngl.create_standalone_context(backend="egl", require=330)
    except Exception as error:  # moderngl and glcontext raise plain Exceptions
        reason = " ".join(str(error).split())
        raise nofacet.InputError(
            f"cannot draw off screen: no OpenGL 3.3 through EGL here ({reason}); install a driver, such as Mesa's"
        ) from None
    try:
        most = min(context.info["GL_MAX_TEXTURE_SIZE"], *context.info["GL_MAX_VIEWPORT_DIMS"])
        if max(resolution) > most:
            raise nofacet.InputError(
                f"resolution {resolution[0]} x {resolution[1]}: OpenGL draws at most {most} pixels a side here"
            )
        yield context
    finally:
        context.release()


def _mesh_of(source: Any, setting: nofacet.MeshSetting, timeout: float) -> MeshResult:
    """OpenCascade's triangles. Raises InputError if there cannot be any, or not within so many seconds."""
    mesher = Mesher()
    end = time.monotonic() + timeout
    try:
        mesher.start(source, setting)
        while (answer := mesher.poll()) is None:
            if time.monotonic() > end:
                raise nofacet.InputError(
                    f"{_name(source)}: stopped after {timeout:g} s while meshing; "
                    "a fine mesh may need a longer timeout, the exact view needs no mesh"
                )
            time.sleep(POLL)
    finally:
        mesher.cancel()
    if isinstance(answer, str):
        raise nofacet.InputError(answer)
    return answer


@dataclass(frozen=True)
class _Scene:
    """What is drawn. size: of the picture without the caption."""

    model: nofacet.Model
    camera: nofacet.Camera
    size: Size
    state: ViewState
    meshed: MeshResult | None

    def draw(self, context: moderngl.Context, resolution: Size) -> NDArray[np.uint8]:
        """sRGB (height, width, 3), row 0 at the top."""
        painter = Painter(context)
        painter.set_model(self.model)
        difference = None
        if self.meshed:
            painter.set_mesh(self.meshed.mesh)
        if self.meshed and not self.state.sections:
            pane = pane_resolution(self.state.view, self.size)
            difference = outline_difference(self.model, self.meshed.mesh, self.camera, pane)
            painter.set_difference(difference)
        seconds = self._render_exact(painter)
        picture = self._painted(context, painter)
        legend = painter.legend(self.state)
        painter.release()
        if legend:
            draw_legend(picture, legend)
        whole = np.full((resolution[1], resolution[0], 3), 255, np.uint8)
        whole[: self.size[1]] = picture
        self._caption(whole, seconds, difference)
        return whole

    def _render_exact(self, painter: Painter) -> float:
        """Give the painter its exact frame; the seconds that it took."""
        resolution = painter.exact_resolution(self.state.view, self.size)
        if resolution is None:
            return 0.0
        buffers, sections = painter.exact_buffers(self.state), self.state.sections
        edges = "edges" in self.state.overlays
        nofacet.render(self.model, self.camera, (16, 16), samples=1, sections=sections)  # prepares the model
        start = time.perf_counter()
        frame = nofacet.render(
            self.model, self.camera, resolution, samples=SAMPLES, buffers=buffers, edges=edges, sections=sections
        )
        seconds = time.perf_counter() - start
        painter.set_exact(frame, frame_curvature(self.model, frame) if "uv" in buffers else None)
        return seconds

    def _painted(self, context: moderngl.Context, painter: Painter) -> NDArray[np.uint8]:
        width, height = self.size
        framebuffer = context.simple_framebuffer(self.size, 3)
        for _ in range(2):  # the second has the lines that the first began to make
            painter.paint(self.state, self.camera, framebuffer, self.size)
            painter.wait()
        pixels = np.frombuffer(framebuffer.read(components=3, alignment=1), np.uint8)
        framebuffer.release()
        return pixels.reshape(height, width, 3)[::-1].copy()

    def _caption(self, whole: NDArray[np.uint8], seconds: float, difference: OutlineDifference | None) -> None:
        height = len(whole) - self.size[1]
        view, width = self.state.view, self.size[0]
        sides = {pane.side for pane in panes(view, self.size)}
        half = width // 2 if len(sides) == 2 else width
        if View.EXACT in sides:
            figures = exact_figures(self.model, seconds, f" with {SAMPLES} samples")
            draw_caption(whole, 0, half, height, "exact", figures)
        if self.meshed:
            left = width - half if len(sides) == 2 else 0
            name = f"triangles, {self.meshed.setting.name}"
            figures = mesh_figures(self.meshed, difference.error if difference else None)
            draw_caption(whole, left, width - left, height, name, figures)


def _name(source: Any) -> str:
    return os.fsdecode(source) if isinstance(source, (str, os.PathLike)) else type(source).__name__


def _view(view: View | str) -> View:
    try:
        return View(view)
    except ValueError:
        raise ValueError(f"unknown view {view!r}; choose one of {', '.join(one.value for one in View)}") from None


def _known(overlays: Sequence[str]) -> frozenset[str]:
    for name in overlays:
        if name not in OVERLAYS:
            raise ValueError(f"unknown overlay {name!r}; choose from {', '.join(OVERLAYS)}")
    return frozenset(overlays)
