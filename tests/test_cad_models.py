"""The models in cad_models/: each STEP file holds what its script promises, and the scripts still make those files."""

from __future__ import annotations

import importlib
import re
import sys
from collections import Counter
from functools import cache
from pathlib import Path
from types import ModuleType

import cadquery as cq
import numpy as np
import pytest

FOLDER = Path(__file__).parents[1] / "cad_models"
MEGABYTE = 1_000_000

# Faces drawn by type, and the box (x, y, z from, to) in mm.
EXPECTED = {
    "teapot": ({"BSPLINE": 32}, (-3.0, 3.434, -2.0, 2.0, 0.0, 3.15)),
    "teapots": ({"BSPLINE": 288}, (-25.272, 25.622, -11.846, 11.852, 8.044, 25.791)),
    "chain": ({"BSPLINE": 252}, (-14.508, 14.698, -14.077, 14.852, -0.983, 9.702)),
    "vacuum_cleaner": (
        {"PLANE": 14, "CYLINDER": 12, "BSPLINE": 3, "EXTRUSION": 3},
        (-118.0, 139.052, -46.748, 46.748, -28.984, 77.636),
    ),
    "balloon": ({"PLANE": 19, "BSPLINE": 14, "CYLINDER": 12}, (-12.391, 12.391, -12.391, 12.391, -8.1, 28.5)),
    "car": (
        {"CYLINDER": 62, "PLANE": 52, "TORUS": 20, "BSPLINE": 13},
        (-208.0, 208.0, -90.365, 90.365, 0.0, 133.923),
    ),
    "flange": (
        {"CYLINDER": 19, "TORUS": 13, "PLANE": 12, "BSPLINE": 5, "CONE": 1},
        (-60.0, 125.004, -60.0, 60.0, 0.0, 60.95),
    ),
    "bottle": ({"BSPLINE": 3, "PLANE": 3, "TORUS": 2}, (-32.277, 32.277, -32.277, 32.277, 0.0, 172.0)),
    "crossing": ({"BSPLINE": 2}, (-19.781, 53.895, -22.562, 22.321, -31.468, 31.745)),
    "perforated_plate": ({"CYLINDER": 1004, "PLANE": 6}, (-123.0, 123.0, -78.0, 78.0, 0.0, 4.0)),
}
# Made in a few seconds and without Boolean operations or fillets, whose results may differ between processors.
REPEATABLE = ["teapot", "teapots", "chain", "crossing"]


def script(name: str) -> ModuleType:
    """The model's script, or the helpers beside it, as a module."""
    if str(FOLDER) not in sys.path:
        sys.path.insert(0, str(FOLDER))
    return importlib.import_module(name)


@cache
def stored(name: str) -> cq.Compound:
    """What the stored STEP file holds."""
    return cq.Compound.makeCompound(cq.importers.importStep(str(FOLDER / f"{name}.step")).vals())


def numbers_and_rest(text: str) -> tuple[list[float], str]:
    """The real numbers of a STEP file, and everything between them."""
    real = re.compile(r"-?\d+\.\d*(?:E[+-]?\d+)?")
    return [float(number) for number in real.findall(text)], real.sub("?", text)


def test_every_script_has_its_step_file_and_both_are_expected() -> None:
    scripts = {path.stem for path in FOLDER.glob("*.py") if not path.stem.startswith("_")}
    assert scripts == {path.stem for path in FOLDER.glob("*.step")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_stored_step(name: str) -> None:
    types, box = EXPECTED[name]
    shape = stored(name)
    assert (FOLDER / f"{name}.step").stat().st_size < 3 * MEGABYTE
    assert dict(Counter(face.geomType() for face in shape.Faces())) == types
    # OpenCascade's check compares every two of the plate's 1,001 loops: half a minute.
    assert name == "perforated_plate" or shape.isValid()
    found = shape.BoundingBox()
    spans = (found.xmin, found.xmax, found.ymin, found.ymax, found.zmin, found.zmax)
    np.testing.assert_allclose(spans, box, atol=2e-3)


@pytest.mark.parametrize("name", REPEATABLE)
def test_script_makes_the_stored_file(name: str, tmp_path: Path) -> None:
    made = script("_shapes").write_step(script(name).build(), tmp_path / f"{name}.step")
    numbers, rest = numbers_and_rest(made.read_text())
    stored_numbers, stored_rest = numbers_and_rest((FOLDER / f"{name}.step").read_text())
    assert rest == stored_rest
    np.testing.assert_allclose(numbers, stored_numbers, atol=2e-3)


@pytest.mark.parametrize(("name", "patches"), [("teapot", 32), ("teapots", 2304), ("chain", 4032)])
def test_patch_count(name: str, patches: int) -> None:
    assert script("_shapes").spans(stored(name).Faces()) == patches


def test_plate_has_a_thousand_holes() -> None:
    loops = sorted(len(face.Wires()) for face in stored("perforated_plate").Faces())
    assert loops[-2:] == [1001, 1001]
    assert max(loops[:-2]) == 1


def test_balloon_fields_lie_on_one_surface() -> None:
    fields = [face for face in stored("balloon").Faces() if face.geomType() == "BSPLINE"]
    for field in fields[1:]:
        np.testing.assert_array_equal(poles(field), poles(fields[0]))


def test_crossing_bodies_overlap() -> None:
    pebble, ring = stored("crossing").Solids()
    assert 0 < pebble.intersect(ring).Volume() < ring.Volume()


def poles(face: cq.Face) -> np.ndarray:
    """Control points (m, n, 3) of a B-spline face."""
    surface = face._geomAdaptor()
    points = [[surface.Pole(i, j) for j in range(1, surface.NbVPoles() + 1)] for i in range(1, surface.NbUPoles() + 1)]
    return np.array([[(p.X(), p.Y(), p.Z()) for p in row] for row in points])


def teapot_nets() -> np.ndarray:
    """(32, 4, 4, 3) control points."""
    return np.array([net for nets in script("teapot").patches().values() for net in nets])


def test_teapot_faces_carry_the_control_points_exactly() -> None:
    found = np.array([poles(face) for face in stored("teapot").Faces()])
    np.testing.assert_array_equal(found, teapot_nets())


def test_teapot_has_the_published_points() -> None:
    # 306 are published; four are never used and twelve repeat the body's lowest ring for the bottom.
    points = {tuple(point) for point in teapot_nets().round(9).reshape(-1, 3) + 0.0}
    assert len(points) == 306 - 4 - 12
    for known in [
        (0.784, -1.4, 2.4),
        (1.12, 2.0, 0.45),
        (-2.65, 0.3, 0.9375),
        (3.525, -0.25, 2.49375),
        (0.45, 0.8, 3.15),
    ]:
        assert known in points


def test_teapot_is_its_own_mirror_image() -> None:
    nets = teapot_nets()
    assert sorted(map(point_key, nets)) == sorted(map(point_key, nets * (1, -1, 1)))


def point_key(net: np.ndarray) -> list[tuple[float, ...]]:
    """The points of a net in an order that does not depend on its parametrisation."""
    return sorted(tuple(point) for point in net.round(9).reshape(-1, 3) + 0.0)


def test_teapot_patches_share_their_borders() -> None:
    borders: Counter[tuple[tuple[float, ...], ...]] = Counter()
    for net in teapot_nets().round(9) + 0.0:
        for border in (net[0], net[-1], net[:, 0], net[:, -1]):
            curve = tuple(map(tuple, border))
            borders[min(curve, curve[::-1])] += 1
    points = [curve for curve in borders if len(set(curve)) == 1]
    assert len(points) == 2  # the poles of knob and bottom, four patches each
    open_borders = [curve for curve, count in borders.items() if count == 1]
    assert len(open_borders) == 16  # the rim's inside, the lid's edge, both ends of handle and spout
    assert all(count == 2 for curve, count in borders.items() if curve not in open_borders + points)


def test_teapot_looks_outward() -> None:
    """The volume under body and lid by the divergence theorem, with 6 x 6 Gauss points a patch (exact)."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    t, weights = (nodes + 1) / 2, weights / 2
    basis = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    slope = np.stack([-3 * (1 - t) ** 2, 3 * (1 - t) * (1 - 3 * t), 3 * t * (2 - 3 * t), 3 * t**2])
    volume = 0.0
    for part in ("body", "lid"):
        nets = np.array(script("teapot").patches()[part])
        point, along_u, along_v = (
            np.einsum("pijc,ia,jb->pabc", nets, *pair) for pair in ((basis, basis), (slope, basis), (basis, slope))
        )
        # The faces are reversed patches, so the outward normal is -(du x dv).
        flux = -np.einsum("pabc,pabc->pab", point, np.cross(along_u, along_v)) / 3
        volume += np.einsum("pab,a,b->", flux, weights, weights)
    assert volume == pytest.approx(24.57, abs=0.01)
    assert all(
        face.wrapped.Orientation().name == "TopAbs_REVERSED" for face in script("teapot").build().toCompound().Faces()
    )
