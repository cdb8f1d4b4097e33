"""The cache of converted models: nothing lost, nothing out of date, no harm from what lies in its folder."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import nofacet
from conftest import model_of, sphere_group
from nofacet import cache, model_file
from nofacet.cad import load
from nofacet.model import Model, Node, PatchGroup

ROOT = Path(__file__).resolve().parents[1]


def full_model() -> Model:
    """A model with something in every field."""
    window = np.array([[0.5, 0.2], [1.0, 0.2], [1.0, 0.6], [0.5, 0.6]])
    return replace(
        model_of([sphere_group(2.0), sphere_group(1.0, (5, 0, 0))], {0: [window]}),
        source="somewhere/part.step",
        face_name=["Gehäuse «A»"],
        face_color=np.array([[0.25, 0.5, 0.125, 0.75]], np.float32),
        conversion_error=np.array([np.nan]),
        edge_use_face=np.array([0, 0], np.int32),
        edge_use_deviation=np.array([1e-9, np.nan]),
        edge_use_tolerance=np.array([1e-7, 1e-7]),
        tree=[Node("assembly", -1, np.empty(0, np.int32)), Node("", 0, np.array([0], np.int32))],
        warnings=["part.step: 1 face is missing — a «warning»"],
    )


def assert_same(one: Model, other: Model) -> None:
    for field in fields(Model):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            assert a.dtype == b.dtype
            np.testing.assert_array_equal(a, b)
        elif field.name == "groups":
            assert len(a) == len(b)
            for p, q in zip(a, b, strict=True):
                for column in fields(PatchGroup):
                    np.testing.assert_array_equal(getattr(p, column.name), getattr(q, column.name))
        elif field.name == "tree":
            assert [(node.name, node.parent, node.faces.tolist()) for node in a] == [
                (node.name, node.parent, node.faces.tolist()) for node in b
            ]
        else:
            assert a == b, field.name


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache."""
    result = tmp_path / "cache"
    monkeypatch.setenv(cache.SETTING, str(result))
    return result


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A file that passes for STEP."""
    path = tmp_path / "part.step"
    path.write_bytes(b"ISO-10303-21;\nEND-ISO-10303-21;\n")
    return path


class Reader:
    """Stands in for the reading process, and counts."""

    def __init__(self, meanwhile: Callable[[], object] = lambda: None) -> None:
        self.calls = 0
        self.meanwhile = meanwhile

    def __call__(self, path: str, timeout: float, progress: object, measure: bool, cancel: object) -> Model:
        self.calls += 1
        self.meanwhile()
        return replace(full_model(), source=path)


@pytest.fixture
def reader(monkeypatch: pytest.MonkeyPatch) -> Reader:
    result = Reader()
    monkeypatch.setattr(load, "read_in_worker", result)
    return result


def test_a_model_survives_its_file(tmp_path: Path) -> None:
    model = full_model()
    with (tmp_path / "m.model").open("wb") as file:
        model_file.write(model, file)
    again = model_file.read(tmp_path / "m.model")
    assert_same(model, again)
    again.face_color[0] = 1  # the arrays are the caller's own
    assert nofacet.render(again, nofacet.Camera.fit(again), (32, 24)).coverage.any()


def test_a_file_is_read_once(place: Path, part: Path, reader: Reader) -> None:
    first = nofacet.load(part)
    second = nofacet.load(part)
    assert reader.calls == 1
    assert_same(first, second)
    assert (place.stat().st_mode & 0o777) == 0o700
    assert [path.suffix for path in place.iterdir()] == [".model"]


def test_the_same_file_elsewhere_is_the_same_entry_but_keeps_its_own_path(
    place: Path, part: Path, reader: Reader, tmp_path: Path
) -> None:
    nofacet.load(part)
    (tmp_path / "copy").mkdir()
    copy = tmp_path / "copy" / part.name
    copy.write_bytes(part.read_bytes())
    assert nofacet.load(copy).source == str(copy)
    assert reader.calls == 1


def test_what_a_model_depends_on_is_in_the_name(
    place: Path, part: Path, reader: Reader, monkeypatch: pytest.MonkeyPatch
) -> None:
    nofacet.load(part)
    nofacet.load(part, measure=True)
    assert reader.calls == 2
    times = part.stat()
    part.write_bytes(part.read_bytes().replace(b";\nEND", b" \nEND"))  # as long, and with the old times
    os.utime(part, ns=(times.st_atime_ns, times.st_mtime_ns))
    nofacet.load(part)
    assert reader.calls == 3
    renamed = part.rename(part.with_name("other.step"))  # warnings name the file
    nofacet.load(renamed)
    assert reader.calls == 4
    monkeypatch.setattr(cache, "_code", lambda: iter([("convert.py", 1, 2)]))
    nofacet.load(renamed)
    assert reader.calls == 5


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:40],
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda data: data[:-100] + bytes([data[-100] ^ 1]) + data[-99:],
        lambda data: b"nofacet model 0\n" + data[16:],
        lambda data: pickle.dumps(["not", "ours"]),
        lambda data: bytes(1000),
    ],
)
def test_damaged_entries_count_as_missing(
    place: Path, part: Path, reader: Reader, damage: Callable[[bytes], bytes]
) -> None:
    nofacet.load(part)
    (entry,) = place.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(damage(whole))
    assert_same(nofacet.load(part), replace(full_model(), source=str(part)))
    assert reader.calls == 2
    assert entry.read_bytes() == whole  # mended


def test_a_file_that_changes_while_it_is_read_is_not_kept(
    place: Path, part: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(load, "read_in_worker", Reader(lambda: part.write_bytes(part.read_bytes() + b"\n")))
    nofacet.load(part)
    assert not place.exists()


def test_a_file_that_may_refer_to_others_is_not_kept(place: Path, part: Path, reader: Reader) -> None:
    part.write_bytes(part.read_bytes() + b"#1=DOCUMENT_FILE('wheel.stp','','',#2,'',$);")
    nofacet.load(part)
    nofacet.load(part)
    assert reader.calls == 2 and not place.exists()


def test_off_means_off(part: Path, reader: Reader, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.setenv(cache.SETTING, "off")
    nofacet.load(part)
    assert not (tmp_path / "xdg").exists()
    monkeypatch.delenv(cache.SETTING)
    nofacet.load(part)
    nofacet.load(part)
    assert reader.calls == 2
    assert len(list((tmp_path / "xdg" / "nofacet").iterdir())) == 1


@pytest.mark.parametrize("setting", ["", "on"])
def test_on_is_the_usual_folder(setting: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(cache.SETTING, setting)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "nofacet"


@pytest.mark.parametrize("folder", ["file", "file/cache"])
def test_a_folder_that_cannot_be_used_does_no_harm(
    part: Path, reader: Reader, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, folder: str
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv(cache.SETTING, str(tmp_path / folder))
    for _ in range(2):
        assert nofacet.load(part).face_count == 1
    assert reader.calls == 2


def test_entries_used_longest_ago_make_room(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = full_model()
    cache.keep("0", model)
    size = (place / "0.model").stat().st_size
    monkeypatch.setattr(cache, "LIMIT", 3 * size)
    for k, name in enumerate("12"):
        cache.keep(name, model)
        os.utime(place / f"{name}.model", (1000 + k, 1000 + k))
    os.utime(place / "0.model", (10, 10))
    assert cache.find("0") is not None  # now used last
    abandoned, unfinished = place / "x.part", place / "y.part"
    for path in (abandoned, unfinished):
        path.touch()
    os.utime(abandoned, (10, 10))
    cache.keep("3", model)
    assert sorted(path.name for path in place.iterdir()) == ["0.model", "2.model", "3.model", "y.part"]


def test_many_at_once_never_see_half_an_entry(place: Path) -> None:
    model = full_model()
    cache.keep("shared", model)

    def turn(k: int) -> bool:
        if k % 3 == 0:
            cache.keep("shared", model)
        found = cache.find("shared")
        return found is not None and found.warnings == model.warnings

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(turn, range(200)))
    assert [path.name for path in place.iterdir()] == ["shared.model"]


def test_a_real_file_comes_back_whole_and_without_a_process(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("OCP")
    path = ROOT / "cad_models" / "balloon.step"
    first = nofacet.load(path)
    monkeypatch.setattr(load, "read_in_worker", None)
    second = nofacet.load(path)
    assert_same(first, second)
    assert first.tree or first.face_name  # names came along
