"""The command line: `nofacet render`, `nofacet view`, `nofacet info` and `nofacet bench`.

Exit status: 0 done, 1 the input could not be shown or the picture not be written, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

import nofacet

from .camera import DEFAULT_VIEW_ANGLE, VIEWS, Camera
from .cli_options import (
    Parser,
    UsageError,
    add_bench_options,
    add_info_options,
    add_render_options,
    add_view_options,
    did_you_mean,
    vector,
)
from .errors import InputError, check_name
from .frame import BUFFERS, check_extension
from .render import check_request
from .summary import summary

WHITE = (1.0, 1.0, 1.0)
INTERRUPTED = 130  # what a shell reports for a program ended by Ctrl-C
BROKEN_PIPE = 141  # the same for one whose reader went away
VIEWER_MODULES = ("nofacet_viewer", "glfw", "imgui_bundle", "moderngl", "OpenGL")
CLEAR_LINE = "\r\x1b[K"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    verbose = "--verbose" in (sys.argv[1:] if arguments is None else arguments)
    if sys.stderr is None:  # closed; print() would write to standard output instead
        sys.stderr = io.StringIO()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a name may have letters that the terminal lacks
    try:
        options = _parse(arguments)
        status: int = options.run(options)
        return status
    except UsageError as error:
        return _fail(error, 2)
    except InputError as error:
        return _fail(error, 1)
    except BrokenPipeError:
        return BROKEN_PIPE
    except OSError as error:
        return _fail(f"{error.filename}: {error.strerror}" if error.filename else error, 1)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        if verbose:
            traceback.print_exc()
        hint = "please report it with the output of --verbose"
        return _fail(f"internal error: {type(error).__name__}: {error}; {hint}", 1)


def _fail(message: object, status: int) -> int:
    print(f"nofacet: {' '.join(str(message).split())}", file=sys.stderr)
    return status


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = Parser(prog="nofacet", description="Draws CAD models from their exact surfaces.", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"nofacet {version('nofacet')}")
    commands: dict[str, tuple[Parser, Callable[[argparse.Namespace], int]]] = {}
    subparsers = parser.add_subparsers(metavar="COMMAND", dest="command", parser_class=Parser)
    for name, add_options, run, text in (
        ("render", add_render_options, _render, "draw a STEP or BREP file into a picture"),
        ("view", add_view_options, _view, "show STEP or BREP files in a window, exact and tessellated"),
        ("info", add_info_options, _info, "say what is in a STEP or BREP file"),
        ("bench", add_bench_options, _bench, "measure speed and error of exact pictures and of triangles"),
    ):
        command = subparsers.add_parser(
            name, help=text, description=f"{text[0].upper()}{text[1:]}.", allow_abbrev=False
        )
        add_options(command)
        commands[name] = command, run

    words = list(sys.argv[1:] if arguments is None else arguments)
    if not words:
        words = ["--help"]
    if not words[0].startswith("-") and words[0] not in commands:
        meant = did_you_mean(words[0], list(commands)) or f"; the commands are {', '.join(commands)}"
        parser.error(f"unknown command {words[0]!r}{meant}")
    first = words[0].split("=")[0]
    if not parser.knows(first) and any(command.knows(first) for command, _ in commands.values()):
        parser.error(f"{first} comes before the command; write options after it, as in nofacet info MODEL --verbose")
    options, unknown = parser.parse_known_args(words)
    if options.command is None:
        parser.refuse_unknown(unknown)
        parser.error("a command is missing")
    chosen, options.run = commands[options.command]
    chosen.refuse_unknown(unknown)
    return options


def _render(options: argparse.Namespace) -> int:
    to_stdout = options.output == "-"
    output = Path("-.png" if to_stdout else options.output)
    _check_output(options, output, to_stdout)
    buffers = _rendered_buffers(options, output)
    with _usage():
        check_request(
            options.resolution,
            options.method,
            options.samples,
            options.threads,
            buffers,
            options.shadows,
            options.reflectance,
            options.section,
        )
    camera = _camera_from_file(options)
    model = _load(options, options.model)
    with _stage(options, "fit camera"), _usage():
        camera = camera or _fitted_camera(options, model, options.resolution)
    with _stage(options, "render"):
        frame = nofacet.render(
            model,
            camera,
            resolution=options.resolution,
            method=options.method,
            samples=options.samples,
            threads=options.threads,
            buffers=buffers,
            edges=options.edges,
            shadows=options.shadows,
            reflectance=options.reflectance,
            sections=options.section,
        )
    incomplete = frame.stats.get("unresolved_faces", ())
    for face in incomplete:
        _say(f"warning: face {face} is not drawn completely: part of it could not be computed reliably")
    warnings = frame.stats.get("warnings", ())
    for warning in warnings:
        _say(f"warning: {warning}")
    if options.verbose:
        _say_stats(frame.stats)
    with _stage(options, "save"):
        if options.background_color or (output.suffix.lower() == ".png" and not options.no_background):
            frame = frame.over(options.background_color or WHITE)
        if to_stdout:
            picture = frame.to_png()
            with _standard_output() as stdout:
                stdout.buffer.write(picture)
        else:
            with _writing(output):
                frame.save(output, options.buffers)
    return 1 if options.strict and (model.warnings or incomplete or warnings) else 0


def _view(options: argparse.Namespace) -> int:
    camera = _camera_from_file(options)
    if options.output is not None and (options.watch or len(options.models) != 1):
        raise UsageError("--output draws one model once; give one MODEL and leave out --watch")
    with _viewer_modules():
        from nofacet_viewer.state import View

        known = {view.value: view for view in View}
        if options.view not in known:
            meant = did_you_mean(options.view, list(known)) or f"; the views are {' '.join(known)}"
            raise UsageError(f"--view: unknown view {options.view!r}{meant}")
        if options.output is not None:
            _write_view(options, known[options.view], camera)
        else:
            from nofacet_viewer.app import Options, view

            fit, sections = partial(_fitted_camera, options), tuple(options.section)
            wanted = options.models, known[options.view], camera, options.resolution, options.watch, sections, fit
            view(Options(*wanted, timeout=options.timeout))
    return 0


def _write_view(options: argparse.Namespace, view: Any, camera: Camera | None) -> None:
    """Draw a view (nofacet_viewer.state.View) of a model without a window."""
    from nofacet_viewer.offscreen import check_picture, side_resolution, write_view

    source, output = options.models[0], Path(options.output)
    with _usage():
        check_picture(output, options.resolution)
    _check_writable(output)
    model = _load(options, source, measure=True)
    with _stage(options, "fit camera"), _usage():
        camera = camera or _fitted_camera(options, model, side_resolution(view, options.resolution))
    with _stage(options, "draw"), _writing(output):
        given = {"model": model, "timeout": options.timeout, "sections": options.section}
        write_view(source, output, view, options.resolution, camera, **given)


@contextmanager
def _viewer_modules() -> Iterator[None]:
    """For what imports the viewer: says how to install what it lacks."""
    try:
        yield
    except ImportError as error:
        module = (error.name or "").split(".")[0]
        if module and module not in VIEWER_MODULES:
            raise
        problem = f"needs the module {module}" if module else f"cannot be loaded ({error})"
        raise InputError(f"the viewer {problem}: pip install 'nofacet[viewer]'") from None


def _say_stats(stats: Mapping[str, Any]) -> None:
    """The renderer's own stages and counts."""
    for name, value in stats.items():
        stage = name.removesuffix("_seconds")
        if stage != name:
            _say(f"  {stage}: {value:.3f} s")
        elif isinstance(value, int):
            _say(f"  {stage}: {value}")


def _info(options: argparse.Namespace) -> int:
    _check_standard_output()
    model = _load(options, options.model, measure=True)
    with _standard_output() as stdout:
        print(summary(model, faces=options.faces), file=stdout)
    return 1 if options.strict and model.warnings else 0


def _bench(options: argparse.Namespace) -> int:
    from .bench.run import FILES, run, write  # loads OpenCascade

    _check_standard_output()
    folder = Path(options.output)
    if folder.is_file():
        raise InputError(f"{folder}: is a file, and --output needs a folder; choose another one")
    with _writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        _check_writable(folder / name)
    report = run(options.models, options.resolution, options.threads, options.quick, _say)
    if not report.subjects:
        return 1
    with _writing(folder):
        markdown = write(report, folder, plotted=not options.quick)
    with _standard_output() as stdout:
        stdout.write(markdown)
    return 0


def _load(options: argparse.Namespace, path: str, measure: bool = False) -> nofacet.Model:
    """The model, with its warnings said on standard error."""
    with _stage(options, "read"), _progress() as progress:
        model = nofacet.load(path, timeout=options.timeout, progress=progress, measure=measure)
    for warning in model.warnings:
        _say(f"warning: {warning}")
    return model


def _check_output(options: argparse.Namespace, output: Path, to_stdout: bool) -> None:
    """Find what would stop the picture from being written before the long work, not after it."""
    with _usage():
        extension = check_extension(output)
    if options.no_background and options.background_color:
        raise UsageError("--background-color and --no-background exclude each other; give one of them")
    if options.buffers and extension == ".png":
        raise UsageError("--buffers is for .exr and .npz; a PNG file holds the color only")
    if options.buffers and options.background_color and "color" not in options.buffers:
        raise UsageError("--background-color needs the color buffer; add it to --buffers")
    if to_stdout:
        _check_standard_output()
        if sys.stdout.isatty():
            raise UsageError(
                "--output=- writes PNG data, and standard output is a terminal; send it to a file or program"
            )
    else:
        _check_writable(output)


def _check_standard_output() -> None:
    if sys.stdout is None:
        raise InputError("standard output is closed, and the result goes there; send it to a file or program")


@contextmanager
def _standard_output() -> Iterator[TextIO]:
    """For what writes to it: in the end all is written, or an error says why not."""
    with _writing("standard output"):
        try:
            yield sys.stdout
            sys.stdout.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # keeps the interpreter's last flush quiet
            raise


@contextmanager
def _writing(place: str | Path) -> Iterator[None]:
    """For what writes there: an error says where, why and what to do."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        where, reason = error.filename or place, error.strerror or str(error).removeprefix(f"{place}: ")
        advice = "choose another place, or make room if the disk is full"
        raise InputError(f"{where}: cannot be written ({reason}); {advice}") from None


def _check_writable(output: Path) -> None:
    check_name(str(output))
    if not output.parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist; make it first")
    if output.is_dir() or not os.access(output if output.exists() else output.parent, os.W_OK):
        raise InputError(f"{output}: cannot be written; choose another file")


def _rendered_buffers(options: argparse.Namespace, output: Path) -> tuple[str, ...]:
    """What the renderer has to compute for the file: position comes from depth."""
    if output.suffix.lower() == ".png":
        return ("color",)
    wanted = options.buffers or tuple(BUFFERS)
    return tuple(dict.fromkeys("depth" if name == "position" else name for name in wanted))


CAMERA_OPTIONS = ("direction", "view_up", "zoom_factor", "orthographic", "view_angle")


def _camera_from_file(options: argparse.Namespace) -> Camera | None:
    given = [name for name in CAMERA_OPTIONS if getattr(options, f"camera_{name}") is not None]
    if options.camera_orthographic and options.camera_view_angle is not None:
        raise UsageError("--camera-view-angle is for perspective; leave out --camera-orthographic")
    if options.camera_direction not in (None, *VIEWS):
        _direction(options.camera_direction)
    if options.camera is None:
        return None
    if given:
        raise UsageError(f"--camera holds the whole camera; leave out --camera-{given[0].replace('_', '-')}")
    return _camera_file(options.camera)


def _camera_file(path: str) -> Camera:
    try:
        check_name(path)
        return Camera.load(path)
    except ValueError as error:
        raise UsageError(str(error)) from None
    except OSError as error:
        reason = error.strerror or error
        raise UsageError(f"{path}: {reason}; give a camera file, or a picture that nofacet made") from None


def _direction(text: str) -> tuple[float, ...]:
    try:
        return vector(text)
    except argparse.ArgumentTypeError as error:
        meant = did_you_mean(text, list(VIEWS)) or f"; the views are {' '.join(VIEWS)}"
        raise UsageError(f"--camera-direction: {error}, or a view{meant}") from None


def _fitted_camera(options: argparse.Namespace, model: nofacet.Model, resolution: tuple[int, int]) -> Camera:
    """The camera that the options describe, fitted to the model. Raises ValueError where they contradict each other."""
    wanted: dict[str, Any] = {"resolution": resolution}
    if options.camera_direction in VIEWS:
        wanted["direction"], wanted["view_up"] = VIEWS[options.camera_direction]
    elif options.camera_direction:
        wanted["direction"] = _direction(options.camera_direction)
    if options.camera_view_up:
        wanted["view_up"] = options.camera_view_up
    if options.camera_zoom_factor:
        wanted["zoom"] = options.camera_zoom_factor
    if options.camera_view_angle or options.camera_orthographic is False:
        wanted["projection"] = "perspective"
        wanted["view_angle"] = options.camera_view_angle or DEFAULT_VIEW_ANGLE
    return Camera.fit(model, **wanted)


@contextmanager
def _usage() -> Iterator[None]:
    """What makes no sense here is wrong usage."""
    try:
        yield
    except InputError:
        raise
    except ValueError as error:
        raise UsageError(str(error)) from None


@contextmanager
def _stage(options: argparse.Namespace, name: str) -> Iterator[None]:
    """Print how long the stage took, with --verbose."""
    begin = time.perf_counter()
    yield
    if options.verbose:
        _say(f"{name}: {time.perf_counter() - begin:.3f} s")


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """For load() to call once a second: one line on a terminal, overwritten; elsewhere a line after 1, 2, 4, 8... s."""
    calls = 0

    def show(message: str) -> None:
        nonlocal calls
        calls += 1
        if sys.stderr.isatty():
            print(f"{CLEAR_LINE}nofacet: {message}", end="", file=sys.stderr, flush=True)
        elif calls & (calls - 1) == 0:
            _say(message)

    try:
        yield show
    finally:
        if calls and sys.stderr.isatty():
            print(CLEAR_LINE, end="", file=sys.stderr, flush=True)


def _say(message: str) -> None:
    print(f"nofacet: {message}", file=sys.stderr, flush=True)
