"""Autosave: the level as it is being edited, kept in the person's data folder by a thread of its own."""

import base64
import contextlib
import datetime
import hashlib
import itertools
import json
import os
import secrets
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from sandbox.editor.storage.background_writer import BackgroundWriter
from sandbox.editor.storage.level_file import StorageError
from sandbox.editor.storage.preferences import data_folder
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.picture import Picture
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.pictures import pictures_of, take_pictures
from sandbox.level.reading.salvage import salvage

_FORMAT = "spring-sandbox/autosave"
_SUFFIX = ".autosave"
# Items of a level that become text before the thread lets the others go on: about 0.5 ms of their time.
_SLICE = 400
# Pause [s] after each slice; a level of 20,000 particles and springs takes 0.1 s more for it.
_BREATH = 0.001


@dataclass(frozen=True)
class _Edit:
    """A level that was noted: where its file is, and the label of the edit that made it."""

    level: Level
    path: Path | None
    label: str


class Autosave:
    """Keeps the level of one window on disk while it is edited; what is left after a crash is among the orphans.

    folder: where, by default in the person's data folder.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = autosave_folder() if folder is None else folder
        self._path = self.folder / f"{secrets.token_hex(8)}{_SUFFIX}"
        self._lock: FileLock | None = None
        self._adopted: tuple[Orphan, ...] = ()
        # The level, None = no file; and the orphans that go once it is written.
        self._writer: BackgroundWriter[tuple[_Edit | None, tuple[Orphan, ...]]] = BackgroundWriter("work", self._write)

    @property
    def fault(self) -> str | None:
        """A line for the person while nothing can be written, else None."""
        return self._writer.fault

    def note(self, level: Level, path: Path | None, label: str) -> None:
        """Keep this level from now on; returns at once, and is written at most one edit or 10 s later."""
        self._writer.note(self._path, (_Edit(level, path, label), self._adopted))

    def clear(self) -> None:
        """Remove what was kept, as the level has been saved, or given up by the person."""
        if self._writer.has_begun:
            self._writer.note(self._path, (None, self._adopted))

    def adopt(self, orphan: "Orphan", level: Level) -> None:
        """Keep the level of an orphan; the orphan itself goes once that is written."""
        self._adopted = (*self._adopted, orphan)
        self.note(level, orphan.edited, "Recover")

    def settle(self) -> None:
        """Wait until the noted edit is written, or cannot be."""
        self._writer.settle()

    def close(self) -> None:
        """Write what was noted last and end; what was not cleared is offered at the next start."""
        self._writer.close()
        if self._lock is not None:
            self._lock.release()
            if not self._path.exists():
                _remove(_lock_path(self._path))
        self._lock = None

    def _write(self, path: Path, content: "tuple[_Edit | None, tuple[Orphan, ...]]") -> None:
        edit, adopted = content
        if edit is None:
            path.unlink(missing_ok=True)
        else:
            # Only once there is something to keep, so that windows that edit nothing leave nothing behind.
            if self._lock is None:
                self.folder.mkdir(parents=True, exist_ok=True)
                lock = FileLock(_lock_path(path), thread_local=False)
                lock.acquire(timeout=0)
                self._lock = lock
            write_file(path, _data(edit, hurried=lambda: self._writer.is_closing))
        for orphan in adopted:
            orphan.dismiss()


@dataclass(frozen=True)
class Orphan:
    """The autosave of a window that is gone.

    path: its own file; name: of its level; edited: the level's file, None where it had none; when: it was kept;
    label: of its last edit; fault: a line where it is damaged, else None, and then the rest is as far as known.
    """

    path: Path
    name: str = "Untitled"
    edited: Path | None = None
    when: datetime.datetime | None = None
    label: str = ""
    fault: str | None = None

    def level(self) -> Level:
        """The level that was kept. Raises StorageError with one line where it is damaged; see `salvaged`."""
        try:
            level = parse_level(_halves(self.path)[1], os.fspath(self.path))
            self._take_pictures(level)
            return level
        except LevelError as error:
            raise StorageError(error.faults[0]) from None

    def salvaged(self) -> tuple[Level | None, list[str]]:
        """The valid part of a damaged autosave, and the lines of what is left out. Raises StorageError."""
        level, lines = salvage(_halves(self.path)[1], os.fspath(self.path))
        if level is not None:
            self._take_pictures(level)
        return level, lines

    def _take_pictures(self, level: Level) -> None:
        """Give a level the pictures that were kept with it."""
        # Autosaves of earlier versions, and damaged ones, have none.
        with contextlib.suppress(AttributeError, TypeError, ValueError):
            kept = json.loads(_halves(self.path)[0]).get("pictures", {})
            take_pictures(level, {name: Picture(name, base64.b64decode(text)) for name, text in kept.items()})

    def dismiss(self) -> None:
        """Remove it for good: the person has it back, or does not want it."""
        _remove(self.path)
        _remove(_lock_path(self.path))


def autosave_folder() -> Path:
    """The folder of the person's autosaves."""
    return data_folder() / "autosaves"


def orphans(folder: Path | None = None) -> list[Orphan]:
    """Autosaves whose windows are gone, newest first; damaged ones last."""
    found = []
    try:
        paths = sorted((autosave_folder() if folder is None else folder).glob(f"*{_SUFFIX}"))
    except OSError:
        return []
    for path in paths:
        if _has_owner(path):
            continue
        try:
            found.append(_orphan(path))
        except StorageError as error:
            found.append(Orphan(path, fault=str(error)))
    never = datetime.datetime.min.replace(tzinfo=datetime.UTC)
    return sorted(found, key=lambda orphan: orphan.when or never, reverse=True)


def _orphan(path: Path) -> Orphan:
    """An autosave with the facts of its first line. Raises StorageError."""
    first, rest = _halves(path)
    try:
        head = json.loads(first)
        if head["format"] != _FORMAT:
            raise ValueError
        known = Orphan(
            path,
            str(head["name"]),
            None if head["path"] is None else Path(str(head["path"])),
            datetime.datetime.fromisoformat(head["when"]).astimezone(datetime.UTC),
            str(head["label"]),
        )
        is_whole = head["digest"] == _digest(rest)
    except (ArithmeticError, LookupError, RecursionError, TypeError, ValueError):
        raise StorageError(f"{one_line(str(path))}: is damaged; its first line cannot be read") from None
    if is_whole:
        return known
    fault = f"{one_line(str(path))}: is damaged; part of the level may be lost"
    return Orphan(known.path, known.name, known.edited, known.when, known.label, fault)


def _data(edit: _Edit, hurried: Callable[[], bool]) -> bytes:
    """The file of an autosave: a line about it, then the level as JSON.

    hurried: whether nobody else has to go on meanwhile.
    """
    texts = []
    for text in _slices(edit.level):
        texts.append(text)
        if not hurried():
            time.sleep(_BREATH)
    rest = "".join(texts).encode()
    head = {
        "format": _FORMAT,
        "name": edit.level.name,
        "path": None if edit.path is None else os.path.abspath(edit.path),
        "label": edit.label,
        "when": datetime.datetime.now(datetime.UTC).isoformat(),
        "digest": _digest(rest),
        "pictures": {
            name: base64.b64encode(picture.data or b"").decode() for name, picture in pictures_of(edit.level).items()
        },
    }
    return json.dumps(head).encode() + b"\n" + rest


def _slices(level: Level) -> Iterator[str]:
    """The JSON text of a level in parts, none of which takes long to make."""
    lists = ("bodies", "particles", "springs", "welds")
    start = level.model_dump_json(exclude=set(lists)).removesuffix("}")
    yield start
    for name in lists:
        yield f',"{name}":['
        separator = ""
        items = iter(getattr(level, name))
        while batch := list(itertools.islice(items, _SLICE)):
            yield separator + ",".join(map(_item, batch))
            separator = ","
        yield "]"
    yield "}"


def _item(item: Any) -> str:
    return json.dumps(item) if isinstance(item, tuple) else str(item.model_dump_json(exclude_defaults=True))


def _halves(path: Path) -> tuple[bytes, bytes]:
    try:
        first, _, rest = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise StorageError(f"{one_line(str(path))}: cannot be read: {refusal_of(error)}") from None
    return first, rest


def _digest(data: bytes) -> str:
    return hashlib.blake2b(data, digest_size=16).hexdigest()


def _has_owner(path: Path) -> bool:
    lock = FileLock(_lock_path(path), thread_local=False)
    try:
        with lock.acquire(timeout=0):
            return False
    except Timeout:
        return True
    except OSError:
        return False


def _lock_path(path: Path) -> Path:
    return path.with_suffix(".lock")


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.unlink()
