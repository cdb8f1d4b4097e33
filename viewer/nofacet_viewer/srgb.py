"""From linear colours to what screens take."""

from __future__ import annotations

RGB = tuple[float, float, float]


def encoded(linear: RGB) -> RGB:
    """sRGB of linear RGB, both from 0 to 1."""
    red, green, blue = (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in linear)
    return red, green, blue
