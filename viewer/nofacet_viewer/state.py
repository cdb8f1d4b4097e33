"""What the window shows: views, panes and settings, as plain data without a window."""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace

import nofacet

WHITE = (1.0, 1.0, 1.0)


class View(enum.Enum):
    """How the exact picture and OpenCascade's triangles share the window; values as the command line takes them."""

    EXACT = "exact"
    TESSELLATED = "tessellated"
    SIDE_BY_SIDE = "side-by-side"
    WIPE = "wipe"
    BLINK = "blink"
    DIFFERENCE = "difference"

    @property
    def shows_exact(self) -> bool:
        return self is not View.TESSELLATED

    @property
    def shows_mesh(self) -> bool:
        return self is not View.EXACT


@dataclass
class ViewState:
    """What is drawn, and how.

    wipe: where the divider is, fraction of the width. blink_exact: which side blink shows now. overlays: names in
    `nofacet_viewer.painter.OVERLAYS`. background: linear RGB. sections: planes that cut the model.
    """

    view: View = View.SIDE_BY_SIDE
    wipe: float = 0.5
    blink_exact: bool = True
    overlays: frozenset[str] = frozenset()
    background: tuple[float, float, float] = WHITE
    sections: tuple[nofacet.Section, ...] = ()

    def copy(self) -> ViewState:
        return replace(self)

    def toggle_overlay(self, name: str) -> None:
        """Show the overlay if it is not shown, and the other way round."""
        self.overlays ^= {name}

    def move_wipe(self, x: float, width: float) -> None:
        """Put the divider at x of a window of that width, both in pixels; it stays within the window."""
        self.wipe = min(max(x / width, 0.0), 1.0)
