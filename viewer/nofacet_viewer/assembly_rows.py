"""The assembly tree as the rows that a panel shows: nodes that are open, with what is right below them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .appearance import Appearance, Faces


@dataclass(frozen=True)
class Row:
    """A node of the assembly, or one face: exactly one of `node` and `face` is not None."""

    label: str
    depth: int
    node: int | None = None
    face: int | None = None


class AssemblyRows:
    """Rows from top to bottom. They are made again only when a node is opened or closed: a tree may be large."""

    def __init__(self, appearance: Appearance) -> None:
        self.appearance = appearance
        roots = appearance.children()
        self._open = set(roots) if len(roots) == 1 else set()
        self.rows = self._made()

    def is_open(self, row: Row) -> bool:
        return row.node in self._open

    def toggle(self, row: Row) -> None:
        """Open a node that is closed, and the other way round."""
        if row.node is not None:
            self._open ^= {row.node}
            self.rows = self._made()

    def reveal(self, face: int, node: int) -> int:
        """Open the nodes above a face, down to the one that holds it (-1: none does); the index of the face's row."""
        tree = self.appearance.model.tree
        while node >= 0:
            self._open.add(node)
            node = tree[node].parent
        self.rows = self._made()
        return next(index for index, row in enumerate(self.rows) if row.face == face)

    def faces_of(self, row: Row) -> Faces:
        """The faces that a row stands for."""
        if row.face is not None:
            return np.array([row.face], np.int32)
        assert row.node is not None
        return self.appearance.faces_of(row.node)

    def _made(self) -> list[Row]:
        model = self.appearance.model
        if not model.tree:
            return [self._face(face, 0) for face in range(model.face_count)]
        rows: list[Row] = []
        todo = [(node, 0) for node in reversed(self.appearance.children())]
        while todo:
            node, depth = todo.pop()
            rows.append(Row(model.tree[node].name or f"part {node}", depth, node=node))
            if node in self._open:
                rows += [self._face(int(face), depth + 1) for face in model.tree[node].faces]
                todo += [(child, depth + 1) for child in reversed(self.appearance.children(node))]
        return rows

    def _face(self, face: int, depth: int) -> Row:
        name = self.appearance.model.face_name[face]
        return Row(f"face {face} {name}".rstrip(), depth, face=face)
