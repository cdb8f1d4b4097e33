"""All panels of the window."""

from __future__ import annotations

from imgui_bundle import imgui

from ..keymap import Keymap
from ..session import Session
from .assembly import AssemblyPanel
from .figures import show_figures
from .help import show_help
from .inspector import show_inspector
from .layout import MARGIN, SIDE_WIDTH
from .measuring import show_measurement
from .messages import show_notice, show_progress, show_warnings
from .sections import show_sections
from .settings import show_meshing, show_overlays, show_views

OPEN = imgui.TreeNodeFlags_.default_open.value


class Panels:
    """Draws what lies before the picture. shown: the side panel and the figures. help: the list of keys."""

    def __init__(self, session: Session, keymap: Keymap) -> None:
        self.shown = True
        self.help = False
        self._session = session
        self._keymap = keymap
        self._assembly = AssemblyPanel()

    def draw(self) -> None:
        """Between imgui's new_frame() and render()."""
        width, height = imgui.get_io().display_size
        show_measurement(self._session, self._session.size[0] / max(width, 1.0))
        if self.shown and (self._session.path or self._session.model):
            show_figures(self._session, self._session.size[0] / max(width, 1.0))
            self._draw_side(width, height)
        show_progress(self._session, (width, height))
        show_notice(self._session, (width, height))
        if self.help:
            show_help(self._keymap, (width, height))

    def _draw_side(self, width: float, height: float) -> None:
        imgui.set_next_window_pos((width - MARGIN, MARGIN), imgui.Cond_.always.value, (1.0, 0.0))
        imgui.set_next_window_size_constraints((SIDE_WIDTH, 0.0), (SIDE_WIDTH, height - 2 * MARGIN))
        flags = imgui.WindowFlags_.always_auto_resize.value | imgui.WindowFlags_.no_move.value
        keys = self._keymap.chords["help"]
        title = f"{keys[0]} shows all keys" if keys else "nofacet"
        if imgui.begin(f"{title}###side", None, flags)[0]:
            if imgui.collapsing_header("View"):
                show_views(self._session, self._keymap)
            if imgui.collapsing_header("Overlays"):
                show_overlays(self._session, self._keymap)
            if imgui.collapsing_header("Tessellation", OPEN):
                show_meshing(self._session)
            if imgui.collapsing_header("Sections"):
                show_sections(self._session, self._keymap)
            if imgui.collapsing_header("Assembly"):
                self._assembly.show(self._session)
            if imgui.collapsing_header("Inspect", OPEN):
                show_inspector(self._session, self._keymap)
            show_warnings(self._session)
        imgui.end()
