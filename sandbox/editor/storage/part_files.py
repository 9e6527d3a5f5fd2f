"""The catalogue of parts: small level files, those that are shipped and a person's own in a folder of their data."""

import functools
import os
import re
from dataclasses import dataclass
from pathlib import Path

from sandbox.editor.storage.level_file import StorageError
from sandbox.editor.storage.preferences import data_folder
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.quantities import replaced
from sandbox.level.format.writing import refusal_of
from sandbox.level.reading.files import parse_level, read_bytes, shipped_folder, write_level

# Own parts that are listed at most.
LISTED = 300
# Files that are remembered as they were read, while they stay as they are.
_REMEMBERED = 400
# Longest name of a file [characters].
_NAME_LIMIT = 60
# Shipped parts that come first, in this order; others follow by their names.
_FIRST = ("car", "crane", "walker", "windmill", "tower")


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
        """What is in it; None where it is broken."""
        return _read(self.path, self.stamp)[0]

    @property
    def fault(self) -> str:
        """One line that says what is wrong with it; empty where nothing is."""
        return _read(self.path, self.stamp)[1]

    @property
    def name(self) -> str:
        """What it is called: by the level's name, of a broken one by the file's."""
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
    """Take the file of an own part away. Raises StorageError."""
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
