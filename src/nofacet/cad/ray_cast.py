"""OpenCascade's own exact ray casting: slow, and sharing no code with the project's methods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt, gp_Pnt2d
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.Standard import Standard_Failure
from OCP.TopAbs import TopAbs_State
from OCP.TopoDS import TopoDS_Shape

TOLERANCE = 1e-9  # model units
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
