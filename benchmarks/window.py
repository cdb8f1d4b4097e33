"""The viewer's window: how fast the exact side follows, and whether the window ever stands still.

    python benchmarks/window.py [--resolution=1280,720] [--seconds=6] [--view=exact] [MODEL...]

Needs a display (without a screen: Xvfb). For every model it opens a window, reads the file, drags the mouse to orbit
for some seconds and lets it rest. It prints, in milliseconds:

stall while reading, orbiting: the longest time in which the window handled no input.
frames a second: of exact pictures that the window showed while the camera orbited; scale: of their resolution.
latency: from an input to the first picture presented that shows its camera; median and largest.
full quality: from the last input until the picture with 16 samples is presented.
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path
from typing import Any

from nofacet_viewer.app import App, Options
from nofacet_viewer.controls import Button
from nofacet_viewer.state import View

FLANGE = str(Path(__file__).resolve().parents[1] / "cad_models" / "flange.step")
NONE: frozenset[str] = frozenset()
INPUT_SECONDS = 1 / 60  # between mouse events
TIMEOUT = 300.0


class Run:
    """One window and how long its steps took."""

    def __init__(self, model: str, view: View, resolution: tuple[int, int]) -> None:
        self.app = App(Options([model], view, size=resolution))
        self.longest = 0.0

    def step(self) -> bool:
        """One turn of the window's loop; whether a picture was presented."""
        start = time.perf_counter()
        presented = self.app.step(0.002)
        self.longest = max(self.longest, time.perf_counter() - start)
        return presented

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
        while time.monotonic() < end and time.monotonic() - quiet < 1.0:
            self.step()
            if session.loader.path or session.tasks.running or session.tessellated.busy or self.app.painter.busy:
                quiet = time.monotonic()

    def orbit(self, seconds: float) -> dict[str, Any]:
        """Drag the mouse in a circle."""
        app, session = self.app, self.app.session
        width, height = session.size
        app.on_press(Button.LEFT, (width * 0.3, height * 0.5), NONE)
        start = time.perf_counter()
        inputs: list[tuple[float, Any]] = []
        frames, latencies, scales = [], [], []
        shown = None
        next_input = start
        while (now := time.perf_counter()) - start < seconds:
            if now >= next_input:
                angle = 2 * math.pi * (now - start) / 3
                app.on_move((width * (0.3 + 0.1 * math.sin(angle)), height * (0.5 + 0.1 * (1 - math.cos(angle)))))
                inputs.append((now, session.camera))
                next_input = now + INPUT_SECONDS
            presented = self.step()
            exact = session.exact
            if not presented or exact is None or exact is shown:
                continue
            shown, now = exact, time.perf_counter()
            frames.append(now)
            scales.append(exact.scale)
            sent = next((at for at, camera in inputs if camera is exact.request.camera), None)
            if sent:
                latencies.append(now - sent)
        app.on_release(Button.LEFT, (width * 0.3, height * 0.5))
        rest = time.perf_counter()
        self.until_full()
        warm = sorted(latencies[len(latencies) // 4 :])
        late = [at for at in frames if at > start + seconds / 4]
        return {
            "frames a second": (len(late) - 1) / (late[-1] - late[0]),
            "scale": sum(scales[len(scales) // 4 :]) / len(scales[len(scales) // 4 :]),
            "latency": 1e3 * warm[len(warm) // 2],
            "largest latency": 1e3 * warm[-1],
            "full quality": 1e3 * (time.perf_counter() - rest),
        }


def measure(model: str, view: View, resolution: tuple[int, int], seconds: float) -> dict[str, Any]:
    run = Run(model, view, resolution)
    run.step()
    run.longest = 0.0  # the window's first picture compiles shaders
    run.until_full()
    result = {"stall while reading": 1e3 * run.longest}
    run.settle()
    run.longest = 0.0
    result |= run.orbit(seconds) | {"stall while orbiting": 1e3 * run.longest}
    run.app.close()
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=[FLANGE], metavar="MODEL")
    parser.add_argument("--resolution", default="1280,720", metavar="W,H")
    parser.add_argument("--seconds", type=float, default=6.0)
    parser.add_argument("--view", default="exact", choices=[view.value for view in View])
    options = parser.parse_args()
    width, height = (int(side) for side in options.resolution.split(","))
    for model in options.models:
        result = measure(model, View(options.view), (width, height), options.seconds)
        print(Path(model).name, *(f"  {name} {value:.3g}" for name, value in result.items()), sep="\n", flush=True)


if __name__ == "__main__":
    main()
