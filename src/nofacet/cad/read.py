"""A STEP or BREP file to one OpenCascade shape with its colours, names and assembly tree.

May hang, print or crash the process on damaged files, as OpenCascade does: call it through nofacet.cad.worker.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from OCP.BinTools import BinTools
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Standard import Standard_Failure
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ShapeTool

from nofacet.cad.appearance import Appearance, FaceIndex, document_appearance
from nofacet.cad.formats import StepText, file_format, scan_step_text
from nofacet.errors import InputError

_DAMAGED = "the file is probably damaged, export it again"
_NO_FACES = "has no faces, so there is nothing to draw; export solids or surfaces, not only curves or annotations"


@dataclass(frozen=True)
class CadFile:
    """The contents of a file: at least one face, lengths in mm for STEP and as written for BREP.

    shape: for STEP the shape of STEPControl_Reader.OneShape() after TransferRoots(): its faces number the model's.
    warnings: one line each.
    """

    shape: TopoDS_Shape
    appearance: Appearance
    warnings: list[str]


def read_file(path: str, enter_stage: Callable[[str], None] = lambda stage: None) -> CadFile:
    """Read a STEP (AP203, AP214, AP242) or BREP (ASCII, binary) file, told apart by content.

    enter_stage is called with a few words as each stage begins.
    Raises InputError if nothing can be drawn; faces that are lost on the way are named in the warnings.
    """
    format_ = file_format(path)
    enter_stage("reading the file")
    try:
        return _read_step(path, enter_stage) if format_ == "step" else _read_brep(path, format_ == "binary brep")
    except (Standard_Failure, RuntimeError) as error:
        detail = re.sub(r".*\b0x[0-9a-f]+ : ", "", " ".join(str(error).split()))  # without the place in the program
        reason = detail or type(error).__name__
        raise InputError(f"{path}: OpenCascade cannot read it ({reason}); {_DAMAGED}") from error


def _read_brep(path: str, binary: bool) -> CadFile:
    shape = TopoDS_Shape()
    read = BinTools.Read_s(shape, path) if binary else BRepTools.Read_s(shape, path, BRep_Builder())
    if not read or shape.IsNull():
        raise InputError(f"{path}: OpenCascade cannot read this BREP file; {_DAMAGED}")
    index = FaceIndex(shape)
    if not len(index):
        raise InputError(f"{path}: {_NO_FACES}")
    return CadFile(shape, Appearance.plain(len(index)), [])


def _read_step(path: str, enter_stage: Callable[[str], None]) -> CadFile:
    with open(path, "rb") as file:
        text = scan_step_text(file.read())
    reader = _step_reader(text)
    # Transferring after any other status than RetDone crashes OpenCascade
    if reader.ReadFile(path) != IFSelect_ReturnStatus.IFSelect_RetDone:
        if not text.complete:
            raise InputError(f"{path}: is cut short (END-ISO-10303-21 is missing); copy or export it again")
        raise InputError(f"{path}: OpenCascade cannot read this STEP file; {_DAMAGED}")
    errors = _text_errors(reader)
    enter_stage("transferring the shapes" + (f" of a file with {errors}" if errors else ""))
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader.Transfer(document)
    shape = reader.ChangeReader().OneShape()
    index = None if shape.IsNull() else FaceIndex(shape)
    if not index:
        if not text.declared_faces:
            raise InputError(f"{path}: {_NO_FACES}")
        lost = f"the file declares {text.declared_faces} faces, OpenCascade delivered none"
        raise InputError(f"{path}: {lost}; {errors or 'it is damaged or unusual'}; export it again")
    enter_stage("collecting colours and names")
    appearance = document_appearance(document, index)
    name = os.path.basename(path)
    return CadFile(shape, appearance, [f"{name}: {loss}" for loss in _losses(text, errors, index, appearance)])


def _text_errors(reader: STEPCAFControl_Reader) -> str:
    """The syntax errors and unresolved references in the text, in a few words; "" if there are none."""
    check = reader.ChangeReader().WS().Model().GlobalCheck(True)
    count = check.NbFails()
    if not count:
        return ""
    first = " ".join(check.CFail(1).split())
    return f"{count} {'error' if count == 1 else 'errors'} in its text ({'' if count == 1 else 'the first: '}{first})"


def _losses(text: StepText, errors: str, index: FaceIndex, appearance: Appearance) -> Iterator[str]:
    """What of the file is not drawn, or not as the file says."""
    delivered = index.distinct()
    missing = text.declared_faces - delivered
    if missing > 0:
        yield (
            f"the file declares {text.declared_faces} faces, OpenCascade delivered {delivered}; "
            f"{missing} {'is' if missing == 1 else 'are'} missing from what is drawn"
        )
    if errors:
        yield f"the file has {errors}; what depends on that is missing or wrong"
    if not text.complete:
        yield "END-ISO-10303-21 is missing: the file may be cut short"
    hidden = int(appearance.hidden.sum())
    if hidden:
        yield f"{hidden} {'face is' if hidden == 1 else 'faces are'} marked hidden in the file and drawn all the same"


def _step_reader(text: StepText) -> STEPCAFControl_Reader:
    reader = STEPCAFControl_Reader()  # registers the settings below
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", int(text.names_parts_of_shapes))
    Interface_Static.SetCVal_s("read.stepcaf.codepage", "UTF8" if text.utf8 else "ISO8859-1")
    XCAFDoc_ShapeTool.SetAutoNaming_s(False)
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    reader.SetSHUOMode(True)  # colours of one occurrence inside an assembly that is placed several times
    reader.SetLayerMode(False)
    reader.SetPropsMode(False)
    reader.SetGDTMode(False)
    reader.SetMatMode(False)
    reader.SetViewMode(False)
    return reader
