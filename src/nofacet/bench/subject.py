"""A model that is measured: its OpenCascade shape, its patches and the camera that all methods share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..camera import Camera
from ..errors import InputError
from ..model import Model

PRIMITIVES = ("sphere", "torus")  # made by OpenCascade, the rest comes from files
OWN = ("bottle", "flange", "teapot")
SMALL_PATCHES = ("teapots", "chain")
THIRD_PARTY = {"ctc_02": "nist/nist_ctc_02_asme1_rc.stp", "linkrods": "occt/linkrods.step"}
OWN_FOLDER, THIRD_PARTY_FOLDER = Path("cad_models"), Path("../shared/models")  # from the repository's root


@dataclass(frozen=True)
class Subject:
    """One model under its fitted orthographic camera.

    shape: the OpenCascade shape the model was made of, without triangles.
    """

    name: str
    shape: Any
    model: Model
    camera: Camera
    resolution: tuple[int, int]

    @property
    def pixel(self) -> float:
        """Size of a pixel in model units: the same everywhere, as the camera is orthographic."""
        return self.camera.extent_at_unit_depth() / self.resolution[1]


def default_names() -> list[str]:
    """What is measured when no model is named."""
    return [*PRIMITIVES, *OWN, *THIRD_PARTY, *SMALL_PATCHES]


def path_of(name: str) -> Path:
    """The file of a default name, seen from the repository's root; any other name is a path itself."""
    if name in THIRD_PARTY:
        return THIRD_PARTY_FOLDER / THIRD_PARTY[name]
    return OWN_FOLDER / f"{name}.step" if name in (*OWN, *SMALL_PATCHES) else Path(name)


def open_subject(name: str, resolution: tuple[int, int]) -> Subject:
    """Read (or make) and convert the model, and fit its camera. Raises InputError if there is nothing to measure."""
    from ..cad.convert import convert

    if name in PRIMITIVES:
        from ..cad import primitives

        shape = getattr(primitives, name)()
    else:
        path = path_of(name)
        if not path.exists():
            raise InputError(f"{name}: {path} is not there; run from the repository's root, or name a file")
        from ..cad.read import read_file

        shape = read_file(str(path)).shape
        name = path.stem if path == Path(name) else name
    model = convert(shape, name)
    return Subject(name, shape, model, Camera.fit(model, resolution=resolution), resolution)
