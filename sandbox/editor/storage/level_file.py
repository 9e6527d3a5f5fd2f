"""Files of levels: the one that is edited, locked and watched, and the small ones of a person's catalogue of parts."""

import contextlib
import datetime
import functools
import hashlib
import json
import os
import platform
import re
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from sandbox.editor.storage.preferences import data_folder
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.quantities import replaced
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.level.reading.files import parse_level, read_bytes, read_level, shipped_folder, write_level
from sandbox.level.reading.pictures import read_pictures
from sandbox.level.reading.salvage import salvage

# Own parts that are listed at most.
LISTED = 300
# Files that are remembered as they were read, while they stay as they are.
_REMEMBERED = 400
# Longest name of a file [characters].
_NAME_LIMIT = 60
# Shipped parts that come first, in this order; others follow by their names.
_FIRST = ("car", "crane", "walker", "windmill", "tower")

# Name of the person's data folder; autosaves, locks and recent levels of another name would not be found again.


class StorageError(Exception):
    """Something that could not be stored or opened, in one line for the person."""


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

    def named_beside(self, name: str) -> str:
        """The file in brackets after a level's name, "" where it is called as the level is, or there is none."""
        return f" ({one_line(self.path.name)})" if self.path is not None and self.path.stem != name else ""

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
        made = cls(folder)
        made._lock = made._locked(Path(path))
        made.path = Path(path)
        return made

    @classmethod
    def copy_of(cls, path: str | os.PathLike[str], folder: Path | None = None) -> tuple["LevelFile", Level]:
        """Open a level as a copy that has no file yet. Raises LevelError where it cannot be read."""
        source = os.fspath(path)
        return cls(folder), read_level(source)

    @classmethod
    def salvaged(
        cls, path: str | os.PathLike[str], folder: Path | None = None
    ) -> tuple["LevelFile", Level | None, list[str]]:
        """Open the valid rest of a level, as a copy, so that its file stays as it is; a line for each part left out.

        Raises LevelError where the file itself cannot be read.
        """
        source = os.fspath(path)
        level, lines = salvage(read_bytes(source), source)
        if level is not None:
            read_pictures(level, Path(source).parent, source, has_all=False)
        return cls(folder), level, lines

    def read(self) -> Level:
        """Read the level from its file, also again to revert to it. Raises LevelError."""
        assert self.path is not None
        source = os.fspath(self.path)
        stamp = _stamp(self.path)
        data = read_bytes(source)
        level = parse_level(data, source)
        read_pictures(level, Path(source).parent, source)
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
        target = Path(path)
        if self.path is not None and _key(target) == _key(self.path):
            return self.save(level, replace)
        if not replace and os.path.lexists(target):
            raise FileExists(f"{_shown(target)} exists already; choose another name, or replace it")
        lock = self._locked(target)
        try:
            warning = self._write(level, target)
        except StorageError:
            _released(lock)
            raise
        _released(self._lock)
        self.path, self._lock = target, lock
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
        """Unlock the file, for other windows."""
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
    """Key of a file, the same for every name that leads to it."""
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
    """The program that has a lock, as far as it wrote its name."""
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


@dataclass(frozen=True)
class PartFile:
    """A file of the catalogue, which is read when it is first asked for what is in it.

    is_own: it is the person's, to be renamed and deleted. stamp: when it was changed [ns], and its size [bytes].
    """

    path: Path
    is_own: bool
    stamp: tuple[int, int]

    @property
    def level(self) -> Level | None:
        """The part's level; None where the file is broken."""
        return _read(self.path, self.stamp)[0]

    @property
    def fault(self) -> str:
        """The line that says what is wrong with the file; empty where nothing is."""
        return _read(self.path, self.stamp)[1]

    @property
    def name(self) -> str:
        """The part's name: that of its level, or the file's where the level cannot be read."""
        level = self.level
        return one_line(self.path.stem) if level is None else level.name


def catalogue(folder: Path | None = None) -> list[PartFile]:
    """All parts, shipped ones first, each by their files' names; folder: of own ones, None = in the person's data."""
    shipped = sorted((shipped_folder("levels") / "parts").glob("*.json"), key=_order)
    own = _own_files(own_parts_folder(folder))[:LISTED]
    return [*(_part(path, is_own=False) for path in shipped), *(_part(path, is_own=True) for path in own)]


def own_parts_folder(folder: Path | None = None) -> Path:
    """The folder of the person's own parts, which may not be there yet."""
    return data_folder() / "parts" if folder is None else folder


def keep_part(level: Level, folder: Path | None = None) -> Path:
    """Write a part into the person's folder, in a file of its name, which is free. Raises StorageError."""
    place = own_parts_folder(folder)
    if any(part.is_own and part.name.casefold() == level.name.casefold() for part in catalogue(folder)):
        raise StorageError(f"there is a part “{one_line(level.name)}” already; choose another name")
    try:
        place.mkdir(parents=True, exist_ok=True)
        path = _free(place, level.name)
        write_level(level, path)
    except LevelError as error:
        raise StorageError(error.faults[0]) from None
    except OSError as error:
        raise StorageError(f"{place} cannot be used: {refusal_of(error)}") from None
    return path


def rename_part(part: PartFile, name: str) -> Path:
    """Give an own part another name, its file too. Raises StorageError."""
    assert part.is_own
    if part.level is None:
        raise StorageError(f"{one_line(part.path.name)} cannot be read, so it cannot be renamed")
    name = name.strip()
    if name == part.level.name:
        return part.path
    if name.casefold() == part.level.name.casefold():
        raise StorageError("change more than the size of letters, or keep it under another name first")
    # The old file goes last: whatever fails before it, the part is there.
    path = keep_part(replaced(part.level, name=name), part.path.parent)
    delete_part(part)
    return path


def delete_part(part: PartFile) -> None:
    """Delete the file of an own part. Raises StorageError."""
    assert part.is_own
    try:
        part.path.unlink(missing_ok=True)
    except OSError as error:
        raise StorageError(f"{one_line(part.path.name)} cannot be deleted: {refusal_of(error)}") from None


def _order(path: Path) -> tuple[int, str]:
    return (_FIRST.index(path.stem) if path.stem in _FIRST else len(_FIRST)), path.stem


def _own_files(folder: Path) -> list[Path]:
    try:
        return sorted(folder.glob("*.json"))
    except OSError:
        return []


def _part(path: Path, is_own: bool) -> PartFile:
    try:
        stat = path.stat()
    except OSError:  # reading says why
        return PartFile(path, is_own, (0, 0))
    return PartFile(path, is_own, (stat.st_mtime_ns, stat.st_size))


@functools.lru_cache(_REMEMBERED)
def _read(path: Path, stamp: tuple[int, int]) -> tuple[Level | None, str]:
    """The level of a file as it is since its stamp, or its first fault."""
    try:
        level = parse_level(read_bytes(path), os.fspath(path.name))
        read_pictures(level, path.parent, os.fspath(path.name))
    except LevelError as error:
        return None, one_line(error.faults[0])
    if not (level.bodies or level.particles or level.terrain):
        return None, f"{one_line(path.name)}: there is nothing in it"
    return level, ""


def _free(folder: Path, name: str) -> Path:
    """A path in the folder that nothing has, by a name made for files."""
    base = re.sub(r"[^\w]+", "-", name.casefold()).strip("-_")[:_NAME_LIMIT] or "part"
    count = 1
    while (path := folder / f"{base if count == 1 else f'{base}-{count}'}.json").exists():
        count += 1
    return path
