"""Stability of the single pass: what can be proven about a network of springs, and how close a world is to it.

All springs evaluated on the old velocities are stable where (Cs + 2 Cd) n_eff < 4 for every spring, with

    n_eff = m_r (w_a n_a + w_b n_b) >= the largest eigenvalue of sqrt(m_r) J W J^T sqrt(m_r)

and n_a, n_b the springs on its ends, for every topology, mass and time step. With Cs = Cd = C that is
C < 4 / (3 n_eff), which holds the article's 1 / (n + 1) inside (Nissen 2019, limitations and pitfalls).
Stable as well, and closer where soft and hard springs meet: m_r (w_a S_a + w_b S_b) < 4 for every spring, with S the
sum of Cs + 2 Cd over the springs on an end; a hand at a particle of many soft springs is inside this one alone.
A Hooke spring counts as the Cs and Cd that it amounts to: k h^2 / m_r and c h / m_r.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.energy import reduced_masses
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import substep_time
from sandbox.physics.substeps import halve
from sandbox.physics.world import LAW_HOOKE, Floats, World

# (Cs + 2 Cd) times an eigenvalue stays below this, or the mode grows; from the linear theory, not a setting.
BOUND = 4.0
# Power iterations of the eigenvalue estimate; 200 come within 1 % on ropes and meshes.
POWER_ITERATIONS = 200


@dataclass(frozen=True)
class StabilityReport:
    """What can be said of a world's stability under its solver; coefficients per tick.

    n_eff and article_limit (1/(n+1)), proven_limit and estimated_limit are for Cs = Cd, of the tightest spring;
    within_limit: whether every spring's own Cs and Cd are proven stable, None where the solver has no proven limit,
    True where it bounds the energy whatever they are.
    """

    solver: str
    n_eff: float
    article_limit: float
    proven_limit: float
    estimated_limit: float
    within_limit: bool | None
    spring: str | None
    text: str


@dataclass(frozen=True)
class CoefficientLimits:
    """How far each slider may go, per tick, with all else as it is; None = no limit can be proven; and why."""

    stiffness: float | None
    damping: float | None
    reason: str


def _working(world: World) -> NDArray[np.bool_]:
    return world.spring_active & (reduced_masses(world) > 0.0)


def _springs_at_ends(world: World) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    working = _working(world)
    ends = np.concatenate([world.particle_a[working], world.particle_b[working]])
    degree = np.bincount(ends, minlength=world.particle_count)
    return degree[world.particle_a], degree[world.particle_b]


def effective_count(world: World) -> Floats:
    """n_eff of every spring (m,), 0 for those that do nothing; at most the larger n of its ends."""
    # n_eff = m_r (w_a n_a + w_b n_b)
    at_a, at_b = _springs_at_ends(world)
    weighted = world.inverse_mass[world.particle_a] * at_a + world.inverse_mass[world.particle_b] * at_b
    return np.where(_working(world), reduced_masses(world) * weighted, 0.0)


@np.errstate(over="ignore", invalid="ignore")
def largest_eigenvalue(world: World) -> float:
    """Largest eigenvalue of sqrt(m_r) J W J^T sqrt(m_r) at the present positions, by power iteration, from below."""
    working = _working(world)
    if not working.any():
        return 0.0
    a, b = world.particle_a[working], world.particle_b[working]
    root = np.sqrt(reduced_masses(world)[working])
    separation = world.position[b] - world.position[a]
    length = np.sqrt(np.sum(separation**2, axis=1))
    normal = np.divide(separation, length[:, None], out=np.zeros_like(separation), where=length[:, None] > 0.0)
    normal[length == 0.0] = (1.0, 0.0)
    count = world.particle_count
    vector = np.random.default_rng(1).standard_normal(len(a))
    eigenvalue = 0.0
    for _ in range(POWER_ITERATIONS):
        pull = (root * vector / np.linalg.norm(vector))[:, None] * normal
        velocity = np.stack([np.bincount(b, pull[:, k], count) - np.bincount(a, pull[:, k], count) for k in (0, 1)], 1)
        velocity *= world.inverse_mass[:, None]
        vector = root * np.sum(normal * (velocity[b] - velocity[a]), axis=1)
        eigenvalue = float(np.linalg.norm(vector))
        if eigenvalue == 0.0:
            break
    return eigenvalue


def _demands(world: World, stiffness: Floats, damping: Floats) -> Floats:
    """Cs + 2 Cd of a substep (m,) from Cs and Cd per tick; a Hooke spring's are those that it amounts to."""
    stiffness, damping = stiffness.copy(), damping.copy()
    halve(stiffness, damping, world.settings.fewest_substeps)
    working, mass = _working(world), reduced_masses(world)
    hooke = (world.law == LAW_HOOKE) & working
    h = substep_time(world.settings)
    stiffness[hooke] = world.hooke_stiffness[hooke] * h * h / mass[hooke]
    damping[hooke] = world.hooke_damping[hooke] * h / mass[hooke]
    return np.where(working, stiffness + 2.0 * damping, 0.0)


def _summed_loads(world: World, demands: Floats) -> Floats:
    """m_r (w_a S_a + w_b S_b) of every spring (m,), S = what the springs on an end demand together."""
    a, b = world.particle_a, world.particle_b
    at = np.bincount(a, demands, world.particle_count) + np.bincount(b, demands, world.particle_count)
    return np.where(
        _working(world), reduced_masses(world) * (world.inverse_mass[a] * at[a] + world.inverse_mass[b] * at[b]), 0.0
    )


def spring_loads(world: World) -> Floats:
    """What must stay below BOUND for every spring (m,): of the two proven bounds the one that allows more here."""
    demands = _demands(world, world.stiffness, world.damping)
    summed, counted = _summed_loads(world, demands), demands * effective_count(world)
    return summed if summed.max() < counted.max() else counted


def _largest(inside: Callable[[float], bool]) -> float:
    """Largest number in 0..1 that is inside, by bisection; 0 where none is."""
    if inside(1.0):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inside(middle) else (low, middle)
    return low


def _equal_limit(world: World, effective: float) -> float:
    """Largest Cs = Cd per tick that stays inside (Cs + 2 Cd) n_eff < 4, for an n_eff or an eigenvalue."""

    def inside(c: float) -> bool:
        stiffness, damping = np.array([c]), np.array([c])
        halve(stiffness, damping, world.settings.fewest_substeps)
        return bool((stiffness[0] + 2.0 * damping[0]) * effective < BOUND)

    return _largest(inside)


def _energy_bound(world: World) -> str:
    """What the test of a step's energy proves, and of which kind the springs are."""
    stiffness, damping = world.stiffness, world.damping
    bouncy = np.flatnonzero(_working(world) & (world.law != LAW_HOOKE) & (stiffness > damping))
    if len(bouncy):
        return (
            f"proven: energy never exceeds four times the start and the work done, whatever Cs and Cd "
            f"(Cs is above Cd at {world.spring_names[bouncy[0]]})"
        )
    return "proven: energy never exceeds the start and the work done, because Cs <= Cd on every spring"


def report(world: World) -> StabilityReport:
    """What can be proven about this world's stability under its solver."""
    counts = effective_count(world)
    solver = world.settings.solver
    if not len(counts) or counts.max() == 0.0:
        return StabilityReport(solver, 0.0, 1.0, 1.0, 1.0, True, None, "no spring does anything: nothing can blow up")
    tightest = int(np.argmax(counts))
    most = max(int(ends[tightest]) for ends in _springs_at_ends(world))
    load = spring_loads(world)
    worst = int(np.argmax(load))
    within: bool | None = bool(load[worst] < BOUND)
    if SOLVERS[solver].proven_limit:
        name, verdict = world.spring_names[worst], "proven stable" if within else "past the proven limit"
        text = (
            f"{verdict}: the springs' Cs + 2 Cd add up to {load[worst]:.3g} at {name}, and stay stable below {BOUND:g}"
        )
    elif SOLVERS[solver].bounded:
        within, text = True, _energy_bound(world)
    else:
        within = None
        text = f"the {solver} solver has no proven limit; the single pass would be stable for Cs = Cd up to "
        text += f"{_equal_limit(world, float(counts[tightest])):.3g} (n_eff {counts[tightest]:.3g})"
    return StabilityReport(
        solver=solver,
        n_eff=float(counts[tightest]),
        article_limit=1.0 / (most + 1.0),
        proven_limit=_equal_limit(world, float(counts[tightest])),
        estimated_limit=_equal_limit(world, largest_eigenvalue(world)),
        within_limit=within,
        spring=world.spring_names[tightest],
        text=text,
    )


def coefficient_limits(world: World, material: int | None = None) -> CoefficientLimits:
    """Marks for the Cs and Cd sliders of a material's springs (None = all).

    Each is the largest value per tick that is proven stable while all else stays as it is, 0 where none is; 1 = the
    whole slider. Other materials are taken to be within limits of their own: a mark cannot answer for one that is not.
    """
    solver = world.settings.solver
    if SOLVERS[solver].bounded:
        return CoefficientLimits(1.0, 1.0, _energy_bound(world))
    if not SOLVERS[solver].proven_limit:
        return CoefficientLimits(None, None, f"no proven limit for the {solver} solver")
    counts = effective_count(world)
    chosen = (world.material >= 0) if material is None else (world.material == material)
    chosen &= (counts > 0.0) & (world.law != LAW_HOOKE)
    if not chosen.any():
        return CoefficientLimits(1.0, 1.0, "no spring of this material does anything")
    # A hand is as hard as it is: where it holds one of these springs' ends, what they may add to it is less.
    ends = np.union1d(world.particle_a[chosen], world.particle_b[chosen])
    judged = chosen | (_working(world) & (world.material < 0) & np.isin(world.particle_b, ends))

    def limit(name: str) -> float:
        def inside(c: float) -> bool:
            pair = {"stiffness": world.stiffness.copy(), "damping": world.damping.copy()}
            pair[name][chosen] = c
            return bool(np.all(_summed_loads(world, _demands(world, **pair))[judged] < BOUND))

        return _largest(inside)

    tightest = int(np.flatnonzero(chosen)[np.argmax(counts[chosen])])
    at = f"n_eff {counts[tightest]:.3g} at {world.spring_names[tightest]}"
    reason = f"proven: Cs + 2 Cd of joined springs add up to less than {BOUND:g}, {at}"
    return CoefficientLimits(limit("stiffness"), limit("damping"), reason)
