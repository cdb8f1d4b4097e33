"""What the documents say can be done: commands are understood, Python compiles, pictures and linked files are there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from nofacet import cli
from nofacet_viewer.state import View

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")] + sorted(ROOT.glob("docs/*.md"))
COMMANDS = [
    (document.name, line)
    for document in DOCUMENTS
    for line in re.findall(r"^    (nofacet .*)$", document.read_text(encoding="utf-8"), re.MULTILINE)
]


@pytest.mark.parametrize(("document", "line"), COMMANDS)
def test_commands_are_understood(document: str, line: str) -> None:
    options = cli._parse(shlex.split(line, comments=True)[1:])
    assert getattr(options, "view", View.EXACT.value) in [view.value for view in View]


def test_there_are_commands() -> None:
    assert {"README.md", "viewer.md", "sections.md"} <= {document for document, _ in COMMANDS}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_linked_files_are_there(document: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", document.read_text(encoding="utf-8"))
    assert not [link for link in links if "://" not in link and not (document.parent / link).exists()]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_python_compiles(document: Path) -> None:
    for block in re.findall(r"^```python\n(.*?)^```", document.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        compile(block, str(document), "exec")


def test_every_picture_is_shown_somewhere() -> None:
    text = "".join(document.read_text(encoding="utf-8") for document in [*DOCUMENTS, *ROOT.glob("*/README.md")])
    assert not [path.name for path in (ROOT / "docs" / "images").iterdir() if path.name not in text]


@pytest.mark.parametrize("document", ["README.md", "docs/accuracy.md"])
def test_what_tables_name_is_in_the_files_they_name(document: str) -> None:
    sources = [path for path in (ROOT / "src").rglob("*") if path.suffix in (".h", ".cpp", ".py")]
    checked = 0
    for row in re.findall(r"^\|.*\|$", (ROOT / document).read_text(encoding="utf-8"), re.MULTILINE):
        files = [name for name in re.findall(r"`([^`]+)`", row.split("|")[-2]) if name.endswith((".h", ".cpp", ".py"))]
        found = [path for path in sources if any(str(path).endswith(f"/{name}") for name in files)]
        assert len(found) >= len(files), row
        text = "".join(path.read_text(encoding="utf-8") for path in found)
        for name in re.findall(r"`(?:\w+::)?(k[A-Z]\w+|[a-z]\w*_\w+)`", row) if files else []:
            assert name in text, f"{name}: not in {files}"
            checked += 1
    assert checked >= 5
