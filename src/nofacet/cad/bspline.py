"""B-splines to Bezier pieces by blossoming (Ramshaw 1989), exact up to rounding.

The Bezier points of a polynomial piece over [a, b] are its blossom values f(a, .., a, b, .., b). They come from the
B-spline's poles d_i = f(t_{k-p+1+i}, .., t_{k+i}) in two triangles: first a replaces the knots left of the span, then
b replaces those right of it. Neither needs a and b to be knots, so cutting to a box and continuing the end spans
beyond the domain are the same operation. The work is done in C++ (src/native/extract/spline.h and blossom.h), which
also reads the curves and surfaces of a stream, many at once: `curves` and `patches` call it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _native

Array = NDArray[np.float64]


def curve_pieces(
    degree: int,
    poles: Array,
    knots: Array,
    multiplicities: NDArray[np.int32],
    periodic: bool,
    low: float,
    high: float,
) -> tuple[Array, Array]:
    """Bezier pieces (m, p + 1, c) of a curve with poles (n, c) over [low, high], the parameters (m + 1,) between."""
    start, stop, points = _native.curve_pieces(
        degree, np.ascontiguousarray(poles), knots, multiplicities, periodic, low, high
    )
    return points, np.append(start, stop[-1])
