"""A measurement in a forked process: it starts with what this one has loaded, and may hang or crash alone."""

from __future__ import annotations

import ctypes
import multiprocessing
import sys
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, TypeVar

Result = TypeVar("Result")


class ChildFailure(Exception):
    """The child crashed or raised; the message is one line."""


def in_child(function: Callable[[], Result], seconds: float) -> Result:
    """What function returns in a forked process. Raises TimeoutError past the limit, ChildFailure if it fails."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_run, args=(function, sender), daemon=True)
    child.start()
    sender.close()
    try:
        if not receiver.poll(seconds):
            raise TimeoutError(f"more than {seconds:g} s")
        done, answer = receiver.recv()
    except EOFError:
        child.join()
        raise ChildFailure(f"the process ended with status {child.exitcode}") from None
    finally:
        child.kill()
        child.join()
        receiver.close()
    if not done:
        raise ChildFailure(answer)
    result: Result = answer
    return result


def _run(function: Callable[[], Any], sender: Connection) -> None:
    _own_memory()
    try:
        answer = (True, function())
    except Exception as error:
        answer = (False, " ".join(f"{type(error).__name__}: {error}".split()))
    sender.send(answer)


_MADV_POPULATE_WRITE = 23  # since Linux 5.14


def _own_memory() -> None:
    """Copy now the pages that are shared with the parent until they are written to.

    OpenCascade writes to every object it hands out, to count references: in a fork each page of a shape would be copied
    while something is measured, which a process that has read the file itself never does. Where the system cannot do
    it, nothing happens.
    """
    if sys.platform != "linux":
        return
    madvise = ctypes.CDLL(None).madvise
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    with open("/proc/self/maps", encoding="utf-8", errors="replace") as maps:
        regions = [line.split(maxsplit=2)[:2] for line in maps]
    for span, access in regions:
        if access == "rw-p":
            start, end = (int(address, 16) for address in span.split("-"))
            madvise(start, end - start, _MADV_POPULATE_WRITE)
