"""Curves in (u, v) for faces that lack them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .approximate import face_of

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shape


def face_with_pcurves(shape: TopoDS_Shape, index: int) -> TopoDS_Face:
    """A copy of face `index` of TopExp::MapShapes(shape, TopAbs_FACE), at its definition's place, taken forward, with
    every missing pcurve projected from the 3-D edge. The shape itself is not changed."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.ShapeFix import ShapeFix_Edge
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    bare = face_of(shape, index).Located(TopLoc_Location()).Oriented(TopAbs_FORWARD)
    face = TopoDS.Face_s(BRepBuilderAPI_Copy(bare).Shape())
    fixer = ShapeFix_Edge()
    explorer = TopExp_Explorer(face, TopAbs_EDGE)
    while explorer.More():
        fixer.FixAddPCurve(TopoDS.Edge_s(explorer.Current()), face, False)
        explorer.Next()
    return face
