"""A scripted person: drags, cuts, pins, slider moves, undo and redo on any level, the same every time."""

import math

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.format.quantities import replaced
from sandbox.level.rules.player_limits import BudgetDef, PlayerLimits
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.settings import AUTO
from sandbox.session.commands import (
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Release,
    SetCoefficients,
    SetGravity,
    SetSolver,
    Unpin,
)
from sandbox.session.session import Session


def without_limits(level: Level) -> Level:
    """A level in which hands may do everything, as often as they like; what rules ask of budgets stays."""
    if level.hands is None:
        return level
    budgets = BudgetDef(**{deed: 1_000 for deed, most in level.hands.at_most if most is not None})
    return replaced(level, hands=PlayerLimits(at_most=budgets))


def play(session: Session, ticks: int) -> None:
    """Play a session for some ticks, one act after the other."""
    acts = (_drag, _slide, _cut, _pin_and_unpin, _drag, _undo_and_redo, _tune)
    for number in range(10**9):
        for _ in acts[number % len(acts)](session, number):
            if session.tick >= ticks:
                return
            session.advance()


def _free_particle(session: Session, number: int) -> int:
    free = np.flatnonzero(shown_particles(session.world) & (session.world.inverse_mass > 0.0))
    return int(free[number * 7919 % len(free)])


def _drag(session: Session, number: int):
    particle, gesture = _free_particle(session, number), session.new_gesture()
    x, y = session.world.position[particle].tolist()
    if not abs(x) + abs(y) < 1e5:
        yield
        return
    session.submit(Grab(0, particle, (x, y)), gesture)
    for tick in range(40):
        session.submit(MoveGrab(0, (x + math.sin(0.15 * tick), y + 0.02 * tick)), gesture)
        yield
    session.submit(Release(0), gesture)
    yield


def _slide(session: Session, number: int):
    gesture = session.new_gesture()
    for tick in range(10):
        session.submit(SetCoefficients(stiffness=0.05 + 0.01 * tick, damping=0.1 + 0.01 * (number % 7)), gesture)
        yield


def _cut(session: Session, number: int):
    springs = np.flatnonzero(shown_springs(session.world))
    if len(springs) > 2:
        session.submit(CutSprings((int(springs[number * 104729 % len(springs)]),)))
    yield


def _pin_and_unpin(session: Session, number: int):
    particle = _free_particle(session, number)
    session.submit(Pin(particle))
    for _ in range(20):
        yield
    session.submit(Unpin(particle))
    yield


def _undo_and_redo(session: Session, number: int):
    session.undo()
    yield
    session.undo()
    yield
    session.redo()
    yield


def _tune(session: Session, number: int):
    session.submit(SetSolver(substeps=AUTO if session.world.settings.substeps == 1 else 1))
    session.submit(SetGravity((0.5, -9.81)))
    yield
