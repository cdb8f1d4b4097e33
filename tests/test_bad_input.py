"""Inputs that cannot be shown: one clear line each, no crash, no hang, nothing from OpenCascade on the terminal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from conftest import SHARED_MODELS
from nofacet.cad import worker
from nofacet.cad.formats import file_format, scan_step_text
from nofacet.cad.load import load
from nofacet.errors import InputError

BAD = SHARED_MODELS / "bad"
needs_bad_models = pytest.mark.skipif(not BAD.is_dir(), reason="the shared test models are not beside the repository")

# What the line must say about each file, besides its name.
REASONS = {
    "Ball.badversion.brep": "cannot read this BREP file",
    "Ball.truncated50.brep": "cannot read this BREP file",
    "ap203_malformed_representation.stp": "has no faces, so there is nothing to draw; export solids or surfaces",
    "ap203_periodic_pole_solid.stp": "declares 30 faces, OpenCascade delivered none",
    "ap242_pmi.stp": "has no faces",
    "as1-oc-214.truncated60.stp": "is cut short",
    "cheese.lfs_pointer.stp": "run git lfs pull",
    "empty.stp": "is empty; export or copy the model again",
    "random.brep": "is neither a STEP nor a BREP file",
    "screw.bitflip40.step": "declares 10 faces, OpenCascade delivered none",
}


def refusal(path: Path | str, timeout: float = 60.0) -> str:
    with pytest.raises(InputError) as caught:
        load(path, timeout=timeout)
    line = str(caught.value)
    assert str(path) in line
    assert "\n" not in line
    assert ";" in line.removeprefix(str(path))  # what is wrong; what to do
    return line


@needs_bad_models
@pytest.mark.parametrize("name", REASONS)
def test_bad_file_is_refused_in_one_line(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert REASONS[name] in refusal(BAD / name)
    assert capfd.readouterr() == ("", "")


@needs_bad_models
def test_every_bad_file_is_tested() -> None:
    assert {path.name for path in BAD.iterdir()} == {*REASONS, "M6.nan_points.step", "screw.dangling_ref.step"}


@needs_bad_models
def test_what_is_left_is_drawn_and_what_is_lost_is_named() -> None:
    model = load(BAD / "screw.dangling_ref.step")
    assert model.face_count == 9
    assert model.warnings[:2] == [
        "screw.dangling_ref.step: the file declares 10 faces, OpenCascade delivered 9; 1 is missing from what is drawn",
        "screw.dangling_ref.step: the file has 5 errors in its text (the first: Unresolved Reference, Ent.Id.#1017 "
        "Param.n0 2 (Id.#1018)); what depends on that is missing or wrong",
    ]


@needs_bad_models
def test_a_file_that_hangs_opencascade_is_stopped() -> None:
    started = time.monotonic()
    line = refusal(BAD / "M6.nan_points.step", timeout=12.0)
    assert "stopped after 12 s while transferring the shapes of a file with 3 errors in its text" in line
    assert time.monotonic() - started < 18


@needs_bad_models
@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs POSIX signals")
def test_ctrl_c_stops_a_hanging_file_at_once() -> None:
    # A shell that runs tests in the background has them ignore Ctrl-C, and what they start, too.
    program = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from nofacet.cad.load import load; load(sys.argv[1], progress=True)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(BAD / "M6.nan_points.step")],
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        start_new_session=True,
    )
    assert process.stderr is not None
    for line in process.stderr:  # progress, once a second
        if "transferring" in line:
            break
    started = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)  # as the terminal does: to the whole group
    process.wait(timeout=10)
    assert time.monotonic() - started < 5
    with pytest.raises(ProcessLookupError):  # no reading process is left behind
        os.killpg(process.pid, 0)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b" \n\n", "is empty"),
        (b"just some text\n", "is neither a STEP nor a BREP file"),
        (b"\x89PNG\r\n\x1a\n", "is neither a STEP nor a BREP file"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n", "is a Git LFS pointer"),
    ],
)
@pytest.mark.parametrize("extension", [".step", ".brep", ".txt"])
def test_other_files_are_refused_by_content(tmp_path: Path, content: bytes, reason: str, extension: str) -> None:
    path = tmp_path / f"part{extension}"
    path.write_bytes(content)
    assert reason in refusal(path)


def test_directory(tmp_path: Path) -> None:
    assert "is a directory" in refusal(tmp_path)


def test_missing_file(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "absent.step")


@pytest.mark.skipif(not os.path.exists(os.devnull), reason="no null device")
def test_device() -> None:
    assert "is not a regular file" in refusal(os.devnull)


@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may read everything")
def test_unreadable_file(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;")
    path.chmod(0)
    assert "no permission" in refusal(path)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse the name themselves")
@pytest.mark.parametrize("content", ["ISO-10303-21;", "DBRep_DrawableShape"])
def test_name_that_is_not_utf8(tmp_path: Path, content: str) -> None:
    path = tmp_path / "b\udcff.step"
    path.write_text(content)
    assert "the name is not UTF-8; rename it" in refusal(path)


def test_timeout_that_is_no_number(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="timeout is nan; give seconds"):
        load(tmp_path / "part.step", timeout=float("nan"))


def test_header_without_shapes(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")
    assert str(path) in refusal(path)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"ISO-10303-21;\nHEADER;", "step"),
        (b"/* written by hand */\nISO-10303-21;", "step"),
        (b"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision", "brep"),
        (b"\nCASCADE Topology V3, (c) Open Cascade", "brep"),
        (b"\nOpen CASCADE Topology V4, (c) Open Cascade\n", "binary brep"),
    ],
)
def test_formats_are_told_by_content(tmp_path: Path, content: bytes, expected: str) -> None:
    path = tmp_path / "part.dat"
    path.write_bytes(content)
    assert file_format(str(path)) == expected


def test_step_text_counts_faces_but_not_twice() -> None:
    exact = b"#1=ADVANCED_FACE('',(#2),#3,.T.);\n#4 = FACE_SURFACE ( 'lid', (#2), #3, .T.);\n"
    triangles = b"#5=COMPLEX_TRIANGULATED_FACE('',#6,4,(),$,(),(),());\n"
    assert scan_step_text(exact + triangles).declared_faces == 2
    assert scan_step_text(triangles).declared_faces == 1
    assert scan_step_text(exact).names_parts_of_shapes
    assert not scan_step_text(exact.replace(b"lid", b"NONE")).names_parts_of_shapes
    assert not scan_step_text(b"#1=PRODUCT('ADVANCED_FACE(','',$,());\xe9").utf8


def child_that(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, code: str) -> Path:
    """Let the reading process run `code` instead; returns a file to load."""
    monkeypatch.setattr(worker, "_CHILD_CODE", code)
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;")
    return path


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_crash_of_the_reading_process_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = child_that(monkeypatch, tmp_path, "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert "OpenCascade crashed while starting (Segmentation fault)" in refusal(path)


def test_a_reading_process_that_cannot_start_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = child_that(monkeypatch, tmp_path, "import a_module_that_is_not_there")
    assert "No module named 'a_module_that_is_not_there'" in refusal(path)


def test_time_limit_and_progress(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    note = "print('stage 0.0 transferring the shapes', file=sys.stderr, flush=True)"
    path = child_that(monkeypatch, tmp_path, f"import sys, time; {note}; time.sleep(60)")
    lines: list[str] = []
    with pytest.raises(InputError, match="stopped after 2.5 s while transferring the shapes"):
        load(path, timeout=2.5, progress=lines.append)
    assert lines == ["part.step: transferring the shapes, 1 s", "part.step: transferring the shapes, 2 s"]


def test_objects_that_are_no_cad_objects() -> None:
    with pytest.raises(InputError, match="cannot draw an object of type int"):
        load(3)
