"""Whether a file has changed on disk, and has stopped changing."""

from __future__ import annotations

import os

SETTLED = 0.3  # seconds without a further change: whoever writes the file is done
Stamp = tuple[int, int]


class FileWatch:
    """Watches one file. A program may write it in pieces or replace it; a change counts once it has settled."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._known = self._seen = stamp(path)
        self._since = 0.0

    def changed(self, now: float) -> bool:
        """Whether the file is another than at the last time this was true. now: seconds of any clock."""
        present = stamp(self.path)
        if present != self._seen:
            self._seen, self._since = present, now
        if present is None or present == self._known or now - self._since < SETTLED:
            return False
        self._known = present
        return True


def stamp(path: str) -> Stamp | None:
    """Time of change and size of a file; None where there is none."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
