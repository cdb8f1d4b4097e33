"""Section planes as the user handles them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nofacet_viewer")
import nofacet
from nofacet.camera import Vector
from nofacet.model import Model
from nofacet_viewer.section_planes import AXES, Bounds, SectionPlane, SectionPlanes

SLANTED = nofacet.Section((0, 0, 0), (0.3, -0.5, 0.8)).normal


@pytest.mark.parametrize("axis", [*AXES.values(), SLANTED])
@pytest.mark.parametrize("flipped", [False, True])
def test_tilts_turn_the_normal(axis: Vector, flipped: bool) -> None:
    plane = SectionPlane((1, 2, 3), axis, flipped=flipped)
    sign = -1 if flipped else 1
    assert plane.normal == tuple(sign * c for c in axis)  # to the last bit
    for tilts in ((30.0, 0.0), (0.0, 30.0)):
        tilted = replace(plane, tilts=tilts)
        assert np.linalg.norm(tilted.normal) == pytest.approx(1)
        assert sign * np.dot(tilted.normal, axis) == pytest.approx(np.cos(np.radians(30)))
    both = [np.array(replace(plane, tilts=tilts).normal) for tilts in ((90.0, 0.0), (0.0, 90.0))]
    assert both[0] @ both[1] == pytest.approx(0, abs=1e-12)
    assert np.linalg.norm(replace(plane, tilts=(-40.0, 70.0)).normal) == pytest.approx(1)


def test_the_axes_tilt_towards_the_next_ones() -> None:
    names = list(AXES)
    for k, name in enumerate(names):
        for tilts, towards in (((90.0, 0.0), names[(k + 1) % 3]), ((0.0, 90.0), names[(k + 2) % 3])):
            normal = SectionPlane((0, 0, 0), AXES[name], tilts).normal
            np.testing.assert_allclose(normal, AXES[towards], atol=1e-15)


def test_moving_along_the_normal() -> None:
    plane = SectionPlane((1, 2, 3), (1, 0, 0), (25.0, -10.0))
    middle = (0.5, 0.5, 0.5)
    moved = plane.at_distance(-4.25, middle)
    assert moved.distance(middle) == pytest.approx(-4.25)
    assert moved.normal == plane.normal
    across = np.subtract(moved.origin, plane.origin)
    np.testing.assert_allclose(np.cross(across, plane.normal), 0, atol=1e-12)
    assert replace(moved, flipped=True).distance(middle) == pytest.approx(4.25)


def test_planes_that_do_not_cut_are_left_out() -> None:
    given = nofacet.Section((0, 0, 1), (0, 2, 0))
    planes = SectionPlanes([given, given])
    assert planes.sections == (given, given)
    planes.planes[0] = replace(planes.planes[0], enabled=False)
    planes.add((3, 0, 0), (1, 0, 0))
    assert planes.sections == (given, nofacet.Section((3, 0, 0), (1, 0, 0)))


def test_a_box_and_how_far_it_reaches(sphere: Model) -> None:
    bounds = Bounds.of(sphere)
    np.testing.assert_allclose([*bounds.low, *bounds.high], [-1, -1, -1, 1, 1, 1], atol=1e-12)
    np.testing.assert_allclose(bounds.middle, 0, atol=1e-12)
    assert bounds.reach((0, 0, -1)) == pytest.approx(1)
    assert bounds.reach((0.6, 0.8, 0)) == pytest.approx(1.4)


@pytest.mark.parametrize("direction", [(-1, 1, -0.5), (1, -1, 0.5), (0, 0, 1)])
def test_what_is_before_the_middle_is_cut_away(sphere: Model, direction: Vector) -> None:
    planes = SectionPlanes()
    for axis in AXES.values():
        planes.add_through_middle(Bounds.of(sphere), axis, direction)
    assert all(np.dot(section.normal, direction) <= 0 for section in planes.sections)
