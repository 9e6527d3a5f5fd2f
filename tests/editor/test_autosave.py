"""Autosave: what is edited is on disk soon, is offered after a crash, and is gone once it is saved."""

import datetime
import errno
import os
import threading
from itertools import pairwise

import pytest

from sandbox.editor.storage import autosave as module
from sandbox.editor.storage import background_writer
from sandbox.editor.storage.autosave import Autosave, orphans
from sandbox.editor.storage.level_file import StorageError
from sandbox.level.reading.files import parse_level, read_level, shipped_levels
from tests.support.storage_children import Child, edit_forever, named


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "autosaves"


@pytest.fixture
def autosave(folder):
    autosave = Autosave(folder)
    yield autosave
    autosave.close()


def test_what_is_noted_is_kept_with_its_file_its_label_and_the_time(autosave, folder, tmp_path):
    before = datetime.datetime.now(datetime.UTC)
    autosave.note(named("first"), tmp_path / "x.json", "Open")
    autosave.note(named("second"), tmp_path / "x.json", "Move")
    autosave.close()
    (orphan,) = orphans(folder)
    assert (orphan.name, orphan.edited, orphan.label, orphan.fault) == ("second", tmp_path / "x.json", "Move", None)
    assert before <= orphan.when <= datetime.datetime.now(datetime.UTC)
    assert orphan.level() == named("second")


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_every_shipped_level_comes_back_as_it_was(path):
    level = read_level(path)
    text = "".join(module._slices(level))
    assert parse_level(text.encode(), "x") == level


def test_no_slice_of_a_large_level_is_long():
    level = named("large", 20_000)
    slices = list(module._slices(level))
    assert len(slices) > 50
    assert max(map(len, slices)) < 60_000
    assert parse_level("".join(slices).encode(), "x") == level


def test_while_a_window_lives_its_autosave_is_no_orphan_and_once_it_is_killed_it_is(folder, tmp_path):
    child = Child(edit_forever, folder, tmp_path / "x.json", 0.02)
    while not list(folder.glob("*.autosave")):
        child.hear()
    assert orphans(folder) == []
    child.kill()
    (orphan,) = orphans(folder)
    assert orphan.edited == tmp_path / "x.json" and orphan.level().particles


def test_what_is_saved_or_given_up_leaves_nothing(autosave, folder):
    autosave.note(named("first"), None, "Open")
    autosave.settle()
    assert len(list(folder.glob("*.autosave"))) == 1
    autosave.clear()
    autosave.close()
    assert os.listdir(folder) == []


def test_a_window_that_edits_nothing_leaves_nothing(folder):
    autosave = Autosave(folder)
    autosave.clear()
    autosave.settle()
    autosave.close()
    assert not folder.exists()


def test_a_closed_autosave_takes_up_again_where_it_is_told_to(autosave, folder):
    autosave.note(named("first"), None, "Open")
    autosave.close()
    autosave.note(named("second"), None, "Move")
    autosave.settle()
    assert orphans(folder) == []
    autosave.close()
    (orphan,) = orphans(folder)
    assert orphan.level() == named("second")


def test_an_orphan_stays_until_it_is_dismissed(autosave, folder):
    autosave.note(named("first"), None, "Open")
    autosave.close()
    for _ in range(2):
        (orphan,) = orphans(folder)
        assert orphan.edited is None
    orphan.dismiss()
    assert orphans(folder) == [] and os.listdir(folder) == []
    orphan.dismiss()


def test_an_orphan_goes_once_the_window_that_took_its_level_has_written_it(autosave, folder, tmp_path, monkeypatch):
    autosave.note(named("lost"), tmp_path / "x.json", "Move")
    autosave.close()
    (orphan,) = orphans(folder)
    heir = Autosave(folder)
    with monkeypatch.context() as patched:
        patched.setattr(module, "write_file", full)
        heir.adopt(orphan, orphan.level())
        heir.settle()
        assert heir.fault and orphan.path.exists()
        heir.close()
        assert orphan.path.exists()
    heir.adopt(orphan, orphan.level())
    heir.settle()
    assert not orphan.path.exists()
    heir.close()
    (again,) = orphans(folder)
    assert (again.name, again.edited, again.label) == ("lost", tmp_path / "x.json", "Recover")


def test_an_orphan_stays_while_only_what_was_noted_before_it_is_written(autosave, folder, tmp_path, monkeypatch):
    lost = Autosave(folder)
    lost.note(named("lost"), tmp_path / "x.json", "Move")
    lost.close()
    (orphan,) = orphans(folder)
    begun, may_end, write_file = threading.Event(), threading.Event(), module.write_file

    def slow(*given):
        begun.set()
        assert may_end.wait(10)
        write_file(*given)

    monkeypatch.setattr(background_writer, "_PAUSES", (0.0, 0.0))
    monkeypatch.setattr(module, "write_file", slow)
    autosave.note(named("before"), None, "Open")
    assert begun.wait(10)
    autosave.adopt(orphan, orphan.level())
    monkeypatch.setattr(module, "write_file", full)
    may_end.set()
    autosave.settle()
    assert orphan.path.exists()


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_folder_that_cannot_be_written_is_told_until_it_can(autosave, folder, monkeypatch):
    monkeypatch.setattr(background_writer, "_PAUSES", (0.0, 0.0))
    with monkeypatch.context() as patched:
        patched.setattr(module, "write_file", full)
        autosave.note(named("first"), None, "Open")
        autosave.settle()
        line = f"The work cannot be kept in {folder}: no space left on device. Save it yourself."
        assert autosave.fault == line
        assert list(folder.glob("*.autosave")) == []
    with autosave._writer._changed:
        assert autosave._writer._changed.wait_for(lambda: autosave.fault is None, 30)
    assert len(list(folder.glob("*.autosave"))) == 1


def test_noting_returns_while_the_disk_is_slow_and_only_the_newest_waits(autosave, folder, monkeypatch):
    monkeypatch.setattr(background_writer, "_PAUSES", (0.0, 0.0))
    real, go, written = module.write_file, threading.Event(), []

    def slow(path, data):
        written.append(data)
        go.wait()
        real(path, data)

    monkeypatch.setattr(module, "write_file", slow)
    for number in range(100):
        autosave.note(named(f"edit {number}"), None, "Move")
    go.set()
    autosave.settle()
    assert 1 <= len(written) <= 3
    autosave.close()
    assert orphans(folder)[0].name == "edit 99"


def damaged(folder, name, data):
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.autosave").write_bytes(data)


def test_damaged_autosaves_are_listed_as_such_and_last(autosave, folder):
    autosave.note(named("first", 50), None, "Open")
    autosave.close()
    (whole,) = folder.glob("*.autosave")
    data = whole.read_bytes()
    head = data.partition(b"\n")[0]
    cases = [b"", b"\n", b"[]\n{}", b"\xff\xfe", data[:30], head, head + b"\n", head + b"\n{", b"[" * 100_000]
    cases += [head.replace(b"autosave", b"autosafe"), head.replace(b'"when": "2', b'"when": "x'), data[:-20]]
    cases += [data.replace(b'"p7"', b'"p8"')]
    for number, case in enumerate(cases):
        damaged(folder, f"damaged {number}", case)
    found = orphans(folder)
    assert len(found) == 1 + len(cases)
    assert [orphan.path for orphan in found if orphan.fault is None] == [whole]
    assert all(a.when is not None or b.when is None for a, b in pairwise(found))
    for orphan in found:
        if orphan.fault is not None:
            assert "is damaged" in orphan.fault and orphan.fault.isprintable()
            with pytest.raises(StorageError):
                orphan.level()
            level, lines = orphan.salvaged()
            assert lines and (level is None or level.name == "first")


def test_what_is_valid_of_a_damaged_autosave_can_be_had(autosave, folder):
    autosave.note(named("first", 50), None, "Open")
    autosave.close()
    (path,) = folder.glob("*.autosave")
    path.write_bytes(path.read_bytes().replace(b'"p7"', b'"p8"'))
    (orphan,) = orphans(folder)
    assert "part of the level may be lost" in orphan.fault and orphan.name == "first"
    level, lines = orphan.salvaged()
    assert len(level.particles) == 49 and len(lines) == 1


def test_a_folder_that_is_not_there_or_no_folder_has_no_orphans(tmp_path):
    assert orphans(tmp_path / "none") == []
    (tmp_path / "file").write_text("")
    assert orphans(tmp_path / "file") == []


def test_the_folder_is_the_person_s_own_unless_told(monkeypatch, tmp_path):
    monkeypatch.setattr(module, "data_folder", lambda: tmp_path)
    autosave = Autosave()
    autosave.note(named("first"), None, "Open")
    autosave.close()
    assert [orphan.path.parent for orphan in orphans()] == [tmp_path / "autosaves"]
