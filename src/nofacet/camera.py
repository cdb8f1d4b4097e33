"""The camera: where the eye is, what it looks at and how much it sees. No window here."""

from __future__ import annotations

import json
import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .model import Model

Vector = tuple[float, float, float]
Projection = Literal["orthographic", "perspective"]

METADATA_KEY = "nofacet:camera"  # where image files carry the camera
DEFAULT_VIEW_ANGLE = 30.0  # degrees
DEFAULT_ZOOM = 0.9  # the model fills this part of the picture

SIDEWAYS = 1e-9  # |cosine| of the angle between up and an axis below which rounding alone decides its sign

# Standard views: name -> (direction from the eye into the scene, up).
VIEWS: dict[str, tuple[Vector, Vector]] = {
    "front": ((0, 1, 0), (0, 0, 1)),
    "back": ((0, -1, 0), (0, 0, 1)),
    "left": ((1, 0, 0), (0, 0, 1)),
    "right": ((-1, 0, 0), (0, 0, 1)),
    "top": ((0, 0, -1), (0, 1, 0)),
    "bottom": ((0, 0, 1), (0, -1, 0)),
    "iso": ((-1, 1, -1), (0, 0, 1)),
}


@dataclass(frozen=True)
class Camera:
    """A camera in world coordinates (model units).

    The picture's vertical extent is `view_height` (model units, orthographic) or `view_angle` (degrees, perspective);
    its horizontal extent follows from the resolution. Depth is the distance from the eye plane, which holds `position`
    and is perpendicular to the viewing direction.

    Raises ValueError where the values do not make a camera, or position and focal_point are too far apart for a float.
    """

    projection: Projection
    position: Vector
    focal_point: Vector
    view_up: Vector = (0.0, 0.0, 1.0)
    view_height: float | None = None
    view_angle: float | None = None

    def __post_init__(self) -> None:
        for name in ("position", "focal_point", "view_up"):
            object.__setattr__(self, name, _vector(name, getattr(self, name)))
        _check_projection(self.projection)
        extent, other = (
            ("view_height", "view_angle") if self.projection == "orthographic" else ("view_angle", "view_height")
        )
        if getattr(self, other) is not None:
            raise ValueError(f"camera: {other} does not belong to {self.projection} projection; give {extent} instead")
        object.__setattr__(self, extent, _extent(extent, getattr(self, extent)))
        if self.distance == 0:
            raise ValueError("camera: position and focal_point are the same point; move one of them")
        if not math.isfinite(self.distance):
            raise ValueError("camera: position and focal_point are too far apart; move one of them nearer")
        if not any(self.view_up) or _parallel(self.direction, np.array(self.view_up)):
            raise ValueError("camera: view_up is zero or runs along the viewing direction; choose another view_up")

    @property
    def direction(self) -> NDArray[np.float64]:
        """Unit vector (3,) from the eye into the scene."""
        return _unit(np.subtract(self.focal_point, self.position))

    @property
    def distance(self) -> float:
        """From the eye to the focal point, model units."""
        return math.dist(self.focal_point, self.position)

    def axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Unit vectors (3,) in the world that point right, up and forward in the picture."""
        forward = self.direction
        right = _unit(_cross(forward, _scaled(np.array(self.view_up))))
        return right, _cross(right, forward), forward

    def pixel_from_world(self, resolution: tuple[int, int]) -> NDArray[np.float64]:
        """Matrix (4, 4) that takes world points (x, y, z, 1) to homogeneous pixel coordinates (X, Y, Z, W).

        X / W and Y / W are pixels, (0, 0) at the picture's top left corner, pixel centres at + 0.5. Z / W grows with
        depth: it is the depth itself in orthographic projection and -1 / depth in perspective, where W is the depth;
        both keep planes flat. In perspective a point on the eye plane has W = 0, one behind it W < 0.
        """
        width, height = resolution
        right, up, forward = self.axes()
        eye = np.array(self.position)
        eye_from_world = np.eye(4)
        eye_from_world[:3, :3] = right, up, forward
        eye_from_world[:3, 3] = -eye_from_world[:3, :3] @ eye
        scale = height / self.extent_at_unit_depth()
        if self.projection == "orthographic":
            pixel_from_eye = np.diag([scale, -scale, 1.0, 1.0])
            pixel_from_eye[:2, 3] = width / 2, height / 2
        else:
            pixel_from_eye = np.array(
                [[scale, 0, width / 2, 0], [0, -scale, height / 2, 0], [0, 0, 0, -1], [0, 0, 1, 0]], dtype=float
            )
        return pixel_from_eye @ eye_from_world

    def rays(self, resolution: tuple[int, int]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins and directions, each (height, width, 3), of the rays through the pixel centres.

        Origins lie on the eye plane; origin + depth * direction is the world point at that depth (directions have unit
        length along the viewing direction, not in space).
        """
        width, height = resolution
        right, up, forward = self.axes()
        extent = self.extent_at_unit_depth()
        x = extent * (np.arange(width) + 0.5 - width / 2) / height
        y = extent * (height / 2 - np.arange(height) - 0.5) / height
        offset = x[None, :, None] * right + y[:, None, None] * up
        if self.projection == "orthographic":
            return np.array(self.position) + offset, np.broadcast_to(forward, offset.shape)
        return np.broadcast_to(np.array(self.position), offset.shape), forward + offset

    def position_from_depth(self, depth: NDArray[np.float64]) -> NDArray[np.float64]:
        """World points (height, width, 3) at depth (height, width) behind the pixel centres; NaN at infinity."""
        height, width = depth.shape
        origin, direction = self.rays((width, height))
        return origin + np.where(np.isfinite(depth), depth, np.nan)[..., None] * direction

    def to_dict(self) -> dict[str, Any]:
        """The camera file's JSON object."""
        extent = "view_height" if self.projection == "orthographic" else "view_angle"
        result: dict[str, Any] = {"projection": self.projection}
        result.update({name: list(getattr(self, name)) for name in ("position", "focal_point", "view_up")})
        result[extent] = getattr(self, extent)
        return result

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Camera:
        """The camera of a camera file's JSON object. Raises ValueError that names the missing or wrong entry."""
        if not isinstance(values, Mapping):
            raise ValueError('camera: this is not a JSON object; write {"projection": ..., "position": ...}')
        known = ("projection", "position", "focal_point", "view_up", "view_height", "view_angle")
        unknown = [name for name in values if name not in known]
        if unknown:
            raise ValueError(f"camera: unknown entry {unknown[0]!r}; the entries are {', '.join(known)}")
        missing = [name for name in known[:3] if name not in values]
        if missing:
            raise ValueError(f"camera: {missing[0]!r} is missing")
        return cls(**values)

    @classmethod
    def load(cls, path: str | Path) -> Camera:
        """Read a camera from a JSON file, or the camera that a PNG or EXR file of ours was made with.

        Raises ValueError (with the file's name) where there is none in the file, OSError where it cannot be read.
        """
        path = Path(path)
        picture = path.suffix.lower() in (".png", ".exr")
        try:
            return cls.from_dict(json.loads(_text_of_picture(path) if picture else path.read_text("utf-8-sig")))
        except (json.JSONDecodeError, UnicodeDecodeError, RecursionError):
            what = f"the {METADATA_KEY} in its metadata is damaged" if picture else "this is not a JSON camera file"
            raise ValueError(f"{path}: {what}") from None
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None

    @classmethod
    def fit(
        cls,
        model: Model,
        direction: Sequence[float] = (-1.0, 1.0, -0.5),
        projection: Projection = "orthographic",
        resolution: tuple[int, int] = (1920, 1080),
        view_up: Sequence[float] = (0.0, 0.0, 1.0),
        view_angle: float = DEFAULT_VIEW_ANGLE,
        zoom: float = DEFAULT_ZOOM,
    ) -> Camera:
        """The camera that looks along `direction` (from the eye into the scene) and sees the whole model.

        At zoom 1 the model touches the picture's border, 0.5 makes it half that size. Above 1, a perspective camera
        keeps its place and narrows `view_angle` (degrees, vertical), as a zoom lens does. Where `view_up` runs along
        `direction`, +Y, +Z or +X takes its place.

        Raises InputError for a model without surfaces, ValueError for an unknown projection, a zero direction, a zoom
        that is not positive, a resolution that is not two whole numbers of at least 1 or a `view_angle` not between 0
        and 180 degrees.
        """
        from .camera_fit import fit_orthographic, fit_perspective

        _check_projection(projection)
        width, height = check_resolution(resolution)
        zoom = _number("zoom", zoom)
        if zoom <= 0:
            raise ValueError(f"camera: zoom is {zoom:g}; it must be positive")
        forward = np.array(_vector("direction", direction))
        if not forward.any():
            raise ValueError("camera: direction is zero; give a vector such as -1,1,-0.5")
        forward = _unit(forward)
        up = _vector("view_up", view_up)
        up = next(
            u for u in (up, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)) if not _parallel(forward, np.array(u))
        )
        if projection == "orthographic":
            return fit_orthographic(model, forward, up, width / height, zoom)
        return fit_perspective(model, forward, up, width / height, _extent("view_angle", view_angle), zoom)

    def extent_at_unit_depth(self) -> float:
        """Height of the picture in the world: anywhere (orthographic), or at depth 1 (perspective)."""
        if self.projection == "orthographic":
            assert self.view_height is not None
            return self.view_height
        assert self.view_angle is not None
        return 2 * float(np.tan(np.radians(self.view_angle) / 2))

    def extent_at(self, depth: float) -> float:
        """Height of the picture in the world at a depth, model units."""
        return self.extent_at_unit_depth() * (depth if self.projection == "perspective" else 1.0)

    def orbit(self, azimuth: float, elevation: float, axis: Vector = (0.0, 0.0, 1.0)) -> Camera:
        """This camera led round its focal point.

        azimuth: degrees round `axis`, anticlockwise seen from the axis's tip. elevation: degrees up along the picture's
        vertical; it ends where the camera would pass over the axis's tip or foot and turn the world upside down.
        """
        right, up, forward = self.axes()
        pole = _unit(np.array(axis, float))
        side = -1.0 if up @ pole < -SIDEWAYS else 1.0
        # The picture's vertical stays on its side of the pole: up' . pole = up . pole cos e + forward . pole sin e.
        rise, ahead = max(0.0, side * float(up @ pole)), side * float(forward @ pole)
        reach = np.degrees(np.arctan2(rise, -ahead)), np.degrees(np.arctan2(rise, ahead))
        angle = float(np.clip(elevation, -reach[1], reach[0]))
        turn = _rotation(pole, azimuth) @ _rotation(right, -angle)
        position = np.array(self.focal_point) - self.distance * (turn @ forward)
        return replace(self, position=as_vector(position), view_up=as_vector(turn @ up))

    def pan(self, x: float, y: float, resolution: tuple[int, int]) -> Camera:
        """This camera moved so that the focal point's surroundings go x pixels to the right and y down."""
        right, up, _ = self.axes()
        move = (y * up - x * right) * self.extent_at(self.distance) / resolution[1]
        return self._moved(move, move)

    def zoom(self, factor: float, about: Sequence[float] | NDArray[np.float64] | None = None) -> Camera:
        """This camera with the picture `factor` times as large round the world point `about`, which stays in place.

        In perspective the eye comes that much nearer to the point; None: the focal point. Raises ValueError for a
        factor that is not positive, or so large that no camera is left.
        """
        factor = _number("zoom factor", factor)
        if factor <= 0:
            raise ValueError(f"camera: zoom factor is {factor:g}; it must be positive")
        centre = np.array(self.focal_point if about is None else _vector("about", about))
        towards = (1 - 1 / factor) * (centre - self.position), (1 - 1 / factor) * (centre - self.focal_point)
        if self.projection == "perspective":
            return self._moved(*towards)
        assert self.view_height is not None
        along = towards[0] - (towards[0] @ self.direction) * self.direction
        return replace(self._moved(along, along), view_height=self.view_height / factor)

    def centre_on(self, point: Sequence[float] | NDArray[np.float64]) -> Camera:
        """This camera moved sideways until the world point, its new focal point, is in the picture's middle.

        Raises ValueError for a point that is not in front of a perspective camera.
        """
        target = np.array(_vector("point", point))
        depth = float((target - self.position) @ self.direction)
        if self.projection == "orthographic":  # the eye may be anywhere on the line of sight
            depth = self.distance
        elif depth <= 0:
            raise ValueError("camera: the point is behind the eye; it cannot be the picture's middle")
        return replace(self, position=as_vector(target - depth * self.direction), focal_point=as_vector(target))

    def with_projection(self, projection: Projection, view_angle: float = DEFAULT_VIEW_ANGLE) -> Camera:
        """This camera in another projection, in which what is as far away as the focal point keeps its size.

        view_angle: degrees, vertical, for a camera that becomes perspective: its eye moves to where that fits.
        Raises ValueError for an unknown projection or a view angle that is not between 0 and 180.
        """
        _check_projection(projection)
        if projection == self.projection:
            return self
        height = self.extent_at(self.distance)
        if projection == "orthographic":
            return replace(self, projection=projection, view_height=height, view_angle=None)
        distance = height / (2 * float(np.tan(np.radians(_extent("view_angle", view_angle)) / 2)))
        position = as_vector(np.array(self.focal_point) - distance * self.direction)
        return replace(self, projection=projection, position=position, view_height=None, view_angle=view_angle)

    def point_at(
        self, pixel: tuple[float, float], resolution: tuple[int, int], depth: float | None = None
    ) -> NDArray[np.float64]:
        """World point (3,) under a pixel position (x, y), at a depth; None: the focal point's."""
        depth = self.distance if depth is None else depth
        right, up, forward = self.axes()
        width, height = resolution
        x, y = (pixel[0] - width / 2) / height, (height / 2 - pixel[1]) / height
        return np.array(self.position) + self.extent_at(depth) * (x * right + y * up) + depth * forward

    def _moved(self, position: NDArray[np.float64], focal_point: NDArray[np.float64]) -> Camera:
        """This camera with both points moved."""
        return replace(
            self,
            position=as_vector(np.array(self.position) + position),
            focal_point=as_vector(np.array(self.focal_point) + focal_point),
        )


def check_resolution(resolution: Any) -> tuple[int, int]:
    """Width and height in pixels. Raises ValueError where they are not two whole numbers of at least 1."""
    try:
        width, height = map(operator.index, resolution)
    except (TypeError, ValueError):
        raise ValueError(f"resolution {resolution!r}: give two whole numbers, width and height") from None
    if width < 1 or height < 1:
        raise ValueError(f"resolution {width} x {height}: give a width and height of at least 1")
    return width, height


def _text_of_picture(path: Path) -> str:
    """The camera file in a picture's metadata."""
    from . import image

    try:
        text = image.read_attribute(path, METADATA_KEY)
    except OSError:
        path.open("rb").close()  # knows better what is wrong where there is no such file
        raise ValueError("this is not a whole picture") from None
    if text is None:
        raise ValueError(f"no {METADATA_KEY} in its metadata; only pictures made by nofacet carry one")
    return text


def _parallel(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Whether two vectors are parallel to within 1e-6 radians: then they do not span a picture."""
    a, b = _scaled(a), _scaled(b)
    return float(np.linalg.norm(_cross(a, b))) <= 1e-6 * float(np.linalg.norm(a) * np.linalg.norm(b))


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    vector = _scaled(vector)
    return vector / np.linalg.norm(vector)


def _scaled(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vector over a power of two that makes its squares neither overflow nor vanish; nothing is rounded."""
    return np.ldexp(vector, -math.frexp(float(np.abs(vector).max()))[1])


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of two vectors (3,); numpy's own is made for many and takes ten times as long for one."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _rotation(axis: NDArray[np.float64], degrees: float) -> NDArray[np.float64]:
    """Matrix (3, 3) that turns anticlockwise round a unit vector (Rodrigues' formula)."""
    angle = np.radians(degrees)
    x, y, z = axis
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def as_vector(vector: NDArray[np.float64]) -> Vector:
    """An array (3,) as a camera keeps it."""
    x, y, z = (float(value) for value in vector)
    return x, y, z


def _check_projection(projection: Any) -> None:
    if projection not in ("orthographic", "perspective"):
        raise ValueError(f"camera: projection is {projection!r}; write 'orthographic' or 'perspective'")


def _extent(name: str, value: Any) -> float:
    """A view_height or view_angle that makes a picture."""
    value = _number(name, value)
    if value <= 0 or (name == "view_angle" and value >= 180):
        limit = "between 0 and 180 degrees" if name == "view_angle" else "positive"
        raise ValueError(f"camera: {name} is {value:g}; it must be {limit}")
    return value


def _number(name: str, value: Any) -> float:
    number = math.nan
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"camera: {name} is {'missing' if value is None else repr(value)}; it must be a finite number")
    return number


def _vector(name: str, value: Any) -> Vector:
    if isinstance(value, (str, bytes)) or not hasattr(value, "__len__") or len(value) != 3:
        raise ValueError(f"camera: {name} is {value!r}; it must be three numbers")
    x, y, z = (_number(name, component) for component in value)
    return x, y, z
