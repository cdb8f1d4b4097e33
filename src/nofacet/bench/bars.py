"""The bars that the project set itself: what must be reached, what is aimed at, what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..render import DEFAULT_METHOD
from .subject import OWN, PRIMITIVES, SMALL_PATCHES
from .timing import ratio

if TYPE_CHECKING:
    from .report import Report, SubjectResult

RAY_METHOD = "bezier_clip_ray"
RAYS_A_SECOND = 2e6  # what the ray tracer must reach on the teapot, one core, for the comparison to mean something
PACKET_EMBREE = 0.020  # s: the fastest that Embree in 4x4 packets drew a 0.1 px mesh on two threads, measured elsewhere
MANY_PATCHES = 100_000


@dataclass(frozen=True)
class Bar:
    """One bar for one model.

    limits: what must be reached and what is aimed at, None where there is no such limit; at_least: whether more is
    better. open_ended: the measured value is a bound only, because what it is compared with ran into its time limit.
    """

    text: str
    model: str
    measured: float
    limits: tuple[float | None, float | None]
    at_least: bool
    unit: str = ""
    open_ended: bool = False

    @property
    def verdict(self) -> str:
        """One of: missed, met, aim met, aim missed (where only an aim is set), not settled (by an open-ended value)."""
        must, aim = (None if limit is None else self._reaches(limit) for limit in self.limits)
        if self.open_ended and False in (must, aim):
            return "not settled"
        if must is False:
            return "missed"
        return "aim met" if aim else "met" if must else "aim missed"

    def _reaches(self, limit: float) -> bool:
        return self.measured >= limit if self.at_least else self.measured <= limit


def bars(report: Report) -> list[Bar]:
    """Every bar that this run measured something for."""
    return [
        bar
        for check in (_floor, _first_picture, _later_frames, _methods, _threads, _samples)
        for bar in (found for result in report.subjects for found in check(result, report.threads))
    ] + [*_scaling(report)]


def _floor(result: SubjectResult, threads: int) -> Iterator[Bar]:
    frame = result.frame(DEFAULT_METHOD, 1, 1)
    if not frame or not result.floor:
        return
    times = ratio(frame.seconds, result.floor.seconds)
    if result.name in (*PRIMITIVES, *OWN):
        yield Bar("frame / floor, one thread", result.name, times, (3.5, 2), False)
    elif result.name in SMALL_PATCHES:
        yield Bar("frame / floor, one thread, small patches", result.name, times, (8, 4), False)


def _first_picture(result: SubjectResult, threads: int) -> Iterator[Bar]:
    fine, coarse = result.mesh("0.1 px"), result.mesh("1 px")
    picture = result.first_picture(threads)
    if not picture:
        return
    own = picture.seconds
    if fine:
        text = f"meshing at 0.1 px / first picture on {threads} threads"
        yield Bar(text, result.name, fine.seconds / own, (10, None), True, open_ended=fine.timed_out)
    if coarse:
        text = f"meshing at 1 px / first picture on {threads} threads"
        yield Bar(text, result.name, coarse.seconds / own, (None, 1), True, open_ended=coarse.timed_out)


def _later_frames(result: SubjectResult, threads: int) -> Iterator[Bar]:
    mesh, frame = result.mesh("0.1 px"), result.frame(DEFAULT_METHOD, 1, 1)
    if mesh and frame and mesh.embree:
        times = mesh.embree[1] / frame.seconds.fastest
        yield Bar("Embree on the 0.1 px mesh / frame, one thread each", result.name, times, (1, None), True)
    frame = result.frame(DEFAULT_METHOD, threads, 1)
    if frame and threads == 2:
        text = "frame on two threads against Embree in packets (recorded: 20 to 37 ms)"
        yield Bar(text, result.name, 1e3 * frame.seconds.fastest, (None, 1e3 * PACKET_EMBREE), False, "ms")


def _methods(result: SubjectResult, threads: int) -> Iterator[Bar]:
    scanline, ray = result.frame(DEFAULT_METHOD, 1, 1), result.frame(RAY_METHOD, 1, 1)
    if not scanline or not ray:
        return
    times = ratio(ray.seconds, scanline.seconds)
    yield Bar(f"{RAY_METHOD} / {DEFAULT_METHOD}, one thread", result.name, times, (5, 10), True)
    if result.name == "teapot":
        width, height = result.resolution
        rate = width * height / ray.seconds.fastest
        text = f"{RAY_METHOD}, primary rays a second on one thread"
        yield Bar(text, result.name, rate / 1e6, (RAYS_A_SECOND / 1e6, None), True, "million")


def _threads(result: SubjectResult, threads: int) -> Iterator[Bar]:
    one, two = result.frame(DEFAULT_METHOD, 1, 1), result.frame(DEFAULT_METHOD, 2, 1)
    if one and two:
        yield Bar("one thread / two threads", result.name, ratio(one.seconds, two.seconds), (1.8, 1.95), True)


def _samples(result: SubjectResult, threads: int) -> Iterator[Bar]:
    one, four = result.frame(DEFAULT_METHOD, 1, 1), result.frame(DEFAULT_METHOD, 1, 4)
    if one and four:
        times = ratio(four.seconds, one.seconds)
        yield Bar("4 samples / 1 sample, one thread", result.name, times, (2.5, 2), False)


def _scaling(report: Report) -> Iterator[Bar]:
    for crowd in report.crowds:
        if crowd.model == "chain":
            seconds = crowd.seconds.fastest
            yield Bar(
                f"{crowd.patches:,} patches on screen, {crowd.threads} threads", "chain", seconds, (1, 0.1), False, "s"
            )
    series = [crowd for crowd in report.crowds if crowd.model == "teapot"]
    for fewer, more in zip(series, series[1:], strict=False):
        times = more.seconds.fastest / fewer.seconds.fastest
        text = f"time at {more.patches:,} patches / at {fewer.patches:,}, same coverage"
        yield Bar(text, "teapot", times, (more.patches / fewer.patches, None), False)
