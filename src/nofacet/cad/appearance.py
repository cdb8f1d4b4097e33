"""What faces look like and are called: colours, names and the assembly tree, face by face.

The order of faces is that of TopExp::MapShapes(shape, TopAbs_FACE), as everywhere in nofacet. Colours are linear RGBA.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from OCP.Quantity import Quantity_ColorRGBA
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_MapOfShape
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool
from OCP.XCAFPrs import XCAFPrs, XCAFPrs_IndexedDataMapOfShapeStyle

from nofacet.model import DEFAULT_COLOR, Model, Node

# What STEP writers put where nobody gave a name; what they call an occurrence that has no name but a number.
_NO_NAME = re.compile(r"NONE|=>\[.*\]", re.IGNORECASE)
_OCCURRENCE_NUMBER = re.compile(r"(NAUO)?\d*")


class FaceIndex:
    """The placed faces of a shape and the number of each, in MapShapes order from 0."""

    def __init__(self, shape: TopoDS_Shape) -> None:
        self._map = TopTools_IndexedMapOfShape()
        TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_FACE, self._map)

    def __len__(self) -> int:
        return self._map.Size()

    def faces_of(self, shape: TopoDS_Shape) -> NDArray[np.int32]:
        """Numbers (int32, in the shape's own order) of the faces of a shape placed in the same world."""
        if shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE:
            found = [self._map.FindIndex(shape)]
        else:
            part = TopTools_IndexedMapOfShape()
            TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_FACE, part)
            found = [self._map.FindIndex(part.FindKey(i)) for i in range(1, part.Size() + 1)]
        return np.array([i - 1 for i in found if i], dtype=np.int32)

    def distinct(self) -> int:
        """Number of distinct faces: those placed several times count once."""
        seen = TopTools_MapOfShape()
        nowhere = TopLoc_Location()
        for i in range(1, self._map.Size() + 1):
            seen.Add(self._map.FindKey(i).Located(nowhere))
        return seen.Size()


@dataclass
class Appearance:
    """Colours (F, 4) float32 linear RGBA, names (F) and the assembly tree of F faces.

    hidden: (F,) bool, True where the source marks the face as hidden.
    """

    face_color: NDArray[np.float32]
    face_name: list[str]
    hidden: NDArray[np.bool_]
    tree: list[Node] = field(default_factory=list)

    @classmethod
    def plain(cls, face_count: int) -> Appearance:
        """Default colour, no names, no tree."""
        color = np.tile(np.array(DEFAULT_COLOR, dtype=np.float32), (face_count, 1))
        return cls(face_color=color, face_name=[""] * face_count, hidden=np.zeros(face_count, np.bool_))

    def paint(self, faces: NDArray[np.int32], color: Quantity_ColorRGBA) -> None:
        """Give faces a colour."""
        rgb = color.GetRGB()  # OpenCascade keeps linear values
        self.face_color[faces] = (rgb.Red(), rgb.Green(), rgb.Blue(), color.Alpha())

    def add_node(self, name: str, parent: int, faces: NDArray[np.int32] | None = None) -> int:
        """Append a node of the tree; returns its number."""
        self.tree.append(Node(name, parent, np.empty(0, np.int32) if faces is None else faces))
        return len(self.tree) - 1

    def applied_to(self, model: Model) -> Model:
        """The model with these colours, names and tree."""
        return replace(model, face_color=self.face_color, face_name=self.face_name, tree=self.tree)


def document_appearance(document: TDocStd_Document, index: FaceIndex) -> Appearance:
    """Colours, names and tree that an XDE document (a STEP file as read) gives to the faces of its shape."""
    appearance = Appearance.plain(len(index))
    roots = TDF_LabelSequence()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    styles = XCAFPrs_IndexedDataMapOfShapeStyle()
    for label in roots:
        XCAFPrs.CollectStyleSettings_s(label, TopLoc_Location(), styles)
        _add_label(label, TopLoc_Location(), -1, index, appearance)
    _paint_styles(styles, index, appearance)
    return appearance


def _paint_styles(styles: XCAFPrs_IndexedDataMapOfShapeStyle, index: FaceIndex, appearance: Appearance) -> None:
    """Paint the styled shapes, the enclosing ones first, so that a face beats its solid and a solid its assembly.

    An instance and the part it places are one located shape, whose entry already holds the instance's colour, if it
    has one. Curve colours (wires, dimensions) do not paint surfaces. What lies in something hidden is hidden.
    """
    painted = []
    for i in range(1, styles.Size() + 1):
        shape, style = styles.FindKey(i), styles.FindFromIndex(i)
        faces = index.faces_of(shape)
        if not style.IsVisible():
            appearance.hidden[faces] = True
        if style.IsSetColorSurf():
            # TopAbs_ShapeEnum runs from compounds to vertices; of nested compounds the larger comes first, of equally
            # large ones the one that was collected last, since inner labels are collected before outer ones
            painted.append((shape.ShapeType().value, -len(faces), -i, faces, style.GetColorSurfRGBA()))
    painted.sort(key=lambda entry: entry[:3])
    for *_, faces, color in painted:
        appearance.paint(faces, color)


def _add_label(
    label: TDF_Label, location: TopLoc_Location, parent: int, index: FaceIndex, appearance: Appearance
) -> None:
    """Add the tree below one label: an assembly, an instance of one, or a part."""
    product, name = label, _label_name(label)
    referred = TDF_Label()
    if XCAFDoc_ShapeTool.GetReferredShape_s(label, referred):
        product = referred
        location = location.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
        if _OCCURRENCE_NUMBER.fullmatch(name):
            name = _label_name(product) or name
    components = TDF_LabelSequence()
    if XCAFDoc_ShapeTool.GetComponents_s(product, components, False):
        node = appearance.add_node(name, parent)
        for component in components:
            _add_label(component, location, node, index, appearance)
    else:
        _add_part(product, name, location, parent, index, appearance)


def _add_part(
    part: TDF_Label, name: str, location: TopLoc_Location, parent: int, index: FaceIndex, appearance: Appearance
) -> None:
    """Add a part: one node with its faces, and a node below it for each of several named bodies."""
    faces = index.faces_of(_placed(part, location))
    if not len(faces):  # dimensions, curves: nothing that is drawn
        return
    bodies = []
    sub_labels = TDF_LabelSequence()
    XCAFDoc_ShapeTool.GetSubShapes_s(part, sub_labels)
    for sub_label in sub_labels:
        sub_name = _label_name(sub_label)
        if not sub_name:
            continue
        shape = _placed(sub_label, location)
        kind = shape.ShapeType()
        if kind == TopAbs_ShapeEnum.TopAbs_FACE:
            for face in index.faces_of(shape):
                appearance.face_name[face] = sub_name
        elif kind in (TopAbs_ShapeEnum.TopAbs_SOLID, TopAbs_ShapeEnum.TopAbs_SHELL):
            bodies.append((sub_name, index.faces_of(shape)))
    if len(bodies) < 2:
        appearance.add_node(name, parent, faces)
        return
    in_bodies = np.concatenate([body_faces for _, body_faces in bodies])
    node = appearance.add_node(name, parent, faces[~np.isin(faces, in_bodies)])
    for body_name, body_faces in bodies:
        appearance.add_node(body_name, node, body_faces)


def _placed(label: TDF_Label, location: TopLoc_Location) -> TopoDS_Shape:
    # False: take scaling and mirroring locations as they are instead of throwing
    return XCAFDoc_ShapeTool.GetShape_s(label).Moved(location, False)


def _label_name(label: TDF_Label) -> str:
    if not label.IsAttribute(TDataStd_Name.GetID_s()):  # FindAttribute crashes where there is none
        return ""
    attribute = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), attribute)
    name = attribute.Get().ToExtString().strip()
    return "" if _NO_NAME.fullmatch(name) else name
