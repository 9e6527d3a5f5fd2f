"""Recent levels: the files that were opened or saved last, and those played last, for every window of the person."""

import contextlib
import json
import os
from pathlib import Path

from filelock import FileLock, Timeout

from sandbox.editor.storage.data_folder import data_folder
from sandbox.level.format.writing import write_file

# How many are remembered; the list is shown whole.
RECENT_COUNT = 20
# Longest wait [s] for another window that writes the list at this moment.
_PATIENCE = 0.5


def recent_levels(folder: Path | None = None) -> list[Path]:
    """Level files that were used last and are still there, newest first. folder: of the person's data."""
    return _there("recent.json", folder)


def played_levels(folder: Path | None = None) -> list[Path]:
    """Level files, shipped ones too, that were played last and are still there, newest first."""
    return _there("played.json", folder)


def remember(path: str | os.PathLike[str], folder: Path | None = None) -> None:
    """Put a level's file first among the recent ones; where that cannot be written, nothing happens."""
    _put_first("recent.json", path, folder)


def remember_played(path: str | os.PathLike[str], folder: Path | None = None) -> None:
    """Put a level's file first among those played; where that cannot be written, nothing happens."""
    _put_first("played.json", path, folder)


def _put_first(name: str, path: str | os.PathLike[str], folder: Path | None) -> None:
    file = _file(name, folder)
    newest = Path(os.path.abspath(path))
    # The list is a convenience: no fault of it is worth a line to the person.
    with contextlib.suppress(OSError, Timeout):
        file.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(file.with_suffix(".lock"), thread_local=False).acquire(timeout=_PATIENCE):
            paths = [newest, *(other for other in _listed(file) if other != newest)]
            write_file(file, json.dumps([os.fspath(other) for other in paths[:RECENT_COUNT]]).encode())


def _there(name: str, folder: Path | None) -> list[Path]:
    return [path for path in _listed(_file(name, folder)) if os.path.isfile(path)]


def _file(name: str, folder: Path | None) -> Path:
    return (data_folder() if folder is None else folder) / name


def _listed(file: Path) -> list[Path]:
    try:
        listed = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return []
    if not isinstance(listed, list):
        return []
    return [Path(path) for path in listed if isinstance(path, str) and "\0" not in path][:RECENT_COUNT]
