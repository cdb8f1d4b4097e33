"""Every key and what the mouse does."""

from __future__ import annotations

from imgui_bundle import imgui

from ..keymap import Keymap
from .layout import panel


def show_help(keymap: Keymap, size: tuple[float, float]) -> None:
    with panel("help", (size[0] / 2, size[1] / 2), (0.5, 0.5)):
        if imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit.value):
            for keys, text in keymap.help():
                imgui.table_next_column()
                imgui.text_unformatted(keys)
                imgui.table_next_column()
                imgui.text_unformatted(text)
            imgui.end_table()
