"""OpenCascade's own triangles of a shape, as plain arrays."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
from OCP.TopAbs import TopAbs_FACE, TopAbs_Orientation
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from . import stream
from .tables import offsets_of

DEFAULT_ANGLE = 0.5  # radians, BRepMesh_IncrementalMesh's own default


@dataclass(frozen=True)
class Mesh:
    """Triangles of every placed face, in world coordinates.

    points: (n, 3) float64, model units; every face has its own.
    normals: (n, 3) float32, unit: the mean of the normals of the face's triangles at the point, weighted by area.
    triangles: (t, 3) int32, indices into points, anticlockwise seen from outside.
    face: (t,) int32, index in the order of TopExp::MapShapes(shape, TopAbs_FACE).
    seconds: wall-clock time that OpenCascade's mesher took.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float32]
    triangles: NDArray[np.int32]
    face: NDArray[np.int32]
    seconds: float


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
    return _collect(shape, time.perf_counter() - start)


def largest_extent(shape: TopoDS_Shape) -> tuple[float, float, float]:
    """Sizes of the shape's bounding box along x, y and z, model units, as OpenCascade's viewers compute it."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    low, high = box.CornerMin(), box.CornerMax()
    return high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()


def _collect(shape: TopoDS_Shape, seconds: float) -> Mesh:
    """Asking for the nodes one by one costs microseconds each; so the triangulations are put on faces without surfaces,
    whose binary form is little else."""
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    owner, matrices, reversed_ = [], [], []
    for index in range(faces.Extent()):
        face = TopoDS.Face_s(faces.FindKey(index + 1))
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        if triangulation is None:
            continue
        bare = TopoDS_Face()
        builder.MakeFace(bare, triangulation)
        builder.Add(compound, bare)
        owner.append(index)
        matrices.append(_matrix(location))
        reversed_.append(face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED)
    if not owner:
        return Mesh(
            np.empty((0, 3)), *(np.empty((0, 3), t) for t in (np.float32, np.int32)), np.empty(0, np.int32), seconds
        )
    content = stream.read(compound)
    shapes = content.children.shape[content.children.offsets[content.root[1]] :][: len(owner)]
    parts = [content.triangulations[number] for number in content.faces.triangulation[shapes].tolist()]
    counts = np.array([len(nodes) for nodes, _ in parts])
    sizes = np.array([len(corners) for _, corners in parts])
    first = offsets_of(counts)[:-1]
    matrix = np.repeat(np.array(matrices), counts, axis=0)
    points = np.einsum("nij,nj->ni", matrix[:, :, :3], np.concatenate([nodes for nodes, _ in parts])) + matrix[:, :, 3]
    triangles = np.concatenate([corners for _, corners in parts]) + np.repeat(first, sizes)[:, None]
    backwards = np.repeat(np.array(reversed_) ^ (np.linalg.det(np.array(matrices)[:, :, :3]) < 0), sizes)
    triangles[backwards] = triangles[backwards][:, ::-1]
    face = np.repeat(np.array(owner, np.int32), sizes)
    return Mesh(points, _normals(points, triangles), triangles.astype(np.int32), face, seconds)


def _matrix(location: TopLoc_Location) -> list[list[float]]:
    if location.IsIdentity():
        return [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]
    transformation = location.Transformation()
    return [[transformation.Value(row, column) for column in (1, 2, 3, 4)] for row in (1, 2, 3)]


def _normals(points: NDArray[np.float64], triangles: NDArray[np.int_]) -> NDArray[np.float32]:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    corner = triangles.ravel()
    sums = np.stack([np.bincount(corner, np.repeat(area[:, k], 3), len(points)) for k in range(3)], axis=1)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.divide(sums, length, out=sums, where=length > 0).astype(np.float32)
