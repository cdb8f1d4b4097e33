"""The points that are measured, over the picture: a line between them, with its length."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

import nofacet

from ..panes import Pane, panes
from ..session import Session
from ..state import View

RADIUS, WIDTH = 4.0, 2.0  # of points and line, pixels
PADDING = 3.0
INK = (0.75, 0.1, 0.45, 1.0)
PAPER = (1.0, 1.0, 1.0, 0.85)

Point = tuple[float, float]


def show_measurement(session: Session, ratio: float) -> None:
    """Behind all panels, in every pane. ratio: framebuffer pixels per unit of imgui's coordinates."""
    points, exact = session.inspection.points, session.shown_exact
    camera = exact.request.camera if exact else session.camera
    if not points or camera is None:
        return
    measurement = session.inspection.measurement
    text = f"{measurement.distance:.6g} mm" if measurement else ""
    view = session.state.view
    shown = panes(view, session.size)
    for pane in shown if view is View.SIDE_BY_SIDE else shown[:1]:
        places = [place for pick in points if (place := _place(pick, camera, pane, ratio))]
        _draw(places, text if len(places) == 2 else "", pane, ratio)


def _place(pick: nofacet.Pick, camera: nofacet.Camera, pane: Pane, ratio: float) -> Point | None:
    """Where a point is in imgui's coordinates; None behind the eye."""
    x, y, _, w = camera.pixel_from_world(pane.size) @ np.array([*pick.position, 1.0])
    return ((pane.x + float(x / w)) / ratio, float(y / w) / ratio) if w > 0 else None


def _draw(places: list[Point], text: str, pane: Pane, ratio: float) -> None:
    canvas = imgui.get_background_draw_list()
    ink, paper = imgui.get_color_u32(INK), imgui.get_color_u32(PAPER)
    canvas.push_clip_rect((pane.x / ratio, 0.0), ((pane.x + pane.width) / ratio, pane.height / ratio))
    if len(places) == 2:
        first, second = places
        canvas.add_line(first, second, paper, WIDTH + 2)
        canvas.add_line(first, second, ink, WIDTH)
    for place in places:
        canvas.add_circle_filled(place, RADIUS + 1, paper)
        canvas.add_circle_filled(place, RADIUS, ink)
    if text:
        (x0, y0), (x1, y1) = places
        size = imgui.calc_text_size(text)
        left, top = (x0 + x1 - size.x) / 2, (y0 + y1 - size.y) / 2
        corner = left + size.x + PADDING, top + size.y + PADDING
        canvas.add_rect_filled((left - PADDING, top - PADDING), corner, paper, PADDING)
        canvas.add_text((left, top), ink, text)
    canvas.pop_clip_rect()
