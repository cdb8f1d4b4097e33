"""Where panels are and how they look."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui

MARGIN = 8.0  # pixels between a panel and the window's border
SIDE_WIDTH = 300.0
PLAIN = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.always_auto_resize.value
    | imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_focus_on_appearing.value
    | imgui.WindowFlags_.no_nav.value
    | imgui.WindowFlags_.no_move.value
)
LABEL = PLAIN | imgui.WindowFlags_.no_inputs.value  # lets the mouse through

PROBLEM_COLOR = (1.0, 0.55, 0.45, 1.0)
FAINT_COLOR = (0.7, 0.7, 0.7, 1.0)


@contextmanager
def panel(name: str, at: tuple[float, float], pivot: tuple[float, float], flags: int = PLAIN) -> Iterator[None]:
    """A window of imgui at a place; pivot: which of its points is there, (0, 0) its top left corner."""
    imgui.set_next_window_pos(at, imgui.Cond_.always.value, pivot)
    imgui.begin(name, None, flags)
    try:
        yield
    finally:
        imgui.end()
