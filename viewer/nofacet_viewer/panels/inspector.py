"""What is under the cursor."""

from __future__ import annotations

from imgui_bundle import imgui

from ..session import Session


def show_inspector(session: Session) -> None:
    """Face, surface type and point under the cursor, from the buffers of the frame that is shown."""
    hover, model = session.hover, session.described
    if hover is None or model is None:
        imgui.text_disabled("nothing under the cursor")
        return
    definition = model.face_definition[hover.face]
    imgui.text_unformatted(f"face {hover.face} {model.face_name[hover.face]}".rstrip())
    imgui.text_unformatted(model.surface_type[definition])
    imgui.text_unformatted("({:.6g}, {:.6g}, {:.6g})".format(*hover.point))
    error = float(model.conversion_error[definition])
    if error == error:  # not NaN: measured
        imgui.text_unformatted(f"conversion error {error:.1e}")
