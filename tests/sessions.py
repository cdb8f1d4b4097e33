"""Sessions of the viewer without a window, for tests of what keys and mouse do."""

from __future__ import annotations

import time
from collections.abc import Callable

import nofacet
from nofacet.model import Model
from nofacet_viewer.appearance import Appearance
from nofacet_viewer.exact import Exact, Request
from nofacet_viewer.section_planes import Bounds
from nofacet_viewer.session import Session
from nofacet_viewer.state import View


def wait_until(session: Session, condition: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"nothing happened; notice: {session.notice}"
        session.update(time.monotonic())
        time.sleep(0.01)


def with_frame(session: Session, model: Model) -> Session:
    session.size = (120, 120)
    session.state.view = View.EXACT
    session.appearance = Appearance(model)
    session.appearance_changed()
    session.inspection.begin(model.face_count)
    session.bounds = Bounds.of(model)
    session.camera = nofacet.Camera("orthographic", (0, -10, 0), (0, 0, 0), view_height=4.0)
    frame = nofacet.render(model, session.camera, (120, 120), samples=1, buffers=("color", "depth", "face"))
    assert session.drawn
    session.exact = Exact(frame, Request(session.drawn, session.camera, (120, 120)), 1.0, 1, 0.01)
    return session
