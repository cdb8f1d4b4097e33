"""The resolution that the machine holds at 30 frames a second, from how long frames took."""

from __future__ import annotations

FRAME_SECONDS = 1 / 30
SHARE = 0.9  # of a frame's time is for rendering, the rest for handing it over
SMALLEST = 1 / 4  # below, little is left to see, and as little time to gain: much of it does not depend on the area
STEP = 1 / 32  # scales are multiples of this, so that they settle
MOST_SHRINK = 0.6  # factor at a time: one slow frame may be the machine's fault
MOST_GROWTH = 1.25
SLACK = 0.07  # part of the budget that growing leaves free: no flicker between two scales
NEWEST = 0.25  # share of the newest frame in the mean of those at one scale: their times scatter
PATIENCE = 60  # frames until a scale that was too slow is tried again


class AdaptiveScale:
    """Scale of the window's resolution for frames in motion, SMALLEST to 1.

    A frame's time is some fixed part and one that grows with its area, so the square root of budget / time never
    overshoots. Where that stays below a step and there is room, the next step is tried: the fixed part may be large.
    """

    def __init__(self, budget: float = SHARE * FRAME_SECONDS, value: float = 0.5) -> None:
        """budget: seconds a frame may take. value: of the first frame."""
        self.budget = budget
        self.value = value
        self._too_large = 2.0  # the smallest scale that was too slow lately
        self._patience = 0
        self._mean = (0.0, 0.0)  # scale of the last frames, and seconds they took

    def update(self, seconds: float, scale: float) -> None:
        """Take into account that a frame at that scale took so long."""
        before, mean = self._mean
        if scale == before:
            seconds = mean + NEWEST * (seconds - mean)
        self._mean = scale, seconds
        room = self.budget / max(seconds, 1e-6)
        self._patience -= 1
        if room < 1.0:
            self._too_large, self._patience = scale, PATIENCE
            self.value = max(_whole_steps(scale * max(room**0.5, MOST_SHRINK)), SMALLEST)
            return
        if self._patience <= 0:
            self._too_large = 2.0
        safe = _whole_steps(scale * min((room * (1.0 - SLACK)) ** 0.5, MOST_GROWTH))
        tried = scale + STEP if room * (1.0 - SLACK) > 1.0 else scale
        value = max(safe, tried if tried < self._too_large else scale)
        self.value = min(value, 1.0)


def _whole_steps(scale: float) -> float:
    return scale // STEP * STEP


def scaled(resolution: tuple[int, int], scale: float) -> tuple[int, int]:
    """A resolution (width, height) in pixels at about the scale, whose sides' ratio is as near as whole numbers allow.

    A frame of another ratio than its pane would be shown slightly stretched.
    """
    width, height = resolution
    if scale >= 1.0:
        return resolution
    middle = max(round(height * scale), 1)
    heights = range(max(middle - 4, 1), min(middle + 4, height) + 1)
    best = min(
        heights, key=lambda rows: (abs(round(width * rows / height) * height / (width * rows) - 1), abs(rows - middle))
    )
    return max(round(width * best / height), 1), best
