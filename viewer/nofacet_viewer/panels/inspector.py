"""What is under the cursor, what is selected and what is measured."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

import nofacet

from ..actions import perform
from ..inspection import Inspection
from ..keymap import Keymap
from ..session import Session
from .layout import FAINT_COLOR

LABEL_WIDTH = 84.0


def show_inspector(session: Session, keymap: Keymap) -> None:
    """What is measured, the facts of the surface under the cursor, and those of the one that was clicked."""
    inspection = session.inspection
    _show_measuring(inspection, keymap)
    imgui.separator()
    if inspection.hover:
        _show_pick(inspection.hover)
    else:
        imgui.text_disabled("nothing under the cursor")
    count = int(inspection.selected.sum())
    if count or inspection.picked:
        imgui.separator_text(f"Selected: {count} face{'' if count == 1 else 's'}")
        if imgui.small_button("isolate"):
            perform(session, "isolate")
        imgui.same_line()
        if imgui.small_button("select nothing"):
            perform(session, "deselect")
    if inspection.picked:
        _show_pick(inspection.picked)


def _show_measuring(inspection: Inspection, keymap: Keymap) -> None:
    keys = keymap.chords["measure"]
    if imgui.checkbox(f"measure ({keys[0]})" if keys else "measure", inspection.measuring)[0]:
        inspection.toggle_measuring()
    if inspection.measurement:
        _show_facts(inspection.measurement.facts)
    elif inspection.measuring:
        imgui.text_colored(FAINT_COLOR, f"click the {'second' if inspection.points else 'first'} point")


def _show_pick(pick: nofacet.Pick) -> None:
    for line in pick.title:
        imgui.text_wrapped(line)
    _show_facts(pick.facts)


def _show_facts(facts: Sequence[tuple[str, str]]) -> None:
    for label, text in facts:
        imgui.text_colored(FAINT_COLOR, label)
        imgui.same_line(LABEL_WIDTH)
        imgui.text_wrapped(text)
