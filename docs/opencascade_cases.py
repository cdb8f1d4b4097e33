"""Cases where OpenCascade contradicts itself or exact arithmetic: the proofs behind docs/accuracy.md.

    python docs/opencascade_cases.py [MODELS]

MODELS: the folder of the third-party test files (default: ../shared/models beside the repository).
"""

from __future__ import annotations

import sys
from fractions import Fraction
from math import comb
from pathlib import Path

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.BRepTopAdaptor import BRepTopAdaptor_FClass2d
from OCP.Geom import Geom_BezierSurface
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt, gp_Pnt2d
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.STEPControl import STEPControl_Reader
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array2OfReal
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_OUT
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape


def degree_25() -> None:
    """A rational Bezier surface of degree 25 x 2 and size 250: two evaluators of OpenCascade and exact fractions."""
    rng = np.random.default_rng(5)
    points, weights = np.empty((26, 3, 3)), rng.uniform(0.5, 2.0, (26, 3))
    points[..., 0], points[..., 1] = 10.0 * np.arange(26)[:, None], 10.0 * np.arange(3)
    points[..., 2] = rng.uniform(-5.0, 5.0, (26, 3))
    poles, weight_array = TColgp_Array2OfPnt(1, 26, 1, 3), TColStd_Array2OfReal(1, 26, 1, 3)
    for i, j in np.ndindex(26, 3):
        poles.SetValue(i + 1, j + 1, gp_Pnt(*map(float, points[i, j])))
        weight_array.SetValue(i + 1, j + 1, float(weights[i, j]))
    surface = Geom_BezierSurface(poles, weight_array)
    adaptor = BRepAdaptor_Surface(BRepBuilderAPI_MakeFace(surface, 1e-7).Face(), False)

    def exact(u: Fraction, v: Fraction) -> list[float]:
        total = [Fraction(0)] * 4
        for i, j in np.ndindex(26, 3):
            basis = comb(25, i) * u**i * (1 - u) ** (25 - i) * comb(2, j) * v**j * (1 - v) ** (2 - j)
            basis *= Fraction(float(weights[i, j]))
            total = [t + basis * Fraction(float(c)) for t, c in zip(total, [*points[i, j], 1.0], strict=True)]
        return [float(t / total[3]) for t in total[:3]]

    worst = {"Geom_Surface": 0.0, "BRepAdaptor_Surface": 0.0}
    for u, v in np.ndindex(9, 5):
        truth = exact(Fraction(u, 8), Fraction(v, 4))
        for name, evaluator in zip(worst, (surface, adaptor), strict=True):
            p = evaluator.Value(u / 8, v / 4)
            worst[name] = max(worst[name], float(np.linalg.norm(np.subtract((p.X(), p.Y(), p.Z()), truth))))
    print("degree 25, largest distance from exact fractions:", worst)


def read(path: Path) -> TopoDS_Shape:
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def classifiers(faces: TopTools_IndexedMapOfShape, index: int, box: tuple[float, float, float, float]) -> None:
    """Random points of a face's parameter box through OpenCascade's two classifiers."""
    face = TopoDS.Face_s(faces.FindKey(index + 1))
    other = BRepTopAdaptor_FClass2d(face, 1e-9)
    rng = np.random.default_rng(1)
    out, other_out = 0, 0
    for _ in range(3000):
        point = gp_Pnt2d(float(rng.uniform(*box[:2])), float(rng.uniform(*box[2:])))
        out += BRepClass_FaceClassifier(face, point, 1e-9).State() == TopAbs_OUT
        other_out += other.Perform(point) == TopAbs_OUT
    print(f"face {index}, 3000 points: BRepClass_FaceClassifier {out} OUT, BRepTopAdaptor_FClass2d {other_out} OUT")


def outline(face: TopoDS_Face) -> None:
    """Each edge's range in its own parameter, and the largest gap between neighbouring curves in (u, v)."""
    explorer = TopExp_Explorer(face, TopAbs_EDGE)
    ends, ranges = [], []
    while explorer.More():
        curve = BRepAdaptor_Curve2d(TopoDS.Edge_s(explorer.Current()), face)
        ranges.append(curve.LastParameter() - curve.FirstParameter())
        ends += [curve.Value(curve.FirstParameter()), curve.Value(curve.LastParameter())]
        explorer.Next()
    gaps = [min(p.Distance(q) for k, q in enumerate(ends) if k // 2 != own // 2) for own, p in enumerate(ends)]
    print(f"  shortest parameter range {min(ranges):.3g}, largest gap of the outline in (u, v) {max(gaps):.3g}")


def throwing_ray(path: Path, origin: tuple[float, float, float], direction: tuple[float, float, float]) -> None:
    """One ray on which OpenCascade's ray caster throws, and its neighbour 1 mm beside it."""
    caster = IntCurvesFace_ShapeIntersector()
    caster.Load(read(path), 1e-9)
    for x in (origin[0], origin[0] - 1.0):
        try:
            caster.Perform(gp_Lin(gp_Pnt(x, *origin[1:]), gp_Dir(*direction)), 0.0, 1e100)
            print(f"{path.name}, ray from x = {x}: {caster.NbPnt()} hits")
        except Exception as failure:  # OpenCascade's exceptions have no other common base in Python
            print(f"{path.name}, ray from x = {x}: {type(failure).__name__}")


def disagreement(path: Path, index: int, points: list[tuple[float, float]]) -> None:
    """Points far from every edge of a face on which the two classifiers differ."""
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(read(path), TopAbs_FACE, faces)
    face = TopoDS.Face_s(faces.FindKey(index + 1))
    for u, v in points:
        one = BRepClass_FaceClassifier(face, gp_Pnt2d(u, v), 1e-9).State()
        other = BRepTopAdaptor_FClass2d(face, 1e-9).Perform(gp_Pnt2d(u, v))
        print(f"face {index}, ({u}, {v}): BRepClass_FaceClassifier {one}, BRepTopAdaptor_FClass2d {other}")


def main() -> None:
    models = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2] / "shared" / "models"
    degree_25()
    faces = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(read(models / "parts" / "SparkFun Arduino Pro Mini.step"), TopAbs_FACE, faces)
    boxes = {
        289: (-12.0, -1.0, 0.0, 1.0),
        135: (0.1, 0.7, -3.05, -0.15),
        520: (-0.3, -0.001, 0.13, 0.83),
        521: (-0.3, -0.001, 0.1, 1.07),
    }
    for index, box in boxes.items():
        classifiers(faces, index, box)
        outline(TopoDS.Face_s(faces.FindKey(index + 1)))
    disagreement(models / "parts" / "SparkFun Arduino Pro Mini.step", 484, [(0.3303941713880292, -3.0383892537057977)])
    disagreement(models / "parts" / "RJ24.stp", 7, [(-5.0, -1.3), (-100.0, -10.0)])
    throwing_ray(
        models / "probe" / "ap203_near_degenerate_nurbs_pole.stp",
        (1043.9101807126312, 2483.6069774343578, -1455.8945095941976),
        (-0.4673233688793352, -0.7241885784628348, 0.5071092305640348),
    )
    throwing_ray(
        models / "cax" / "HEAD_BACK.stp",
        (-27.108957833052024, 324.97314207202453, -71.12101365876921),
        (0.5583923151650322, -0.8002322762629899, 0.2186923098592845),
    )


if __name__ == "__main__":
    main()
