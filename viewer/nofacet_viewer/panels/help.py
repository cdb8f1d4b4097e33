"""Every key and what the mouse does."""

from __future__ import annotations

from itertools import zip_longest

from imgui_bundle import imgui

from ..keymap import Keymap
from .layout import panel


def show_help(keymap: Keymap, size: tuple[float, float]) -> None:
    """The list in two halves, side by side: as a whole it is higher than a small window."""
    rows = keymap.help()
    half = (len(rows) + 1) // 2
    with panel("help", (size[0] / 2, size[1] / 2), (0.5, 0.5)):
        if imgui.begin_table("keys", 4, imgui.TableFlags_.sizing_fixed_fit.value):
            for left, right in zip_longest(rows[:half], rows[half:], fillvalue=("", "")):
                for text in (*left, *right):
                    imgui.table_next_column()
                    imgui.text_unformatted(text)
            imgui.end_table()
