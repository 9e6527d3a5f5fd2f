"""Recording again: the commands of a recording, on its level or another, as this version steps them."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.reading.files import level_data, parse_level
from sandbox.session.commands import CommandError
from sandbox.session.replay.format import STATE_TICKS
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session


def record_again(replay: Replay, level: Level, path: Path) -> None:
    """Write a recording of as many ticks with the same commands on a level; states as far apart as they were.

    Raises ReplayError where a command cannot be carried out there, OSError where the file cannot be written.
    """
    stored = sorted(replay.states)
    apart = stored[1] - stored[0] if len(stored) > 2 else STATE_TICKS
    session = Session(level, script=replay.script)
    session.record_to(path, apart)
    try:
        while session.tick < replay.ticks:
            session.advance()
        session.apply_pending()
    except CommandError as error:
        session.abandon_recording()
        raise ReplayError(*(f"{replay.source}: {fault}" for fault in error.faults)) from None
    if session.stop_recording() is None:
        raise OSError(0, "; ".join(session.refusals), str(path))


def with_settings(level: Level, settings: Mapping[str, Any], source: str) -> Level:
    """A level with other values of some of its settings, which source has given. Raises LevelError."""
    data = level_data(level)
    data["settings"] = {**data.get("settings", {}), **settings}
    return parse_level(json.dumps(data).encode(), source)
