"""Level files: reads them within limits, writes them without losing the old one, finds the shipped ones."""

import os
import stat
from collections.abc import Sequence
from pathlib import Path

from sandbox.level.document.canonical import level_data, level_text
from sandbox.level.document.model import Level
from sandbox.level.faults.validate import check_level
from sandbox.level.format.level_error import LevelError, suggestion
from sandbox.level.format.limits import FILE_LIMIT
from sandbox.level.format.shipped import shipped_folder
from sandbox.level.format.writing import refusal_of, write_file, write_over
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.pictures import placed_pictures, read_pictures

__all__ = [
    "LevelError",
    "file_of",
    "keep_file",
    "level_data",
    "level_path",
    "load_level",
    "parse_level",
    "read_bytes",
    "read_level",
    "run_with",
    "shipped_folder",
    "shipped_levels",
    "write_level",
]


def read_level(path: str | os.PathLike[str]) -> Level:
    """Read a level file. Raises LevelError with one line per fault, also if the file cannot be read."""
    source = os.fspath(path)
    level = parse_level(read_bytes(source), source)
    read_pictures(level, Path(source).parent, source)
    keep_file(level, Path(source).name)
    return level


def keep_file(level: Level, name: str, run_with: Sequence[str] = ()) -> None:
    """Store the name of a level's file in the level, for as long as the level lives; "": there is none.

    run_with: those of its settings that whoever runs it has chosen, in place of what the file says.
    """
    object.__setattr__(level, "_file", name)
    object.__setattr__(level, "_run_with", tuple(run_with))


def file_of(level: Level) -> str:
    """The name of the file that a level was read from, without folders; "" for a copy of another level."""
    return getattr(level, "_file", "")


def run_with(level: Level) -> tuple[str, ...]:
    """The names of the settings that are not as the level's file has them, but as whoever runs it has chosen."""
    return getattr(level, "_run_with", ())


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Read the bytes of a level file, at most one more than the limit. Raises LevelError."""
    source = os.fspath(path)
    try:
        if not stat.S_ISREG(os.stat(source).st_mode):
            kind = "a folder" if os.path.isdir(source) else "no regular file"
            raise LevelError(source, [("", f"is {kind}; name a level file")])
        with open(source, "rb") as file:
            return file.read(FILE_LIMIT + 1)
    except FileNotFoundError:
        raise LevelError(source, [("", "there is no such file")]) from None
    except LevelError:
        raise
    except (OSError, ValueError) as error:
        raise LevelError(source, [("", f"cannot be read: {refusal_of(error)}")]) from None


def load_level(name: str | os.PathLike[str]) -> Level:
    """Read a level file, or a shipped level by its name (`rope`). Raises LevelError."""
    return read_level(level_path(name))


def level_path(name: str | os.PathLike[str]) -> str | Path:
    """A level file as it is named, or that of a shipped level by its name (`rope`). Raises LevelError."""
    text = os.fspath(name)
    if "\0" in text or Path(text).name != text or os.path.isfile(text):
        return text
    shipped = {path.stem: path for path in shipped_levels()}
    found = shipped.get(text) or shipped.get(text.removesuffix(".json"))
    if found is not None or os.path.lexists(text):
        return found or text
    hint = suggestion(text, shipped) or "; shipped are " + ", ".join(shipped)
    raise LevelError(text, [("", "there is no such file and no shipped level of that name" + hint)])


def write_level(level: Level, path: str | os.PathLike[str], backups: Path | None = None) -> str | None:
    """Write a level in canonical form, whole or not at all. Raises LevelError if it could not be read back.

    Its pictures are written beside it, where they are not there; another picture of the same name stays, and the file
    then names the level's own by a number.

    If the folder does not allow to replace a file in one step, a copy of the old file is made first, beside it or in
    the folder `backups`. Returns a warning that says so, else None.
    """
    source = os.fspath(path)
    check_level(level, source)
    named, pictures = placed_pictures(level, Path(source).parent, source)
    data = level_text(named).encode()
    if len(data) > FILE_LIMIT:
        raise LevelError(source, [("", f"would be larger than {FILE_LIMIT // 1024 // 1024} MiB; make it smaller")])
    try:
        for picture, content in pictures.items():
            write_file(picture, content)
        return write_over(Path(os.path.realpath(source)), data, backups)
    except (OSError, ValueError) as error:
        raise LevelError(source, [("", f"cannot be written: {refusal_of(error)}")]) from None


def shipped_levels() -> list[Path]:
    """Files of the shipped levels, in order of their names."""
    return sorted(shipped_folder("levels").glob("*.json"))
