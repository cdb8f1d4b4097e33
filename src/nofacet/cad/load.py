"""load(): whatever holds a CAD model to a Model."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from nofacet import cache
from nofacet.cad.formats import file_format
from nofacet.cad.worker import read_in_worker
from nofacet.model import Model

if TYPE_CHECKING:
    from nofacet._native import Cancel


def load(
    source: Any,
    timeout: float = 300.0,
    progress: Callable[[str], None] | bool | None = None,
    measure: bool = False,
    cancel: Cancel | None = None,
) -> Model:
    """Load a CAD model.

    source: the path of a STEP or BREP file (str or PathLike; told apart by content, not by extension); a cadquery
        Workplane, Shape, Sketch or Assembly; a build123d shape, assembly or builder; an OpenCascade TopoDS_Shape.
        A file is read in a process of its own, which cannot take this one down, or taken from the cache if it was
        read before and has not changed (nofacet.cache).
    timeout: seconds that reading a file may take, math.inf for no limit.
    progress: called once a second with a line of text while a file is read; True: write it to standard error.
    measure: compare every patch with OpenCascade's surface and every edge with the curve that trims, and fill
        Model.conversion_error, edge_use_face, edge_use_deviation and edge_use_tolerance.
    cancel: once another thread has called its `set()`, reading a file ends within a twentieth of a second.

    Lengths are in mm for STEP files (OpenCascade converts), else as in the source. Colours are linear RGBA.
    Raises InputError (one line: what is wrong, what to do) if there is nothing to show, Cancelled if it was called
    off, ValueError for a timeout that is not a number. What is lost of a model that can be shown is named in
    Model.warnings.
    """
    if math.isnan(timeout):
        raise ValueError("timeout is nan; give seconds, or math.inf for no limit")
    if isinstance(source, (str, os.PathLike)):
        path = os.fsdecode(source)
        file_format(path)  # refuses at once what needs no OpenCascade to be refused
        return _file(path, timeout, write_progress if progress is True else progress or None, measure, cancel)
    from nofacet.cad.convert import convert
    from nofacet.cad.objects import cad_object

    shape, appearance = cad_object(source)
    model = appearance.applied_to(convert(shape, type(source).__name__))
    if measure:
        from nofacet.cad.measure import measured

        model = measured(shape, model)
    return model


def _file(
    path: str, timeout: float, progress: Callable[[str], None] | None, measure: bool, cancel: Cancel | None
) -> Model:
    """The model of a file: kept from an earlier reading, or read and then kept."""
    name = cache.name_of(path, measure)
    model = cache.find(name) if name else None
    if model is not None:
        return replace(model, source=path)
    model = read_in_worker(path, timeout, progress, measure, cancel)
    if name and name == cache.name_of(path, measure):  # else the file has changed meanwhile
        cache.keep(name, model)
    return model


def write_progress(line: str) -> None:
    """Write a line of progress to standard error."""
    print(line, file=sys.stderr, flush=True)
