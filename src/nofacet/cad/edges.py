"""Edge uses: every use of an edge in a wire of a face, with the curve it follows on the face's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .curves import Pieces, pieces
from .geometry import SURFACES
from .records import gather_reals
from .stream import REVERSED, WIRE, Stream
from .tables import Index, distinct, expand, marked

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeUses:
    """U uses, ordered by face and wire; edges of internal and external orientation bound nothing and are left out.

    face: (U,), place in the faces asked for; wire: (U,), number of the wire on its face, all faces' wires counted
    through; edge: (U,), shape index; reversed: (U,), whether the wire runs against the edge, the face taken forward;
    location: (U,), of the edge on the face; pcurve: (U,), row of stream.pcurves, -1 for none, which stands for the
    3-D curve's image on the plane; seam: (U,), whether the face uses the edge on both sides of a seam.
    """

    face: Index
    wire: Index
    edge: Index
    reversed: NDArray[np.bool_]
    location: Index
    pcurve: Index
    seam: NDArray[np.bool_]


def edge_uses(stream: Stream, faces: Index) -> tuple[EdgeUses, Index]:
    """The uses in the faces (F,) (shape indices), and the faces (places) left out because a curve in (u, v) is missing.

    Degenerate edges without a curve are left out.
    """
    below = stream.children
    face, row = expand(below.offsets, faces)
    is_wire = (below.orientation[row] <= REVERSED) & (stream.kinds[below.shape[row]] == WIRE)
    face, row = face[is_wire], row[is_wire]
    wire, use = expand(below.offsets, below.shape[row])
    bounding = below.orientation[use] <= REVERSED
    wire, use = wire[bounding], use[bounding]
    edge, face = below.shape[use], face[wire]
    location = stream.locations.compose_all(below.location[row][wire], below.location[use])
    pcurve, seam = _pcurves(stream, faces, face, edge, location)
    plane = stream.surfaces.kind[stream.faces.surface[faces[face]]] == SURFACES.index("plane")
    has_curve = (pcurve >= 0) | (plane & (stream.edges.curve[edge] > 0))
    incomplete = marked(len(faces), face[~has_curve & ~stream.edges.degenerated[edge]])
    against = below.orientation[use] != below.orientation[row][wire]
    kept = np.flatnonzero(has_curve & ~incomplete[face])
    uses = EdgeUses(face[kept], wire[kept], edge[kept], against[kept], location[kept], pcurve[kept], seam[kept])
    return uses, np.flatnonzero(incomplete)


def _pcurves(
    stream: Stream, faces: Index, face: Index, edge: Index, location: Index
) -> tuple[Index, NDArray[np.bool_]]:
    """Each use's curve on its face's surface at its place, as BRep_Tool::CurveOnSurface matches it; seams."""
    own = stream.pcurves
    use, row = expand(own.offsets, edge)
    on_surface = own.surface[row] == stream.faces.surface[faces[face[use]]]
    use, row = use[on_surface], row[on_surface]
    placed = stream.locations.compose_all(location[use], own.location[row])
    in_place = placed == stream.faces.location[faces[face[use]]]
    seam = np.zeros(len(edge), bool)
    seam[use[own.second[row] > 0]] = True
    _, place = distinct(face * len(stream.kinds) + edge)
    seam &= np.bincount(place)[place] > 1
    use, row = use[in_place], row[in_place]
    pcurve = np.full(len(edge), -1, np.intp)
    pcurve[use[::-1]] = row[::-1]  # the first of several stays
    return pcurve, seam


@dataclass(frozen=True)
class Segments:
    """Rational Bezier segments (wu, wv, w) with end weights 1, in the direction of their edges.

    offsets: (U + 1,), use k has the segments offsets[k] .. offsets[k + 1]; first_point: (S,), of each segment in
    points; degree: (S,); points: (M, 3).
    """

    offsets: Index
    first_point: Index
    degree: Index
    points: Array

    def with_links(self, links: Array) -> Segments:
        """The same and straight segments, links (n, 2, 2) from point to point, as further uses of one segment each."""
        count = len(links)
        points = np.ones((2 * count, 3))
        points[:, :2] = links.reshape(-1, 2)
        return Segments(
            np.append(self.offsets, self.offsets[-1] + 1 + np.arange(count)),
            np.append(self.first_point, len(self.points) + 2 * np.arange(count)),
            np.append(self.degree, np.ones(count, np.intp)),
            np.concatenate([self.points, points]),
        )


def segments(stream: Stream, faces: Index, uses: EdgeUses) -> Segments:
    """The segments of all uses in their faces' (u, v)."""
    edges, own = stream.edges, stream.pcurves
    given = np.flatnonzero(uses.pcurve >= 0)
    row = uses.pcurve[given]
    curve = np.where(uses.reversed[given] & (own.second[row] > 0), own.second[row], own.curve[row])
    parts = [
        Pieces(given[part.owner], part.start, part.stop, with_unit_ends(part.points))
        for part in pieces(stream.curves2d, curve, own.first[row], own.last[row])
    ]
    projected = np.flatnonzero(uses.pcurve < 0)
    if len(projected):
        edge = uses.edge[projected]
        matrices = _projections(stream, faces[uses.face[projected]], uses.location[projected], edges.location[edge])
        for part in pieces(stream.curves, edges.curve[edge], edges.first[edge], edges.last[edge]):
            points = np.empty((*part.points.shape[:2], 3))
            np.matmul(part.points, matrices[part.owner], out=points[..., :2])
            points[..., 2] = part.points[..., 3]
            parts.append(Pieces(projected[part.owner], part.start, part.stop, with_unit_ends(points)))
    return Segments(*_native.segment_table(parts, len(uses.face)))


def with_unit_ends(points: Array) -> Array:
    """The same curves (m, p + 1, 3) with end weights 1: a Moebius change of parameter and a common factor."""
    ends = points[:, (0, -1), 2]
    rows = np.flatnonzero((ends != 1.0).any(axis=1))
    if not len(rows):
        return points
    degree = points.shape[1] - 1
    some = points[rows]
    start, ratio = some[:, :1, 2:], (some[:, :1, 2:] / some[:, -1:, 2:]) ** (1 / degree)
    some *= ratio ** np.arange(degree + 1)[:, None] / start
    some[:, (0, -1)] /= some[:, (0, -1), 2:]
    points[rows] = some
    return points


def _projections(stream: Stream, faces: Index, location: Index, curve_location: Index) -> Array:
    """Matrices (n, 4, 2) that take homogeneous points of edges' 3-D curves to the planes' (u, v): the inverse frame,
    after the curve's placement relative to the face's."""
    frames = gather_reals(stream.surfaces.data, stream.surfaces.at[stream.faces.surface[faces]], 12)
    origin, axes = frames[:, :3], frames[:, 6:].reshape(-1, 2, 3)
    result = np.empty((len(faces), 4, 2))
    result[:, :3] = axes.swapaxes(1, 2)
    result[:, 3] = -(axes @ origin[..., None])[..., 0]
    placed = stream.locations.compose_all(location, curve_location)
    own = stream.faces.location[faces]
    moved = np.flatnonzero(placed != own)
    if len(moved):
        pairs, pair = np.unique(np.stack([own[moved], placed[moved]], axis=1), axis=0, return_inverse=True)
        inner, outer = (np.array([stream.locations.matrix(k) for k in column]) for column in pairs.T.tolist())
        relative = np.linalg.inv(inner) @ outer
        result[moved] = relative.swapaxes(1, 2)[pair.ravel()] @ result[moved]
    return result
