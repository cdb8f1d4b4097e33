"""Pictures of the window's content without a window."""

from __future__ import annotations

from pathlib import Path

import cadquery as cq
import numpy as np
import pytest

import nofacet
from egl import offscreen_context
from nofacet import cli

pytest.importorskip("moderngl")

from nofacet_viewer import offscreen
from nofacet_viewer.caption import SEPARATOR, caption_height, last_that_fit, text_width
from nofacet_viewer.offscreen import write_view
from nofacet_viewer.state import View

SIZE = (480, 300)


@pytest.fixture(autouse=True)
def egl() -> None:
    offscreen_context().release()


def pixels_of(path: Path) -> np.ndarray:
    pixels, channels, _ = nofacet.image.read(path)
    assert channels == ["R", "G", "B"]
    return pixels


@pytest.mark.parametrize("view", list(View))
def test_every_view_is_written(tmp_path: Path, view: View) -> None:
    path = tmp_path / "view.png"
    write_view(cq.Workplane().sphere(3), path, view, SIZE, setting=nofacet.MeshSetting("coarse", 0.3))
    pixels = pixels_of(path)
    assert pixels.shape == (SIZE[1], SIZE[0], 3)
    caption = pixels[-caption_height(SIZE[1]) :]
    assert (caption < 0.5).any() and caption[0, 0] == pytest.approx(245 / 255)
    shown = pixels[: -caption_height(SIZE[1])]
    assert (shown.min(axis=2) < 0.9).mean() > 0.02 and shown[0, 0] == pytest.approx(1.0)


def test_camera_is_in_the_picture(tmp_path: Path) -> None:
    camera = nofacet.Camera("perspective", (9, 8, 7), (0, 0, 0), view_angle=40.0)
    write_view(cq.Workplane().box(1, 2, 3), tmp_path / "view.png", "wipe", SIZE, camera)
    assert nofacet.Camera.load(tmp_path / "view.png") == camera


def test_all_overlays_together(tmp_path: Path) -> None:
    write_view(cq.Workplane().cylinder(2, 1), tmp_path / "all.png", "side-by-side", SIZE, overlays=offscreen.OVERLAYS)
    assert np.ptp(pixels_of(tmp_path / "all.png"), axis=2).max() > 0.3  # legend and lines are coloured


@pytest.mark.parametrize("view", [View.EXACT, View.TESSELLATED, View.SIDE_BY_SIDE, View.DIFFERENCE])
def test_section_planes_cut_every_view(tmp_path: Path, view: View) -> None:
    ball, camera = cq.Workplane().sphere(3), nofacet.Camera("orthographic", (0, -9, 0), (0, 0, 0), view_height=8)
    pictures = []
    for sections in ([], [nofacet.Section((0, 0, 0), (0.01, 0, 1))]):
        write_view(ball, tmp_path / "view.png", view, SIZE, camera, sections=sections)
        pictures.append(pixels_of(tmp_path / "view.png")[: -caption_height(SIZE[1])].min(axis=2) < 0.9)
    middle = len(pictures[0]) // 2
    whole, cut = (picture[: middle - 4].sum() for picture in pictures)
    divider = 2 * (middle - 4) if view is View.SIDE_BY_SIDE else 0
    assert whole > 500 and cut == divider
    assert pictures[1][middle + 4 :].sum() > 0.8 * pictures[0][middle + 4 :].sum()


def test_the_command_line_cuts(tmp_path: Path) -> None:
    cq.Workplane().sphere(3).export(str(tmp_path / "ball.step"))
    arguments = ["view", str(tmp_path / "ball.step"), f"--output={tmp_path / 'view.png'}", "--view=exact"]
    arguments += ["--resolution=300,300", "--section=0,0,0/0,0,1", "--section=0,0,0/1,0,0"]
    assert cli.main(arguments) == 0
    shown = pixels_of(tmp_path / "view.png")[: -caption_height(300)].min(axis=2) < 0.9
    assert 0.2 < shown.mean() < 0.35  # a quarter of the ball


def test_wrong_requests_are_one_line(tmp_path: Path) -> None:
    ball = cq.Workplane().sphere(1)
    with pytest.raises(ValueError, match=r"written as \.png"):
        write_view(ball, tmp_path / "view.exr")
    with pytest.raises(ValueError, match="unknown view 'sideways'; choose one of exact"):
        write_view(ball, tmp_path / "view.png", "sideways")
    with pytest.raises(ValueError, match="unknown overlay 'stripes'"):
        write_view(ball, tmp_path / "view.png", overlays=["stripes"])
    with pytest.raises(ValueError, match="too small"):
        write_view(ball, tmp_path / "view.png", resolution=(10, 10))


def test_meshing_that_takes_too_long_is_stopped(tmp_path: Path) -> None:
    ball = cq.Workplane().sphere(1)
    with pytest.raises(nofacet.InputError, match="Workplane: stopped after 0.001 s while meshing"):
        write_view(ball, tmp_path / "view.png", "wipe", SIZE, model=nofacet.load(ball), timeout=0.001)


def test_without_egl_it_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**wanted: object) -> None:
        raise Exception("libEGL.so.1 not\nloaded")

    monkeypatch.setattr("moderngl.create_standalone_context", refuse)
    with pytest.raises(nofacet.InputError, match=r"no OpenGL 3.3 through EGL here \(libEGL.so.1 not loaded\)"):
        write_view(cq.Workplane().sphere(1), tmp_path / "view.png", "exact", SIZE)


def test_the_last_figures_find_room() -> None:
    figures = ["one", "two", "three"]
    width = text_width(f"two{SEPARATOR}three", 12)
    assert last_that_fit(figures, 12, width) == ["two", "three"]
    assert last_that_fit(figures, 12, width - 1) == ["three"]
    assert last_that_fit(figures, 12, 1000) == figures and last_that_fit(figures, 12, 0) == []


def test_a_line_of_text_has_a_width() -> None:
    assert 60 < text_width("12,345 triangles", 14) < 200
