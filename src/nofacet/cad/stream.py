"""A shape's whole boundary representation from one OpenCascade call.

Asking OpenCascade pole by pole costs microseconds a call; its own binary serialisation (BinTools, format version 4)
writes everything in milliseconds, and this module reads those bytes into plain tuples and arrays. The format is
little-endian and packed: text section headers ("Curves 12") followed by binary records. It is defined by what
BinTools writes (OpenCascade 7.6 and later), so the version is pinned and the header line checked.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from struct import Struct
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADER = b"\nOpen CASCADE Topology V4, (c) Open Cascade\n"
SOLID_LIKE, FACE, WIRE, EDGE, VERTEX = (0, 1, 2, 3), 4, 5, 6, 7  # TopAbs_ShapeEnum; 0-3 compound .. shell
FORWARD, REVERSED, INTERNAL, EXTERNAL = 0, 1, 2, 3  # TopAbs_Orientation

Array = NDArray[np.float64]
Vector = tuple[float, ...]
Location = tuple[tuple[int, int], ...]  # (datum, power) pairs, rightmost factor first, as TopLoc_Location has them


@dataclass(slots=True)
class Curve:
    """A curve in 2 or 3 dimensions, by kind, with t OpenCascade's parameter.

    line: origin + t b; circle, ellipse: origin + cos t a + sin t b; hyperbola: origin + cosh t a + sinh t b;
    parabola: origin + t^2 a + t b; bezier (0 <= t <= 1), bspline: poles (n, dim + 1) homogeneous;
    offset: basis moved by `offset` along its normal (2-D: right of the tangent; 3-D: tangent x direction b).
    bounds: the range of a trimmed curve, None where it is the kind's own.
    """

    kind: str
    origin: Vector = ()
    a: Vector = ()
    b: Vector = ()
    degree: int = 0
    poles: Array | None = None
    knots: Array | None = None
    multiplicities: NDArray[np.int32] | None = None
    periodic: bool = False
    rational: bool = False
    basis: Curve | None = None
    offset: float = 0.0
    bounds: tuple[float, float] | None = None


@dataclass(slots=True)
class Surface:
    """A surface in OpenCascade's own parameters (u, v).

    Elementary ones live in the frame (origin, x, y, z), y as stored, so left-handed frames stay so; radii hold
    (radius, 0), cone (reference radius, half angle), torus (major, minor). extrusion: curve(u) + v z; revolution:
    curve(v) turned by u about the axis (origin, z). bezier, bspline: poles (nu, nv, 4) homogeneous.
    bounds: u0, u1, v0, v1 of a rectangular-trimmed surface, else None. offset: distance from `basis`.
    """

    kind: str
    origin: Vector = ()
    x: Vector = ()
    y: Vector = ()
    z: Vector = ()
    radii: tuple[float, float] = (0.0, 0.0)
    curve: Curve | None = None
    degrees: tuple[int, int] = (0, 0)
    poles: Array | None = None
    knots: tuple[Array, Array] | None = None
    multiplicities: tuple[NDArray[np.int32], NDArray[np.int32]] | None = None
    periodic: tuple[bool, bool] = (False, False)
    rational: bool = False
    basis: Surface | None = None
    offset: float = 0.0
    bounds: tuple[float, float, float, float] | None = None


@dataclass(slots=True)
class PCurve:
    """An edge's curve on a surface; `second` is used by the reversed use of a seam. Indices count from 1, 0 is none."""

    surface: int
    location: int
    curve: int
    second: int
    first: float
    last: float


@dataclass(slots=True)
class Edge:
    """curve: (curve index, location index, first, last) of the 3-D curve, or None."""

    tolerance: float
    degenerated: bool
    curve: tuple[int, int, float, float] | None
    pcurves: list[PCurve]


@dataclass(slots=True)
class Face:
    surface: int
    location: int
    triangulation: int


@dataclass(slots=True)
class Stream:
    """Everything BinTools wrote. All lists count from 1 (entry 0 is None), as the indices in the records do.

    children[k]: (orientation, shape, location) triples of shape k; root: the same triple for the shape itself.
    locations: datum chains; matrices: the same as (4, 4) arrays. triangulations: (nodes (n, 3), triangles (m, 3)).
    """

    locations: list[Location]
    matrices: list[Array]
    curves2d: list[Any]
    curves: list[Any]
    surfaces: list[Any]
    triangulations: list[Any]
    kinds: list[int]
    shapes: list[Any]
    children: list[list[tuple[int, int, int]]]
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
    reader = _Reader(data)
    reader.at = len(HEADER)
    locations, matrices = _locations(reader)
    curves2d = _section(reader, b"Curve2ds", lambda: _curve(reader, 2))
    curves = _section(reader, b"Curves", lambda: _curve(reader, 3))
    for empty in (b"Polygon3D", b"PolygonOnTriangulations"):
        if reader.header(empty):
            raise InputError("OpenCascade wrote polygons that were not asked for: this version cannot be read")
    surfaces = _section(reader, b"Surfaces", lambda: _surface(reader))
    triangulations = _section(reader, b"Triangulations", lambda: _triangulation(reader))
    kinds, shapes, children = _shapes(reader)
    root = _reference(reader, len(kinds))
    if root is None or reader.at != len(data):
        raise InputError("OpenCascade's binary format has parts this version does not know")
    return Stream(locations, matrices, curves2d, curves, surfaces, triangulations, kinds, shapes, children, root)


_INT, _REAL, _SHORT = Struct("<i"), Struct("<d"), Struct("<H")
_REALS = {n: Struct(f"<{n}d") for n in range(1, 17)}
_REFERENCE = Struct("<Bii")
_KNOTS = np.dtype([("knot", "<f8"), ("multiplicity", "<i4")])


class _Reader:
    """A position in the bytes."""

    __slots__ = ("data", "at")

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1]

    def integer(self) -> int:
        self.at += 4
        return int(_INT.unpack_from(self.data, self.at - 4)[0])

    def short(self) -> int:
        self.at += 2
        return int(_SHORT.unpack_from(self.data, self.at - 2)[0])

    def real(self) -> float:
        self.at += 8
        return float(_REAL.unpack_from(self.data, self.at - 8)[0])

    def reals(self, n: int) -> Vector:
        at = self.at
        self.at += 8 * n
        return _REALS[n].unpack_from(self.data, at)

    def array(self, dtype: Any, count: int) -> NDArray[Any]:
        result = np.frombuffer(self.data, dtype, count, self.at).copy()
        self.at += result.nbytes
        return result

    def header(self, name: bytes) -> int:
        """Read the section header 'name count' and return the count."""
        while self.data[self.at] == 10:
            self.at += 1
        end = self.data.index(b"\n", self.at)
        word, count = self.data[self.at : end].split()
        if word != name:
            raise InputError(f"OpenCascade's binary format has {word!r} where {name!r} should be")
        self.at = end + 1
        return int(count)


def _section(reader: _Reader, name: bytes, read_one: Callable[[], Any]) -> list[Any]:
    return [None, *(read_one() for _ in range(reader.header(name)))]


def multiply(left: Location, right: Location) -> Location:
    """The location left * right with equal neighbours merged, as TopLoc_Location::Multiplied does."""
    result = left
    for datum, power in reversed(right):
        if result and result[0][0] == datum:
            power += result[0][1]
            result = result[1:]
        if power:
            result = ((datum, power), *result)
    return result


def _locations(reader: _Reader) -> tuple[list[Location], list[Array]]:
    chains: list[Location] = [()]
    matrices: list[Array] = [np.eye(4)]
    for index in range(1, reader.header(b"Locations") + 1):
        matrix = np.eye(4)
        if reader.byte() == 1:
            matrix[:3] = np.reshape(reader.reals(12), (3, 4))
            chain: Location = ((index, 1),)
        else:
            chain = ()
            while datum := reader.integer():
                power = reader.integer()
                chain = (*chain, (datum, power))
                matrix = np.linalg.matrix_power(matrices[datum], power) @ matrix
        chains.append(chain)
        matrices.append(matrix)
    return chains, matrices


_CURVES = ("", "line", "circle", "ellipse", "parabola", "hyperbola", "bezier", "bspline", "trimmed", "offset")


def _curve(reader: _Reader, dim: int) -> Curve:
    kind = _CURVES[reader.byte()]
    if kind == "line":
        numbers = reader.reals(2 * dim)
        return Curve(kind, numbers[:dim], (), numbers[dim:])
    if kind in ("circle", "ellipse", "parabola", "hyperbola"):
        return _conic(reader, kind, dim)
    if kind == "trimmed":
        bounds = (reader.real(), reader.real())
        basis = _curve(reader, dim)
        basis.bounds = bounds
        return basis
    if kind == "offset":
        offset = reader.real()
        direction = reader.reals(3) if dim == 3 else ()
        return Curve(kind, b=direction, basis=_curve(reader, dim), offset=offset)
    rational = bool(reader.byte())
    if kind == "bezier":
        degree = reader.short()
        return Curve(kind, degree=degree, poles=_poles(reader, (degree + 1,), dim, rational), rational=rational)
    periodic = bool(reader.byte())
    degree, count, knot_count = reader.short(), reader.integer(), reader.integer()
    poles = _poles(reader, (count,), dim, rational)
    knots = reader.array(_KNOTS, knot_count)
    return Curve(
        kind,
        degree=degree,
        poles=poles,
        knots=np.ascontiguousarray(knots["knot"]),
        multiplicities=np.ascontiguousarray(knots["multiplicity"]),
        periodic=periodic,
        rational=rational,
    )


def _conic(reader: _Reader, kind: str, dim: int) -> Curve:
    """Conics store their frame (in 3-D with the normal between origin and X), then one or two sizes."""
    origin = reader.reals(dim)
    if dim == 3:
        reader.at += 24
    x, y = reader.reals(dim), reader.reals(dim)
    first = reader.real()
    if kind == "parabola":
        return Curve(kind, origin, tuple(c / (4 * first) for c in x), y)
    second = first if kind == "circle" else reader.real()
    return Curve(kind, origin, tuple(first * c for c in x), tuple(second * c for c in y))


def _poles(reader: _Reader, shape: tuple[int, ...], dim: int, rational: bool) -> Array:
    """Homogeneous poles, shape (*shape, dim + 1), with the last column 1 where there are no weights."""
    width = dim + 1 if rational else dim
    stored = reader.array("<f8", int(np.prod(shape)) * width).reshape(*shape, width)
    poles = np.ones((*shape, dim + 1))
    poles[..., :width] = stored
    if rational:
        poles[..., :dim] *= poles[..., dim:]
    return poles


_SURFACES = (
    "",
    "plane",
    "cylinder",
    "cone",
    "sphere",
    "torus",
    "extrusion",
    "revolution",
    "bezier",
    "bspline",
    "trimmed",
    "offset",
)


def _surface(reader: _Reader) -> Surface:
    kind = _SURFACES[reader.byte()]
    if kind in ("plane", "cylinder", "cone", "sphere", "torus"):
        n = reader.reals(12)
        radii = (0.0, 0.0)
        if kind in ("cone", "torus"):
            radii = (reader.real(), reader.real())
        elif kind != "plane":
            radii = (reader.real(), 0.0)
        return Surface(kind, n[:3], n[6:9], n[9:12], n[3:6], radii)
    if kind == "extrusion":
        direction = reader.reals(3)
        return Surface(kind, z=direction, curve=_curve(reader, 3))
    if kind == "revolution":
        origin, direction = reader.reals(3), reader.reals(3)
        return Surface(kind, origin, z=direction, curve=_curve(reader, 3))
    if kind == "trimmed":
        bounds = reader.reals(4)
        basis = _surface(reader)
        basis.bounds = (bounds[0], bounds[1], bounds[2], bounds[3])
        return basis
    if kind == "offset":
        offset = reader.real()
        return Surface(kind, basis=_surface(reader), offset=offset)
    rational = bool(reader.byte() | reader.byte())
    if kind == "bezier":
        du, dv = reader.short(), reader.short()
        poles = _poles(reader, (du + 1, dv + 1), 3, rational)
        return Surface(kind, degrees=(du, dv), poles=poles, rational=rational)
    periodic = (bool(reader.byte()), bool(reader.byte()))
    degrees = (reader.short(), reader.short())
    nu, nv, ku, kv = (reader.integer() for _ in range(4))
    poles = _poles(reader, (nu, nv), 3, rational)
    u, v = reader.array(_KNOTS, ku), reader.array(_KNOTS, kv)
    knots = (np.ascontiguousarray(u["knot"]), np.ascontiguousarray(v["knot"]))
    multiplicities = (np.ascontiguousarray(u["multiplicity"]), np.ascontiguousarray(v["multiplicity"]))
    return Surface(
        kind,
        degrees=degrees,
        poles=poles,
        knots=knots,
        multiplicities=multiplicities,
        periodic=periodic,
        rational=rational,
    )


def _triangulation(reader: _Reader) -> tuple[Array, NDArray[np.int32]]:
    nodes, triangles = reader.integer(), reader.integer()
    has_uv, has_normals = reader.byte(), reader.byte()
    reader.real()  # deflection
    points = reader.array("<f8", 3 * nodes).reshape(nodes, 3)
    reader.at += 16 * nodes if has_uv else 0
    corners = reader.array("<i4", 3 * triangles).reshape(triangles, 3) - 1
    reader.at += 12 * nodes if has_normals else 0
    return points, corners


def _reference(reader: _Reader, count: int) -> tuple[int, int, int] | None:
    """(orientation, shape, location), or None at the '*' that ends a list of sub-shapes."""
    if reader.data[reader.at] == 42:
        reader.at += 1
        return None
    orientation, backwards, location = _REFERENCE.unpack_from(reader.data, reader.at)
    reader.at += 9
    return orientation, count - backwards, location


def _shapes(reader: _Reader) -> tuple[list[int], list[Any], list[list[tuple[int, int, int]]]]:
    kinds, shapes = [-1], [None]
    children: list[list[tuple[int, int, int]]] = [[]]
    count = reader.header(b"TShapes") + 1
    for _ in range(count - 1):
        kind = reader.byte()
        record: Any = None
        if kind == VERTEX:
            _skip_vertex(reader)
        elif kind == EDGE:
            record = _edge(reader)
        elif kind == FACE:
            reader.at += 9  # natural restriction flag, tolerance
            surface, location = reader.integer(), reader.integer()
            record = Face(surface, location, reader.integer() if reader.byte() == 2 else 0)
        reader.at += 7  # flags: free, modified, checked, orientable, closed, infinite, convex
        below = []
        while (child := _reference(reader, count)) is not None:
            below.append(child)
        kinds.append(kind)
        shapes.append(record)
        children.append(below)
    return kinds, shapes, children


def _skip_vertex(reader: _Reader) -> None:
    reader.at += 32  # tolerance, point
    while kind := reader.byte():
        reader.at += (0, 16, 20, 24)[kind]


def _edge(reader: _Reader) -> Edge:
    tolerance = reader.real()
    degenerated = bool(reader.data[reader.at + 2])
    reader.at += 3  # same parameter, same range, degenerated
    edge = Edge(tolerance, degenerated, None, [])
    while kind := reader.byte():
        if kind == 1:
            curve, location = reader.integer(), reader.integer()
            edge.curve = (curve, location, reader.real(), reader.real())
        elif kind in (2, 3):
            curve, second = reader.integer(), 0
            if kind == 3:
                second = reader.integer()
                reader.at += 1  # continuity
            surface, location = reader.integer(), reader.integer()
            edge.pcurves.append(PCurve(surface, location, curve, second, reader.real(), reader.real()))
        elif kind == 4:
            reader.at += 17  # continuity across two surfaces
        else:
            raise InputError(f"OpenCascade's binary format has an unknown edge record {kind}")
    return edge
