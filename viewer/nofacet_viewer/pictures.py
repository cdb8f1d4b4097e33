"""Pictures that the user takes: of the window as it is, and clean ones of the exact model."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.metadata import version
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import nofacet
from nofacet import image
from nofacet.camera import METADATA_KEY
from nofacet.frame import SOFTWARE_KEY

from .exact import FULL_SAMPLES


def picture_path(model: str | None, folder: Path) -> Path:
    """A file name for a picture of a model that does not exist yet in the folder."""
    stem = Path(model).stem if model else "nofacet"
    return next(path for number in count(1) if not (path := folder / f"{stem}-{number}.png").exists())


def save_window(path: Path, pixels: NDArray[np.uint8], camera: nofacet.Camera | None) -> Path:
    """Write the window's pixels (height, width, 3), sRGB, with the camera. Raises OSError where that is impossible."""
    attributes = {SOFTWARE_KEY: f"nofacet {version('nofacet')}"}
    if camera:
        attributes[METADATA_KEY] = json.dumps(camera.to_dict())
    image.write(path, pixels, ("R", "G", "B"), attributes)
    return path


def save_exact(
    path: Path,
    model: nofacet.Model,
    camera: nofacet.Camera,
    size: tuple[int, int],
    sections: Sequence[nofacet.Section] = (),
) -> Path:
    """Draw the model in full quality and write it with a transparent background. Raises InputError, OSError."""
    nofacet.render(model, camera, size, samples=FULL_SAMPLES, buffers=("color",), sections=sections).save(path)
    return path
