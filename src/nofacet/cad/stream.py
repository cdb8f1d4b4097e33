"""A shape's whole boundary representation from one OpenCascade call.

Asking OpenCascade pole by pole costs microseconds a call; its own binary serialisation (BinTools, format version 4)
writes everything in milliseconds, and this module reads those bytes into tables. The format is little-endian and
packed: text section headers ("Curves 12") followed by binary records of many sizes. One pass over the bytes finds where
each record starts; numpy then reads all records of one kind together. The format is defined by what BinTools writes
(OpenCascade 7.6 and later), so the version is pinned and the header line checked.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from struct import Struct
from struct import error as StructError
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .locations import Location, Locations
from .records import Curves, Index, Surfaces, gather, gather_reals, scan_curves, scan_surfaces
from .tables import expand_runs, offsets_of

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADER = b"\nOpen CASCADE Topology V4, (c) Open Cascade\n"
SOLID_LIKE, FACE, WIRE, EDGE, VERTEX = (0, 1, 2, 3), 4, 5, 6, 7  # TopAbs_ShapeEnum; 0-3 compound .. shell
FORWARD, REVERSED, INTERNAL, EXTERNAL = 0, 1, 2, 3  # TopAbs_Orientation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class References:
    """Sub-shapes: those of shape k are entries offsets[k] .. offsets[k + 1]."""

    offsets: Index
    orientation: NDArray[np.uint8]
    shape: Index
    location: Index


@dataclass(frozen=True)
class Faces:
    """By shape index: numbers of the surface, its location and the triangulation, 0 for none or no face."""

    surface: Index
    location: Index
    triangulation: Index


@dataclass(frozen=True)
class Edges:
    """By shape index: the edge's tolerance, whether it is degenerate, its 3-D curve (0: none), that curve's location
    and range."""

    tolerance: Array
    degenerated: NDArray[np.bool_]
    curve: Index
    location: Index
    first: Array
    last: Array


@dataclass(frozen=True)
class PCurves:
    """Edges' curves on surfaces: those of shape k are entries offsets[k] .. offsets[k + 1].

    second: the curve used by the reversed use of a seam, 0 for none.
    """

    offsets: Index
    curve: Index
    second: Index
    surface: Index
    location: Index
    first: Array
    last: Array


@dataclass(frozen=True)
class Stream:
    """Everything BinTools wrote. Shapes, curves, surfaces and triangulations count from 1.

    kinds: TopAbs_ShapeEnum by shape index; root: (orientation, shape, location) of the shape itself.
    triangulations: (nodes (n, 3), triangles (m, 3)).
    """

    locations: Locations
    curves2d: Curves
    curves: Curves
    surfaces: Surfaces
    triangulations: list[Any]
    kinds: NDArray[np.uint8]
    children: References
    faces: Faces
    edges: Edges
    pcurves: PCurves
    root: tuple[int, int, int]


def read(shape: TopoDS_Shape) -> Stream:
    """Serialise a shape with OpenCascade and parse it. Raises InputError on a null shape or an unknown format."""
    import OCP.BinTools as bintools  # several format names are module-level, so the module is what is needed

    if shape is None or shape.IsNull():
        raise InputError("the shape is empty: nothing to convert")
    buffer = io.BytesIO()
    bintools.BinTools.Write_s(shape, buffer, False, False, bintools.BinTools_FormatVersion_VERSION_4)
    return parse(buffer.getvalue())


def parse(data: bytes) -> Stream:
    """Parse BinTools bytes, format version 4. Raises InputError when they are not that or end at the wrong place."""
    if not data.startswith(HEADER):
        raise InputError(f"OpenCascade wrote an unknown binary format {data[:45]!r}: this version cannot be read")
    try:
        return _parse(data)
    except (IndexError, StructError) as problem:
        raise InputError("OpenCascade's binary format has parts this version does not know") from problem


def _parse(data: bytes) -> Stream:
    count, at = _section(data, len(HEADER), b"Locations")
    locations, at = _locations(data, at, count)
    count, at = _section(data, at, b"Curve2ds")
    curves2d, at = scan_curves(data, at, 2, count)
    count, at = _section(data, at, b"Curves")
    curves, at = scan_curves(data, at, 3, count)
    for empty in (b"Polygon3D", b"PolygonOnTriangulations"):
        count, at = _section(data, at, empty)
        if count:
            raise InputError("OpenCascade wrote polygons that were not asked for: this version cannot be read")
    count, at = _section(data, at, b"Surfaces")
    surfaces, at = scan_surfaces(data, at, count)
    count, at = _section(data, at, b"Triangulations")
    triangulations: list[Any] = [None]
    for _ in range(count):
        triangulation, at = _triangulation(data, at)
        triangulations.append(triangulation)
    count, at = _section(data, at, b"TShapes")
    scan = _scan_shapes(data, at, count)
    if scan.end + _REFERENCE.itemsize != len(data):
        raise InputError("OpenCascade's binary format has parts this version does not know")
    orientation, shape, location = gather(data, np.array([scan.end]), _REFERENCE)[0].tolist()
    return Stream(
        locations,
        curves2d,
        curves,
        surfaces,
        triangulations,
        np.array(scan.kinds, np.uint8),
        _references(data, scan),
        _faces(data, scan),
        *_edges(data, scan),
        (orientation, count + 1 - shape, location),
    )


def _section(data: bytes, at: int, name: bytes) -> tuple[int, int]:
    """The count of the section header 'name count' at or after byte `at`, and the byte after the header."""
    while data[at] == 10:
        at += 1
    end = data.index(b"\n", at) if b"\n" in data[at : at + 60] else at
    word, _, count = data[at:end].partition(b" ")
    if word != name:
        raise InputError(f"OpenCascade's binary format has {word!r} where {name!r} should be")
    return int(count), end + 1


_INT, _PAIR, _SIZES = Struct("<i"), Struct("<ii"), Struct("<iiBB")


def _locations(data: bytes, at: int, count: int) -> tuple[Locations, int]:
    chains: list[Location] = [()]
    datums = []
    for number in range(1, count + 1):
        at += 1
        if data[at - 1] == 1:
            datums.append(at)
            chains.append(((number, 1),))
            at += 96
            continue
        chain: Location = ()
        while _INT.unpack_from(data, at)[0]:
            chain = (*chain, _PAIR.unpack_from(data, at))
            at += 8
        at += 4
        chains.append(chain)
    matrices = np.tile(np.eye(4), (len(datums), 1, 1))
    matrices[:, :3] = gather_reals(data, np.array(datums, np.intp), 12).reshape(-1, 3, 4)
    return Locations(chains, matrices), at


def _triangulation(data: bytes, at: int) -> tuple[tuple[Array, NDArray[np.int32]], int]:
    nodes, triangles, has_uv, has_normals = _SIZES.unpack_from(data, at)
    at += 18  # sizes, flags, deflection
    points = np.frombuffer(data, "<f8", 3 * nodes, at).reshape(nodes, 3)
    at += 24 * nodes + (16 * nodes if has_uv else 0)
    corners = np.frombuffer(data, "<i4", 3 * triangles, at).reshape(triangles, 3) - 1
    return (points, corners), at + 12 * triangles + (12 * nodes if has_normals else 0)


@dataclass
class _Scan:
    """Where the records of the shapes start: faces, edges, edges' representations; by shape index how many of those lie
    before it, and where its references to sub-shapes begin and end."""

    kinds: list[int]
    references: list[int]
    reference_ends: list[int]
    faces: list[int]
    edges: list[int]
    representations: list[int]
    representation_offsets: list[int]
    end: int = 0


_CURVE, _PCURVE, _SEAM, _CONTINUITY = 1, 2, 3, 4  # kinds of an edge's representations
_REPRESENTATION_SIZES = (0, 25, 29, 34, 18)
_POINT_SIZES = (0, 17, 21, 25)  # of a vertex's representations
_REFERENCES = re.compile(rb"(?:[\x00-\x03].{8})*\*", re.DOTALL)  # orientation, shape, location; '*' ends the list


def _scan_shapes(data: bytes, at: int, count: int) -> _Scan:
    scan = _Scan([0], [0], [0], [], [], [], [0, 0])
    kinds, references, reference_ends = scan.kinds, scan.references, scan.reference_ends
    representations, representation_offsets = scan.representations, scan.representation_offsets
    for _ in range(count):
        kind = data[at]
        kinds.append(kind)
        if kind == EDGE:
            scan.edges.append(at + 1)
            at += 12
            while representation := data[at]:
                representations.append(at)
                at += _REPRESENTATION_SIZES[representation]
            at += 1
        elif kind == VERTEX:
            at += 33  # tolerance, point
            while point := data[at]:
                at += _POINT_SIZES[point]
            at += 1
        elif kind == FACE:
            scan.faces.append(at + 10)  # after natural restriction flag and tolerance
            at += 23 if data[at + 18] == 2 else 19
        else:
            at += 1
        at += 7  # flags: free, modified, checked, orientable, closed, infinite, convex
        references.append(at)
        ending = _REFERENCES.match(data, at)
        if ending is None:
            raise InputError(f"OpenCascade's binary format has a shape of kind {kind} that cannot be read")
        at = ending.end()
        reference_ends.append(at - 1)
        representation_offsets.append(len(representations))
    scan.end = at
    return scan


_REFERENCE = np.dtype([("orientation", "u1"), ("shape", "<i4"), ("location", "<i4")])
_FACE = np.dtype([("surface", "<i4"), ("location", "<i4"), ("has", "u1"), ("triangulation", "<i4")])
_EDGE = np.dtype([("tolerance", "<f8"), ("same_parameter", "u1"), ("same_range", "u1"), ("degenerated", "u1")])
_RANGE = [("first", "<f8"), ("last", "<f8")]
_PLACE = [("surface", "<i4"), ("location", "<i4"), *_RANGE]
_REPRESENTATIONS = {
    _CURVE: np.dtype([("kind", "u1"), ("curve", "<i4"), ("location", "<i4"), *_RANGE]),
    _PCURVE: np.dtype([("kind", "u1"), ("curve", "<i4"), *_PLACE]),
    _SEAM: np.dtype([("kind", "u1"), ("curve", "<i4"), ("second", "<i4"), ("continuity", "u1"), *_PLACE]),
}


def _references(data: bytes, scan: _Scan) -> References:
    start, size = np.array(scan.references), _REFERENCE.itemsize
    counts = (np.array(scan.reference_ends) - start) // size
    owner, place = expand_runs(np.zeros(len(counts), np.intp), counts)
    records = gather(data, start[owner] + size * place, _REFERENCE)
    shape = len(scan.kinds) - records["shape"].astype(np.intp)
    return References(offsets_of(counts), records["orientation"], shape, records["location"].astype(np.intp))


def _faces(data: bytes, scan: _Scan) -> Faces:
    which = np.flatnonzero(np.array(scan.kinds) == FACE)
    records = gather(data, np.array(scan.faces, np.intp), _FACE)
    columns = np.zeros((3, len(scan.kinds)), np.intp)
    for column, name in zip(columns, ("surface", "location", "triangulation"), strict=True):
        column[which] = records[name]
    columns[2][which[records["has"] != 2]] = 0
    return Faces(*columns)


def _edges(data: bytes, scan: _Scan) -> tuple[Edges, PCurves]:
    count = len(scan.kinds)
    at = np.array(scan.representations, np.intp)
    kinds = np.frombuffer(data, np.uint8)[at]
    offsets = np.array(scan.representation_offsets)
    owner = np.repeat(np.arange(count), np.diff(offsets))

    is_edge = np.array(scan.kinds) == EDGE
    records = gather(data, np.array(scan.edges, np.intp), _EDGE)
    edges = Edges(np.zeros(count), np.zeros(count, bool), *np.zeros((2, count), np.intp), *np.zeros((2, count)))
    edges.tolerance[is_edge], edges.degenerated[is_edge] = records["tolerance"], records["degenerated"] != 0
    is_curve = kinds == _CURVE
    records = gather(data, at[is_curve], _REPRESENTATIONS[_CURVE])
    for name in ("curve", "location", "first", "last"):
        getattr(edges, name)[owner[is_curve]] = records[name]

    on_surface = (kinds == _PCURVE) | (kinds == _SEAM)
    at, kinds = at[on_surface], kinds[on_surface]
    before = np.append(0, np.cumsum(on_surface))
    pcurves = PCurves(before[offsets], *np.zeros((4, len(at)), np.intp), *np.zeros((2, len(at))))
    for kind in (_PCURVE, _SEAM):
        records = gather(data, at[kinds == kind], _REPRESENTATIONS[kind])
        for name in records.dtype.names or ():
            if name not in ("kind", "continuity"):
                getattr(pcurves, name)[kinds == kind] = records[name]
    return edges, pcurves
