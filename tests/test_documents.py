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
