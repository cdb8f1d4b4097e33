"""Reading and writing image files, through OpenImageIO."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import OpenImageIO as oiio  # 30 ms, which only those who touch images should pay

PNG_END = b"IEND\xaeB`\x82"  # the last chunk's name and checksum


def write(
    path: str | Path,
    pixels: NDArray[Any],
    channels: Sequence[str],
    attributes: Mapping[str, str],
) -> None:
    """Write pixels (height, width, channels) to `path`, the format by its extension, row 0 at the top.

    uint8 pixels are written as sRGB with unassociated alpha, float32 ones as linear values just as they are.
    Raises OSError where the file cannot be written.
    """
    import OpenImageIO as oiio

    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, "uint8" if pixels.dtype == np.uint8 else "float")
    spec.channelnames = tuple(channels)
    if pixels.dtype == np.uint8:
        spec.attribute("oiio:UnassociatedAlpha", 1)
        spec.attribute("oiio:ColorSpace", "sRGB")
    for name, value in attributes.items():
        spec.attribute(name, value)
    output = oiio.ImageOutput.create(str(path))
    if output is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    written = output.open(str(path), spec) and output.write_image(np.ascontiguousarray(pixels))
    error = output.geterror()
    if not (output.close() and written):
        raise OSError(f"{path}: {error or output.geterror()}")
    if not _is_whole(path, height):
        raise OSError(f"{path}: only a part of the picture was written; is the disk full?")


def _is_whole(path: str | Path, height: int) -> bool:
    """Whether the end of the file was written: the libraries below do not always notice that a disk is full."""
    if str(path).lower().endswith(".png"):  # which can only be read from its beginning
        with open(path, "rb") as file:
            file.seek(max(0, file.seek(0, 2) - len(PNG_END)))
            return file.read(len(PNG_END)) == PNG_END
    source = _open(path)
    try:
        return source.read_scanline(height - 1, 0, "float") is not None
    finally:
        source.close()


def read(path: str | Path) -> tuple[NDArray[np.float32], list[str], dict[str, Any]]:
    """Pixels (height, width, channels) as they are stored, channel names and attributes of an image file.

    Raises OSError where it cannot be read.
    """
    source = _open(path)
    try:
        pixels = source.read_image("float")
        if pixels is None:
            raise OSError(f"{path}: {source.geterror()}")
        spec = source.spec()
        return pixels, list(spec.channelnames), {item.name: item.value for item in spec.extra_attribs}
    finally:
        source.close()


def read_attribute(path: str | Path, name: str) -> str | None:
    """A text attribute from an image file's metadata, None without it. Raises OSError where it cannot be read."""
    source = _open(path)
    value = source.spec().getattribute(name)
    source.close()
    return value if isinstance(value, str) else None


def _open(path: str | Path) -> oiio.ImageInput:
    import OpenImageIO as oiio

    as_stored = oiio.ImageSpec()
    as_stored.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), as_stored)
    if source is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    return source
