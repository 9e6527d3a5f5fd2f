"""Which level file a recording runs on: that of its level's name, or else of its title, the nearest to it."""

import functools
import os
from collections.abc import Iterable
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import file_of, read_level
from sandbox.session.replay.recording import Replay


class NoLevelError(LevelError):
    """Files among which a recording has no level, or several; folder: where they were looked for."""

    def __init__(self, replay: Replay, folder: Path, fault: str) -> None:
        super().__init__(replay.source, [("", f"in {folder} {fault}")])
        self.folder = folder


def level_in(place: Path, replay: Replay) -> Level:
    """The level of a recording at a place: a level file, or a folder in which its level lies. Raises LevelError."""
    return level_among(nearest(place.rglob("*.json"), replay), replay, place) if place.is_dir() else known_level(place)


def nearest(files: Iterable[Path], replay: Replay) -> list[Path]:
    """The files of the name of a recording's level, or else of its title, that are the fewest folders away from it."""
    name, title, each = file_of(replay.level), replay.level.name, sorted(files)
    found = [path for path in each if name and path.name == name] or [path for path in each if title == _title_of(path)]
    here = Path(replay.source).resolve().parent
    away = [len(Path(os.path.relpath(path.resolve().parent, here)).parts) for path in found]
    return [path for path, steps in zip(found, away, strict=True) if steps == min(away)]


def level_among(found: list[Path], replay: Replay, folder: Path) -> Level:
    """The level of a recording where one file was found in a folder. Raises LevelError."""
    name, title = file_of(replay.level), replay.level.name
    if len(found) == 1:
        return known_level(found[0])
    if found:
        called = name if found[0].name == name else repr(title)
        fault = f"{len(found)} levels are called {called}: {', '.join(map(str, found))}"
    else:
        fault = f"there is neither {name} nor a level with the title {title!r}" if name else ""
        fault = fault or f"no level has the title {title!r}"
    raise NoLevelError(replay, folder, fault)


def known_level(path: Path) -> Level:
    """A level, read once as long as its file is not changed. Raises LevelError."""
    return _read_level(path, path.stat().st_mtime_ns if path.is_file() else 0)


def _title_of(path: Path) -> str | None:
    """The title of a level file, None of one that cannot be read."""
    try:
        return known_level(path).name
    except (LevelError, OSError):
        return None


@functools.lru_cache(maxsize=256)
def _read_level(path: Path, changed: int) -> Level:
    return read_level(path)
