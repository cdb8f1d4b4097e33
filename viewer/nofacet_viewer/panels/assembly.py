"""The assembly tree: what is shown, in which colour, how transparent."""

from __future__ import annotations

from imgui_bundle import imgui

import nofacet

from ..appearance import Appearance, Faces
from ..assembly_rows import AssemblyRows, Row
from ..session import Session

INDENT = 14.0
HEIGHT = 220.0


class AssemblyPanel:
    """Remembers which nodes are open."""

    def __init__(self) -> None:
        self._rows: AssemblyRows | None = None
        self._revealed: nofacet.Pick | None = None  # whose row has been scrolled to

    def show(self, session: Session) -> None:
        """The rows that are in sight; a click with the right button opens a row's menu."""
        appearance = session.appearance
        if appearance is None:
            imgui.text_disabled("no model")
            return
        if self._rows is None or self._rows.appearance is not appearance:
            self._rows = AssemblyRows(appearance)
        picked = session.inspection.picked
        shows_picked = picked is not None and picked is not self._revealed
        self._revealed = picked
        if imgui.small_button("show all"):
            appearance.show_all()
            session.appearance_changed()
        imgui.begin_child("rows", (0.0, HEIGHT), imgui.ChildFlags_.borders.value)
        clipper = imgui.ListClipper()
        if picked and picked.section is None and shows_picked:
            index = self._rows.reveal(picked.face, picked.node)
            line = imgui.get_frame_height_with_spacing()
            imgui.set_scroll_y(max(index * line - HEIGHT / 2, 0.0))
        rows = self._rows.rows
        clipper.begin(len(rows))
        while clipper.step():
            for index in range(clipper.display_start, clipper.display_end):
                self._show_row(session, self._rows, rows[index])
        clipper.end()
        imgui.end_child()

    def _show_row(self, session: Session, rows: AssemblyRows, row: Row) -> None:
        appearance = rows.appearance
        imgui.push_id(f"{row.node}/{row.face}")
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + INDENT * row.depth)
        if row.node is not None:
            direction = imgui.Dir.down if rows.is_open(row) else imgui.Dir.right
            if imgui.arrow_button("open", direction):
                rows.toggle(row)
            imgui.same_line()
        faces = rows.faces_of(row)
        visible = bool(len(faces)) and bool(appearance.visible[faces].any())
        clicked, visible = imgui.checkbox("##visible", visible)
        if clicked:
            appearance.show(faces, visible)
            session.appearance_changed()
        imgui.same_line()
        if imgui.selectable(row.label, bool(len(faces)) and bool(session.inspection.selected[faces].all()))[0]:
            session.inspection.select(faces, add=imgui.get_io().key_ctrl)
        if imgui.begin_popup_context_item("menu"):
            _show_menu(session, appearance, faces)
            imgui.end_popup()
        imgui.pop_id()


def _show_menu(session: Session, appearance: Appearance, faces: Faces) -> None:
    if imgui.menu_item_simple("Isolate"):
        appearance.isolate(faces)
        session.appearance_changed()
    if imgui.menu_item_simple("As in the file"):
        appearance.restore(faces)
        session.appearance_changed()
    if not len(faces):
        return
    red, green, blue, opacity = (float(value) for value in appearance.color[faces[0]])
    srgb = [encoded(red), encoded(green), encoded(blue)]
    changed, srgb = imgui.color_edit3("colour", srgb)
    if changed:
        appearance.paint(faces, (decoded(srgb[0]), decoded(srgb[1]), decoded(srgb[2])))
        session.appearance_changed()
    changed, transparency = imgui.slider_float("transparency", 1.0 - opacity, 0.0, 0.95, "%.2f")
    if changed:
        appearance.set_opacity(faces, 1.0 - transparency)
        session.appearance_changed()


def encoded(linear: float) -> float:
    """sRGB from linear, both from 0 to 1."""
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def decoded(srgb: float) -> float:
    """Linear from sRGB, both from 0 to 1."""
    return srgb / 12.92 if srgb <= 0.04045 else ((srgb + 0.055) / 1.055) ** 2.4
