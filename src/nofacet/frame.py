"""A rendered picture: its buffers, camera and files."""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native, image
from .camera import METADATA_KEY, Camera

# Buffer -> (dtype, channels, channel names in an EXR file). Arrays are (height, width) or (height, width, channels).
BUFFERS: dict[str, tuple[type[np.generic], int, tuple[str, ...]]] = {
    "color": (np.float32, 4, ("R", "G", "B", "A")),
    "coverage": (np.float32, 1, ("coverage",)),
    "depth": (np.float64, 1, ("Z",)),
    "face": (np.int32, 1, ("face",)),
    "uv": (np.float64, 2, ("U", "V")),
    "position": (np.float64, 3, ("P.X", "P.Y", "P.Z")),
    "normal": (np.float32, 3, ("N.X", "N.Y", "N.Z")),
}
EXTENSIONS = (".png", ".exr", ".npz")
SOFTWARE_KEY = "Software"


class Frame:
    """The buffers that a renderer was asked for, and the camera they were seen with.

    Buffers, row 0 at the top; h, w = height and width:
    color (h, w, 4) float32, linear RGBA, alpha premultiplied, averaged over the pixel.
    coverage (h, w) float32, the part of the pixel's area that the model covers.
    depth (h, w) float64, distance from the eye plane, model units; +inf on background.
    face (h, w) int32, index of the face; -1 on background, -2 - k on the caps of section plane k.
    uv (h, w, 2) float64, OpenCascade's parameters on that face; 0 on background, NaN on caps.
    position (h, w, 3) float64, world point, from depth, which is kept with it, and camera; NaN on background.
    normal (h, w, 3) float32, unit, world, turned towards the eye; 0 on background.

    Asking for a buffer that was not rendered raises AttributeError.
    """

    def __init__(
        self, camera: Camera, buffers: Mapping[str, NDArray[Any]], stats: Mapping[str, Any] | None = None
    ) -> None:
        """Raises ValueError for an unknown buffer, a wrong shape or dtype, or no buffer at all."""
        if not buffers:
            raise ValueError("a frame needs at least one buffer")
        self.camera = camera
        self.height, self.width = (int(size) for size in next(iter(buffers.values())).shape[:2])
        for name, array in buffers.items():
            dtype, channels, _ = _buffer(name)
            shape = (self.height, self.width) if channels == 1 else (self.height, self.width, channels)
            if name == "position":
                raise ValueError("position is derived from depth and camera; give depth")
            if array.shape != shape or array.dtype != dtype:
                raise ValueError(f"buffer {name} is {array.dtype} {array.shape}; it must be {dtype.__name__} {shape}")
        self._buffers = dict(buffers)
        self.stats = dict(stats or {})

    @property
    def resolution(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.width, self.height

    @property
    def buffers(self) -> tuple[str, ...]:
        """Names of the buffers this frame can give, in the order of the contract above."""
        return tuple(name for name in BUFFERS if ("depth" if name == "position" else name) in self._buffers)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in BUFFERS:
            raise AttributeError(f"a frame has no {name!r}; its buffers are {', '.join(self.buffers)}")
        stored = "depth" if name == "position" else name
        if stored not in self._buffers:
            asked = tuple(self._buffers) + (stored,)
            raise AttributeError(f"{name} was not rendered; ask for it: nofacet.render(..., buffers={asked})")
        return self.camera.position_from_depth(self._buffers[stored]) if name == "position" else self._buffers[stored]

    def srgb8(self, background: Sequence[float] | None = None) -> NDArray[np.uint8]:
        """The color buffer as screens show it, (h, w, 4) uint8 sRGB: with straight alpha as `save` writes it or, before
        a background (three sRGB values from 0 to 1), opaque. The interpreter's lock is free meanwhile. Raises
        ValueError for another background."""
        behind = None if background is None else linear_background(background)
        pixels: NDArray[np.uint8] = _native.frame_buffer(self.color.size).reshape(self.color.shape)
        _native.srgb8(np.ascontiguousarray(self.color), behind, os.cpu_count() or 1, pixels)
        return pixels

    def over(self, background: Sequence[float]) -> Frame:
        """This frame before an opaque background, three sRGB values from 0 to 1. Needs the color buffer.

        Raises ValueError for another background.
        """
        color = self.color.copy()
        color[..., :3] += (1 - color[..., 3:]) * linear_background(background).astype(np.float32)
        color[..., 3] = 1
        return Frame(self.camera, {**self._buffers, "color": color}, self.stats)

    def save(self, path: str | Path, buffers: Sequence[str] | None = None) -> None:
        """Write the frame to a .png (color, 8-bit sRGB), .exr or .npz file (all buffers, or those named).

        EXR holds 32-bit floats, so depth, uv and position lose digits there; face is exact up to 2 ** 24. The camera
        and the program's version go along in every format.

        Raises ValueError for another extension, an unknown buffer or none at all, AttributeError for a buffer that was
        not rendered, OSError where the file cannot be written.
        """
        from importlib.metadata import version  # 25 ms to import, which reading a model should not pay

        path = Path(path)
        extension = check_extension(path)
        if not path.parent.is_dir():
            raise OSError(f"{path}: the folder {path.parent} does not exist; make it first")
        attributes: dict[str, Any] = {
            METADATA_KEY: json.dumps(self.camera.to_dict()),
            SOFTWARE_KEY: f"nofacet {version('nofacet')}",
        }
        if extension == ".png":
            image.write(path, self.srgb8(), ("R", "G", "B", "A"), attributes)
            return
        arrays: dict[str, Any] = {}
        for name in self.buffers if buffers is None else buffers:
            _buffer(name)
            arrays[name] = getattr(self, name)
        if not arrays:
            raise ValueError(f"{path}: no buffer to save; choose from {', '.join(self.buffers)}")
        if extension == ".npz":
            with path.open("wb") as file:
                np.savez(file, **arrays, **attributes)
            return
        pixels = np.dstack([array.astype(np.float32) for array in arrays.values()])
        image.write(path, pixels, [channel for name in arrays for channel in BUFFERS[name][2]], attributes)

    def to_png(self) -> bytes:
        """The file that `save` would write as .png. Raises AttributeError where color was not rendered."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "frame.png")
            self.save(path)
            return path.read_bytes()

    def __repr__(self) -> str:
        return f"<Frame of {self.width} x {self.height} pixels: {', '.join(self.buffers)}>"

    def _repr_png_(self) -> bytes | None:
        """For notebooks: the picture, if there is one."""
        return self.to_png() if "color" in self.buffers else None

    @classmethod
    def load(cls, path: str | Path) -> Frame:
        """Read a frame that `save` wrote as .npz or .exr (there with the digits that 32-bit floats hold).

        Depth that was not saved is made of position, to within rounding.

        Raises ValueError (with the file's name) for a file of another kind or a damaged one, OSError where it cannot be
        opened.
        """
        path = Path(path)
        extension = path.suffix.lower()
        if extension == ".png":
            raise ValueError(f"{path}: a PNG file does not hold the buffers; save the frame as .npz or .exr")
        if extension not in (".npz", ".exr"):
            raise ValueError(f"{path}: cannot read {extension or 'a file without extension'}; give .npz or .exr")
        arrays, text = _read_npz(path) if extension == ".npz" else _read_exr(path)
        if not text:
            raise ValueError(f"{path}: no {METADATA_KEY} in it; only files made by nofacet carry one")
        try:
            camera = Camera.from_dict(json.loads(text))
            position = arrays.pop("position", None)
            if position is not None and "depth" not in arrays:
                if position.dtype != np.float64 or position.shape[2:] != (3,):
                    shape = f"{position.dtype} {position.shape}"
                    raise ValueError(f"buffer position is {shape}; it must be float64 (height, width, 3)")
                depth = (position - camera.position) @ camera.direction
                arrays["depth"] = np.where(np.isnan(depth), np.inf, depth)
            return cls(camera, arrays)
        except (json.JSONDecodeError, RecursionError):
            raise ValueError(f"{path}: the {METADATA_KEY} in it is damaged") from None
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None


def check_extension(path: Path) -> str:
    """The path's extension in lower case. Raises ValueError where no frame can be saved under it."""
    extension = path.suffix.lower()
    if extension not in EXTENSIONS:
        raise ValueError(f"{path}: cannot write {extension or 'a file without extension'}; use .png, .exr or .npz")
    return extension


def _read_npz(path: Path) -> tuple[dict[str, NDArray[Any]], str]:
    """The buffers in a file and the text of its camera."""
    with path.open("rb") as file:
        try:
            if not zipfile.is_zipfile(file):
                raise zipfile.BadZipFile
            file.seek(0)
            with np.load(file, allow_pickle=False) as data:
                arrays = {name: data[name] for name in (*BUFFERS, METADATA_KEY) if name in data.files}
        except (ValueError, OSError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error):  # of damage
            raise ValueError(f"{path}: this is not a whole .npz file of a frame; save the frame again") from None
    return arrays, str(arrays.pop(METADATA_KEY, ""))


def _read_exr(path: Path) -> tuple[dict[str, NDArray[Any]], str]:
    """The buffers in a file and the text of its camera."""
    try:
        pixels, channels, attributes = image.read(path)
    except (OSError, UnicodeDecodeError):
        path.open("rb").close()  # knows better what is wrong where there is no such file
        raise ValueError(f"{path}: this is not a whole EXR file; save the frame again") from None
    arrays = {}
    for name, (dtype, count, names) in BUFFERS.items():
        if set(names) <= set(channels):
            array = pixels[..., [channels.index(channel) for channel in names]].astype(dtype)
            arrays[name] = array[..., 0] if count == 1 else array
    return arrays, str(attributes.get(METADATA_KEY, ""))


def _buffer(name: str) -> tuple[type[np.generic], int, tuple[str, ...]]:
    if name not in BUFFERS:
        raise ValueError(f"unknown buffer {name!r}; the buffers are {', '.join(BUFFERS)}")
    return BUFFERS[name]


def linear_background(background: Sequence[float]) -> NDArray[np.float64]:
    """Linear RGB (3,) of three sRGB values from 0 to 1. Raises ValueError for anything else."""
    try:
        srgb = np.asarray(background, np.float64)
    except (TypeError, ValueError):
        srgb = np.empty(0)
    if srgb.shape != (3,) or not ((srgb >= 0) & (srgb <= 1)).all():
        raise ValueError(f"background {background!r}: give three sRGB values from 0 to 1")
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
