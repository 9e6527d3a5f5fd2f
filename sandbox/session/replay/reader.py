"""Reading replay files: every line checked before it is believed, faults as one line each."""

import codecs
import io
import json
import os
import re
import shlex
import zlib
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, BinaryIO, ClassVar, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from sandbox.level.document.model import CHANGEABLE_SETTINGS, Level, Settings
from sandbox.level.format.foreign import CONFLICT, LFS_POINTER, scan
from sandbox.level.format.level_error import shown
from sandbox.level.format.limits import FILE_LIMIT, PARTICLE_LIMIT, SPRING_LIMIT
from sandbox.level.format.slices import at_once
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.reading.files import LevelError, keep_file, parse_level
from sandbox.level.reading.pictures import read_pictures
from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import ALWAYS_STORED, BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.faults import plain_fault
from sandbox.session.commands.records import UNNUMBERED, ScriptLine
from sandbox.session.replay import FORMAT
from sandbox.session.replay.format import CHAIN_DIGITS, TICK_DIGITS, VERSION, level_digest, unseal
from sandbox.session.replay.recording import ByHand, OtherPhysicsError, Replay, ReplayError, StoredState, TickHashes

# What a stored state may hold [bytes]: so much, and so much for each particle and spring. Shipped levels have up to 224
# bytes a slot, and a third more as base64.
STATE_BYTES, STATE_BYTES_A_SLOT = 2**20, 400
# The longest name of a file that systems have [characters].
FILE_NAME_LIMIT = 255
# Lines that are read at a time, where somebody waits for what comes next.
SLICE_LINES = 100
GZIP_MAGIC = b"\x1f\x8b"
# Compressed bytes that are read at a time.
_CHUNK = 64 * 1024
# A level of 8 MiB with every number written out and every character escaped.
HEADER_LIMIT = 32 * 2**20  # [bytes]
# What a command may hold, and any line but a stored state and the first [bytes]; the kind is told by the key behind the
# tick, where a Recorder writes it.
COMMAND_LIMIT = 2**20
TICK_LIMIT = 16 * 2**10
_BEGINNING = re.compile(rb'\{"(?:tick": [^,"]{1,20}, ")?(\w+)": ')
_LONGEST_BEGINNING = 64
Tick = Annotated[int, Field(ge=0, le=2**53)]
Digest = Annotated[str, Field(max_length=128)]
# What a script may hold: some hours of dragging, in [bytes] and lines.
SIZE_LIMIT = 32 * 2**20
LINE_LIMIT = 250_000
FAULT_LIMIT = 50  # that are told of one script


class Line(BaseModel):
    """The fields of a line; others are refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class CommandLine(Line):
    """A command at a tick, of a gesture."""

    tick: Tick
    gesture: Tick = 0
    command: dict[str, Any]


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
    run_with: tuple[Literal[CHANGEABLE_SETTINGS], ...] = ()  # type: ignore[valid-type]
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
    """Arrays that were written past the commands."""

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
    return at_once(read_in_slices(path, partial, retold))


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
    keep_file(level, head.level_file, head.run_with)
    gathered = _RecordingReading(slots_of(level), version=head.version, retold=retold)
    number = 1
    for number in gathered.read(source, lines, each, digest, head.version):
        if number % SLICE_LINES == 0:
            yield
    _check_end(source, gathered, number, lines.cut, partial)
    return Replay(
        source, level, tuple(gathered.script), tuple(gathered.hashes), gathered.states, gathered.end_hash,
        head.physics_version, head.sandbox_version, tuple(gathered.written),
    )  # fmt: skip


@dataclass
class RunReading:
    """Reads a file of sealed lines, a recording or a scene; slots: particles and springs of its world."""

    slots: int
    script: list[ScriptLine] = field(default_factory=list)
    has_ended: bool = False
    # Most texts stay as they are from line to line: each is kept once, which halves the memory of a long recording.
    _texts: dict[str, str] = field(default_factory=dict)
    # Arrays by name in the last stored state.
    _state_now: dict[str, str] = field(default_factory=dict)
    remedy: ClassVar[str] = ""

    def read(
        self, source: str, lines: "ReplayLines", each: Iterator[bytes], digest: str, version: int
    ) -> Iterator[int]:
        """Take in the lines behind the first, each checked; their numbers. Ends before a line that is cut off.

        digest: of the first; version: of the chain. Raises ReplayError.
        """
        lines.state_limit = self._state_limit
        for number, line in enumerate(each, 2):
            where = f"{source}: line {number}"
            if self.has_ended:
                raise ReplayError(f"{where}: follows the end line; cut it off")
            if not line.endswith(b"\n"):
                yield number
                return
            sealed = unseal(line, digest, version)
            if sealed is None:
                raise ReplayError(f"{where}: changed or damaged: its chain does not fit{self.remedy}")
            digest = sealed
            kind = _KINDS.get(kind_of(line))
            if kind is None:
                raise ReplayError(f"{where}: neither a command, a tick, a state nor the end")
            self.add(checked(where, kind, line), number, where)
            lines.state_limit = self._state_limit
            yield number

    def add(self, line: SealedLine, number: int, where: str) -> None:
        """Read one line. Raises ReplayError where it does not fit there."""
        if isinstance(line, SealedCommand):
            self.script.append(ScriptLine(line.tick, line.gesture, line.command, number))
            self.slots += PARTICLE_LIMIT + SPRING_LIMIT if line.command.get("type") == "add_body" else 1
        self.has_ended = isinstance(line, EndLine)

    def stored(self, line: StateLine, number: int) -> StoredState:
        """The state of a line, completed by the one before it."""
        self._state_now = {**self._state_now, **{self._once(name): text for name, text in line.state.items()}}
        joined = tuple(each.model_dump() for each in line.joined)
        return StoredState(self._state_now, WorldSettings(**dict(line.settings)), joined, number)

    def _once(self, text: str) -> str:
        return self._texts.setdefault(text, text)

    @property
    def _state_limit(self) -> int:
        """The most bytes of a line that stores a state."""
        return STATE_BYTES + STATE_BYTES_A_SLOT * self.slots


@dataclass
class _RecordingReading(RunReading):
    """Reads a recording, whose chain of hashes is of a version; retold: see read_replay."""

    version: int = VERSION
    retold: bool = False
    hashes: list[TickHashes] = field(default_factory=list)
    states: dict[int, StoredState] = field(default_factory=dict)
    written: list[ByHand] = field(default_factory=list)
    end_hash: str | None = None
    # Hashes by array after the last tick line, "" for none.
    _hashes_now: dict[str, str] = field(default_factory=lambda: dict.fromkeys(BY_STORED, ""))
    remedy: ClassVar[str] = "; record the run again"

    def add(self, line: SealedLine, number: int, where: str) -> None:
        """Read one line. Raises ReplayError where it does not fit there."""
        tick = len(self.hashes) - 1
        expected = tick + 1 if isinstance(line, TickLine) else tick
        if line.tick != expected:
            raise ReplayError(f"{where}: is of tick {line.tick}, where tick {expected} belongs")
        super().add(line, number, where)
        if isinstance(line, TickLine):
            self._add_hashes(line, where)
        elif isinstance(line, StateLine):
            self.states[tick] = self.stored(line, number)
        elif isinstance(line, WrittenLine):
            self.written.append(ByHand(tick, line.written))
        elif isinstance(line, EndLine):
            self.end_hash = line.hash

    def _add_hashes(self, line: TickLine, where: str) -> None:
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


def _check_end(source: str, gathered: _RecordingReading, number: int, cut: bool, partial: bool) -> None:
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
    values = opened(where, line, "replay", FORMAT, tuple(CHAIN_DIGITS))
    physics = values.get("physics_version")
    if physics != PHYSICS_VERSION and not retold:
        raise OtherPhysicsError(
            f"{where}: recorded with physics version {physics!r:.40}; this program has {PHYSICS_VERSION}, "
            "which steps differently: verify it with the version that recorded it"
        )
    digest = unseal(line, "", values["version"])
    if digest is None:
        raise ReplayError(f"{where}: changed or damaged: its chain does not fit; record the run again")
    return checked(where, FirstLine, line), digest


def opened(where: str, line: bytes, noun: str, form: str, versions: Sequence[int]) -> dict[str, Any]:
    """The values of the first line of a recording or a scene, as the noun says. Raises ReplayError."""
    if line.count(b",") > FILE_LIMIT // 2:
        raise ReplayError(f"{where}: holds more than a level may; it is no recording")
    if fault := scan(line):
        raise ReplayError(f"{where}: {fault[1]}")
    values = json_object(f"{where}: not a {noun}", line)
    if values.get("format") != form:
        raise ReplayError(f"{where}: not a {noun}: its format is not {form!r}")
    version = values.get("version")
    if type(version) is not int or version not in versions:
        newer = "; it is newer: update the program" if type(version) is int and version > max(versions) else ""
        known = " and ".join(map(str, versions))
        raise ReplayError(f"{where}: {noun} version {version!r:.40}; this program reads {known}{newer}")
    return values


def level_of(source: str, head: FirstLine) -> Level:
    """The level of a first line. Raises ReplayError."""
    if level_digest(head.level) != head.level_sha256:
        raise ReplayError(f"{source}: line 1: the level is not the one that was recorded: its sha256 differs")
    try:
        level = parse_level(_compact(head.level), f"{source}: line 1: level")
        read_pictures(level, Path(source).parent, source, has_all=False)
        return level
    except LevelError as error:
        raise ReplayError(*error.faults) from None


def _compact(level: dict[str, Any]) -> bytes:
    """A level as small as it gets, so that one which fits a level file fits here."""
    return json.dumps(level, ensure_ascii=False, separators=(",", ":")).encode(errors="surrogatepass")


def slots_of(level: Level) -> int:
    """Particles and springs of a level that was read."""
    counts = [body.count for body in (kept_plan(level) or Plan(level)).bodies]
    return len(level.particles) + len(level.springs) + sum(particles + springs for particles, springs in counts)


def read_script(path: str | Path) -> tuple[ScriptLine, ...]:
    """Read a file of command lines as a replay has them, without hashes: {"tick": 12, "command": {...}}.

    A line without a gesture is a gesture of its own. Raises ReplayError, one line per fault, at most 50.
    """
    source = str(path)
    try:
        if Path(path).stat().st_size > SIZE_LIMIT:
            raise ReplayError(f"{source}: larger than {SIZE_LIMIT // 2**20} MiB")
        return _read(source, Path(path))
    except (OSError, ValueError) as error:
        if isinstance(error, ReplayError):
            raise
        raise ReplayError(f"{source}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _read(source: str, path: Path) -> tuple[ScriptLine, ...]:
    faults: list[str] = []
    script: list[ScriptLine] = []
    for number, line in _lines(source, path):
        if len(faults) >= FAULT_LIMIT:
            break
        where = f"{source}: line {number}"
        try:
            if len(line) > COMMAND_LIMIT:
                raise ReplayError(f"{where}: longer than {COMMAND_LIMIT} bytes")
            parsed = checked(where, CommandLine, line)
        except ReplayError as error:
            faults.extend(error.faults)
        else:
            script.append(ScriptLine(parsed.tick, parsed.gesture or UNNUMBERED + number, parsed.command, number))
    if faults:
        raise ReplayError(*faults[:FAULT_LIMIT])
    return tuple(sorted(script, key=lambda line: line.tick))


def _lines(source: str, path: Path) -> Iterator[tuple[int, bytes]]:
    """Lines that hold something, by number, each read no further than it is too long."""
    with open(path, "rb") as file:
        number = 0
        while line := file.readline(COMMAND_LIMIT + 1):
            while len(line) > COMMAND_LIMIT and not line.endswith(b"\n"):
                rest = file.readline(COMMAND_LIMIT)
                line = line[:COMMAND_LIMIT] + (rest[-1:] or b"\n")
            number += 1
            if number > LINE_LIMIT:
                raise ReplayError(f"{source}: more than {LINE_LIMIT:,} lines")
            if line.strip():
                yield number, _as_written(path, number, line)


def _as_written(path: Path, number: int, line: bytes) -> bytes:
    """A line without what editors and git add on Windows. Raises ReplayError at a merge conflict."""
    if CONFLICT.match(line):
        raise ReplayError(
            f"{path}: line {number}: a merge conflict of git; take one side whole: git checkout --ours "
            f"{shlex.quote(str(path))}; if a recording then differs from its level, record it again"
        )
    if number == 1:
        line = line.removeprefix(codecs.BOM_UTF8)
    return line[:-2] + b"\n" if line.endswith(b"\r\n") else line


class ReplayLines:
    """The lines of a file; iterated once. cut: whether the compressed data have ended early, when all were given out.

    state_limit: of a line that stores a state [bytes], set once the level is known.
    Raises ReplayError for what cannot be read, is damaged, or is too long for what it is.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.cut = False
        self.state_limit = TICK_LIMIT

    def __iter__(self) -> Iterator[bytes]:
        try:
            with open(self.path, "rb") as raw:
                start = raw.read(len(LFS_POINTER))
                raw.seek(0)
                if start == LFS_POINTER:
                    raise ReplayError(f"{self.path}: is a Git LFS pointer, not the recording: git lfs pull fetches it")
                if not start.startswith(GZIP_MAGIC):
                    if self.path.suffix == ".gz" and start and not start.startswith(b"{"):
                        raise ReplayError(f"{self.path}: damaged gzip data: it does not begin as gzip does")
                    yield from self._limited(raw)
                    return
                inflated = _Inflated(raw)
                yield from self._limited(io.BufferedReader(inflated, _CHUNK))
                self.cut = inflated.cut
        except zlib.error as error:
            raise ReplayError(f"{self.path}: damaged gzip data: {error}") from None
        except ReplayError:
            raise
        except (OSError, ValueError) as error:
            raise ReplayError(f"{self.path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None

    def _limited(self, file: BinaryIO) -> Iterator[bytes]:
        number, limit = 1, HEADER_LIMIT
        while line := file.readline(limit + 1 if number == 1 else _LONGEST_BEGINNING):
            if number > 1 and not line.endswith(b"\n"):
                limit = self._limit(line)
                line += file.readline(limit + 1 - len(line))
            if len(line) > limit:
                raise ReplayError(f"{self.path}: line {number}: longer than {limit} bytes")
            yield _as_written(self.path, number, line)
            number += 1

    def _limit(self, beginning: bytes) -> int:
        limits = {b"gesture": COMMAND_LIMIT, b"command": COMMAND_LIMIT, b"state": self.state_limit}
        return limits.get(kind_of(beginning), TICK_LIMIT)


def kind_of(line: bytes) -> bytes:
    """The first key of a line that is not its tick, where it is written as a Recorder does; else nothing."""
    found = _BEGINNING.match(line)
    return found[1] if found else b""


class _Inflated(io.RawIOBase):
    """Data out of gzip. cut: whether they ended before their end. Raises ValueError where more follows it."""

    def __init__(self, raw: BinaryIO) -> None:
        self.cut = False
        self._raw = raw
        self._inflater = zlib.decompressobj(16 + zlib.MAX_WBITS)

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        while not self._inflater.eof:
            packed = self._inflater.unconsumed_tail or self._raw.read(_CHUNK)
            data = self._inflater.decompress(packed, len(buffer))
            if data:
                buffer[: len(data)] = data
                return len(data)
            if not packed:
                self.cut = True
                return 0
        if self._inflater.unused_data or self._raw.read(1):
            raise ValueError("bytes follow the end of the compressed data; cut them off")
        return 0


def json_object(where: str, line: bytes) -> dict[str, Any]:
    """The JSON object that a line is. Raises ReplayError for anything else, and for a key that stands twice in it."""
    try:
        values = json.loads(line, object_pairs_hook=_distinct)
    except _RepeatedKeyError as error:
        raise ReplayError(f"{where}: {error}") from None
    except (ValueError, RecursionError):
        raise ReplayError(f"{where}: not a line of JSON") from None
    if not isinstance(values, dict):
        raise ReplayError(f"{where}: not a JSON object")
    return values


class _RepeatedKeyError(Exception):
    pass


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for key, value in pairs:
        if key in values:
            raise _RepeatedKeyError(f"{shown(key)}: this key stands here more than once; keep one")
        values[key] = value
    return values


AnyLine = TypeVar("AnyLine", bound=Line)


def checked(where: str, kind: type[AnyLine], line: bytes) -> AnyLine:
    """A line's fields, checked; of a command no key may stand twice anywhere. Raises ReplayError."""
    try:
        if issubclass(kind, CommandLine):
            return kind.model_validate(json_object(where, line))
        return kind.model_validate_json(line)
    except ValidationError as error:
        raise ReplayError(f"{where}: {plain_fault(error)}") from None
