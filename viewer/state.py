"""What the window shows, as plain values: testable without a window."""

from __future__ import annotations

import enum
from dataclasses import dataclass


class View(enum.Enum):
    """How the two sides are shown."""

    EXACT = "exact"
    TESSELLATED = "tessellated"
    SIDE_BY_SIDE = "side-by-side"
    WIPE = "wipe"
    BLINK = "blink"
    DIFFERENCE = "difference"


@dataclass
class ViewState:
    """One picture of the window.

    wipe: the divider's place, fraction of the width; the exact side is left of it.
    blink_exact: which side blink shows now.
    overlays: names from painter.OVERLAYS.
    background: linear RGB.
    """

    view: View = View.SIDE_BY_SIDE
    wipe: float = 0.5
    blink_exact: bool = True
    overlays: frozenset[str] = frozenset()
    background: tuple[float, float, float] = (1.0, 1.0, 1.0)
