"""Work that takes longer than a frame, done in threads; its results come back to the thread that polls."""

from __future__ import annotations

import os
import queue
import sys
import threading
from collections.abc import Callable
from typing import Any, TypeVar

NICENESS = 5
Result = TypeVar("Result")


class Tasks:
    """Each task has a thread of its own. What is run must leave the interpreter's lock free while it computes."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        """wake: called in a task's thread when it has ended."""
        self._wake = wake
        self._ended: queue.SimpleQueue[tuple[Callable[[Any], None], Any]] = queue.SimpleQueue()
        self.running = 0

    def run(self, work: Callable[[], Result], then: Callable[[Result | Exception], None]) -> None:
        """Begin `work`; the poll() after its end calls `then` with what it returned, or raised."""

        def task() -> None:
            give_way()
            try:
                result: Result | Exception = work()
            except Exception as error:
                result = error
            self._ended.put((then, result))
            self._wake()

        self.running += 1
        threading.Thread(target=task, name="task").start()

    def poll(self) -> bool:
        """Hand over what has ended; whether there was anything."""
        any_ended = False
        while not self._ended.empty():
            then, result = self._ended.get()
            self.running -= 1
            any_ended = True
            then(result)
        return any_ended


def give_way() -> None:
    """Let the calling thread, and what it starts, compute only when the window has nothing to do, where the system can
    tell threads apart (Linux): a window that waits for a processor is a window that hangs."""
    if sys.platform == "linux":
        thread = threading.get_native_id()
        os.setpriority(os.PRIO_PROCESS, thread, min(os.getpriority(os.PRIO_PROCESS, thread) + NICENESS, 19))
