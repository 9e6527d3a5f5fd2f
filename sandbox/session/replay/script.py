"""Reading scripts: commands as lines of a replay, without hashes."""

from collections.abc import Iterator
from pathlib import Path

from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.line_reader import COMMAND_LIMIT
from sandbox.session.replay.record import CommandLine, checked
from sandbox.session.replay.recording import ReplayError

# What a script may hold: some hours of dragging, in [bytes] and lines.
SIZE_LIMIT = 32 * 2**20
LINE_LIMIT = 250_000
FAULT_LIMIT = 50  # that are told of one script
# Gestures that a script does not number are numbered by line from here, beyond those that it does.
UNNUMBERED = 2**40


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
                yield number, line
