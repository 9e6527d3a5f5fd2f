"""A recorded run: `Replay`, as a file holds it, `Recorder`, which writes it as it happens, and its text for people."""

import gzip
import io
import json
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import file_of, run_with
from sandbox.physics.analysis.query import slot_name
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Left, Snapshot, hash_by_array, leave, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import UNNUMBERED, ScriptLine
from sandbox.session.level_edits import with_settings
from sandbox.session.replay.format import (
    ARRAY_DIGITS,
    STATE_LIMIT,
    STATE_TICKS,
    TICK_DIGITS,
    decode_state,
    encode_state,
    header,
    seal,
)

# Ticks after which what is compressed reaches the file: a second of the usual rate.
FLUSH_TICKS = 60
GZIP_LEVEL = 9


class ReplayError(ValueError):
    """A replay or script that cannot be used; faults: one line each."""

    def __init__(self, *faults: str) -> None:
        super().__init__("\n".join(faults))
        self.faults = list(faults)


class OtherPhysicsError(ReplayError):
    """A recording that another physics version made, which this one can only record again."""


@dataclass(frozen=True, slots=True)
class TickHashes:
    """The hashes of the state after a tick: the first digits of the whole hash, and of the hash of each array.

    arrays: in the order of the table; nothing for one that is not in use.
    """

    whole: str
    arrays: tuple[str, ...]

    def fits(self, whole: str) -> bool:
        """Whether a state of this hash is the recorded one."""
        return whole.startswith(self.whole)

    @classmethod
    def of(cls, world: World) -> "TickHashes":
        """All hexadecimal digits of the hashes of a world."""
        by_array = hash_by_array(world)
        return cls(state_hash(world, by_array), tuple(by_array.get(name, "") for name in BY_STORED))

    def agrees(self, other: "TickHashes") -> bool:
        """Whether both may be of one state, by the digits that both have."""
        return self.whole[: len(other.whole)] == other.whole[: len(self.whole)]

    def unlike(self, other: "TickHashes") -> list[str]:
        """The arrays, in the order of hashing, that are others in the state of other hashes."""
        pairs = zip(BY_STORED, self.arrays, other.arrays, strict=True)
        return [name for name, a, b in pairs if a[: len(b) or None] != b[: len(a) or None]]


@dataclass(frozen=True)
class StoredState:
    """A state line: arrays as text, see format.decode_state; joined: what joined; line: where it stands in its file."""

    arrays: dict[str, str]
    settings: WorldSettings
    joined: tuple[dict[str, Any], ...]
    line: int

    def of(self, level: Level, tick: int, most: int = STATE_LIMIT) -> Snapshot:
        """The state at that tick of a run of the level, of so many bytes at most. Raises ValueError, one line."""
        return decode_state(level, tick, self.arrays, self.settings, self.joined, most)


@dataclass(frozen=True)
class ByHand:
    """Arrays that were written into a recorded world past its commands, after so many ticks; no run can repeat that."""

    tick: int
    what: tuple[str, ...]

    def __str__(self) -> str:
        return (
            f"at tick {self.tick} a program wrote {', '.join(self.what)} by hand, which no run repeats: "
            "do it with a command"
        )


@dataclass(frozen=True)
class Replay:
    """A recorded run: hashes[t] is the state after t ticks; end_hash is None where the file is cut off.

    physics_version, sandbox_version: of the program that recorded it. written: what was written into its world by hand.
    """

    source: str
    level: Level
    script: tuple[ScriptLine, ...]
    hashes: tuple[TickHashes, ...]
    states: dict[int, StoredState]
    end_hash: str | None
    physics_version: int = PHYSICS_VERSION
    sandbox_version: str = ""
    written: tuple[ByHand, ...] = ()

    @property
    def is_of_this_physics(self) -> bool:
        """Whether the recording was made by the physics version of this program."""
        return self.physics_version == PHYSICS_VERSION

    @property
    def ticks(self) -> int:
        """Ticks recorded."""
        return len(self.hashes) - 1

    def on(self, level: Level | None) -> Level:
        """The level of a run of its commands: its own, or another with the settings that the recording was run with.

        Raises ReplayError where the other cannot have them.
        """
        if level is None or level is self.level:
            return self.level
        names = [name for name in run_with(self.level) if name not in run_with(level)]
        settings = {name: getattr(self.level.settings, name) for name in names}
        try:
            return with_settings(level, settings, self.source) if settings else level
        except LevelError as error:
            raise ReplayError(*error.faults) from None

    @property
    def compared(self) -> str:
        """The part of a run to compare: every tick, or of a link, which has no hashes of ticks, its end."""
        return "every tick" if self.hashes[0].whole else "its end"

    def fits(self, world: World) -> bool:
        """Whether a run of it is as recorded, by the hashes that there are of its tick."""
        present = state_hash(world)
        ends = world.tick == self.ticks and self.end_hash is not None
        return self.hashes[world.tick].fits(present) and (not ends or present == self.end_hash)

    def state(self, tick: int) -> Snapshot:
        """The stored state of a tick. Raises ReplayError where there is none, or one that its own hash belies."""
        stored = self.states.get(tick)
        if stored is None:
            raise ReplayError(f"{self.source}: no state is stored at tick {tick}")
        try:
            snapshot = stored.of(self.level, tick)
        except ValueError as error:
            raise ReplayError(f"{self.source}: line {stored.line}: {error}") from None
        if not self.hashes[tick].fits(state_hash(snapshot)):
            raise ReplayError(
                f"{self.source}: line {stored.line}: state: is not the one whose hash stands at tick {tick}"
            )
        return snapshot


@contextmanager
def faults_of(replay: Replay) -> Iterator[None]:
    """Say of which recording a command cannot be carried out. Raises ReplayError."""
    try:
        yield
    except CommandError as error:
        raise ReplayError(*(f"{replay.source}: {fault}" for fault in error.faults)) from None


class Recorder:
    """Writes one run to a file, from the level's first tick; a name ending in .gz is compressed.

    Every line reaches the file when it is written (compressed: every 60 ticks), so that a crash leaves a recording
    that is only cut off. state_ticks: from one stored state to the next.
    Raises OSError where the file cannot be written.
    """

    def __init__(self, path: Path, level: Level, world: World, state_ticks: int = STATE_TICKS) -> None:
        self.path = Path(path)
        self._chain = ""
        self._state_ticks = state_ticks
        # The world as a tick or a command left it last.
        self._left = leave(world, hash_by_array(world))
        # Of the last tick, and of the last stored state: hashes by array, and there the rows of each too.
        self._hashes: dict[str, str] = {}
        self._stored: dict[str, tuple[str | None, int]] = {}
        # Whether the state is still the one whose hashes were written last, and not stored.
        self._is_storable = False
        raw = self._raw = io.FileIO(self.path, "wb")
        # No name and no time in the compressed header, so that the same run gives the same bytes.
        self._file: BinaryIO | gzip.GzipFile = (
            gzip.GzipFile(filename="", mode="wb", compresslevel=GZIP_LEVEL, fileobj=raw, mtime=0)
            if self.path.suffix == ".gz"
            else io.BufferedWriter(raw)
        )
        try:
            self._write(header(level))
            self.write_tick(world)
        except OSError as error:
            self.abandon()
            # What has not even begun is no recording; a device is not for taking away.
            with suppress(OSError):
                if self.path.is_file():
                    self.path.unlink()
            error.filename = str(self.path)
            raise

    def write_command(self, world: World, gesture: int, record: dict[str, Any]) -> None:
        """Write a command that was applied to the world, before its step."""
        self._is_storable = False
        self._write({"tick": world.tick, "gesture": gesture, "command": record})
        self._left = leave(world, hash_by_array(world))

    def write_tick(self, world: World) -> None:
        """Write what changed in the hashes of the present state, and now and then the state itself."""
        hashes, before = hash_by_array(world), self._hashes
        storing = world.tick % self._state_ticks == 0
        names = hashes if storing else [name for name in BY_STORED if hashes.get(name) != before.get(name)]
        arrays = {name: hashes[name][:ARRAY_DIGITS] if name in hashes else None for name in names}
        self._hashes = hashes
        self._left = leave(world, hashes)
        whole = state_hash(world, hashes)
        self._write({"tick": world.tick, "hash": whole if storing else whole[:TICK_DIGITS], "arrays": arrays})
        self._is_storable = not storing
        if storing:
            self._write_state(world, hashes)
        if world.tick % FLUSH_TICKS == 0 and isinstance(self._file, gzip.GzipFile):
            self._file.flush(zlib.Z_SYNC_FLUSH)

    def note_written(self, world: World) -> str | None:
        """Write what was written into the world since a command or a tick left it; in words, None where nothing was."""
        left = self._left
        names = left.written(world)
        if not names:
            return None
        self._left = leave(world, hash_by_array(world))
        self._is_storable = False
        written = ByHand(world.tick, tuple(_place(name, left, world) for name in names))
        self._write({"tick": world.tick, "written": written.what})
        return str(written)

    def _write_state(self, world: World, hashes: dict[str, str]) -> None:
        present = {name: (hashes.get(name), len(getattr(world, column.name))) for name, column in BY_STORED.items()}
        changed = [name for name in BY_STORED if present[name] != self._stored.get(name)]
        self._stored = present
        self._write({"tick": world.tick, **encode_state(world, changed)})

    def finish(self, world: World) -> None:
        """Write the last state and the last line, and close the file."""
        try:
            if self._is_storable:
                self._write_state(world, self._hashes)
            self._write({"end": True, "tick": world.tick, "hash": state_hash(world)})
            self._file.close()
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Close the file without an end line."""
        for file in (self._file, self._raw):
            with suppress(OSError):
                file.close()

    def _write(self, values: dict[str, Any]) -> None:
        line, self._chain = seal(values, self._chain)
        self._file.write(line)
        if not isinstance(self._file, gzip.GzipFile):
            self._file.flush()


def _place(array: str, left: Left, world: World) -> str:
    """An array by its name in files, with the first place in it whose bytes are other, where they are known."""
    before = left.kept[array][0] if array in left.kept else None
    if array not in BY_STORED:
        return array
    values = getattr(world, BY_STORED[array].name)
    if before is None or len(before) != values.nbytes or not len(values):
        return array
    row = values.nbytes // len(values)
    present = np.frombuffer(values.tobytes(), dtype=f"V{row}")
    different = np.flatnonzero(present != np.frombuffer(before, dtype=f"V{row}"))
    if not len(different):
        return array
    name = slot_name(world, array, int(different[0]))
    more = f" and {len(different) - 1} more" if len(different) > 1 else ""
    return f"{array}[{different[0]}]" + (f" ({name})" if name else "") + more


def recording_text(replay: Replay) -> str:
    """The lines of a recording as one text, the hash of its end last."""
    return "".join(f"{line}\n" for line in _lines(replay))


def commands_text(replay: Replay) -> str:
    """The commands alone, a JSON object a line, as `sandbox run --commands` takes them."""
    return "".join(f"{line}\n" for line in _command_lines(replay))


def _lines(replay: Replay) -> Iterator[str]:
    name = file_of(replay.level)
    yield f"recording of {name + ', ' if name else ''}{json.dumps(replay.level.name, ensure_ascii=False)}"
    yield f"physics version {replay.physics_version}, recorded by version {replay.sandbox_version}"
    chosen = [f"{each} {getattr(replay.level.settings, each)}" for each in run_with(replay.level)]
    yield from [f"run with {', '.join(chosen)}"] if chosen else []
    yield ""
    yield "level"
    yield level_text(replay.level).rstrip("\n")
    yield ""
    yield f"commands: {len(replay.script) or 'none'}"
    yield from _command_lines(replay)
    yield ""
    yield from map(str, replay.written)
    seconds = replay.ticks / replay.level.settings.tick_rate
    whole = replay.end_hash is not None
    yield f"{'ends' if whole else 'cut off'} after tick {replay.ticks}, {seconds:g} s"
    yield f"hash {replay.end_hash if whole else replay.hashes[-1].whole}"


def _command_lines(replay: Replay) -> Iterator[str]:
    for line in replay.script:
        gesture = {"gesture": line.gesture} if line.gesture < UNNUMBERED else {}
        yield json.dumps({"tick": line.tick, **gesture, "command": line.record}, ensure_ascii=False)
