"""Reading replay files: every line checked before it is believed, faults as one line each."""

import json
import os
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import Field, field_validator

from sandbox.level.document.model import Level, Settings
from sandbox.level.format.limits import FILE_LIMIT, PARTICLE_LIMIT, SPRING_LIMIT
from sandbox.level.format.scan import scan
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.reading.files import LevelError, keep_file, parse_level
from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import ALWAYS_STORED, BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import CHAIN_DIGITS, FORMAT, TICK_DIGITS, VERSION, level_digest, unseal
from sandbox.session.replay.line_reader import GZIP_MAGIC, ReplayLines, kind_of
from sandbox.session.replay.record import CommandLine, Digest, Line, Tick, checked, json_object
from sandbox.session.replay.recording import ByHand, OtherPhysicsError, Replay, ReplayError, StoredState, TickHashes

# What a stored state may hold [bytes]: so much, and so much for each particle and spring. Shipped levels have up to 224
# bytes a slot, and a third more as base64.
STATE_BYTES, STATE_BYTES_A_SLOT = 2**20, 400
# The longest name of a file that systems have [characters].
FILE_NAME_LIMIT = 255
# Lines that are read at a time, where somebody waits for what comes next.
SLICE_LINES = 100


class Sealed(Line):
    """A line that ends in a chain."""

    chain: Digest


class FirstLine(Sealed):
    """The first line."""

    format: str
    version: int
    physics_version: int
    sandbox_version: Digest
    level_sha256: Digest
    level_file: Annotated[str, Field(max_length=FILE_NAME_LIMIT)] = ""
    level: dict[str, Any]


class SealedCommand(Sealed, CommandLine):
    """A command at a tick, of a gesture."""


class TickLine(Sealed):
    """The hashes of a tick."""

    tick: Tick
    hash: Annotated[Digest, Field(min_length=TICK_DIGITS)]
    arrays: dict[str, Digest | None]


class _JoinedLine(Line):
    particle: Tick
    spring: Tick
    definition: dict[str, Any]


class StateLine(Sealed):
    """A stored state."""

    tick: Tick
    state: dict[str, str]
    settings: Settings
    joined: tuple[_JoinedLine, ...] = ()

    @field_validator("settings")
    @classmethod
    def _complete(cls, settings: Settings) -> Settings:
        if missing := [name for name in Settings.model_fields if name not in settings.model_fields_set]:
            raise ValueError(f"{', '.join(missing)}: missing")
        return settings


class WrittenLine(Sealed):
    """What was written into the world past the commands."""

    tick: Tick
    written: tuple[str, ...]


class EndLine(Sealed):
    """The last line."""

    end: bool
    tick: Tick
    hash: Digest


SealedLine = SealedCommand | TickLine | StateLine | WrittenLine | EndLine
# By the key that a Recorder writes behind the tick.
_KINDS: dict[bytes, type[SealedLine]] = {
    b"gesture": SealedCommand,
    b"command": SealedCommand,
    b"hash": TickLine,
    b"state": StateLine,
    b"written": WrittenLine,
    b"end": EndLine,
}


@dataclass
class _Gathered:
    """What was read of a recording of a version, whose level has this many particles and springs (slots)."""

    version: int
    slots: int
    retold: bool = False
    script: list[ScriptLine] = field(default_factory=list)
    hashes: list[TickHashes] = field(default_factory=list)
    states: dict[int, StoredState] = field(default_factory=dict)
    written: list[ByHand] = field(default_factory=list)
    end_hash: str | None = None
    # Most arrays stay as they are from tick to tick: each text is kept once, which halves the memory of a long replay.
    texts: dict[str, str] = field(default_factory=dict)
    # Hashes by array after the last tick line, "" for none, and arrays by name in the last stored state.
    _hashes_now: dict[str, str] = field(default_factory=lambda: dict.fromkeys(BY_STORED, ""))
    _state_now: dict[str, str] = field(default_factory=dict)

    @property
    def state_limit(self) -> int:
        """The most bytes of a line that stores a state."""
        return state_limit_of(self.slots)

    def add(self, line: "SealedLine", number: int, where: str) -> None:
        """Add one line to the recording that is read. Raises ReplayError where it does not fit there."""
        tick = len(self.hashes) - 1
        expected = tick + 1 if isinstance(line, TickLine) else tick
        if line.tick != expected:
            raise ReplayError(f"{where}: is of tick {line.tick}, where tick {expected} belongs")
        if isinstance(line, TickLine):
            self._add_hashes(line, where)
        elif isinstance(line, SealedCommand):
            self.script.append(ScriptLine(line.tick, line.gesture, line.command, number))
            kind = line.command.get("type")
            self.slots += PARTICLE_LIMIT + SPRING_LIMIT if kind == "add_body" else 1
        elif isinstance(line, StateLine):
            self._state_now = {**self._state_now, **{self._once(name): text for name, text in line.state.items()}}
            joined = tuple(each.model_dump() for each in line.joined)
            self.states[tick] = StoredState(self._state_now, WorldSettings(**dict(line.settings)), joined, number)
        elif isinstance(line, WrittenLine):
            self.written.append(ByHand(tick, line.written))
        else:
            self.end_hash = line.hash

    def _add_hashes(self, line: "TickLine", where: str) -> None:
        # A tick line tells of the few arrays that changed: only these are looked at.
        if self.version == 1:
            self._hashes_now = dict.fromkeys(BY_STORED, "")
        now = self._hashes_now
        now.update({name: self._once(digest or "") for name, digest in line.arrays.items()})
        is_known = len(now) == len(BY_STORED)
        if not self.retold and not (is_known and all(map(now.__getitem__, ALWAYS_STORED))):
            raise OtherPhysicsError(
                f"{where}: arrays: recorded by a version whose state has other arrays; record the run again"
            )
        self.hashes.append(TickHashes(line.hash, tuple(now.values())[: len(BY_STORED)]))

    def _once(self, text: str) -> str:
        """The text itself, or the equal one that is kept already."""
        return self.texts.setdefault(text, text)


def state_limit_of(slots: int) -> int:
    """The most bytes of a line that stores a state of this many particles and springs."""
    return STATE_BYTES + STATE_BYTES_A_SLOT * slots


def begins_as_replay(path: str | os.PathLike[str]) -> bool:
    """Whether a file's first bytes are a replay's, plain or compressed. Raises OSError."""
    with open(path, "rb") as file:
        start = file.read(64)
    return start.startswith(GZIP_MAGIC) or FORMAT.encode() in start


def read_replay(path: str | Path, partial: bool = False, retold: bool = False) -> Replay:
    """Read a replay file. partial: accept one that is cut off, as far as it goes.

    retold: accept one of another physics version, for its level and commands, which can be recorded again.
    Raises ReplayError, naming file and line, for anything that no Recorder wrote.
    """
    slices = read_in_slices(path, partial, retold)
    while True:
        try:
            next(slices)
        except StopIteration as end:
            return cast(Replay, end.value)


def read_in_slices(path: str | Path, partial: bool = False, retold: bool = False) -> Generator[None, None, Replay]:
    """As `read_replay`, some lines at a time."""
    source = str(path)
    lines = ReplayLines(Path(path))
    each = iter(lines)
    first = next(each, None)
    if first is None:
        raise ReplayError(f"{source}: the file is empty, not a replay")
    if not first.endswith(b"\n"):
        raise ReplayError(f"{source}: line 1: cut off before its end, or no recording")
    head, digest = _read_header(source, first, retold)
    level = level_of(source, head)
    keep_file(level, head.level_file)
    gathered = _Gathered(head.version, slots_of(level), retold)
    number = 1
    lines.state_limit = gathered.state_limit
    for number, line in enumerate(each, 2):
        where = f"{source}: line {number}"
        if gathered.end_hash is not None:
            raise ReplayError(f"{where}: follows the end line; cut it off")
        if not line.endswith(b"\n"):
            break
        sealed = unseal(line, digest, head.version)
        if sealed is None:
            raise ReplayError(f"{where}: changed or damaged: its chain does not fit; record the run again")
        digest = sealed
        gathered.add(parse_line(where, line), number, where)
        lines.state_limit = gathered.state_limit
        if number % SLICE_LINES == 0:
            yield
    _check_end(source, gathered, number, lines.cut, partial)
    return Replay(
        source, level, tuple(gathered.script), tuple(gathered.hashes), gathered.states, gathered.end_hash,
        head.physics_version, head.sandbox_version, tuple(gathered.written),
    )  # fmt: skip


def _check_end(source: str, gathered: _Gathered, number: int, cut: bool, partial: bool) -> None:
    last = len(gathered.hashes) - 1
    whole = gathered.end_hash is not None
    if last < 1 and not whole:
        raise ReplayError(f"{source}: cut off before tick 1: nothing to verify")
    if not whole and not partial:
        raise ReplayError(f"{source}: line {number}: cut off after tick {last}; --partial verifies what is there")
    if cut and not partial:
        raise ReplayError(f"{source}: its last bytes are cut off; --partial verifies what is there")


def _read_header(source: str, line: bytes, retold: bool) -> tuple[FirstLine, str]:
    where = f"{source}: line 1"
    if line.count(b",") > FILE_LIMIT // 2:
        raise ReplayError(f"{where}: holds more than a level may; it is no recording")
    if fault := scan(line):
        raise ReplayError(f"{where}: {fault[1]}")
    values = json_object(f"{where}: not a replay", line)
    if values.get("format") != FORMAT:
        raise ReplayError(f"{where}: not a replay: its format is not {FORMAT!r}")
    version = values.get("version")
    if type(version) is not int or version not in CHAIN_DIGITS:
        newer = "; it is newer: update the program" if type(version) is int and version > VERSION else ""
        known = " and ".join(map(str, CHAIN_DIGITS))
        raise ReplayError(f"{where}: replay version {version!r:.40}; this program reads {known}{newer}")
    physics = values.get("physics_version")
    if physics != PHYSICS_VERSION and not retold:
        raise OtherPhysicsError(
            f"{where}: recorded with physics version {physics!r:.40}; this program has {PHYSICS_VERSION}, "
            "which steps differently: verify it with the version that recorded it"
        )
    digest = unseal(line, "", version)
    if digest is None:
        raise ReplayError(f"{where}: changed or damaged: its chain does not fit; record the run again")
    return checked(where, FirstLine, line), digest


def level_of(source: str, head: FirstLine) -> Level:
    """The level of a first line. Raises ReplayError."""
    if level_digest(head.level) != head.level_sha256:
        raise ReplayError(f"{source}: line 1: the level is not the one that was recorded: its sha256 differs")
    try:
        return parse_level(_compact(head.level), f"{source}: line 1: level")
    except LevelError as error:
        raise ReplayError(*error.faults) from None


def _compact(level: dict[str, Any]) -> bytes:
    """A level as small as it gets, so that one which fits a level file fits here."""
    return json.dumps(level, ensure_ascii=False, separators=(",", ":")).encode(errors="surrogatepass")


def slots_of(level: Level) -> int:
    """Particles and springs of a level that was read."""
    counts = [body.count for body in (kept_plan(level) or Plan(level)).bodies]
    return len(level.particles) + len(level.springs) + sum(particles + springs for particles, springs in counts)


def parse_line(where: str, line: bytes) -> SealedLine:
    """A line behind the first. Raises ReplayError."""
    kind = _KINDS.get(kind_of(line))
    if kind is None:
        raise ReplayError(f"{where}: neither a command, a tick, a state nor the end")
    return checked(where, kind, line)
