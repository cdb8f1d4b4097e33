"""What can be drawn over, or instead of, the models' own colours; and what each needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import nofacet

from .color_scale import ColorScale, conversion_scale, curvature_scale
from .line_layer import LineStyle

OVERLAYS = ("mesh-edges", "edges", "patch-borders", "control-nets", "conversion-error", "zebra", "curvature")

# Overlays of lines. The exact side's edges are drawn by nofacet.render(edges=True), and look like these.
LINE_STYLES = {
    "mesh-edges": LineStyle((0.02, 0.02, 0.02), width=0.7, opacity=0.6),
    "edges": LineStyle((0.01, 0.01, 0.01), width=1.2),
    "patch-borders": LineStyle((0.85, 0.17, 0.0), width=1.4, opacity=0.95),
    "control-nets": LineStyle((0.0, 0.12, 0.55), width=1.0, rule="faint behind"),
}
EXACT_LINES = ("patch-borders", "control-nets")
# Overlays that replace the faces' colours, and the buffers of a frame that they are made of; the last one named wins.
_VALUES = ("face", "normal", "coverage")
ANALYSES = {"conversion-error": _VALUES, "zebra": _VALUES, "curvature": (*_VALUES, "uv")}


def analysis_of(overlays: frozenset[str]) -> str | None:
    """The overlay that replaces the faces' colours."""
    return next((name for name in reversed(ANALYSES) if name in overlays), None)


def shading_of(overlays: frozenset[str]) -> str:
    """What MeshLayer.draw() calls it; faces in the colours of their conversion error are lit as any."""
    analysis = analysis_of(overlays)
    return "lit" if analysis in (None, "conversion-error") else str(analysis)


def scale_of(overlays: frozenset[str], model: nofacet.Model, size: float) -> ColorScale | None:
    """What the colours of the overlay that replaces the faces' mean. size: the model's diagonal, model units."""
    analysis = analysis_of(overlays)
    if analysis == "curvature":
        return curvature_scale(size)
    return conversion_scale(model.conversion_error) if analysis == "conversion-error" else None


def face_colors(overlays: frozenset[str], model: nofacet.Model) -> NDArray[np.float32]:
    """Linear RGBA (F, 4) of the model's faces: its own, or of their conversion error. Alpha 0 stays: hidden."""
    own = model.face_color
    if analysis_of(overlays) != "conversion-error":
        return own
    rgb = conversion_scale(model.conversion_error).color(model.conversion_error[model.face_definition])
    return np.column_stack([rgb, own[:, 3] > 0]).astype(np.float32)


def frame_curvature(model: nofacet.Model, frame: nofacet.Frame) -> NDArray[np.float32] | None:
    """Mean curvature (height, width) at the frame's pixel centres, 1 / model units, positive where the surface bends
    towards its normal; NaN on background. None where this nofacet cannot evaluate surfaces. Needs face and uv."""
    evaluate = getattr(nofacet, "evaluate", None)
    if evaluate is None:
        return None
    return np.asarray(evaluate(model, frame.face, frame.uv).mean_curvature, np.float32)
