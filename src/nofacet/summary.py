"""What is in a model, as text."""

from __future__ import annotations

import numpy as np

from .extent import bounding_box
from .model import Model


def summary(model: Model, faces: bool = False) -> str:
    """Counts, size, assembly, surface types with their conversion errors, trims and warnings; a line a face on request.

    Lengths are in model units (mm as OpenCascade delivers them). Raises InputError for a model without surfaces.
    """
    low, high = bounding_box(model)
    size = high - low
    diagonal = float(np.linalg.norm(size))
    lines = [
        model.source,
        f"  faces      {model.face_count} drawn, {model.definition_count} distinct",
        f"  patches    {model.patch_count} rational Bezier patches",
        f"  size       {_triple(size, ' x ')} mm, diagonal {diagonal:.6g}",
        f"  box        ({_triple(low)}) to ({_triple(high)})",
        f"  trims      {len(model.loop_offsets) - 1} loops of {len(model.segment_edge)} segments; "
        f"{int(np.count_nonzero(model.trimmed))} of {model.definition_count} faces need them",
    ]
    lines += ["", *_surface_table(model, diagonal)]
    if model.tree:
        lines += ["", "assembly", *_tree(model)]
    if faces:
        lines += ["", *_face_table(model, diagonal)]
    if model.warnings:
        lines += ["", "warnings", *(f"  {warning}" for warning in model.warnings)]
    return "\n".join(lines)


def _triple(values: np.ndarray, separator: str = ", ") -> str:
    return separator.join(f"{value:.6g}" for value in values)


def _patches_per_definition(model: Model) -> np.ndarray:
    count = np.zeros(model.definition_count, int)
    for group in model.groups:
        count += np.bincount(group.definition, minlength=model.definition_count)
    return count


def _error(error: float, diagonal: float) -> str:
    """A conversion error in model units and as a part of the model's size."""
    return "not measured" if np.isnan(error) else f"{error:.1e} mm = {error / (diagonal or 1):.1e} of the size"


def _worst(errors: np.ndarray) -> float:
    return float(np.nanmax(errors)) if np.isfinite(errors).any() else float("nan")


def _surface_table(model: Model, diagonal: float) -> list[str]:
    kinds = np.array(model.surface_type)
    patches = _patches_per_definition(model)
    lines = [f"{'surface':<12}{'distinct':>9}{'drawn':>8}{'patches':>9}{'trimmed':>9}  largest conversion error"]
    for kind in sorted(set(model.surface_type), key=lambda kind: -int(np.count_nonzero(kinds == kind))):
        of_kind = kinds == kind
        drawn = np.count_nonzero(of_kind[model.face_definition])
        counts = f"{of_kind.sum():>9}{drawn:>8}{patches[of_kind].sum():>9}{model.trimmed[of_kind].sum(dtype=int):>9}"
        lines.append(f"{kind:<12}{counts}  {_error(_worst(model.conversion_error[of_kind]), diagonal)}")
    lines.append(f"{'all':<12}{'':>35}  {_error(_worst(model.conversion_error), diagonal)}")
    return lines


def _tree(model: Model) -> list[str]:
    depth: list[int] = []
    lines = []
    for node in model.tree:
        depth.append(0 if node.parent < 0 else depth[node.parent] + 1)
        faces = f"  ({len(node.faces)} faces)" if len(node.faces) else ""
        lines.append(f"{'  ' * (depth[-1] + 1)}{node.name or 'unnamed'}{faces}")
    return lines


def _face_table(model: Model, diagonal: float) -> list[str]:
    patches = _patches_per_definition(model)
    lines = [f"{'face':>6}  {'surface':<12}{'patches':>8}{'loops':>6}  conversion error"]
    for face, definition in enumerate(model.face_definition):
        loops = model.definition_loops[definition + 1] - model.definition_loops[definition]
        error = _error(float(model.conversion_error[definition]), diagonal)
        name = f"  {model.face_name[face]}" if model.face_name[face] else ""
        lines.append(
            f"{face:>6}  {model.surface_type[definition]:<12}{patches[definition]:>8}{loops:>6}  {error}{name}"
        )
    return lines
