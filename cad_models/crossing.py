"""Two free-form bodies passing through each other: a pebble and a bent ring, side by side in a compound, not fused."""

from __future__ import annotations

import cadquery as cq
import numpy as np
from numpy.typing import NDArray

from _shapes import FOLDER, bspline_surface, face, hull, solid, write_step


def pebble() -> cq.Solid:
    """A ball with three soft lobes, closing in a pole at either end."""
    colatitude = np.array([0.0, 0.14, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0]) * np.pi
    angle = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    radius = 22 * (1 + 0.25 * np.sin(colatitude[:, None]) ** 2 * np.cos(3 * angle + 4 * colatitude[:, None]))
    z = 24 * np.cos(colatitude)[:, None] + 0 * angle
    z[0], z[-1] = 24, -24
    reach = np.where(np.isin(np.arange(8), (0, 7)), 0.2, np.sin(colatitude))[:, None] * radius
    rings = np.stack([reach * np.cos(angle), reach * np.sin(angle), z], axis=-1)
    return hull(np.round(rings, 4), (0, 0, 24), (0, 0, -24))


def ring() -> NDArray[np.float64]:
    """(20, 10, 3) control points of a ring of changing thickness, bent up and down along its length."""
    along = np.linspace(0, 2 * np.pi, 20, endpoint=False)[:, None]
    around = np.linspace(0, 2 * np.pi, 10, endpoint=False)
    thick = 6.5 + 2.0 * np.cos(3 * along)
    radius = 27 + thick * np.cos(around)
    z = 0.9 * thick * np.sin(around) + 8 * np.sin(2 * along)
    return np.round(np.stack([radius * np.cos(along), radius * np.sin(along), z], axis=-1), 4)


def build() -> cq.Assembly:
    """The two bodies, each a solid of one face; the ring stands upright, half inside the pebble."""
    hoop = solid(face(bspline_surface(ring(), closed=(True, True))))
    place = cq.Location(cq.Vector(20, 0, 0), cq.Vector(1, 0.2, 0), 75)
    crossing = cq.Assembly(name="crossing")
    crossing.add(pebble(), name="pebble", color=cq.Color(0.80, 0.45, 0.20))
    crossing.add(hoop, name="ring", loc=place, color=cq.Color(0.20, 0.45, 0.75))
    return crossing


if __name__ == "__main__":
    write_step(build(), FOLDER / "crossing.step")
