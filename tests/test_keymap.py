"""The viewer's keys: defaults, the user's file, and what is said of a bad one."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

pytest.importorskip("nofacet_viewer")
from nofacet_viewer.keymap import ACTIONS, MOUSE, Keymap, KeymapError, default_path, normalized

DOCUMENT = Path(__file__).resolve().parents[1] / "docs" / "viewer.md"


def written(folder: Path, content: object) -> Path:
    path = folder / "keymap.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("key", "modifiers", "action"),
    [
        ("1", (), "front"),
        ("3", (), "right"),
        ("7", (), "top"),
        ("9", (), "iso"),
        ("5", (), "projection"),
        ("Enter", (), "fit"),
        ("H", (), "help"),
        ("F12", (), "screenshot"),
        ("F12", ("Ctrl",), "exact-picture"),
        ("Right", (), "next-file"),
        ("1", ("Ctrl",), None),
    ],
)
def test_default_keys(key: str, modifiers: tuple[str, ...], action: str | None) -> None:
    assert Keymap().action(key, frozenset(modifiers)) == action


def test_without_a_file_the_defaults_hold(tmp_path: Path) -> None:
    assert Keymap.load(tmp_path / "missing.json").chords == Keymap().chords


def test_the_file_replaces_what_it_names(tmp_path: Path) -> None:
    keymap = Keymap.load(written(tmp_path, {"front": "ctrl+shift+f", "fit": ["Enter", "0"], "blink": []}))
    assert keymap.action("F", frozenset({"Shift", "Ctrl"})) == "front"
    assert keymap.action("1") is None
    assert keymap.action("0") == keymap.action("Enter") == "fit"
    assert keymap.action("B") is None
    assert keymap.action("3") == "right"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "this is not JSON (Expecting property name enclosed in double quotes in line 1)"),
        ("[1]", 'this is not a JSON object; write {"front": "1", ...}'),
        ({"frnt": "1"}, "there is no action 'frnt'; did you mean front?"),
        ({"front": "Entr"}, "there is no key 'Entr'; did you mean Enter?"),
        ({"front": "Ctrl"}, "'Ctrl' is not a key with modifiers before it; write for example Ctrl+F12"),
        ({"front": 1}, "front is 1; give a key, or a list of keys"),
        ({"front": "3"}, "3 is to do both front and right; give one of them another key"),
    ],
)
def test_a_bad_file_gets_one_line(tmp_path: Path, content: object, message: str) -> None:
    path = written(tmp_path, content)
    with pytest.raises(KeymapError) as caught:
        Keymap.load(path)
    assert str(caught.value) == f"{path}: {message}"


def test_help_names_every_key_and_the_mouse() -> None:
    lines = Keymap({"fit": ("Enter", "0"), "blink": ()}).help()
    assert ("Enter or 0", "see the whole model") in lines
    assert ("-", "exact and tessellated in turn") in lines
    assert any("drag" in keys for keys, _ in lines)
    assert len(lines) > len(ACTIONS)


def test_chords_are_normalized() -> None:
    assert normalized("shift+CTRL+f12") == "Ctrl+Shift+F12"


def test_the_file_is_in_the_configuration_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("APPDATA", str(tmp_path))
    assert default_path() == tmp_path / "nofacet" / "keymap.json"


def test_the_documented_keys_are_the_keys() -> None:
    rows = [f"| {' or '.join(action.keys)} | {action.text} | `{action.name}` |" for action in ACTIONS]
    rows += [f"| {mouse} | {text} | |" for mouse, text in MOUSE]
    table = "\n".join(["| key or mouse | what it does | name |", "| --- | --- | --- |", *rows, ""])
    assert table in DOCUMENT.read_text(encoding="utf-8"), f"docs/viewer.md should have\n{table}"


def test_the_documented_keymap_file_can_be_read(tmp_path: Path) -> None:
    example = re.search(r'^    (\{"front".*\})$', DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE)
    assert example
    chords = Keymap.load(written(tmp_path, example[1])).chords
    assert (chords["front"], chords["fit"], chords["blink"]) == (("F",), ("Enter", "Ctrl+0"), ())
