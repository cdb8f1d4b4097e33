"""A display without a screen, and input as the X server delivers it (its XTEST extension)."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

SCREEN = "1400x900x24"
BUTTONS = {"left": 1, "middle": 2, "right": 3, "wheel up": 4, "wheel down": 5}


@contextmanager
def display() -> Iterator[str]:
    """A display's name; the display ends with the block. Skips the test where there is no Xvfb."""
    if shutil.which("Xvfb") is None:
        pytest.skip("needs Xvfb")
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as answer:
            number = answer.readline().strip()
        if not number:
            pytest.skip("Xvfb does not start")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait()


def run_in_window(module: str, scenario: str, *arguments: str) -> None:
    """Call a function of a test module in a process with a display of its own: a process has one window, and OpenGL
    contexts without a window may not come before it. Fails with what the process wrote."""
    with display() as name:
        environment = {**os.environ, "DISPLAY": name, "XDG_SESSION_TYPE": "x11"}
        environment.pop("WAYLAND_DISPLAY", None)
        environment["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), *sys.path])
        code = f"import sys, {module}; {module}.{scenario}(*sys.argv[1:])"
        result = subprocess.run(
            [sys.executable, "-X", "faulthandler", "-c", code, *arguments],
            env=environment,
            capture_output=True,
            text=True,
            timeout=1200,  # a starved machine is slow, not wrong
        )
    if result.returncode:
        pytest.fail(result.stdout + result.stderr)


class Hands:
    """Mouse and keyboard of the display in $DISPLAY."""

    def __init__(self) -> None:
        self._x = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
        self._test = ctypes.CDLL(ctypes.util.find_library("Xtst") or "libXtst.so.6")
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._x.XStringToKeysym.restype = ctypes.c_ulong
        self._display = ctypes.c_void_p(self._x.XOpenDisplay(None))

    def move(self, x: float, y: float) -> None:
        """To a position on the screen; the window is in its upper left corner."""
        self._test.XTestFakeMotionEvent(self._display, -1, round(x), round(y), ctypes.c_ulong(0))
        self._flush()

    def button(self, name: str, down: bool) -> None:
        self._test.XTestFakeButtonEvent(self._display, BUTTONS[name], int(down), ctypes.c_ulong(0))
        self._flush()

    def click(self, name: str) -> None:
        self.button(name, True)
        self.button(name, False)

    def key(self, keysym: str, down: bool) -> None:
        """keysym: as X11 calls the key, such as "1", "Return" or "Control_L"."""
        code = self._x.XKeysymToKeycode(self._display, ctypes.c_ulong(self._x.XStringToKeysym(keysym.encode())))
        self._test.XTestFakeKeyEvent(self._display, code, int(down), ctypes.c_ulong(0))
        self._flush()

    def press(self, *keysyms: str) -> None:
        """All keys down in this order, and up again."""
        for keysym in keysyms:
            self.key(keysym, True)
        for keysym in reversed(keysyms):
            self.key(keysym, False)

    def _flush(self) -> None:
        self._x.XSync(self._display, 0)
        time.sleep(0.02)
