"""Many instances of one model in one picture: how time grows with the number of patches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..extent import bounding_box
from ..model import Model
from ..render import DEFAULT_METHOD
from .frames import frame_time
from .subject import Subject
from .timing import Timing

SERIES = (1_000, 10_000, 100_000)  # patches, at the same screen coverage
MANY = 100_000


@dataclass(frozen=True)
class CrowdTime:
    """Frames of one sample a pixel row of so many instances of a model, all of them in the picture."""

    model: str
    instances: int
    patches: int
    threads: int
    seconds: Timing
    pieces: int
    stages: dict[str, float]


def measure_crowds(subject: Subject, threads: int) -> Iterator[CrowdTime]:
    """The teapot: the series on one thread. The chain: MANY patches on all threads. Nothing of other models."""
    if subject.name == "teapot":
        for patches in SERIES:
            yield _time(subject, patches, 1)
    if subject.name == "chain":
        yield _time(subject, MANY, threads)


def _time(subject: Subject, patches: int, threads: int) -> CrowdTime:
    count = ceil(patches / subject.model.placed_patch_count)
    model = crowd(subject.model, count, subject.camera)
    camera = Camera.fit(model, resolution=subject.resolution)
    frame = frame_time(model, camera, subject.resolution, DEFAULT_METHOD, threads, 1)
    total = model.placed_patch_count
    return CrowdTime(subject.name, count, total, threads, frame.seconds, frame.pieces, frame.stages)


def crowd(model: Model, count: int, camera: Camera) -> Model:
    """`count` instances of a model, side by side in rows and columns across the camera's view."""
    low, high = bounding_box(model)
    step = float(np.linalg.norm(high - low))
    right, up, _ = camera.axes()
    columns = ceil(sqrt(count))
    place = np.arange(count)
    moves = step * (np.multiply.outer(place % columns, right) + np.multiply.outer(place // columns, up))
    return replaced(model, moves)


def replaced(model: Model, moves: NDArray[np.float64]) -> Model:
    """A model of one instance for each translation (n, 3), model units."""
    count, placements = len(moves), len(model.placements)
    matrices = np.tile(model.placements, (count, 1, 1))
    matrices[:, :3, 3] += np.repeat(moves, placements, axis=0)
    instance = np.repeat(np.arange(count), model.face_count)
    return replace(
        model,
        face_definition=np.tile(model.face_definition, count),
        face_placement=(np.tile(model.face_placement, count) + placements * instance).astype(np.int32),
        placements=matrices,
        face_outward=np.tile(model.face_outward, count),
        face_color=np.tile(model.face_color, (count, 1)),
        face_name=model.face_name * count,
        tree=[],
    )
