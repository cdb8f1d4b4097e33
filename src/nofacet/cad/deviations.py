"""How far the edges that a file gives in space run from the curves in (u, v) that trimming follows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import stream as brep
from .convert import placed_faces
from .edges import edge_uses
from .evaluate import Curves, Surfaces
from .geometry import Curve, Surface
from .stream import Stream
from .surfaces import INFINITE

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_PARTS = 8  # of an edge at least, between its samples
_PARTS_OF_SPAN = 4  # of each interval between the knots of its curves: approximations are best at the knots
_ROUNDING = 1e-11  # of the coordinates; curves that are closer at equal parameter are one curve
_NEWTON_STEPS = 12
_DIFFERENCE = 1e-5  # of the parameter range, for tangents: they only have to lead to the nearest point
_SQUARE = 1e-3  # squared cosine between an offset and the curve below which the point counts as the nearest
_FOLD = 0.01  # of the edge's extent: curves that are further apart at equal parameter may fold back

_EVEN = np.linspace(0.0, 1.0, _PARTS + 1)
_ENDS = np.array([0.0, 1.0])


@dataclass(frozen=True)
class EdgeDeviations:
    """One entry for each use of an edge in a placed face, face by face, wires and edges as the face stores them.

    face: (E,) int32, index of the placed face. distance: (E,) float64, model units, between the edge's curve in space
    and its curve on the face's surface. tolerance: (E,) float64, what the file's reader recorded for the edge.
    """

    face: NDArray[np.int32]
    distance: Array
    tolerance: Array


def edge_deviations(shape: TopoDS_Shape) -> EdgeDeviations:
    """Measure how far each edge's 3-D curve and the curve on the surface that trims the face are apart, as curves.

    Two curves can be one and the same and yet far apart at equal parameter, so each sample of either is compared with
    the nearest point of the other (Gauss-Newton from equal parameter, and from the nearest chord where a curve may
    fold back). Samples: nine or more an edge, five on each interval between knots of either curve, then 15 around the
    largest distance found. What a sample yields is never below the true distance there by more than rounding (1e-11
    of the coordinates). The largest of a smooth distance is found to about 1 %; a peak narrower than the samples'
    spacing can be missed. Planes without pcurves are trimmed by the projected edge: there it is the distance from
    the plane.

    Left out: degenerate edges, edges without a 3-D curve or without end, internal edges, faces without a surface.
    Every distinct face is measured once. About 0.1 ms an edge use.
    """
    stream = brep.read(shape)
    faces = placed_faces(stream)
    shapes = faces.shape.tolist()
    first_place = {face: index for index, face in reversed(list(enumerate(shapes)))}
    collection = _Collection()
    own = [face for face in dict.fromkeys(shapes) if stream.faces.surface[face]]
    for face in collection.add(stream, own, own):
        from .repair import face_with_pcurves

        repaired = brep.read(face_with_pcurves(shape, first_place[face]))
        collection.add(repaired, [repaired.root[1]], [face])
    distance = _Measurement(collection).distances()
    tolerance = np.array([row.tolerance for row in collection.rows], float)
    rows_of: dict[int, list[int]] = {face: [] for face in shapes}
    for number, row in enumerate(collection.rows):
        rows_of[row.face].append(number)
    use = np.array([number for face in shapes for number in rows_of[face]], np.int64)
    placed = np.repeat(np.arange(len(shapes), dtype=np.int32), [len(rows_of[face]) for face in shapes])
    locations = stream.locations.compose_all(faces.location, stream.faces.location[faces.shape])
    scale = np.array([_scale(stream, location) for location in locations.tolist()])[placed]
    return EdgeDeviations(placed, scale * distance[use], scale * tolerance[use])


def _scale(stream: Stream, location: int) -> float:
    """World lengths from lengths in the coordinates of a surface at a location."""
    return float(abs(np.linalg.det(stream.locations.matrix(location)[:3, :3])) ** (1 / 3)) if location else 1.0


@dataclass(frozen=True, slots=True)
class _Use:
    """One edge use: its face; its 3-D curve and range; its curve in (u, v) and range, or -1: projected onto the plane.

    Numbers count in the collection's lists; frame takes the 3-D curve to the surface's coordinates.
    """

    face: int
    curve: int
    first: float
    last: float
    surface: int
    pcurve: int
    pcurve_first: float
    pcurve_last: float
    frame: int
    tolerance: float


@dataclass
class _Collection:
    """All edge uses to measure, of one or more streams, and the curves and surfaces they refer to."""

    rows: list[_Use] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)
    curves2d: list[Curve] = field(default_factory=list)
    surfaces: list[Surface] = field(default_factory=list)
    frames: list[Array] = field(default_factory=lambda: [np.eye(4)])

    def add_stream(self, stream: Stream) -> tuple[int, int, int]:
        """Take over a stream's curves and surfaces; returns what to add to its indices, which count from 1."""
        base = len(self.curves) - 1, len(self.curves2d) - 1, len(self.surfaces) - 1
        self.curves += stream.curves[1:]
        self.curves2d += stream.curves2d[1:]
        self.surfaces += stream.surfaces[1:]
        return base

    def add(self, stream: Stream, faces: list[int], names: list[int]) -> list[int]:
        """Add the edge uses of `faces` (shape indices) under other names; returns the names of the faces left out
        because a pcurve is missing that has to be built first."""
        base = self.add_stream(stream)
        uses, incomplete = edge_uses(stream, np.array(faces, np.intp))
        edges, pcurves = stream.edges, stream.pcurves
        measurable = ~edges.degenerated[uses.edge] & (edges.curve[uses.edge] > 0)
        for k in np.flatnonzero(measurable).tolist():
            face, edge, row = int(uses.face[k]), int(uses.edge[k]), int(uses.pcurve[k])
            in_plane = (-1, 0.0, 0.0)
            if row >= 0:
                own = (pcurves.second[row] if uses.reversed[k] else 0) or pcurves.curve[row]
                in_plane = (base[1] + int(own), float(pcurves.first[row]), float(pcurves.last[row]))
            first, last = float(edges.first[edge]), float(edges.last[edge])
            if not all(isfinite(t) and abs(t) < INFINITE for t in (first, last, *in_plane)):
                continue
            curve, surface = base[0] + int(edges.curve[edge]), base[2] + int(stream.faces.surface[faces[face]])
            placed = stream.locations.compose(int(uses.location[k]), int(edges.location[edge]))
            frame = self._frame(stream, int(stream.faces.location[faces[face]]), placed)
            tolerance = float(edges.tolerance[edge])
            self.rows.append(_Use(names[face], curve, first, last, surface, *in_plane, frame, tolerance))
        return [names[k] for k in incomplete.tolist()]

    def _frame(self, stream: Stream, own: int, placed: int) -> int:
        """The number of the frame that takes location `placed` to location `own`."""
        if placed == own:
            return 0
        self.frames.append(np.linalg.inv(stream.locations.matrix(own)) @ stream.locations.matrix(placed))
        return len(self.frames) - 1


@dataclass(frozen=True)
class _Places:
    """Places on edge uses, ascending: use (n,), part of the parameter range s (n,), and both curves' points (n, 3)."""

    use: Index
    s: Array
    space: Array
    surface: Array


class _Measurement:
    """Distances of a collection's edge uses."""

    def __init__(self, collection: _Collection) -> None:
        self._collection = collection
        rows = collection.rows
        self._curves, self._curves2d = Curves(collection.curves, 3), Curves(collection.curves2d, 2)
        self._surfaces = Surfaces(collection.surfaces)
        names = ("curve", "surface", "pcurve", "frame")
        self._curve, self._surface, self._pcurve, self._frame = (
            np.array([getattr(row, name) for row in rows], np.int64) for name in names
        )
        ranges = np.array([(row.first, row.last, row.pcurve_first, row.pcurve_last) for row in rows]).reshape(-1, 4)
        self._range, self._pcurve_range = ranges[:, :2], ranges[:, 2:]
        self._frames = np.array(collection.frames)
        planes = [s if s.kind == "plane" else None for s in collection.surfaces]
        zero = (0.0, 0.0, 0.0)
        self._origin = np.array([s.origin if s else zero for s in planes]).reshape(-1, 3)
        axes = np.array([(s.x, s.y) if s else (zero, zero) for s in planes]).reshape(-1, 2, 3)
        self._normal = np.cross(axes[:, 0], axes[:, 1])

    def distances(self) -> Array:
        """The largest distance (n,) found on each use."""
        count = len(self._curve)
        result = np.zeros(count)
        if not count:
            return result
        samples = [self._samples(row) for row in self._collection.rows]
        begin = np.cumsum([0, *(len(own) for own in samples)])
        use, s = np.repeat(np.arange(count), np.diff(begin)), np.concatenate(samples)
        with np.errstate(all="ignore"):  # values that are not numbers stay so
            places = _Places(use, s, self._in_space(use, s), self._on_surface(use, s))
            nets = _Net(begin, s, places.space), _Net(begin, s, places.surface)
            distance, largest = self._between(places, nets, result)
            np.maximum.at(result, use, distance)
            use, s = _around(largest, use, s)
            places = _Places(use, s, self._in_space(use, s), self._on_surface(use, s))
            np.maximum.at(result, use, self._between(places, nets, result)[0])
        return result

    def _samples(self, row: _Use) -> Array:
        """Parts of the parameter range, ascending, from 0 to 1."""
        curve = self._collection.curves[row.curve]
        if row.pcurve < 0:
            if curve.kind == "line":
                return _ENDS  # its distance from the plane is largest at an end
            breaks = _knots_within(curve, row.first, row.last)
        else:
            pcurve = self._collection.curves2d[row.pcurve]
            breaks = [
                *_knots_within(curve, row.first, row.last),
                *_knots_within(pcurve, row.pcurve_first, row.pcurve_last),
            ]
        if not breaks:
            return _EVEN
        cuts = np.unique(np.round([0.0, *breaks, 1.0], 9))
        parts = max(_PARTS_OF_SPAN, -(-_PARTS // (len(cuts) - 1)))
        inner = cuts[:-1, None] + np.diff(cuts)[:, None] * np.arange(parts) / parts
        return np.append(inner, 1.0)

    def _between(self, places: _Places, nets: tuple[_Net, _Net], known: Array) -> tuple[Array, Index]:
        """Distance (n,) between the curves at each place, and which places have the largest of their use.

        A lower value stands where the distance is below known (one a use) or below that at another place of the use.
        The uses whose distance may be rounding have no largest one.
        """
        use, s, space, surface = places.use, places.s, places.space, places.surface
        equal = np.linalg.norm(space - surface, axis=1)
        rounding = _ROUNDING * np.abs(space).max(axis=1, initial=0.0)
        far = equal > rounding
        distance = np.where(far & (self._pcurve[use] >= 0), 0.0, equal)
        open_ = np.nonzero(far & (self._pcurve[use] >= 0) & (equal > known[use]))[0]
        known = known.copy()
        for first in (_largest(use, open_, equal), open_):  # the largest ones first: they spare most of the others
            own = first[(equal[first] > known[use[first]]) & (distance[first] == 0)]
            if len(own):
                to_surface = _nearest(self._on_surface, nets[1], space[own], use[own], s[own], surface[own])
                to_space = _nearest(self._in_space, nets[0], surface[own], use[own], s[own], space[own])
                distance[own] = np.maximum(to_surface, to_space)
                np.maximum.at(known, use[own], distance[own])
        return distance, _largest(use, np.nonzero(far & (distance > 0))[0], distance)

    def _in_space(self, use: Index, s: Array) -> Array:
        """Points (n, 3) of the edges' 3-D curves, in the surfaces' coordinates."""
        first, last = self._range[use].T
        points = self._curves(self._curve[use], first + s * (last - first))
        moved = np.nonzero(self._frame[use])[0]
        if len(moved):
            frames = self._frames[self._frame[use[moved]]]
            points[moved] = np.einsum("nij,nj->ni", frames[:, :3, :3], points[moved]) + frames[:, :3, 3]
        return points

    def _on_surface(self, use: Index, s: Array) -> Array:
        """Points (n, 3) of the curves that trim, in the surfaces' coordinates."""
        points = np.empty((len(s), 3))
        given = self._pcurve[use] >= 0
        own, part = use[given], s[given]
        first, last = self._pcurve_range[own].T
        parameters = self._curves2d(self._pcurve[own], first + part * (last - first))
        points[given] = self._surfaces(self._surface[own], parameters[:, 0], parameters[:, 1])
        own, part = use[~given], s[~given]
        space, surface = self._in_space(own, part), self._surface[own]
        normal = self._normal[surface]
        height = ((space - self._origin[surface]) * normal).sum(axis=1, keepdims=True)
        points[~given] = space - height * normal
        return points


def _knots_within(curve: Curve, first: float, last: float) -> list[float]:
    """A spline's knots inside its range, as parts of the range; its ends too, so that a spline always has some."""
    if curve.knots is None or len(curve.knots) == 2 and curve.degree == 1:
        return []
    if curve.periodic:
        period = curve.knots[-1] - curve.knots[0]
        turns = np.arange(np.floor((first - curve.knots[0]) / period), np.ceil((last - curve.knots[0]) / period))
        knots = (curve.knots[:-1] + period * turns[:, None]).ravel()
    else:
        knots = curve.knots
    parts = (knots - first) / (last - first)
    return [*parts[(parts > 1e-9) & (parts < 1 - 1e-9)].tolist(), 1.0]


@dataclass(frozen=True)
class _Net:
    """Points on one curve of every edge use: those of use k are begin[k] to begin[k + 1]."""

    begin: Index
    s: Array
    points: Array

    @cached_property
    def extent(self) -> Array:
        """The longest side (uses,) of each curve's box."""
        first = self.begin[:-1]
        sides = np.maximum.reduceat(self.points, first) - np.minimum.reduceat(self.points, first)
        return np.asarray(sides.max(axis=1))

    def nearest(self, points: Array, use: Index) -> Array:
        """Where (n,) the chords of each one's own use are nearest to points (n, 3); use (n,) ascending."""
        result = np.empty(len(points))
        cuts = np.append(np.nonzero(np.diff(use, prepend=-1))[0], len(use))
        for low, high in zip(cuts, cuts[1:], strict=False):
            own = slice(self.begin[use[low]], self.begin[use[low] + 1])
            start, along = self.points[own][:-1], np.diff(self.points[own], axis=0)
            to = points[low:high, None] - start
            part = np.clip((to * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-300), 0.0, 1.0)
            chord = ((to - part[..., None] * along) ** 2).sum(axis=2).argmin(axis=1)
            s = self.s[own]
            result[low:high] = s[chord] + part[np.arange(high - low), chord] * np.diff(s)[chord]
        return result


def _nearest(
    curve: Callable[[Index, Array], Array], net: _Net, points: Array, use: Index, start: Array, at_start: Array
) -> Array:
    """Distance (n,) of points (n, 3) from each one's curve, never above that from at_start, the curve at `start`."""
    distance = _descend(curve, points, use, start, at_start)
    fold = np.nonzero(np.linalg.norm(points - at_start, axis=1) > _FOLD * net.extent[use])[0]
    if len(fold):
        own, place = use[fold], net.nearest(points[fold], use[fold])
        distance[fold] = np.fmin(distance[fold], _descend(curve, points[fold], own, place, curve(own, place)))
    return distance


def _descend(curve: Callable[[Index, Array], Array], points: Array, use: Index, start: Array, at_start: Array) -> Array:
    """Distance (n,) of points (n, 3) from each one's curve by Gauss-Newton from `start`, where it is at `at_start`."""
    s, here = start.copy(), at_start.copy()
    distance = np.linalg.norm(points - here, axis=1)
    active, damping = np.arange(len(points)), np.ones(len(points))
    for _ in range(_NEWTON_STEPS):
        side = np.where(s[active] > 0.5, -_DIFFERENCE, _DIFFERENCE)
        tangent = (curve(use[active], s[active] + side) - here[active]) / side[:, None]
        along, speed = ((points[active] - here[active]) * tangent).sum(axis=1), (tangent**2).sum(axis=1)
        moving = along**2 > _SQUARE * speed * distance[active] ** 2
        active = active[moving]
        there = np.clip(s[active] + damping[active] * (along / speed)[moving], 0.0, 1.0)
        at_there = curve(use[active], there)
        shorter = np.linalg.norm(points[active] - at_there, axis=1)
        better = shorter < distance[active]
        going = better | (np.abs(there - s[active]) > _DIFFERENCE)
        damping[active] = np.where(better, 1.0, 0.25 * damping[active])
        kept = active[better]
        s[kept], here[kept], distance[kept] = there[better], at_there[better], shorter[better]
        active = active[going]
        if not len(active):
            break
    return distance


def _largest(use: Index, places: Index, value: Array) -> Index:
    """Of `places`, for each use the one with the largest value."""
    order = places[np.lexsort((value[places], use[places]))]
    return order[np.append(use[order][1:] != use[order][:-1], True)] if len(order) else order


def _around(places: Index, use: Index, s: Array) -> tuple[Index, Array]:
    """New places: between each one given and its neighbours on the same use."""
    own, inner = use[places], _EVEN[1:-1]
    new = []
    for neighbour in (np.maximum(places - 1, 0), np.minimum(places + 1, len(use) - 1)):
        width = np.where(use[neighbour] == own, s[neighbour] - s[places], 0.0)
        new.append(s[places, None] + width[:, None] * inner)
    result = np.sort(np.concatenate([new[0], s[places, None], new[1]], axis=1), axis=1)
    return np.repeat(own, result.shape[1]), result.ravel()
