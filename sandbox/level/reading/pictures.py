"""Pictures that looks of a level name: read from the folder of its file, and written there."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown
from sandbox.level.format.look import BodyLook
from sandbox.level.format.picture import NoPicture, Picture, read_picture
from sandbox.level.format.writing import refusal_of, write_file


def pictures_of(level: Level) -> dict[str, Picture]:
    """The pictures of a level that were read, by their names."""
    return {look.picture: look.picture for _, look in _wearing(level) if look.picture.data is not None}


def read_pictures(level: Level, folder: Path, source: str, has_all: bool = True) -> None:
    """Read the pictures of a level that was just read from a folder, into the level.

    has_all: raise LevelError with a line for each that cannot be read; else those stay names alone.
    """
    faults: list[Fault] = []
    found: dict[str, Picture | str] = {}
    for where, look in _wearing(level):
        name = str(look.picture)
        if name not in found:
            try:
                found[name] = read_picture(folder / name)
            except NoPicture as error:
                found[name] = f"{shown(name)}: {error}"
        picture = found[name]
        if isinstance(picture, Picture):
            look.__dict__["picture"] = picture
        else:
            faults.append((where, picture))
    if faults and has_all:
        raise LevelError(source, faults)


def take_pictures(level: Level, pictures: Mapping[str, Picture]) -> None:
    """Give a level that was just made the pictures that it names, where these are they."""
    for _, look in _wearing(level):
        if look.picture.data is None and look.picture in pictures:
            look.__dict__["picture"] = pictures[look.picture]


def lacking(level: Level) -> str | None:
    """A line about pictures that a level names and does not have, None where it has all."""
    have = pictures_of(level)
    names = sorted({shown(str(look.picture)) for _, look in _wearing(level) if look.picture not in have})
    return f"{', '.join(names)}: not here, so what wears it has its usual skin" if names else None


def write_pictures(level: Level, folder: Path, source: str) -> None:
    """Write the pictures of a level into the folder of its file. What lies there already stays as it is.

    Raises LevelError for a name that another picture has there, for one that was never read and does not lie there, and
    where the folder takes none; then nothing is written.
    """
    faults: list[Fault] = []
    missing: dict[Path, bytes] = {}
    for where, look in _wearing(level):
        picture, path = look.picture, folder / look.picture
        if picture.data is None:
            if not path.is_file():
                faults.append((where, f"{shown(str(picture))} is not here: choose it again, or take it out"))
        elif not path.exists() and missing.get(path, picture.data) == picture.data:
            missing[path] = picture.data
        elif path in missing or not _is_of(picture, path):
            faults.append((where, f"{shown(str(picture))}: another picture of that name is here; rename one of them"))
    if faults:
        raise LevelError(source, faults)
    for path, data in missing.items():
        try:
            write_file(path, data)
        except (OSError, ValueError) as error:
            raise LevelError(source, [("", f"{path.name} cannot be written beside it: {refusal_of(error)}")]) from None


def _is_of(picture: Picture, path: Path) -> bool:
    """Whether a file is where a picture came from, though it may have changed since, or holds the same."""
    try:
        return str(path.resolve()) == picture.path or path.read_bytes() == picture.data
    except OSError:
        return False


def _wearing(level: Level) -> Iterator[tuple[str, Any]]:
    """Looks with a picture, and where they are."""
    looks: list[tuple[str, BodyLook | None]] = [
        *((json_path(["bodies", k, "look", "picture"]), body.look) for k, body in enumerate(level.bodies)),
        *((json_path(["materials", name, "look", "picture"]), each.look) for name, each in level.materials.items()),
    ]
    return ((where, look) for where, look in looks if look is not None and look.picture is not None)
