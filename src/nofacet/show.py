"""show(): CAD objects in a window, in a notebook or in a picture file."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from dataclasses import replace
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any

from .cad.load import load
from .camera import VIEWS, Camera, Projection
from .combine import combine
from .errors import InputError
from .frame import Frame, check_extension, linear_background
from .model import Model
from .render import DEFAULT_BUFFERS, DEFAULT_METHOD, check_request, render
from .section import Section

DEFAULT_DIRECTION = (-1.0, 1.0, -0.5)
WHITE = (1.0, 1.0, 1.0)


def show(
    *objects: Any,
    names: Sequence[str | None] | str | None = None,
    colors: Sequence[Any] | str | None = None,
    alphas: Sequence[float | None] | float | None = None,
    camera: Camera | str | PathLike[str] | None = None,
    direction: Sequence[float] | str = DEFAULT_DIRECTION,
    projection: Projection = "orthographic",
    zoom: float = 0.9,
    width: int = 1280,
    height: int = 720,
    samples: int = 16,
    edges: bool = False,
    sections: Sequence[Section] = (),
    background: Sequence[float] | None = WHITE,
    screenshot: str | PathLike[str] | None = None,
    interact: bool | None = None,
    title: str = "nofacet",
) -> Frame | None:
    """Show CAD objects, all together, from their exact surfaces.

    objects: whatever `load` takes: paths, cadquery, build123d and OpenCascade objects; models; lists of these, which
        count as one object.
    names, colors, alphas: one for each object, or None for what the object has itself; with a single object the value
        alone will do. A colour is a name, "#rrggbb", three or four sRGB values from 0 to 1, or a cadquery or build123d
        Color; alpha is 0 (transparent) to 1.
    camera: a Camera, a camera file, or a picture that nofacet made. Without one the objects are fitted, seen along
        `direction` (from the eye into the scene, or one of front, back, left, right, top, bottom, iso) with `zoom`.
    width, height: of the picture or window, pixels. samples, edges: of the picture; see `render`.
    sections: planes that cut the objects.
    screenshot: write this .png, .exr or .npz file and open no window. background: three sRGB values from 0 to 1 behind
        a .png; None: transparent.
    interact: True opens a window in any case, False never; None: unless a screenshot is asked for, or in a notebook.

    Returns the picture (its background transparent), which a notebook displays; None after a window, once it is closed.
    Raises InputError if there is nothing to show, ValueError for a request that makes no sense, ImportError if there
    is no window to open. What cannot be shown beside the rest is named in a warning.
    """
    request = check_request((width, height), DEFAULT_METHOD, samples, None, DEFAULT_BUFFERS, sections=sections)
    if background is not None:
        linear_background(background)
    file = None if screenshot is None else Path(screenshot)
    if file:
        check_extension(file)
    model = _together(objects, names, colors, alphas)
    for warning in model.warnings:
        warnings.warn(warning, stacklevel=2)
    if camera is None:
        camera = _fitted(model, direction, projection, zoom, request.resolution)
    elif not isinstance(camera, Camera):
        camera = Camera.load(Path(camera))
    quiet = file is not None or _in_notebook()
    frame = None
    if quiet or interact is False:
        frame = render(model, camera, request.resolution, samples=samples, edges=edges, sections=request.sections)
        for warning in frame.stats.get("warnings", ()):
            warnings.warn(warning, stacklevel=2)
    if file and frame:
        behind = background if file.suffix.lower() == ".png" else None
        (frame if behind is None else frame.over(behind)).save(file)
    if interact or (interact is None and not quiet):
        _open_window(model, camera, title, request.sections, request.resolution)
        return None
    return frame


def _fitted(
    model: Model, direction: Sequence[float] | str, projection: Projection, zoom: float, resolution: tuple[int, int]
) -> Camera:
    up: Sequence[float] = (0.0, 0.0, 1.0)
    if isinstance(direction, str):
        if direction not in VIEWS:
            raise ValueError(f"direction {direction!r}: give three numbers, or one of {' '.join(VIEWS)}")
        direction, up = VIEWS[direction]
    return Camera.fit(model, direction, projection, resolution, up, zoom=zoom)


def _together(objects: Sequence[Any], names: Any, colors: Any, alphas: Any) -> Model:
    """The objects as one model, named and painted."""
    if not objects:
        raise ValueError("there is nothing to show; give at least one object")
    wanted = [_one_each(what, given, len(objects)) for what, given in zip(_LISTS, (names, colors, alphas), strict=True)]
    models, titles, problems = [], [], []
    for number, (source, name, color, alpha) in enumerate(zip(objects, *wanted, strict=True), 1):
        try:
            model = _loaded(source)
        except InputError as problem:
            problems.append(InputError(f"{name or f'object {number}'}: {problem}"))
            continue
        models.append(_painted(model, color, alpha))
        titles.append(name)
    if not models:
        raise problems[0]
    model = models[0] if titles == [None] else combine(models, titles)
    return replace(model, warnings=[*model.warnings, *map(str, problems)]) if problems else model


_LISTS = ("names", "colors", "alphas")


def _one_each(what: str, given: Any, count: int) -> Sequence[Any]:
    if given is None:
        return [None] * count
    if isinstance(given, str) or not hasattr(given, "__len__"):
        given = [given]
    if what == "colors" and count == 1 and len(given) in (3, 4) and isinstance(given[0], Real):
        given = [given]
    if len(given) != count:
        raise ValueError(f"{what}: {len(given)} for {count} objects; give one for each, or None")
    return list(given)


def _loaded(source: Any) -> Model:
    if isinstance(source, Model):
        return source
    if type(source) in (list, tuple):
        if not source:
            raise InputError("this list is empty, so there is nothing to draw")
        return combine([_loaded(item) for item in source])
    return load(source)


def _painted(model: Model, color: Any, alpha: float | None) -> Model:
    """The model with all faces in one colour, or with another alpha."""
    if color is None and alpha is None:
        return model
    if alpha is not None and not 0 <= alpha <= 1:
        raise ValueError(f"alpha {alpha}: give 0 (transparent) to 1")
    painted = model.face_color.copy()
    if color is not None:
        from .cad.colors import linear_rgba  # loads OpenCascade

        painted[:] = linear_rgba(color)
    if alpha is not None:
        painted[:, 3] = alpha
    return replace(model, face_color=painted)


def _in_notebook() -> bool:
    """Whether what is returned to the caller's console is displayed as a picture: in Jupyter and other kernels."""
    ipython = sys.modules.get("IPython")  # nobody is in a notebook without it
    shell = ipython.get_ipython() if ipython else None
    return getattr(shell, "kernel", None) is not None


def _open_window(model: Model, camera: Camera, title: str, sections: Sequence[Section], size: tuple[int, int]) -> None:
    try:
        app = importlib.import_module("nofacet_viewer.app")
    except ImportError as problem:
        how = "pip install 'nofacet[viewer]', or draw without a window: screenshot='part.png'"
        raise ImportError(f"there is no window to open ({problem}); {how}") from None
    app.open_window(model, camera=camera, title=title, sections=sections, size=size)
