"""OpenCascade's mesher in a process of its own: it holds the interpreter's lock, may take minutes, and may crash.

The process reads the model once and then meshes it with one setting after another, so that a deflection can be chosen
live. Requests and answers are pickled, each behind its length. Whatever OpenCascade prints goes nowhere.
"""

from __future__ import annotations

import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

import nofacet
from nofacet.tessellation import read_shape, write_shape

from .mesh_arrays import MeshArrays

_CHILD_CODE = "import sys; sys.path[:] = sys.argv[1].split('\\n'); from nofacet_viewer.meshing import serve; serve()"
_LENGTH = struct.Struct("<Q")


@dataclass(frozen=True)
class MeshResult:
    """A mesh and what was asked for. arrays: the mesh as it is drawn."""

    setting: nofacet.MeshSetting
    mesh: nofacet.Mesh
    arrays: MeshArrays | None = None


class Mesher:
    """Meshes one source after another; the caller asks whether a mesh is there.

    A new start() makes the one before obsolete: only the newest request is answered.
    """

    def __init__(self) -> None:
        self._child: _Child | None = None
        self._source: Any = None
        self._waiting = False

    @property
    def busy(self) -> bool:
        """Whether a mesh is on its way."""
        return self._waiting

    def start(self, source: Any, setting: nofacet.MeshSetting) -> None:
        """Begin to mesh what nofacet.load(source) takes; faces are numbered as in the model.

        Raises InputError for an object that holds no faces.
        """
        if self._child is None or source is not self._source and source != self._source or self._waiting:
            self.cancel()
            self._child, self._source = _Child(source), source
        self._child.ask(setting)
        self._waiting = True

    def cancel(self) -> None:
        """Stop what is going on and forget the source; there will be no answer."""
        if self._child:
            self._child.stop()
        self._child, self._source, self._waiting = None, None, False

    def poll(self) -> MeshResult | str | None:
        """The mesh, or one line why there is none, as soon as it is known, once; until then None. Never blocks."""
        answer = self._child.answer() if self._child and self._waiting else None
        if answer is None:
            return None
        self._waiting = False
        if isinstance(answer, str):
            self.cancel()
        return answer


class _Child:
    """The process, and a thread that waits for its answers."""

    def __init__(self, source: Any) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        if isinstance(source, (str, os.PathLike)):
            self._name = path = os.fsdecode(source)
        else:
            self._name = type(source).__name__
            self._folder = tempfile.TemporaryDirectory()
            path = str(Path(self._folder.name, "shape.brep"))
            write_shape(source, path)
        self._answers: list[MeshResult | str] = []
        self._process = subprocess.Popen(
            [sys.executable, "-c", _CHILD_CODE, "\n".join(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        threading.Thread(target=self._listen, daemon=True).start()
        self._send(path)

    def ask(self, setting: nofacet.MeshSetting) -> None:
        self._send(setting)

    def answer(self) -> MeshResult | str | None:
        return self._answers.pop(0) if self._answers else None

    def stop(self) -> None:
        self._process.kill()
        self._process.wait()
        if self._process.stdin:
            self._process.stdin.close()
        if self._folder:
            self._folder.cleanup()

    def _send(self, message: Any) -> None:
        assert self._process.stdin
        try:
            _write(self._process.stdin, message)
        except OSError:  # it has ended; the listener says so
            return

    def _listen(self) -> None:
        assert self._process.stdout
        with self._process.stdout as stream:
            while (answer := _read(stream)) is not None:
                if isinstance(answer, MeshResult):
                    answer = replace(answer, arrays=MeshArrays.of(answer.mesh))
                self._answers.append(answer)
        status = self._process.wait()
        reason = (signal.strsignal(-status) if status < 0 else None) or f"status {status}"
        self._answers.append(f"{self._name}: meshing stopped ({reason}); choose a larger deflection")


def _write(stream: IO[bytes], message: Any) -> None:
    data = pickle.dumps(message, protocol=5)
    stream.write(_LENGTH.pack(len(data)) + data)
    stream.flush()


def _read(stream: IO[bytes]) -> Any:
    """The next message, None at the stream's end."""
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    size = _LENGTH.unpack(head)[0]
    data = stream.read(size)
    return pickle.loads(data) if len(data) == size else None


def serve() -> None:
    """The child's whole life: read the source named first, then answer every setting with its mesh."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches both; the parent decides
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    path = _read(requests)
    try:
        shape = read_shape(path)
    except nofacet.InputError as error:
        _write(answers, str(error))
        return
    while (setting := _read(requests)) is not None:
        try:
            _write(answers, MeshResult(setting, nofacet.tessellate(shape, setting)))
        except Exception as error:  # OpenCascade's are of many kinds
            _write(answers, f"{path}: meshing failed ({' '.join(repr(error).split())}); choose another deflection")
