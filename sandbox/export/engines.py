"""A body's springs in the terms of other engines: frequency and damping ratio, or k and c, and what differs there.

One step of each engine, for one spring of error x and velocity u after gravity, read from its source:

    Chipmunk, pymunk, Godot   u' = (u - k h x / m_r) exp(-c h / m_r)
    Unity (Box2D 2), Rapier   u' = (u - k h x / m_r) / (1 + c h / m_r + k h^2 / m_r)
    Box2D 3                   the same, and once more with the new x after positions have moved
    the sandbox               u' = (1 - Cd) u - Cs x / h

k is that of the level; c is such that the motion falls off alike, each engine's own damping allowed for.
"""

import math
from dataclasses import dataclass

import numpy as np

from sandbox.export.chosen_body import ChosenBody
from sandbox.physics.analysis.stability import BOUND

# Substeps of a step, by default, of Box2D 3 (b2World_Step) and Rapier (numSolverIterations).
SOFT_STEP_SUBSTEPS = 4
# Times that a damped spring of Godot's is damped in a step: every second of its 16 solver iterations.
GODOT_TIMES = 8
# A tick is cut into at most this many steps for an engine that adds springs one by one; beyond, a rod is advised.
MOST_STEPS = 64
# Springs whose reduced masses agree to this share are of one line.
SAME_MASS = 1e-6


@dataclass(frozen=True)
class MassLine:
    """k [N/m] and c [N s/m] of this many springs of one reduced mass [kg]."""

    reduced_mass: float
    springs: int
    k: float
    c: float


@dataclass(frozen=True)
class EngineNumbers:
    """What to type into an engine that takes `steps` steps a tick: frequency [Hz] and damping_ratio of each spring.

    masses: k and c by reduced mass, lightest first. rigid: its springs should be rods there. negative: whether the
    engine damps more than the level does even at a damping of 0, which is what it is given.
    """

    engine: str
    steps: int
    step: float
    frequency: float
    damping_ratio: float
    masses: tuple[MassLine, ...]
    rigid: bool
    negative: bool
    difference: str


def engine_numbers(body: ChosenBody) -> dict[str, EngineNumbers]:
    """The numbers of a body for every engine, by its name in `--to`."""
    added = steps_of_added_springs(body)
    return {
        "box2d": _solved(body, "Box2D 3", SOFT_STEP_SUBSTEPS, 2.0, BOX2D),
        "unity": _solved(body, "Unity 2D", 1, 1.0, UNITY),
        "godot": _added(body, "Godot 4", added, GODOT_TIMES, GODOT),
        "rapier": _solved(body, "Rapier 2D", SOFT_STEP_SUBSTEPS, 1.0, RAPIER),
        "pymunk": _added(body, "pymunk 7", added, 1, PYMUNK),
        "chipmunk": _added(body, "Chipmunk 7", added, 1, CHIPMUNK),
    }


def steps_of_added_springs(body: ChosenBody) -> int:
    """Steps a tick with which springs of this k can be added one by one: k h^2 / m_r n_eff < 4 in each."""
    whole = body.restoring * (body.tick / body.h) ** 2
    return math.floor(math.sqrt(whole * body.n_eff / BOUND)) + 1


def _solved(body: ChosenBody, engine: str, steps: int, own: float, difference: str) -> EngineNumbers:
    """An implicit engine, which damps as `own` times k h by itself."""
    share = body.tick / steps / body.h
    restoring = body.restoring * share * share
    # (1 + a D) a step is the fall exp(-a c h / m_r) of the wobble.
    damping = math.expm1(body.eigenvalue * body.decay * share) / body.eigenvalue - own * restoring
    return _numbers(body, engine, steps, restoring, damping, body.rigid, difference)


def _added(body: ChosenBody, engine: str, steps: int, times: int, difference: str) -> EngineNumbers:
    """An engine that adds springs one by one, and damps this many times a step."""
    rigid = body.rigid or steps > MOST_STEPS
    steps = 1 if rigid else steps
    share = body.tick / steps / body.h
    return _numbers(body, engine, steps, body.restoring * share * share, body.decay * share, rigid, difference, times)


def _numbers(
    body: ChosenBody, engine: str, steps: int, restoring: float, damping: float, rigid: bool, difference: str,
    times: int = 1,
) -> EngineNumbers:  # fmt: skip
    """restoring = k h^2 / m_r and damping = c h / m_r of the engine's step, in which it is damped this many times."""
    h, least = body.tick / steps, max(damping, 0.0)
    ratio = 0.5 * least / math.sqrt(restoring) if restoring > 0.0 else 0.0
    masses = tuple(
        MassLine(mass, count, body.restoring * mass / body.h**2, least * mass / h / times)
        for mass, count in _masses(body)
    )
    hertz = math.sqrt(restoring) / h / (2.0 * math.pi)
    return EngineNumbers(engine, steps, h, hertz, ratio, masses, rigid, damping < 0.0, difference)


def _masses(body: ChosenBody) -> list[tuple[float, int]]:
    ordered = np.sort(body.reduced)
    apart = np.flatnonzero(np.diff(ordered) > SAME_MASS * ordered[1:]) + 1
    return [(float(part[0]), len(part)) for part in np.split(ordered, apart)]


BOX2D = (
    "springs of a body are solved one after another, not together: sags are those of here, but what swings in less "
    "than 20 ticks is up to 4 % quicker. Only contacts and rigid joints are "
    "clamped to a quarter of the substep rate, springs are not"
)
UNITY = (
    "SpringJoint2D is Box2D 2: one step of Time.fixedDeltaTime without substeps, so set that to the step above. "
    "Springs of a body are solved one after another, not together. From its equation, not tried here"
)
GODOT = (
    "DampedSpringJoint2D adds each spring by itself, and damps in every second of its 16 solver iterations, so its c "
    "is an eighth of pymunk's. Set linear_damp to 0. In pixels k and c are the same. From its source, not tried here"
)
RAPIER = (
    "JointData.spring takes this k and c. Springs of a body are solved one after another, not together; what swings "
    "in less than 20 ticks is up to 4 % quicker, and at Cs 0.9, Cd 0.95 a braced square sags half as much again"
)
CHIPMUNK = (
    "each spring is added by itself, so a stiffer body needs more steps a tick (those above are proven enough for k). "
    "Set the space's damping to 1, or everything is slowed down"
)
PYMUNK = CHIPMUNK
