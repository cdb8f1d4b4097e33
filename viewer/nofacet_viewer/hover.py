"""What a finished frame has under the cursor: at once, but only as exact as its pixels."""

from __future__ import annotations

from dataclasses import dataclass

import nofacet
from nofacet.camera import Vector, as_vector

from .controls import Point
from .panes import Pane


@dataclass(frozen=True)
class Hover:
    """The face's index, as in Frame (below -1 on a cap), and the world point."""

    face: int
    point: Vector


def hover_in(frame: nofacet.Frame, pane: Pane, cursor: Point) -> Hover | None:
    """The nearest pixel's face and the point at its centre; None on background. cursor: in the window."""
    x, y = cursor[0] - pane.x, cursor[1]
    column, row = int(x * frame.width / pane.width), int(y * frame.height / pane.height)
    if not (0 <= column < frame.width and 0 <= row < frame.height) or frame.face[row, column] == -1:
        return None
    centre = (column + 0.5) * pane.width / frame.width, (row + 0.5) * pane.height / frame.height
    point = frame.camera.point_at(centre, pane.size, float(frame.depth[row, column]))
    return Hover(int(frame.face[row, column]), as_vector(point))
