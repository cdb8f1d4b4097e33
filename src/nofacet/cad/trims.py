"""A face's wires to trim loops of rational Bezier segments in its own (u, v).

Trimming follows the curves that the file gives in (u, v) ("pcurves"), wherever the 3-D edge may run. Planes mostly
have none: there the 3-D curve is projected by the plane's frame, which is exact for every kind of curve.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite, pi

import numpy as np
from numpy.typing import NDArray

from .corners import weld
from .curves import Piece, pieces, projected, spline_pieces
from .loops import (
    Box,
    Loop,
    ParameterSpace,
    Use,
    bounding_box,
    chain,
    close_winding,
    is_rectangle,
    reverse,
    winding,
)
from .stream import FORWARD, REVERSED, Curve, Edge, Face, Location, PCurve, Stream, Surface, multiply
from .surfaces import INFINITE, natural_bounds, periods


class MissingPCurve(ValueError):
    """An edge on a curved surface has no curve in (u, v); one has to be built before the face can be trimmed."""


@dataclass(frozen=True)
class Trim:
    """A face's loops (closed bitwise), their box, and whether patches cut to the box need no loops at all."""

    loops: list[Loop]
    box: Box
    whole: bool


@dataclass(frozen=True)
class _EdgeUse:
    edge: int
    reversed: bool
    location: Location


@dataclass
class Trimmer:
    """Makes trims from a stream. edge_index numbers distinct edges in the order of their first use."""

    stream: Stream
    edge_index: dict[int, int] = field(default_factory=dict)

    def trim(self, shape: int) -> Trim:
        """The trim of face `shape` (an index of stream.shapes) in its own coordinates.

        Raises ValueError, with the reason, where the face cannot be trimmed: MissingPCurve or a face without end.
        """
        face: Face = self.stream.shapes[shape]
        surface: Surface = self.stream.surfaces[face.surface]
        bounds = natural_bounds(surface)
        wires = self._wires(shape)
        space = ParameterSpace(periods(surface), bounds, lambda axis, value: _collapsed(surface, axis, value))
        seams = self._seams(face, wires)
        closed: list[Loop] = []
        winding_loops: list[Loop] = []
        turns: list[tuple[int, int]] = []
        for wire in wires:
            uses = [use for edge_use in wire if (use := self._use(face, surface, edge_use, seams))]
            for loop in chain(uses, space) if uses else []:
                turn = winding(loop, space)
                if turn == (0, 0):
                    closed.append(loop)
                else:
                    winding_loops.append(loop)
                    turns.append(turn)
        if not closed and not winding_loops:
            if not all(abs(bound) < INFINITE for bound in bounds):
                raise ValueError("it has no edges, and its surface has no end")
            return Trim([], bounds, True)
        closed += close_winding(winding_loops, turns, space)
        u0, u1, v0, v1 = bounding_box(closed)
        if not all(map(isfinite, (u0, u1, v0, v1))) or max(map(abs, (u0, u1, v0, v1))) >= INFINITE:
            raise ValueError("its edges have coordinates that are infinite or not numbers")
        if not (u1 > u0 and v1 > v0):
            raise ValueError("its edges enclose no area")
        welded = [weld(loop, u1 - u0, v1 - v0, space) for loop in closed]
        if any(len(loop) > len(other) for loop, other in zip(welded, closed, strict=True)):
            u0, u1, v0, v1 = bounding_box(welded)  # edges led on to their corner can leave the box
        closed = welded
        box = (u0, u1, v0, v1)
        return Trim(closed, box, is_rectangle(closed, box))

    def _wires(self, shape: int) -> list[list[_EdgeUse]]:
        """The edge uses of each wire on the face taken forward; internal and external ones bound nothing."""
        children, kinds = self.stream.children, self.stream.kinds
        wires = []
        for wire_orientation, wire, wire_location in children[shape]:
            if wire_orientation not in (FORWARD, REVERSED) or kinds[wire] != 5:
                continue
            wires.append(
                [
                    _EdgeUse(
                        edge,
                        orientation != wire_orientation,
                        self._locate(wire_location, location),
                    )
                    for orientation, edge, location in children[wire]
                    if orientation in (FORWARD, REVERSED)
                ]
            )
        return wires

    def _locate(self, outer: int, inner: int) -> Location:
        if not outer and not inner:
            return ()
        return multiply(self.stream.locations[outer], self.stream.locations[inner])

    def _seams(self, face: Face, wires: list[list[_EdgeUse]]) -> set[int]:
        """Edges that the face uses twice as the two sides of a seam."""
        seen: set[int] = set()
        seams: set[int] = set()
        for wire in wires:
            for use in wire:
                if use.edge in seen:
                    record = self.stream.shapes[use.edge]
                    if any(p.second and p.surface == face.surface for p in record.pcurves):
                        seams.add(use.edge)
                seen.add(use.edge)
        return seams

    def _use(self, face: Face, surface: Surface, use: _EdgeUse, seams: set[int]) -> Use:
        """The segments of one edge use, in its own direction; empty for a degenerate edge that has no curve."""
        edge: Edge = self.stream.shapes[use.edge]
        pcurve = self._pcurve(face, edge, use.location)
        if pcurve is not None:
            index = pcurve.second if use.reversed and pcurve.second else pcurve.curve
            segments = _segments(self.stream.curves2d[index], pcurve.first, pcurve.last)
        elif surface.kind == "plane" and edge.curve is not None:
            segments = self._projected(face, surface, edge, use.location)
        elif edge.degenerated:
            return []
        else:
            raise MissingPCurve("an edge has no curve in the surface's parameters")
        number = -1
        if not edge.degenerated and use.edge not in seams:
            number = self.edge_index.setdefault(use.edge, len(self.edge_index))
        result: Use = [(points, number) for points in segments]
        return reverse(result) if use.reversed else result

    def _pcurve(self, face: Face, edge: Edge, location: Location) -> PCurve | None:
        """The edge's curve on this face's surface at this place, as BRep_Tool::CurveOnSurface matches it."""
        for pcurve in edge.pcurves:
            if pcurve.surface == face.surface:
                if not location and pcurve.location == face.location:
                    return pcurve
                locations = self.stream.locations
                if multiply(location, locations[pcurve.location]) == locations[face.location]:
                    return pcurve
        return None

    def _projected(self, face: Face, surface: Surface, edge: Edge, location: Location) -> list[Piece]:
        """The 3-D curve in the plane's (u, v): inverse frame, after the edge's placement relative to the face."""
        assert edge.curve is not None
        index, curve_location, first, last = edge.curve
        axes = (surface.x, surface.y)
        rows = [[*axis, -sum(a * o for a, o in zip(axis, surface.origin, strict=True))] for axis in axes]
        locations = self.stream.locations
        placed = multiply(location, locations[curve_location]) if location else locations[curve_location]
        if placed != locations[face.location]:
            inverse = np.linalg.inv(self.stream.matrices[face.location])
            rows = (np.array(rows) @ inverse @ matrix_of(self.stream, placed)).tolist()
        curve = self.stream.curves[index]
        if curve.kind != "offset":
            return _segments(projected(curve, rows), first, last)
        points = np.array(pieces(curve, first, last)[0])
        flat = np.concatenate([points @ np.array(rows).T, points[..., 3:]], axis=-1)
        return [list(map(tuple, piece)) for piece in flat.tolist()]


def matrix_of(stream: Stream, location: Location) -> NDArray[np.float64]:
    """The (4, 4) matrix of a datum chain, the first pair being the rightmost factor."""
    matrix = np.eye(4)
    for datum, power in location:
        matrix = np.linalg.matrix_power(stream.matrices[datum], power) @ matrix
    return matrix


def _segments(curve: Curve, first: float, last: float) -> list[Piece]:
    """Rational Bezier segments (wu, wv, w) of a 2-D curve over [first, last], end weights 1."""
    if curve.kind not in ("bezier", "bspline") or not curve.rational:
        return pieces(curve, first, last)[0]
    points, _ = spline_pieces(curve, first, last)
    degree = points.shape[1] - 1
    # a Moebius change of parameter makes both end weights 1 and leaves the curve as it is
    start, ratio = points[:, :1, 2:], (points[:, :1, 2:] / points[:, -1:, 2:]) ** (1 / degree)
    points = points * (ratio ** np.arange(degree + 1)[:, None] / start)
    points[:, (0, -1)] /= points[:, (0, -1), 2:]
    return [list(map(tuple, segment)) for segment in points.tolist()]


def _collapsed(surface: Surface, axis: int, value: float) -> bool:
    """Whether the surface is a single point where parameter `axis` has `value`: poles and tips of turned surfaces."""
    if axis != 1:
        return False
    r1, r2 = surface.radii
    if surface.kind == "sphere":
        return abs(abs(value) - pi / 2) < 1e-6
    if surface.kind == "cone":
        return abs(r1 + value * np.sin(r2)) <= 1e-6 * (abs(r1) + abs(value))
    if surface.kind == "torus":
        return bool(abs(r1 + r2 * np.cos(value)) <= 1e-6 * r2)
    if surface.kind == "revolution":
        assert surface.curve is not None
        point = np.array(pieces(surface.curve, value, value + 1e-9)[0][0][0])
        spoke = point[:3] / point[3] - np.array(surface.origin)
        return bool(np.linalg.norm(np.cross(spoke, surface.z)) <= 1e-6 * np.linalg.norm(spoke))
    return False
