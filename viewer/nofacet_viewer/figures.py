"""The numbers beside each side's picture, as text."""

from __future__ import annotations

import numpy as np

import nofacet
from nofacet.outline import OutlineError

from .meshing import MeshResult


def exact_figures(model: nofacet.Model, frame_seconds: float, note: str = "") -> list[str]:
    """Patches, time of the frame (`note`: what of it, such as its samples) and the bound of the surfaces' error."""
    return [f"{model.placed_patch_count:,} patches", f"frame {_duration(frame_seconds)}{note}", _error_bound(model)]


def mesh_figures(result: MeshResult, error: OutlineError | None) -> list[str]:
    """Triangles, meshing time, memory and the outline's error in the present picture."""
    mesh = result.mesh
    figures = [
        f"{len(mesh.triangles):,} triangles",
        f"meshed in {_duration(mesh.seconds)}",
        f"{mesh.display_bytes / 1e6:.2g} MB" if mesh.display_bytes < 1e8 else f"{mesh.display_bytes / 1e6:.0f} MB",
    ]
    if error:
        figures.append(f"outline off by up to {error.largest:.3g} px (RMS {error.rms:.2g})")
    return figures


def _error_bound(model: nofacet.Model) -> str:
    """The largest conversion error; where none was measured, it says so."""
    measured = model.conversion_error[np.isfinite(model.conversion_error)]
    return f"surfaces within {measured.max():.1e} mm" if len(measured) else "conversion error not measured"


def _duration(seconds: float) -> str:
    return f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"
