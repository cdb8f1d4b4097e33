"""Section planes: added, dragged, tilted, flipped, switched off, removed."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui

from ..clipping import MOST_PLANES
from ..keymap import Keymap
from ..section_planes import AXES, MOST_TILT, Bounds, SectionPlane
from ..session import Session
from ..state import View
from .layout import FAINT_COLOR

NAMES = 56.0  # width left for a slider's name, at its right
STEP = 0.001  # of the model's reach that a slider for positions shows


def show_sections(session: Session, keymap: Keymap) -> None:
    """The planes, each with its sliders; the picture follows while they are dragged."""
    if session.bounds is None or session.camera is None:
        imgui.text_disabled("no model")
        return
    _show_adding(session, session.bounds, keymap)
    planes = session.planes.planes
    removed = None
    for index, plane in enumerate(planes):
        imgui.push_id(index)
        imgui.separator()
        planes[index], keeps = _show_plane(plane, session.bounds)
        imgui.pop_id()
        if not keeps:
            removed = index
    if removed is not None:
        del planes[removed]
    if planes and session.state.view.shows_mesh:
        _show_limits(session)


def _show_adding(session: Session, bounds: Bounds, keymap: Keymap) -> None:
    imgui.text_unformatted("add")
    for name, axis in AXES.items():
        imgui.same_line()
        if imgui.small_button(name):
            assert session.camera
            session.planes.add_through_middle(bounds, axis, session.camera.direction)
    picked, keys = session.inspection.picked, keymap.chords["section"]
    if picked:
        imgui.same_line()
        if imgui.small_button("along selected face"):
            session.planes.add(picked.position, picked.normal)
    if keys:
        imgui.text_colored(FAINT_COLOR, f"{keys[0]}: along the face under the cursor")


def _show_plane(plane: SectionPlane, bounds: Bounds) -> tuple[SectionPlane, bool]:
    """A plane's row; what the user has made of it, and whether it stays."""
    enabled = imgui.checkbox("cuts", plane.enabled)[1]
    imgui.same_line()
    flipped = plane.flipped ^ imgui.small_button("flip")
    imgui.same_line()
    keeps = not imgui.small_button("remove")
    plane = replace(plane, enabled=enabled, flipped=flipped)
    middle, reach = bounds.middle, bounds.reach(plane.normal)
    imgui.set_next_item_width(-NAMES)
    changed, distance = imgui.slider_float("along", plane.distance(middle), -reach, reach, _format(reach))
    if changed:
        plane = plane.at_distance(distance, middle)
    imgui.set_next_item_width(-NAMES)
    changed, tilts = imgui.slider_float2("tilt", list(plane.tilts), -MOST_TILT, MOST_TILT, "%.1f deg")
    if changed:
        plane = replace(plane, tilts=(tilts[0], tilts[1]))
    return plane, keeps


def _show_limits(session: Session) -> None:
    """What triangles cannot do."""
    lines = ["Triangles are hollow: cut open, without caps."]
    if len(session.state.sections) > MOST_PLANES:
        lines.append(f"They are cut by the first {MOST_PLANES} planes.")
    if session.state.view is View.DIFFERENCE:
        lines.append("Outlines are not compared while planes cut.")
    imgui.push_text_wrap_pos(0.0)
    for line in lines:
        imgui.text_colored(FAINT_COLOR, line)
    imgui.pop_text_wrap_pos()


def _format(reach: float) -> str:
    """With as many decimals as tell a STEP of the slider's range."""
    decimals = next((count for count in range(9) if 10.0**-count <= STEP * reach), 9)
    return f"%.{decimals}f mm"
