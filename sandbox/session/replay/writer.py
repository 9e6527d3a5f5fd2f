"""Recorder: writes a replay file as a run happens."""

import gzip
import io
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from sandbox import __version__
from sandbox.level.format.model import Level
from sandbox.physics.snapshot import hash_by_array, state_hash
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.replay.format import STATE_TICKS, encode_state, header, seal


class Recorder:
    """Writes one run to a file, from the level's first tick; a name ending in .gz is compressed.

    Every line reaches the file when it is written (compressed: at every state line), so that a crash leaves a
    recording that is only cut off.
    Raises OSError where the file cannot be written.
    """

    def __init__(self, path: Path, level: Level, world: World) -> None:
        self.path = Path(path)
        self._chain = ""
        raw = self._raw = io.FileIO(self.path, "wb")
        # No name and no time in the compressed header, so that the same run gives the same bytes.
        self._file: BinaryIO | gzip.GzipFile = (
            gzip.GzipFile(filename="", mode="wb", compresslevel=6, fileobj=raw, mtime=0)
            if self.path.suffix == ".gz"
            else io.BufferedWriter(raw)
        )
        try:
            self._write(header(level, PHYSICS_VERSION, __version__))
            self.write_tick(world)
        except OSError as error:
            self.abandon()
            error.filename = str(self.path)
            raise

    def write_command(self, tick: int, gesture: int, record: dict[str, Any]) -> None:
        """Write a command that was applied at a tick, before its step."""
        self._write({"tick": tick, "gesture": gesture, "command": record})

    def write_tick(self, world: World) -> None:
        """Write the hashes of the present state, and now and then the state itself."""
        arrays = hash_by_array(world)
        self._write({"tick": world.tick, "hash": state_hash(world, arrays), "arrays": arrays})
        if world.tick % STATE_TICKS == 0:
            self._write({"tick": world.tick, **encode_state(world)})
            self._flush()

    def finish(self, world: World) -> None:
        """Write the last line and close the file."""
        try:
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

    def _flush(self) -> None:
        if isinstance(self._file, gzip.GzipFile):
            self._file.flush(zlib.Z_SYNC_FLUSH)
