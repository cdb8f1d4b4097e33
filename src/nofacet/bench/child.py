"""A measurement in a forked process: it starts with what this one has loaded, and may hang or crash alone."""

from __future__ import annotations

import multiprocessing
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
    try:
        answer = (True, function())
    except Exception as error:
        answer = (False, " ".join(f"{type(error).__name__}: {error}".split()))
    sender.send(answer)
