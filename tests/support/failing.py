"""A recording in which a check of its level fails, as the documents show one."""

import json
from pathlib import Path

from sandbox.level.reading.files import level_data, load_level, parse_level
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session

CHECK = {"name": "it hangs", "metric": "y", "particle": "garland.14", "always": [0, 20], "at_most": 5.6}
PUSH = {"type": "push", "position": [-5.517, 4.972], "radius": 2.345, "impulse": [31.4, 487.654]}


def put_failing(folder: Path) -> Path:
    """Write failing.replay.gz into a folder: particles are pinned one after another, then a garland is pushed up."""
    level = parse_level(json.dumps({**level_data(load_level("rope")), "checks": [CHECK]}).encode(), "failing")
    session = Session(level)
    session.record_to(folder / "failing.replay.gz")
    while session.tick < 180:
        tick = session.tick
        if tick < 50 and tick % 10 == 0:
            pin = {"type": "pin", "particle": f"rope.{tick // 10 + 5}"}
            session.submit(from_record(pin, session.world))
        if tick == 60:
            session.submit(from_record(PUSH, session.world))
        session.advance()
    path = session.stop_recording()
    assert path is not None and not session.messages
    return path
