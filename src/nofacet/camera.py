"""The camera: where the eye is, what it looks at and how much it sees. No window here."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .extent import support

if TYPE_CHECKING:
    from .model import Model

Vector = tuple[float, float, float]
Projection = Literal["orthographic", "perspective"]

METADATA_KEY = "nofacet:camera"  # where image files carry the camera
DEFAULT_VIEW_ANGLE = 30.0  # degrees
DEFAULT_ZOOM = 0.9  # the model fills this part of the picture

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

    Raises ValueError where the values do not make a camera.
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
        if self.projection not in ("orthographic", "perspective"):
            raise ValueError(f"camera: projection is {self.projection!r}; write 'orthographic' or 'perspective'")
        extent, other = (
            ("view_height", "view_angle") if self.projection == "orthographic" else ("view_angle", "view_height")
        )
        if getattr(self, other) is not None:
            raise ValueError(f"camera: {other} does not belong to {self.projection} projection; give {extent} instead")
        value = _number(extent, getattr(self, extent))
        object.__setattr__(self, extent, value)
        if value <= 0 or (extent == "view_angle" and value >= 180):
            limit = "between 0 and 180 degrees" if extent == "view_angle" else "positive"
            raise ValueError(f"camera: {extent} is {value:g}; it must be {limit}")
        if self.position == self.focal_point:
            raise ValueError("camera: position and focal_point are the same point; move one of them")
        if not any(self.view_up) or _parallel(self.direction, np.array(self.view_up)):
            raise ValueError("camera: view_up is zero or runs along the viewing direction; choose another view_up")

    @property
    def direction(self) -> NDArray[np.float64]:
        """Unit vector (3,) from the eye into the scene."""
        return _unit(np.subtract(self.focal_point, self.position))

    def axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Unit vectors (3,) in the world that point right, up and forward in the picture."""
        forward = self.direction
        right = _unit(np.cross(forward, self.view_up))
        return right, np.cross(right, forward), forward

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
            return cls.from_dict(json.loads(_text_of_picture(path) if picture else path.read_text(encoding="utf-8")))
        except (json.JSONDecodeError, UnicodeDecodeError):
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

        Raises InputError for a model without surfaces, ValueError for a zero direction or a zoom that is not positive.
        """
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
        aspect = resolution[0] / resolution[1]
        if projection == "orthographic":
            return _fit_orthographic(model, forward, up, aspect, zoom)
        return _fit_perspective(model, forward, up, aspect, _number("view_angle", view_angle), zoom)

    def extent_at_unit_depth(self) -> float:
        """Height of the picture in the world: anywhere (orthographic), or at depth 1 (perspective)."""
        if self.projection == "orthographic":
            assert self.view_height is not None
            return self.view_height
        assert self.view_angle is not None
        return 2 * float(np.tan(np.radians(self.view_angle) / 2))


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


def _fit_orthographic(model: Model, forward: NDArray[np.float64], up: Vector, aspect: float, zoom: float) -> Camera:
    right, true_up, _ = Camera("orthographic", (0.0, 0.0, 0.0), _tuple(forward), up, view_height=1.0).axes()
    basis = np.stack([right, true_up, forward])
    middle, size = _box(support(model, [*basis, *-basis]))
    focal_point = middle @ basis
    radius = float(np.linalg.norm(size)) / 2 or 1.0
    height = max(size[1], size[0] / aspect) or 2 * radius  # a single point or line of sight still makes a picture
    return Camera("orthographic", _tuple(focal_point - 2 * radius * forward), _tuple(focal_point), up, height / zoom)


def _fit_perspective(
    model: Model, forward: NDArray[np.float64], up: Vector, aspect: float, view_angle: float, zoom: float
) -> Camera:
    half = float(np.tan(np.radians(view_angle) / 2))
    camera = Camera("perspective", (0.0, 0.0, 0.0), _tuple(forward), up, view_angle=view_angle)
    basis = np.stack(camera.axes())
    slopes = [half * aspect * min(zoom, 1.0), half * min(zoom, 1.0)]
    # The four sides of the view's pyramid each touch the model: |x - eye_x| <= slope * (z - eye_z) for all points.
    sides = [sign * basis[axis] - slope * basis[2] for axis, slope in enumerate(slopes) for sign in (1, -1)]
    reach = support(model, [*basis, *-basis, *sides])
    middle, size = _box(reach[:6])
    radius = float(np.linalg.norm(size)) / 2 or 1.0
    eye = np.zeros(3)  # in the basis, from the middle
    depth_limits = []
    for axis, slope in enumerate(slopes):
        high, low = reach[6 + 2 * axis : 8 + 2 * axis] - (middle[axis], -middle[axis]) + slope * middle[2]
        eye[axis] = (high - low) / 2
        depth_limits.append(-(high + low) / (2 * slope))
    eye[2] = min(*depth_limits, -size[2] / 2 - 1e-3 * radius)  # in front of the model even if it is flat
    focal_point = np.array([eye[0], eye[1], 0.0])
    if zoom > 1:
        view_angle = float(np.degrees(2 * np.arctan(half / zoom)))
    return Camera(
        "perspective", _tuple((eye + middle) @ basis), _tuple((focal_point + middle) @ basis), up, view_angle=view_angle
    )


def _box(reach: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Middle and size (3,), (3,) of a box, from how far it reaches along three directions and their opposites (6,)."""
    return (reach[:3] - reach[3:]) / 2, reach[:3] + reach[3:]


def _parallel(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Whether two vectors are parallel to within 1e-6 radians: then they do not span a picture."""
    return float(np.linalg.norm(np.cross(a, b))) <= 1e-6 * float(np.linalg.norm(a) * np.linalg.norm(b))


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    return vector / np.linalg.norm(vector)


def _tuple(vector: NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in vector)
    return x, y, z


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
        raise ValueError(f"camera: {name} is {'missing' if value is None else repr(value)}; it must be a finite number")
    return float(value)


def _vector(name: str, value: Any) -> Vector:
    if isinstance(value, (str, bytes)) or not hasattr(value, "__len__") or len(value) != 3:
        raise ValueError(f"camera: {name} is {value!r}; it must be three numbers")
    x, y, z = (_number(name, component) for component in value)
    return x, y, z
