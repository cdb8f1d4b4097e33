"""A shape to a Model: every distinct face once, every placed face in OpenCascade's order."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..model import DEFAULT_COLOR, Model
from . import stream as brep
from .loops import Loop
from .stream import EXTERNAL, INTERNAL, REVERSED, Face, Location, Stream, Surface, multiply
from .surfaces import PatchBuilder, is_exact
from .trims import MissingPCurve, Trim, Trimmer, matrix_of

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
        conversion = _Conversion(shape, stream)
        definition_of: dict[int, int] = {}
        for index, face in enumerate(faces):
            if face.shape not in definition_of:
                definition_of[face.shape] = len(definition_of)
                conversion.add(face.shape, index)
        return _assemble(source, stream, faces, definition_of, conversion)


@contextmanager
def _garbage_collection_paused() -> Iterator[None]:
    """Conversion makes hundreds of thousands of tuples and no cycles: looking for cycles costs a third of its time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@dataclass(frozen=True, slots=True)
class PlacedFace:
    """A face of the stream (index into shapes) where it stands in the shape."""

    shape: int
    location: Location
    orientation: int


def placed_faces(stream: Stream) -> list[PlacedFace]:
    """Faces in the order of TopExp::MapShapes: depth first, each (shape, location) once, first orientation kept."""
    faces: dict[tuple[int, Location], PlacedFace] = {}

    def walk(orientation: int, shape: int, location: Location) -> None:
        kind = stream.kinds[shape]
        if kind == brep.FACE:
            faces.setdefault((shape, location), PlacedFace(shape, location, orientation))
        elif kind in brep.SOLID_LIKE:
            for below, child, place in stream.children[shape]:
                walk(
                    _composed(orientation, below),
                    child,
                    multiply(location, stream.locations[place]) if place else location,
                )

    orientation, shape, place = stream.root
    walk(orientation, shape, stream.locations[place])
    return list(faces.values())


def _composed(outer: int, inner: int) -> int:
    """TopAbs::Compose: a reversed parent flips, an internal or external one passes its own on."""
    if outer in (INTERNAL, EXTERNAL):
        return outer
    return inner if outer != REVERSED or inner in (INTERNAL, EXTERNAL) else 1 - inner


@dataclass
class _Conversion:
    """Converts face definitions one by one and keeps what they come to."""

    shape: TopoDS_Shape
    stream: Stream
    builder: PatchBuilder = field(default_factory=PatchBuilder)
    surface_type: list[str] = field(default_factory=list)
    trimmed: list[int] = field(default_factory=list)
    loops: list[list[Loop]] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    triangulated: int = 0

    def __post_init__(self) -> None:
        self.trimmer = Trimmer(self.stream)

    def add(self, shape: int, index: int) -> None:
        """Convert stream.shapes[shape] as the next definition; index is its first placed face, for messages."""
        face: Face = self.stream.shapes[shape]
        self.errors.append(float("nan"))
        if not face.surface:
            self._add_triangles(face, index)
            return
        surface: Surface = self.stream.surfaces[face.surface]
        self.surface_type.append(surface.kind)
        self.trimmed.append(0)
        self.loops.append([])
        try:
            trim = self._trim(shape, index)
            definition = len(self.surface_type) - 1
            if is_exact(surface):
                self.builder.add(definition, surface, trim.box)
            else:
                self._approximate(definition, index, trim)
        except ValueError as problem:
            self.warnings.append(f"face {index} ({surface.kind}) is not drawn: {problem}")
            return
        self.trimmed[-1] = 0 if trim.whole else 1
        self.loops[-1] = trim.loops

    def _trim(self, shape: int, index: int) -> Trim:
        try:
            return self.trimmer.trim(shape)
        except MissingPCurve:
            from .repair import face_with_pcurves

            repaired = brep.read(face_with_pcurves(self.shape, index))
            trim = Trimmer(repaired).trim(repaired.root[1])
            bare = [[(points, -1) for points, _ in loop] for loop in trim.loops]
            return Trim(bare, trim.box, trim.whole)

    def _approximate(self, definition: int, index: int, trim: Trim) -> None:
        from .approximate import approximate

        surface, error = approximate(self.shape, index, trim.box)
        self.builder.add(definition, surface, trim.box)
        self.errors[definition] = error

    def _add_triangles(self, face: Face, index: int) -> None:
        """A face given as triangles only: triangle k is half of the parallelogram over (0, 1) x (2 k, 2 k + 1)."""
        definition = len(self.surface_type)
        self.surface_type.append("triangles")
        self.trimmed.append(1)
        self.loops.append([])
        if not face.triangulation:
            self.warnings.append(f"face {index} is not drawn: it has neither a surface nor triangles")
            return
        self.triangulated += 1
        nodes, triangles = self.stream.triangulations[face.triangulation]
        a, b, c = (nodes[triangles[:, k]] for k in range(3))
        points = np.ones((len(triangles), 1, 2, 2, 4))
        points[:, 0, 0, 0, :3], points[:, 0, 1, 0, :3] = a, b
        points[:, 0, 0, 1, :3], points[:, 0, 1, 1, :3] = c, b + c - a
        for k, patch in enumerate(points):
            v = 2.0 * k
            self.builder.add_patches(definition, patch[None], np.array((0.0, 1.0)), np.array((v, v + 1)))
            corners = [(0.0, v, 1.0), (1.0, v, 1.0), (0.0, v + 1, 1.0), (0.0, v, 1.0)]
            self.loops[-1].append([(list(pair), -1) for pair in zip(corners, corners[1:], strict=False)])


def _assemble(
    source: str,
    stream: Stream,
    faces: list[PlacedFace],
    definition_of: dict[int, int],
    conversion: _Conversion,
) -> Model:
    placements, face_placement = _placements(stream, faces)
    mirrored = np.linalg.det(placements[:, :3, :3])[face_placement] < 0 if faces else np.zeros(0, bool)
    backwards = np.array([face.orientation == REVERSED for face in faces], bool)
    warnings = list(conversion.warnings)
    if conversion.triangulated:
        drawn = sum(conversion.surface_type[definition_of[face.shape]] == "triangles" for face in faces)
        warnings.append(f"{drawn} faces are given as triangles only and are drawn as those triangles")
    definition_loops, loop_offsets, segment_offsets, points, edges = _flat_loops(conversion.loops)
    return Model(
        source=source,
        groups=conversion.builder.groups(),
        surface_type=conversion.surface_type,
        trimmed=np.array(conversion.trimmed, np.uint8),
        definition_loops=definition_loops,
        loop_offsets=loop_offsets,
        segment_offsets=segment_offsets,
        segment_points=points,
        segment_edge=edges,
        conversion_error=np.array(conversion.errors, np.float64),
        face_definition=np.array([definition_of[face.shape] for face in faces], np.int32),
        face_placement=face_placement,
        placements=placements,
        face_outward=np.where(mirrored ^ backwards, -1, 1).astype(np.int8),
        face_color=np.tile(np.array(DEFAULT_COLOR, np.float32), (len(faces), 1)),
        face_name=[""] * len(faces),
        warnings=warnings,
    )


def _placements(stream: Stream, faces: list[PlacedFace]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Distinct matrices (K, 4, 4), world from definition, and the index (F,) of each face's."""
    index_of: dict[Location, int] = {}
    matrices: list[NDArray[np.float64]] = []
    index = np.empty(len(faces), np.int32)
    for k, face in enumerate(faces):
        own = stream.shapes[face.shape].location
        location = multiply(face.location, stream.locations[own]) if own else face.location
        if location not in index_of:
            index_of[location] = len(matrices)
            matrices.append(matrix_of(stream, location))
        index[k] = index_of[location]
    return np.array(matrices).reshape(-1, 4, 4), index


def _flat_loops(
    loops: list[list[Loop]],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.int32]]:
    """Offsets of definitions, loops and segments, then segment_points and segment_edge, as Model documents them."""
    definition_loops = np.cumsum([0, *(len(own) for own in loops)])
    loop_offsets = np.cumsum([0, *(len(loop) for own in loops for loop in own)])
    segments = [segment for own in loops for loop in own for segment in loop]
    segment_offsets = np.cumsum([0, *(len(points) for points, _ in segments)])
    flat = [point for points, _ in segments for point in points]
    return (
        definition_loops.astype(np.int64),
        loop_offsets.astype(np.int64),
        segment_offsets.astype(np.int64),
        np.array(flat, np.float64).reshape(-1, 3),
        np.array([edge for _, edge in segments], np.int32),
    )
