"""What a file is and what its text declares, found from its bytes alone, without OpenCascade."""

from __future__ import annotations

import os
import re
from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from nofacet.errors import InputError, check_name

Format = Literal["step", "brep", "binary brep"]

_LFS_POINTER = b"version https://git-lfs.github.com/spec/"
_SIGNATURES: tuple[tuple[bytes, Format], ...] = (
    (b"ISO-10303-21", "step"),
    (b"Open CASCADE Topology", "binary brep"),
    (b"DBRep_DrawableShape", "brep"),
    (b"CASCADE Topology", "brep"),
)

# Entities that become one face each. A file with both kinds holds the tessellated ones as a second picture of the same
# faces, so they count only where there is no exact face. Bare surfaces of a geometric set are not counted.
_EXACT_FACE = rb"=\s*\(?\s*(?:ADVANCED_FACE|FACE_SURFACE|CURVE_BOUNDED_SURFACE)\s*\(\s*(?:'([^']*)')?"
_TESSELLATED_FACE = rb"=\s*\(?\s*(?:COMPLEX_|CUBIC_BEZIER_)?TRIANGULATED_FACE\s*\("
_BODY_NAME = rb"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|SHELL_BASED_SURFACE_MODEL)\s*\(\s*'([^']*)'"
_PRODUCT = rb"=\s*PRODUCT\s*\("
_NO_NAME = frozenset({b"", b"NONE", b"None", b"none"})


@dataclass(frozen=True)
class StepText:
    """What the text of a STEP file says about itself.

    declared_faces: number of face entities; 0 if the file writes its faces in another way.
    names_parts_of_shapes: faces or several bodies of one product carry names (reading those takes longer).
    complete: the text has its end mark; False: the file was cut short.
    utf8: all bytes are valid UTF-8; otherwise names are taken as ISO 8859-1.
    """

    declared_faces: int
    names_parts_of_shapes: bool
    complete: bool
    utf8: bool


def file_format(path: str) -> Format:
    """The format of a file, told by its content and never by its extension.

    Raises InputError if there is no such regular file, it cannot be opened, it is neither STEP nor BREP, or its name is
    not UTF-8.
    """
    check_name(path)
    head = _read_head(path)
    if not head.strip():
        raise InputError(f"{path}: is empty; export or copy the model again")
    if head.startswith(_LFS_POINTER):
        raise InputError(f"{path}: is a Git LFS pointer, not the model itself; run git lfs pull")
    for signature, file_format_ in _SIGNATURES:
        if signature in head:
            return file_format_
    raise InputError(f"{path}: is neither a STEP nor a BREP file (told by its content); export the model as STEP")


def _read_head(path: str) -> bytes:
    if os.path.isdir(path):
        raise InputError(f"{path}: is a directory; name a STEP or BREP file in it")
    if os.path.exists(path) and not os.path.isfile(path):
        raise InputError(f"{path}: is not a regular file; save the model to a file first")
    try:
        with open(path, "rb") as file:
            return file.read(4096)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except PermissionError:
        raise InputError(f"{path}: no permission to read it; change its permissions or copy it") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{path!r}: cannot be opened ({reason}); check the path") from None


def scan_step_text(text: bytes) -> StepText:
    """What the text of a STEP file declares (about 10 ms for 4 MB)."""
    exact = re.findall(_EXACT_FACE, text)
    bodies = _named(re.findall(_BODY_NAME, text))
    try:
        text.decode("utf-8")
        utf8 = True
    except UnicodeDecodeError:
        utf8 = False
    return StepText(
        declared_faces=len(exact) or len(re.findall(_TESSELLATED_FACE, text)),
        names_parts_of_shapes=bool(_named(exact)) or len(bodies) > len(re.findall(_PRODUCT, text)),
        complete=b"END-ISO-10303-21" in text,
        utf8=utf8,
    )


def _named(names: Collection[bytes]) -> set[bytes]:
    return {name for name in names if name.strip() not in _NO_NAME}
