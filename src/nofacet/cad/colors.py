"""Colours as people write them and as CAD packages hold them."""

from __future__ import annotations

from numbers import Real
from typing import Any

from OCP.Quantity import Quantity_Color, Quantity_ColorRGBA, Quantity_TypeOfColor

Rgba = tuple[float, float, float, float]
_HOW = "write a name as 'steelblue', '#rrggbb', '#rrggbbaa', or three or four numbers from 0 to 1"


def linear_rgba(color: Any) -> Rgba:
    """Linear RGBA of a colour: a name OpenCascade knows or '#rrggbb[aa]', three or four sRGB values from 0 to 1, or a
    cadquery or build123d Color. Without a fourth value it is opaque. Raises ValueError for anything else."""
    if isinstance(getattr(color, "wrapped", None), Quantity_ColorRGBA):
        return _values(color.wrapped)
    if isinstance(color, str):
        found = Quantity_ColorRGBA()
        named = Quantity_ColorRGBA.ColorFromHex_s if color.startswith("#") else Quantity_ColorRGBA.ColorFromName_s
        if not named(color, found):
            raise ValueError(f"unknown color {color!r}; {_HOW}")
        return _values(found)
    if not hasattr(color, "__len__") or len(color) not in (3, 4) or not all(_is_share(value) for value in color):
        raise ValueError(f"color {color!r}: {_HOW}")
    red, green, blue, alpha = (float(value) for value in (*color, 1.0)[:4])
    return _values(Quantity_ColorRGBA(Quantity_Color(red, green, blue, Quantity_TypeOfColor.Quantity_TOC_sRGB), alpha))


def _is_share(value: Any) -> bool:
    return isinstance(value, Real) and 0 <= float(value) <= 1


def _values(color: Quantity_ColorRGBA) -> Rgba:
    rgb = color.GetRGB()  # OpenCascade keeps linear values
    return rgb.Red(), rgb.Green(), rgb.Blue(), color.Alpha()
