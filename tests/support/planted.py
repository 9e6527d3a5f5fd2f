"""Recordings of a minute of random play, with gestures amongst it after which something goes wrong."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.reading.files import level_data, load_level, parse_level
from sandbox.session.commands.records import from_record
from sandbox.session.compare.rollback import RandomHands
from sandbox.session.session import Session
from sandbox.session.shrink.failures import CheckFails, Diverges, Failure, Freezes, Leaves

SECONDS = 60.0
# Hands of gestures that are planted: random ones have 0.
HAND = 7


@dataclass(frozen=True)
class Planted:
    """A level, what goes wrong, and after which commands: each with its time [s]; those of one number are a gesture."""

    name: str
    seed: int
    failure: Callable[[Level], Failure]
    commands: tuple[tuple[float, int, dict[str, Any]], ...]
    changes: dict[str, Any] = field(default_factory=dict)

    def level(self) -> Level:
        """The shipped level of that name with the changes."""
        return edited(load_level(self.name), **self.changes)

    def record(self, path: Path, is_planted: bool = True) -> Level:
        """Record the play; is_planted: with those commands."""
        level = self.level()
        session = Session(level)
        session.record_to(path)
        hands = RandomHands(session, self.seed)
        rate = level.settings.tick_rate
        due = [(round(at * rate), 10**6 + gesture, record) for at, gesture, record in self.commands if is_planted]
        while session.tick < SECONDS * rate:
            for tick, gesture, record in due:
                if tick == session.tick:
                    session.submit(from_record(record, session.world), gesture)
            hands.act()
            session.advance()
        assert session.stop_recording() == path
        return level


def edited(level: Level, **changes: Any) -> Level:
    """A level with other values of fields, which are named like `settings__solver`."""
    data = level_data(level)
    for name, value in changes.items():
        *places, last = name.split("__")
        inner = data
        for place in places:
            inner = inner.setdefault(place, {})
        inner[last] = value
    return parse_level(json.dumps(data).encode(), "edited")


def _check(**given: Any) -> list[dict[str, Any]]:
    return [{"name": "planted", "always": [0, SECONDS], **given}]


def _drag(at: float, particle: str, *places: tuple[float, float], strength: float = 1e6) -> Any:
    """A hand takes a particle through places, one each half second."""
    first, *others = places
    grab = {"type": "grab", "grab": HAND, "particle": particle, "target": list(first), "strength": strength}
    moves = [{"type": "move_grab", "grab": HAND, "target": list(place)} for place in others]
    listed = [grab, *moves, {"type": "release", "grab": HAND}]
    return tuple((at + 0.5 * number, 1, record) for number, record in enumerate(listed))


def _once(at: float, gesture: int, **record: Any) -> Any:
    return ((at, gesture, record),)


CHECK = CheckFails("planted")
FAR = (-80.0, -80.0, 80.0, 80.0)
CASES = (
    # A rope is pulled too hard; a garland is torn where the other level has weaker hemp.
    Planted(
        "rope",
        12,
        lambda _: CHECK,
        _drag(41.0, "rope.end", (6.13, 3.37), (14.271, 9.163), (3.1, 4.2)),
        {"checks": _check(metric="strain", body="rope", at_most=0.0014)},
    ),
    Planted(
        "rope",
        1,
        lambda level: Diverges(edited(level, materials__hemp__tension_limit=0.0012)),
        _drag(44.0, "rope.end", (6.13, 3.37), (14.271, 9.163), (3.1, 4.2)),
    ),
    # Both ends of a girder come off; springs go.
    Planted(
        "girder",
        2,
        lambda _: CHECK,
        _once(21.0, 1, type="unpin", particle="girder.0") + _once(29.0, 2, type="unpin", particle="girder.22"),
        {"checks": _check(metric="y", body="girder", at_least=-1.0)},
    ),
    Planted(
        "suspension_bridge",
        3,
        lambda _: CHECK,
        _once(20.0, 1, type="cut_springs", springs=[f"cable:{number}" for number in (3, 4, 9, 12)])
        + _once(32.0, 2, type="cut_springs", springs=[f"cable:{number}" for number in (14, 17, 21, 22, 25)]),
        {"checks": _check(metric="broken_springs", body="cable", at_most=5)},
    ),
    # A body is thrown out of bounds.
    Planted(
        "newtons_cradle",
        4,
        lambda _: Leaves((-20.0, -20.0, 20.0, 20.0)),
        _once(30.0, 1, type="cut_springs", springs=[":0", ":1", ":2", ":3"])
        + _once(38.0, 2, type="push", position=[0.0, 2.0], radius=9.0, impulse=[812.3, 3171.7]),
    ),
    Planted(
        "walker",
        5,
        lambda _: Leaves(FAR),
        _once(37.0, 1, type="push", position=[30.0, 2.0], radius=300.0, impulse=[9812.3, 28171.7]),
    ),
    # Two gestures together: a pin and a drag; a motor in the wind.
    Planted(
        "ferris_wheel",
        6,
        lambda _: CHECK,
        _once(25.0, 1, type="set_drive", part="wheel", value=1.0)
        + _once(35.0, 2, type="set_air", wind=[161.3, 42.2], drag=9.17),
        {"checks": _check(metric="max_speed", at_most=45.0)},
    ),
    Planted(
        "truck_bridge",
        7,
        lambda level: Diverges(edited(level, settings__drag=0.001), apart=30.0),
        _once(26.0, 1, type="set_drive", part="rear wheel", value=1.0),
    ),
    # Everything blows up.
    Planted("clock_spring", 8, lambda _: Freezes(), _once(31.0, 1, type="set_solver", solver="single_pass")),
    Planted(
        "jelly_cube",
        9,
        lambda _: CHECK,
        _once(28.0, 1, type="set_inflation", body="cube", value=20.6)
        + _once(40.0, 2, type="set_inflation", body="cube", value=1.0),
        {"checks": _check(metric="max_speed", at_most=60.0)},
    ),
)
