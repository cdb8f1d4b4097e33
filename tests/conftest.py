"""Small models made by hand, so that tests of what comes after reading need no file and no OpenCascade."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nofacet.model import Model, PatchGroup

os.environ["NOFACET_CACHE"] = "off"  # tests leave the user's models alone; those of the cache use a folder of their own

# Third-party test files beside the repository; tests that need them are skipped where they are not there.
SHARED_MODELS = Path(__file__).resolve().parents[2] / "shared" / "models"


def model_of(groups: list[PatchGroup], loops: dict[int, list[np.ndarray]] | None = None) -> Model:
    """A model of untrimmed patches, one placed face per definition; loops: definition -> closed polygons (n, 2)."""
    definitions = 1 + max(int(group.definition.max()) for group in groups)
    loops = loops or {}
    segments: list[np.ndarray] = []
    loop_offsets, definition_loops = [0], [0]
    for definition in range(definitions):
        for polygon in loops.get(definition, []):
            corners = np.column_stack([polygon, np.ones(len(polygon))])
            segments += [np.stack([a, b]) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
            loop_offsets.append(len(segments))
        definition_loops.append(len(loop_offsets) - 1)
    return Model(
        source="made by hand",
        groups=groups,
        surface_type=["bspline"] * definitions,
        trimmed=np.array([definition in loops for definition in range(definitions)], np.uint8),
        definition_loops=np.array(definition_loops, np.int64),
        loop_offsets=np.array(loop_offsets, np.int64),
        segment_offsets=np.arange(0, 2 * len(segments) + 1, 2, dtype=np.int64),
        segment_points=np.concatenate(segments) if segments else np.empty((0, 3)),
        segment_edge=np.zeros(len(segments), np.int32),
        conversion_error=np.full(definitions, np.nan),
        face_definition=np.arange(definitions, dtype=np.int32),
        face_placement=np.zeros(definitions, np.int32),
        placements=np.eye(4)[None],
        face_outward=np.ones(definitions, np.int8),
        face_color=np.tile(np.array([0.5, 0.5, 0.5, 1.0], np.float32), (definitions, 1)),
        face_name=[""] * definitions,
    )


def sphere_group(radius: float = 1.0, centre: tuple[float, float, float] = (0, 0, 0)) -> PatchGroup:
    """A sphere around `centre` as eight rational biquadratic octants with OpenCascade's (longitude, latitude)."""
    quarter = np.array([[1, 0, 1], [1, 1, np.sqrt(0.5)], [0, 1, 1]]) * [
        [1, 1, 1],
        [np.sqrt(0.5), np.sqrt(0.5), 1],
        [1, 1, 1],
    ]
    patches, domains = [], []
    for south in (False, True):
        for turn in range(4):
            u0 = turn * np.pi / 2
            rotation = np.array([[np.cos(u0), -np.sin(u0)], [np.sin(u0), np.cos(u0)]])
            across = quarter[:, :2] @ rotation.T  # weighted (x, y) along u
            up = quarter * [1, -1, 1] if south else quarter  # weighted (radius, z) along v, from the equator
            up = up[::-1] if south else up
            points = np.empty((3, 3, 4))
            points[..., :2] = radius * across[:, None, :] * up[None, :, 0, None]
            points[..., 2] = radius * quarter[:, 2, None] * up[None, :, 1]
            points[..., 3] = quarter[:, 2, None] * up[None, :, 2]
            points[..., :3] += points[..., 3:] * np.array(centre, float)
            patches.append(points)
            domains.append([u0, u0 + np.pi / 2, -np.pi / 2 if south else 0, 0 if south else np.pi / 2])
    return PatchGroup(np.array(patches), np.zeros(8, np.int32), np.array(domains), np.ones((8, 2), np.uint8))


def rectangle_group(corners: np.ndarray, domain: tuple[float, float, float, float] = (0, 1, 0, 1)) -> PatchGroup:
    """One bilinear patch; corners (2, 2, 3), first index along u."""
    points = np.concatenate([np.asarray(corners, float), np.ones((2, 2, 1))], axis=2)[None]
    return PatchGroup(points, np.zeros(1, np.int32), np.array([domain], float), np.zeros((1, 2), np.uint8))


@pytest.fixture
def sphere() -> Model:
    """The unit sphere around the origin: one face of eight patches."""
    return replace(model_of([sphere_group()]), surface_type=["sphere"], source="sphere")
