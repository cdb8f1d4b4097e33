"""The threads that draw, which wait from one frame to the next."""

from concurrent.futures import ThreadPoolExecutor

import cadquery as cq
import numpy as np

import nofacet
from nofacet.bench.child import in_child

MODEL = nofacet.load(cq.Workplane().sphere(2).cut(cq.Workplane().box(1, 1, 5)))
RESOLUTION = (160, 120)
CAMERA = nofacet.Camera.fit(MODEL, direction=(1, 2, 3), resolution=RESOLUTION)


def faces(threads: int) -> np.ndarray:
    return np.array(nofacet.render(MODEL, CAMERA, RESOLUTION, threads=threads, buffers=("face",)).face)


def test_a_forked_process_has_threads_of_its_own() -> None:
    """It inherits none of those that wait in its parent."""
    expected = faces(3)
    np.testing.assert_array_equal(in_child(lambda: faces(3), 60.0), expected)
    np.testing.assert_array_equal(faces(3), expected)


def test_many_threads_draw_at_once_with_many_threads_each() -> None:
    expected = faces(1)
    with ThreadPoolExecutor(5) as pool:
        for drawn in pool.map(faces, [1, 2, 3, 4, 7] * 8):
            np.testing.assert_array_equal(drawn, expected)


def test_what_is_subdivided_does_not_depend_on_the_threads() -> None:
    """Whichever thread opens a part of a patch; what is opened ahead and then not needed is not counted."""
    frames = [nofacet.render(MODEL, CAMERA, RESOLUTION, threads=threads) for threads in (1, 2, 3, 7)]
    assert len({frame.stats["pieces"] for frame in frames}) == 1
    for frame in frames[1:]:
        np.testing.assert_array_equal(frame.color, frames[0].color)
        np.testing.assert_array_equal(frame.depth, frames[0].depth)
