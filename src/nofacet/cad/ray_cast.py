"""OpenCascade's own exact ray casting: slow, and sharing no code with the project's methods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.Standard import Standard_Failure
from OCP.TopoDS import TopoDS_Shape

TOLERANCE = 1e-9  # model units
FAR = 1e100


class RayCaster:
    """A shape prepared for IntCurvesFace_ShapeIntersector."""

    def __init__(self, shape: TopoDS_Shape) -> None:
        self._intersector = IntCurvesFace_ShapeIntersector()
        self._intersector.Load(shape, TOLERANCE)

    def depth(self, origin: NDArray[np.float64], direction: NDArray[np.float64]) -> float:
        """Distance along the unit direction (3,) to the nearest hit from origin (3,), model units; +inf without one.

        A ray that OpenCascade gives up on has none.
        """
        line = gp_Lin(gp_Pnt(*map(float, origin)), gp_Dir(*map(float, direction)))
        try:
            self._intersector.Perform(line, 0.0, FAR)
        except Standard_Failure:
            return np.inf
        count = self._intersector.NbPnt() if self._intersector.IsDone() else 0
        return min((self._intersector.WParameter(k) for k in range(1, count + 1)), default=np.inf)
