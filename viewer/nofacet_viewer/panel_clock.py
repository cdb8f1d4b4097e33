"""When panels are drawn anew: it takes longer than the rest of a picture, so not with every picture of a motion."""

from __future__ import annotations

from math import inf

SETTLING_TURNS = 2  # that imgui needs after an input until its windows stay the same
BUSY_SECONDS = 0.1  # between pictures of a progress bar
FIGURE_SECONDS = 0.25  # between figures that change with every picture: nobody reads faster


class PanelClock:
    """Times are those of time.monotonic()."""

    def __init__(self) -> None:
        self._turns = SETTLING_TURNS  # to be drawn at once
        self._drawn = -inf  # when
        self._due = inf  # when they are to be drawn again, if nothing happens before

    def touch(self) -> None:
        """Something has happened that panels may show."""
        self._turns = SETTLING_TURNS

    def follow(self, seconds: float) -> None:
        """What panels show changes all the time: draw them so long after the last time."""
        self._due = min(self._due, self._drawn + seconds)

    def patience(self, now: float) -> float:
        """Seconds until panels are due; 0: they are."""
        return 0.0 if self._turns else max(self._due - now, 0.0)

    def drawn(self, now: float) -> None:
        """Panels have been drawn."""
        self._turns, self._drawn, self._due = max(self._turns - 1, 0), now, inf
