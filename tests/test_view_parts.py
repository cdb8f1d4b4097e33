"""Parts of the window that draw nothing themselves: panes, lines in space, colours that stand for numbers."""

from __future__ import annotations

import cadquery as cq
import numpy as np
import pytest

import nofacet
from conftest import sphere_group

pytest.importorskip("moderngl")

from nofacet_viewer import lines
from nofacet_viewer.color_scale import (
    DIVERGING,
    NO_VALUE,
    ColorScale,
    conversion_scale,
    outline_scale,
    rounded_up,
)
from nofacet_viewer.figures import exact_figures
from nofacet_viewer.panes import DIVIDER, pane_resolution, panes
from nofacet_viewer.state import View


@pytest.mark.parametrize("width", [2, 639, 640, 1280])
def test_side_by_side_has_equal_panes_with_a_divider(width: int) -> None:
    left, right = panes(View.SIDE_BY_SIDE, (width, 480))
    assert left.size == right.size == pane_resolution(View.SIDE_BY_SIDE, (width, 480))
    assert left.x == 0 and right.x + right.width == width
    if width > DIVIDER:
        assert 0 <= right.x - (left.x + left.width) - DIVIDER <= 1


def test_other_views_have_the_whole_window() -> None:
    for view in View:
        if view is not View.SIDE_BY_SIDE:
            assert {pane.size for pane in panes(view, (640, 480))} == {(640, 480)}
    assert [pane.side for pane in panes(View.WIPE, (9, 9))] == [View.EXACT, View.TESSELLATED]
    assert [pane.side for pane in panes(View.EXACT, (9, 9))] == [View.EXACT]


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_chords_are_within_the_tolerance_of_the_circle(sphere: nofacet.Model, tolerance: float) -> None:
    found = lines.patch_borders(sphere, tolerance)
    assert np.linalg.norm(found, axis=2) == pytest.approx(1, abs=1e-12)
    sagitta = 1 - np.linalg.norm(found.mean(axis=1), axis=1)
    assert sagitta.max() <= tolerance and sagitta.max() > tolerance / 8
    # Three great circles, each border in two patches; and the eight patches' fourth borders, shrunk to the poles.
    length = np.linalg.norm(found[:, 1] - found[:, 0], axis=1).sum()
    assert length == pytest.approx(2 * 3 * 2 * np.pi, rel=2 * tolerance)


def test_control_nets_and_borders_follow_their_placements() -> None:
    ball = cq.Workplane().sphere(1)
    assembly = cq.Assembly().add(ball, loc=cq.Location((5, 0, 0))).add(ball, loc=cq.Location((-5, 0, 0)))
    model = nofacet.load(assembly)
    for found in (lines.patch_borders(model, 0.01), lines.control_nets(model)):
        x = found[..., 0]
        assert (np.abs(np.abs(x) - 5) <= 1 + 1e-9).all() and (x > 0).sum() == (x < 0).sum() > 0


def test_edges_of_a_mesh() -> None:
    mesh = nofacet.tessellate(cq.Workplane().box(1, 2, 3), nofacet.MeshSetting("test", 0.1))
    assert len(lines.mesh_edges(mesh)) == 6 * 5
    borders = lines.face_borders(mesh)
    assert len(borders) == 6 * 4
    assert np.linalg.norm(borders[:, 1] - borders[:, 0], axis=1).sum() == pytest.approx(2 * 4 * (1 + 2 + 3))


def test_seams_are_no_borders() -> None:
    mesh = nofacet.tessellate(cq.Workplane().cylinder(2, 1), nofacet.MeshSetting("test", 0.01))
    borders = lines.face_borders(mesh)
    assert (borders[:, 0, 2] == borders[:, 1, 2]).all()  # the two rims only
    assert np.linalg.norm(borders[:, 1] - borders[:, 0], axis=1).sum() == pytest.approx(4 * 2 * np.pi, rel=0.02)


def test_borders_of_an_empty_mesh() -> None:
    none = np.empty((0, 3))
    mesh = nofacet.Mesh(none, none.astype(np.float32), none.astype(np.int32), np.empty(0, np.int32), 0.0)
    assert len(lines.face_borders(mesh)) == len(lines.mesh_edges(mesh)) == 0


def test_scales() -> None:
    scale = ColorScale("test", "mm", -2.0, 2.0, DIVERGING)
    assert scale.color([-9, -2, 0, 2]) == pytest.approx(np.array(DIVERGING)[[0, 0, 2, 4]])
    assert scale.color(np.nan) == pytest.approx(NO_VALUE)
    assert scale.ticks() == [(0, "-2"), (0.25, "-1"), (0.5, "0"), (0.75, "1"), (1, "2")]
    assert scale.ramp()[[0, -1]] == pytest.approx(scale.color([-2, 2]))
    log = conversion_scale(np.array([0.0, 3e-14, 2e-9, np.nan]))
    assert (log.low, log.high) == pytest.approx((1e-14, 1e-8))
    assert log.color([1e-14, 1e-11, 1e-8]) == pytest.approx(log.ramp()[[0, 127, 255]], abs=0.01)
    assert log.ticks()[0] == (0, "1e-14")
    assert [rounded_up(value) for value in (0.011, 1.0, 2.1, 7.0)] == pytest.approx([0.02, 1.0, 5.0, 10.0])
    assert outline_scale(0.0).high == 0.01
    root = outline_scale(6.5)
    assert root.ticks() == [(0, "-10"), (0.25, "-2.5"), (0.5, "0"), (0.75, "2.5"), (1, "10")]
    assert root.color([-20, -2.5, 0, 2.5, 10]) == pytest.approx(np.array(DIVERGING))
    assert root.ramp()[[0, -1]] == pytest.approx(root.color([-10, 10]))


def test_figures_say_what_was_not_measured(sphere: nofacet.Model) -> None:
    assert exact_figures(sphere, 0.0123) == ["8 patches", "frame 12 ms", "conversion error not measured"]
    assert len(sphere_group().definition) == sphere.placed_patch_count
