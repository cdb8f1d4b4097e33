"""Several models in one world as one model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .model import Model, Node, PatchGroup


def combine(models: Sequence[Model], names: Sequence[str | None] | None = None) -> Model:
    """One model of all faces of `models`, numbered in their order: face k of models[i] becomes k plus the number of
    faces of the models before it.

    names: what each is called in the tree, None: as its own single root is, or its source. Every model is one node at
    the top of the tree: its single root, or a new node over its roots or, without a tree, with all its faces. Warnings
    begin with that name, and count faces as that model does.

    Raises ValueError for no models, and names that are not as many as models.
    """
    if not models:
        raise ValueError("there is no model to combine")
    wanted = [None] * len(models) if names is None else list(names)
    if len(wanted) != len(models):
        raise ValueError(f"{len(wanted)} names for {len(models)} models; give one each, or None")
    named = [_under_one_root(model, name) for model, name in zip(models, wanted, strict=True)]
    definitions = _firsts(model.definition_count for model in named)
    faces = _firsts(model.face_count for model in named)
    edges = _firsts(int(model.segment_edge.max(initial=-1)) + 1 for model in named)
    placements = _firsts(len(model.placements) for model in named)

    def joined(field: str) -> NDArray[Any]:
        return np.concatenate([getattr(model, field) for model in named])

    def shifted(field: str, firsts: list[int]) -> NDArray[Any]:
        """Indices into something of which each model brings its own; -1 stays."""
        columns = [getattr(model, field) for model in named]
        moved = [np.where(column < 0, column, column + first) for column, first in zip(columns, firsts, strict=False)]
        return np.concatenate(moved).astype(columns[0].dtype)

    def offsets(field: str) -> NDArray[np.int64]:
        columns = [getattr(model, field) for model in named]
        starts = _firsts(int(column[-1]) for column in columns)
        moved = [column[:-1] + first for column, first in zip(columns, starts, strict=False)]
        return np.concatenate([*moved, starts[-1:]]).astype(np.int64)

    return Model(
        source=", ".join(dict.fromkeys(model.source for model in named)),
        groups=_joined_groups(named, definitions),
        surface_type=[kind for model in named for kind in model.surface_type],
        trimmed=joined("trimmed"),
        definition_loops=offsets("definition_loops"),
        loop_offsets=offsets("loop_offsets"),
        segment_offsets=offsets("segment_offsets"),
        segment_points=joined("segment_points"),
        segment_edge=shifted("segment_edge", edges),
        conversion_error=joined("conversion_error"),
        face_definition=shifted("face_definition", definitions),
        face_placement=shifted("face_placement", placements),
        placements=joined("placements"),
        face_outward=joined("face_outward"),
        face_color=joined("face_color"),
        face_name=[name for model in named for name in model.face_name],
        body_offsets=offsets("body_offsets"),
        body_face=shifted("body_face", faces),
        body_face_outward=joined("body_face_outward"),
        body_closed=joined("body_closed"),
        edge_use_face=shifted("edge_use_face", faces),
        edge_use_deviation=joined("edge_use_deviation"),
        edge_use_tolerance=joined("edge_use_tolerance"),
        tree=_joined_tree(named, faces),
        warnings=[f"{model.tree[0].name}: {warning}" for model in named for warning in model.warnings],
    )


def _firsts(counts: Any) -> list[int]:
    """Running sums from 0: where each model's own begin, and their number."""
    return list(accumulate(counts, initial=0))


def _under_one_root(model: Model, name: str | None) -> Model:
    """The model with a tree that has one root, called `name`."""
    roots = [k for k, node in enumerate(model.tree) if node.parent < 0]
    if len(roots) == 1:  # parents come before their children, so it is the first
        root = model.tree[0]
        title = root.name or model.source if name is None else name
        return replace(model, tree=[replace(root, name=title), *model.tree[1:]])
    held = np.empty(0, np.int32) if roots else np.arange(model.face_count, dtype=np.int32)
    below = [replace(node, parent=node.parent + 1 if node.parent >= 0 else 0) for node in model.tree]
    return replace(model, tree=[Node(model.source if name is None else name, -1, held), *below])


def _joined_tree(models: Sequence[Model], first_faces: Sequence[int]) -> list[Node]:
    tree: list[Node] = []
    for model, first_face in zip(models, first_faces, strict=False):
        above = len(tree)
        for node in model.tree:
            parent = node.parent + above if node.parent >= 0 else -1
            tree.append(Node(node.name, parent, (node.faces + first_face).astype(np.int32)))
    return tree


def _joined_groups(models: Sequence[Model], first_definitions: Sequence[int]) -> list[PatchGroup]:
    """One group for each bidegree, its patches in the order of their definitions."""
    found: dict[tuple[int, int], list[PatchGroup]] = {}
    for model, first in zip(models, first_definitions, strict=False):
        for group in model.groups:
            moved = replace(group, definition=(group.definition + first).astype(np.int32))
            found.setdefault(group.degree, []).append(moved)
    return [
        PatchGroup(
            *(
                np.concatenate([getattr(group, field) for group in groups])
                for field in ("control_points", "definition", "domain", "angular")
            )
        )
        for groups in found.values()
    ]
