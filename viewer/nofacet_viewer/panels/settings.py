"""View, overlays and how OpenCascade meshes."""

from __future__ import annotations

from imgui_bundle import imgui

from ..keymap import Keymap
from ..painter import OVERLAYS
from ..session import Session
from ..state import View
from ..tessellated import CHOICES, IN_PIXELS, PIXEL_RANGE


def show_views(session: Session, keymap: Keymap) -> None:
    """One button a view."""
    for view in View:
        if imgui.radio_button(_labelled(view.value, keymap), session.state.view is view):
            session.show_view(view)


def show_overlays(session: Session, keymap: Keymap) -> None:
    """One check box an overlay."""
    for name in OVERLAYS:
        if imgui.checkbox(_labelled(name, keymap), name in session.state.overlays)[0]:
            session.state.toggle_overlay(name)


def show_meshing(session: Session) -> None:
    """The presets of other viewers, and a slider for the deflection in pixels."""
    tessellated = session.tessellated
    imgui.set_next_item_width(-1)
    if imgui.begin_combo("##preset", "deflection in pixels" if tessellated.choice == IN_PIXELS else tessellated.choice):
        for choice in CHOICES:
            label = "deflection in pixels" if choice == IN_PIXELS else choice
            if imgui.selectable(label, choice == tessellated.choice)[0]:
                tessellated.choice = choice
                session.mesh()
        imgui.end_combo()
    imgui.set_next_item_width(-1)
    flags = imgui.SliderFlags_.logarithmic.value
    changed, pixels = imgui.slider_float("##pixels", tessellated.pixels, *PIXEL_RANGE, "%.2f px", flags)
    if changed:
        tessellated.choice, tessellated.pixels = IN_PIXELS, min(max(pixels, PIXEL_RANGE[0]), PIXEL_RANGE[1])
    if imgui.is_item_deactivated_after_edit():
        session.mesh()


def _labelled(name: str, keymap: Keymap) -> str:
    keys = keymap.chords.get(name, ())
    return f"{name.replace('-', ' ')} ({keys[0]})" if keys else name.replace("-", " ")
