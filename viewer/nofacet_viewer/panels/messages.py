"""What is being read, and what went wrong."""

from __future__ import annotations

import os
import time

from imgui_bundle import imgui

from ..session import Session
from .layout import LABEL, MARGIN, PROBLEM_COLOR, panel

MOST_WARNINGS = 20  # that are listed
BAR = (420.0, 0.0)


def show_progress(session: Session, size: tuple[float, float]) -> None:
    """A bar while a file is read that is not shown yet, with a button that cancels it."""
    loader = session.loader
    if loader.path is None or not loader.awaited:
        return
    with panel("reading", (size[0] / 2, size[1] / 2), (0.5, 0.5)):
        elapsed = time.monotonic() - loader.started
        imgui.text_unformatted(loader.stage or f"{os.path.basename(loader.path)}: reading")
        imgui.progress_bar(-elapsed, BAR, f"{elapsed:.1f} s")  # negative: how much is left is not known
        if imgui.button("Cancel"):
            session.cancel_reading()


def show_notice(session: Session, size: tuple[float, float]) -> None:
    """The session's notice, at the bottom; without any file, what to do."""
    notice = session.notice
    if notice is None:
        if session.path is None and session.model is None:
            _line("Drop a STEP or BREP file here", size, problem=False)
        return
    _line(notice.text, size, notice.is_problem)


def show_warnings(session: Session) -> None:
    """What is to be known of the model and its cuts, in the side panel; nothing where there is nothing to be said."""
    warnings = session.warnings
    if warnings and imgui.collapsing_header(f"Warnings ({len(warnings)})###warnings"):
        for warning in warnings[:MOST_WARNINGS]:
            imgui.text_wrapped(warning)
        if len(warnings) > MOST_WARNINGS:
            imgui.text_disabled(f"and {len(warnings) - MOST_WARNINGS} more: nofacet info")


def _line(text: str, size: tuple[float, float], problem: bool) -> None:
    with panel("notice", (size[0] / 2, size[1] - MARGIN), (0.5, 1.0), LABEL):
        imgui.push_text_wrap_pos(size[0] - 8 * MARGIN)
        if problem:
            imgui.text_colored(PROBLEM_COLOR, text)
        else:
            imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
