"""Reading replay and script files: every line checked before it is believed, faults as one line each."""

import gzip
import json
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, BinaryIO

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from sandbox.level.format.files import LevelError, parse_level
from sandbox.level.format.model import Settings
from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import ALWAYS_STORED, BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.command import plain_fault
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import FORMAT, HEADER_LIMIT, LINE_LIMIT, VERSION, level_digest, unseal
from sandbox.session.replay.recording import Replay, ReplayError, StoredState, TickHashes

GZIP_MAGIC = b"\x1f\x8b"
# The header that a Recorder writes: no flags, no time, no name; another one is a changed byte.
GZIP_HEADER = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\xff"
SCRIPT_SIZE_LIMIT = 64 * 2**20  # [bytes]
FAULT_LIMIT = 50  # that are told of one script
# Gestures that a script does not number are numbered by line from here, beyond those that it does.
UNNUMBERED = 2**40

Tick = Annotated[int, Field(ge=0, le=2**53)]
Digest = Annotated[str, Field(max_length=128)]


class _Line(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class _CommandLine(_Line):
    tick: Tick
    gesture: Tick = 0
    command: dict[str, Any]


class _Sealed(_Line):
    chain: Digest


class _Header(_Sealed):
    format: str
    version: int
    physics_version: int
    sandbox_version: Digest
    level_sha256: Digest
    level: dict[str, Any]


class _SealedCommand(_Sealed, _CommandLine):
    pass


class _TickLine(_Sealed):
    tick: Tick
    hash: Digest
    arrays: dict[str, Digest]


class _JoinedLine(_Line):
    particle: Tick
    spring: Tick
    definition: dict[str, Any]


class _StateLine(_Sealed):
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


class _EndLine(_Sealed):
    end: bool
    tick: Tick
    hash: Digest


_KINDS: dict[str, type[_Sealed]] = {
    "command": _SealedCommand,
    "arrays": _TickLine,
    "state": _StateLine,
    "end": _EndLine,
}


@dataclass
class _Gathered:
    script: list[ScriptLine] = field(default_factory=list)
    hashes: list[TickHashes] = field(default_factory=list)
    states: dict[int, StoredState] = field(default_factory=dict)
    end_hash: str | None = None
    # Most arrays stay as they are from tick to tick: each text is kept once, which halves the memory of a long replay.
    texts: dict[str, str] = field(default_factory=dict)

    def once(self, text: str) -> str:
        """The text itself, or the equal one that is kept already."""
        return self.texts.setdefault(text, text)


def begins_as_replay(path: str | os.PathLike[str]) -> bool:
    """Whether a file's first bytes are a replay's, plain or compressed. Raises OSError."""
    with open(path, "rb") as file:
        start = file.read(64)
    return start.startswith(GZIP_MAGIC) or FORMAT.encode() in start


def read_replay(path: str | Path, partial: bool = False) -> Replay:
    """Read a replay file. partial: accept one that is cut off, as far as it goes.

    Raises ReplayError, naming file and line, for anything that a Recorder of this version did not write.
    """
    source = str(path)
    lines = _lines(Path(path))
    first = next(lines, None)
    if first is None:
        raise ReplayError(f"{source}: the file is empty, not a replay")
    head, chain = _read_header(source, first)
    level = _read_level(source, head)
    gathered = _Gathered()
    number = 1
    for line in lines:
        number += 1
        where = f"{source}: line {number}"
        if gathered.end_hash is not None:
            raise ReplayError(f"{where}: follows the end line; cut it off")
        if not line.endswith(b"\n"):
            break
        sealed = unseal(line, chain)
        if sealed is None:
            raise ReplayError(f"{where}: changed or damaged: its chain does not fit; record the run again")
        chain = sealed
        _gather(gathered, _parse(where, line), number, where)
    if not gathered.hashes:
        raise ReplayError(f"{source}: cut off before tick 0: nothing to verify")
    if gathered.end_hash is None and not partial:
        last = len(gathered.hashes) - 1
        raise ReplayError(f"{source}: line {number}: cut off after tick {last}; --partial verifies what is there")
    return Replay(source, level, tuple(gathered.script), tuple(gathered.hashes), gathered.states, gathered.end_hash)


def _lines(path: Path) -> Iterator[bytes]:
    """The file's lines, decompressed where it is gzip; a cut-off compressed stream just ends."""
    try:
        with open(path, "rb") as raw:
            start = raw.read(len(GZIP_HEADER))
            raw.seek(0)
            if start[:2] != GZIP_MAGIC:
                yield from _limited(path, raw)
                return
            if start != GZIP_HEADER[: len(start)]:
                raise ReplayError(f"{path}: line 1: the gzip header is not one that a recording has")
            with gzip.GzipFile(fileobj=raw, mode="rb") as unzipped:
                yield from _limited(path, unzipped)
    except EOFError:
        return
    except (gzip.BadGzipFile, zlib.error) as error:
        raise ReplayError(f"{path}: damaged gzip data: {error}") from None
    except (OSError, ValueError) as error:
        if isinstance(error, ReplayError):
            raise
        raise ReplayError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _limited(path: Path, file: BinaryIO | gzip.GzipFile) -> Iterator[bytes]:
    number, limit = 1, HEADER_LIMIT
    while line := file.readline(limit + 1):
        if len(line) > limit:
            raise ReplayError(f"{path}: line {number}: longer than {limit} bytes")
        yield line
        number, limit = number + 1, LINE_LIMIT


def _read_header(source: str, line: bytes) -> tuple[_Header, str]:
    where = f"{source}: line 1"
    values = _object(where, line)
    if values.get("format") != FORMAT:
        raise ReplayError(f"{where}: not a replay: its format is not {FORMAT!r}")
    if values.get("version") != VERSION:
        raise ReplayError(
            f"{where}: replay version {values.get('version')!r:.40}; this program reads version {VERSION}"
        )
    physics = values.get("physics_version")
    if physics != PHYSICS_VERSION:
        raise ReplayError(
            f"{where}: recorded with physics version {physics!r:.40}; this program has {PHYSICS_VERSION}, "
            "which steps differently: verify it with the version that recorded it"
        )
    chain = unseal(line, "")
    if chain is None:
        raise ReplayError(f"{where}: changed or damaged: its chain does not fit; record the run again")
    return _validated(where, _Header, line), chain


def _read_level(source: str, head: _Header) -> Any:
    if level_digest(head.level) != head.level_sha256:
        raise ReplayError(f"{source}: line 1: the level is not the one that was recorded: its sha256 differs")
    try:
        return parse_level(_compact(head.level), f"{source}: line 1: level")
    except LevelError as error:
        raise ReplayError(*error.faults) from None


def _compact(level: dict[str, Any]) -> bytes:
    """A level as small as it gets, so that one which fits a level file fits here."""
    return json.dumps(level, ensure_ascii=False, separators=(",", ":")).encode(errors="surrogatepass")


def _object(where: str, line: bytes) -> dict[str, Any]:
    try:
        values = json.loads(line)
    except (ValueError, RecursionError):
        raise ReplayError(f"{where}: not a line of JSON") from None
    if not isinstance(values, dict):
        raise ReplayError(f"{where}: not a JSON object")
    return values


def _validated(where: str, kind: type[Any], line: bytes) -> Any:
    try:
        return kind.model_validate_json(line)
    except ValidationError as error:
        raise ReplayError(f"{where}: {plain_fault(error)}") from None


def _parse(where: str, line: bytes) -> _Sealed:
    values = _object(where, line)
    kind = next((kind for key, kind in _KINDS.items() if key in values), None)
    if kind is None:
        raise ReplayError(f"{where}: neither a command, a tick, a state nor the end")
    return _validated(where, kind, line)


def _gather(gathered: _Gathered, line: _Sealed, number: int, where: str) -> None:
    """Add one line to what was read, if it fits there."""
    tick = len(gathered.hashes) - 1
    expected = tick + 1 if isinstance(line, _TickLine) else tick
    if line.tick != expected:  # type: ignore[attr-defined]
        raise ReplayError(f"{where}: is of tick {line.tick}, where tick {expected} belongs")  # type: ignore[attr-defined]
    if isinstance(line, _TickLine):
        if not ALWAYS_STORED <= line.arrays.keys() <= BY_STORED.keys():
            raise ReplayError(
                f"{where}: arrays: recorded by a version whose state has other arrays; record the run again"
            )
        hashes = tuple(gathered.once(line.arrays.get(name, "")) for name in BY_STORED)
        gathered.hashes.append(TickHashes(line.hash, hashes))
    elif isinstance(line, _SealedCommand):
        gathered.script.append(ScriptLine(line.tick, line.gesture, line.command, number))
    elif isinstance(line, _StateLine):
        arrays = {gathered.once(name): gathered.once(text) for name, text in line.state.items()}
        gathered.states[tick] = StoredState(
            arrays, WorldSettings(**dict(line.settings)), tuple(each.model_dump() for each in line.joined), number
        )
    elif isinstance(line, _EndLine):
        gathered.end_hash = line.hash


def read_script(path: str | Path) -> tuple[ScriptLine, ...]:
    """Read a file of command lines as a replay has them, without hashes: {"tick": 12, "command": {...}}.

    A line without a gesture is a gesture of its own. Raises ReplayError, one line per fault, at most 50.
    """
    source = str(path)
    faults: list[str] = []
    script: list[ScriptLine] = []
    try:
        with open(path, "rb") as file:
            data = file.read(SCRIPT_SIZE_LIMIT + 1)
    except (OSError, ValueError) as error:
        raise ReplayError(f"{source}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(data) > SCRIPT_SIZE_LIMIT:
        raise ReplayError(f"{source}: larger than {SCRIPT_SIZE_LIMIT} bytes")
    for number, line in enumerate(data.splitlines(), 1):
        if not line.strip():
            continue
        if len(faults) >= FAULT_LIMIT:
            break
        try:
            _object(f"{source}: line {number}", line)
            parsed = _validated(f"{source}: line {number}", _CommandLine, line)
            script.append(ScriptLine(parsed.tick, parsed.gesture or UNNUMBERED + number, parsed.command, number))
        except ReplayError as error:
            faults.extend(error.faults)
    if faults:
        raise ReplayError(*faults[:FAULT_LIMIT])
    return tuple(sorted(script, key=lambda line: line.tick))
