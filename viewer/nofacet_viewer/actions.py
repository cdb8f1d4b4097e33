"""What the keymap's actions do to a session."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import nofacet
from nofacet.camera import VIEWS

from .loading import one_line
from .painter import OVERLAYS
from .session import Session
from .state import View


def perform(session: Session, action: str) -> bool:
    """Do what a key is for; False for what is not the session's: pictures, help, panels, quitting."""
    if action in VIEWS:
        look_along(session, *VIEWS[action])
    elif action == "fit" and session.camera:
        look_along(session, tuple(session.camera.direction), session.camera.view_up)
    elif action == "projection":
        session.toggle_projection()
    elif action in {view.value for view in View}:
        session.show_view(View(action))
    elif action in OVERLAYS:
        session.state.toggle_overlay(action)
    elif action in ("next-file", "previous-file"):
        session.step_file(1 if action == "next-file" else -1)
    elif action == "reload":
        session.reload()
    elif action == "measure":
        session.inspection.toggle_measuring()
    elif action == "deselect":
        session.inspection.clear()
    elif action == "section":
        session.cut_along_face()
    elif action == "show-all" and session.appearance:
        session.appearance.show_all()
        session.appearance_changed()
    elif action == "isolate" and session.appearance and session.inspection.selected.any():
        session.appearance.isolate(np.flatnonzero(session.inspection.selected).astype(np.int32))
        session.appearance_changed()
    else:
        return action in ("fit", "show-all", "isolate")
    return True


def look_along(session: Session, direction: Sequence[float], view_up: Sequence[float]) -> None:
    """Look at all that is visible along a direction (from the eye into the scene), in the present projection."""
    model, camera, resolution = session.drawn, session.camera, session.pane_size
    if model is None or camera is None:
        return
    options = {"view_angle": camera.view_angle} if camera.view_angle else {}

    def fit() -> nofacet.Camera:
        return nofacet.Camera.fit(model, direction, camera.projection, resolution, view_up, **options)

    def take(fitted: nofacet.Camera | Exception) -> None:
        if isinstance(fitted, nofacet.Camera):
            session.camera = fitted
        else:
            session.say(one_line(fitted))

    session.tasks.run(fit, take)
