"""Words on pictures that no window shows: captions below the sides, and legends."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .color_scale import ColorScale

Picture = NDArray[np.uint8]

FONT = "DroidSans"  # OpenImageIO brings it along
BOLD = "DroidSans-Bold"
LINE = 1.4  # line height over font size
SEPARATOR = "  ·  "
PAPER, INK, FAINT_INK = 245, 20, 90  # sRGB grays


def font_size(height: int) -> int:
    """For a picture of that height, pixels."""
    return max(10, round(height / 50))


def caption_height(height: int) -> int:
    """Of two lines, pixels."""
    return round(2.6 * LINE * font_size(height))


def write_text(picture: Picture, x: int, y: int, text: str, size: int, align: str = "left", bold: bool = False) -> None:
    """Write into a picture (height, width, 3), sRGB; x, y: where the text's baseline begins, ends or has its middle."""
    import OpenImageIO as oiio

    height, width, channels = picture.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, "uint8"))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(picture))
    color = (INK / 255,) * 3 if bold else (FAINT_INK / 255,) * 3
    name = BOLD if bold else FONT
    if not oiio.ImageBufAlgo.render_text(buffer, x, y, text, size, name, color, align, "baseline"):
        raise RuntimeError(f"no text in the picture: {buffer.geterror()}")
    picture[:] = np.asarray(buffer.get_pixels(oiio.UINT8)).reshape(picture.shape)


def draw_caption(picture: Picture, x: int, width: int, height: int, title: str, figures: list[str]) -> None:
    """A title and figures in the lowest `height` rows of a picture, columns x to x + width. The last figures are below
    the title, those that find no room there beside it, those that find none there either nowhere."""
    size = font_size(picture.shape[0])
    strip = picture[-height:, x : x + width]
    strip[:] = PAPER
    first = round(LINE * size)
    write_text(strip, size, first, title, size, bold=True)
    below = last_that_fit(figures, size, width - 2 * size)
    if below:
        write_text(strip, size, first + round(LINE * size), SEPARATOR.join(below), size)
    left = text_width(title, size, bold=True) + 2 * size
    beside = last_that_fit(figures[: len(figures) - len(below)], size, width - left - size)
    if beside:
        write_text(strip, left, first, SEPARATOR.join(beside), size)


def last_that_fit(figures: list[str], size: int, width: int) -> list[str]:
    """As many of the last figures as a line of `width` pixels holds."""
    first = 0
    while first < len(figures) and text_width(SEPARATOR.join(figures[first:]), size) > width:
        first += 1
    return figures[first:]


def text_width(text: str, size: int, bold: bool = False) -> int:
    """Pixels."""
    import OpenImageIO as oiio

    box: Any = oiio.ImageBufAlgo.text_size(text, size, BOLD if bold else FONT)
    return int(box.xend - box.xbegin)


def draw_legend(picture: Picture, scale: ColorScale) -> None:
    """The colours of a scale and what they mean, in the lower right corner."""
    height, width, _ = picture.shape
    size = font_size(height)
    title = f"{scale.title}, {scale.unit}"
    bar_width, bar_height = min(max(16 * size, text_width(title, size) - 2 * size), width - 4 * size), size
    box = picture[-round(4.6 * size) - size // 2 :, -bar_width - 4 * size :][: round(4.6 * size), : -size // 2]
    box[:] = PAPER
    write_text(box, box.shape[1] // 2, round(1.2 * size), title, size, "center")
    left, top = (box.shape[1] - bar_width) // 2, round(1.7 * size)
    ramp = scale.ramp()
    columns = ramp[np.arange(bar_width) * len(ramp) // bar_width]
    box[top : top + bar_height, left : left + bar_width] = srgb8(columns)
    for place, label in scale.ticks():
        write_text(box, left + round(place * (bar_width - 1)), top + round(2.2 * size), label, size, "center")


def srgb8(linear: NDArray[np.float32]) -> Picture:
    """8-bit sRGB from linear RGB (..., 3)."""
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.rint(255 * encoded).astype(np.uint8)
