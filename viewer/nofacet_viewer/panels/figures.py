"""The numbers beside each side."""

from __future__ import annotations

from imgui_bundle import imgui

from ..exact import Exact
from ..figures import exact_figures, mesh_figures
from ..panes import panes
from ..session import Session
from ..state import View
from .layout import FAINT_COLOR, LABEL, MARGIN, PROBLEM_COLOR, panel


def show_figures(session: Session, ratio: float) -> None:
    """A label in each side's upper left corner. ratio: framebuffer pixels per unit of imgui's coordinates."""
    view = session.state.view
    left = {pane.side: pane.x / ratio for pane in panes(view, session.size)}
    if View.EXACT in left and not (view is View.BLINK and not session.state.blink_exact):
        with panel("exact figures", (left[View.EXACT] + MARGIN, MARGIN), (0.0, 0.0), LABEL):
            _exact(session)
    if View.TESSELLATED not in left or (view is View.BLINK and session.state.blink_exact):
        return
    if view in (View.WIPE, View.DIFFERENCE):  # both sides share the pane
        at, pivot = (session.state.wipe * session.size[0] / ratio + MARGIN, MARGIN), (0.0, 0.0)
        if view is View.DIFFERENCE or at[0] < 260:
            at = (MARGIN, session.size[1] / ratio - MARGIN)
            pivot = (0.0, 1.0)
    else:
        at, pivot = (left[View.TESSELLATED] + MARGIN, MARGIN), (0.0, 0.0)
    with panel("mesh figures", at, pivot, LABEL):
        _mesh(session)


def _exact(session: Session) -> None:
    imgui.text_unformatted("Exact")
    if session.described is None or session.exact is None:
        return
    exact = session.exact
    for line in exact_figures(session.described, exact.seconds, f" {quality(exact)}"):
        imgui.text_unformatted(line)


def quality(exact: Exact) -> str:
    """At which resolution and how many samples a frame was drawn."""
    if exact.scale < 1.0:
        return f"at {exact.scale:.0%} of the resolution"
    return f"with {exact.samples} sample{'s' if exact.samples > 1 else ''}"


def _mesh(session: Session) -> None:
    tessellated = session.tessellated
    imgui.text_unformatted("OpenCascade's triangles")
    if tessellated.problem:
        imgui.push_text_wrap_pos(320)
        imgui.text_colored(PROBLEM_COLOR, tessellated.problem)
        imgui.pop_text_wrap_pos()
    if tessellated.result:
        error = session.difference.error if session.difference else None
        imgui.text_colored(FAINT_COLOR, tessellated.result.setting.name)
        for line in mesh_figures(tessellated.result, error):
            imgui.text_unformatted(line)
    if tessellated.busy:
        imgui.text_colored(FAINT_COLOR, "meshing ...")
