"""The model that every renderer draws: rational Bezier patches and trim loops in plain arrays.

Nothing here knows OpenCascade. Distinct faces ("definitions") are converted once; an assembly that uses one of
them a thousand times holds a thousand (definition, placement) pairs. Length n, D, L, S, M, F, K, B, N, E below are the
number of patches of a group, definitions, loops, segments, segment points, placed faces, placements, bodies, their
faces and edge uses.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

DEFAULT_COLOR = (0.6, 0.65, 0.7, 1.0)  # linear RGBA of a face that the file gives no colour


@dataclass(frozen=True)
class PatchGroup:
    """All patches of one bidegree (du, dv).

    control_points: (n, du + 1, dv + 1, 4) float64, homogeneous (wx, wy, wz, w), model units, in the definition's own
        coordinates; the first index runs along u.
    definition: (n,) int32, the face definition each patch belongs to.
    domain: (n, 4) float64, u0, u1, v0, v1: OpenCascade's parameters of the face at the patch's borders.
    angular: (n, 2) uint8, for u and v: 0 where the parameter is linear in the patch parameter s, u = u0 + s (u1 - u0);
        1 where it is an angle (radians), u = m + 2 atan(T (2 s - 1)), m = (u0 + u1) / 2, T = tan((u1 - u0) / 4).
    """

    control_points: NDArray[np.float64]
    definition: NDArray[np.int32]
    domain: NDArray[np.float64]
    angular: NDArray[np.uint8]

    @property
    def degree(self) -> tuple[int, int]:
        """Bidegree (du, dv)."""
        return self.control_points.shape[1] - 1, self.control_points.shape[2] - 1


@dataclass(frozen=True)
class Node:
    """One node of the assembly tree: its name, its parent's index (-1: root), the faces it holds itself (F indices)."""

    name: str
    parent: int
    faces: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Model:
    """A CAD model as patches and trim loops.

    Definitions (distinct faces, converted once):
    surface_type: D strings: plane, cylinder, cone, sphere, torus, bezier, bspline, revolution, extrusion, offset,
        triangles, other.
    trimmed: (D,) uint8; 0: the patches are drawn whole, 1: the loops decide.
    definition_loops: (D + 1,) int64, offsets into the loops.
    loop_offsets: (L + 1,) int64, offsets into the segments.
    segment_offsets: (S + 1,) int64, offsets into segment_points; segment k has degree
        segment_offsets[k + 1] - segment_offsets[k] - 1.
    segment_points: (M, 3) float64, homogeneous (wu, wv, w) with w > 0: rational Bezier segments in OpenCascade's
        (u, v) of the face. Neighbouring segments share their end point bitwise, loops are closed, ends have w = 1;
        a point is inside where they wind round it an odd and positive number of times (in their common sense).
    segment_edge: (S,) int32, index of the edge the segment runs along; -1: seam, degenerate edge or weld.
    conversion_error: (D,) float64, largest distance to OpenCascade's surface in model units; NaN: not measured.

    Placed faces, in the order of TopExp::MapShapes(shape, TopAbs_FACE):
    face_definition: (F,) int32.
    face_placement: (F,) int32.
    placements: (K, 4, 4) float64, world from definition coordinates.
    face_outward: (F,) int8, +1 where Su x Sv (in world coordinates) points out of the material, else -1.
    face_color: (F, 4) float32, linear RGBA.
    face_name: F strings, "" without a name.

    Bodies: solids, shells that are in no solid, faces that are in no shell, where they stand; B = 0 where not known:
    body_offsets: (B + 1,) int64, offsets into body_face.
    body_face: (N,) int32, the placed faces that bound each body; two bodies may share a face.
    body_face_outward: (N,) int8, +1 where Su x Sv (in world coordinates) points out of the body there, else -1.
    body_closed: (B,) uint8, 1: every edge is used as often one way as the other, and all faces are drawn: the body has
        an inside, in which section planes show caps.

    Uses of edges in placed faces, E of them, face by face; E = 0 where not measured:
    edge_use_face: (E,) int32, the placed face.
    edge_use_deviation: (E,) float64, distance between the edge's curve in space and the curve on the surface that
        trims the face, model units; NaN where it could not be computed.
    edge_use_tolerance: (E,) float64, how large the source says that distance may be, model units.

    tree: assembly nodes, parents before children; may be empty.
    warnings: one line each.
    """

    source: str
    groups: list[PatchGroup]
    surface_type: list[str]
    trimmed: NDArray[np.uint8]
    definition_loops: NDArray[np.int64]
    loop_offsets: NDArray[np.int64]
    segment_offsets: NDArray[np.int64]
    segment_points: NDArray[np.float64]
    segment_edge: NDArray[np.int32]
    conversion_error: NDArray[np.float64]
    face_definition: NDArray[np.int32]
    face_placement: NDArray[np.int32]
    placements: NDArray[np.float64]
    face_outward: NDArray[np.int8]
    face_color: NDArray[np.float32]
    face_name: list[str]
    body_offsets: NDArray[np.int64] = field(default_factory=lambda: np.zeros(1, np.int64))
    body_face: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    body_face_outward: NDArray[np.int8] = field(default_factory=lambda: np.empty(0, np.int8))
    body_closed: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    edge_use_face: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    edge_use_deviation: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    edge_use_tolerance: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    tree: list[Node] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def definition_count(self) -> int:
        """D, the number of distinct faces."""
        return len(self.surface_type)

    @property
    def face_count(self) -> int:
        """F, the number of placed faces."""
        return len(self.face_definition)

    @property
    def patch_count(self) -> int:
        """Number of patches of all definitions, each counted once however often it is placed."""
        return sum(len(group.definition) for group in self.groups)

    @property
    def placed_patch_count(self) -> int:
        """Number of patches of all placed faces: those of a definition count as often as it is placed."""
        patches = np.zeros(self.definition_count, np.int64)
        for group in self.groups:
            patches += np.bincount(group.definition, minlength=self.definition_count)
        return int(patches[self.face_definition].sum())

    def trim_deviation(self, face: int) -> float:
        """How far a placed face's edges in space run from the curves that trim it, at most, model units; NaN if not
        measured."""
        deviations = self.edge_use_deviation[self.edge_use_face == face]
        return float(np.fmax.reduce(deviations, initial=np.nan))

    def showing(self, visible: NDArray[np.bool_]) -> Model:
        """This model without the faces for which `visible` (F,) is False; those that stay keep their indices.

        The others get a definition that has no patches, and a colour of opacity 0; bodies that lose faces are open.
        """
        nothing = self.definition_count
        body = np.repeat(np.arange(len(self.body_closed)), np.diff(self.body_offsets))
        hidden = np.bincount(body[~visible[self.body_face]], minlength=len(self.body_closed))
        return replace(
            self,
            surface_type=[*self.surface_type, "other"],
            trimmed=np.append(self.trimmed, np.uint8(0)),
            definition_loops=np.append(self.definition_loops, self.definition_loops[-1]),
            conversion_error=np.append(self.conversion_error, 0.0),
            face_definition=np.where(visible, self.face_definition, np.int32(nothing)),
            face_color=np.where(visible[:, None], self.face_color, np.float32(0)),
            body_closed=np.where(hidden == 0, self.body_closed, np.uint8(0)),
        )
