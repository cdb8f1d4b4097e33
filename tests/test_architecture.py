"""The walls of the house: who may import what."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "nofacet"
WINDOW_MODULES = {"moderngl", "glfw", "imgui_bundle"}


def imported_modules(path: Path) -> set[str]:
    """Top-level names of everything a Python file imports, wherever in the file it does."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module.split(".")[0])
    return names


def test_only_cad_imports_opencascade() -> None:
    guilty = [
        path.relative_to(ROOT)
        for path in PACKAGE.rglob("*.py")
        if PACKAGE / "cad" not in path.parents and imported_modules(path) & {"OCP", "cadquery", "build123d"}
    ]
    assert not guilty


def test_only_the_viewer_opens_windows() -> None:
    guilty = [path.relative_to(ROOT) for path in PACKAGE.rglob("*.py") if imported_modules(path) & WINDOW_MODULES]
    assert guilty == [Path("src/nofacet/bench/gl.py")]  # draws off screen


def test_the_viewer_uses_the_public_api_only() -> None:
    private = re.compile(r"(from nofacet(\.\w+)* import .*\b_|nofacet\._|from nofacet\.(cad|bench)\b|nofacet\.cad\.)")
    sources = list((ROOT / "viewer").rglob("*.py"))
    assert sources
    assert not [path.relative_to(ROOT) for path in sources if private.search(path.read_text(encoding="utf-8"))]
    assert not [path for path in sources if imported_modules(path) & {"OCP", "cadquery", "build123d"}]


def test_only_bindings_include_nanobind() -> None:
    native = ROOT / "src" / "native"
    sources = [path for path in native.rglob("*") if path.suffix in (".h", ".cpp")]
    guilty = [path.relative_to(ROOT) for path in sources if re.search(r"#\s*include\s*[<\"]nanobind", path.read_text())]
    assert guilty == [Path("src/native/bindings.cpp")]


def test_no_two_native_types_of_a_namespace_share_a_name() -> None:
    # Two types of one name share the functions that the compiler makes for both, such as those of their vectors, and
    # the linker keeps the ones of either. With link-time optimisation that crashed.
    homes: dict[tuple[bool, str], set[str]] = {}  # by whether made for each instruction set
    for path in (ROOT / "src" / "native").rglob("*"):
        if path.suffix not in (".h", ".cpp"):
            continue
        unnamed = lanes = False
        for line in path.read_text(encoding="utf-8").splitlines():
            if line in ("namespace {", "}  // namespace"):
                unnamed = line == "namespace {"
            if line in ("namespace HWY_NAMESPACE {", "}  // namespace HWY_NAMESPACE"):
                lanes = line == "namespace HWY_NAMESPACE {"
            match = re.match(r"(?:struct|class|union|enum(?: class)?) (\w+)(?!\w|::|;)", line)
            if match and not unnamed:
                homes.setdefault((lanes, match[1]), set()).add(str(path.relative_to(ROOT)))
    assert len(homes) > 100
    assert not {kind[1]: files for kind, files in homes.items() if len(files) > 1}


@pytest.mark.parametrize("module", ["nofacet", "nofacet.cli"])
def test_import_does_not_load_opencascade(module: str) -> None:
    program = f"import sys, {module}; print(*{{'OCP', 'cadquery', 'build123d'}} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == ""
