"""Soft bodies of shipped levels that a straight stroke cuts, as the scissors do."""

import json
import math

import numpy as np

from sandbox.app.draw.things.level_slots import Actor, level_slots_of
from sandbox.level.document.model import Level
from sandbox.level.format.shipped import shipped_folder
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shares_crossed, springs_crossing
from sandbox.session.commands import CutSprings, SetCoefficients
from sandbox.session.session import Session

# A stroke's direction [degrees], and how far it misses the middle, as a part of the body's size.
STROKES = {"across": (109.0, 0.0), "along": (40.0, 0.0), "corner": (-43.0, 0.25)}
SOFT_LEVELS = {
    "jelly_pile": ("cube 1", "plank 2", "wedge 3", "wheel 4"),
    "desk_toy": ("raspberry", "lemon"),
    "trampoline": ("cube",),
    "beating_heart": ("heart",),
    "jelly_cube": ("cube",),
    "jelly_wheel": ("wheel",),
    "rope_bridge_jelly": ("cube", "disc"),
    "balloons": ("house",),
}
# Proven to be stable in a single pass.
SOFT_ENOUGH = 0.08


def level_with(name: str, solver: str) -> Level:
    """A shipped level with another solver."""
    read = json.loads((shipped_folder("levels") / f"{name}.json").read_text(encoding="utf-8"))
    read["settings"]["solver"] = solver
    return parse_level(json.dumps(read).encode(), name)


def begun(level: Level, ticks: int = 60) -> Session:
    """A run of a level, after some ticks; in a single pass its bodies are soft enough for that."""
    session = Session(level)
    if level.settings.solver == "single_pass":
        session.submit(SetCoefficients(stiffness=SOFT_ENOUGH, damping=SOFT_ENOUGH))
    advance(session, ticks)
    return session


def advance(session: Session, ticks: int) -> None:
    """Step a run."""
    for _ in range(ticks):
        session.advance()


def actor_of(level: Level, body: str) -> Actor:
    """The slots of a body."""
    return next(actor for actor in level_slots_of(level).actors if actor.body.id == body)


def line_of(session: Session, actor: Actor, stroke: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ends [m] of a stroke through a body where it lies now."""
    degrees, off = STROKES[stroke]
    place = session.world.position[actor.slots]
    size = float(np.ptp(place, axis=0).max())
    way = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    middle = place.mean(axis=0) + off * size * np.array([-way[1], way[0]])
    start, end = (middle + sign * size * way for sign in (-1.0, 1.0))
    return (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))


def crossed(session: Session, actor: Actor, stroke: str) -> tuple[int, ...]:
    """The springs of a body that a stroke crosses, where the body lies now."""
    found = springs_crossing(session.world, *line_of(session, actor, stroke))
    return tuple(np.intersect1d(found, actor.springs).tolist())


def cut_along(session: Session, body: str, stroke: str) -> CutSprings:
    """The command that parts a body along a stroke, where the body lies now."""
    actor = actor_of(session.level, body)
    springs = np.array(crossed(session, actor, stroke), np.int64)
    shares = shares_crossed(session.world, springs, *line_of(session, actor, stroke))
    is_parted = shares >= 0.0
    return CutSprings(tuple(springs[is_parted].tolist()), tuple(shares[is_parted].tolist()))


def part(session: Session, body: str, stroke: str) -> None:
    """Part a body along a stroke, with the next tick."""
    session.submit(cut_along(session, body, stroke))


def cut(session: Session, body: str, stroke: str) -> Actor:
    """Cut a body by a stroke, with the next tick; its slots."""
    actor = actor_of(session.level, body)
    session.submit(CutSprings(crossed(session, actor, stroke)))
    return actor
