"""The resolution that the machine holds at 30 frames a second, from how long frames took."""

from __future__ import annotations

FRAME_SECONDS = 1 / 30
SHARE = 0.85  # of a frame's time is for rendering, the rest for handing it over
SMALLEST = 1 / 4  # below, little is left to see, and as little time to gain: much of it does not depend on the area
STEP = 1 / 32  # scales are multiples of this, so that they settle
MOST_SHRINK = 0.6  # factor at a time: one slow frame may be the machine's fault
MOST_GROWTH = 1.25
SLACK = 0.07  # part of the budget that growing leaves free: no flicker between two scales


class AdaptiveScale:
    """Scale of the window's resolution for frames in motion, SMALLEST to 1.

    A frame's time is some fixed part and one that grows with its area, so the square root of budget / time never
    overshoots; repeated, it ends at the right scale whatever the parts are.
    """

    def __init__(self, budget: float = SHARE * FRAME_SECONDS, value: float = 0.5) -> None:
        """budget: seconds a frame may take. value: of the first frame."""
        self.budget = budget
        self.value = value

    def update(self, seconds: float, scale: float) -> None:
        """Take into account that a frame at that scale took so long."""
        room = self.budget / max(seconds, 1e-6)
        if room > 1.0:
            room = max(room * (1.0 - SLACK), 1.0)
        factor = min(max(room**0.5, MOST_SHRINK), MOST_GROWTH)
        self.value = min(max(scale * factor // STEP * STEP, SMALLEST), 1.0)


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
