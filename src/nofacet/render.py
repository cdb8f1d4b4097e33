"""From model and camera to frame: checks the request, hands the arrays to the native method."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from . import _native
from .camera import Camera, check_resolution
from .errors import Cancelled, InputError
from .frame import BUFFERS, Frame
from .model import Model
from .scene import scene_of
from .section import Section, uncapped_warnings

DEFAULT_METHOD = "bezier_clip_scanline"
DEFAULT_BUFFERS = ("color", "coverage", "depth", "face")
# A frame's buffers take 32 bytes a pixel by default and 60 with all of them.
MAX_PIXELS = 1 << 28


def methods() -> tuple[str, ...]:
    """Names of the rendering methods, for `render(method=...)` and `--method`."""
    return tuple(_native.method_names())


def render(
    model: Model,
    camera: Camera,
    resolution: tuple[int, int] = (1920, 1080),
    method: str = DEFAULT_METHOD,
    samples: int = 4,
    threads: int | None = None,
    buffers: Sequence[str] = DEFAULT_BUFFERS,
    edges: bool = False,
    shadows: bool = False,
    reflectance: float = 0.0,
    sections: Sequence[Section] = (),
    cancel: _native.Cancel | None = None,
) -> Frame:
    """Draw `model` as `camera` sees it.

    resolution: width and height in pixels.
    method: one of `methods()`.
    samples: what colour and coverage are averaged over: scan planes a pixel row (along x they are exact), or with
        "bezier_clip_ray" samples x samples rays a pixel.
    threads: None uses every core; no pixel depends on it.
    buffers: names from `nofacet.frame.BUFFERS`; only these are computed. "position" is made of "depth", which the frame
        therefore keeps, too.
    edges: draw the B-rep's edges as fine lines into `color`.
    shadows: of the key light; opaque faces cast them. Only with a method that casts secondary rays.
    reflectance: share of the mirror image in every face's colour, 0 to below 1; four bounces. Where it shows nothing,
        `color` lets that share of the background through. Only with a method that casts secondary rays.
    sections: planes that cut the model; a point is drawn only if every one of them keeps it. Closed bodies show caps
        in the planes, in the colour of most of their faces; on a cap `face` is -2 - (the plane's index), `normal` the
        plane's and `uv` NaN. Bodies that are not closed are cut open: `stats["warnings"]` has a line for each that is.

    cancel: once another thread has called its `set()`, drawing ends with the bands of rows that were begun. The
        interpreter's lock is free while a frame is drawn.

    Raises ValueError for a request that makes no sense, InputError if the model has nothing to draw, Cancelled.
    The frame's `stats` hold the stages' times in seconds and counts.
    """
    request = check_request(resolution, method, samples, threads, buffers, shadows, reflectance, sections)
    if not model.groups:
        raise InputError(f"{model.source}: no face could be converted, there is nothing to draw; see its warnings")
    width, height = request.resolution
    wanted = {"depth" if name == "position" else name for name in request.buffers}
    kept = set(wanted)
    if edges and "color" in wanted:
        wanted.add("depth")  # edge lines are hidden by depth
    arrays = {}
    for name in wanted:
        dtype, channels, _ = BUFFERS[name]
        shape = (height, width) if channels == 1 else (height, width, channels)
        memory = _native.frame_buffer(height * width * channels * np.dtype(dtype).itemsize)
        arrays[name] = memory.view(dtype).reshape(shape)
    stats = scene_of(model).render(
        method=method,
        eye=tuple(camera.position),
        axes=np.array(camera.axes()),
        scale=height / camera.extent_at_unit_depth(),
        perspective=camera.projection == "perspective",
        width=width,
        height=height,
        samples=request.samples,
        threads=request.threads or os.cpu_count() or 1,
        edges=edges,
        shadows=shadows,
        reflectance=reflectance,
        sections=np.array([(plane.origin, plane.normal) for plane in request.sections], float).reshape(-1, 2, 3),
        cancel=cancel,
        **arrays,
    )
    if stats.pop("cancelled"):
        raise Cancelled("the frame was called off")
    if request.sections:
        stats["warnings"] = uncapped_warnings(model, request.sections, stats.pop("uncapped_faces"))
    return Frame(camera, {name: arrays[name] for name in arrays if name in kept}, stats)


class Request(NamedTuple):
    """What check_request() was given, with whole numbers as int and sequences, which may be generators, as tuples."""

    resolution: tuple[int, int]
    samples: int
    threads: int | None
    buffers: tuple[str, ...]
    sections: tuple[Section, ...]


def check_request(
    resolution: tuple[int, int],
    method: str,
    samples: int,
    threads: int | None,
    buffers: Sequence[str],
    shadows: bool = False,
    reflectance: float = 0.0,
    sections: Sequence[Section] = (),
) -> Request:
    """The request; raises ValueError, in one line, for what render() would refuse whatever the model and the camera."""
    width, height = check_resolution(resolution)
    if width * height > MAX_PIXELS:
        raise ValueError(f"resolution {width} x {height}: give at most {MAX_PIXELS} pixels in all")
    if method not in methods():
        raise ValueError(f"unknown method {method!r}; choose one of {', '.join(methods())}")
    samples = _whole("samples", samples, 256)
    if threads is not None:
        threads = _whole("threads", threads, 1024, ", or None for every core")
    names = _tuple("buffers", buffers)
    unknown = [name for name in names if name not in BUFFERS]
    if unknown or not names:
        what = f"unknown buffer {unknown[0]!r}" if unknown else "no buffer asked for"
        raise ValueError(f"{what}; choose from {', '.join(BUFFERS)}")
    if not 0 <= reflectance < 1:
        raise ValueError(f"reflectance {reflectance}: give a share from 0 to below 1")
    if (shadows or reflectance) and not _native.casts_secondary_rays(method):
        able = ", ".join(name for name in methods() if _native.casts_secondary_rays(name))
        raise ValueError(f"method {method!r} casts neither shadows nor mirror images; choose {able}")
    planes = _tuple("sections", sections)
    if planes and (shadows or reflectance):
        raise ValueError("section planes cut neither shadows nor mirror images; leave out one or the other")
    return Request((width, height), samples, threads, names, planes)


def _whole(name: str, value: Any, most: int, otherwise: str = "") -> int:
    try:
        number = operator.index(value)
    except TypeError:
        number = 0
    if not 1 <= number <= most:
        raise ValueError(f"{name} {value}: give 1 to {most}, a whole number{otherwise}")
    return number


def _tuple(name: str, values: Any) -> tuple[Any, ...]:
    try:
        return tuple(values)
    except TypeError:
        raise ValueError(f"{name} {values!r}: give a list") from None
