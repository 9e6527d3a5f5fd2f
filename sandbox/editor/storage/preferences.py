"""Preferences: small facts that the program remembers about a person from start to start."""

import contextlib
import json
from pathlib import Path
from typing import Any

from sandbox.editor.storage.level_file import data_folder
from sandbox.level.format.writing import write_file


def preference(name: str, folder: Path | None = None) -> Any:
    """What is remembered under a name; None where nothing is. folder: of the person's data."""
    return _read(_file(folder)).get(name)


def set_preference(name: str, value: Any, folder: Path | None = None) -> None:
    """Remember a JSON value under a name; where that cannot be written, nothing happens."""
    file = _file(folder)
    # None of it is worth a line to the person: it is asked or offered once more, no work depends on it.
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_file(file, json.dumps({**_read(file), name: value}).encode())


def _file(folder: Path | None) -> Path:
    return (data_folder() if folder is None else folder) / "preferences.json"


def _read(file: Path) -> dict[str, Any]:
    try:
        read = json.loads(file.read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return read if isinstance(read, dict) else {}
