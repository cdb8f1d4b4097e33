"""When the window draws its panels anew."""

from __future__ import annotations

from math import inf

import pytest

pytest.importorskip("imgui_bundle")

from nofacet_viewer.panel_clock import (  # noqa: E402
    BUSY_SECONDS,
    FIGURE_SECONDS,
    MOTION_SECONDS,
    SETTLING_TURNS,
    PanelClock,
)


@pytest.fixture
def clock() -> PanelClock:
    """Of panels that were drawn until they had settled, at time 0."""
    clock = PanelClock()
    for _ in range(SETTLING_TURNS):
        assert clock.due(0.0) and clock.patience(0.0) == 0.0
        clock.drawn(0.0)
    assert not clock.due(1e9) and clock.patience(0.0) == inf
    return clock


def test_an_input_shows_at_once_and_settles(clock: PanelClock) -> None:
    clock.touch()
    for _ in range(SETTLING_TURNS):
        assert clock.due(1.0) and clock.patience(1.0) == 0.0
        clock.drawn(1.0)
    assert not clock.due(1e9)


def test_figures_come_with_a_later_picture(clock: PanelClock) -> None:
    for now in (0.03, 0.06, 0.09):  # pictures of a motion: only the first counts
        clock.follow_picture()
        assert not clock.due(now)
    assert clock.due(FIGURE_SECONDS)
    assert clock.patience(FIGURE_SECONDS) == pytest.approx(MOTION_SECONDS)  # another picture may come
    assert clock.patience(FIGURE_SECONDS + MOTION_SECONDS) == 0.0
    clock.drawn(FIGURE_SECONDS)
    assert not clock.due(1e9) and clock.patience(FIGURE_SECONDS) == inf


def test_progress_is_drawn_without_pictures(clock: PanelClock) -> None:
    clock.follow_progress()
    clock.follow_picture()
    assert clock.patience(0.0) == pytest.approx(BUSY_SECONDS)
    assert not clock.due(BUSY_SECONDS / 2)
    assert clock.due(BUSY_SECONDS) and clock.patience(BUSY_SECONDS) == 0.0
