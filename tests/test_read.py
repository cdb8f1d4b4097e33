"""Reading: faces and their order, colours, names, tree, units; from files and from objects in memory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import build123d as bd
import cadquery as cq
import numpy as np
import pytest
from OCP.BinTools import BinTools
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Trsf, gp_Vec
from OCP.Quantity import Quantity_ColorRGBA
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from conftest import SHARED_MODELS
from nofacet.cad.appearance import FaceIndex
from nofacet.cad.load import load
from nofacet.cad.objects import cad_object
from nofacet.cad.read import read_file
from nofacet.errors import InputError
from nofacet.model import DEFAULT_COLOR, Node

needs_models = pytest.mark.skipif(
    not SHARED_MODELS.is_dir(), reason="the shared test models are not beside the repository"
)
GREY = DEFAULT_COLOR
RED, GREEN, BLUE, YELLOW = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (1.0, 1.0, 0.0, 1.0)


def colors_of(face_color: np.ndarray, faces: Any = slice(None)) -> set[tuple[float, ...]]:
    return {tuple(color) for color in face_color[faces].astype(float).round(4).tolist()}


def node_colors(model: Any) -> list[tuple[str, int, set[tuple[float, ...]]]]:
    """(name, number of own faces, their colours) of each node that has faces."""
    return [(n.name, len(n.faces), colors_of(model.face_color, n.faces)) for n in model.tree if len(n.faces)]


def path_of(tree: list[Node], number: int) -> str:
    node = tree[number]
    return node.name if node.parent < 0 else f"{path_of(tree, node.parent)}/{node.name}"


# Files


def faces_in_order(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_FACE, faces)
    return [faces.FindKey(i) for i in range(1, faces.Size() + 1)]


def signature(face: TopoDS_Shape) -> tuple[Any, ...]:
    """What tells one placed face from another: orientation, location, kind of surface, its vertices in the world."""
    transformation = face.Location().Transformation()
    location = [transformation.Value(row, column) for row in (1, 2, 3) for column in (1, 2, 3, 4)]
    vertices = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(face, TopAbs_ShapeEnum.TopAbs_VERTEX, vertices)
    points = [BRep_Tool.Pnt_s(TopoDS.Vertex_s(vertices.FindKey(i))).Coord() for i in range(1, vertices.Size() + 1)]
    has_surface = BRep_Tool.Surface_s(TopoDS.Face_s(face)) is not None
    kind = BRepAdaptor_Surface(TopoDS.Face_s(face), False).GetType() if has_surface else None
    return face.Orientation(), location, kind, points


def extent(shape: TopoDS_Shape) -> np.ndarray:
    """Extent of the vertices, (3,)."""
    return np.ptp([point for face in faces_in_order(shape) for point in signature(face)[3]], axis=0)


@needs_models
@pytest.mark.parametrize(
    "name",
    [
        "cax/as1-oc-214.stp",
        "cax/io1-tu-203.stp",
        "nist/nist_ctc_05_asme1_ap242-e1.stp",
        "nist/nist_ftc_08_asme1_ap242-e1-tg.stp",
        "aero/777-200LR_Onshape.step",
        "aero/F-16_OpenVSP3.5.0.stp",
        "parts/0934d80e-594d-480d-a3d9-4a029e0955b7.step",
        "parts/boxed_sphere.step",
        "parts/Design1.stp",
        "parts/plate_mode_samples_creo.stp",
        "parts/test_pipe_out_true.step",
    ],
)
def test_faces_and_their_order_are_those_of_the_plain_step_reader(name: str) -> None:
    path = str(SHARED_MODELS / name)
    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    expected = [signature(face) for face in faces_in_order(reader.OneShape())]
    file = read_file(path)
    assert [signature(face) for face in faces_in_order(file.shape)] == expected
    # every face hangs in the tree exactly once
    in_tree = np.concatenate([node.faces for node in file.appearance.tree])
    assert sorted(in_tree) == list(range(len(expected)))


@needs_models
def test_assembly_tree_and_colours() -> None:
    model = load(SHARED_MODELS / "cax/as1-oc-214.stp", measure=True)
    assert (model.face_count, model.definition_count, len(model.tree)) == (160, 53, 28)
    assert model.conversion_error.max() < 1e-9
    assert path_of(model.tree, 0) == "as1"
    paths = [path_of(model.tree, i) for i in range(len(model.tree))]
    assert "as1/l-bracket-assembly_2/nut-bolt-assembly_3/bolt_1" in paths
    assert paths.count("as1/rod-assembly_1/nut_1") == 1
    colors = {name.rsplit("_", 1)[0]: color for name, _, color in node_colors(model)}
    half = 0.2140  # linear value of sRGB 0.5
    assert colors == {
        "nut": {RED},
        "bolt": {BLUE},
        "l-bracket": {GREEN},
        "rod": {(1.0, half, 0.0, 1.0)},
        "plate": {(0.6038, 1.0, 0.0, 1.0)},
    }
    assert model.warnings == []


@needs_models
def test_many_instances_and_face_colours() -> None:
    file = read_file(str(SHARED_MODELS / "parts/SparkFun Arduino Pro Mini.step"))
    assert len(file.appearance.tree) == 53
    assert FaceIndex(file.shape).distinct() == 2332
    assert len(file.appearance.face_color) == 2844
    assert len(colors_of(file.appearance.face_color)) == 14
    colors = [(name, count, len(colors)) for name, count, colors in node_colors(file.appearance)]
    assert colors.count(("cap_603", 18, 1)) == 8  # one body of one part, placed eight times
    assert ("ATmega", 1413, 3) in colors
    assert file.warnings == []


@needs_models
def test_a_lost_face_is_reported() -> None:
    file = read_file(str(SHARED_MODELS / "aero/777-200LR_Onshape.step"))
    assert len(file.appearance.face_name) == 51
    assert file.warnings[0] == (
        "777-200LR_Onshape.step: the file declares 52 faces, OpenCascade delivered 51; 1 is missing from what is drawn"
    )


@needs_models
def test_units() -> None:
    inches, metres = (extent(read_file(str(SHARED_MODELS / f"cax/cube-{unit}.step")).shape) for unit in ("in", "m"))
    assert np.allclose(inches, metres, rtol=1e-9) and inches.min() > 1


@needs_models
def test_face_names() -> None:
    names = read_file(str(SHARED_MODELS / "cax/HEAD_BACK.stp")).appearance.face_name
    assert len(names) == 12 and all(name.startswith("*VOL5") for name in names)


@needs_models
def test_bodies_of_one_part_are_nodes() -> None:
    tree = read_file(str(SHARED_MODELS / "parts/boxed_sphere.step")).appearance.tree
    assert {node.name: len(node.faces) > 0 for node in tree} == {"Document": False, "box": True, "sphere": True}


@pytest.mark.parametrize("binary", [False, True])
def test_brep_file(tmp_path: Path, binary: bool) -> None:
    shape = BRepPrimAPI_MakeBox(1, 2, 3).Shape()
    path = tmp_path / "a box é.dat"  # no known extension, not ASCII
    (BinTools if binary else BRepTools).Write_s(shape, str(path))
    model = load(path)
    assert model.face_count == 6
    assert model.surface_type == ["plane"] * 6
    assert model.source == str(path)
    assert colors_of(model.face_color) == {GREY}


def test_brep_without_faces(tmp_path: Path) -> None:
    path = tmp_path / "line.brep"
    BRepTools.Write_s(cq.Edge.makeLine(cq.Vector(0, 0, 0), cq.Vector(1, 0, 0)).wrapped, str(path))
    with pytest.raises(InputError, match="has no faces"):
        load(path)


# Colour precedence, on a STEP file written for it


class StyledStep:
    """Writes an assembly with colours wherever XDE can put them."""

    def __init__(self) -> None:
        self.document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colors = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())

    def part(self, name: str, shape: TopoDS_Shape) -> TDF_Label:
        return self._named(self.shapes.AddShape(shape, False), name)

    def assembly(self, name: str) -> TDF_Label:
        return self._named(self.shapes.NewShape(), name)

    def place(self, name: str, into: TDF_Label, what: TDF_Label, x: float) -> TDF_Label:
        translation = gp_Trsf()
        translation.SetTranslation(gp_Vec(x, 0, 0))
        return self._named(self.shapes.AddComponent(into, what, TopLoc_Location(translation)), name)

    def paint(self, label: TDF_Label, color: tuple[float, ...]) -> None:
        self.colors.SetColor(label, Quantity_ColorRGBA(*color), XCAFDoc_ColorType.XCAFDoc_ColorSurf)

    def write(self, path: Path) -> str:
        self.shapes.UpdateAssemblies()
        writer = STEPCAFControl_Writer()
        writer.Transfer(self.document)
        writer.Write(str(path))
        return str(path)

    @staticmethod
    def _named(label: TDF_Label, name: str) -> TDF_Label:
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        return label


def test_face_beats_instance_and_instance_beats_part(tmp_path: Path) -> None:
    step = StyledStep()
    box = BRepPrimAPI_MakeBox(1, 1, 1).Shape()
    part = step.part("part", box)
    plain = step.part("unpainted", BRepPrimAPI_MakeBox(2, 2, 2).Shape())
    glass = (0.0, 0.0, 1.0, 0.5)
    step.paint(part, RED)
    step.paint(step.shapes.AddSubShape(part, TopExp_Explorer(box, TopAbs_ShapeEnum.TopAbs_FACE).Current()), glass)
    top, sub = step.assembly("top"), step.assembly("sub")
    step.place("as the part", sub, part, 0)
    step.paint(step.place("green", sub, part, 2), GREEN)
    step.place("from above", sub, plain, 4)
    step.place("sub 1", top, sub, 10)
    step.paint(step.place("sub 2", top, sub, 20), YELLOW)
    hidden = step.place("hidden", top, part, 30)
    step.colors.SetVisibility(hidden, False)

    file = read_file(step.write(tmp_path / "styled.step"))
    assert node_colors(file.appearance) == [
        ("as the part", 6, {RED, glass}),
        ("green", 6, {GREEN, glass}),
        ("from above", 6, {GREY}),
        ("as the part", 6, {RED, glass}),
        ("green", 6, {GREEN, glass}),
        ("from above", 6, {YELLOW}),  # the assembly's colour goes to what has none of its own
        ("hidden", 6, {RED, glass}),
    ]
    assert file.warnings == ["styled.step: 6 faces are marked hidden in the file and drawn all the same"]


def test_names_of_occurrences_fall_back_to_the_product(tmp_path: Path) -> None:
    step = StyledStep()
    top = step.assembly("top")
    bolt = step.part("bolt", BRepPrimAPI_MakeBox(1, 1, 1).Shape())
    step.place("NAUO7", top, bolt, 0)
    step.place("left bolt", top, bolt, 5)
    file = read_file(step.write(tmp_path / "named.step"))
    assert [node.name for node in file.appearance.tree] == ["top", "bolt", "left bolt"]


# Objects in memory, and what becomes of them in a STEP file


def cadquery_assembly() -> cq.Assembly:
    box = cq.Workplane().box(1, 2, 3)
    inner = cq.Assembly(name="inner", loc=cq.Location((9, 0, 0), (0, 1, 0), 30))
    inner.add(box, name="glass", color=cq.Color(0, 1, 0, 0.5))
    inner.add(cq.Workplane().sphere(1), name="ball", loc=cq.Location((0, 5, 0), (1, 0, 0), 20))
    inner.objects["glass"].addSubshape(box.faces(">Z").val(), name="lid", color=cq.Color(0, 0, 1))
    top = cq.Assembly(name="top", color=cq.Color(1, 0, 0), loc=cq.Location((1, 2, 3), (0, 0, 1), 30))
    top.add(cq.Workplane().box(1, 1, 1), name="box", loc=cq.Location((-4, 0, 0), (0, 1, 0), 45))
    top.add(inner)
    return top


def build123d_assembly() -> bd.Compound:
    glass = bd.Box(1, 2, 3)
    glass.label, glass.color = "glass", bd.Color(0, 1, 0, 0.5)
    ball = bd.Sphere(1).moved(bd.Location((0, 5, 0)))
    ball.label = "ball"
    box = bd.Box(1, 1, 1)
    box.label, box.color = "box", bd.Color(1, 0, 0)
    inner = bd.Compound(label="inner", children=[glass, ball])
    inner.color = bd.Color(0, 0, 1)
    inner.location = bd.Location((0, 0, 20), (1, 0, 0), 45)
    top = bd.Compound(label="top", children=[box, inner])
    top.location = bd.Location((100, 0, 0), (0, 1, 0), 45)
    return top


CADQUERY_COLORS = [
    ("box", 6, {RED}),
    ("glass", 6, {(0.0, 1.0, 0.0, 0.5), BLUE}),
    ("ball", 1, {RED}),  # inherited from the top
]
BUILD123D_COLORS = [("box", 6, {RED}), ("glass", 6, {(0.0, 1.0, 0.0, 0.5)}), ("ball", 1, {BLUE})]


def test_cadquery_assembly() -> None:
    assembly = cadquery_assembly()
    model = load(assembly)
    assert node_colors(model) == CADQUERY_COLORS
    assert [path_of(model.tree, i) for i in range(len(model.tree))] == [
        "top",
        "top/box",
        "top/inner",
        "top/inner/glass",
        "top/inner/ball",
    ]
    assert model.face_count == len(assembly.toCompound().Faces()) == 13
    assert model.face_name.count("lid") == 1


def test_cadquery_assembly_through_a_step_file(tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    cadquery_assembly().export(str(path))
    model = load(path)
    assert model.face_count == 13
    assert node_colors(model) == [  # cadquery writes colours to parts only: nothing is inherited
        ("box", 6, {GREY}),
        CADQUERY_COLORS[1],
        ("ball", 1, {GREY}),
    ]
    assert {"top", "inner"} <= {node.name for node in model.tree}
    assert model.face_name.count("lid") == 1


def test_build123d_assembly() -> None:
    assembly = build123d_assembly()
    assert node_colors(load(assembly)) == BUILD123D_COLORS
    # a moved or copied assembly shares no shapes with its children any more
    assert node_colors(load(bd.Pos(1, 2, 3) * assembly)) == BUILD123D_COLORS


def test_build123d_assembly_through_a_step_file(tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    bd.export_step(build123d_assembly(), str(path))
    model = load(path)
    colors = node_colors(model)
    assert [(count, color) for _, count, color in colors] == [(count, color) for _, count, color in BUILD123D_COLORS]
    names = ["box", "glass", "ball"]
    if all(f"'{name}'" in path.read_text() for name in names):  # build123d 0.10 writes none into the file
        assert [name for name, _, _ in colors] == names


def builder() -> bd.BuildPart:
    with bd.BuildPart() as part:
        bd.Sphere(1)
    return part


def sketch_builder() -> bd.BuildSketch:
    with bd.BuildSketch() as sketch:
        bd.Circle(1)
    return sketch


@pytest.mark.parametrize(
    ("source", "faces"),
    [
        (cq.Workplane().box(1, 1, 1), 6),
        (cq.Workplane().rarray(3, 3, 2, 2).box(1, 1, 1, combine=False), 24),
        (cq.Workplane().box(1, 1, 1).faces(">Z"), 1),
        (cq.Workplane().sphere(2).val(), 1),
        (cq.Workplane().sphere(2).val().wrapped, 1),
        (bd.Solid.make_box(1, 1, 1), 6),
        (bd.Box(1, 1, 1), 6),
        (bd.Box(1, 1, 1).faces(), 6),
        (builder(), 1),
        (sketch_builder(), 1),
    ],
    ids=lambda value: type(value).__name__,
)
def test_objects_in_memory(source: Any, faces: int) -> None:
    model = load(source)
    assert model.face_count == faces
    assert model.source == type(source).__name__


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        (cq.Workplane(), "holds no shape"),
        (cq.Workplane().box(1, 1, 1).edges(), "has no faces"),
        (cq.Assembly(), "has no faces"),
        (bd.Part(), "holds no shape"),
        (bd.BuildPart(), "this BuildPart object holds no shape"),
        (cq.Sketch(), "holds no shape"),
        (TopoDS_Shape(), "this TopoDS_Shape object holds no shape"),
        (bd.Box(1, 1, 1).edges(), "has no faces"),
        (None, "of type NoneType"),
        (np.zeros(3), "of type ndarray"),
    ],
)
def test_objects_without_faces(source: Any, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        cad_object(source)


def test_loading_a_file_imports_neither_opencascade_nor_cad_packages(tmp_path: Path) -> None:
    path = tmp_path / "box.brep"
    BRepTools.Write_s(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), str(path))
    program = (
        "import sys; from nofacet.cad.load import load; assert load(sys.argv[1]).face_count == 6; "
        "print(sorted({'OCP', 'cadquery', 'build123d'} & set(sys.modules)))"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry)}
    output = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, env=environment, check=True
    )
    assert output.stdout.strip() == "[]"


def test_a_sketch_is_its_faces() -> None:
    model = load(cq.Sketch().rect(4, 2).push([(10, 0)]).circle(1))
    assert sorted(model.surface_type) == ["plane", "plane"]
