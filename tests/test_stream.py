"""The binary stream: everything it holds comes out as OpenCascade itself has it."""

from __future__ import annotations

import io

import numpy as np
import pytest

from conftest import SHARED_MODELS

pytest.importorskip("OCP")

import OCP.BinTools as bintools
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from nofacet.cad import stream
from nofacet.cad.convert import convert, placed_faces
from nofacet.cad.locations import multiply
from nofacet.errors import InputError


def moved(dx: float, angle: float) -> TopLoc_Location:
    turn, step = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)), angle)
    step.SetTranslation(gp_Vec(dx, 0, 1))
    return TopLoc_Location(turn) * TopLoc_Location(step)


def compound(*shapes: TopoDS_Shape) -> TopoDS_Compound:
    result, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(result)
    for shape in shapes:
        builder.Add(result, shape)
    return result


def nested() -> TopoDS_Shape:
    """An assembly of assemblies that uses one box nine times, two reversed, four of them at two places."""
    box = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()
    there = moved(5, 0.3)
    pair = compound(box, box.Moved(there), box.Moved(there), box.Moved(moved(9, 1.0)).Reversed())
    return compound(pair.Moved(moved(1, 0.5)), pair.Moved(moved(-20, 2.0)), box).Moved(moved(3, -0.7))


def brep(path: str) -> TopoDS_Shape:
    if not (SHARED_MODELS / path).exists():
        pytest.skip(f"{SHARED_MODELS / path} is not there")
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, str(SHARED_MODELS / path), BRep_Builder())
    return shape


def occ_faces(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_FACE, faces)
    return [TopoDS.Face_s(faces.FindKey(k)) for k in range(1, faces.Extent() + 1)]


@pytest.mark.parametrize("source", ["nested", "occt/Ball.brep", "occt/MODERN_Sink_1.brep", "aero/wing_assy.brep"])
def test_faces_come_in_the_order_orientation_and_place_that_opencascade_gives(source: str) -> None:
    shape = nested() if source == "nested" else brep(source)
    theirs = occ_faces(shape)
    parsed = stream.read(shape)
    ours = placed_faces(parsed)
    model = convert(shape, source)
    assert len(ours.shape) == len(theirs) == model.face_count
    assert ours.orientation.tolist() == [int(face.Orientation().value) for face in theirs]
    same_shape: dict[int, TopoDS_Shape] = {}
    for k, (number, reference) in enumerate(zip(ours.shape.tolist(), theirs, strict=True)):
        assert same_shape.setdefault(number, reference).IsPartner(reference)
        own = TopLoc_Location()
        BRep_Tool.Surface_s(TopoDS.Face_s(reference.Located(TopLoc_Location())), own)
        trsf = (reference.Location() * own).Transformation()
        expected = [[trsf.Value(row, column) for column in range(1, 5)] for row in range(1, 4)]
        np.testing.assert_allclose(model.placements[model.face_placement[k], :3], expected, atol=1e-12)
    assert model.definition_count == len(same_shape)


def test_instances_share_one_definition() -> None:
    model = convert(nested(), "nested")
    assert model.definition_count == 6
    assert model.face_count == 6 * 7  # the two copies at one place are the same faces
    assert model.patch_count == 6


def test_locations_multiply_like_opencascades() -> None:
    a, b = ((1, 1),), ((2, 1),)
    assert multiply(a, b) == ((2, 1), (1, 1))
    assert multiply(a, ((1, -1),)) == ()
    assert multiply(a, ((1, 2), (2, 1))) == ((1, 2), (2, 1), (1, 1))
    inverse = ((1, -1), (2, -1))
    assert multiply(multiply(a, b), inverse) == ()


def test_null_shapes_and_foreign_bytes_are_input_errors() -> None:
    with pytest.raises(InputError):
        stream.read(TopoDS_Shape())
    with pytest.raises(InputError):
        stream.parse(b"\nOpen CASCADE Topology V3 (c)\nLocations 0\n")


def test_bytes_that_end_too_early_are_input_errors() -> None:
    buffer = io.BytesIO()
    shape = compound(nested(), BRepPrimAPI_MakeCylinder(2.0, 5.0).Shape())
    bintools.BinTools.Write_s(shape, buffer, False, False, bintools.BinTools_FormatVersion_VERSION_4)
    data = buffer.getvalue()
    assert len(stream.parse(data).kinds) > 20
    for length in [*range(0, len(data) - 1, 97), len(data) - 1]:
        with pytest.raises(InputError):
            stream.parse(data[:length])


def test_edges_and_curves_of_a_cylinder() -> None:
    parsed = stream.read(BRepPrimAPI_MakeCylinder(2.0, 5.0).Shape())
    kinds = [surface.kind for surface in parsed.surfaces[1:]]
    assert sorted(kinds) == ["cylinder", "plane", "plane"]
    cylinder = next(surface for surface in parsed.surfaces[1:] if surface.kind == "cylinder")
    assert cylinder.radii[0] == 2.0
    circles = [curve for curve in parsed.curves[1:] if curve.kind == "circle"]
    assert len(circles) == 2 and all(np.hypot(circle.a[0], circle.a[1]) == 2.0 for circle in circles)
    assert (parsed.kinds == stream.EDGE).sum() == 3
    assert np.count_nonzero(parsed.pcurves.second) == 1  # the seam


def test_faces_with_triangles_only() -> None:
    from OCP.gp import gp_Pnt
    from OCP.Poly import Poly_Triangle, Poly_Triangulation
    from OCP.TopoDS import TopoDS_Face

    mesh = Poly_Triangulation(4, 2, False)
    corners = [(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 1)]
    for k, corner in enumerate(corners, 1):
        mesh.SetNode(k, gp_Pnt(*corner))
    mesh.SetTriangle(1, Poly_Triangle(1, 2, 3))
    mesh.SetTriangle(2, Poly_Triangle(1, 3, 4))
    face = TopoDS_Face()
    BRep_Builder().MakeFace(face, mesh)
    model = convert(face, "mesh")
    assert model.surface_type == ["triangles"] and model.trimmed[0] == 1
    (group,) = model.groups
    assert group.degree == (1, 1)
    np.testing.assert_array_equal(group.domain, [[0, 1, 0, 1], [0, 1, 2, 3]])
    np.testing.assert_array_equal(group.control_points[1, 0, 0, :3], corners[0])
    np.testing.assert_array_equal(group.control_points[1, 1, 0, :3], corners[2])
    np.testing.assert_array_equal(group.control_points[1, 0, 1, :3], corners[3])
    assert len(model.loop_offsets) == 3
    assert model.warnings == ["1 faces are given as triangles only and are drawn as those triangles"]
