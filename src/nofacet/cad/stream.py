"""A shape's whole boundary representation from one OpenCascade call.

Asking OpenCascade pole by pole costs microseconds a call; its own binary serialisation (BinTools, format version 4)
writes everything in milliseconds, and this module reads those bytes into tables. The format is little-endian and
packed: text section headers ("Curves 12") followed by binary records of many sizes. One pass over the bytes in C++
(src/native/extract/stream_scan.h) finds where each record starts; numpy then reads all curves or surfaces of one kind
together. The format is defined by what BinTools writes
(OpenCascade 7.6 and later), so the version is pinned and the header line checked.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from struct import Struct
from struct import error as StructError
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import _native
from ..errors import InputError
from .locations import Location, Locations
from .records import Curves, Index, Surfaces, gather_reals, scan_curves, scan_surfaces

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADER = b"\nOpen CASCADE Topology V4, (c) Open Cascade\n"
SOLID_LIKE = COMPOUND, COMPSOLID, SOLID, SHELL = 0, 1, 2, 3  # TopAbs_ShapeEnum: what holds faces
FACE, WIRE, EDGE, VERTEX = 4, 5, 6, 7
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
    triangulations: (nodes (n, 3), triangles (m, 3), normals (n, 3) or (0, 3) where there are none).
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
    except InputError:
        raise
    except (IndexError, ValueError, StructError) as problem:
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
    kinds, children, faces, edges, pcurves, at = _native.scan_shapes(data, at, count)
    if at + _REFERENCE.size != len(data):
        raise InputError("OpenCascade's binary format has parts this version does not know")
    orientation, shape, location = _REFERENCE.unpack_from(data, at)
    return Stream(
        locations,
        curves2d,
        curves,
        surfaces,
        triangulations,
        kinds,
        References(*children),
        Faces(*faces),
        Edges(*edges),
        PCurves(*pcurves),
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
_REFERENCE = Struct("<Bii")  # orientation, shape, location


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


def _triangulation(data: bytes, at: int) -> tuple[tuple[Array, NDArray[np.int32], NDArray[np.float32]], int]:
    nodes, triangles, has_uv, has_normals = _SIZES.unpack_from(data, at)
    at += 18  # sizes, flags, deflection
    points = np.frombuffer(data, "<f8", 3 * nodes, at).reshape(nodes, 3)
    at += 24 * nodes + (16 * nodes if has_uv else 0)
    corners = np.frombuffer(data, "<i4", 3 * triangles, at).reshape(triangles, 3) - 1
    at += 12 * triangles
    normals = np.frombuffer(data, "<f4", 3 * nodes if has_normals else 0, at).reshape(-1, 3)
    return (points, corners, normals), at + normals.nbytes
