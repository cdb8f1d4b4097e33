"""What the user has made of a model's faces: hidden, isolated, recoloured, made transparent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import nofacet

Faces = NDArray[np.int32]  # indices of placed faces


class Appearance:
    """Visibility and colour of every face of a model.

    visible: (F,) bool. color: (F, 4) float32, linear RGBA.
    """

    def __init__(self, model: nofacet.Model) -> None:
        self.model = model
        self.visible = np.ones(model.face_count, bool)
        self.color = model.face_color.copy()
        self._children: dict[int, list[int]] = {}
        for index, node in enumerate(model.tree):
            self._children.setdefault(node.parent, []).append(index)

    def children(self, node: int = -1) -> list[int]:
        """Indices of the assembly nodes right below one; -1: the roots."""
        return self._children.get(node, [])

    def faces_of(self, node: int) -> Faces:
        """The faces of an assembly node and of all nodes below it."""
        found, todo = [], [node]
        while todo:
            index = todo.pop()
            found.append(self.model.tree[index].faces)
            todo += self.children(index)
        return np.concatenate(found)

    def show(self, faces: Faces, visible: bool) -> None:
        self.visible[faces] = visible

    def isolate(self, faces: Faces) -> None:
        """Show these faces alone."""
        self.visible[:] = False
        self.visible[faces] = True

    def show_all(self) -> None:
        self.visible[:] = True

    def paint(self, faces: Faces, rgb: tuple[float, float, float]) -> None:
        """Give faces a colour, linear RGB; their opacity stays."""
        self.color[faces, :3] = rgb

    def set_opacity(self, faces: Faces, opacity: float) -> None:
        """0 lets everything through, 1 nothing."""
        self.color[faces, 3] = opacity

    def restore(self, faces: Faces) -> None:
        """Give faces the colour and opacity that they have in the file."""
        self.color[faces] = self.model.face_color[faces]

    def applied(self) -> nofacet.Model:
        """The model as it is to be drawn; the model itself where nothing has been changed."""
        model = self.model
        if not np.array_equal(self.color, model.face_color):
            model = replace(model, face_color=self.color.copy())
        return model if self.visible.all() else model.showing(self.visible)

    def carried_to(self, model: nofacet.Model) -> Appearance:
        """The same for another reading of the model; a fresh one where it has other faces."""
        result = Appearance(model)
        if model.face_count == self.model.face_count:
            result.visible = self.visible.copy()
            painted = (self.color != self.model.face_color).any(axis=1)
            result.color[painted] = self.color[painted]
        return result
