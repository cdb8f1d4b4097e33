"""Draws the pictures of the viewer in docs/images again, with no display: python docs/view_images.py"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import nofacet
from nofacet_viewer.caption import caption_height
from nofacet_viewer.offscreen import write_view
from nofacet_viewer.panes import pane_resolution
from nofacet_viewer.state import View

ROOT = Path(__file__).resolve().parents[1]
SIZE = (1100, 550)
OWN = ROOT / "cad_models"
CTC_02 = ROOT.parent / "shared" / "models" / "nist" / "nist_ctc_02_asme1_rc.stp"  # third-party, beside the repository


@dataclass(frozen=True)
class Picture:
    """direction: from the eye into the scene. setting: of nofacet.MESH_SETTINGS."""

    source: Path
    view: View
    direction: tuple[float, float, float]
    setting: str = "Mayo"
    overlays: tuple[str, ...] = ()


FLANGE, TEAPOT, BOTTLE = (OWN / f"{name}.step" for name in ("flange", "teapot", "bottle"))
FROM_FLANGE, FROM_TEAPOT, FROM_BOTTLE, FROM_CTC = (-1, 1, -0.8), (0.6, 1, -0.4), (-1, 1, -0.4), (-1, 1, -0.9)

PICTURES = {
    "view_side_by_side": Picture(FLANGE, View.SIDE_BY_SIDE, FROM_FLANGE),
    "view_wipe": Picture(TEAPOT, View.WIPE, FROM_TEAPOT, overlays=("mesh-edges",)),
    "view_difference": Picture(FLANGE, View.DIFFERENCE, FROM_FLANGE),
    "view_difference_ctc_02": Picture(CTC_02, View.DIFFERENCE, FROM_CTC),
    "view_edges_ctc_02": Picture(CTC_02, View.SIDE_BY_SIDE, FROM_CTC, overlays=("edges",)),
    "view_zebra": Picture(BOTTLE, View.SIDE_BY_SIDE, FROM_BOTTLE, overlays=("zebra",)),
    "view_curvature": Picture(FLANGE, View.WIPE, FROM_FLANGE, overlays=("curvature",)),
    "view_control_nets": Picture(TEAPOT, View.EXACT, FROM_TEAPOT, overlays=("control-nets", "patch-borders")),
    "view_patch_borders": Picture(FLANGE, View.SIDE_BY_SIDE, FROM_FLANGE, overlays=("patch-borders",)),
    "view_conversion_error": Picture(FLANGE, View.EXACT, FROM_FLANGE, overlays=("conversion-error",)),
}


def main() -> None:
    for name, picture in PICTURES.items():
        if not picture.source.exists():
            print(f"{name}: {picture.source} is not there, so its picture stays as it is")
            continue
        pane = pane_resolution(picture.view, (SIZE[0], SIZE[1] - caption_height(SIZE[1])))
        camera = nofacet.Camera.fit(nofacet.load(picture.source, measure=True), picture.direction, resolution=pane)
        setting = nofacet.MESH_SETTINGS[picture.setting]
        output = ROOT / "docs" / "images" / f"{name}.png"
        write_view(picture.source, output, picture.view, SIZE, camera, picture.overlays, setting)


if __name__ == "__main__":
    main()
