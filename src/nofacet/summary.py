"""What is in a model, as text."""

from __future__ import annotations

import numpy as np

from .extent import bounding_box
from .model import Model


def summary(model: Model, faces: bool = False) -> str:
    """Counts, size, edge deviations, surface types with conversion errors, assembly, warnings; on request all faces.

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
        f"  edges      {_edges(model)}",
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


def _edges(model: Model) -> str:
    """How far the edges in space are from the curves that trim the faces."""
    deviation = model.edge_use_deviation
    if not np.isfinite(deviation).any():
        return "no edge uses measured"
    worst = int(np.nanargmax(deviation))
    over = np.count_nonzero(deviation > model.edge_use_tolerance)
    exceed = "1 exceeds its" if over == 1 else f"{over} exceed their"
    return (
        f"{np.count_nonzero(np.isfinite(deviation))} edge uses measured, at most {deviation[worst]:.1e} mm from the "
        f"curves that trim (face {model.edge_use_face[worst]}); {exceed} recorded tolerance"
    )


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
    deviation = np.full(model.face_count, np.nan)
    np.fmax.at(deviation, model.edge_use_face, model.edge_use_deviation)
    exceeding = model.edge_use_deviation > model.edge_use_tolerance
    over = np.bincount(model.edge_use_face[exceeding], minlength=model.face_count)
    head = f"{'face':>6}  {'surface':<12}{'patches':>8}{'loops':>6}  {'conversion error':<36}"
    lines = [f"{head}{'edge deviation':<16}over tolerance"]
    for face, definition in enumerate(model.face_definition):
        loops = model.definition_loops[definition + 1] - model.definition_loops[definition]
        error = _error(float(model.conversion_error[definition]), diagonal)
        edges = "not measured" if np.isnan(deviation[face]) else f"{deviation[face]:.1e} mm"
        name = f"  {model.face_name[face]}" if model.face_name[face] else ""
        kind = model.surface_type[definition]
        counts = f"{face:>6}  {kind:<12}{patches[definition]:>8}{loops:>6}"
        lines.append(f"{counts}  {error:<36}{edges:<16}{over[face]:>14}{name}")
    return lines
