"""A level that answers, with a rule of every kind, and a run of it that fires them."""

import json
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands import Command, HoldKey
from sandbox.session.session import Session

TICKS = 240
KEY_DOWN, KEY_UP = 30, 45


def answering(**changes: Any) -> Level:
    """A ball falls through a ring into a basket, and what it touches cuts, pins, drives, counts and wins."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "A level that answers",
        "settings": {"solver": "direct"},
        "hands": {},
        "terrain": [{"id": "floor", "polyline": [[-9, 0], [9, 0]]}],
        "zones": [
            {"id": "basket", "box": [-1, 0, 1, 1]},
            {"id": "ring", "circle": [0, 2, 0.3]},
            {"id": "roof", "polygon": [[-1, 2.5], [1, 2.5], [0, 3.2]]},
        ],
        "bodies": [
            {"id": "rope", "type": "rope", "start": [2, 3], "end": [4, 3], "segments": 5, "pinned": [0, 5]},
            {"id": "cube", "type": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.5, "position": [-7, 0.6],
             "firmness": {"sag": 0.0}},
            {"id": "line", "type": "rope", "start": [5, 3], "end": [7, 3], "segments": 5, "pinned": [0, 5]},
            {"id": "wheel", "type": "wheel", "position": [-4, 0.5], "radius": 0.4, "thickness": 0.1, "segments": 10,
             "motor": {"speed": 6.0, "torque": 20.0, "key": "d"}},
        ],
        "particles": [{"id": "ball", "position": [0, 4], "radius": 0.1}],
        "counters": [{"id": "score", "text": "Score"}],
        "rules": [
            {"id": "goal", "when": {"metric": "inside", "particle": "ball", "zone": "basket"}, "for_seconds": 0.5,
             "then": [{"win": "In!", "stars": {"second": 2, "third": 1}}]},
            {"id": "through", "when": {"crosses": "ring", "particle": "ball"}, "once": True,
             "then": [{"count": "score"}, {"say": "Through the ring"}]},
            {"id": "hit", "when": {"touches": ["ball", "floor"]},
             "then": [{"cut": "rope"}, {"count": "score", "by": 5}]},
            {"id": "gone", "when": {"all": [{"breaks": "rope"}, {"counter": "score", "at_least": 6}]},
             "then": [{"unpin": "line.5"}, {"drive": "wheel"}]},
            {"id": "falls", "when": {"metric": "y", "particle": "line.5", "at_most": 2}, "once": True,
             "then": [{"pin": "line.5"}, {"gravity": [0, -8], "during": 0.5}]},
            {"id": "key", "when": {"key": "g"}, "for_seconds": 0.1, "then": [{"cut": "line:2"}, {"sound": "bell"}]},
            {"id": "late", "when": {"any": [{"time": 3.0}, {"metric": "speed", "body": "wheel", "at_least": 90}]},
             "then": [{"wind": [1, 0]}, {"checkpoint": True}, {"sag": 0.2, "body": "cube", "during": 0.4}]},
            {"id": "still", "when": {"metric": "settled", "body": "rope", "at_least": 0.1}, "then": [{"say": "Still"}]},
            {"id": "lost", "when": {"none": [{"metric": "y", "particle": "ball", "at_least": -1}]},
             "then": [{"fail": "It fell"}]},
        ],
    }  # fmt: skip
    return parse_level(json.dumps(data | changes).encode(), "answering")


def hands(tick: int) -> list[Command]:
    """What is done in the run at a tick."""
    return [HoldKey(0, tick == KEY_DOWN)] if tick in (KEY_DOWN, KEY_UP) else []


def run(session: Session, until: int = TICKS) -> None:
    """Go on to a tick, with what is done in the run."""
    while session.tick < until:
        for command in hands(session.tick):
            session.submit(command)
        session.advance()
