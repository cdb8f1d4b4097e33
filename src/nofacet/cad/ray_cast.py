"""OpenCascade's own exact ray casting: slow, and sharing no code with the project's methods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.Standard import Standard_Failure
from OCP.TopAbs import TopAbs_State
from OCP.TopoDS import TopoDS_Shape

TOLERANCE = 1e-9  # model units
GRAZING = 0.05  # the sine of the largest angle between ray and surface that is called grazing
NEWTON_STEPS, NEWTON_TOLERANCE = 12, 1e-13
FAR = 1e100


class RayCaster:
    """A shape prepared for IntCurvesFace_ShapeIntersector. A ray that OpenCascade gives up on hits nothing."""

    def __init__(self, shape: TopoDS_Shape) -> None:
        self._intersector = IntCurvesFace_ShapeIntersector()
        self._intersector.Load(shape, TOLERANCE)

    def depth(self, origin: NDArray[np.float64], direction: NDArray[np.float64]) -> float:
        """Distance along the unit direction (3,) to the nearest hit from origin (3,), model units; +inf without one."""
        hits = range(1, self._cast(origin, direction) + 1)
        return min((self._intersector.WParameter(k) for k in hits), default=np.inf)

    def covers(self, origin: NDArray[np.float64], direction: NDArray[np.float64]) -> bool:
        """Whether the ray hits a face inside its trim loops: the intersector also reports hits outside them by as much
        as the edges' tolerances, which can be large."""
        return any(self._is_inside(k) for k in range(1, self._cast(origin, direction) + 1))

    def silhouette(
        self, origin: NDArray[np.float64], direction: NDArray[np.float64], up: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """The point (3,) near the ray's hits where a surface, met at a grazing angle, is seen edge-on, in the plane
        through the ray and across `up`; by Newton's method. None where no hit is grazing or the method strays."""
        hits = range(1, self._cast(origin, direction) + 1)
        places = [
            (self._intersector.Face(k), self._intersector.UParameter(k), self._intersector.VParameter(k)) for k in hits
        ]
        for face, u, v in places:
            surface = BRepAdaptor_Surface(face, False)
            for iteration in range(NEWTON_STEPS):
                point, du, dv, duu, dvv, duv = _derivatives(surface, u, v)
                normal = np.cross(du, dv)
                slant = float(normal @ direction)
                if iteration == 0 and abs(slant) > GRAZING * np.linalg.norm(normal):
                    break
                slopes = [np.cross(duu, dv) + np.cross(du, duv), np.cross(duv, dv) + np.cross(du, dvv)]
                matrix = np.array([[slope @ direction for slope in slopes], [du @ up, dv @ up]])
                if abs(np.linalg.det(matrix)) < 1e-300:
                    break
                step = np.linalg.solve(matrix, np.array([-slant, float((origin - point) @ up)]))
                u, v = u + float(step[0]), v + float(step[1])
                if np.abs(step).max() < NEWTON_TOLERANCE * max(1.0, abs(u), abs(v)):
                    return _derivatives(surface, u, v)[0]
        return None

    def _cast(self, origin: NDArray[np.float64], direction: NDArray[np.float64]) -> int:
        """Number of hits."""
        line = gp_Lin(gp_Pnt(*map(float, origin)), gp_Dir(*map(float, direction)))
        try:
            self._intersector.Perform(line, 0.0, FAR)
        except Standard_Failure:
            return 0
        return int(self._intersector.NbPnt()) if self._intersector.IsDone() else 0

    def _is_inside(self, hit: int) -> bool:
        place = gp_Pnt2d(self._intersector.UParameter(hit), self._intersector.VParameter(hit))
        state = BRepClass_FaceClassifier(self._intersector.Face(hit), place, TOLERANCE).State()
        return bool(state in (TopAbs_State.TopAbs_IN, TopAbs_State.TopAbs_ON))


def _derivatives(surface: BRepAdaptor_Surface, u: float, v: float) -> list[NDArray[np.float64]]:
    """Point, and derivatives by u, v, uu, vv, uv, each (3,)."""
    point, vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
    surface.D2(u, v, point, *vectors)
    return [np.array([one.X(), one.Y(), one.Z()]) for one in (point, *vectors)]
