"""LevelFile: opening, saving, locks and changes by others; every refusal is one line and loses nothing."""

import errno
import json
import os
import platform

import pytest

from sandbox.editor.storage import preferences
from sandbox.editor.storage.autosave import Autosave, orphans
from sandbox.editor.storage.level_file import ChangedOnDisk, FileExists, LevelFile, LevelInUse, StorageError
from sandbox.level.reading.files import LevelError, read_level, write_level
from tests.support.storage_children import Child, hold, named


@pytest.fixture
def data(tmp_path):
    return tmp_path / "data"


@pytest.fixture
def path(tmp_path):
    (tmp_path / "levels").mkdir()
    path = tmp_path / "levels" / "x.json"
    write_level(named("old"), path)
    return path


@pytest.fixture
def opened(path, data):
    level_file, level = LevelFile.open(path, data)
    assert level == named("old")
    yield level_file
    level_file.close()


def refusal(kind, call, *arguments, **options):
    with pytest.raises(kind) as refused:
        call(*arguments, **options)
    line = str(refused.value)
    assert line.isprintable()
    return line


def test_a_level_is_saved_where_it_was_opened_and_nothing_is_left_beside_it(opened, path):
    assert opened.save(named("new")) is None
    assert read_level(path) == named("new")
    assert os.listdir(path.parent) == ["x.json"]


def test_a_new_level_gets_its_file_by_save_as(path, data):
    level_file = LevelFile(data)
    assert level_file.path is None and not level_file.changed_on_disk()
    level_file.save_as(named("new"), path.with_name("y.json"))
    level_file.save(named("newer"))
    assert read_level(path.with_name("y.json")) == named("newer")
    level_file.close()


def test_save_as_replaces_no_file_unless_told_to(opened, path):
    other = path.with_name("y.json")
    write_level(named("other"), other)
    assert refusal(FileExists, opened.save_as, named("new"), other) == (
        f"{other} exists already; choose another name, or replace it"
    )
    assert opened.path == path and read_level(other) == named("other")
    opened.save_as(named("new"), other, replace=True)
    assert opened.path == other and read_level(other) == named("new")
    assert read_level(path) == named("old")


def test_save_as_to_its_own_file_is_save(opened, path):
    (path.parent / "link.json").symlink_to(path)
    opened.save_as(named("new"), path.parent / "link.json")
    assert opened.path == path and read_level(path) == named("new")


def test_the_second_window_is_told_who_has_a_level_and_may_have_a_copy(path, data):
    child = Child(hold, path, data)
    pid = child.hear()
    line = refusal(LevelInUse, LevelFile.open, path, data)
    assert line.startswith(f"{path} is open in another window (process {pid} on {platform.node()}, since ")
    assert line.endswith("; close it there, or open a copy")
    level_file, level = LevelFile.copy_of(path, data)
    assert level == named("old") and level_file.path is None
    assert "another window" in refusal(LevelInUse, level_file.save_as, level, path, replace=True)
    child.kill()
    LevelFile.open(path, data)[0].close()


def test_a_level_that_is_open_twice_in_one_window_is_said_to_be(opened, path, data):
    assert "is open in this window (process" in refusal(LevelInUse, LevelFile.open, path, data)
    (path.parent / "link.json").symlink_to(path)
    assert "is open in this window" in refusal(LevelInUse, LevelFile.open, path.parent / "link.json", data)


def test_a_damaged_note_of_who_has_a_level_costs_only_the_name(opened, path, data):
    (note,) = (data / "locks").glob("*.json")
    for damaged in (b"", b"[]", b'{"pid": 1}', b"\xff"):
        note.write_bytes(damaged)
        assert "is open in another window; close it there" in refusal(LevelInUse, LevelFile.open, path, data)


def test_a_level_that_was_closed_saved_elsewhere_or_refused_is_free_again(path, data):
    level_file, level = LevelFile.open(path, data)
    level_file.save_as(level, path.with_name("y.json"))
    again, _ = LevelFile.open(path, data)
    again.close()
    assert "is open" in refusal(LevelInUse, LevelFile.open, path.with_name("y.json"), data)
    level_file.close()
    LevelFile.open(path.with_name("y.json"), data)[0].close()
    path.write_text("{")
    for _ in range(2):
        assert "not JSON" in refusal(LevelError, LevelFile.open, path, data)


def test_a_save_as_that_fails_keeps_the_file_and_its_lock(opened, path, data):
    away = path.parent / "none" / "y.json"
    assert "no such file or directory" in refusal(StorageError, opened.save_as, named("new"), away)
    assert opened.path == path
    assert "is open" in refusal(LevelInUse, LevelFile.open, path, data)
    opened.save(named("new"))
    assert read_level(path) == named("new")


def test_where_no_lock_can_be_made_a_level_opens_with_a_warning(path, tmp_path):
    (tmp_path / "data").write_text("a file, no folder")
    level_file, level = LevelFile.open(path, tmp_path / "data")
    assert level == named("old")
    assert level_file.warning.startswith(f"{path} cannot be locked against other windows: ")
    level_file.save(named("new"))
    assert read_level(path) == named("new")
    level_file.close()


def test_a_change_by_another_program_is_noticed_and_not_written_over_unless_told_to(opened, path):
    assert not opened.changed_on_disk()
    write_level(named("theirs"), path)
    assert opened.changed_on_disk()
    assert refusal(ChangedOnDisk, opened.save, named("mine")) == (
        f"{path} was changed by another program after you opened it; save under another name, or replace it"
    )
    assert read_level(path) == named("theirs")
    opened.save(named("mine"), replace=True)
    assert read_level(path) == named("mine") and not opened.changed_on_disk()


def test_a_change_within_the_grain_of_the_clock_is_noticed_when_saving(opened, path):
    before = path.stat()
    path.write_bytes(path.read_bytes().replace(b"old", b"odd"))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    refusal(ChangedOnDisk, opened.save, named("mine"))
    assert read_level(path) == named("odd")


def test_reading_again_takes_what_another_program_wrote(opened, path):
    write_level(named("theirs"), path)
    assert opened.read() == named("theirs")
    assert not opened.changed_on_disk()
    opened.save(named("mine"))


def test_own_saves_touched_files_and_files_that_are_gone_are_no_changes(opened, path):
    opened.save(named("new"))
    assert not opened.changed_on_disk()
    os.utime(path)
    assert not opened.changed_on_disk()
    path.unlink()
    assert not opened.changed_on_disk()
    opened.save(named("newer"))
    assert read_level(path) == named("newer")


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


def read_only(*_):
    raise OSError(errno.EROFS, "Read-only file system")


@pytest.mark.parametrize("trouble", ["no space", "read-only folder", "vanished folder", "folder in its place"])
def test_a_save_that_cannot_be_is_one_line_and_the_work_stays_in_the_autosave(
    opened, path, data, tmp_path, monkeypatch, trouble
):
    autosave = Autosave(tmp_path / "autosaves")
    autosave.note(named("new"), path, "Move")
    autosave.settle()
    before = path.read_bytes()
    with monkeypatch.context() as patched:
        if trouble == "no space":
            patched.setattr(os, "fsync", full)
            words = "cannot be written: no space left on device"
        elif trouble == "read-only folder":
            patched.setattr("builtins.open", read_only)
            patched.setattr(LevelFile, "_differs", lambda _: False)
            words = "cannot be written: read-only file system"
        elif trouble == "vanished folder":
            path.unlink()
            path.parent.rmdir()
            words = "cannot be written: no such file or directory"
        else:
            path.unlink()
            path.mkdir()
            words = "cannot be written: it is a folder"
        assert refusal(StorageError, opened.save, named("new")) == f"{path}: {words}"
    if path.is_file():
        assert path.read_bytes() == before
    if path.parent.is_dir():
        assert os.listdir(path.parent) == ["x.json"]
    autosave.close()
    (orphan,) = orphans(tmp_path / "autosaves")
    assert orphan.level() == named("new") and orphan.edited == path
    opened.save_as(named("new"), tmp_path / "rescued.json")
    assert read_level(tmp_path / "rescued.json") == named("new")


def test_a_save_in_place_brings_a_warning_and_a_copy(opened, path, data, monkeypatch):
    def refused(*_):
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "replace", refused)
    warning = opened.save(named("new"))
    assert warning.endswith(f"the level as it was is in {path}.bak")
    assert read_level(path) == named("new") and read_level(f"{path}.bak") == named("old")
    assert not opened.changed_on_disk()


def test_what_is_salvaged_has_no_file_yet_so_that_the_damaged_one_stays(path, data):
    raw = json.loads(path.read_bytes())
    raw["particles"][1]["mass"] = -1
    path.write_text(json.dumps(raw))
    damaged = path.read_bytes()
    refusal(LevelError, LevelFile.open, path, data)
    level_file, level, lines = LevelFile.salvaged(path, data)
    assert level == named("old") and lines == [f"{path}: particles.1.mass: -1 is below the limit 1e-09"]
    assert level_file.path is None
    refusal(FileExists, level_file.save_as, level, path)
    assert path.read_bytes() == damaged


@pytest.mark.parametrize("name", ["x\0.json", "y" * 5_000])
def test_names_that_no_system_takes_are_refused_in_a_line(data, tmp_path, name):
    refusal(LevelError, LevelFile.open, tmp_path / name, data)
    refusal(StorageError, LevelFile(data).save_as, named("new"), tmp_path / name)


def test_the_data_folder_is_the_person_s_own(monkeypatch, tmp_path):
    monkeypatch.setattr(preferences.platformdirs, "user_data_dir", lambda name, appauthor: str(tmp_path / name))
    assert preferences.data_folder() == tmp_path / "spring-sandbox"
    assert LevelFile().folder == tmp_path / "spring-sandbox"
