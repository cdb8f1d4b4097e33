"""Converted models kept on disk: a file that was opened before opens again at once, without OpenCascade.

An entry's name is a hash of all that its model depends on: the file's bytes and name, what was measured, and the code
that reads and converts, OpenCascade's included. So entries are never out of date; what has changed has another name.
Any number of processes may use the same folder: entries appear whole or not at all, and one that is damaged counts as
missing. Nothing here raises because of the folder's state: without a usable one there is no cache.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

from . import _native, model_file
from .model import Model

_log = logging.getLogger(__name__)

SETTING = "NOFACET_CACHE"  # environment variable: a folder, "off", or "on" for the usual folder
LIMIT = 1 << 30  # bytes of all entries together; those used longest ago go first
_ENTRY, _UNFINISHED = ".model", ".part"
_ABANDONED = 3600.0  # seconds after which an unfinished entry is what a dead process left
# A STEP file with this entity may refer to other files, whose content the name of an entry would not know.
_REFERENCE = b"DOCUMENT_FILE"


def folder() -> Path | None:
    """Where entries are: $NOFACET_CACHE, or nofacet in $XDG_CACHE_HOME or ~/.cache; None where there is to be none."""
    setting = os.environ.get(SETTING, "")
    if setting == "off":
        return None
    if setting not in ("", "on"):
        return Path(setting)
    base = os.environ.get("XDG_CACHE_HOME", "")
    try:
        return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "nofacet"
    except RuntimeError:  # no home
        return None


def name_of(path: str, measure: bool) -> str | None:
    """The name of the entry for a file as it is now; None where it has none.

    measure: whether the conversion errors and edges of the model are measured.
    """
    if folder() is None:
        return None
    try:
        content = Path(path).read_bytes()
        digest = hashlib.sha256(json.dumps([os.path.basename(path), measure, *_code()]).encode())
    except (OSError, ValueError) as problem:  # ValueError: a module OCP that says nothing of where it comes from
        _log.debug("cache: %s", problem)
        return None
    if _REFERENCE in content:
        return None
    digest.update(content)
    return digest.hexdigest()


def find(name: str) -> Model | None:
    """The model of an entry; None without a whole one."""
    path = _entry(name)
    if path is None:
        return None
    try:
        model = model_file.read(path)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as problem:
        _log.debug("cache: %s", problem)
        return None
    with suppress(OSError):
        os.utime(path)  # it is used now
    return model


def keep(name: str, model: Model) -> None:
    """Make an entry, and room for it."""
    path = _entry(name)
    if path is None:
        return
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=_UNFINISHED, delete=False) as file:
            try:
                model_file.write(model, file)
                file.close()
                os.replace(file.name, path)
            except BaseException:
                file.close()
                os.unlink(file.name)
                raise
        _make_room(path.parent)
    except OSError as problem:
        _log.debug("cache: %s", problem)


def _entry(name: str) -> Path | None:
    place = folder()
    return None if place is None else place / (name + _ENTRY)


def _make_room(place: Path) -> None:
    """Remove the entries used longest ago until the rest is within the limit, and what dead processes left."""
    entries = []
    with os.scandir(place) as found:
        for file in found:
            with suppress(OSError):  # another process was quicker
                status = file.stat()
                if file.name.endswith(_ENTRY):
                    entries.append((status.st_mtime_ns, status.st_size, file.path))
                elif file.name.endswith(_UNFINISHED) and time.time() - status.st_mtime > _ABANDONED:
                    os.unlink(file.path)
    total = sum(size for _, size, _ in entries)
    for _, size, path in sorted(entries):
        if total <= LIMIT:
            break
        with suppress(OSError):
            os.unlink(path)
        total -= size


def _code() -> Iterator[tuple[str, int, int]]:
    """The files that read and convert: name, size and time of change of each."""
    package = Path(__file__).parent
    paths = [*sorted(package.glob("*.py")), *sorted(package.glob("cad/*.py")), Path(str(_native.__file__))]
    opencascade = find_spec("OCP")
    if opencascade is not None and opencascade.origin:
        paths += [Path(opencascade.origin), *sorted(Path(opencascade.origin).parent.glob("OCP.*"))]
    for path in paths:
        status = path.stat()
        yield str(path), status.st_size, status.st_mtime_ns
