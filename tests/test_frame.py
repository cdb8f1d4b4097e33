"""Frame: buffers by name, and what its files hold."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nofacet import image
from nofacet.camera import METADATA_KEY, Camera
from nofacet.frame import BUFFERS, Frame

WIDTH, HEIGHT = 5, 3
STORED = tuple(name for name in BUFFERS if name != "position")


@pytest.fixture
def camera() -> Camera:
    return Camera("orthographic", (1, 2, 30), (0, 0, 0), (0, 1, 0), view_height=6.0)


@pytest.fixture
def frame(camera: Camera) -> Frame:
    rng = np.random.default_rng(1)
    shapes = {name: (HEIGHT, WIDTH) + ((count,) if count > 1 else ()) for name, (_, count, _) in BUFFERS.items()}
    buffers: dict[str, Any] = {name: rng.random(shapes[name]).astype(BUFFERS[name][0]) for name in STORED}
    buffers["face"][...] = rng.integers(-1, 2**24, (HEIGHT, WIDTH))
    buffers["depth"][0, 0] = np.inf
    buffers["color"][..., :3] *= buffers["color"][..., 3:]
    return Frame(camera, buffers)


def test_buffers_by_name(frame: Frame) -> None:
    assert frame.resolution == (WIDTH, HEIGHT)
    assert frame.buffers == tuple(BUFFERS)
    assert frame.depth.shape == (HEIGHT, WIDTH) and frame.position.shape == (HEIGHT, WIDTH, 3)
    np.testing.assert_array_equal(frame.position, frame.camera.position_from_depth(frame.depth))
    np.testing.assert_array_equal(copy.deepcopy(frame).uv, frame.uv)


def test_a_buffer_that_was_not_rendered_says_how_to_get_it(camera: Camera) -> None:
    frame = Frame(camera, {"face": np.zeros((HEIGHT, WIDTH), np.int32)})
    with pytest.raises(AttributeError, match=r"uv was not rendered.*buffers=\('face', 'uv'\)"):
        _ = frame.uv
    with pytest.raises(AttributeError, match=r"position was not rendered.*'depth'"):
        _ = frame.position
    with pytest.raises(AttributeError, match="no 'colour'"):
        _ = frame.colour
    assert not hasattr(frame, "normal") and frame.buffers == ("face",)


@pytest.mark.parametrize(
    "buffers",
    [
        {},
        {"colour": np.zeros((3, 5))},
        {"depth": np.zeros((3, 5, 1))},
        {"depth": np.zeros((3, 5), np.float32)},
        {"position": np.zeros((3, 5, 3))},
        {"depth": np.zeros((3, 5)), "face": np.zeros((5, 3), np.int32)},
    ],
)
def test_wrong_buffers_are_refused(camera: Camera, buffers: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        Frame(camera, buffers)


def test_npz_holds_every_buffer_bit_for_bit(frame: Frame, tmp_path: Path) -> None:
    path = tmp_path / "frame.npz"
    frame.save(path)
    with np.load(path) as data:
        for name, (dtype, _, _) in BUFFERS.items():
            assert data[name].dtype == dtype
            np.testing.assert_array_equal(data[name], getattr(frame, name))
    again = Frame.load(path)
    assert again.camera == frame.camera and again.buffers == frame.buffers
    np.testing.assert_array_equal(again.position, frame.position)
    frame.save(path, ["depth", "position"])
    with np.load(path) as data:
        assert set(data.files) & set(BUFFERS) == {"depth", "position"}


def test_exr_holds_every_buffer_under_the_contract_names(frame: Frame, tmp_path: Path) -> None:
    path = tmp_path / "frame.exr"
    frame.save(path)
    pixels, channels, attributes = image.read(path)
    names = "R G B A coverage Z face U V P.X P.Y P.Z N.X N.Y N.Z"
    assert pixels.dtype == np.float32 and sorted(channels) == sorted(names.split())
    assert json.loads(attributes["nofacet:camera"]) == frame.camera.to_dict()
    assert attributes["Software"].startswith("nofacet ")
    again = Frame.load(path)
    assert again.camera == frame.camera and again.buffers == frame.buffers
    for name in STORED:
        assert getattr(again, name).dtype == BUFFERS[name][0]
        np.testing.assert_array_equal(getattr(again, name), getattr(frame, name).astype(np.float32))


def test_png_is_srgb_with_straight_alpha(camera: Camera, tmp_path: Path) -> None:
    color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    color[0, 0] = 0.1, 0.05, 0.25, 0.5  # premultiplied: straight (0.2, 0.1, 0.5)
    color[0, 1] = 1, 2, 0.001, 1
    frame = Frame(camera, {"color": color})
    path = tmp_path / "frame.png"
    frame.save(path)
    pixels, channels, attributes = image.read(path)
    assert channels == ["R", "G", "B", "A"] and pixels.shape == (HEIGHT, WIDTH, 4)
    assert np.rint(255 * pixels[0, :3]).tolist() == [[124, 89, 188, 128], [255, 255, 3, 255], [0, 0, 0, 0]]
    assert Camera.load(path) == camera and attributes["Software"].startswith("nofacet ")


def test_over_a_background(camera: Camera, tmp_path: Path) -> None:
    color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    color[0, 0] = 0, 0.5, 0, 0.5
    opaque = Frame(camera, {"color": color, "coverage": color[..., 3].copy()}).over((1, 1, 0.5))
    np.testing.assert_allclose(opaque.color[0, 0], [0.5, 1, 0.5 * 0.2140411, 1], rtol=1e-6)
    assert opaque.coverage[0, 0] == 0.5 and color[0, 0, 3] == 0.5
    opaque.save(tmp_path / "frame.png")
    pixels, _, _ = image.read(tmp_path / "frame.png")
    assert np.rint(255 * pixels[1, 1]).tolist() == [255, 255, 128, 255]


@pytest.mark.parametrize("background", [(5, 5, 5), (np.nan,) * 3, "white", (1, 2), (1, 1, 1, 1), (1, None, 1), 0.5])
def test_backgrounds_are_three_values_from_0_to_1(frame: Frame, background: Any) -> None:
    for before in (frame.over, frame.srgb8):
        with pytest.raises(ValueError, match="^background .*: give three sRGB values from 0 to 1$"):
            before(background)


@pytest.mark.parametrize(("extension", "rtol"), [("npz", 1e-14), ("exr", 1e-6)])
def test_position_alone_gives_depth_back(frame: Frame, tmp_path: Path, extension: str, rtol: float) -> None:
    path = tmp_path / f"frame.{extension}"
    frame.save(path, ["position"])
    again = Frame.load(path)
    assert again.buffers == ("depth", "position") and again.depth.dtype == np.float64
    np.testing.assert_allclose(again.depth, frame.depth, rtol=rtol, atol=30 * rtol)
    np.testing.assert_allclose(again.position, frame.position, rtol=rtol, atol=30 * rtol)


def test_files_that_hold_no_frame_are_named(frame: Frame, tmp_path: Path) -> None:
    path = tmp_path / "frame.npz"
    frame.save(path)
    whole = path.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 255
    np.save(tmp_path / "array.npy", frame.depth)
    np.savez(tmp_path / "objects.npz", depth=np.array([{}], object))
    contents = [b"", b"hello", whole[: len(whole) // 2], bytes(damaged)]
    contents += [(tmp_path / name).read_bytes() for name in ("array.npy", "objects.npz")]
    for content in contents:
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"frame\.npz: this is not a whole \.npz file of a frame"):
            Frame.load(path)
    (tmp_path / "frame.exr").write_bytes(b"hello")
    with pytest.raises(ValueError, match=r"frame\.exr: this is not a whole EXR file"):
        Frame.load(tmp_path / "frame.exr")
    with pytest.raises(ValueError, match=r"frame\.jpg: cannot read \.jpg; give \.npz or \.exr"):
        Frame.load(tmp_path / "frame.jpg")
    with pytest.raises(FileNotFoundError, match=r"missing\.npz"):
        Frame.load(tmp_path / "missing.npz")


def test_what_is_wrong_with_a_frame_is_said_with_its_file(frame: Frame, tmp_path: Path) -> None:
    path, camera = tmp_path / "frame.npz", json.dumps(frame.camera.to_dict())
    for arrays, text, message in (
        ({"depth": frame.depth}, "{", "the nofacet:camera in it is damaged"),
        ({"depth": frame.depth}, "[]", "this is not a JSON object"),
        ({"depth": frame.face}, camera, "buffer depth is int32"),
        ({"position": frame.depth}, camera, "buffer position is float64 .*; it must be"),
        ({"position": np.array("x")}, camera, "buffer position is <U1"),
        ({}, camera, "at least one buffer"),
    ):
        stored: dict[str, Any] = {**arrays, METADATA_KEY: text}
        np.savez(path, **stored)
        with pytest.raises(ValueError, match=rf"frame\.npz: .*{message}"):
            Frame.load(path)


def test_files_that_cannot_be(frame: Frame, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"cannot write \.jpg; use \.png, \.exr or \.npz"):
        frame.save(tmp_path / "frame.jpg")
    with pytest.raises(OSError, match="missing does not exist"):
        frame.save(tmp_path / "missing" / "frame.png")
    with pytest.raises(ValueError, match="unknown buffer 'colour'"):
        frame.save(tmp_path / "frame.npz", ["colour"])
    for name in ("none.npz", "none.exr"):
        with pytest.raises(ValueError, match="no buffer to save; choose from color, "):
            frame.save(tmp_path / name, [])
        assert not (tmp_path / name).exists()
    with pytest.raises(ValueError, match="does not hold the buffers"):
        Frame.load(tmp_path / "frame.png")
    with pytest.raises(OSError):
        Frame.load(tmp_path / "frame.exr")
    (tmp_path / "folder.exr").mkdir()
    with pytest.raises(OSError):
        frame.save(tmp_path / "folder.exr")
    np.savez(tmp_path / "other.npz", depth=frame.depth)
    with pytest.raises(ValueError, match="made by nofacet"):
        Frame.load(tmp_path / "other.npz")
