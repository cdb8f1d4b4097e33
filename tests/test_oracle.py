"""Small but hard third-party files against OpenCascade, ray by ray; `make oracle` does all files and more rays."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS
from nofacet.model import Model
from oracle_all import FAULTS, SHARED, judge
from scenes import GENERAL_DIRECTION, OTHER_DIRECTION

pytestmark = pytest.mark.skipif(
    not (SHARED / "oracle" / "check_frame.py").is_file(),
    reason="../shared with the models and their judge is not there",
)

RESOLUTION = (320, 240)
SAMPLES = 300
FILES = (
    "nist/nist_ftc_11_asme1_rb.stp",  # tori and cylinders with seams in both directions
    "nist/NIST_MBE_PMI_11.stp",  # the same part as C0 rational B-splines
    "occt/screw.step",  # degenerate tori
    "cax/HEAD_BACK.stp",  # sphere poles, wide tolerances
    "occt/Ball.brep",  # left-handed placements, degree 12
    "probe/ap214_negative_spindle_torus.stp",
    "probe/ap203_near_degenerate_nurbs_pole.stp",
    "probe/ap214_offset_extrusion.stp",
    "parts/test.brep",  # 3.6e-3 units across
    "parts/RJ24.stp",  # edges off their planes
    "cax/cube-in.step",
    "aero/F-16_OpenVSP3.5.0.stp",  # collapsed sides, not valid for OpenCascade
)


@pytest.mark.parametrize("name", FILES)
def test_opencascade_agrees(name: str) -> None:
    for record in judge(SHARED_MODELS / name, seed=20, samples=SAMPLES, resolution=RESOLUTION):
        faults = {key: record[key] for key in (*FAULTS, "unresolved") if record[key]}
        assert not faults, f"{record['faults'][:3]}, camera {record['camera']}"
        assert record["hits"] > 20


@cache
def model(name: str) -> Model:
    return nofacet.load(SHARED_MODELS / name)


@pytest.mark.parametrize("direction", [GENERAL_DIRECTION, OTHER_DIRECTION, (0.0, 1.0, 0.0)])
def test_one_part_in_two_representations_gives_one_picture(direction: tuple[float, float, float]) -> None:
    """nist_ftc_11 has analytic faces, NIST_MBE_PMI_11 rational B-splines; their faces are numbered differently."""
    analytic, bspline = model(FILES[0]), model(FILES[1])
    camera = nofacet.Camera.fit(analytic, direction, resolution=RESOLUTION)
    buffers = ("coverage", "depth", "normal")
    first, second = (
        nofacet.render(part, camera, RESOLUTION, samples=8, buffers=buffers) for part in (analytic, bspline)
    )
    assert camera.view_height
    np.testing.assert_allclose(second.depth, first.depth, rtol=0, atol=1e-11 * camera.view_height)
    np.testing.assert_allclose(second.coverage, first.coverage, atol=1e-6)
    np.testing.assert_allclose(second.normal, first.normal, atol=3e-7)


def test_units_of_length() -> None:
    """One cube, written in inches and in metres: the same camera fits, the same picture comes out."""
    inches, metres = model("cax/cube-in.step"), model("cax/cube-m.step")
    cameras = [nofacet.Camera.fit(cube, GENERAL_DIRECTION, resolution=RESOLUTION) for cube in (inches, metres)]
    assert cameras[0].view_height == pytest.approx(cameras[1].view_height, rel=1e-12)
    first, second = (nofacet.render(cube, cameras[0], RESOLUTION, buffers=("depth",)) for cube in (inches, metres))
    np.testing.assert_allclose(second.depth, first.depth, rtol=1e-11)
