"""Surfaces to rational Bezier patches in OpenCascade's own parameters, cut to the box of (u, v) that each face uses.

Every exact kind is one of three constructions on homogeneous control points (wx, wy, wz, w):
turning a profile by an angle (cylinder, cone, sphere, torus, revolution), moving a curve along a line (extrusion,
plane) and blossoming (Bezier, B-spline). A turn by [u0, u1] is a rational quadratic in s with
u = m + 2 atan(T (2 s - 1)), m = (u0 + u1) / 2, T = tan((u1 - u0) / 4): control points at the angles u0, m, u1 with
the weights 1, cos((u1 - u0) / 2), 1, the middle one on the tangents' meeting point. All surfaces of one kind are
converted together.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _native
from ..model import PatchGroup
from .curves import ANGLE_LIMIT, cut_evenly, pieces, unit_arcs
from .geometry import CURVES, SURFACES
from .records import BEZIER_SURFACE, CIRCLE, ELLIPSE, Surfaces, gather_reals
from .tables import Index, expand, offsets_of

Array = NDArray[np.float64]

_ELEMENTARY_NUMBERS = {"plane": 12, "cylinder": 13, "cone": 14, "sphere": 13, "torus": 14}


def are_exact(surfaces: Surfaces, which: Index) -> NDArray[np.bool_]:
    """Whether surfaces `which` (n,) are rational in their own parameters (or their half-angle tangents)."""
    profile = surfaces.profiles.kind[surfaces.profile[which]]
    exact_profile = (profile != CURVES.index("hyperbola")) & (profile != CURVES.index("offset"))
    return np.asarray((surfaces.kind[which] != SURFACES.index("offset")) & exact_profile)


class PatchBuilder:
    """Collects patches, one group for each bidegree."""

    def __init__(self) -> None:
        self._parts: dict[tuple[int, int], list[tuple[NDArray[Any], ...]]] = defaultdict(list)

    def add(self, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        """Add the patches of definitions (n,), on the surfaces `which` (n,), all exact, over boxes (n, 4)."""
        kinds = surfaces.kind[which]
        for number in np.flatnonzero(np.bincount(kinds)).tolist():
            rows = np.flatnonzero(kinds == number)
            own = (definition[rows], surfaces, which[rows], boxes[rows])
            kind = SURFACES[number]
            if kind == "plane":
                self._planes(*own)
            elif kind in _ELEMENTARY_NUMBERS:
                self._turned(kind, *own)
            elif kind == "extrusion":
                self._extrusions(*own)
            elif kind == "revolution":
                self._revolutions(*own)
            else:
                self._splines(*own)

    def add_patches(self, points: Array, definition: Index, domain: Array, angular: Any = (0, 0)) -> None:
        """Add patches: points (n, du + 1, dv + 1, 4), definition (n,), domain (n, 4), angular (n, 2) or (2,)."""
        flags = np.empty((len(points), 2), np.uint8)
        flags[:] = angular
        self._parts[points.shape[1] - 1, points.shape[2] - 1].append((points, definition, domain, flags))

    def groups(self) -> list[PatchGroup]:
        """All patches, one group for each bidegree, ordered by bidegree and inside a group by definition."""
        result = []
        for degrees in sorted(self._parts):
            parts = self._parts[degrees]
            columns = parts[0] if len(parts) == 1 else [np.concatenate(column) for column in zip(*parts, strict=True)]
            points, definition, domain, angular = columns
            if (definition[1:] < definition[:-1]).any():
                order = np.argsort(definition, kind="stable")
                points, definition, domain, angular = (column[order] for column in columns)
            if len(definition):
                result.append(PatchGroup(points, definition.astype(np.int32), domain, angular))
        return result

    def _planes(self, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        origin, x, y = _frames(gather_reals(surfaces.data, surfaces.at[which], 12))[:3]
        u, v = boxes[:, :2, None, None], boxes[:, None, 2:, None]
        points = np.ones((len(which), 2, 2, 4))
        points[..., :3] = origin + u * x + v * y
        self.add_patches(points, definition, boxes)

    def _turned(self, kind: str, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        """Cylinders, cones, spheres, tori: the profile in v is turned by u."""
        numbers = gather_reals(surfaces.data, surfaces.at[which], _ELEMENTARY_NUMBERS[kind])
        u = cut_evenly(boxes[:, 0], boxes[:, 1], ANGLE_LIMIT)
        v = cut_evenly(boxes[:, 2], boxes[:, 3], ANGLE_LIMIT if kind in ("sphere", "torus") else np.inf)
        iu, iv = pairs(u.owner, v.owner, len(which))
        owner = u.owner[iu]
        domain = np.stack([u.start[iu], u.stop[iu], v.start[iv], v.stop[iv]], axis=1)
        origin, x, y, z = _frames(numbers[owner])
        r1, r2 = numbers[owner, 12:13], numbers[owner, -1:]
        if kind in ("cylinder", "cone"):
            slope, rise = (np.sin(r2), np.cos(r2)) if kind == "cone" else (0.0, 1.0)
            along = domain[:, 2:]
            radius, height, weight = r1 + along * slope, along * rise, np.ones_like(along)
        else:
            cosine, sine, weight = unit_arcs(domain[:, 2], domain[:, 3])
            major, minor = (r1, r2) if kind == "torus" else (0.0, r1)
            radius, height = major * weight + minor * cosine, minor * sine
        cosine, sine, turn_weight = (turn[:, :, None, None] for turn in unit_arcs(domain[:, 0], domain[:, 1]))
        radius, height, weight = (profile[:, None, :, None] for profile in (radius, height, weight))
        w = turn_weight * weight
        points = np.empty((*w.shape[:3], 4))
        points[..., :3] = origin * w + radius * (cosine * x + sine * y) + (turn_weight * height) * z
        points[..., 3:] = w
        self.add_patches(points, definition[owner], domain, (1, kind in ("sphere", "torus")))

    def _extrusions(self, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        direction = gather_reals(surfaces.data, surfaces.at[which], 3)
        profile = surfaces.profile[which]
        for part in pieces(surfaces.profiles, profile, boxes[:, 0], boxes[:, 1]):
            v = boxes[part.owner, 2:]
            points = np.repeat(part.points[:, :, None], 2, axis=2)
            points[..., :3] += points[..., 3:] * v[:, None, :, None] * direction[part.owner, None, None]
            domain = np.column_stack([part.start, part.stop, v])
            angular = np.zeros((len(v), 2), np.uint8)
            angular[:, 0] = _angular(surfaces, profile[part.owner])
            self.add_patches(points, definition[part.owner], domain, angular)

    def _revolutions(self, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        axes = gather_reals(surfaces.data, surfaces.at[which], 6)
        profile = surfaces.profile[which]
        cuts = cut_evenly(boxes[:, 0], boxes[:, 1], ANGLE_LIMIT)
        for part in pieces(surfaces.profiles, profile, boxes[:, 2], boxes[:, 3]):
            iu, iv = pairs(cuts.owner, part.owner, len(which))
            owner = part.owner[iv]
            origin, z = axes[owner, None, :3], axes[owner, None, 3:]
            meridian = part.points[iv]
            w = meridian[..., 3:]
            spoke = meridian[..., :3] - w * origin
            axial = (spoke * z).sum(axis=-1, keepdims=True) * z
            x = spoke - axial
            y = np.cross(z, x)
            cosine, sine, weight = (turn[:, :, None, None] for turn in unit_arcs(cuts.start[iu], cuts.stop[iu]))
            points = np.empty((len(iu), 3, meridian.shape[1], 4))
            points[..., :3] = cosine * x[:, None] + sine * y[:, None] + weight * (axial + w * origin)[:, None]
            points[..., 3:] = weight * w[:, None]
            domain = np.stack([cuts.start[iu], cuts.stop[iu], part.start[iv], part.stop[iv]], axis=1)
            angular = np.ones((len(iu), 2), np.uint8)
            angular[:, 1] = _angular(surfaces, profile[owner])
            self.add_patches(points, definition[owner], domain, angular)

    def _splines(self, definition: Index, surfaces: Surfaces, which: Index, boxes: Array) -> None:
        bezier = bool(surfaces.kind[which[0]] == BEZIER_SURFACE)
        for owner, domain, points in _native.spline_patches(surfaces.data, bezier, surfaces.at[which], boxes):
            self.add_patches(points, definition[owner], domain)


def pairs(u_owner: Index, v_owner: Index, count: int) -> tuple[Index, Index]:
    """All pairs of pieces in u and in v that have the same owner, u varying slower: indices of both. The owners, less
    than `count`, are sorted."""
    return expand(offsets_of(np.bincount(v_owner, minlength=count)), u_owner)


def _frames(numbers: Array) -> list[Array]:
    """origin, x, y, z, each (n, 1, 1, 3), of elementary surfaces' stored frames: origin, z, x, y."""
    return [numbers[:, None, None, k : k + 3] for k in (0, 6, 9, 3)]


def _angular(surfaces: Surfaces, profile: Index) -> NDArray[np.bool_]:
    kind = surfaces.profiles.kind[profile]
    return np.asarray((kind == CIRCLE) | (kind == ELLIPSE))
