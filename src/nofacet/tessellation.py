"""From a file or CAD object to OpenCascade's triangles of it."""

from __future__ import annotations

import os
from typing import Any

from .mesh import Mesh
from .mesh_setting import MeshSetting

FINEST_DEFLECTION = 1e-7  # model units, OpenCascade's Precision::Confusion()
FINEST_ANGLE = 1e-12  # radians, its Precision::Angular()


def read_shape(source: Any) -> Any:
    """The OpenCascade shape (TopoDS_Shape) that nofacet.load(source) numbers the faces of.

    A file is read in this process, which a damaged one can stop or crash: read it with load() first, or read the shape
    in a process of its own. Raises InputError as load() does.
    """
    if isinstance(source, (str, os.PathLike)):
        from .cad.read import read_file

        return read_file(os.fsdecode(source)).shape
    from .cad.objects import cad_object

    return cad_object(source)[0]


def tessellate(source: Any, setting: MeshSetting) -> Mesh:
    """OpenCascade's triangles of what nofacet.load(source) takes, in this process (see read_shape).

    Triangles that a shape given had before are thrown away. Faces that OpenCascade cannot mesh have none.
    Raises InputError as load() does, ValueError for a deflection or an angle that OpenCascade takes for 0.
    """
    from .cad.tessellate import box_sides, tessellate

    shape = read_shape(source)
    absolute = setting.for_box(box_sides(shape))
    if absolute.deflection < FINEST_DEFLECTION or absolute.angle < FINEST_ANGLE:
        raise ValueError(
            f"mesh setting {setting.name!r}: deflection {absolute.deflection:g} and angle {absolute.angle:g}; "
            f"OpenCascade needs at least {FINEST_DEFLECTION:g} model units and {FINEST_ANGLE:g} radians"
        )
    return tessellate(shape, absolute.deflection, absolute.angle, absolute.delabella)


def write_shape(source: Any, path: str | os.PathLike[str]) -> None:
    """Write the shape of a CAD object to a binary BREP file that load() and read_shape() read; its faces keep their
    order. Raises InputError for an object without faces, OSError where the file cannot be written."""
    from .cad.objects import write_brep

    write_brep(read_shape(source), os.fspath(path))
