"""Writing: whatever fails, and whenever, what was there before can still be had."""

import builtins
import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sandbox.level.format import writing
from sandbox.level.format.writing import unfinished, write_file, write_over

OLD, NEW = b'{"old": 1}', b'{"new": 2}' * 100


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(OLD)
    return path


def refusing(monkeypatch, holder, name, number, only=lambda *_: True):
    """Let a function of the system fail with an error number, where its arguments are of the kind."""
    real = getattr(holder, name)

    def fails(*arguments, **options):
        if only(*arguments):
            raise OSError(number, os.strerror(number))
        return real(*arguments, **options)

    monkeypatch.setattr(holder, name, fails)


class FullFile:
    """A file on a disk that is full: what is written does not fit, at once or when it is flushed."""

    def __init__(self, file, failing):
        self.file, self.failing = file, failing

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def __getattr__(self, name):
        if name == self.failing:
            raise OSError(errno.ENOSPC, "No space left on device")
        return getattr(self.file, name)


@pytest.mark.parametrize("failing", ["write", "flush"])
def test_a_disk_that_is_full_leaves_the_old_file_and_nothing_else(path, monkeypatch, failing):
    real = builtins.open
    monkeypatch.setattr(builtins, "open", lambda *arguments: FullFile(real(*arguments), failing))
    with pytest.raises(OSError, match="No space left"):
        write_over(path, NEW)
    monkeypatch.undo()
    assert path.read_bytes() == OLD
    assert os.listdir(path.parent) == ["x.json"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
def test_a_write_that_fails_late_leaves_the_old_file_and_nothing_else(path, monkeypatch, call, number):
    refusing(monkeypatch, os, call, number)
    with pytest.raises(OSError):
        write_over(path, NEW)
    assert path.read_bytes() == OLD
    assert os.listdir(path.parent) == ["x.json"]


@pytest.mark.skipif(sys.platform == "win32", reason="no limits of a process here")
def test_a_real_limit_of_size_leaves_the_old_file_and_nothing_else(path):
    script = (
        "import resource, sys, pathlib\n"
        "from sandbox.level.format.writing import write_over\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "try: write_over(pathlib.Path(sys.argv[1]), b'x' * 100_000)\n"
        "except OSError as error: print(error.strerror)\n"
    )
    ended = subprocess.run([sys.executable, "-B", "-c", script, path], capture_output=True, text=True, check=True)
    assert ended.stdout == "File too large\n"
    assert path.read_bytes() == OLD
    assert os.listdir(path.parent) == ["x.json"]


@pytest.mark.parametrize("target", ["folder", "pipe", "protected"])
def test_what_is_no_file_or_is_protected_is_refused_before_anything_is_made(tmp_path, monkeypatch, target):
    path = tmp_path / "x.json"
    if target == "folder":
        path.mkdir()
    elif target == "pipe":
        if not hasattr(os, "mkfifo"):
            pytest.skip("no pipes here")
        os.mkfifo(path)
    else:
        path.write_bytes(OLD)
        monkeypatch.setattr(writing.os, "access", lambda *_: False)
    with pytest.raises(OSError, match="it is"):
        write_over(path, NEW)
    assert os.listdir(tmp_path) == ["x.json"]


def test_a_file_that_cannot_be_replaced_is_written_in_place_beside_its_copy(path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EBUSY)
    warning = write_over(path, NEW)
    assert warning == (
        f"{path} cannot be replaced in one step here, so it was written in place and read back; "
        f"the level as it was is in {path}.bak"
    )
    assert path.read_bytes() == NEW
    assert sorted(os.listdir(path.parent)) == ["x.json", "x.json.bak"]
    assert Path(f"{path}.bak").read_bytes() == OLD


def test_shorter_data_written_in_place_leaves_no_end_of_the_old(path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EXDEV)
    path.write_bytes(NEW)
    assert write_over(path, OLD)
    assert path.read_bytes() == OLD


def test_where_nothing_can_be_made_beside_a_file_its_copy_goes_to_the_other_folder(path, monkeypatch):
    beside = path.parent
    refusing(monkeypatch, builtins, "open", errno.EACCES, lambda name, *_: str(name) not in (str(path), str(kept)))
    kept = beside / "backups" / "x.json.bak"
    warning = write_over(path, NEW, beside / "backups")
    monkeypatch.undo()
    assert warning.endswith(f"the level as it was is in {kept}")
    assert path.read_bytes() == NEW
    assert kept.read_bytes() == OLD


def test_without_a_copy_nothing_is_written_in_place(path, monkeypatch):
    refusing(monkeypatch, builtins, "open", errno.EACCES, lambda name, *_: str(name) != str(path))
    with pytest.raises(PermissionError):
        write_over(path, NEW)
    monkeypatch.undo()
    assert path.read_bytes() == OLD
    assert os.listdir(path.parent) == ["x.json"]


def test_a_new_file_that_cannot_be_made_is_refused(tmp_path, monkeypatch):
    refusing(monkeypatch, builtins, "open", errno.EROFS)
    with pytest.raises(OSError, match="Read-only"):
        write_over(tmp_path / "x.json", NEW, tmp_path / "backups")
    monkeypatch.undo()
    assert os.listdir(tmp_path) == []


def test_a_new_file_where_none_can_be_replaced_is_written_under_its_name_or_not_at_all(tmp_path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EPERM)
    assert "each save will write over it" in write_over(tmp_path / "x.json", NEW)
    assert (tmp_path / "x.json").read_bytes() == NEW
    monkeypatch.setattr(writing.Path, "read_bytes", lambda _: NEW[:5])
    with pytest.raises(OSError, match="it reads back otherwise"):
        write_over(tmp_path / "y.json", NEW)
    assert os.listdir(tmp_path) == ["x.json"]


def test_a_write_in_place_that_fails_half_way_puts_the_old_content_back(path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EPERM)
    real = os.fsync
    calls = []

    def fails_third(descriptor):
        # The first is of the temporary file, the second of the copy, the third of the file in place.
        calls.append(descriptor)
        if len(calls) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fails_third)
    with pytest.raises(OSError, match="No space left"):
        write_over(path, NEW)
    assert path.read_bytes() == OLD
    assert len(calls) == 4


def test_where_the_old_content_cannot_be_put_back_the_message_names_the_copy(path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EPERM)
    refusing(monkeypatch, builtins, "open", errno.EIO, lambda name, mode="r": str(name) == str(path) and "+" in mode)
    with pytest.raises(OSError) as refused:
        write_over(path, NEW)
    assert refused.value.strerror.endswith(f"; the level as it was is in {path}.bak")
    assert Path(f"{path}.bak").read_bytes() == OLD


def test_a_file_torn_by_a_write_in_place_does_not_become_the_copy(path, monkeypatch):
    refusing(monkeypatch, os, "replace", errno.EBUSY)
    write_over(path, NEW)
    path.write_bytes(NEW[:17])
    write_over(path, OLD)
    assert Path(f"{path}.bak").read_bytes() == OLD


def test_a_file_system_without_flushing_is_written_to_all_the_same(path, monkeypatch):
    refusing(monkeypatch, os, "fsync", errno.EINVAL)
    assert write_over(path, NEW) is None
    assert path.read_bytes() == NEW


def test_what_killed_programs_left_is_swept_and_what_others_write_now_is_not(path):
    recording = unfinished(path.with_name("played.replay.gz"), ".replay.gz")
    old, young = (path.with_name(f".spring-sandbox-{name}.tmp") for name in ("old", "young"))
    for left in (old, young, recording):
        left.write_bytes(b"half")
    day_ago = time.time() - 86_400
    for left in (old, recording):
        os.utime(left, (day_ago, day_ago))
    write_file(path, NEW)
    assert sorted(os.listdir(path.parent)) == [young.name, "x.json"]
