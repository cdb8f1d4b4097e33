"""Faces' wires to trim loops of rational Bezier segments in their own (u, v), all faces together.

Trimming follows the curves that the file gives in (u, v) ("pcurves"), wherever the 3-D edge may run. Planes mostly
have none: there the 3-D curve is projected by the plane's frame, which is exact for every kind of curve.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .chains import Stretch, chain_face
from .edges import EdgeUses, Segments, edge_uses, segments
from .geometry import SURFACES
from .loops import (
    Loops,
    Ordered,
    ParameterSpace,
    Runs,
    bounding_boxes,
    closed,
    corner_gaps,
    order_uses,
    rectangles,
    runs,
    use_ends,
)
from .stream import Stream
from .surfaces import INFINITE, collapsed, natural_bounds, periods
from .tables import Index, distinct, marked

Array = NDArray[np.float64]

_HAS_POLES = np.array([kind in ("cone", "sphere", "torus", "revolution") for kind in SURFACES])
_WIDE = 1e-3  # gap in a loop, in parts of its wire's extent, that may be the place of a period


@dataclass(frozen=True)
class Trims:
    """The trims of F faces. loops: closed bitwise; boxes: (F, 4) u0, u1, v0, v1 of the loops; whole: (F,), whether
    patches cut to the box need no loops at all; problems: by face, why it cannot be trimmed; incomplete: faces that
    lack a curve in (u, v), which has to be built before they can be trimmed."""

    loops: Loops
    boxes: Array
    whole: NDArray[np.bool_]
    problems: dict[int, str]
    incomplete: list[int]


@np.errstate(all="ignore")  # numbers that are none end up in the boxes, where they are looked for
def trim(stream: Stream, faces: Index) -> Trims:
    """The trims of faces (shape indices (F,), all with a surface) in their own coordinates."""
    uses, incomplete = edge_uses(stream, faces)
    curves, order, problems = _runs(stream, faces, uses)
    boxes = bounding_boxes(order, curves, len(faces))
    empty = ~((boxes[:, 1] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 2]))
    endless = ~(np.abs(boxes).max(axis=1) < INFINITE)
    has_loops = np.zeros(len(faces), bool)
    has_loops[order.face] = True
    for k in np.flatnonzero(has_loops & (empty | endless)).tolist():
        problems[k] = (
            "its edges have coordinates that are infinite or not numbers" if endless[k] else "its edges enclose no area"
        )
    bare = ~has_loops
    bare[[*problems, *incomplete]] = False
    for k in np.flatnonzero(bare).tolist():
        boxes[k] = natural_bounds(stream.surfaces[int(stream.faces.surface[faces[k]])])
        if not np.abs(boxes[k]).max() < INFINITE:
            problems[k] = "it has no edges, and its surface has no end"
    kept = np.ones(len(faces), bool)
    kept[list(problems)] = False
    loops, boxes = closed(order, curves, boxes, kept, _at_poles(stream, faces, order, curves, boxes))
    return Trims(loops, boxes, bare | rectangles(loops, boxes), problems, incomplete.tolist())


def _at_poles(stream: Stream, faces: Index, order: Runs, curves: Segments, boxes: Array) -> NDArray[np.bool_]:
    """Whether the gap behind each segment (S,) that may be a corner is a missing edge along a pole instead."""
    result = np.zeros(len(order.segment), bool)
    before = corner_gaps(order, curves, boxes)
    loop = np.searchsorted(order.loop_offsets, before, side="right") - 1
    surface = stream.faces.surface[faces[order.face[loop]]]
    chosen = np.flatnonzero(_HAS_POLES[stream.surfaces.kind[surface]])
    if not len(chosen):
        return result
    before, loop = before[chosen], loop[chosen]
    after = np.where(before + 1 == order.loop_offsets[loop + 1], order.loop_offsets[loop], before + 1)
    ends = np.stack([_end_heights(order, curves, before, 1), _end_heights(order, curves, after, 0)], axis=1)
    surfaces = {index: stream.surfaces[index] for index in set(surface[chosen].tolist())}
    for place, index, heights in zip(before.tolist(), surface[chosen].tolist(), ends.tolist(), strict=True):
        result[place] = any(collapsed(surfaces[index], 1, v) for v in heights)
    return result


def _end_heights(order: Runs, curves: Segments, which: Index, end: int) -> Array:
    """v (n,) where the segments `which` (n,) of loops start (end 0) or end (1)."""
    segment = order.segment[which]
    at_last = order.backwards[which] != (end == 1)
    point = curves.first_point[segment] + np.where(at_last, curves.degree[segment], 0)
    return np.asarray(curves.points[point, 1] + order.shift[which, 1])


def _runs(stream: Stream, faces: Index, uses: EdgeUses) -> tuple[Segments, Runs, dict[int, str]]:
    """All segments, their order in loops, and the faces that cannot have loops, with the reason."""
    curves = segments(stream, faces, uses)
    start, end, size = use_ends(uses.wire, uses.reversed, curves)
    ordered = order_uses(uses.wire, start, end, size)
    difficult = _difficult(stream, faces, uses, ordered, start, end, size)
    easy = ~marked(len(faces), difficult)[uses.face[ordered.use]]
    use, loop = ordered.use[easy], ordered.loop[easy]
    face, shift = uses.face[use], np.zeros((len(use), 2))
    problems: dict[int, str] = {}
    if len(difficult):
        rows, links, problems = _chained(stream, faces, uses, difficult, start, end, size)
        curves = curves.with_links(links)
        hard_face, hard_loop, hard_use, hard_shift = rows
        face, loop = np.append(face, hard_face), np.append(loop, hard_loop)
        use, shift = np.append(use, hard_use), np.concatenate([shift, hard_shift])
        order = np.argsort(face, kind="stable")
        face, loop, use, shift = face[order], loop[order], use[order], shift[order]
    link_count = len(curves.offsets) - 1 - len(uses.face)
    against = np.append(uses.reversed, np.zeros(link_count, bool))[use]
    edge = np.append(_edge_numbers(stream, uses), np.full(link_count, -1))[use]
    return curves, runs(curves, face, loop, use, against, shift, edge), problems


def _difficult(
    stream: Stream, faces: Index, uses: EdgeUses, ordered: Ordered, start: Array, end: Array, size: Array
) -> Index:
    """Faces with a wire whose order is not plain, or with a gap in a loop on a surface that has a period."""
    wires = marked(uses.wire.max(initial=-1) + 1, ordered.unclear)
    difficult = marked(len(faces), uses.face[wires[uses.wire]])
    use, loop = ordered.use, ordered.loop
    last = np.append(loop[1:] != loop[:-1], True)[: len(loop)]
    following = np.arange(1, len(use) + 1)
    following[last] = np.flatnonzero(np.append(True, last[:-1])[: len(loop)])
    gap = (np.abs(end[use] - start[use[following]]) > _WIDE * size[use]).any(axis=1)
    face = np.flatnonzero(marked(len(faces), uses.face[use[gap]]))
    difficult[face[stream.surfaces.may_be_periodic(stream.faces.surface[faces[face]])]] = True
    return np.flatnonzero(difficult)


Rows = tuple[Index, Index, Index, Array]  # face, loop, use, shift


def _chained(
    stream: Stream, faces: Index, uses: EdgeUses, difficult: Index, start: Array, end: Array, size: Array
) -> tuple[Rows, Array, dict[int, str]]:
    """The difficult faces' loops as rows for assemble(); links (n, 2, 2), used as uses U, U + 1, ..; problems."""
    problems: dict[int, str] = {}
    spaces: dict[int, ParameterSpace] = {}
    rows: list[tuple[int, int, int]] = []
    shifts: list[tuple[float, float]] = []
    links: list[tuple[tuple[float, float], tuple[float, float]]] = []
    next_loop = len(uses.face)  # beyond the numbers of all plain loops
    bounds = np.searchsorted(uses.face, np.stack([difficult, difficult + 1])).T.tolist()
    for face, (low, high) in zip(difficult.tolist(), bounds, strict=True):
        wires: dict[int, list[Stretch]] = defaultdict(list)
        sizes: dict[int, tuple[float, float]] = {}
        values = (column[low:high].tolist() for column in (uses.wire, start, end, size))
        for use, (wire, begin, stop, extent) in enumerate(zip(*values, strict=True), low):
            wires[wire].append(Stretch(use, tuple(begin), tuple(stop)))
            sizes[wire] = tuple(extent)
        surface = int(stream.faces.surface[faces[face]])
        if surface not in spaces:
            spaces[surface] = _space(stream, surface)
        try:
            loops = chain_face(list(wires.values()), list(sizes.values()), spaces[surface])
        except ValueError as problem:
            problems[face] = str(problem)
            continue
        for loop in loops:
            for stretch in loop:
                number = stretch.use if stretch.use >= 0 else len(uses.face) + len(links)
                if stretch.use < 0:
                    links.append((stretch.start, stretch.end))
                rows.append((face, next_loop, number))
                shifts.append(stretch.shift)
            next_loop += 1
    face_column, loop_column, use_column = np.array(rows, np.intp).reshape(-1, 3).T
    return (
        (face_column, loop_column, use_column, np.array(shifts).reshape(-1, 2)),
        np.array(links).reshape(-1, 2, 2),
        problems,
    )


def _space(stream: Stream, index: int) -> ParameterSpace:
    surface = stream.surfaces[index]
    return ParameterSpace(
        periods(surface), natural_bounds(surface), lambda axis, value: collapsed(surface, axis, value)
    )


def _edge_numbers(stream: Stream, uses: EdgeUses) -> Index:
    """Distinct edges (U,) counted in the order of their first use; -1 for seams and degenerate edges."""
    drawn = np.flatnonzero(~uses.seam & ~stream.edges.degenerated[uses.edge])
    result = np.full(len(uses.face), -1, np.intp)
    _, result[drawn] = distinct(uses.edge[drawn])
    return result
