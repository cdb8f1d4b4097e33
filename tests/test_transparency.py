"""Transparent faces: layers over each other, nearest first, over whatever is opaque."""

from dataclasses import replace

import numpy as np
import pytest

import nofacet
from scenes import look_down, rectangle, together

RESOLUTION = (40, 30)
every_method = pytest.mark.parametrize("method", nofacet.methods())


def stacked(*colors: tuple[float, float, float, float]) -> nofacet.Model:
    """Rectangles of 4 x 3 over each other, the first one nearest to an eye above."""
    sheets = [rectangle(0, 0, 4, 3, z=-k) for k in range(len(colors))]
    return replace(together(*sheets), face_color=np.array(colors, np.float32))


def colour_of(model: nofacet.Model, method: str) -> np.ndarray:
    frame = nofacet.render(model, look_down(3, centre=(2, 1.5, 0)), RESOLUTION, method, samples=4)
    np.testing.assert_array_equal(frame.coverage, np.float32(1))
    assert np.ptp(frame.color, axis=(0, 1)).max() < 1e-6  # orthographic, flat: one colour everywhere
    return np.asarray(frame.color[15, 20], np.float64)


RED, GREEN, BLUE = (0.8, 0.1, 0.1), (0.1, 0.8, 0.1), (0.1, 0.1, 0.8)


@every_method
def test_layers_are_composed_nearest_first(method: str) -> None:
    opaque = {rgb: colour_of(stacked((*rgb, 1.0)), method)[:3] for rgb in (RED, GREEN, BLUE)}
    pixel = colour_of(stacked((*RED, 0.25), (*GREEN, 0.5), (*BLUE, 1.0)), method)
    expected = 0.25 * opaque[RED] + 0.75 * 0.5 * opaque[GREEN] + 0.75 * 0.5 * opaque[BLUE]
    np.testing.assert_allclose(pixel, [*expected, 1.0], atol=1e-6)


@every_method
def test_alpha_of_transparent_faces_alone(method: str) -> None:
    assert colour_of(stacked((*RED, 0.25), (*GREEN, 0.5)), method)[3] == pytest.approx(1 - 0.75 * 0.5, abs=1e-6)


@every_method
def test_transparent_face_behind_an_opaque_one_is_hidden(method: str) -> None:
    alone = colour_of(stacked((*BLUE, 1.0)), method)
    assert colour_of(stacked((*BLUE, 1.0), (*RED, 0.25)), method) == pytest.approx(alone, abs=1e-6)


@every_method
def test_values_are_of_the_nearest_face_even_if_transparent(method: str) -> None:
    frame = nofacet.render(stacked((*RED, 0.25), (*BLUE, 1.0)), look_down(3, centre=(2, 1.5, 0)), RESOLUTION, method)
    assert (frame.face == 0).all()
    np.testing.assert_allclose(frame.depth, 10.0, atol=1e-12)
