"""Orientations of sub-shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .stream import REVERSED


def composed(outer: NDArray[Any], inner: NDArray[Any]) -> NDArray[Any]:
    """TopAbs::Compose: a reversed parent flips, an internal or external one passes its own on."""
    flipped = np.where((outer == REVERSED) & (inner <= REVERSED), 1 - inner.astype(np.intp), inner)
    return np.where(outer <= REVERSED, flipped, outer)
