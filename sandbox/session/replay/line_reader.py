"""The lines of a replay file, plain or gzip, of which none is longer than its kind may be."""

import io
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from sandbox.level.format.foreign import LFS_POINTER
from sandbox.session.replay.recording import ReplayError

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
            yield line
            number += 1

    def _limit(self, beginning: bytes) -> int:
        limits = {b"gesture": COMMAND_LIMIT, b"command": COMMAND_LIMIT, b"state": self.state_limit}
        return limits.get(kind_of(beginning), TICK_LIMIT)


def kind_of(line: bytes) -> bytes:
    """The first key of a line that is not its tick, where it is written as a Recorder does; else nothing."""
    found = _BEGINNING.match(line)
    return found[1] if found else b""


class _Inflated(io.RawIOBase):
    """What gzip data hold. cut: whether they ended before their end. Raises ValueError where more follows it."""

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
