"""The exact picture in the background: its steps, and that it is called off."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import nofacet
from nofacet.model import Model

FLANGE = Path(__file__).resolve().parents[1] / "cad_models" / "flange.step"


@pytest.mark.parametrize("method", nofacet.methods())
def test_a_frame_that_is_called_off_has_no_result(sphere: Model, method: str) -> None:
    cancel = nofacet.Cancel()
    camera = nofacet.Camera.fit(sphere, resolution=(64, 64))
    nofacet.render(sphere, camera, (64, 64), method=method, cancel=cancel)
    cancel.set()
    assert cancel.is_set()
    with pytest.raises(nofacet.Cancelled):
        nofacet.render(sphere, camera, (64, 64), method=method, cancel=cancel)


@pytest.mark.parametrize("method", nofacet.methods())
def test_another_thread_calls_a_long_frame_off(sphere: Model, method: str) -> None:
    """The whole frame would take minutes; and the interpreter runs on meanwhile."""
    cancel, ended = nofacet.Cancel(), []
    camera = nofacet.Camera.fit(sphere, resolution=(8000, 8000))

    def draw() -> None:
        try:
            nofacet.render(sphere, camera, (8000, 8000), method=method, samples=64, buffers=("color",), cancel=cancel)
        except nofacet.Cancelled:
            ended.append(True)

    thread = threading.Thread(target=draw)
    thread.start()
    time.sleep(0.2)
    assert thread.is_alive()
    cancel.set()
    thread.join(60)
    assert ended


def test_reading_is_called_off() -> None:
    cancel = nofacet.Cancel()
    threading.Timer(0.2, cancel.set).start()
    with pytest.raises(nofacet.Cancelled, match="flange.step: reading was called off"):
        nofacet.load(FLANGE, cancel=cancel)


class Collector:
    """An exact renderer whose frames are collected."""

    def __init__(self) -> None:
        pytest.importorskip("nofacet_viewer")
        pytest.importorskip("moderngl")
        from nofacet_viewer.exact import ExactRenderer

        self.renderer = ExactRenderer(self.collect)
        self.frames: list = []
        self.new = threading.Event()

    def collect(self) -> None:
        frame = self.renderer.latest()
        if frame is not None:
            self.frames.append(frame)
            self.new.set()

    def wait(self, condition) -> None:  # type: ignore[no-untyped-def]
        end = time.monotonic() + 60
        while not condition():
            assert time.monotonic() < end
            self.new.wait(0.05)
            self.new.clear()


def request(model: Model, turn: float = 0.0, resolution: tuple[int, int] = (96, 64)):  # type: ignore[no-untyped-def]
    from nofacet_viewer.exact import Request

    camera = nofacet.Camera.fit(model, resolution=resolution).orbit(turn, 0)
    return Request(model, camera, resolution)


def test_at_rest_the_picture_gets_better_step_by_step(sphere: Model) -> None:
    collector = Collector()
    wanted = request(sphere)
    collector.renderer.show(wanted)
    collector.wait(lambda: collector.frames and collector.frames[-1].is_full)
    collector.renderer.show(wanted)  # nothing new: nothing happens
    collector.renderer.stop()
    steps = [(frame.scale, frame.samples) for frame in collector.frames]
    assert steps[0] == (0.5, 1)
    assert steps[-1] == (1.0, 16)
    assert steps == sorted(steps)
    assert collector.frames[0].frame.resolution == (48, 32)
    full = nofacet.render(sphere, wanted.camera, (96, 64), samples=16, buffers=("color",))
    np.testing.assert_array_equal(collector.frames[-1].frame.color, full.color)


def test_a_camera_that_moves_ends_the_refinement(sphere: Model) -> None:
    collector = Collector()
    slow = request(sphere, resolution=(3000, 3000))
    collector.renderer.show(slow)
    collector.wait(lambda: len(collector.frames) >= 1)  # the frame in motion; refining goes on
    moved = request(sphere, 30.0)
    collector.renderer.show(moved)
    collector.wait(lambda: collector.frames[-1].request == moved and collector.frames[-1].is_full)
    collector.renderer.stop()
    assert not any(frame.request == slow and frame.is_full for frame in collector.frames)


def test_going_back_to_a_request_that_was_called_off_draws_it(sphere: Model) -> None:
    collector = Collector()
    first, second = request(sphere), request(sphere, 45.0)
    for _ in range(5):
        collector.renderer.show(first)
        collector.renderer.show(second)
    collector.renderer.show(first)
    collector.wait(lambda: collector.frames and collector.frames[-1].request == first and collector.frames[-1].is_full)
    collector.renderer.stop()


def test_under_a_mouse_that_never_rests_frames_appear(sphere: Model) -> None:
    collector = Collector()
    turn = 0.0
    end = time.monotonic() + 60
    while len(collector.frames) < 5:
        assert time.monotonic() < end
        turn += 1.0
        collector.renderer.show(request(sphere, turn))
        time.sleep(0.002)
    collector.renderer.stop()


def test_a_model_with_nothing_to_draw_gets_a_line(sphere: Model) -> None:
    from dataclasses import replace

    collector = Collector()
    collector.renderer.show(replace(request(sphere), model=replace(sphere, groups=[], source="empty.step")))
    collector.wait(lambda: bool(collector.frames))
    collector.renderer.stop()
    assert collector.frames == ["empty.step: no face could be converted, there is nothing to draw; see its warnings"]


def test_the_end_of_a_motion_is_not_waited_for_where_it_is_known(
    sphere: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    collector = Collector()
    from nofacet_viewer import exact

    monkeypatch.setattr(exact, "REST_SECONDS", 3600.0)
    collector.renderer.show(request(sphere))
    collector.wait(lambda: collector.frames)
    assert not collector.frames[-1].is_full
    collector.renderer.rest(request(sphere))
    collector.wait(lambda: collector.frames[-1].is_full)
    moved = request(sphere, 30.0)
    collector.renderer.rest(moved)  # and where it is known from the beginning
    collector.wait(lambda: collector.frames[-1].request == moved and collector.frames[-1].is_full)
    collector.renderer.stop()


def test_a_program_may_end_while_a_frame_is_drawn() -> None:
    """It was aborted: the thread that drew came back to an interpreter that was gone."""
    code = (
        "import time, nofacet; from nofacet_viewer.exact import ExactRenderer, Request;"
        f"model = nofacet.load({str(FLANGE)!r}); camera = nofacet.Camera.fit(model);"
        "ExactRenderer().show(Request(model, camera, (4000, 4000))); time.sleep(0.2)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")
