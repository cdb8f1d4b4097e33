"""When panels are drawn anew: it takes longer than the rest of a picture, so not with every picture of a motion."""

from __future__ import annotations

from math import inf

SETTLING_TURNS = 2  # that imgui needs after an input until its windows stay the same
BUSY_SECONDS = 0.1  # between pictures of a progress bar
FIGURE_SECONDS = 0.25  # between figures that change with every picture: nobody reads faster
MOTION_SECONDS = 0.1  # within which a motion's next picture comes: figures wait for it rather than delay it


class PanelClock:
    """Times are those of time.monotonic(), in seconds."""

    def __init__(self) -> None:
        self._turns = SETTLING_TURNS  # to be drawn at once
        self._drawn = -inf  # when
        self._along = self._alone = inf  # from when on panels are drawn with the next picture, and without one

    def touch(self) -> None:
        """Something has happened that panels may show."""
        self._turns = SETTLING_TURNS

    def follow_progress(self) -> None:
        """Panels show how time goes by."""
        self._alone = min(self._alone, self._drawn + BUSY_SECONDS)

    def follow_picture(self) -> None:
        """There is another picture, with figures of its own."""
        self._along = min(self._along, self._drawn + FIGURE_SECONDS)
        self._alone = min(self._alone, self._drawn + FIGURE_SECONDS + MOTION_SECONDS)

    def due(self, now: float) -> bool:
        """Whether a picture that is drawn now comes with new panels."""
        return self._turns > 0 or now >= min(self._along, self._alone)

    def patience(self, now: float) -> float:
        """Seconds until panels are to be drawn even if the picture stays the same."""
        return 0.0 if self._turns else max(self._alone - now, 0.0)

    def drawn(self, now: float) -> None:
        """Panels have been drawn."""
        self._turns, self._drawn, self._along, self._alone = max(self._turns - 1, 0), now, inf, inf
