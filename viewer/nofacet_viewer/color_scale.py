"""Colours that stand for numbers, and the legend that explains them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

STEPS = 256  # colours of a ramp

# Linear RGB at equal distances. Blue - pale gray - red for signed values, dark blue to yellow for sizes.
DIVERGING = ((0.01, 0.05, 0.40), (0.10, 0.35, 0.75), (0.75, 0.75, 0.75), (0.80, 0.22, 0.06), (0.38, 0.01, 0.01))
SEQUENTIAL = ((0.02, 0.01, 0.12), (0.03, 0.10, 0.32), (0.02, 0.28, 0.28), (0.20, 0.52, 0.10), (0.90, 0.80, 0.02))
NO_VALUE = (0.3, 0.3, 0.3)  # of what has no number


@dataclass(frozen=True)
class ColorScale:
    """What colours mean: `title` in `unit`, from `low` to `high`.

    log: equal steps of colour are equal ratios. root: they are equal steps of the value's square root, with its sign,
    so that small values differ from 0 (low is -high). colors: linear RGB at equal distances from low to high.
    """

    title: str
    unit: str
    low: float
    high: float
    colors: tuple[tuple[float, float, float], ...]
    log: bool = False
    root: bool = False

    def color(self, values: ArrayLike) -> NDArray[np.float32]:
        """Linear RGB (..., 3) of values (...); NaN is gray, what lies outside has the end's colour."""
        value, low, high = (self._evenly(np.asarray(x, np.float64)) for x in (values, self.low, self.high))
        place = (value - low) / (high - low)
        return np.where(np.isnan(place)[..., None], NO_VALUE, self._at(np.nan_to_num(place))).astype(np.float32)

    def ramp(self) -> NDArray[np.float32]:
        """Linear RGB (STEPS, 3) from low to high."""
        return self._at(np.linspace(0, 1, STEPS)).astype(np.float32)

    def _evenly(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """What equal steps of colour are equal steps of."""
        if self.log:
            return np.log(np.maximum(values, self.low))
        return np.sign(values) * np.sqrt(np.abs(values)) if self.root else values

    def _at(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        """Linear RGB (..., 3) at places along the ramp, from 0 to 1."""
        ramp = np.array(self.colors)
        ends = np.linspace(0, 1, len(ramp))
        return np.stack([np.interp(place, ends, ramp[:, c]) for c in range(3)], axis=-1)

    def ticks(self) -> list[tuple[float, str]]:
        """Places along the ramp, from 0 to 1, and what to write there."""
        if self.log:
            exponents = range(round(np.log10(self.low)), round(np.log10(self.high)) + 1)
            step = max(1, len(exponents) // 4)
            shown = list(exponents)[::step]
            span = max(1, len(exponents) - 1)
            return [((exponent - exponents[0]) / span, f"1e{exponent}") for exponent in shown]
        if self.root:
            shares = np.linspace(-1, 1, 5)
            return [(0.5 + share / 2, f"{self.high * share * abs(share):g}") for share in shares]
        values = np.linspace(self.low, self.high, 5)
        return [(k / 4, f"{value:g}") for k, value in enumerate(values)]


def rounded_up(value: float) -> float:
    """The next 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1, 2, 5, 10) if step * power >= value * (1 - 1e-12)))


def outline_scale(largest: float) -> ColorScale:
    """For signed outline errors of at most `largest` pixels."""
    end = rounded_up(max(largest, 0.01))
    return ColorScale("outline, drawn beyond exact", "px", -end, end, DIVERGING, root=True)


def curvature_scale(size: float) -> ColorScale:
    """For mean curvatures of a model of that size (diagonal), model units: radii down to a fortieth of it show."""
    end = rounded_up(20 / size)
    return ColorScale("mean curvature, hollow is positive", "1/mm", -end, end, DIVERGING)


def conversion_scale(errors: NDArray[np.float64]) -> ColorScale:
    """For the conversion errors of faces, model units: whole powers of ten around those that are not zero."""
    found = errors[np.isfinite(errors) & (errors > 0)]
    low = np.floor(np.log10(found.min())) if len(found) else -15.0
    high = np.ceil(np.log10(found.max())) if len(found) else -12.0
    return ColorScale("conversion error", "mm", 10.0**low, 10.0 ** max(high, low + 1), SEQUENTIAL, log=True)
