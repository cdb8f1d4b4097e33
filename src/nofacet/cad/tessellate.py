"""OpenCascade's own triangles of a shape, as plain arrays."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
from OCP.Poly import Poly_Triangulation
from OCP.TopAbs import TopAbs_FACE, TopAbs_Orientation
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from ..mesh import Mesh
from ..mesh_setting import DEFAULT_ANGLE
from . import stream


def tessellate(
    shape: TopoDS_Shape,
    deflection: float,
    angle: float = DEFAULT_ANGLE,
    delabella: bool = False,
    parallel: bool = False,
) -> Mesh:
    """Mesh a shape with BRepMesh_IncrementalMesh; triangles it had before are thrown away.

    deflection: largest distance between an edge or a surface and its triangles that the mesher aims at, model units.
    angle: largest angle, radians, between neighbouring segments of an edge, or normals on a face.
    delabella: use that algorithm instead of the default one (Watson).
    parallel: let OpenCascade mesh faces on several threads.
    Faces that OpenCascade cannot mesh have no triangles.
    """
    parameters = IMeshTools_Parameters()
    parameters.Deflection, parameters.Angle, parameters.InParallel = deflection, angle, parallel
    if delabella:
        parameters.MeshAlgo = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Delabella
    BRepTools.Clean_s(shape)
    start = time.perf_counter()
    BRepMesh_IncrementalMesh(shape, parameters)
    return _collect(shape, time.perf_counter() - start, deflection)


def box_sides(shape: TopoDS_Shape) -> tuple[float, float, float]:
    """Sizes of the shape's bounding box along x, y and z, model units, as OpenCascade's viewers compute it."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    low, high = box.CornerMin(), box.CornerMax()
    return high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()


@dataclass(frozen=True)
class _FaceMesh:
    """Where the triangles of one face belong: its index and location, and whether they are seen from inside."""

    face: int
    triangulation: Poly_Triangulation
    location: TopLoc_Location
    backwards: bool


def _face_meshes(shape: TopoDS_Shape) -> Iterator[_FaceMesh]:
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    for index in range(faces.Extent()):
        face = TopoDS.Face_s(faces.FindKey(index + 1))
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        if triangulation is not None:
            backwards = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
            yield _FaceMesh(index, triangulation, location, backwards)


def _collect(shape: TopoDS_Shape, seconds: float, deflection: float) -> Mesh:
    found = list(_face_meshes(shape))
    points, triangles = [np.empty((0, 3))], [np.empty((0, 3), np.int32)]
    count = 0
    for one, (nodes, corners) in zip(found, _arrays([one.triangulation for one in found]), strict=True):
        rotation, move = _matrix(one.location)
        points.append(nodes @ rotation.T + move)
        triangles.append(count + (corners[:, ::-1] if one.backwards ^ (np.linalg.det(rotation) < 0) else corners))
        count += len(nodes)
    face = np.repeat(np.array([one.face for one in found], np.int32), [len(part) for part in triangles[1:]])
    all_points, all_triangles = np.concatenate(points), np.concatenate(triangles).astype(np.int32)
    return Mesh(all_points, _normals(all_points, all_triangles), all_triangles, face, seconds, deflection)


def _arrays(triangulations: list[Poly_Triangulation]) -> list[tuple[NDArray[np.float64], NDArray[np.int32]]]:
    """Nodes (n, 3) and corners (t, 3) of each. Asking for them one by one costs microseconds each; so they are put on
    faces without a surface, whose binary form holds little else."""
    if not triangulations:
        return []
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for triangulation in triangulations:
        face = TopoDS_Face()
        builder.MakeFace(face, triangulation)
        builder.Add(compound, face)
    content = stream.read(compound)
    first = content.children.offsets[content.root[1]]
    faces = content.children.shape[first : first + len(triangulations)]
    return [content.triangulations[number] for number in content.faces.triangulation[faces].tolist()]


def _matrix(location: TopLoc_Location) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rotation (3, 3), with scale, and translation (3,)."""
    transformation = location.Transformation()
    rows = np.array([[transformation.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)])
    return rows[:, :3], rows[:, 3]


def _normals(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float32]:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    corner = triangles.ravel()
    sums = np.stack([np.bincount(corner, np.repeat(area[:, k], 3), len(points)) for k in range(3)], axis=1)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.divide(sums, length, out=sums, where=length > 0).astype(np.float32)
