"""Autosave: the level as it is being edited, kept in the person's data folder by a thread of its own."""

import contextlib
import datetime
import hashlib
import itertools
import json
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from sandbox.editor.storage.data_folder import data_folder
from sandbox.editor.storage.level_file import StorageError
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.salvage import salvage

_FORMAT = "spring-sandbox/autosave"
_SUFFIX = ".autosave"
# Items of a level that become text before the thread lets the others go on: about 0.5 ms of their time.
_SLICE = 400
# Pause [s] after each slice; a level of 20,000 particles and springs takes 0.1 s more for it.
_BREATH = 0.001
# Pause [s] after a write, as many times the time it took, within these bounds. With the longest write the pause is
# what the newest edit may be behind: together they stay under the promised 10 s.
_PAUSE_FACTOR = 5.0
_PAUSES = (0.25, 4.0)


@dataclass(frozen=True)
class _Edit:
    """A level that was noted: where its file is, and the label of the edit that made it."""

    level: Level
    path: Path | None
    label: str


class Autosave:
    """Keeps the level of one window on disk while it is edited; what is left after a crash is among the orphans.

    folder: where, by default in the person's data folder. `fault`: a line for the person while nothing can be
    written there, else None. It is written again at each pause until it succeeds.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = autosave_folder() if folder is None else folder
        self.fault: str | None = None
        self._path = self.folder / f"{secrets.token_hex(8)}{_SUFFIX}"
        self._lock: FileLock | None = None
        self._changed = threading.Condition()
        self._edit: _Edit | None = None
        # Numbers of the notes so far: the newest, the one that was last tried, the one that was last written.
        self._noted = self._tried = self._written = 0
        self._is_closing = False
        self._adopted: tuple[Orphan, ...] = ()
        self._thread: threading.Thread | None = None

    def note(self, level: Level, path: Path | None, label: str) -> None:
        """Keep this level from now on; returns at once, and is written at most one edit or 10 s later."""
        self._want(_Edit(level, path, label))

    def clear(self) -> None:
        """Remove what was kept, as the level has been saved, or given up by the person."""
        if self._thread is not None:
            self._want(None)

    def adopt(self, orphan: "Orphan", level: Level) -> None:
        """Keep the level of an orphan; the orphan itself goes once that is written."""
        self._want(_Edit(level, orphan.edited, "Recover"), orphan)

    def settle(self) -> None:
        """Wait until what was noted is written, or cannot be."""
        with self._changed:
            noted = self._noted
            self._changed.wait_for(lambda: self._tried >= noted)

    def close(self) -> None:
        """Write what was noted last and end; what was not cleared is offered at the next start."""
        with self._changed:
            self._is_closing = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join()
        if self._lock is not None:
            self._lock.release()
            if not self._path.exists():
                _remove(_lock_path(self._path))
        self._thread = self._lock = None

    def _want(self, edit: _Edit | None, *adopted: "Orphan") -> None:
        with self._changed:
            self._edit, self._noted = edit, self._noted + 1
            self._adopted = (*self._adopted, *adopted)
            if self._thread is None:
                self._is_closing = False
                self._thread = threading.Thread(target=self._work, name="autosave", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._written < self._noted or self._is_closing)
                if self._written == self._noted:
                    return
                # Orphans that come with a later edit stay until that one is written.
                edit, number, adopted = self._edit, self._noted, self._adopted
            start = time.monotonic()
            fault = self._write(edit, adopted)
            shortest, longest = _PAUSES
            pause = longest if fault else min(max(_PAUSE_FACTOR * (time.monotonic() - start), shortest), longest)
            with self._changed:
                self.fault, self._tried = fault, number
                if fault is None:
                    self._written, self._adopted = number, self._adopted[len(adopted) :]
                self._changed.notify_all()
                if self._is_closing and fault is not None:
                    return
                self._changed.wait_for(lambda: self._is_closing, pause)

    def _write(self, edit: _Edit | None, adopted: "tuple[Orphan, ...]") -> str | None:
        """Bring the file to what is wanted, in place of the adopted orphans: None, or why it cannot be."""
        try:
            if edit is None:
                self._path.unlink(missing_ok=True)
            else:
                self._take_lock()
                write_file(self._path, _data(edit, hurried=lambda: self._is_closing))
        except (OSError, ValueError, MemoryError) as error:
            why = refusal_of(error) if isinstance(error, OSError) else one_line(str(error))
            return f"The work cannot be kept in {one_line(str(self.folder))}: {why}. Save it yourself."
        for orphan in adopted:
            orphan.dismiss()
        return None

    def _take_lock(self) -> None:
        # Only once there is something to keep, so that windows that edit nothing leave nothing behind.
        if self._lock is None:
            self.folder.mkdir(parents=True, exist_ok=True)
            lock = FileLock(_lock_path(self._path), thread_local=False)
            lock.acquire(timeout=0)
            self._lock = lock


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
            return parse_level(_halves(self.path)[1], os.fspath(self.path))
        except LevelError as error:
            raise StorageError(error.faults[0]) from None

    def salvaged(self) -> tuple[Level | None, list[str]]:
        """What is valid of a damaged one, and the lines of what is left out. Raises StorageError."""
        return salvage(_halves(self.path)[1], os.fspath(self.path))

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
    """What an autosave says of itself. Raises StorageError."""
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
