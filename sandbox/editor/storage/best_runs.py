"""Best runs: of each level that a person has won, the best result, and a recording of that run."""

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.editor.storage.preferences import data_folder
from sandbox.level.document.model import Level
from sandbox.level.format.writing import unfinished, write_file
from sandbox.level.reading.files import level_data
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.level_edits import SILENT
from sandbox.session.outcome import MOST_STARS
from sandbox.session.solution import recorded

# Version of the file of a result.
VERSION = 1
SUFFIX = ".replay.jsonl"


@dataclass(frozen=True)
class Result:
    """A win of a level: with 1 to 3 stars, after so many ticks, of which a second has `rate`."""

    stars: int
    ticks: int
    rate: int

    @property
    def seconds(self) -> float:
        """Time of the run [s]."""
        return self.ticks / self.rate

    def is_better_than(self, other: "Result | None") -> bool:
        """Whether the result has more stars than another, or as many in less time."""
        return other is None or (-self.stars, self.seconds) < (-other.stars, other.seconds)


def best_result(level: Level, folder: Path | None = None) -> Result | None:
    """The best result of a level; None where it was never won. folder: of the person's data."""
    try:
        data = json.loads(_place(level, folder).with_suffix(".json").read_bytes())
        stars, ticks = data["stars"], data["ticks"]
    except (OSError, ValueError, RecursionError, KeyError, TypeError):
        return None
    is_sound = type(stars) is int and type(ticks) is int and 1 <= stars <= MOST_STARS and ticks > 0
    return Result(stars, ticks, level.settings.tick_rate) if is_sound else None


def keep_result(level: Level, result: Result, folder: Path | None = None) -> bool:
    """Keep the result of a run if it is the best one of its level; whether it is. Raises OSError."""
    if not result.is_better_than(best_result(level, folder)):
        return False
    place = _place(level, folder)
    place.parent.mkdir(parents=True, exist_ok=True)
    data = {"version": VERSION, "level": level.name, "stars": result.stars, "ticks": result.ticks}
    write_file(place.with_suffix(".json"), json.dumps(data, indent=2).encode())
    return True


def best_recording(level: Level, folder: Path | None = None) -> Path | None:
    """The recording of the best run of a level, where there is one."""
    path = _recording(level, folder)
    return path if path.is_file() else None


def record_best(level: Level, script: Sequence[ScriptLine], ticks: int, folder: Path | None = None) -> Iterator[bool]:
    """Record the commands of a run of so many ticks as the best one of its level, a slice at a time.

    Where they cannot be carried out or written, the recording before stays.
    """
    path = _recording(level, folder)
    # Of several windows each writes its own.
    partial = unfinished(path, SUFFIX)
    with contextlib.suppress(CommandError, OSError):
        yield from map(bool, recorded(level, script, ticks, partial))
        os.replace(partial, path)


def _recording(level: Level, folder: Path | None) -> Path:
    return _place(level, folder).with_suffix(SUFFIX)


def _place(level: Level, folder: Path | None) -> Path:
    """Where results of a level are kept, but for the end of the name: by all of it that says something about a run."""
    data = {name: part for name, part in level_data(level).items() if name not in SILENT}
    digest = hashlib.blake2b(json.dumps(data, sort_keys=True).encode(), digest_size=16).hexdigest()
    return (data_folder() if folder is None else folder) / "best" / digest
