"""Pictures that looks of a level name: read from the folder of its file, and written there."""

import itertools
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown
from sandbox.level.format.look import BodyLook
from sandbox.level.format.picture import NoPicture, Picture, read_picture
from sandbox.level.format.quantities import replaced


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
    return f"{', '.join(names)}: not here; what wears it has its usual skin" if names else None


def placed_pictures(level: Level, folder: Path, source: str) -> tuple[Level, dict[Path, bytes]]:
    """A level whose pictures have names that are free in a folder, or theirs; and what is to be written there.

    What lies there stays as it is. Raises LevelError for a picture that was never read and does not lie there.
    """
    faults: list[Fault] = []
    missing: dict[Path, bytes] = {}

    def place(where: str, look: BodyLook) -> BodyLook:
        picture = look.picture
        assert isinstance(picture, Picture)
        if picture.data is None and not (folder / picture).is_file():
            faults.append((where, f"{shown(str(picture))} is not here: choose it again, or take it out"))
        if picture.data is None:
            return look
        path = next(path for path in _names(folder, picture) if _is_free(path, picture, missing))
        if not path.exists():
            missing[path] = picture.data
        return replaced(look, picture=Picture(path.name, picture.data, picture.path))

    changed = _with_looks(level, place)
    if faults:
        raise LevelError(source, faults)
    return changed, missing


def _names(folder: Path, picture: Picture) -> Iterator[Path]:
    yield folder / picture
    stem = picture[: -len(".png")]
    yield from (folder / f"{stem}-{number}.png" for number in itertools.count(2))


def _is_free(path: Path, picture: Picture, missing: Mapping[Path, bytes]) -> bool:
    """Whether a file is not there, holds this picture, or is where it came from, though it may have changed since."""
    if path in missing:
        return missing[path] == picture.data
    if not os.path.lexists(path):
        return True
    try:
        return os.path.realpath(path) == picture.path or path.read_bytes() == picture.data
    except OSError:
        return False


def _with_looks(level: Level, change: Callable[[str, BodyLook], BodyLook]) -> Level:
    """A level with others of the looks that have a picture; the same where it has none."""
    wearing = dict(_wearing(level))
    if not wearing:
        return level
    made = {where: change(where, look) for where, look in wearing.items()}
    bodies = tuple(
        replaced(body, look=made[where]) if (where := _of_body(k)) in made else body
        for k, body in enumerate(level.bodies)
    )
    materials = {
        name: replaced(each, look=made[where]) if (where := _of_material(name)) in made else each
        for name, each in level.materials.items()
    }
    return replaced(level, bodies=bodies, materials=materials)


def _of_body(number: int) -> str:
    return json_path(["bodies", number, "look", "picture"])


def _of_material(name: str) -> str:
    return json_path(["materials", name, "look", "picture"])


def _wearing(level: Level) -> Iterator[tuple[str, Any]]:
    """Looks with a picture, and where they are."""
    looks: list[tuple[str, BodyLook | None]] = [
        *((_of_body(k), body.look) for k, body in enumerate(level.bodies) if body.look is not None),
        *((_of_material(name), each.look) for name, each in level.materials.items() if each.look is not None),
    ]
    return ((where, look) for where, look in looks if look is not None and look.picture is not None)
