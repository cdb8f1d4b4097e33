"""The command line's options: what they are called, and what their values may be."""

from __future__ import annotations

import argparse
import difflib
import re
from collections.abc import Sequence
from typing import Any, NoReturn

from .camera import DEFAULT_VIEW_ANGLE, DEFAULT_ZOOM, VIEWS
from .frame import BUFFERS
from .render import DEFAULT_METHOD, MAX_PIXELS, methods
from .section import Section

MAX_SIDE = 32_768  # pixels


class UsageError(Exception):
    """Wrong usage; the message is one line."""


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, and which option or command was probably meant."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self._negative_number_matcher = re.compile(r"-[\d.]")  # what is no option: -1,1,0 as well as -1

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} (see {self.prog} --help)")

    def knows(self, option: str) -> bool:
        return any(option in action.option_strings for action in self._actions)

    def refuse_unknown(self, unknown: Sequence[str]) -> None:
        if not unknown:
            return
        name = unknown[0].split("=")[0]
        if not name.startswith("-"):
            self.error(f"unexpected argument {name!r}")
        known = [option for action in self._actions for option in action.option_strings]
        self.error(f"unknown option {name}{did_you_mean(name, known)}")


def did_you_mean(word: str, known: Sequence[str]) -> str:
    longer = [name for name in known if word and name.startswith(word)]
    close = longer or difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"; did you mean {close[0]}?" if close else ""


def add_common_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", metavar="MODEL", help="a STEP or BREP file")
    _add_timeout(parser)
    parser.add_argument("--strict", action="store_true", help="exit with status 1 if there was a warning")
    _add_verbose(parser)


def _add_timeout(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--timeout", type=_positive, default=300.0, metavar="SECONDS", help="for reading (default: 300)"
    )


def _add_verbose(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--verbose", action="store_true", help="print the time of each stage, and tracebacks")


def add_info_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--faces", action="store_true", help="add a line for every face")
    add_common_options(parser)


def add_bench_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add(
        "models",
        nargs="*",
        metavar="MODEL",
        help="STEP or BREP files, sphere or torus (default: the project's own and third-party models)",
    )
    add("--output", default="build/bench", metavar="DIR", help="for bench.md, .json and .png (default: build/bench)")
    add("--resolution", type=_resolution, default=(1920, 1080), metavar="W,H", help="in pixels (default: 1920,1080)")
    add("--threads", type=_count, default=2, metavar="N", help="compared with one thread (default: 2)")
    add("--quick", action="store_true", help="only our frames and the floor under them: no meshes, no comparisons")
    _add_verbose(parser)


def add_render_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--output", required=True, metavar="FILE", help="a .png, .exr or .npz file; - writes PNG to standard output")
    add("--resolution", type=_resolution, default=(1920, 1080), metavar="W,H", help="in pixels (default: 1920,1080)")
    names = ", ".join(methods())
    add(
        "--method",
        type=_method,
        default=DEFAULT_METHOD,
        metavar="NAME",
        help=f"one of {names} (default: {DEFAULT_METHOD})",
    )
    add(
        "--samples",
        type=_count,
        default=4,
        metavar="N",
        help="scan planes a pixel row, or rays a pixel side (default: 4)",
    )
    add("--threads", type=_count, metavar="N", help="default: every core")
    add(
        "--buffers",
        type=_buffers,
        metavar="NAMES",
        help=f"for .exr and .npz: some of {','.join(BUFFERS)} (default: all)",
    )
    add("--edges", action="store_true", help="draw the model's edges as lines")
    add("--shadows", action="store_true", help="cast shadows (only --method=bezier_clip_ray)")
    add(
        "--reflectance",
        type=_share,
        default=0.0,
        metavar="R",
        help="mirror this share, from 0 to below 1 (only --method=bezier_clip_ray; default: 0)",
    )
    _add_section(parser)
    add(
        "--background-color",
        type=_color,
        metavar="R,G,B",
        help="three numbers from 0 to 1, or #rrggbb (default: white)",
    )
    add("--no-background", action="store_true", help="transparent background (always so in .exr and .npz by default)")
    add_camera_options(parser)
    add_common_options(parser)


def add_camera_options(parser: argparse.ArgumentParser) -> None:
    camera = parser.add_argument_group("camera", "fits the model unless it comes from a file")
    add = camera.add_argument
    add("--camera", metavar="FILE", help="a camera file (JSON), or a picture that nofacet made")
    add(
        "--camera-direction",
        metavar="X,Y,Z",
        help=f"from the eye into the scene, or one of {' '.join(VIEWS)} (default: -1,1,-0.5)",
    )
    add("--camera-view-up", type=vector, metavar="X,Y,Z", help="default: 0,0,1")
    add(
        "--camera-zoom-factor",
        type=_positive,
        metavar="RATIO",
        help=f"1 fills the picture (default: {DEFAULT_ZOOM:g})",
    )
    add("--camera-orthographic", type=_boolean, nargs="?", const=True, metavar="BOOL", help="default: true")
    add(
        "--camera-view-angle",
        type=_positive,
        metavar="DEGREES",
        help=f"perspective with this vertical angle (default: {DEFAULT_VIEW_ANGLE:g})",
    )


def add_view_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("models", nargs="*", metavar="MODEL", help="STEP or BREP files; the arrow keys step through them")
    add("--watch", action="store_true", help="read the file again when it changes")
    add(
        "--view",
        default="side-by-side",
        metavar="NAME",
        help="exact, tessellated, side-by-side, wipe, blink or difference (default: side-by-side)",
    )
    add("--resolution", type=_resolution, default=(1280, 720), metavar="W,H", help="in pixels (default: 1280,720)")
    _add_section(parser)
    add("--output", metavar="FILE", help="draw into this .png file without a window, and quit")
    add_camera_options(parser)
    _add_timeout(parser)
    _add_verbose(parser)


def _add_section(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--section",
        type=_section,
        action="append",
        default=[],
        metavar="X,Y,Z/NX,NY,NZ",
        help="cut the model by a plane through X,Y,Z and take away the side that NX,NY,NZ points to; repeatable",
    )


def _numbers(text: str, count: int, example: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not all(abs(value) < float("inf") for value in values):
        wanted = "a finite number" if count == 1 else f"{count} numbers"
        raise argparse.ArgumentTypeError(f"{text!r} is not {wanted}; write for example {example}")
    return values


def vector(text: str) -> tuple[float, float, float]:
    x, y, z = _numbers(text, 3, "-1,1,-0.5")
    return x, y, z


def _positive(text: str) -> float:
    (value,) = _numbers(text, 1, "2.5")
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not positive")
    return value


def _share(text: str) -> float:
    (value,) = _numbers(text, 1, "0.3")
    if not 0 <= value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a share from 0 to below 1")
    return value


def _section(text: str) -> Section:
    origin, slash, normal = text.partition("/")
    if not slash:
        raise argparse.ArgumentTypeError(f"{text!r} is not ORIGIN/NORMAL; write for example 0,0,10/0,0,1")
    try:
        return Section(vector(origin), vector(normal))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 up")
    return int(text)


def _resolution(text: str) -> tuple[int, int]:
    width, height = _numbers(text, 2, "1920,1080")
    if not (width.is_integer() and height.is_integer() and width >= 1 and height >= 1):
        raise argparse.ArgumentTypeError(f"{text!r} is not two whole numbers from 1 up; write for example 1920,1080")
    if max(width, height) > MAX_SIDE or width * height > MAX_PIXELS:
        raise argparse.ArgumentTypeError(
            f"{text!r} is too large; at most {MAX_SIDE} pixels a side and {MAX_PIXELS // 10**6} million in all"
        )
    return int(width), int(height)


def _method(text: str) -> str:
    if text not in methods():
        meant = did_you_mean(text, methods()) or f"; the methods are {', '.join(methods())}"
        raise argparse.ArgumentTypeError(f"unknown method {text!r}{meant}")
    return text


def _boolean(text: str) -> bool:
    if text.lower() not in ("true", "false"):
        raise argparse.ArgumentTypeError(f"{text!r} is neither true nor false")
    return text.lower() == "true"


def _color(text: str) -> tuple[float, ...]:
    if text.startswith("#"):
        try:
            if len(text) == 7:
                return tuple(byte / 255 for byte in bytes.fromhex(text[1:]))
        except ValueError:
            pass
        raise argparse.ArgumentTypeError(f"{text!r} is not a color; write for example #ffffff")
    color = _numbers(text, 3, "0.2,0.2,0.2 or #333333")
    if not all(0 <= value <= 1 for value in color):
        raise argparse.ArgumentTypeError(f"{text!r} is not three numbers from 0 to 1")
    return color


def _buffers(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    for name in names:
        if name not in BUFFERS:
            raise argparse.ArgumentTypeError(f"unknown buffer {name!r}{did_you_mean(name, list(BUFFERS))}")
    return names
