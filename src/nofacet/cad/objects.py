"""CAD objects in memory to one OpenCascade shape with colours, names and assembly tree.

cadquery and build123d are recognised by the classes of the object and never imported here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from OCP.BinTools import BinTools
from OCP.BRep import BRep_Builder
from OCP.Quantity import Quantity_ColorRGBA
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Iterator, TopoDS_Shape

from nofacet.cad.appearance import Appearance, FaceIndex
from nofacet.errors import InputError


def cad_object(source: Any) -> tuple[TopoDS_Shape, Appearance]:
    """The shape of a CAD object, whose faces number the model's, and its appearance.

    Accepts a TopoDS_Shape, a cadquery Workplane, Shape or Assembly, a build123d shape, assembly, builder or list of
    shapes. Raises InputError for anything else and for objects without faces.
    """
    kind = type(source).__name__
    if _is_a(source, "cadquery", "Assembly"):
        shape = source.toCompound().wrapped
        index = _face_index(shape, kind)
        appearance = Appearance.plain(len(index))
        _add_cadquery_assembly(source, TopLoc_Location(), -1, None, index, appearance)
        return shape, appearance
    if _is_a(source, "build123d", "Builder"):
        source = source._obj  # BuildPart.part, BuildSketch.sketch, BuildLine.line
    if _is_a(source, "build123d", "Shape") and _wrapped(source):
        shape = source.wrapped
        index = _face_index(shape, kind)
        appearance = Appearance.plain(len(index))
        _add_build123d(source, shape, -1, index, appearance)
        return shape, appearance
    shape = _plain_shape(source)
    if shape is None or shape.IsNull():
        if _package(source) in ("cadquery", "build123d"):
            raise InputError(f"this {kind} object holds no shape, so there is nothing to draw; build one first")
        raise InputError(
            f"cannot draw an object of type {kind}; give a file, a cadquery Workplane, Shape or Assembly, "
            "a build123d object, or a TopoDS_Shape"
        )
    return shape, Appearance.plain(len(_face_index(shape, kind)))


def write_brep(shape: TopoDS_Shape, path: str) -> None:
    """Write a binary BREP file. Raises OSError where it cannot be written."""
    if not BinTools.Write_s(shape, path):
        raise OSError(f"{path}: OpenCascade cannot write there; check the folder and the free space")


def _package(source: Any) -> str:
    return type(source).__module__.split(".")[0]


def _is_a(source: Any, package: str, class_name: str) -> bool:
    return any(c.__name__ == class_name and c.__module__.split(".")[0] == package for c in type(source).__mro__)


def _wrapped(source: Any) -> TopoDS_Shape | None:
    try:
        shape = getattr(source, "wrapped", None)
    except AssertionError:  # build123d's way of saying that there is none
        return None
    return shape if isinstance(shape, TopoDS_Shape) else None


def _plain_shape(source: Any) -> TopoDS_Shape | None:
    if isinstance(source, TopoDS_Shape):
        return source
    if _is_a(source, "cadquery", "Workplane"):
        return _together(source.vals())
    if _is_a(source, "build123d", "ShapeList"):
        return _together(source)
    return _wrapped(source)


def _together(objects: Iterable[Any]) -> TopoDS_Shape | None:
    """The one shape among the objects, or the compound of several; points and planes do not count."""
    shapes = [shape for item in objects if (shape := _wrapped(item))]
    if len(shapes) < 2:
        return shapes[0] if shapes else None
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def _face_index(shape: TopoDS_Shape, kind: str) -> FaceIndex:
    index = FaceIndex(shape)
    if not len(index):
        raise InputError(f"this {kind} object has no faces, so there is nothing to draw; give a solid or a surface")
    return index


def _add_cadquery_assembly(
    assembly: Any,
    location: TopLoc_Location,
    parent: int,
    color: Quantity_ColorRGBA | None,
    index: FaceIndex,
    appearance: Appearance,
) -> None:
    """Add one cadquery Assembly and what is below it; colour is inherited by those that have none."""
    location = location.Multiplied(assembly.loc.wrapped)
    color = assembly.color.wrapped if assembly.color else color
    faces = [index.faces_of(shape.wrapped.Moved(location, False)) for shape in assembly.shapes]
    node = appearance.add_node(assembly.name, parent, np.concatenate(faces) if faces else None)
    if color:
        appearance.paint(appearance.tree[node].faces, color)
    for shape, subshape_color in getattr(assembly, "_subshape_colors", {}).items():
        if subshape_color:
            appearance.paint(index.faces_of(shape.wrapped.Moved(location, False)), subshape_color.wrapped)
    for shape, name in getattr(assembly, "_subshape_names", {}).items():
        if shape.wrapped.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE:
            for face in index.faces_of(shape.wrapped.Moved(location, False)):
                appearance.face_name[face] = name
    for child in assembly.children:
        _add_cadquery_assembly(child, location, node, color, index, appearance)


def _add_build123d(
    node_shape: Any, placed: TopoDS_Shape, parent: int, index: FaceIndex, appearance: Appearance
) -> None:
    """Add one build123d shape and its children, whose colours beat its own.

    placed: the shape in the world. Children are found in it by their order, for a moved or copied assembly no longer
    shares its shape with its children.
    """
    faces = index.faces_of(placed)
    if node_shape.color is not None:
        appearance.paint(faces, node_shape.color.wrapped)
    parts = []
    if node_shape.children:
        iterator = TopoDS_Iterator(placed)
        while iterator.More():
            parts.append(iterator.Value())
            iterator.Next()
    is_assembly = len(parts) == len(node_shape.children) > 0
    node = appearance.add_node(node_shape.label, parent, None if is_assembly else faces)
    if is_assembly:
        for child, part in zip(node_shape.children, parts, strict=True):
            _add_build123d(child, part, node, index, appearance)
