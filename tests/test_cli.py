"""The command line: its messages, its exit status and what it asks of load() and render()."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nofacet
from nofacet import cli, image
from nofacet.camera import Camera
from nofacet.errors import InputError
from nofacet.frame import BUFFERS, Frame
from nofacet.model import Model, Node
from nofacet.section import Section


class Stand:
    """Stands in for reading and rendering, and remembers what it was asked."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.loaded: dict[str, Any] = {}
        self.rendered: dict[str, Any] = {}
        self.stats: dict[str, Any] = {"scan_seconds": 0.25, "pieces": 17, "unresolved_faces": []}

    def load(self, source: str, **options: Any) -> Model:
        self.loaded = {"source": source, **options}
        return self.model

    def render(self, model: Model, camera: Camera, **options: Any) -> Frame:
        self.rendered = {"camera": camera, **options}
        width, height = options["resolution"]
        buffers = {
            name: np.zeros((height, width) + ((BUFFERS[name][1],) if BUFFERS[name][1] > 1 else ()), BUFFERS[name][0])
            for name in options["buffers"]
        }
        return Frame(camera, buffers, self.stats)


@pytest.fixture
def stand(sphere: Model, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Stand:
    stand = Stand(sphere)
    monkeypatch.setattr(nofacet, "load", stand.load, raising=False)
    monkeypatch.setattr(nofacet, "render", stand.render, raising=False)
    monkeypatch.chdir(tmp_path)
    return stand


def run(*arguments: str) -> int:
    return cli.main(["render", "part.step", "--resolution=8,6", *arguments])


def only_line(capsys: pytest.CaptureFixture[str]) -> str:
    """What was written to standard error, which must be a single line; nothing on standard output."""
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith("nofacet: ")
    return line.removeprefix("nofacet: ")


def test_render_writes_a_white_png(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--output=part.png") == 0
    pixels, _, attributes = image.read("part.png")
    assert pixels.shape == (6, 8, 4) and (pixels == 1).all()
    assert json.loads(attributes["nofacet:camera"]) == stand.rendered["camera"].to_dict()
    assert stand.loaded["source"] == "part.step" and stand.loaded["timeout"] == 300
    assert stand.rendered["buffers"] == ("color",) and stand.rendered["samples"] == 4
    assert stand.rendered["method"] == "bezier_clip_scanline" and stand.rendered["threads"] is None
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("option", "value"),
    [("--no-background", [0, 0, 0, 0]), ("--background-color=#ff8000", [255, 128, 0, 255])]
    + [("--background-color=0,0.5,1", [0, 128, 255, 255])],
)
def test_backgrounds(stand: Stand, option: str, value: list[int]) -> None:
    assert run("--output=part.png", option) == 0
    assert np.rint(255 * image.read("part.png")[0][0, 0]).tolist() == value


def test_data_files_hold_all_buffers_unless_told_otherwise(stand: Stand) -> None:
    assert run("--output=part.npz") == 0
    assert set(Frame.load("part.npz").buffers) == set(BUFFERS)
    assert stand.rendered["buffers"] == ("color", "coverage", "depth", "face", "uv", "normal")
    assert run("--output=part.exr", "--buffers=position,face") == 0
    assert stand.rendered["buffers"] == ("depth", "face")
    assert set(image.read("part.exr")[1]) == {"P.X", "P.Y", "P.Z", "face"}


def test_png_to_standard_output(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    stdout = io.TextIOWrapper(io.BytesIO())
    monkeypatch.setattr(sys, "stdout", stdout)
    assert run("--output=-") == 0
    assert stdout.buffer.getvalue().startswith(b"\x89PNG")


def test_secondary_rays(stand: Stand) -> None:
    assert run("--output=part.png") == 0
    assert not stand.rendered["shadows"] and stand.rendered["reflectance"] == 0
    assert run("--output=part.png", "--method=bezier_clip_ray", "--shadows", "--reflectance=0.25") == 0
    assert stand.rendered["shadows"] and stand.rendered["reflectance"] == 0.25


def test_camera_options(stand: Stand) -> None:
    def camera(*options: str) -> Camera:
        assert run("--output=part.png", *options) == 0
        result: Camera = stand.rendered["camera"]
        return result

    resolution = (8, 6)
    assert camera() == Camera.fit(stand.model, resolution=resolution)
    assert camera("--camera-direction=1,2,-3", "--camera-view-up=0,1,0", "--camera-zoom-factor=2") == Camera.fit(
        stand.model, (1, 2, -3), view_up=(0, 1, 0), zoom=2, resolution=resolution
    )
    assert camera("--camera-direction", "-1,1,-0.5") == camera("--camera-direction=-1,1,-0.5")
    assert camera("--camera-direction=top").view_up == (0, 1, 0)
    assert camera("--camera-direction=iso", "--camera-orthographic").projection == "orthographic"
    assert camera("--camera-view-angle=50").view_angle == 50
    assert camera("--camera-orthographic=false").view_angle == 30
    fixed = Camera("perspective", (9, 9, 9), (0, 0, 0), view_angle=12.5)
    Path("camera.json").write_text(json.dumps(fixed.to_dict()))
    assert camera("--camera=camera.json") == fixed
    assert camera("--camera=part.png") == fixed  # from the picture that the line above made
    Path("camera.json").write_text(json.dumps(fixed.to_dict()), encoding="utf-8-sig")  # as some editors save it
    assert camera("--camera=camera.json") == fixed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rendr", "part.step"], "unknown command 'rendr'; did you mean render?"),
        (["part.step"], "unknown command 'part.step'; the commands are render, view, info, bench"),
        (["render", "part.step"], "--output"),
        (["render", "--output=a.png"], "MODEL"),
        (["render", "a.step", "b.step", "--output=a.png"], "unexpected argument 'b.step'"),
        (["render", "a.step", "--output=a.png", "--smaples=4"], "unknown option --smaples; did you mean --samples?"),
        (["render", "a.step", "--output=a.png", "--camera-dir=1,0,0"], "did you mean --camera-direction?"),
        (["--outptu=a.png"], "unknown option --outptu"),
        (["info", "a.step", "--edges"], "unknown option --edges"),
        (["--verbose", "render", "a.step", "--output=a.png"], "--verbose comes before the command; write"),
        (["--timeout", "5", "info", "a.step"], "--timeout comes before the command"),
    ],
)
def test_wrong_usage(stand: Stand, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert cli.main(arguments) == 2
    assert message in only_line(capsys)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--resolution=0,100"], "from 1 up"),
        (["--resolution=-5,100"], "from 1 up"),
        (["--resolution=10.5,100"], "whole numbers"),
        (["--resolution=100"], "'100' is not 2 numbers"),
        (["--resolution=1000000,1"], "too large"),
        (["--resolution=30000,30000"], "too large"),
        (["--samples=0"], "from 1 up"),
        (["--threads=many"], "from 1 up"),
        (["--timeout=-1"], "not positive"),
        (["--timeout=nan"], "'nan' is not a finite number; write for example 2.5"),
        (["--background-color=red"], "not 3 numbers"),
        (["--background-color=#12345g"], "not a color"),
        (["--background-color=0,0,2"], "from 0 to 1"),
        (["--background-color=0,0,0", "--no-background"], "exclude each other"),
        (["--camera-direction=fromt"], "did you mean front?"),
        (["--camera-direction=0,0,0"], "direction is zero"),
        (["--camera-view-up=1,2"], "not 3 numbers"),
        (["--camera-zoom-factor=0"], "not positive"),
        (["--camera-view-angle=200"], "between 0 and 180"),
        (["--camera-view-angle=20", "--camera-orthographic"], "is for perspective"),
        (["--camera-orthographic=maybe"], "neither true nor false"),
        (["--camera=missing.json"], "missing.json: No such file"),
        (["--camera=."], ".: Is a directory; give a camera file, or a picture that nofacet made"),
        (["--camera=o\udcff.png"], "the name is not UTF-8; rename it"),
        (["--camera=deep.json"], "deep.json: this is not a JSON camera file"),
        (["--camera=empty.json"], "empty.json: this is not a JSON camera file"),
        (["--camera=list.json"], "list.json: camera: this is not a JSON object"),
        (["--camera=plain.png"], "only pictures made by nofacet"),
        (["--camera=list.json", "--camera-direction=top"], "leave out --camera-direction"),
        (["--method=bezier_clip_scan"], "did you mean bezier_clip_scanline?"),
        (["--samples=257"], "give 1 to 256"),
        (["--shadows"], "casts neither shadows nor mirror images; choose bezier_clip_ray"),
        (["--reflectance=0.5"], "casts neither shadows nor mirror images; choose bezier_clip_ray"),
        (["--section=1,2,3"], "'1,2,3' is not ORIGIN/NORMAL; write for example 0,0,10/0,0,1"),
        (["--section=1,2/0,0,1"], "'1,2' is not 3 numbers"),
        (["--section=0,0,0/0,0,0"], "the normal is 0, 0, 0"),
        (["--section=0,0,0/0,0,1", "--method=bezier_clip_ray", "--shadows"], "section planes cut neither"),
        (["--reflectance=1", "--method=bezier_clip_ray"], "'1' is not a share from 0 to below 1"),
        (["--threads=1025"], "give 1 to 1024"),
        (["--output=part.jpg"], "use .png, .exr or .npz"),
        (["--output=part"], "use .png, .exr or .npz"),
        (["--buffers=depth"], "is for .exr and .npz"),
        (["--output=part.npz", "--buffers=depht"], "did you mean depth?"),
    ],
)
def test_wrong_values(stand: Stand, capsys: pytest.CaptureFixture[str], options: list[str], message: str) -> None:
    Path("empty.json").write_text("")
    Path("deep.json").write_text("[" * 100_000)
    Path("list.json").write_text("[1]")
    image.write("plain.png", np.zeros((2, 2, 4), np.uint8), "RGBA", {})
    assert run("--output=part.png", *options) == 2
    assert message in only_line(capsys)
    assert not Path("part.png").exists()
    assert not stand.loaded or options[0].startswith("--camera")  # found before the long work


def test_output_that_cannot_be_written(stand: Stand, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "folder.png").mkdir()
    for output, message in (
        ("missing/part.png", "missing does not exist"),
        ("folder.png", "cannot be written"),
        ("o\udcff.png", "the name is not UTF-8; rename it"),
    ):
        assert run(f"--output={output}") == 1
        assert message in only_line(capsys)
    assert not stand.loaded  # found before the long work


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is full")
@pytest.mark.parametrize("extension", ["png", "npz"])
def test_a_full_disk(stand: Stand, capsys: pytest.CaptureFixture[str], extension: str) -> None:
    Path(f"full.{extension}").symlink_to("/dev/full")
    assert run(f"--output=full.{extension}") == 1
    line = only_line(capsys)
    assert line.startswith(f"full.{extension}: cannot be written (")
    assert line.endswith("; choose another place, or make room if the disk is full")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is full")
@pytest.mark.parametrize("command", [["info"], ["render", "--output=-"]])
def test_a_full_disk_behind_standard_output(command: list[str]) -> None:
    flange = Path(__file__).parents[1] / "cad_models" / "flange.step"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with open("/dev/full", "w") as full:
        result = subprocess.run(
            [sys.executable, "-m", "nofacet", *command, str(flange)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
    assert result.returncode == 1
    assert "standard output: cannot be written (No space left on device); choose" in result.stderr.splitlines()[-1]


@pytest.mark.parametrize("command", [["info"], ["render", "--output=-"], ["bench"]])
def test_standard_output_that_is_closed(
    stand: Stand, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, command: list[str]
) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    assert cli.main([*command, "part.step"]) == 1
    assert capsys.readouterr().err.startswith("nofacet: standard output is closed")
    assert run("--output=part.png") == 0  # which writes nothing there
    monkeypatch.setattr(sys, "stderr", None)
    assert run("--output=-") == 1


def test_names_that_the_terminal_cannot_show(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    stdout = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", stdout)
    stand.model = replace(stand.model, source="tö.step")
    assert cli.main(["info", "tö.step"]) == 0
    assert stdout.buffer.getvalue().startswith(b"t\\xf6.step\n")


def test_input_errors_are_one_line(stand: Stand, capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    def fail(error: BaseException) -> None:
        def load(source: str, **options: Any) -> Model:
            raise error

        monkeypatch.setattr(nofacet, "load", load)

    fail(InputError("part.step: there is no face in it;\n export it again"))
    assert run("--output=part.png") == 1
    assert only_line(capsys) == "part.step: there is no face in it; export it again"
    fail(PermissionError(13, "Permission denied", "part.step"))
    assert run("--output=part.png") == 1
    assert only_line(capsys) == "part.step: Permission denied"
    fail(RuntimeError("oh no"))
    assert run("--output=part.png") == 1
    assert "internal error: RuntimeError: oh no" in only_line(capsys)
    assert run("--output=part.png", "--verbose") == 1
    assert "Traceback" in capsys.readouterr().err
    fail(KeyboardInterrupt())
    assert run("--output=part.png") == 130
    assert capsys.readouterr().err == ""


def test_warnings_fail_only_with_strict(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    stand.model = replace(stand.model, warnings=["face 3: no surface", "face 7: no surface"])
    assert run("--output=part.png") == 0
    expected = ["nofacet: warning: face 3: no surface", "nofacet: warning: face 7: no surface"]
    assert capsys.readouterr().err.splitlines() == expected
    assert run("--output=part.png", "--strict") == 1
    assert Path("part.png").exists()


def test_sections(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    planes = ["--section=0,0,1/0,0,1", "--section=0,-1,0/0,-2,0"]
    assert run("--output=part.png", *planes) == 0
    assert stand.rendered["sections"] == [Section((0, 0, 1), (0, 0, 1)), Section((0, -1, 0), (0, -1, 0))]
    stand.stats["warnings"] = ["face 3: not a closed volume"]
    assert run("--output=part.png", *planes) == 0
    assert "warning: face 3: not a closed volume" in only_line(capsys)
    assert run("--output=part.png", "--strict", *planes) == 1


def test_faces_that_could_not_be_drawn_are_named(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    stand.stats["unresolved_faces"] = [12]
    assert run("--output=part.png") == 0
    assert "warning: face 12 is not drawn completely" in only_line(capsys)
    assert run("--output=part.png", "--strict") == 1


def test_verbose_prints_stage_times(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--output=part.png", "--verbose") == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(":")[1].strip() for line in lines] == ["read", "fit camera", "render", "scan", "pieces", "save"]
    assert "nofacet:   scan: 0.250 s" in lines and "nofacet:   pieces: 17" in lines


def test_progress_is_one_line_on_a_terminal_and_few_elsewhere(
    stand: Stand, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def load(source: str, progress: Callable[[str], None], **options: Any) -> Model:
        for second in range(1, 11):
            progress(f"{source}: {second} s")
        return stand.model

    monkeypatch.setattr(nofacet, "load", load)
    assert run("--output=part.png") == 0
    assert capsys.readouterr().err.splitlines() == [f"nofacet: part.step: {second} s" for second in (1, 2, 4, 8)]
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert run("--output=part.png") == 0
    text = capsys.readouterr().err
    assert "\n" not in text and text.endswith("\r\x1b[K")


def test_info(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    stand.model = replace(
        stand.model,
        conversion_error=np.array([2e-15]),
        edge_use_face=np.zeros(3, np.int32),
        edge_use_deviation=np.array([1e-9, np.nan, 0.02]),
        edge_use_tolerance=np.array([1e-7, 1e-7, 1e-2]),
        tree=[Node("assembly", -1, np.empty(0, np.int32)), Node("ball", 0, np.array([0], np.int32))],
        warnings=["face 0: too round"],
    )
    assert cli.main(["info", "part.step", "--faces"]) == 0
    assert stand.loaded["measure"] is True
    text, warning = capsys.readouterr()
    assert warning == "nofacet: warning: face 0: too round\n"
    for part in (
        "1 drawn, 1 distinct",
        "8 rational Bezier patches",
        "size       2 x 2 x 2 mm",
        "2.0e-15 mm",
        "    ball  (1 face",
        "2 edge uses measured, at most 2.0e-02 mm from the curves that trim (face 0); 1 exceeds its recorded tolerance",
    ):
        assert part in text
    assert "     0  sphere             8     0  2.0e-15 mm" in text
    assert "2.0e-02 mm                   1\n" in text


def test_info_without_edges_to_measure(stand: Stand, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["info", "part.step", "--faces"]) == 0
    text = capsys.readouterr().out
    assert "no edge uses measured" in text and text.splitlines()[-1].split()[-3:] == ["not", "measured", "0"]


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--help"], ["render", "--help"], ["--version"]):
        with pytest.raises(SystemExit) as ended:
            cli.main(arguments)
        assert ended.value.code == 0
    text = capsys.readouterr().out
    assert "render" in text and "--camera-zoom-factor" in text


def test_a_reader_that_goes_away_is_no_error(stand: Stand) -> None:
    """As in `nofacet info part.step | head -1`: no message, no traceback."""
    program = (
        "import os, sys, nofacet; from nofacet import cli\n"
        "reader, writer = os.pipe(); os.close(reader); os.dup2(writer, 1)\n"
        "cli._load = lambda options, path, measure: None; cli.summary = lambda model, faces: 'x' * 100_000\n"
        "sys.exit(cli.main(['info', 'part.step']))"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (141, "")
