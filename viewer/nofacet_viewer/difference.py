"""How far the drawn outline is from the exact one: in numbers, and as a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import nofacet
from nofacet.borders import exact_borders, mesh_borders
from nofacet.outline import MatchedBorders, OutlineError, match, outline_error

MARGIN = 1.5  # pixels: how far the coloured stroke reaches beyond the two outlines


@dataclass(frozen=True, eq=False)
class OutlineDifference:
    """The signed outline error of one picture.

    picture: (height, width, 2) float32: pixels that the drawn outline reaches beyond the exact one (negative: falls
    short), and 1 near the outline, 0 where there is none.
    error: the same in numbers; None where no outline is in the picture.
    """

    camera: nofacet.Camera
    picture: NDArray[np.float32]
    error: OutlineError | None


def outline_difference(
    model: nofacet.Model, mesh: nofacet.Mesh, camera: nofacet.Camera, resolution: tuple[int, int]
) -> OutlineDifference:
    """Compare the outlines on every row and column (nofacet.outline). Takes a while: call it from a thread.

    Raises InputError for a model without surfaces.
    """
    width, height = resolution
    exact, drawn = exact_borders(model, camera, resolution), mesh_borders(mesh, camera, resolution)
    rows, columns = match(exact[0], drawn[0]), match(exact[1], drawn[1])
    (row, x_in_row, row_value), (column, up_column, column_value) = _strokes(rows), _strokes(columns)
    # Columns are the rows of a camera turned by 90 degrees; along them x runs upwards.
    x, y = np.concatenate([x_in_row, column]), np.concatenate([row, height - 1 - up_column])
    value = np.concatenate([row_value, column_value])
    order = np.argsort(np.abs(value), kind="stable")  # where strokes cross, the larger error shows
    order = order[((x >= 0) & (x < width) & (y >= 0) & (y < height))[order]]
    picture = np.zeros((height, width, 2), np.float32)
    picture[y[order], x[order], 0] = value[order]
    picture[y[order], x[order], 1] = 1
    return OutlineDifference(camera, picture, outline_error((rows, columns)))


def _strokes(matched: MatchedBorders) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Scan line, place along it and error of the pixels between two matching borders and MARGIN around them."""
    first = np.floor(np.minimum(matched.exact, matched.drawn) - MARGIN).astype(np.int64)
    last = np.floor(np.maximum(matched.exact, matched.drawn) + MARGIN).astype(np.int64)
    count = last - first + 1
    border = np.repeat(np.arange(len(count)), count)
    within = np.arange(len(border)) - np.repeat(np.cumsum(count) - count, count)
    return matched.line[border], first[border] + within, matched.distance[border]
