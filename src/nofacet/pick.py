"""What is known of the surface point under a pixel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .camera import Camera, Vector, check_resolution
from .evaluate import evaluate
from .model import Model
from .render import render
from .section import Section

LABEL_WIDTH = 12  # of a fact's line, in characters
_ROUNDING = 1e-12  # a number this much smaller than those beside it is rounding; in texts only


@dataclass(frozen=True)
class Pick:
    """A point on a face, with what the model knows of the face, or on the cap of a section plane. Lengths in model
    units, mm for STEP files.

    face: index of the face, -2 - k on the cap of section plane k, of which only surface_type ("plane"), position,
        normal and depth are known; name: the face's own name, "" without one.
    part: names of the assembly's nodes down to the one that holds the face, "" in a model without a tree;
        node: index of that node in Model.tree, -1 without one.
    surface_type: as in Model.surface_type.
    uv: OpenCascade's parameters on the face.
    position: on the exact surface, world.
    normal: unit, world, out of the material, so turned away from the eye where a surface is seen from behind.
    principal_curvatures: the larger first, 1 / model units, positive where the surface bends towards the normal; NaN
        at poles. principal_directions: unit, world. Both as in SurfacePoints.
    depth: distance from the camera's eye plane.
    conversion_error: of the face's patches from OpenCascade's surface, at most; NaN if not measured.
    trim_deviation: of the face's edges in space from the curves that trim it, at most; NaN if not measured.
    """

    face: int
    name: str
    part: tuple[str, ...]
    node: int
    surface_type: str
    uv: tuple[float, float]
    position: Vector
    normal: Vector
    principal_curvatures: tuple[float, float]
    principal_directions: tuple[Vector, Vector]
    depth: float
    conversion_error: float
    trim_deviation: float

    @property
    def section(self) -> int | None:
        """Index of the section plane on whose cap the point is; None on a face."""
        return -2 - self.face if self.face < -1 else None

    @property
    def radii_of_curvature(self) -> tuple[float, float]:
        """Reciprocals of the principal curvatures, model units: signed as they are, inf (or, by rounding, huge) where
        the surface does not bend."""
        first, second = (1 / k if k else math.inf for k in self.principal_curvatures)
        return first, second

    @property
    def title(self) -> tuple[str, ...]:
        """For people: what was picked, and in a line of its own the part that it is in."""
        if self.section is not None:
            return ("cap of a section plane",)
        face = f"face {self.face}" + (f" {self.name}" if self.name else "") + f", {self.surface_type}"
        return (face, " / ".join(name or "unnamed" for name in self.part)) if self.part else (face,)

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """For people: what each fact is called, and the fact."""
        point = (
            ("point", lengths_text(self.position)),
            ("normal", ", ".join(f"{round(value, 6) + 0.0:.6f}" for value in self.normal)),
        )
        if self.section is not None:
            return point
        return (
            ("(u, v)", f"{self.uv[0]:.9g}, {self.uv[1]:.9g}"),
            *point,
            ("curvature", ", ".join(self.bend_texts)),
            ("conversion", _error_text(self.conversion_error)),
            ("trimming", _error_text(self.trim_deviation)),
        )

    def __str__(self) -> str:
        """A line for each fact, for people."""
        return "\n".join([*self.title, *(f"{label:<{LABEL_WIDTH}}{text}" for label, text in self.facts)])

    @property
    def bend_texts(self) -> tuple[str, str]:
        """The principal curvatures for people: radius and sense, or flat where only rounding is left."""
        reach = max(math.hypot(*self.position), 1e-300)
        rounding = _ROUNDING * max(1 / reach, *(abs(k) for k in self.principal_curvatures))
        first, second = (_bend_text(k, rounding) for k in self.principal_curvatures)
        return first, second


def _bend_text(curvature: float, rounding: float) -> str:
    if math.isnan(curvature):
        return "not defined"
    if abs(curvature) <= rounding:
        return "flat"
    return f"radius {1 / abs(curvature):.6g} mm {'concave' if curvature > 0 else 'convex'}"


def pick(
    model: Model,
    camera: Camera,
    resolution: tuple[int, int],
    x: float,
    y: float,
    sections: Sequence[Section] = (),
) -> Pick | None:
    """The facts of the point that `model` shows at a place in a picture; None where it shows background.

    resolution: width and height of the picture in pixels. x, y: a place in it, in pixels from its top left corner and
    not only whole ones: the centre of pixel (i, j) is (i + 0.5, j + 0.5). It may be outside the picture.
    sections: planes that cut the model, as in render; what they take away is not picked, their caps are.

    The renderer solves the ray through that place. Raises ValueError for a place that is not finite or a picture
    without pixels, InputError for a model with nothing to draw.
    """
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"pick at ({x}, {y}): give finite pixel coordinates")
    eye = _camera_of_pixel(camera, resolution, x, y)
    buffers = ("face", "uv", "depth") if sections else ("face", "uv")
    frame = render(model, eye, (1, 1), samples=1, threads=1, buffers=buffers, sections=sections)
    face = int(frame.face[0, 0])
    if face == -1:
        return None
    if face < -1:
        position = eye.point_at((0.5, 0.5), (1, 1), float(frame.depth[0, 0]))
        return _on_cap(face, position, sections[-2 - face], camera)
    point = evaluate(model, [face], frame.uv[0])
    node = _node_of(model, face)
    definition = model.face_definition[face]
    position = point.position[0]
    return Pick(
        face=face,
        name=model.face_name[face],
        part=_path(model, node),
        node=node,
        surface_type=model.surface_type[definition],
        uv=(float(frame.uv[0, 0, 0]), float(frame.uv[0, 0, 1])),
        position=_vector(position),
        normal=_vector(point.normal[0]),
        principal_curvatures=(float(point.principal_curvatures[0, 0]), float(point.principal_curvatures[0, 1])),
        principal_directions=(
            _vector(point.principal_directions[0, 0]),
            _vector(point.principal_directions[0, 1]),
        ),
        depth=float((position - camera.position) @ camera.direction),
        conversion_error=float(model.conversion_error[definition]),
        trim_deviation=model.trim_deviation(face),
    )


def _on_cap(face: int, position: np.ndarray, section: Section, camera: Camera) -> Pick:
    normal = np.array(section.normal)
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    return Pick(
        face=face,
        name="",
        part=(),
        node=-1,
        surface_type="plane",
        uv=(math.nan, math.nan),
        position=_vector(position),
        normal=section.normal,
        principal_curvatures=(0.0, 0.0),
        principal_directions=(_vector(across), _vector(np.cross(normal, across))),
        depth=float((position - camera.position) @ camera.direction),
        conversion_error=math.nan,
        trim_deviation=math.nan,
    )


def _camera_of_pixel(camera: Camera, resolution: tuple[int, int], x: float, y: float) -> Camera:
    """The camera whose picture is one pixel of the given camera's, the one around (x, y).

    In perspective it looks along that pixel's ray, so its pixel is a square across the ray.
    """
    width, height = check_resolution(resolution)
    right, up, forward = camera.axes()
    pixel = camera.extent_at_unit_depth() / height
    offset = pixel * ((x - width / 2) * right + (height / 2 - y) * up)
    if camera.projection == "orthographic":
        position, focal_point = (_vector(np.add(p, offset)) for p in (camera.position, camera.focal_point))
        return replace(camera, position=position, focal_point=focal_point, view_height=pixel)
    distance = float(np.linalg.norm(np.subtract(camera.focal_point, camera.position)))
    focal_point = _vector(np.add(camera.position, distance * (forward + offset)))
    angle = math.degrees(2 * math.atan(pixel / 2))
    return replace(camera, focal_point=focal_point, view_up=_vector(up), view_angle=angle)


def _node_of(model: Model, face: int) -> int:
    """The last node of the tree that holds the face, -1 without one."""
    return next((k for k in reversed(range(len(model.tree))) if (model.tree[k].faces == face).any()), -1)


def _path(model: Model, node: int) -> tuple[str, ...]:
    """Names from the tree's root down to a node."""
    names: list[str] = []
    while node >= 0:
        names.append(model.tree[node].name)
        node = model.tree[node].parent
    return tuple(reversed(names))


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def lengths_text(values: Vector) -> str:
    """Three lengths for people."""
    rounding = _ROUNDING * max(abs(value) for value in values)
    return ", ".join(f"{value if abs(value) > rounding else 0.0:.9g}" for value in values) + " mm"


def _error_text(error: float) -> str:
    return "not measured" if math.isnan(error) else f"within {error:.1e} mm"
