"""The viewer's window: how fast the exact side follows, and whether the window ever stands still.

    python benchmarks/window.py [--resolution=1280,720] [--seconds=6] [--view=exact] [MODEL...]

Needs a display (without a screen: Xvfb). For every model it opens a window, reads the file (the cache is not used),
waits until nothing goes on in the background, drags the mouse to orbit for some seconds and lets it rest. It prints,
in milliseconds where nothing else is said:

stall while reading: the longest time in which no input was handled, from opening the window until the file is read,
    shown in full quality, meshed and measured. While orbiting: the same for the drag and the refinement after it. What
    waiting for input takes longer than it was to last counts, too.
frames a second: of exact pictures that the window showed while the camera orbited; scale: of their resolution.
frame: time that drawing one of them took, median.
latency: from an input, whether or not the window was ready for it, to the first picture presented that shows its
    camera or a later one; median and largest.
full quality: from the last input until the picture with 16 samples is presented.

The first quarter of the orbit, in which the resolution settles, counts for the stalls only.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean, median
from typing import NamedTuple

import nofacet
from nofacet_viewer.app import App, Options
from nofacet_viewer.controls import Button
from nofacet_viewer.exact import Exact
from nofacet_viewer.state import View

FLANGE = str(Path(__file__).resolve().parents[1] / "cad_models" / "flange.step")
NONE: frozenset[str] = frozenset()
INPUT_SECONDS = 1 / 60  # between mouse events
TURN_SECONDS = 3.0  # in which the mouse goes round once
QUIET_SECONDS = 1.0  # without anything in the background
TIMEOUT = 600.0


class Shown(NamedTuple):
    """A picture that was presented. Its pixels are let go, as in use: the next frames want their memory."""

    at: float
    scale: float
    seconds: float


@dataclass
class Orbit:
    """What was asked for and shown while the camera moved; times of time.perf_counter()."""

    start: float
    seconds: float
    unanswered: list[tuple[float, nofacet.Camera]] = field(default_factory=list)  # inputs
    shown: list[Shown] = field(default_factory=list)
    latencies: list[tuple[float, float]] = field(default_factory=list)  # when the input came, and how long it took

    def show(self, exact: Exact, now: float) -> None:
        """A picture is presented: it answers the input with its camera and all before."""
        self.shown.append(Shown(now, exact.scale, exact.seconds))
        answered = [k for k, (_, camera) in enumerate(self.unanswered) if camera is exact.request.camera]
        if answered:
            self.latencies += [(at, now - at) for at, _ in self.unanswered[: answered[-1] + 1]]
            del self.unanswered[: answered[-1] + 1]

    def figures(self) -> dict[str, float]:
        settled = self.start + self.seconds / 4
        shown = [picture for picture in self.shown if picture.at > settled]
        latencies = [took for at, took in self.latencies if at > settled]
        return {
            "frames a second": (len(shown) - 1) / (shown[-1].at - shown[0].at),
            "scale": fmean(picture.scale for picture in shown),
            "frame": 1e3 * median(picture.seconds for picture in shown),
            "latency": 1e3 * median(latencies),
            "largest latency": 1e3 * max(latencies),
        }


class Run:
    """One window, and the longest time in which it has handled no input."""

    def __init__(self, model: str, view: View, resolution: tuple[int, int]) -> None:
        self.app = App(Options([model], view, size=resolution))
        self.longest = 0.0
        self._handled = time.perf_counter()
        self._wait = self.app.window.wait
        self.app.window.wait = self._timed_wait  # type: ignore[method-assign]

    def step(self, wait: float = 0.002) -> bool:
        """One turn of the window's loop; whether a picture was presented. wait: seconds at most for something to do."""
        return self.app.step(wait)

    def until_full(self) -> None:
        session, end = self.app.session, time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            presented = self.step()
            exact = session.exact
            if presented and exact and exact.is_full and exact.request.camera == session.camera:
                return
        raise TimeoutError("no picture in full quality")

    def settle(self) -> None:
        """Until nothing goes on in the background any more."""
        session, end = self.app.session, time.monotonic() + TIMEOUT
        quiet = time.monotonic()
        while time.monotonic() - quiet < QUIET_SECONDS:
            self.step()
            if session.loader.path or session.tasks.running or session.tessellated.busy or self.app.painter.busy:
                quiet = time.monotonic()
            if time.monotonic() > end:
                raise TimeoutError("work in the background does not end")

    def orbit(self, seconds: float) -> dict[str, float]:
        """Drag the mouse in a circle, then let it rest until the picture is in full quality."""
        app, session = self.app, self.app.session
        width, height = session.size
        app.on_press(Button.LEFT, (width * 0.3, height * 0.5), NONE)
        orbit = Orbit(time.perf_counter(), seconds)
        shown, next_input = session.exact, orbit.start
        while (now := time.perf_counter()) - orbit.start < seconds:
            due = []
            while next_input <= now:
                due.append(next_input)
                next_input += INPUT_SECONDS
            if due:  # the window is told where several motions have led to
                angle = 2 * math.pi * (now - orbit.start) / TURN_SECONDS
                app.on_move((width * (0.3 + 0.1 * math.sin(angle)), height * (0.5 + 0.1 * (1 - math.cos(angle)))))
                assert session.camera
                orbit.unanswered += [(at, session.camera) for at in due]
            if self.step(max(next_input - time.perf_counter(), 0.0)) and session.exact and session.exact is not shown:
                shown = session.exact
                orbit.show(shown, time.perf_counter())
        rest = time.perf_counter()
        app.on_release(Button.LEFT, session.cursor)
        self.until_full()
        return orbit.figures() | {"full quality": 1e3 * (time.perf_counter() - rest)}

    def take_longest(self) -> float:
        """The longest time without input since the last call, ms."""
        longest, self.longest = 1e3 * self.longest, 0.0
        return longest

    def _timed_wait(self, seconds: float) -> None:
        start = time.perf_counter()
        self._wait(seconds)
        now = time.perf_counter()
        overdue = max(now - start - seconds, 0.0)
        self.longest = max(self.longest, start - self._handled + overdue)
        self._handled = now


def measure(model: str, view: View, resolution: tuple[int, int], seconds: float) -> dict[str, float]:
    run = Run(model, view, resolution)
    run.until_full()
    run.settle()
    result = {"stall while reading": run.take_longest()} | run.orbit(seconds)
    run.settle()
    result["stall while orbiting"] = run.take_longest()
    run.app.close()
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=[FLANGE], metavar="MODEL")
    parser.add_argument("--resolution", default="1280,720", metavar="W,H")
    parser.add_argument("--seconds", type=float, default=6.0)
    parser.add_argument("--view", default="exact", choices=[view.value for view in View])
    options = parser.parse_args()
    os.environ["NOFACET_CACHE"] = "off"
    width, height = (int(side) for side in options.resolution.split(","))
    for model in options.models:
        result = measure(model, View(options.view), (width, height), options.seconds)
        print(Path(model).name, *(f"  {name} {value:.3g}" for name, value in result.items()), sep="\n", flush=True)


if __name__ == "__main__":
    main()
