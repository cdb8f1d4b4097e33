"""Tables whose entries own runs of rows: numbering, expanding and cutting, against plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from nofacet import _native
from nofacet.cad.curves import Pieces, cut_evenly
from nofacet.cad.tables import distinct, expand_runs, marked

INFINITY = float("inf")


@pytest.mark.parametrize("count", [0, 1, 2, 7, 1000])
def test_distinct_keys_are_numbered_as_they_appear(count: int) -> None:
    random = np.random.default_rng(count)
    # a few small keys, many multiples of a power of two, and the ends of what an integer holds
    keys = random.choice([-1, 0, 3, *(np.arange(300) << 40), -(2**63), 2**63 - 1], count).astype(np.int64)
    number: dict[int, int] = {}
    expected = [number.setdefault(key, len(number)) for key in keys.tolist()]
    first, place = distinct(keys)
    assert place.tolist() == expected
    assert keys[first].tolist() == list(number)
    assert first.tolist() == [expected.index(k) for k in range(len(number))]


def test_runs_are_written_out_in_order() -> None:
    owner, number = expand_runs(np.array([5, 100, 7, -3]), np.array([2, 0, 1, 4]))
    assert owner.tolist() == [0, 0, 2, 3, 3, 3, 3]
    assert number.tolist() == [5, 6, 7, -3, -2, -1, 0]
    with pytest.raises(ValueError, match="negative length"):
        expand_runs(np.array([0]), np.array([-1]))


def test_marks_are_where_they_were_asked_for() -> None:
    assert marked(4, [2, 0, 2]).tolist() == [True, False, True, False]
    assert marked(2, []).tolist() == [False, False]


def test_intervals_are_cut_into_the_fewest_equal_pieces() -> None:
    cuts = cut_evenly(np.array([0.0, 1.0, 0.0]), np.array([3.0, 2.0, 2.0 + 1e-12]), 1.0)
    assert cuts.owner.tolist() == [0, 0, 0, 1, 2, 2]
    assert cuts.start.tolist() == pytest.approx([0, 1, 2, 1, 0, 1])
    assert cuts.stop.tolist() == pytest.approx([1, 2, 3, 2, 1, 2])
    assert cuts.stop[2] == 3.0 and cuts.stop[5] == 2.0 + 1e-12  # the ends are the intervals' own


def test_intervals_without_an_end_are_not_cut_for_ever() -> None:
    ends = np.array([INFINITY, np.nan, -1.0, 1e300])
    assert np.bincount(cut_evenly(np.zeros(4), ends, 1.0).owner).tolist() == [10_000, 1, 1, 10_000]
    whole = cut_evenly(np.zeros(4), ends, INFINITY)
    assert whole.owner.tolist() == [0, 1, 2, 3]
    assert whole.start.tolist() == [0.0] * 4
    np.testing.assert_array_equal(whole.stop, ends)


def test_pieces_of_two_degrees_become_one_table() -> None:
    random = np.random.default_rng(1)
    lines = Pieces(np.array([0, 2, 2]), np.zeros(3), np.ones(3), random.random((3, 2, 3)))
    arcs = Pieces(np.array([3]), np.zeros(1), np.ones(1), random.random((1, 3, 3)))
    offsets, first_point, degree, points = _native.segment_table([lines, arcs], 4)
    assert offsets.tolist() == [0, 1, 1, 3, 4]
    assert degree.tolist() == [1, 1, 1, 2]
    found = [points[at : at + d + 1].tolist() for at, d in zip(first_point, degree, strict=True)]
    assert found == [*lines.points.tolist(), *arcs.points.tolist()]
    with pytest.raises(ValueError, match="no such use"):
        _native.segment_table([arcs], 3)
