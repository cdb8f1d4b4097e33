"""Loops whose edges do not meet: cut where they cross, led on to where they would meet, or linked."""

from __future__ import annotations

from math import sqrt

import pytest

from trim_loops import Loop, reverse, weld

Place = tuple[float, ...]


def line(start: Place, end: Place, edge: int) -> Loop:
    return [([(*start, 1.0), (*end, 1.0)], edge)]


def rest(start: Place, end: Place) -> Loop:
    """A detour from start to end far from the corner at (10, 0), edges 2 to 4."""
    return [*line(start, (10, 10), 2), *line((10, 10), (0, 10), 3), *line((0, 10), end, 4)]


def corner(first: Loop, second: Loop) -> Loop:
    """The welded loop of two edges at a corner of a square of side 10 and the way back."""
    loop = weld([*first, *second, *rest(second[-1][0][-1][:2], first[0][0][0][:2])], 10, 10)
    for (points, _), (following, _) in zip(loop, [*loop[1:], loop[0]], strict=True):
        assert points[-1] == following[0] and points[-1][2] == 1 == points[0][2]
    return loop


def ends(loop: Loop) -> list[tuple[Place, Place, int]]:
    return [(points[0][:2], points[-1][:2], edge) for points, edge in loop]


def test_edges_that_overshoot_are_cut_at_their_crossing() -> None:
    loop = corner(line((0, 0), (10.25, 0), 0), line((10, -0.5), (10, 5), 1))
    assert ends(loop)[:2] == [((0, 0), (10, 0), 0), ((10, 0), (10, 5), 1)]
    assert len(loop) == 5


def test_edges_that_cross_at_a_sharp_angle_are_cut_far_from_their_ends() -> None:
    loop = corner(line((0, 0), (10, 0), 0), line((10, 0.25), (2, -0.25), 1))
    assert ends(loop)[:2] == [((0, 0), (6, 0), 0), ((6, 0), (2, -0.25), 1)]


def test_edges_that_stop_short_are_led_on_by_straight_pieces_that_are_no_edge() -> None:
    loop = corner(line((0, 0), (9.75, 0), 0), line((10, 0.5), (10, 5), 1))
    assert ends(loop)[:4] == [
        ((0, 0), (9.75, 0), 0),
        ((9.75, 0), (10, 0), -1),
        ((10, 0), (10, 0.5), -1),
        ((10, 0.5), (10, 5), 1),
    ]


@pytest.mark.parametrize("backwards", [False, True])
def test_an_edge_is_cut_where_another_stops_just_short_of_it(backwards: bool) -> None:
    first, second = line((0, 0), (10.5, 0), 0), line((10, 0.0625), (10, 5), 1)
    loop = corner(reverse(second), reverse(first)) if backwards else corner(first, second)
    cut, extension, whole = reverse(loop[:3]) if backwards else loop[:3]
    assert ends([cut, whole]) == [((0, 0), pytest.approx((10, 0)), 0), ((10, 0.0625), (10, 5), 1)]
    assert extension[1] == -1


def test_an_edge_is_cut_where_another_starts_on_it() -> None:
    loop = corner(line((0, 0), (10.5, 0), 0), line((10, 0), (10, 5), 1))
    assert ends(loop)[:2] == [((0, 0), (10, 0), 0), ((10, 0), (10, 5), 1)]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (line((0, 0), (9.75, 0), 0), line((9.75, 0.25), (0, 0.25), 1)),  # parallel, back again
        (line((0, 0), (9.5, 0), 0), line((9.75, 0.25), (12, 0.25), 1)),  # parallel, on
        (line((0, 0), (9.75, 0), 0), line((9.75, 0.25), (0, 0.5), 1)),  # tangents meet 10 gaps away
        (line((0, 0), (10.125, 0), 0), line((10, 0.5), (10, 5), 1)),  # one crosses the other's tangent far from its end
        (line((0, 0), (9.9375, 0), 0), line((10, 2), (10, 5), 1)),  # an edge is missing
    ],
)
def test_the_link_stays_where_there_is_no_corner(first: Loop, second: Loop) -> None:
    assert ends(corner(first, second))[1] == (first[0][0][-1][:2], second[0][0][0][:2], -1)


def test_curves_are_cut_exactly_and_keep_their_shape() -> None:
    h = sqrt(0.5)
    arc: Loop = [
        ([(10.0, -1.0, 1.0), (11 * h, -1 * h, h), (11.0, 0.0, 1.0)], 0),
        ([(11.0, 0.0, 1.0), (11 * h, 1 * h, h), (10.0, 1.0, 1.0)], 0),
    ]
    across: Loop = [([(10.875, 0.6, 1.0), (8.0, 0.6, 1.0), (4.5, 0.6, 1.0), (0.0, 0.6, 1.0)], 1)]
    loop = corner(arc, across)
    assert [edge for _, edge in loop] == [0, 0, 1, 2, 3, 4]
    assert loop[1][0][-1][:2] == pytest.approx((10.8, 0.6), abs=1e-14)
    for t in (0.2, 0.7):
        u, v, w = (
            sum(b * p[k] for b, p in zip(((1 - t) ** 2, 2 * t * (1 - t), t * t), loop[1][0], strict=True))
            for k in range(3)
        )
        assert (u / w - 10) ** 2 + (v / w) ** 2 == pytest.approx(1, abs=1e-14)
    assert all(v == pytest.approx(0.6 * w) for _, v, w in loop[2][0][1:])


def test_pieces_beyond_the_crossing_are_dropped_but_no_other_edge() -> None:
    first = [*line((0, 0), (9.5, 0), 0), *line((9.5, 0), (10.25, 0), 0), *line((10.25, 0), (10.5, 0), 0)]
    loop = corner(first, line((10, -0.25), (10, 5), 1))
    assert ends(loop)[:3] == [((0, 0), (9.5, 0), 0), ((9.5, 0), (10, 0), 0), ((10, 0), (10, 5), 1)]


def test_a_loop_with_a_single_gap_is_cut_on_both_of_its_sides() -> None:
    loop = weld([*line((5, -0.25), (5, 5), 0), *line((5, 5), (0, 0), 1), *line((0, 0), (5.25, 0), 2)], 5, 5)
    assert ends(loop) == [((5, 0), (5, 5), 0), ((5, 5), (0, 0), 1), ((0, 0), (5, 0), 2)]


def test_small_gaps_are_moved_away_and_poles_stay_straight() -> None:
    assert len(corner(line((0, 0), (10, 0), 0), line((10, 1e-9), (10, 5), 1))) == 5
    slanted = [*line((0, 0), (4.5, 1), 0), *line((5, 1), (10, 0), 1), *line((10, 0), (0, 0), 2)]
    assert ends(weld(slanted, 10, 1, at_pole=lambda v: v == 1))[1] == ((4.5, 1), (5, 1), -1)
    assert len(weld(slanted, 10, 1)) == 5
