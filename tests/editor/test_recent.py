"""Recent levels: newest first, each once, and a damaged list is an empty one."""

import os
from pathlib import Path

import pytest

from sandbox.editor.storage import preferences
from sandbox.editor.storage.preferences import RECENT_COUNT, recent_levels, remember


def made(folder, *names):
    paths = [folder / name for name in names]
    for path in paths:
        path.write_text("{}")
    return paths


def test_the_newest_is_first_and_each_stands_once(tmp_path):
    a, b, c = made(tmp_path, "a.json", "b.json", "ü\n.json")
    for path in (a, b, c, a):
        remember(path, tmp_path / "data")
    assert recent_levels(tmp_path / "data") == [a, c, b]


def test_paths_are_remembered_whole(tmp_path, monkeypatch):
    made(tmp_path, "a.json")
    monkeypatch.chdir(tmp_path)
    remember("a.json", tmp_path / "data")
    monkeypatch.chdir("/")
    assert recent_levels(tmp_path / "data") == [tmp_path / "a.json"]


def test_files_that_are_gone_are_not_listed_and_come_back_with_the_file(tmp_path):
    a, b = made(tmp_path, "a.json", "b.json")
    remember(a, tmp_path)
    remember(b, tmp_path)
    b.unlink()
    assert recent_levels(tmp_path) == [a]
    made(tmp_path, "b.json")
    assert recent_levels(tmp_path) == [b, a]


def test_the_list_does_not_grow_beyond_its_length(tmp_path):
    paths = made(tmp_path, *(f"{number}.json" for number in range(RECENT_COUNT + 5)))
    for path in paths:
        remember(path, tmp_path)
    assert recent_levels(tmp_path) == paths[:4:-1]


@pytest.mark.parametrize("damaged", [b"", b"{}", b"5", b"\xff", b"[" * 100_000, b'[1, null, "a\\u0000b", {}]'])
def test_a_damaged_list_is_an_empty_one_and_is_mended_by_the_next(tmp_path, damaged):
    (tmp_path / "recent.json").write_bytes(damaged)
    assert recent_levels(tmp_path) == []
    (path,) = made(tmp_path, "a.json")
    remember(path, tmp_path)
    assert recent_levels(tmp_path) == [path]


def test_where_nothing_can_be_written_nothing_happens(tmp_path):
    (tmp_path / "data").write_text("a file")
    remember(tmp_path / "a.json", tmp_path / "data")
    assert recent_levels(tmp_path / "data") == []


def test_the_list_is_the_person_s_own_unless_told(tmp_path, monkeypatch):
    monkeypatch.setattr(preferences, "data_folder", lambda: tmp_path)
    (path,) = made(tmp_path, "a.json")
    remember(os.fspath(path))
    assert recent_levels() == [Path(path)]
