"""A recording as text, good for line-by-line diffs: what it is, its level and its commands, no hashes of ticks."""

import json
from collections.abc import Iterator

from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import file_of
from sandbox.session.replay.recording import Replay


def recording_text(replay: Replay) -> str:
    """The whole text, with the hash of the end as its last line."""
    return "".join(f"{line}\n" for line in _lines(replay))


def commands_text(replay: Replay) -> str:
    """The commands alone, a JSON object a line, as `sandbox run --commands` takes them."""
    return "".join(f"{line}\n" for line in _command_lines(replay))


def _lines(replay: Replay) -> Iterator[str]:
    name = file_of(replay.level)
    yield f"recording of {name + ', ' if name else ''}{json.dumps(replay.level.name, ensure_ascii=False)}"
    yield f"physics version {replay.physics_version}, recorded by version {replay.sandbox_version}"
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
        yield json.dumps({"tick": line.tick, "gesture": line.gesture, "command": line.record}, ensure_ascii=False)
