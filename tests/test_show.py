"""show(): what it takes, how it paints and names, pictures, notebooks, the window's absence."""

from __future__ import annotations

import sys
import warnings
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import nofacet
from nofacet import image
from nofacet.camera import METADATA_KEY
from nofacet.extent import bounding_box
from nofacet.model import Model
from scenes import look_down, rectangle

OWN = Path(__file__).resolve().parents[1] / "cad_models"
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def window(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Model, dict[str, Any]]]:
    """A viewer that only notes what it is asked to open."""
    opened: list[tuple[Model, dict[str, Any]]] = []
    app = ModuleType("nofacet_viewer.app")
    app.open_window = lambda model, **options: opened.append((model, options))  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "nofacet_viewer", ModuleType("nofacet_viewer"))
    monkeypatch.setitem(sys.modules, "nofacet_viewer.app", app)
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    return opened


def shown(window: list[tuple[Model, dict[str, Any]]], *objects: Any, **options: Any) -> Model:
    assert nofacet.show(*objects, **options) is None
    return window[-1][0]


def test_opens_a_window_with_a_fitted_camera(window: list[Any], sphere: Model) -> None:
    assert shown(window, sphere, title="a ball", direction="top", zoom=0.5) is sphere
    options = window[0][1]
    assert options["title"] == "a ball"
    assert options["camera"] == nofacet.Camera.fit(sphere, (0, 0, -1), "orthographic", (1280, 720), (0, 1, 0), zoom=0.5)
    camera = look_down(3.0)
    shown(window, sphere, camera=camera)
    assert window[1][1]["camera"] == camera


def test_without_the_viewer(monkeypatch: pytest.MonkeyPatch, sphere: Model) -> None:
    monkeypatch.setitem(sys.modules, "nofacet_viewer", None)
    with pytest.raises(ImportError, match=r"no window to open .*pip install 'nofacet\[viewer\]', or .*screenshot="):
        nofacet.show(sphere)


def test_screenshot_opens_no_window(window: list[Any], sphere: Model, tmp_path: Path) -> None:
    path = tmp_path / "ball.png"
    frame = nofacet.show(sphere, screenshot=path, width=64, height=48, samples=2)
    assert frame and frame.resolution == (64, 48) and not window
    pixels, _, attributes = image.read(path)
    assert pixels.shape == (48, 64, 4) and METADATA_KEY in attributes
    assert (pixels[0, 0] == 1).all() and frame.color[0, 0, 3] == 0  # white behind the picture in the file only
    nofacet.show(sphere, screenshot=path, width=64, height=48, background=None)
    assert image.read(path)[0][0, 0, 3] == 0
    nofacet.show(sphere, screenshot=path, width=64, height=48, background=(0, 0, 1))
    assert image.read(path)[0][0, 0].tolist() == [0, 0, 1, 1]


def test_section_planes_cut(window: list[Any], sphere: Model, tmp_path: Path) -> None:
    plane = nofacet.Section((0, 0, 0.1), (0, 0, 1))
    shell = replace(
        sphere,
        body_offsets=np.array([0, 1]),
        body_face=np.array([0], np.int32),
        body_face_outward=np.ones(1, np.int8),
        body_closed=np.zeros(1, np.uint8),
    )
    with pytest.warns(UserWarning, match="not a closed volume"):
        frame = nofacet.show(shell, sections=[plane], interact=False, width=32, height=32)
    whole = nofacet.show(shell, interact=False, width=32, height=32)
    assert frame and whole and 0.3 < frame.coverage.sum() / whole.coverage.sum() < 0.9
    shown(window, sphere, sections=[plane])
    assert window[-1][1]["sections"] == (plane,)


def test_a_picture_gives_its_camera_back(window: list[Any], sphere: Model, tmp_path: Path) -> None:
    camera = nofacet.Camera("perspective", (9, 1, 2), (0, 0, 0.1), view_angle=17.0)
    for name in ("shot.png", "shot.exr"):
        nofacet.show(sphere, camera=camera, screenshot=tmp_path / name, width=32, height=24)
        assert nofacet.Camera.load(tmp_path / name) == camera
        shown(window, sphere, camera=tmp_path / name)
        assert window[-1][1]["camera"] == camera


def test_interact_decides(window: list[Any], sphere: Model, tmp_path: Path) -> None:
    assert nofacet.show(sphere, interact=False, width=32, height=24) and not window
    assert nofacet.show(sphere, interact=True, screenshot=tmp_path / "a.png", width=32, height=24) is None
    assert len(window) == 1 and (tmp_path / "a.png").exists()


def test_in_a_notebook(window: list[Any], sphere: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    shell = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    frame = nofacet.show(sphere, width=32, height=24)
    assert frame and not window and (frame._repr_png_() or b"").startswith(PNG)
    shown(window, sphere, interact=True)
    shell.kernel = None  # IPython in a terminal
    shown(window, sphere)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    shown(window, sphere)
    assert len(window) == 3


def test_ipython_displays_a_frame(sphere: Model) -> None:
    formatters = pytest.importorskip("IPython.core.formatters")
    frame = nofacet.render(sphere, nofacet.Camera.fit(sphere), (32, 24), buffers=("color", "depth"))
    data, _ = formatters.DisplayFormatter().format(frame)
    assert data["image/png"].startswith(PNG)
    assert data["text/plain"] == "<Frame of 32 x 24 pixels: color, depth, position>"
    blind = nofacet.render(sphere, nofacet.Camera.fit(sphere), (32, 24), buffers=("face",))
    data, _ = formatters.DisplayFormatter().format(blind)
    assert data == {"text/plain": "<Frame of 32 x 24 pixels: face>"}


def test_png_of_a_frame_is_srgb_over_nothing(tmp_path: Path) -> None:
    color = np.zeros((1, 2, 4), np.float32)
    color[0, 1] = 0.25, 0.0, 0.0, 0.5  # half of linear 0.5
    frame = nofacet.Frame(look_down(1.0), {"color": color})
    (tmp_path / "a.png").write_bytes(frame.to_png())
    pixels = np.rint(255 * image.read(tmp_path / "a.png")[0])
    assert pixels.tolist() == [[[0, 0, 0, 0], [188, 0, 0, 128]]]


def test_names_colors_and_alphas(window: list[Any]) -> None:
    one, two, three = rectangle(0, 0, 1, 1), rectangle(2, 0, 3, 1), rectangle(4, 0, 5, 1)
    model = shown(
        window, one, two, three,
        names=["left", None, "right / \u00e9\n"],
        colors=["red", "#0000ff80", None],
        alphas=[None, None, 0.25],
    )  # fmt: skip
    assert [node.name for node in model.tree] == ["left", "made by hand", "right / \u00e9\n"]
    assert [node.faces.tolist() for node in model.tree] == [[0], [1], [2]]
    expected: list[list[float]] = [[1, 0, 0, 1], [0, 0, 1, 128 / 255], [0.5, 0.5, 0.5, 0.25]]
    np.testing.assert_allclose(model.face_color, expected, atol=1e-6)
    assert (one.face_color == np.float32(0.5)).any()  # what was given is as it was


def test_colors_in_every_form(window: list[Any]) -> None:
    pytest.importorskip("cadquery")
    pytest.importorskip("build123d")
    import build123d
    import cadquery

    linear = 0.21404114  # of sRGB 0.5
    for color in (
        (0.5, 0, 1),
        [0.5, 0, 1, 1],
        np.array([0.5, 0, 1], np.float32),
        cadquery.Color(0.5, 0, 1),
        build123d.Color(0.5, 0, 1),
    ):
        model = shown(window, rectangle(0, 0, 1, 1), colors=[color])
        np.testing.assert_allclose(model.face_color, [[linear, 0, 1, 1]], atol=1e-6)
        alone = shown(window, rectangle(0, 0, 1, 1), colors=color)
        np.testing.assert_array_equal(alone.face_color, model.face_color)
    assert shown(window, rectangle(0, 0, 1, 1), colors="steelblue", alphas=0.5).face_color[0, 3] == 0.5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"names": ["a"]}, "names: 1 for 2 objects"),
        ({"colors": ["red"] * 3}, "colors: 3 for 2 objects"),
        ({"colors": ["reddish", None]}, "unknown color 'reddish'; write a name"),
        ({"colors": ["#12", None]}, "unknown color '#12'"),
        ({"colors": [(1, 2, 3), None]}, "numbers from 0 to 1"),
        ({"colors": [(255, 0), None]}, "numbers from 0 to 1"),
        ({"alphas": [1.5, None]}, "alpha 1.5"),
        ({"direction": "frnt"}, "direction 'frnt': give three numbers, or one of front"),
        ({"camera": "missing.json"}, "missing.json"),
        ({"screenshot": "a.jpg"}, r"cannot write \.jpg"),
        ({"width": 0, "interact": False}, "resolution 0"),
        ({"width": 64.0}, r"resolution \(64.0, 720\): give two whole numbers"),
        ({"samples": 2.5}, "samples 2.5: give 1 to 256, a whole number"),
        ({"sections": nofacet.Section((0, 0, 0), (0, 0, 1))}, "sections Section.*: give a list"),
        ({"projection": "fisheye"}, "projection is 'fisheye'"),
        ({"background": (255, 255, 255)}, r"background \(255, 255, 255\): give three sRGB values from 0 to 1"),
    ],
)
def test_requests_that_make_no_sense(options: dict[str, Any], message: str, window: list[Any], sphere: Model) -> None:
    with pytest.raises((ValueError, OSError), match=message) as caught:
        nofacet.show(sphere, sphere, **options)
    assert "\n" not in str(caught.value) and not window


def test_nothing_to_show(window: list[Any]) -> None:
    with pytest.raises(ValueError, match="there is nothing to show"):
        nofacet.show()
    with pytest.raises(nofacet.InputError, match="type int"):
        nofacet.show(3)
    with pytest.raises(nofacet.InputError, match="object 1: this list is empty"):
        nofacet.show([])


def test_cad_objects_together(window: list[Any]) -> None:
    cq, b123d = pytest.importorskip("cadquery"), pytest.importorskip("build123d")
    assembly = cq.Assembly(name="pair").add(cq.Workplane().box(1, 1, 1), name="a", color=cq.Color("green"))
    assembly.add(cq.Workplane().sphere(1), name="b", loc=cq.Location((5, 0, 0)))
    solid = b123d.Solid.make_cylinder(1, 2).moved(b123d.Location((0, 9, 0)))
    solid.label = "rod"
    parts = (
        assembly,
        solid,
        cq.Workplane().box(2, 2, 2).val().wrapped,
        cq.Sketch().rect(3, 2),
        [cq.Workplane().sphere(3)] * 2,
    )
    model = shown(window, *parts, OWN / "bottle.step", names=[None, None, "raw", "flat", "balls", None])
    separate = [nofacet.load(part) for part in parts[:4]]
    counts = [part.face_count for part in separate]
    assert counts == [7, 3, 6, 1]
    tree = [(node.name, node.parent) for node in model.tree]
    assert tree[:5] == [("pair", -1), ("a", 0), ("b", 0), ("rod", -1), ("raw", -1)]
    assert ("flat", -1) in tree and ("balls", -1) in tree
    assert model.tree[2].faces.tolist() == [6] and model.tree[3].faces.tolist() == [7, 8, 9]
    np.testing.assert_allclose(model.face_color[0], separate[0].face_color[0])
    np.testing.assert_allclose(bounding_box(shown(window, *parts))[1][1], 10)
    frame = nofacet.render(model, nofacet.Camera.fit(model, resolution=(200, 150)), (200, 150))
    assert len(np.unique(frame.face)) > 5


def test_what_has_no_faces_is_named_and_the_rest_shown(window: list[Any], sphere: Model) -> None:
    cq = pytest.importorskip("cadquery")
    empty = cq.Compound.makeCompound([])
    wire = cq.Workplane().rect(1, 2)
    with pytest.warns(UserWarning, match="(nothing|wire): this .* object has no faces") as caught:
        model = shown(window, empty, sphere, wire, names=["nothing", "ball", "wire"])
    assert len(caught) == 2 and len(model.warnings) == 2
    assert [node.name for node in model.tree] == ["ball"] and model.face_count == 1
    for lost in (empty, wire):
        with pytest.raises(nofacet.InputError, match="has no faces"):
            nofacet.show(lost)


def test_warnings_of_conversion_are_told(window: list[Any], sphere: Model) -> None:
    with pytest.warns(UserWarning, match="ball: face 0 is odd"):
        shown(window, replace(sphere, warnings=["face 0 is odd"]), sphere, names=["ball", None])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shown(window, sphere)
