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
from numpy.typing import NDArray

from sandbox.level.format.level_error import shown, suggestion
from sandbox.physics.analysis.energy import reduced_masses
from sandbox.physics.analysis.stability import BOUND, constraint_count, effective_count
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT, capped, of_body
from sandbox.physics.keeping.equipment import design_gravity
from sandbox.physics.marks import LAW_HAND, LAW_HOOKE
from sandbox.physics.softness.firmness import lowest_mode_of
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import substep_coefficients, substep_time
from sandbox.physics.world import World

# What the loose springs of a level are called together.
LOOSE = "loose springs"
# Names in a message, at most.
MOST_NAMED = 12
# Eigenvalue of the slow motions of what has no wobble of its own, such as a rope's: small, with digits to spare.
SLOW = 1e-6
# Substeps of a step, by default, of Box2D 3 (b2World_Step) and Rapier (numSolverIterations).
SOFT_STEP_SUBSTEPS = 4
# Times that a damped spring of Godot's is damped in a step: every second of its 16 solver iterations.
GODOT_TIMES = 8
# A tick is cut into at most this many steps for an engine that adds springs one by one; beyond, a rod is advised.
MOST_STEPS = 64
# Springs whose reduced masses agree to this share are of one line.
SAME_MASS = 1e-6
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


class NoSuchBody(ValueError):
    """There is nothing of that name to take home; its text is one line for a person."""


@dataclass(frozen=True, eq=False)
class ChosenBody:
    """A body of a world, or its loose springs of one material, as taken home.

    springs (k,) = slots that do something, all of the same Cs and Cd or Hooke's k and c. stiffness, damping: Cs and Cd
    of a tick [1]. tick [s]. n_eff: see stability.py. form: place in the world's `forms`, None; mode: eigenvalue of its
    slowest wobble, 0 where its form is not stiff. weight [N] of its free particles; least_mass
    [kg] and least_length [m]: of the spring of the least reduced mass. gravity [m/s^2].

    restoring = k h^2 / m_r and decay = c h / m_r, of a substep of h [s] as the level's solver has them: k is the spring
    constant of all its springs, c what an engine without damping of its own needs for the same motion at eigenvalue.
    """

    world: World
    name: str
    material: str
    springs: NDArray[np.int64]
    reduced: Floats
    stiffness: float
    damping: float
    hooke: bool
    tick: float
    h: float
    n_eff: float
    has_constraints: bool
    others: int
    form: int | None
    mode: float
    weight: float
    least_mass: float
    least_length: float
    gravity: float
    eigenvalue: float
    restoring: float
    decay: float

    @property
    def rigid(self) -> bool:
        """Whether its springs are complete rods, whose k is a cap of the solver's and no number to take home."""
        return not self.hooke and self.damping > HIGHEST_COEFFICIENT


@dataclass(frozen=True)
class MassLine:
    """k [N/m] and c [N s/m] of this many springs of one reduced mass [kg]."""

    reduced_mass: float
    springs: int
    k: float
    c: float


@dataclass(frozen=True)
class EngineNumbers:
    """The numbers for an engine that makes `steps` steps a tick: frequency [Hz] and damping_ratio of each spring.

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


def body_names(world: World) -> list[str]:
    """Names of what can be taken home, in the order of their springs; loose springs last."""
    chosen = np.flatnonzero(_working(world))
    found = dict.fromkeys(world.spring_names[slot].rpartition(":")[0] for slot in chosen.tolist())
    return [name for name in found if name] + [LOOSE] * ("" in found)


def choose_body(world: World, name: str | None = None) -> ChosenBody:
    """The body of that name; None: the first that has springs. Raises NoSuchBody."""
    names = body_names(world)
    if not names:
        raise NoSuchBody("no spring does anything here; there is nothing to take home")
    name = names[0] if name is None else name
    if name not in names:
        listed = ", ".join(map(shown, names[:MOST_NAMED])) + (", ..." if len(names) > MOST_NAMED else "")
        hint = suggestion(name, names) or f"; there are {listed}"
        raise NoSuchBody(f"there is no body with springs called {shown(name)}{hint}")
    return _described(world, name, springs_of(world, name))


def springs_of(world: World, name: str) -> NDArray[np.int64]:
    """Slots of the springs of the body of that name that do something."""
    prefix = "" if name == LOOSE else name
    mine = [k for k, spring in enumerate(world.spring_names) if spring.rpartition(":")[0] == prefix]
    slots = np.array(mine, dtype=np.int64)
    return np.asarray(slots[_working(world)[slots]])


def body_at(world: World, particle: int) -> str | None:
    """The name, as in `body_names`, of what the springs at a particle are of; None: there are none."""
    ends = (world.particle_a == particle) | (world.particle_b == particle)
    springs = np.flatnonzero(_working(world) & ends)
    return None if not len(springs) else world.spring_names[int(springs[0])].rpartition(":")[0] or LOOSE


def _working(world: World) -> NDArray[np.bool_]:
    return world.spring_active & (reduced_masses(world) > 0.0) & (world.law != LAW_HAND) & (world.material >= 0)


def _described(world: World, name: str, slots: NDArray[np.int64]) -> ChosenBody:
    first, settings = slots[0], world.settings
    alike = np.ones(len(slots), dtype=np.bool_)
    for column in ("law", "material", "stiffness", "damping", "hooke_stiffness", "hooke_damping"):
        values = getattr(world, column)
        alike &= values[slots] == values[first]
    springs, others = slots[alike], int(np.count_nonzero(~alike))
    reduced = reduced_masses(world)[springs]
    particles = np.unique(np.concatenate([world.particle_a[slots], world.particle_b[slots]]))
    form = next((k for k, each in enumerate(world.forms) if each.name == name), None)
    mode = 0.0 if form is None else lowest_mode_of(world.forms[form].shape)
    gravity, least = design_gravity(*settings.gravity), int(np.argmin(reduced))
    tick, h = 1.0 / settings.tick_rate, substep_time(settings)
    # Without a wobble of its own it moves slowly as a whole, but springs that share nothing swing each for itself.
    # n_eff of its springs, then of the areas and bends that begin at one of its particles.
    mine = np.isin(world.corner_particle[world.constraint_first], particles) & world.constraint_active
    counts = np.concatenate([effective_count(world)[slots], constraint_count(world)[mine]])
    alone = bool(counts.max() <= 1.0)
    eigenvalue = mode if mode > 0.0 else 1.0 if alone else SLOW
    hooke = bool(world.law[first] == LAW_HOOKE)
    if hooke:
        k, c = float(world.hooke_stiffness[first]), float(world.hooke_damping[first])
        mass = float(reduced[least])
        stiffness, damping = min(k * tick * tick / mass, 1.0), min(c * tick / mass, 1.0)
        restoring, decay = k * h * h / mass, c * h / mass
    else:
        stiffness, damping = float(world.stiffness[first]), float(world.damping[first])
        restoring, decay = as_in_solver(world, int(first), eigenvalue, alone)
    free = particles[world.inverse_mass[particles] > 0.0]
    return ChosenBody(
        world, name, world.material_names[world.material[first]], springs, reduced, stiffness, damping, hooke, tick, h,
        float(counts.max()), len(counts) > len(slots), others, form, mode,
        float(np.sum(world.mass[free])) * gravity, float(reduced[least]), float(world.rest_length[springs[least]]),
        gravity, eigenvalue, restoring, decay,
    )  # fmt: skip


def as_in_solver(world: World, spring: int, a: float, alone: bool) -> tuple[float, float]:
    """k h^2 / m_r and c h / m_r of a spring in a substep of the world's solver.

    In the slowest wobble, of eigenvalue a, the network is one spring of Cs_a and Cd_a, of which a step leaves
    u' = (1 - Cd_a) u - Cs_a x / h. An engine that adds k x first and then damps by exp(-c h / m_r) does the same with
    a k h^2 / m_r = Cs_a / (1 - Cd_a) and a c h / m_r = -ln(1 - Cd_a).
    """
    solver = SOLVERS[world.settings.solver]
    pairs = substep_coefficients(world, highest=solver.highest)
    stiffness, damping = (min(float(values[spring]), 1.0) for values in pairs)
    stiffness, damping = capped(stiffness, damping, HIGHEST_COEFFICIENT)
    of_wobble = of_body(stiffness, damping, a) if alone or solver.bounded else (a * stiffness, a * damping)
    damped = min(of_wobble[1], HIGHEST_COEFFICIENT)
    return of_wobble[0] / (1.0 - damped) / a, -math.log1p(-damped) / a


def engine_numbers(body: ChosenBody) -> dict[str, EngineNumbers]:
    """The numbers of a body for every engine, by its name in `--to`."""
    # Springs of this k can be added one by one in steps in each of which k h^2 / m_r n_eff < 4.
    whole = body.restoring * (body.tick / body.h) ** 2
    added = math.floor(math.sqrt(whole * body.n_eff / BOUND)) + 1
    return {
        "box2d": _solved(body, "Box2D 3", SOFT_STEP_SUBSTEPS, 2.0, BOX2D),
        "unity": _solved(body, "Unity 2D", 1, 1.0, UNITY),
        "godot": _added(body, "Godot 4", added, GODOT_TIMES, GODOT),
        "rapier": _solved(body, "Rapier 2D", SOFT_STEP_SUBSTEPS, 1.0, RAPIER),
        "pymunk": _added(body, "pymunk 7", added, 1, PYMUNK),
        "chipmunk": _added(body, "Chipmunk 7", added, 1, CHIPMUNK),
    }


def _solved(body: ChosenBody, engine: str, steps: int, own: float, difference: str) -> EngineNumbers:
    """An implicit engine, which damps as `own` times k h by itself."""
    ratio = body.tick / steps / body.h
    restoring = body.restoring * ratio * ratio
    # (1 + a D) a step is the fall exp(-a c h / m_r) of the wobble.
    damping = math.expm1(body.eigenvalue * body.decay * ratio) / body.eigenvalue - own * restoring
    return _engine_numbers(body, engine, steps, restoring, damping, body.rigid, difference)


def _added(body: ChosenBody, engine: str, steps: int, times: int, difference: str) -> EngineNumbers:
    """An engine that adds springs one by one, and damps this many times a step."""
    rigid = body.rigid or steps > MOST_STEPS
    steps = 1 if rigid else steps
    ratio = body.tick / steps / body.h
    return _engine_numbers(
        body, engine, steps, body.restoring * ratio * ratio, body.decay * ratio, rigid, difference, times
    )


def _engine_numbers(
    body: ChosenBody, engine: str, steps: int, restoring: float, damping: float, rigid: bool, difference: str,
    times: int = 1,
) -> EngineNumbers:  # fmt: skip
    """restoring = k h^2 / m_r and damping = c h / m_r of the engine's step, in which it is damped this many times."""
    h, least = body.tick / steps, max(damping, 0.0)
    ratio = 0.5 * least / math.sqrt(restoring) if restoring > 0.0 else 0.0
    ordered = np.sort(body.reduced)
    apart = np.flatnonzero(np.diff(ordered) > SAME_MASS * ordered[1:]) + 1
    alike = [(float(part[0]), len(part)) for part in np.split(ordered, apart)]
    masses = tuple(
        MassLine(mass, count, body.restoring * mass / body.h**2, least * mass / h / times) for mass, count in alike
    )
    hertz = math.sqrt(restoring) / h / (2.0 * math.pi)
    return EngineNumbers(engine, steps, h, hertz, ratio, masses, rigid, damping < 0.0, difference)
