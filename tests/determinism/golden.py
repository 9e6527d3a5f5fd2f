"""Goldens: runs that are kept as files, each a level, the commands of a run, and hashes of its state on the way.

A file is gzipped JSON lines, and depends on nothing else: a line {"level": text of a level file}, then command lines as
docs/commands.md has them, then for every kept tick a line {"tick", "hash", "arrays"}: the hash of the whole state and
that of each array, by its name in files.
"""

import gzip
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.level.format.files import parse_level
from sandbox.physics.snapshot import hash_by_array, state_hash
from sandbox.session.commands.records import ScriptLine
from sandbox.session.session import Session

FOLDER = Path(__file__).with_name("goldens")
SUFFIX = ".jsonl.gz"
KEPT_TICKS = 60  # between two kept states


@dataclass(frozen=True)
class Kept:
    """What a golden keeps of the state after a tick: the hash of all, and of each array."""

    tick: int
    hash: str
    arrays: dict[str, str]


@dataclass(frozen=True)
class Golden:
    """A run: the text of its level, its command lines ({"tick", "gesture", "command"}), and its kept states."""

    level: str
    commands: tuple[dict[str, Any], ...]
    kept: tuple[Kept, ...]

    def start(self) -> Session:
        """The run at its beginning; a command of it that cannot be carried out raises CommandError."""
        script = [
            ScriptLine(line["tick"], line["gesture"], line["command"], number)
            for number, line in enumerate(self.commands, 2)
        ]
        return Session(parse_level(self.level.encode(), "golden"), script=script)


def golden_path(name: str) -> Path:
    """Where the golden of a level is, by the level's name."""
    return FOLDER / f"{name}{SUFFIX}"


def golden_names() -> list[str]:
    """Names of the levels that have a golden."""
    return sorted(path.name.removesuffix(SUFFIX) for path in FOLDER.glob(f"*{SUFFIX}"))


def read_golden(name: str) -> Golden:
    """The golden of a level."""
    level, *lines = map(json.loads, gzip.decompress(golden_path(name).read_bytes()).splitlines())
    commands = tuple(line for line in lines if "command" in line)
    return Golden(level["level"], commands, tuple(Kept(**line) for line in lines if "hash" in line))


def write_golden(name: str, golden: Golden) -> None:
    """Write the golden of a level: the same bytes for the same golden."""
    lines = [{"level": golden.level}, *golden.commands, *(vars(kept) for kept in golden.kept)]
    text = "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in lines)
    golden_path(name).write_bytes(gzip.compress(text.encode(), mtime=0))


def played(session: Session, ticks: int) -> Iterator[Kept]:
    """Step up to a tick and give every state on the way that a golden keeps."""
    while session.tick < ticks:
        session.advance()
        if session.tick % KEPT_TICKS == 0:
            arrays = hash_by_array(session.world)
            yield Kept(session.tick, state_hash(session.world, arrays), arrays)
