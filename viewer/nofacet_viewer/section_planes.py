"""Section planes as the user handles them: moved along their normal, tilted, flipped, switched off. No window here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

import nofacet
from nofacet.camera import Vector, as_vector
from nofacet.extent import bounding_box

MOST_TILT = 90.0  # degrees
AXES: dict[str, Vector] = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class Bounds:
    """A model's box, world."""

    low: Vector
    high: Vector

    @classmethod
    def of(cls, model: nofacet.Model) -> Bounds:
        """Raises InputError for a model without surfaces."""
        low, high = bounding_box(model)
        return cls(as_vector(low), as_vector(high))

    @property
    def middle(self) -> Vector:
        return as_vector(np.add(self.low, self.high) / 2)

    def reach(self, normal: Vector) -> float:
        """How far the box goes from its middle along a unit vector, model units."""
        return float(np.abs(normal) @ np.subtract(self.high, self.low)) / 2


@dataclass(frozen=True)
class SectionPlane:
    """A plane through `origin`, at right angles to `axis` until it is tilted.

    axis: unit. tilts: degrees, MOST_TILT at most, towards two directions across the axis. flipped: the other side is
    cut away. enabled: it cuts.
    """

    origin: Vector
    axis: Vector
    tilts: tuple[float, float] = (0.0, 0.0)
    flipped: bool = False
    enabled: bool = True

    @property
    def normal(self) -> Vector:
        """Unit, into what is cut away."""
        first, second = _across(self.axis)
        a, b = np.radians(self.tilts)
        normal = np.array(self.axis)
        if a or b:  # an axis stays what it is, to the last bit
            normal = np.sin(a) * first + np.cos(a) * (np.sin(b) * second + np.cos(b) * normal)
        return as_vector(-normal if self.flipped else normal)

    @property
    def section(self) -> nofacet.Section:
        return nofacet.Section(self.origin, self.normal)

    def distance(self, point: Vector) -> float:
        """From a point to the plane, along its normal, model units."""
        return float(np.subtract(self.origin, point) @ self.normal)

    def at_distance(self, distance: float, point: Vector) -> SectionPlane:
        """Moved along its normal to where it has that distance from a point."""
        move = (distance - self.distance(point)) * np.array(self.normal)
        return replace(self, origin=as_vector(np.add(self.origin, move)))


class SectionPlanes:
    """The planes that the user has made, in their order. They are replaced, never changed."""

    def __init__(self, sections: Sequence[nofacet.Section] = ()) -> None:
        self.planes = [SectionPlane(section.origin, section.normal) for section in sections]

    @property
    def sections(self) -> tuple[nofacet.Section, ...]:
        """Those that cut."""
        return tuple(plane.section for plane in self.planes if plane.enabled)

    def add(self, origin: Vector, axis: Vector) -> None:
        """Cut away what lies beyond a point along a unit vector."""
        self.planes.append(SectionPlane(origin, axis))

    def add_through_middle(self, bounds: Bounds, axis: Vector, direction: Sequence[float] | np.ndarray) -> None:
        """Cut at right angles to an axis; what is nearer to an eye that looks along `direction` is cut away."""
        flipped = float(np.dot(axis, direction)) > 0
        self.planes.append(SectionPlane(bounds.middle, axis, flipped=flipped))


def _across(axis: Vector) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors that make a right-handed frame with an axis: of X they are Y and Z, and so on."""
    normal = np.array(axis)
    next_axis = np.eye(3)[(int(np.abs(normal).argmax()) + 1) % 3]
    first = next_axis - (next_axis @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)
