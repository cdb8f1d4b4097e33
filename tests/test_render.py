"""Requests: what render() takes, and the one line it says of what makes no sense."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import nofacet
from nofacet.model import Model
from scenes import look_down

PLANE = nofacet.Section((0, 0, 0.1), (0, 0, 1))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": (64.0, 48.0)}, r"resolution \(64.0, 48.0\): give two whole numbers"),
        ({"resolution": (64, 48, 3)}, "give two whole numbers"),
        ({"resolution": 64}, "resolution 64: give two whole numbers"),
        ({"resolution": (0, 48)}, "resolution 0 x 48: give a width and height of at least 1"),
        ({"resolution": (1 << 20, 1 << 20)}, "give at most 268435456 pixels in all"),
        ({"samples": 2.5}, "samples 2.5: give 1 to 256, a whole number"),
        ({"samples": 0}, "samples 0: give 1 to 256"),
        ({"threads": 1.5}, "threads 1.5: give 1 to 1024, a whole number, or None for every core"),
        ({"buffers": ()}, "no buffer asked for"),
        ({"buffers": iter(["colour"])}, "unknown buffer 'colour'"),
        ({"buffers": 3}, "buffers 3: give a list"),
        ({"sections": PLANE}, r"sections Section\(origin=.*\): give a list"),
    ],
)
def test_requests_that_make_no_sense(options: dict[str, Any], message: str, sphere: Model) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        nofacet.render(sphere, look_down(3.0), **options)
    assert "\n" not in str(caught.value)


def test_numpys_integers_and_generators_will_do(sphere: Model) -> None:
    width, height, count = np.array([16, 12, 2])
    frame = nofacet.render(
        sphere,
        look_down(3.0),
        (width, height),
        samples=count,
        threads=count,
        buffers=iter(["position", "face"]),  # type: ignore[arg-type]
        sections=(plane for plane in [PLANE]),  # type: ignore[arg-type]
    )
    assert frame.resolution == (16, 12) and frame.buffers == ("depth", "face", "position")
    assert frame.stats["warnings"]  # the sphere is no body, so the plane cuts it open
