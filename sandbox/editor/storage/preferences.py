"""Preferences: what a person has chosen, and small facts that the program remembers, from start to start."""

import contextlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import platformdirs
from filelock import FileLock, Timeout

from sandbox.level.format.writing import write_file

# Version of the file; a later one may hold names that are not known here, which are kept.
VERSION = 1
# Longest wait [s] for another window that writes the file at this moment.
_PATIENCE = 0.5
_APPLICATION = "spring-sandbox"
# How many are remembered; the list is shown whole.
RECENT_COUNT = 20


def data_folder() -> Path:
    """The folder of the person's own data: autosaves, locks, backups, recent levels, preferences."""
    return Path(platformdirs.user_data_dir(_APPLICATION, appauthor=False))


def preference(name: str, folder: Path | None = None) -> Any:
    """The value remembered under a name; None where there is none. folder: of the person's data."""
    return preferences(folder).get(name)


def preferences(folder: Path | None = None) -> dict[str, Any]:
    """All remembered values by their names; none where they cannot be read."""
    try:
        return _read(preferences_file(folder))
    except (OSError, ValueError):
        return {}


def set_preference(name: str, value: Any, folder: Path | None = None) -> None:
    """Remember a JSON value under a name, None = forget it; where that cannot be written, nothing happens."""
    set_preferences({name: value}, folder)


def set_preferences(values: Mapping[str, Any], folder: Path | None = None) -> None:
    """Remember JSON values by their names, None = forget one; where that cannot be written, nothing happens."""
    file = preferences_file(folder)
    # None of it is worth a line to the person: it is asked or offered once more, no work depends on it.
    with contextlib.suppress(OSError, Timeout):
        file.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(file.with_suffix(".lock"), thread_local=False).acquire(timeout=_PATIENCE):
            set_aside_broken(folder)
            kept = {"version": VERSION, **preferences(folder), **values}
            kept = {name: value for name, value in kept.items() if value is not None}
            write_file(file, json.dumps(kept, indent=2).encode())


def set_aside_broken(folder: Path | None = None) -> Path | None:
    """Give a file that cannot be read as preferences another name, which is returned; None where nothing is broken."""
    file = preferences_file(folder)
    try:
        _read(file)
    except OSError:
        return None
    except ValueError:
        aside = file.with_name("preferences.broken.json")
        with contextlib.suppress(OSError):
            os.replace(file, aside)
            return aside
    return None


def preferences_file(folder: Path | None = None) -> Path:
    """Where preferences are kept."""
    return (data_folder() if folder is None else folder) / "preferences.json"


def _read(file: Path) -> dict[str, Any]:
    """The values in a file, none where there is no file. Raises OSError, and ValueError for what are no preferences."""
    try:
        read = json.loads(file.read_bytes())
    except FileNotFoundError:
        return {}
    except RecursionError as error:
        raise ValueError("too deep") from error
    if not isinstance(read, dict):
        raise ValueError("no object")
    return read


def recent_levels(folder: Path | None = None) -> list[Path]:
    """Level files that were used last and are still there, newest first. folder: of the person's data."""
    return _still_there("recent.json", folder)


def played_levels(folder: Path | None = None) -> list[Path]:
    """Level files, shipped ones too, that were played last and are still there, newest first."""
    return _still_there("played.json", folder)


def remember(path: str | os.PathLike[str], folder: Path | None = None) -> None:
    """Put a level's file first among the recent ones; where that cannot be written, nothing happens."""
    _put_first("recent.json", path, folder)


def remember_played(path: str | os.PathLike[str], folder: Path | None = None) -> None:
    """Put a level's file first among those played; where that cannot be written, nothing happens."""
    _put_first("played.json", path, folder)


def _put_first(name: str, path: str | os.PathLike[str], folder: Path | None) -> None:
    file = _list_file(name, folder)
    newest = Path(os.path.abspath(path))
    # The list is a convenience: no fault of it is worth a line to the person.
    with contextlib.suppress(OSError, Timeout):
        file.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(file.with_suffix(".lock"), thread_local=False).acquire(timeout=_PATIENCE):
            paths = [newest, *(other for other in _listed(file) if other != newest)]
            write_file(file, json.dumps([os.fspath(other) for other in paths[:RECENT_COUNT]]).encode())


def _still_there(name: str, folder: Path | None) -> list[Path]:
    return [path for path in _listed(_list_file(name, folder)) if os.path.isfile(path)]


def _list_file(name: str, folder: Path | None) -> Path:
    return (data_folder() if folder is None else folder) / name


def _listed(file: Path) -> list[Path]:
    try:
        listed = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return []
    if not isinstance(listed, list):
        return []
    return [Path(path) for path in listed if isinstance(path, str) and "\0" not in path][:RECENT_COUNT]
