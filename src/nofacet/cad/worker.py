"""Reading a file in a process of its own, because OpenCascade can hang or crash on damaged files.

OpenCascade holds the interpreter's lock while it works, so within one process neither a time limit nor Ctrl-C would
get through; here the parent only waits, and kills the child when it must. The child pickles its answer (the Model, or
why there is none) to its standard output and notes on its standard error which stage it enters. Whatever OpenCascade
itself prints goes nowhere. The parent never imports OCP.
"""

from __future__ import annotations

import gc
import json
import logging
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn, TextIO

from nofacet.errors import Cancelled, InputError

if TYPE_CHECKING:
    from nofacet._native import Cancel
    from nofacet.model import Model

_log = logging.getLogger(__name__)

# The child takes over the parent's import path, so that it runs the same nofacet however the parent found it.
_CHILD_CODE = (
    "import sys; sys.path[:] = sys.argv[1].split('\\n'); "
    "from nofacet.cad.worker import run_child; run_child(sys.argv[2])"
)
_TICK = 1.0  # seconds between progress messages, and before the first
_CANCEL_TICK = 0.05  # seconds between looks at whether reading was called off
_LONGEST_WAIT = 1e6  # seconds, what the system's timers can hold
_ORPHAN_GRACE = 5.0  # seconds past the time limit after which a child that nobody killed ends by itself
_FIRST_STAGE = "starting"
_LAST_STAGE = "sending the model"


def read_in_worker(
    path: str,
    timeout: float = 300.0,
    progress: Callable[[str], None] | None = None,
    measure: bool = False,
    cancel: Cancel | None = None,
) -> Model:
    """Read and convert a STEP or BREP file in a child process.

    timeout: seconds, math.inf for no limit. progress: called once a second, first after a second, with one line that
    names the file, the stage and the time. measure: fill what load() says.
    Raises InputError if the file cannot be shown, if reading takes longer than the timeout, if OpenCascade crashes;
    Cancelled once `cancel` is set.
    """
    started = time.monotonic()
    job = {"file": path, "measure": measure, "started": started, "timeout": min(timeout, _LONGEST_WAIT)}
    with tempfile.TemporaryFile("a+", encoding="utf-8", errors="replace") as notes:
        child = subprocess.Popen(
            [sys.executable, "-c", _CHILD_CODE, "\n".join(sys.path), json.dumps(job)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=notes,
        )
        try:
            answer = _wait(child, path, started, timeout, notes, progress, cancel)
        finally:  # also on Ctrl-C
            child.kill()
            child.wait()
            if child.stdout:
                child.stdout.close()
        return _unpack(answer, child.returncode, path, notes)


def _wait(
    child: subprocess.Popen[bytes],
    path: str,
    started: float,
    timeout: float,
    notes: TextIO,
    progress: Callable[[str], None] | None,
    cancel: Cancel | None,
) -> bytes:
    """The child's standard output once it has ended."""
    said = 0.0  # when there was the last progress message
    while True:
        elapsed = time.monotonic() - started
        if cancel and cancel.is_set():
            raise Cancelled(f"{path}: reading was called off")
        if elapsed >= timeout:
            raise InputError(
                f"{path}: stopped after {timeout:g} s while {_present_stage(notes)}; "
                "a damaged file can make OpenCascade hang, a very large one may need a longer timeout"
            )
        if progress and elapsed >= said + _TICK:
            progress(f"{os.path.basename(path)}: {_present_stage(notes)}, {elapsed:.0f} s")
            said = elapsed // _TICK * _TICK
        until_tick = said + _TICK - elapsed if progress else _LONGEST_WAIT
        if cancel:
            until_tick = min(until_tick, _CANCEL_TICK)
        try:
            return child.communicate(timeout=min(until_tick, timeout - elapsed))[0]
        except subprocess.TimeoutExpired:
            continue


def _unpack(answer: bytes, return_code: int, path: str, notes: TextIO) -> Model:
    if return_code == 0:
        kind, content = pickle.loads(answer)
        if kind == "input error":
            raise InputError(content)
        if kind == "failure":
            summary, details = content
            stage = _present_stage(notes)
            raise InputError(f"{path}: failed while {stage} ({summary}); please report this") from RuntimeError(details)
        _log_stage_times(path, notes)
        return content
    stage = _present_stage(notes)
    if return_code < 0:
        reason = signal.strsignal(-return_code) or f"signal {-return_code}"
        raise InputError(
            f"{path}: OpenCascade crashed while {stage} ({reason}); the file is probably damaged, export it again"
        )
    notes.seek(0)
    last_line = (notes.read().strip().splitlines() or ["no message"])[-1]
    problem = f"the reading process failed while {stage} (status {return_code}: {last_line})"
    raise InputError(f"{path}: {problem}; please report this")


def _stages(notes: TextIO) -> list[tuple[float, str]]:
    """The stages entered so far: seconds since the start, name."""
    stages = [(0.0, _FIRST_STAGE)]
    notes.seek(0)
    for line in notes:
        mark, _, rest = line.rstrip("\n").partition(" ")
        if mark == "stage":
            seconds, _, name = rest.partition(" ")
            stages.append((float(seconds), name))
    return stages


def _present_stage(notes: TextIO) -> str:
    return _stages(notes)[-1][1]


def _log_stage_times(path: str, notes: TextIO) -> None:
    if _log.isEnabledFor(logging.DEBUG):
        stages = _stages(notes)
        for (begin, name), (end, _) in zip(stages, stages[1:], strict=False):
            _log.debug("%s: %s %.3f s", os.path.basename(path), name, end - begin)


def run_child(job_json: str) -> NoReturn:
    """The child's whole life: do the job, send the answer, leave without OpenCascade's clean-up."""
    job = json.loads(job_json)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches both; the parent decides
    if hasattr(signal, "setitimer"):  # should the parent be gone, the system ends a child that hangs
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, job["timeout"] + _ORPHAN_GRACE)
    gc.disable()  # a short life with many small objects
    answer_file = os.fdopen(os.dup(1), "wb")
    notes = os.fdopen(os.dup(2), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)

    def enter_stage(name: str) -> None:
        print("stage", time.monotonic() - job["started"], name, file=notes, flush=True)

    answer: tuple[str, object]
    try:
        answer = ("model", _read_and_convert(job["file"], job["measure"], enter_stage))
        enter_stage(_LAST_STAGE)
    except InputError as error:
        answer = ("input error", str(error))
    except Exception as error:
        answer = ("failure", (" ".join(repr(error).split()), traceback.format_exc()))
    pickle.dump(answer, answer_file, protocol=5)
    answer_file.flush()
    enter_stage("done")
    os._exit(0)


def _read_and_convert(path: str, measure: bool, enter_stage: Callable[[str], None]) -> Model:
    enter_stage("loading OpenCascade")
    from nofacet.cad.convert import convert
    from nofacet.cad.read import read_file

    file = read_file(path, enter_stage)
    enter_stage("converting the faces")
    model = file.appearance.applied_to(convert(file.shape, path))
    model = replace(model, warnings=file.warnings + model.warnings)
    if measure:
        from nofacet.cad.measure import measured

        model = measured(file.shape, model, enter_stage)
    return model
