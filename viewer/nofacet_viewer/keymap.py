"""Which key does what: the defaults, and the file in which the user says otherwise.

The file is JSON, an object from actions to a key or a list of keys ([] for none); what it does not name stays as it is:

    {"front": "F", "fit": ["Enter", "Ctrl+0"], "blink": []}
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

MODIFIERS = ("Ctrl", "Shift", "Alt")  # in the order in which a chord names them
KEYS = (
    *"ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789",
    *(f"F{number}" for number in range(1, 13)),
    *("Enter", "Space", "Tab", "Escape", "Backspace", "Delete", "Insert", "Home", "End", "PageUp", "PageDown"),
    *("Left", "Right", "Up", "Down"),
    *("-", "=", ",", ".", "/", ";", "'", "[", "]", "\\", "`"),
)


@dataclass(frozen=True)
class Action:
    """Something a key can do: its name in the file, its keys unless the file has others, what the help says of it."""

    name: str
    keys: tuple[str, ...]
    text: str


ACTIONS = (
    Action("front", ("1",), "view from the front"),
    Action("right", ("3",), "view from the right"),
    Action("top", ("7",), "view from the top"),
    Action("iso", ("9",), "isometric view"),
    Action("projection", ("5",), "orthographic or perspective"),
    Action("fit", ("Enter",), "see the whole model"),
    Action("exact", ("E",), "exact picture alone"),
    Action("tessellated", ("T",), "OpenCascade's triangles alone"),
    Action("side-by-side", ("S",), "exact and tessellated side by side"),
    Action("wipe", ("W",), "exact and tessellated with a divider"),
    Action("blink", ("B",), "exact and tessellated in turn"),
    Action("difference", ("D",), "difference of the outlines"),
    Action("mesh-edges", ("G",), "edges of the triangles"),
    Action("edges", ("L",), "edges of the model"),
    Action("patch-borders", ("P",), "borders of the Bezier patches"),
    Action("control-nets", ("C",), "control nets of the Bezier patches"),
    Action("conversion-error", ("X",), "faces coloured by conversion error"),
    Action("zebra", ("Z",), "zebra stripes"),
    Action("curvature", ("K",), "curvature"),
    Action("measure", ("M",), "measure: from the point of one click to that of the next"),
    Action("isolate", ("I",), "show what is selected alone"),
    Action("show-all", ("A",), "show every face again"),
    Action("section", ("N",), "cut along the face under the cursor"),
    Action("deselect", ("Escape",), "select nothing, measure no more"),
    Action("next-file", ("Right",), "next file"),
    Action("previous-file", ("Left",), "previous file"),
    Action("reload", ("R",), "read the file again"),
    Action("panels", ("Tab",), "show or hide the panels"),
    Action("screenshot", ("F12",), "picture of the window"),
    Action("exact-picture", ("Ctrl+F12",), "clean exact picture with transparent background"),
    Action("help", ("H",), "this list"),
    Action("quit", ("Ctrl+Q",), "quit"),
)
# Not configurable, so that every hint about the mouse is true: what the help says beside the keys.
MOUSE = (
    ("Left click", "select the face under the cursor"),
    ("Double click, Shift+left click", "select its part"),
    ("Ctrl+left click", "select it, too, or no longer"),
    ("Left drag", "orbit; the divider of a wipe: move it"),
    ("Middle drag, Shift+left drag", "pan"),
    ("Wheel, right drag", "zoom"),
    ("Ctrl+wheel", "zoom to the cursor"),
    ("Middle click", "centre on the point under the cursor"),
    ("Drop a file", "open it"),
)


class KeymapError(ValueError):
    """The keymap cannot be used. The message is one line."""


class Keymap:
    """What each chord, such as "Ctrl+F12", does."""

    def __init__(self, keys: Mapping[str, tuple[str, ...]] | None = None) -> None:
        """keys: action name -> chords, in place of the default ones. Raises KeymapError that names what is wrong."""
        keys = keys or {}
        unknown = [name for name in keys if name not in {action.name for action in ACTIONS}]
        if unknown:
            raise KeymapError(f"there is no action {unknown[0]!r}{_meant(unknown[0], [a.name for a in ACTIONS])}")
        self.chords: dict[str, tuple[str, ...]] = {
            action.name: tuple(normalized(chord) for chord in keys.get(action.name, action.keys)) for action in ACTIONS
        }
        self._action: dict[str, str] = {}
        for name, chords in self.chords.items():
            for chord in chords:
                other = self._action.setdefault(chord, name)
                if other != name:
                    raise KeymapError(f"{chord} is to do both {other} and {name}; give one of them another key")

    def action(self, key: str, modifiers: frozenset[str] = frozenset()) -> str | None:
        """What a key pressed with these modifiers does; None: nothing."""
        return self._action.get("+".join([*(name for name in MODIFIERS if name in modifiers), key]))

    def help(self) -> list[tuple[str, str]]:
        """Keys and what they do, the mouse included, in the order of the table."""
        return [(" or ".join(self.chords[action.name]) or "-", action.text) for action in ACTIONS] + list(MOUSE)

    @classmethod
    def load(cls, path: Path | None = None) -> Keymap:
        """The keymap of the user's file, the default one where there is no file.

        Raises KeymapError, one line that begins with the path, for a file that cannot be used.
        """
        path = path or default_path()
        try:
            return cls(_chords(json.loads(path.read_text(encoding="utf-8"))))
        except FileNotFoundError:
            return cls()
        except OSError as error:
            raise KeymapError(f"{path}: {error.strerror}") from None
        except UnicodeDecodeError:
            raise KeymapError(f"{path}: this is not a text file in UTF-8") from None
        except json.JSONDecodeError as error:
            raise KeymapError(f"{path}: this is not JSON ({error.msg} in line {error.lineno})") from None
        except KeymapError as error:
            raise KeymapError(f"{path}: {error}") from None


def default_path() -> Path:
    """The user's keymap: nofacet/keymap.json in %APPDATA% on Windows, else in $XDG_CONFIG_HOME or ~/.config."""
    base = os.environ.get("APPDATA" if os.name == "nt" else "XDG_CONFIG_HOME", "")
    return (Path(base) if base else Path.home() / ".config") / "nofacet" / "keymap.json"


def normalized(chord: str) -> str:
    """A chord as Keymap compares it: "ctrl+f12" is "Ctrl+F12". Raises KeymapError for keys that do not exist."""
    *modifiers, key = chord.split("+")
    names = {name.lower(): name for name in (*MODIFIERS, *KEYS)}
    known = [names.get(part.strip().lower()) for part in (*modifiers, key)]
    if None in known:
        part = (*modifiers, key)[known.index(None)]
        raise KeymapError(f"there is no key {part!r}{_meant(part, list(names.values()))}")
    if known[-1] in MODIFIERS or not set(known[:-1]) <= set(MODIFIERS):
        raise KeymapError(f"{chord!r} is not a key with modifiers before it; write for example Ctrl+F12")
    return "+".join([*(name for name in MODIFIERS if name in known[:-1]), str(known[-1])])


def _chords(content: Any) -> dict[str, tuple[str, ...]]:
    """The file's object with every value as a tuple."""
    if not isinstance(content, dict):
        raise KeymapError('this is not a JSON object; write {"front": "1", ...}')
    result = {}
    for name, value in content.items():
        chords = [value] if isinstance(value, str) else value
        if not isinstance(chords, list) or not all(isinstance(chord, str) for chord in chords):
            raise KeymapError(f"{name} is {value!r}; give a key, or a list of keys")
        result[name] = tuple(chords)
    return result


def _meant(word: str, known: list[str]) -> str:
    close = get_close_matches(word, known, n=1, cutoff=0.5)
    return f"; did you mean {close[0]}?" if close else ""
