"""Hard cases as data: patches whose exact area mathematics gives, and cameras that once went wrong on real files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS, model_of
from nofacet.model import PatchGroup
from scenes import compare_methods

CASES = Path(__file__).parent / "cases"


def cases(name: str) -> list[Any]:
    content: list[Any] = json.loads((CASES / f"{name}.json").read_text())
    return content


def patch(control_points: list[list[list[float]]]) -> nofacet.Model:
    group = PatchGroup(
        np.array([control_points], np.float64),
        np.zeros(1, np.int32),
        np.array([[0.0, 1.0, 0.0, 1.0]]),
        np.zeros((1, 2), np.uint8),
    )
    return model_of([group])


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.5707963267948966])
@pytest.mark.parametrize("case", cases("patches"), ids=lambda case: case["name"])
def test_patch_has_its_exact_area(case: dict[str, Any], angle: float) -> None:
    resolution, view_height = (160, 120), 4.1
    up = (np.sin(angle), np.cos(angle), 0.0)
    camera = nofacet.Camera("orthographic", (0.4, 0.3, 9.0), (0.4, 0.3, 0.0), up, view_height=view_height)
    frame = nofacet.render(patch(case["control_points"]), camera, resolution, samples=16, buffers=("coverage",))
    pixel = view_height / resolution[1]
    outline_pixels = 8 / pixel  # longer than any of these outlines
    assert frame.stats["unresolved"] == 0
    assert frame.stats["pieces"] < 5000
    area = frame.coverage.sum(dtype=np.float64) * pixel**2
    assert abs(area - case["area"]) < 1e-3 * outline_pixels * pixel**2


@pytest.mark.skipif(not SHARED_MODELS.is_dir(), reason="the shared test models are not beside the repository")
@pytest.mark.parametrize("case", cases("cameras"), ids=lambda case: f"{Path(case['model']).stem}: {case['why']}")
def test_camera_that_once_went_wrong(case: dict[str, Any]) -> None:
    model = nofacet.load(SHARED_MODELS / case["model"])
    frame = nofacet.render(model, nofacet.Camera.from_dict(case["camera"]), (320, 240))
    assert frame.stats["unresolved"] == 0
    assert frame.stats["pieces"] < case["max_pieces"]
    assert (frame.face >= 0).any()
    compare_methods(model, nofacet.Camera.from_dict(case["camera"]), (320, 240))
