"""Where in the window each side's picture is."""

from __future__ import annotations

from dataclasses import dataclass

from .state import View

Size = tuple[int, int]

DIVIDER = 2  # pixels between the sides, at least


@dataclass(frozen=True)
class Pane:
    """A rectangle of the window that one side is drawn for: its left edge and its width and height, pixels.

    side: View.EXACT or View.TESSELLATED.
    """

    side: View
    x: int
    width: int
    height: int

    @property
    def size(self) -> Size:
        """Width and height."""
        return self.width, self.height


def panes(view: View, size: Size) -> tuple[Pane, ...]:
    """The panes of a view in a window of `size`. Those that share the whole window show one of them at each place."""
    width, height = size
    if view is View.SIDE_BY_SIDE:
        half = max(1, (width - DIVIDER) // 2)
        return Pane(View.EXACT, 0, half, height), Pane(View.TESSELLATED, width - half, half, height)
    sides = (view,) if view in (View.EXACT, View.TESSELLATED) else (View.EXACT, View.TESSELLATED)
    return tuple(Pane(side, 0, width, height) for side in sides)


def pane_resolution(view: View, size: Size) -> Size:
    """Width and height of a view's panes: all have the same. Fit cameras to this."""
    return panes(view, size)[0].size
