"""Recorder: writes a replay file as a run happens."""

import gzip
import io
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import slot_name
from sandbox.physics.snapshot import Left, hash_by_array, leave, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.replay.format import ARRAY_DIGITS, STATE_TICKS, TICK_DIGITS, encode_state, header, seal
from sandbox.session.replay.recording import ByHand
from sandbox.version import __version__

# Ticks after which what is compressed reaches the file: a second of the usual rate.
FLUSH_TICKS = 60
GZIP_LEVEL = 9


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
            self._write(header(level, PHYSICS_VERSION, __version__))
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
        told = hashes if storing else [name for name in BY_STORED if hashes.get(name) != before.get(name)]
        arrays = {name: hashes[name][:ARRAY_DIGITS] if name in hashes else None for name in told}
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
        """Close the file as it is."""
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
