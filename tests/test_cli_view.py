"""`nofacet view --output`: its messages, its exit status, and the picture it writes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import nofacet
from egl import offscreen_context
from nofacet import cli, cli_options

pytest.importorskip("moderngl")
from nofacet_viewer.offscreen import side_resolution
from nofacet_viewer.state import View

FLANGE = str(Path(__file__).resolve().parents[1] / "cad_models" / "flange.step")
SMALL = "--resolution=240,150"


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def error_line(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line beside those that tell how reading goes."""
    lines = [line for line in capsys.readouterr().err.splitlines() if not line.endswith(" s")]
    assert len(lines) == 1 and lines[0].startswith("nofacet: ")
    return lines[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--output=a.png"], "give one MODEL"),
        ([FLANGE, FLANGE, "--output=a.png"], "give one MODEL"),
        ([FLANGE, "--output=a.png", "--watch"], "leave out --watch"),
        ([FLANGE, "--output=a.png", "--view=wip"], "unknown view 'wip'; did you mean wipe?"),
        ([FLANGE, "--output=a.jpg"], "a.jpg: pictures of views are written as .png"),
        ([FLANGE, "--output=-"], "are written as .png"),
        ([FLANGE, "--output="], "are written as .png"),
        ([FLANGE, "--output=a.png", "--resolution=10,10"], "10 x 10: too small for a view and its figures"),
        ([FLANGE, "--output=a.png", "--camera=missing.png"], "missing.png: No such file"),
        ([FLANGE, "--output=a.png", "--camera-direction=0,0,0"], "direction is zero"),
        ([FLANGE, "--output=a.png", "--camera-direction=fromt"], "did you mean front?"),
        ([FLANGE, "--section=0,0,0/0,0,1"], "unknown option --section"),
    ],
)
def test_wrong_usage(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert cli.main(["view", *arguments]) == 2
    assert message in error_line(capsys)


@pytest.mark.parametrize(
    ("model", "output", "message"),
    [
        ("missing.step", "a.png", "missing.step: no such file"),
        (".", "a.png", "is a directory"),
        ("empty.step", "a.png", "empty.step: is empty"),
        (FLANGE, "nowhere/a.png", "the folder nowhere does not exist"),
        (FLANGE, "folder.png", "folder.png: cannot be written"),
    ],
)
def test_what_cannot_be_shown(capsys: pytest.CaptureFixture[str], model: str, output: str, message: str) -> None:
    Path("empty.step").touch()
    Path("folder.png").mkdir()
    assert cli.main(["view", model, f"--output={output}", SMALL]) == 1
    assert message in error_line(capsys)


def test_a_picture_too_large_for_opengl(capsys: pytest.CaptureFixture[str]) -> None:
    context = offscreen_context()
    most = context.info["GL_MAX_TEXTURE_SIZE"]
    context.release()
    if most >= cli_options.MAX_SIDE:
        pytest.skip("OpenGL draws all that the command line takes")
    assert cli.main(["view", FLANGE, "--output=a.png", f"--resolution={most + 1},100"]) == 1
    assert "pixels a side here" in error_line(capsys)


@pytest.mark.parametrize("module", ["moderngl", "nofacet_viewer"])
def test_without_the_extra_it_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, module: str
) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "nofacet_viewer"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, module, None)
    assert cli.main(["view", FLANGE, "--output=a.png"]) == 1
    assert f"the viewer needs the module {module}: pip install 'nofacet[viewer]'" in error_line(capsys)


def test_the_camera_goes_from_picture_to_picture() -> None:
    offscreen_context().release()
    assert cli.main(["view", FLANGE, "--output=a.png", SMALL, "--camera-direction=top", "--view=wipe"]) == 0
    camera = nofacet.Camera.load("a.png")
    assert camera == nofacet.Camera.fit(
        nofacet.load(FLANGE), (0, 0, -1), view_up=(0, 1, 0), resolution=side_resolution("wipe", (240, 150))
    )
    assert cli.main(["view", FLANGE, "--output=b.png", SMALL, "--camera=a.png", "--view=exact"]) == 0
    assert cli.main(["render", FLANGE, "--output=c.png", SMALL, "--camera=b.png"]) == 0
    assert nofacet.Camera.load("c.png") == camera


def test_help_names_every_view(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(["view", "--help"])
    text = capsys.readouterr().out
    assert text.count("Show STEP or BREP files") == 1
    assert not [view for view in View if view.value not in text.replace(",", "").split()]
