"""LevelFile: the file of the level that is edited, locked against other windows and watched for changes."""

import contextlib
import datetime
import hashlib
import json
import os
import platform
from pathlib import Path

from filelock import FileLock, Timeout

from sandbox.editor.storage.preferences import data_folder
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.level.reading.files import parse_level, read_bytes, write_level
from sandbox.level.reading.salvage import salvage

# Name of the person's data folder; autosaves, locks and recent levels of another name would not be found again.


class StorageError(Exception):
    """What could not be stored or opened, in one line for the person."""


class LevelInUse(StorageError):
    """The level is open in another window; it can still be opened as a copy."""


class FileExists(StorageError):
    """A file of that name is there; it is replaced only where the person says so."""


class ChangedOnDisk(StorageError):
    """Another program has written the level's file; it is replaced only where the person says so."""


class LevelFile:
    """The file of an open level, or none yet (`path` is None): then the level is saved under a new name.

    folder: where locks and backups are kept, by default the person's data folder. `warning`: a line for the person
    where the file could not be locked, else None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = data_folder() if folder is None else folder
        self.path: Path | None = None
        self.warning: str | None = None
        self._lock: FileLock | None = None
        self._digest: bytes | None = None
        self._stamp: tuple[int, ...] | None = None

    @classmethod
    def open(cls, path: str | os.PathLike[str], folder: Path | None = None) -> tuple["LevelFile", Level]:
        """Open a level to edit it. Raises LevelInUse, or LevelError where it cannot be read."""
        opened = cls(folder)
        opened._lock = opened._locked(Path(path))
        opened.path = Path(path)
        try:
            return opened, opened.read()
        except LevelError:
            opened.close()
            raise

    @classmethod
    def to_come(cls, path: str | os.PathLike[str], folder: Path | None = None) -> "LevelFile":
        """A file that is written once the level is saved. Raises LevelInUse."""
        wanted = cls(folder)
        wanted._lock = wanted._locked(Path(path))
        wanted.path = Path(path)
        return wanted

    @classmethod
    def copy_of(cls, path: str | os.PathLike[str], folder: Path | None = None) -> tuple["LevelFile", Level]:
        """Open a level as a copy that has no file yet. Raises LevelError where it cannot be read."""
        source = os.fspath(path)
        return cls(folder), parse_level(read_bytes(source), source)

    @classmethod
    def salvaged(
        cls, path: str | os.PathLike[str], folder: Path | None = None
    ) -> tuple["LevelFile", Level | None, list[str]]:
        """Open the valid rest of a level, as a copy, so that its file stays as it is; a line for each part left out.

        Raises LevelError where the file itself cannot be read.
        """
        source = os.fspath(path)
        return cls(folder), *salvage(read_bytes(source), source)

    def read(self) -> Level:
        """Read the level from its file, also again to revert to it. Raises LevelError."""
        assert self.path is not None
        source = os.fspath(self.path)
        stamp = _stamp(self.path)
        data = read_bytes(source)
        level = parse_level(data, source)
        self._digest, self._stamp = _digest(data), stamp
        return level

    def save(self, level: Level, replace: bool = False) -> str | None:
        """Write the level to its file: a warning for the person, or None. Raises StorageError.

        replace: write also where another program has changed the file since, which is ChangedOnDisk otherwise.
        """
        assert self.path is not None
        if not replace and self._differs():
            raise ChangedOnDisk(
                f"{_shown(self.path)} was changed by another program after you opened it; "
                "save under another name, or replace it"
            )
        warning = self._write(level, self.path)
        self._remember()
        return warning

    def save_as(self, level: Level, path: str | os.PathLike[str], replace: bool = False) -> str | None:
        """Write the level to another file, which then is its own: a warning, or None. Raises StorageError.

        replace: write also where a file of that name is, which is FileExists otherwise.
        """
        wanted = Path(path)
        if self.path is not None and _key(wanted) == _key(self.path):
            return self.save(level, replace)
        if not replace and os.path.lexists(wanted):
            raise FileExists(f"{_shown(wanted)} exists already; choose another name, or replace it")
        lock = self._locked(wanted)
        try:
            warning = self._write(level, wanted)
        except StorageError:
            _released(lock)
            raise
        _released(self._lock)
        self.path, self._lock = wanted, lock
        self._remember()
        return warning

    def changed_on_disk(self) -> bool:
        """Whether the file holds something else than was last read or written here; cheap enough to ask often."""
        if self.path is None or _stamp(self.path) == self._stamp:
            return False
        if self._differs():
            return True
        self._stamp = _stamp(self.path)
        return False

    def close(self) -> None:
        """Let other windows have the file."""
        _released(self._lock)
        self._lock = None

    def _differs(self) -> bool:
        """Whether the file is there and its bytes are others; a file that is gone holds nothing to lose."""
        assert self.path is not None
        try:
            return _digest(read_bytes(self.path)) != self._digest
        except LevelError:
            return False

    def _remember(self) -> None:
        assert self.path is not None
        self._stamp = _stamp(self.path)
        with contextlib.suppress(LevelError):
            self._digest = _digest(read_bytes(self.path))

    def _write(self, level: Level, path: Path) -> str | None:
        try:
            return write_level(level, path, self.folder / "backups" / _key(path))
        except LevelError as error:
            raise StorageError(error.faults[0]) from None

    def _locked(self, path: Path) -> FileLock | None:
        """The lock of a file, held until its process ends; None, and a warning, where none can be made."""
        self.warning = None
        try:
            folder = self.folder / "locks"
            folder.mkdir(parents=True, exist_ok=True)
            lock = FileLock(folder / f"{_key(path)}.lock", thread_local=False)
            lock.acquire(timeout=0)
        except Timeout:
            raise LevelInUse(f"{_shown(path)} is open {_holder(lock)}; close it there, or open a copy") from None
        except (OSError, ValueError) as error:
            self.warning = f"{_shown(path)} cannot be locked against other windows: {refusal_of(error)}"
            return None
        holder = {"pid": os.getpid(), "host": platform.node(), "since": f"{datetime.datetime.now():%Y-%m-%d %H:%M}"}
        with contextlib.suppress(OSError):
            write_file(_holder_path(lock), json.dumps(holder).encode())
        return lock


def _key(path: Path) -> str:
    """The same short text for every name of one file."""
    try:
        real = os.path.normcase(os.path.realpath(path))
    except ValueError:  # a null character, which reading and writing refuse in words
        real = os.path.abspath(path)
    return hashlib.blake2b(os.fsencode(real), digest_size=16).hexdigest()


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data).digest()


def _stamp(path: Path) -> tuple[int, ...] | None:
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


def _shown(path: Path) -> str:
    return one_line(os.fspath(path))


def _holder_path(lock: FileLock) -> Path:
    return Path(lock.lock_file).with_suffix(".json")


def _holder(lock: FileLock) -> str:
    """Who has a lock, as far as they said so."""
    try:
        holder = json.loads(_holder_path(lock).read_bytes())
        pid, host, since = holder["pid"], holder["host"], holder["since"]
    except (OSError, ValueError, LookupError, TypeError):
        return "in another window"
    where = "in this window" if (pid, host) == (os.getpid(), platform.node()) else "in another window"
    return one_line(f"{where} (process {pid} on {host}, since {since})")


def _released(lock: FileLock | None) -> None:
    if lock is not None:
        with contextlib.suppress(OSError):
            _holder_path(lock).unlink()
        lock.release()
