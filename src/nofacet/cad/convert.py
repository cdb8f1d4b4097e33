"""A shape to a Model: every distinct face once, every placed face in OpenCascade's order."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..model import DEFAULT_COLOR, Model
from . import stream as brep
from .bodies import Bodies, BodyFinder, are_closed
from .geometry import SURFACES
from .loops import Loops, merged, without
from .orientation import composed
from .patches import PatchBuilder, are_exact
from .stream import REVERSED, Stream
from .tables import Index, distinct, expand_runs, marked, offsets_of
from .trims import Trims, trim

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape


def convert(shape: TopoDS_Shape, source: str) -> Model:
    """Convert every face of shape, in the order of TopExp::MapShapes(shape, TopAbs_FACE).

    source: what warnings and the model call it. Colours are the default, names and tree empty. A face that cannot be
    converted has no patches and a warning that names its index and the reason. Raises InputError on a null shape.
    """
    with _garbage_collection_paused():
        stream = brep.read(shape)
        faces = placed_faces(stream)
        first, definition = distinct(faces.shape)
        conversion = _Conversion(shape, stream, faces.shape[first], first)
        return _assemble(source, stream, faces, definition, conversion)


@contextmanager
def _garbage_collection_paused() -> Iterator[None]:
    """Conversion makes many tuples and no cycles: looking for cycles costs a third of its time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@dataclass(frozen=True)
class PlacedFaces:
    """Faces of the stream where they stand in the shape: index into shapes, number of the location, orientation, each
    (F,); and the bodies they bound."""

    shape: Index
    location: Index
    orientation: NDArray[np.uint8]
    bodies: Bodies


def placed_faces(stream: Stream) -> PlacedFaces:
    """Faces in the order of TopExp::MapShapes: depth first, each (shape, location) once, first orientation kept."""
    below = stream.children
    holds_faces = stream.kinds <= brep.SHELL
    orientation, shape, location = (np.array([value]) for value in stream.root)
    finder, body = BodyFinder(), np.array([-1])
    while (holds := holds_faces[shape]).any():
        body = finder.enter(stream.kinds[shape], shape, location, body)
        # each such shape makes way for its children, a face stays, anything else has no faces
        count = np.where(holds, np.diff(below.offsets)[shape], stream.kinds[shape] == brep.FACE)
        parent, k = expand_runs(np.where(holds, below.offsets[shape], 0), count)
        inner = np.flatnonzero(holds[parent])
        k, outer = k[inner], parent[inner]
        orientations, shapes, locations = orientation[parent], shape[parent], location[parent]
        orientations[inner] = composed(orientation[outer], below.orientation[k])
        shapes[inner] = below.shape[k]
        locations[inner] = stream.locations.compose_all(location[outer], below.location[k])
        orientation, shape, location, body = orientations, shapes, locations, body[parent]
    body = finder.enter(stream.kinds[shape], shape, location, body)
    place = shape * (location.max(initial=0) + 1) + location
    faces = np.flatnonzero(stream.kinds[shape] == brep.FACE)
    first, number = distinct(place[faces])
    bodies = finder.bodies(body[faces], number, orientation[faces])
    first = faces[first]
    return PlacedFaces(shape[first], location[first], orientation[first].astype(np.uint8), bodies)


WANTED = 1e-9  # of a face's size: an approximated surface that misses this is named in a warning


class _Conversion:
    """The face definitions (D,) in the order of their first placed faces, and what they come to."""

    def __init__(self, shape: TopoDS_Shape, stream: Stream, definitions: Index, first_face: Index) -> None:
        """definitions: (D,) shape indices; first_face: (D,), the placed face that messages name."""
        self.shape = shape
        self.stream = stream
        self.definitions = definitions
        self.first_face = first_face
        self.builder = PatchBuilder()
        self.errors = np.full(len(definitions), np.nan)
        self.trimmed = np.zeros(len(definitions), np.uint8)
        self.problems: dict[int, str] = {}
        self.inexact: dict[int, str] = {}
        self.surface = stream.faces.surface[definitions]
        kinds = stream.surfaces.kind[self.surface].tolist()
        self.surface_type = [SURFACES[kind] or "triangles" for kind in kinds]
        self._loops: list[Loops] = []
        self._add_surfaces(np.flatnonzero(self.surface > 0))
        self._add_triangles(np.flatnonzero(self.surface == 0))
        self.loops = self._loops[0] if len(self._loops) == 1 else merged(self._loops)

    def _add_surfaces(self, own: Index) -> None:
        trims = trim(self.stream, self.definitions[own])
        self._take(own, trims)
        good = np.ones(len(own), bool)
        good[[*trims.problems, *trims.incomplete]] = False
        exact = are_exact(self.stream.surfaces, self.surface[own])
        usual = np.flatnonzero(good & exact)
        self.builder.add(own[usual], self.stream.surfaces, self.surface[own[usual]], trims.boxes[usual])
        boxes = {int(own[k]): trims.boxes[k] for k in np.flatnonzero(good & ~exact)}
        for k in own[trims.incomplete].tolist():
            boxes |= self._repaired(k)
        for definition, box in sorted(boxes.items()):
            self._add_single(definition, box)

    def _take(self, own: Index, trims: Trims) -> None:
        """Keep the trims of definitions `own`."""
        self.trimmed[own] = ~trims.whole
        for k, problem in trims.problems.items():
            self._fail(int(own[k]), problem)
        loops = trims.loops
        self._loops.append(Loops(own[loops.face], loops.loop_offsets, loops.segment_offsets, loops.points, loops.edge))

    def _fail(self, definition: int, problem: str) -> None:
        self.problems[definition] = problem
        self.trimmed[definition] = 0

    def _repaired(self, definition: int) -> dict[int, NDArray[np.float64]]:
        """Trim a definition after building the curves it lacks; its box, nothing if that is in vain."""
        from .repair import face_with_pcurves

        repaired = brep.read(face_with_pcurves(self.shape, int(self.first_face[definition])))
        trims = trim(repaired, np.array([repaired.root[1]]))
        trims.loops.edge[:] = -1
        if trims.incomplete:
            trims.problems[0] = "an edge has no curve in the surface's parameters"
        self._take(np.array([definition]), trims)
        return {} if trims.problems else {definition: trims.boxes[0]}

    def _add_single(self, definition: int, box: NDArray[np.float64]) -> None:
        """Add a definition whose surface may have to be approximated."""
        which = self.surface[definition : definition + 1]
        own, boxes = np.array([definition]), box[None]
        if are_exact(self.stream.surfaces, which)[0]:
            self.builder.add(own, self.stream.surfaces, which, boxes)
            return
        from .approximate import approximate

        try:
            surfaces, error, size = approximate(self.shape, int(self.first_face[definition]), tuple(box))
        except ValueError as problem:
            self._fail(definition, str(problem))
            self._loops = [without(loops, own) for loops in self._loops]
            return
        self.errors[definition] = error
        if error > WANTED * size:
            self.inexact[definition] = f"its surface is approximated, and only to within {error:.1e} mm"
        self.builder.add(own, surfaces, np.array([1]), boxes)

    def _add_triangles(self, own: Index) -> None:
        """Faces given as triangles only: triangle k is half of the parallelogram over (0, 1) x (2 k, 2 k + 1)."""
        for definition in own.tolist():
            self.trimmed[definition] = 1
            number = int(self.stream.faces.triangulation[self.definitions[definition]])
            if not number:
                self.problems[definition] = "it has neither a surface nor triangles"
                continue
            nodes, triangles, _ = self.stream.triangulations[number]
            a, b, c = (nodes[triangles[:, k]] for k in range(3))
            points = np.ones((len(triangles), 2, 2, 4))
            points[:, 0, 0, :3], points[:, 1, 0, :3], points[:, 0, 1, :3], points[:, 1, 1, :3] = a, b, c, b + c - a
            v = 2.0 * np.arange(len(triangles))
            owner = np.full(len(triangles), definition)
            self.builder.add_patches(points, owner, np.stack([0 * v, 0 * v + 1, v, v + 1], axis=1))
            corners = np.ones((len(triangles), 3, 2, 3))
            corners[..., 0] = [(0, 1), (1, 0), (0, 0)]
            corners[..., 1] = v[:, None, None] + np.array([(0, 0), (0, 1), (1, 0)])
            count = len(triangles)
            self._loops.append(
                Loops(
                    owner,
                    3 * np.arange(count + 1),
                    2 * np.arange(3 * count + 1),
                    corners.reshape(-1, 3),
                    np.full(3 * count, -1, np.int32),
                )
            )

    def warnings(self, faces: PlacedFaces) -> list[str]:
        """A line for each definition that is not drawn, or not as exactly as promised, and one for all triangles."""
        result = []
        for definition, problem in sorted(self.problems.items()):
            kind = "" if self.surface_type[definition] == "triangles" else f" ({self.surface_type[definition]})"
            result.append(f"face {self.first_face[definition]}{kind} is not drawn: {problem}")
        for definition, problem in sorted(self.inexact.items()):
            result.append(f"face {self.first_face[definition]} ({self.surface_type[definition]}): {problem}")
        drawn_shapes = self.definitions[(self.surface == 0) & (self.trimmed == 1)]
        has_triangles = drawn_shapes[self.stream.faces.triangulation[drawn_shapes] > 0]
        drawn = np.isin(faces.shape, has_triangles).sum()
        if drawn:
            result.append(f"{drawn} faces are given as triangles only and are drawn as those triangles")
        return result


def _assemble(source: str, stream: Stream, faces: PlacedFaces, definition: Index, conversion: _Conversion) -> Model:
    """definition: (F,), of each placed face."""
    placements, face_placement = _placements(stream, faces)
    mirrored = (np.linalg.det(placements[:, :3, :3]) < 0)[face_placement]
    backwards = faces.orientation == REVERSED
    bodies = faces.bodies
    count = len(faces.shape)
    loops = conversion.loops
    return Model(
        source=source,
        groups=conversion.builder.groups(),
        surface_type=conversion.surface_type,
        trimmed=conversion.trimmed,
        definition_loops=offsets_of(np.bincount(loops.face, minlength=len(conversion.definitions))),
        loop_offsets=loops.loop_offsets,
        segment_offsets=loops.segment_offsets,
        segment_points=loops.points,
        segment_edge=loops.edge,
        conversion_error=conversion.errors,
        face_definition=definition.astype(np.int32),
        face_placement=face_placement,
        placements=placements,
        face_outward=np.where(mirrored ^ backwards, -1, 1).astype(np.int8),
        face_color=np.tile(np.array(DEFAULT_COLOR, np.float32), (count, 1)),
        face_name=[""] * count,
        body_offsets=bodies.offsets,
        body_face=bodies.face.astype(np.int32),
        body_face_outward=np.where(mirrored[bodies.face] ^ bodies.reversed, -1, 1).astype(np.int8),
        body_closed=_closed(stream, conversion, bodies, definition[bodies.face]),
        warnings=conversion.warnings(faces),
    )


def _closed(stream: Stream, conversion: _Conversion, bodies: Bodies, definition: Index) -> NDArray[np.uint8]:
    """Whether each body (B,) is closed, and all of its faces are drawn; definition: (N,), of the faces it uses."""
    closed = are_closed(stream, bodies.shape)
    body = np.repeat(np.arange(len(closed)), np.diff(bodies.offsets))
    missing = marked(len(conversion.definitions), list(conversion.problems))
    closed[body[missing[definition]]] = False
    return closed.astype(np.uint8)


def _placements(stream: Stream, faces: PlacedFaces) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Distinct matrices (K, 4, 4), world from definition, and the index (F,) of each face's."""
    locations = stream.locations.compose_all(faces.location, stream.faces.location[faces.shape])
    first, which = distinct(locations)
    matrices = np.array([stream.locations.matrix(location) for location in locations[first].tolist()])
    return matrices.reshape(-1, 4, 4), which.astype(np.int32)
