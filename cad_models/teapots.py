"""72 teapots of 32 patches, 2,304 in all, deformed together as one block (the survey's figure 9 a).

The block of 6 x 4 x 3 pots stands in a lattice of 4 x 4 x 4 points; moving those points arches and twists the space
inside (free-form deformation: Sederberg and Parry 1986, DOI 10.1145/15886.15903), and the pots' control points go
along. So each pot is its own free-form shape, not an instance. The patches of a part are one B-spline face with triple
knots: a span is a patch, and nothing is approximated.
"""

from __future__ import annotations

import cadquery as cq
import numpy as np
from numpy.typing import NDArray

from _shapes import FOLDER, bspline_surface, compound, face, write_step
from teapot import patches

COUNTS = np.array([6, 4, 3])
PITCH = np.array([7.4, 5.0, 4.4])
POT_LOW, POT_HIGH = np.array([-3.0, -2.0, 0.0]), np.array([3.434, 2.0, 3.15])  # a pot's bounding box
ARCH, TWIST = np.radians(110), np.radians(70)  # turn of the block's ends against each other


def parts() -> list[NDArray[np.float64]]:
    """Control nets of body, handle, spout and lid, (m, n, 3), m and n one more than three times the patches."""
    grids = [(4, nets) for nets in (patches()["body"], patches()["lid"])]
    grids += [(2, nets) for nets in (patches()["handle"], patches()["spout"])]
    return [joined([nets[i : i + across] for i in range(0, len(nets), across)]) for across, nets in grids]


def joined(rows: list[list[NDArray[np.float64]]]) -> NDArray[np.float64]:
    """One net of the 4 x 4 nets in `rows`, common borders once."""
    strips = [np.concatenate([net[:, min(j, 1) :] for j, net in enumerate(row)], axis=1) for row in rows]
    return np.concatenate([strip[min(i, 1) :] for i, strip in enumerate(strips)])


def lattice() -> NDArray[np.float64]:
    """(4, 4, 4, 3) lattice points in mm: the block as an arch, its ends twisted, its middle wider."""
    size = (COUNTS - 1) * PITCH + POT_HIGH - POT_LOW
    share = np.stack(np.meshgrid(*[np.linspace(0, 1, 4)] * 3, indexing="ij"), axis=-1) - 0.5
    bend, turn = ARCH * share[..., 0], TWIST * share[..., 0]
    wide = 1.35 - 1.4 * share[..., 0] ** 2
    y, z = share[..., 1] * size[1] * wide, share[..., 2] * size[2] * wide
    y, z = y * np.cos(turn) - z * np.sin(turn), y * np.sin(turn) + z * np.cos(turn)
    radius = size[0] / ARCH + z
    return np.stack([radius * np.sin(bend), y, radius * np.cos(bend)], axis=-1)


def deformed(
    points: NDArray[np.float64], place: NDArray[np.int64], points_to: NDArray[np.float64]
) -> NDArray[np.float64]:
    """A pot's points at `place` in the block, carried along by the lattice `points_to`, in mm."""
    share = (points - POT_LOW + place * PITCH) / ((COUNTS - 1) * PITCH + POT_HIGH - POT_LOW)
    i = np.arange(4)
    weights = np.array([1, 3, 3, 1]) * share[..., None] ** i * (1 - share[..., None]) ** (3 - i)
    moved = np.einsum("...i,...j,...k,ijkc->...c", *np.moveaxis(weights, -2, 0), points_to)
    return np.round(moved, 3)


def build() -> cq.Assembly:
    """Four free faces a pot; one compound and colour for each slice of 12 pots."""
    nets, points_to = parts(), lattice()
    array = cq.Assembly(name="teapots")
    for x in range(COUNTS[0]):
        faces = []
        for y, z in np.ndindex(*COUNTS[1:]):
            for net in nets:
                surface = bspline_surface(deformed(net, np.array([x, y, z]), points_to), multiplicity=3)
                faces.append(cq.Face(face(surface).wrapped.Reversed()))
        share = x / (COUNTS[0] - 1)
        color = cq.Color(0.25 + 0.60 * share, 0.55, 0.80 - 0.55 * share)
        array.add(compound(faces), name=f"slice_{x + 1}", color=color)
    return array


if __name__ == "__main__":
    write_step(build(), FOLDER / "teapots.step")
