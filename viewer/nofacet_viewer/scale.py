"""The resolution that the machine holds at 30 frames a second, or more, from how long frames took."""

from __future__ import annotations

FRAME_SECONDS = 1 / 30
SHARE = 0.9  # of a frame's time is for rendering, the rest for handing it over
QUICK_SECONDS = 1 / 50  # a frame sharper than HALF takes no longer: who moves the camera feels every frame twice
HALF = 1 / 2
SMALLEST = 1 / 4  # below, little is left to see, and as little time to gain: much of it does not depend on the area
STEP = 1 / 32  # scales are multiples of this, so that they settle
MOST_SHRINK = 0.6  # factor at a time: one slow frame may be the machine's fault
MOST_GROWTH = 1.25
SLACK = 0.07  # part of the budget that growing leaves free: no flicker between two scales
NEWEST = 0.25  # share of the newest frame in the mean of those at one scale: their times scatter
PATIENCE = 60  # frames until a scale that was too slow is tried again


class AdaptiveScale:
    """Scale of the window's resolution for frames in motion, SMALLEST to 1.

    Up to HALF a frame may take the budget, beyond only the quick one: then following fast is worth more.

    A frame's time is some fixed part and one that grows with its area, so the square root of budget / time never
    overshoots. Where that stays below a step and there is room, the next step is tried: the fixed part may be large.
    """

    def __init__(
        self, budget: float = SHARE * FRAME_SECONDS, quick: float = QUICK_SECONDS, value: float = HALF
    ) -> None:
        """budget, quick: seconds a frame may take. value: of the first frame."""
        self.budget = budget
        self.quick = quick
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
        self._patience -= 1
        if seconds > (self.budget if scale <= HALF else self.quick):
            self._too_large, self._patience = scale, PATIENCE
        elif self._patience <= 0:
            self._too_large = 2.0
        within_budget, within_quick = (self._next(budget / max(seconds, 1e-6)) for budget in (self.budget, self.quick))
        self.value = max(min(within_budget, HALF), min(within_quick, 1.0), SMALLEST)

    def _next(self, room: float) -> float:
        """The scale after frames that left so much room: the quotient of what one may take and what they took."""
        scale = self._mean[0]
        if room < 1.0:
            return _whole_steps(scale * max(room**0.5, MOST_SHRINK))
        safe = _whole_steps(scale * min((room * (1.0 - SLACK)) ** 0.5, MOST_GROWTH))
        tried = scale + STEP if room * (1.0 - SLACK) > 1.0 else scale
        return max(safe, tried if tried < self._too_large else scale)


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
