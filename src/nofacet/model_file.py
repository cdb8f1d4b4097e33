"""A model as bytes: numpy arrays as they lie in memory, behind a header in JSON. Reading runs no code from the file.

    magic (16 bytes), SHA-256 of all that follows, length of the header (uint64), header, arrays

The header holds strings, lists and the tree as they are, and an array as [dtype, shape, offset], the offset counted
from the first multiple of 64 bytes behind the header. Little-endian, as is every machine this runs on.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import fields
from math import prod
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from .model import Model, Node, PatchGroup

MAGIC = b"nofacet model 2\n"
_ALIGNMENT = 64  # of arrays: a cache line
_START = len(MAGIC) + hashlib.sha256().digest_size
_TEXTS = ("source", "surface_type", "face_name", "warnings")
_ARRAYS = tuple(field.name for field in fields(Model) if field.name not in (*_TEXTS, "groups", "tree"))
_GROUP_ARRAYS = tuple(field.name for field in fields(PatchGroup))


def write(model: Model, file: IO[bytes]) -> None:
    """Write a model to an open file. Raises OSError where that is impossible."""
    arrays = _Arrays()
    header = {
        "texts": {name: getattr(model, name) for name in _TEXTS},
        "arrays": {name: arrays.add(getattr(model, name)) for name in _ARRAYS},
        "groups": [{name: arrays.add(getattr(group, name)) for name in _GROUP_ARRAYS} for group in model.groups],
        "tree": [[node.name, node.parent, arrays.add(node.faces)] for node in model.tree],
    }
    text = json.dumps(header).encode()
    parts = [len(text).to_bytes(8, "little"), text, _padding(_START + 8 + len(text)), *arrays.parts()]
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)
    file.writelines([MAGIC, digest.digest(), *parts])


def read(path: Path) -> Model:
    """The model that `write` put into a file; its arrays are the caller's own.

    Raises ValueError for a file that is not that, whole and unchanged, OSError where it cannot be read.
    """
    data = np.fromfile(path, np.uint8)
    if data[: len(MAGIC)].tobytes() != MAGIC:
        raise ValueError(f"{path}: not a model that this version wrote")
    if hashlib.sha256(data[_START:].data).digest() != data[len(MAGIC) : _START].tobytes():
        raise ValueError(f"{path}: is damaged")
    end = _START + 8 + int.from_bytes(data[_START : _START + 8].tobytes(), "little")
    header = json.loads(data[_START + 8 : end].tobytes())
    body = data[end + len(_padding(end)) :]

    def array(entry: list[Any]) -> NDArray[Any]:
        dtype, shape, offset = entry
        return body[offset : offset + np.dtype(dtype).itemsize * prod(shape)].view(dtype).reshape(shape)

    values: dict[str, Any] = {name: array(entry) for name, entry in header["arrays"].items()} | header["texts"]
    return Model(
        groups=[PatchGroup(**{name: array(entry) for name, entry in group.items()}) for group in header["groups"]],
        tree=[Node(name, parent, array(faces)) for name, parent, faces in header["tree"]],
        **values,
    )


class _Arrays:
    """Arrays one behind the other, each at a multiple of the alignment."""

    def __init__(self) -> None:
        self._arrays: list[NDArray[Any]] = []
        self._end = 0

    def add(self, values: NDArray[Any]) -> list[Any]:
        """The header's entry for an array."""
        array = np.ascontiguousarray(values)
        self._arrays.append(array)
        start = self._end
        self._end += array.nbytes + len(_padding(array.nbytes))
        return [array.dtype.str, array.shape, start]

    def parts(self) -> Iterator[bytes | memoryview]:
        for array in self._arrays:
            yield array.reshape(-1).view(np.uint8).data
            yield _padding(array.nbytes)


def _padding(length: int) -> bytes:
    return bytes(-length % _ALIGNMENT)
