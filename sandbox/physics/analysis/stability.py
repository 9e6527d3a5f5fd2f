"""Stability of the single pass: proven limits of a network of springs, and how close a world is to them.

All springs evaluated on the old velocities are stable where (Cs + 2 Cd) n_eff < 4 for every spring, with

    n_eff = m_r (w_a n_a + w_b n_b) >= the largest eigenvalue of sqrt(m_r) J W J^T sqrt(m_r)

and n_a, n_b the springs on its ends, for every topology, mass and time step. With Cs = Cd = C that is
C < 4 / (3 n_eff), which holds the article's 1 / (n + 1) inside (Nissen 2019, limitations and pitfalls).
Stable as well, and closer where soft and hard springs meet: m_r (w_a S_a + w_b S_b) < 4 for every spring, with S the
sum of Cs + 2 Cd over the springs on an end.
A constraint counts as one more spring at each of its corners, and has the most of them for its n_eff.
A Hooke spring counts as the Cs and Cd that it amounts to: k h^2 / m_r and c h / m_r.

`report` says it of a world, `spring_loads` of each spring, `coefficient_limits` and `coefficient_zones` of what Cs and
Cd a person may choose.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.energy import measure_constraints, reduced_masses
from sandbox.physics.analysis.query import slot_name
from sandbox.physics.arrays import Floats
from sandbox.physics.marks import LAW_HAND, LAW_HOOKE
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import substep_time, turned
from sandbox.physics.world import World

# (Cs + 2 Cd) times an eigenvalue stays below this, or the mode grows; from the linear theory, not a setting.
BOUND = 4.0
# Power iterations of the eigenvalue estimate; 200 come within 1 % on ropes and meshes.
POWER_ITERATIONS = 200
# Steps of the bisection that finds where a zone ends: to 1e-6 of the range.
BISECTIONS = 20
# Of worlds of more springs the explosion is not estimated: the eigenvalue takes too long for a window.
MOST_ESTIMATED = 6000


@dataclass(frozen=True)
class StabilityReport:
    """The stability of a world under its solver; coefficients per tick.

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


def report(world: World) -> StabilityReport:
    """Report the stability of a world under its solver."""
    counts = np.concatenate([effective_count(world), constraint_count(world)])
    solver = world.settings.solver
    if not len(counts) or counts.max() == 0.0:
        return StabilityReport(solver, 0.0, 1.0, 1.0, 1.0, True, None, "no spring does anything: nothing can blow up")
    tightest = int(np.argmax(counts))
    if tightest < world.spring_count:
        ends = np.array([world.particle_a[tightest], world.particle_b[tightest]])
    else:
        first = world.constraint_first[tightest - world.spring_count]
        ends = world.corner_particle[first : first + world.constraint_corners[tightest - world.spring_count]]
    most = int(_degrees(world)[ends].max())
    load = spring_loads(world)
    worst = int(np.argmax(load))
    within: bool | None = bool(load[worst] < BOUND)
    if SOLVERS[solver].proven_limit:
        name, verdict = _owner_name(world, worst), "proven stable" if within else "past the proven limit"
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
        spring=_owner_name(world, tightest),
        text=text,
    )


def _owner_name(world: World, slot: int) -> str:
    """Name of a spring, or of the constraint after the springs."""
    if slot < world.spring_count:
        return world.spring_names[slot]
    return slot_name(world, "element_kind", slot - world.spring_count)


def _energy_bound(world: World) -> str:
    """The sentence about what the test of a step's energy proves for these springs."""
    stiffness, damping = world.stiffness, world.damping
    springs = _working(world) & (world.law != LAW_HOOKE) & (stiffness > damping)
    constraints = (constraint_count(world) > 0.0) & (world.constraint_stiffness > world.constraint_damping)
    underdamped = np.flatnonzero(np.append(springs, constraints))
    water = "; what water does is bounded, not proven" if len(world.water) else ""
    if len(underdamped):
        return (
            f"proven: energy never exceeds four times the start and the work done, whatever Cs and Cd "
            f"(Cs is above Cd at {_owner_name(world, int(underdamped[0]))}){water}"
        )
    return f"proven: energy never exceeds the start and the work done, because Cs <= Cd on every spring{water}"


def _equal_limit(world: World, effective: float) -> float:
    """Largest Cs = Cd per tick that stays inside (Cs + 2 Cd) n_eff < 4, for an n_eff or an eigenvalue."""

    def inside(c: float) -> bool:
        stiffness, damping = turned(np.array([c]), np.array([c]), np.zeros(1), world.settings.fewest_substeps)
        return bool((stiffness[0] + 2.0 * damping[0]) * effective < BOUND)  # (5)

    return _largest(inside)


def _largest(inside: Callable[[float], bool]) -> float:
    """Largest number in 0..1 that is inside, by bisection; 0 where none is."""
    if inside(1.0):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inside(middle) else (low, middle)
    return low


@dataclass(frozen=True)
class CoefficientLimits:
    """Limits of each slider, per tick, with all else as it is; None = no limit can be proven; and why.

    both: how far Cs = Cd may go.
    """

    stiffness: float | None
    damping: float | None
    reason: str
    both: float | None = None


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
    counts, chosen = _counted(world, material)
    if not chosen.any():
        return CoefficientLimits(1.0, 1.0, "no spring of this material does anything")

    def limit(name: str) -> float:
        def inside(c: float) -> bool:
            springs = {"stiffness": world.stiffness.copy(), "damping": world.damping.copy()}
            constraints = {"stiffness": world.constraint_stiffness.copy(), "damping": world.constraint_damping.copy()}
            springs[name][chosen[: world.spring_count]] = c
            constraints[name][chosen[world.spring_count :]] = c
            loads = _summed_loads(world, _demands(world, **springs), _constraint_demands(world, **constraints))
            return bool(np.all(loads[chosen] < BOUND))

        return _largest(inside)

    tightest = int(np.flatnonzero(chosen)[np.argmax(counts[chosen])])
    at = f"n_eff {counts[tightest]:.3g} at {_owner_name(world, tightest)}"
    reason = f"proven: Cs + 2 Cd of joined springs add up to less than {BOUND:g}, {at}"
    demand = stability_limit(world, material)
    both = 0.0 if demand <= 0.0 else _equal_limit(world, BOUND / demand)
    return CoefficientLimits(limit("stiffness"), limit("damping"), reason, both)


@dataclass(frozen=True)
class CoefficientZones:
    """Zones of Cs and Cd per tick; see `coefficient_zones`.

    stiffness (k,): values of Cs. For each, as the highest Cd (k,) inside, -1 where none is: `article`, both at most
    1/(n+1) in every substep, with n = most_springs; `proven`, what is proven stable; `estimated`, what the largest
    eigenvalue says. None where a zone does not apply. bounded: whether the solver bounds the energy whatever Cs and Cd
    are; holds: whether the zones hold for the solver, and are not only those that a single pass would have.
    """

    stiffness: Floats
    article: Floats | None
    proven: Floats | None
    estimated: Floats | None
    most_springs: int
    bounded: bool
    holds: bool


def coefficient_zones(world: World, material: int | None, stiffness: Floats) -> CoefficientZones:
    """The zones of a material's springs (None = all) at given values of Cs (k,), all else as it is now.

    What is `estimated` takes the other materials to have the same Cs and Cd.
    """
    kind, most = SOLVERS[world.settings.solver], most_springs(world, material)
    if kind.bounded or most == 0:
        return CoefficientZones(stiffness, None, None, None, most, kind.bounded, True)
    count, article = world.settings.fewest_substeps, 1.0 / (most + 1.0)
    limit, lam = stability_limit(world, material), 0.0
    if world.spring_count <= MOST_ESTIMATED:
        lam = largest_eigenvalue(world)

    def highest(largest_stiffness: float, largest_damping: float, demand: float) -> Floats:
        """The highest Cd (k,) at which Cs, Cd and Cs + 2 Cd of a substep are within bounds; -1 where none is."""

        def is_inside(damping: Floats) -> np.ndarray:
            # Cs and Cd of a substep grow with both of those of a tick, so bisection finds the edge.
            each, damp = turned(stiffness, damping, np.zeros(len(stiffness)), count)
            return (each <= largest_stiffness) & (damp <= largest_damping) & (each + 2.0 * damp < demand)

        low, high = np.zeros(len(stiffness)), np.ones(len(stiffness))
        nothing, everything = ~is_inside(low), is_inside(high)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            inside = is_inside(middle)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return np.where(nothing, -1.0, np.where(everything, 1.0, low))

    estimated = highest(np.inf, 2.0 / lam, BOUND / lam) if lam > 0.0 else None
    return CoefficientZones(
        stiffness, highest(article, article, np.inf), highest(np.inf, np.inf, limit), estimated, most, False,
        kind.proven_limit,
    )  # fmt: skip


def most_springs(world: World, material: int | None = None) -> int:
    """The article's n: most springs and constraints on a particle that springs of a material (None = all) hold."""
    _, chosen = _counted(world, material)
    degree, slots = _degrees(world), np.flatnonzero(chosen[: world.spring_count])
    ends = [world.particle_a[slots], world.particle_b[slots]]
    corners = _free_corners(world)
    owner = np.repeat(np.arange(world.constraint_count), world.constraint_corners)[corners]
    ends.append(world.corner_particle[corners[chosen[world.spring_count :][owner]]])
    return int(degree[np.concatenate(ends)].max(initial=0))


def stability_limit(world: World, material: int | None = None) -> float:
    """The limit of Cs + 2 Cd of a substep below which a material's springs (None = all) are proven stable; inf: none.

    All springs of the material are taken with the same Cs and Cd, others as they are; 0 or less: those are unstable.
    """
    _, chosen = _counted(world, material)
    slots, elements = chosen[: world.spring_count], chosen[world.spring_count :]
    demands = _demands(world, world.stiffness, world.damping)
    of_constraints = _constraint_demands(world, world.constraint_stiffness, world.constraint_damping)

    def loads(demand: float) -> Floats:
        both = np.where(slots, demand, demands), np.where(elements, demand, of_constraints)
        return _summed_loads(world, *both)[chosen]

    # The loads are linear in what is demanded.
    at_rest = loads(0.0)
    slope = loads(1.0) - at_rest
    return float(np.min((BOUND - at_rest) / slope)) if len(slope) else np.inf


def _counted(world: World, material: int | None) -> tuple[Floats, NDArray[np.bool_]]:
    """n_eff of every spring, then every constraint (m + t,); and which of them have Cs and Cd of a material."""
    counts = np.concatenate([effective_count(world), constraint_count(world)])
    materials = np.concatenate([world.material, world.constraint_material])
    is_nissen = np.append(world.law != LAW_HOOKE, np.ones(world.constraint_count, dtype=np.bool_))
    chosen = (materials >= 0) if material is None else (materials == material)
    return counts, chosen & (counts > 0.0) & is_nissen


def stability_shares(world: World) -> Floats:
    """How near each spring (m,) is to the limit of what is proven stable: 1 = at it, more = beyond.

    Under a solver without a proven limit, to that of the single pass. Under one that bounds the energy no spring is
    beyond: 1 where Cs is above Cd, so that the bound is four times the energy, else 0.
    """
    if SOLVERS[world.settings.solver].bounded:
        return np.where(_working(world) & (world.law != LAW_HOOKE) & (world.stiffness > world.damping), 1.0, 0.0)
    return spring_loads(world)[: world.spring_count] / BOUND


def spring_loads(world: World) -> Floats:
    """The load of every spring, then every constraint (m + t,), that must stay below BOUND to be proven stable.

    Of two proven bounds the one that allows more.
    """
    demands = _demands(world, world.stiffness, world.damping)
    of_constraints = _constraint_demands(world, world.constraint_stiffness, world.constraint_damping)
    summed = _summed_loads(world, demands, of_constraints)
    counted = np.concatenate([demands * effective_count(world), of_constraints * constraint_count(world)])
    return summed if summed.max() < counted.max() else counted


def _summed_loads(world: World, demands: Floats, of_constraints: Floats) -> Floats:
    """m_r (w_a S_a + w_b S_b) of every spring, S = what is demanded on an end; then the most S of every constraint."""
    a, b = world.particle_a, world.particle_b
    corners = _free_corners(world)
    asked = np.repeat(of_constraints, world.constraint_corners)[corners]
    at = np.zeros(world.particle_count)
    for particles, weight in ((a, demands), (b, demands), (world.corner_particle[corners], asked)):
        at = at + np.bincount(particles, weight, world.particle_count)
    ends = reduced_masses(world) * (world.inverse_mass[a] * at[a] + world.inverse_mass[b] * at[b])
    return np.concatenate([np.where(_working(world), ends, 0.0), _most_at_corners(world, at)])


def _demands(world: World, stiffness: Floats, damping: Floats) -> Floats:
    """Cs + 2 Cd of a substep (m,) from Cs and Cd per tick; a Hooke spring's are those that it amounts to."""
    stiffness, damping = turned(stiffness, damping, world.lowest_mode, world.settings.fewest_substeps)
    working, mass = _working(world), reduced_masses(world)
    hooke = (world.law == LAW_HOOKE) & working
    h = substep_time(world.settings)
    stiffness[hooke] = world.hooke_stiffness[hooke] * h * h / mass[hooke]
    damping[hooke] = world.hooke_damping[hooke] * h / mass[hooke]
    return np.where(working, stiffness + 2.0 * damping, 0.0)


def _constraint_demands(world: World, stiffness: Floats, damping: Floats) -> Floats:
    """Cs + 2 Cd of a substep (t,) from a constraint's Cs and Cd per tick; 0 where it does nothing."""
    stiffness, damping = turned(stiffness, damping, world.constraint_lowest_mode, world.settings.fewest_substeps)
    return np.where(constraint_count(world) > 0.0, stiffness + 2.0 * damping, 0.0)


def effective_count(world: World) -> Floats:
    """n_eff of every spring (m,), 0 for those that do nothing; at most the larger n of its ends."""
    # n_eff = m_r (w_a n_a + w_b n_b)  (6)
    a, b, degree = world.particle_a, world.particle_b, _degrees(world)
    weighted = world.inverse_mass[a] * degree[a] + world.inverse_mass[b] * degree[b]
    return np.where(_working(world), reduced_masses(world) * weighted, 0.0)


def constraint_count(world: World) -> Floats:
    """n_eff of every constraint (t,): the most springs and constraints that hold one of its free corners."""
    # m sum of w |g|^2 n <= the largest n, since m <= 1 / (sum of w |g|^2)
    return _most_at_corners(world, _degrees(world).astype(np.float64))


def _most_at_corners(world: World, at: Floats) -> Floats:
    """The most of what stands at each particle (n,) over the free corners of every constraint (t,); 0 where none is."""
    owner, corners = np.repeat(np.arange(world.constraint_count), world.constraint_corners), _free_corners(world)
    most = np.zeros(world.constraint_count)
    np.maximum.at(most, owner[corners], at[world.corner_particle[corners]])
    return most


def _degrees(world: World) -> NDArray[np.int64]:
    """Springs and constraints that hold each particle (n,)."""
    working = _working(world)
    joined = world.corner_particle[_free_corners(world)]
    ends = np.concatenate([world.particle_a[working], world.particle_b[working], joined])
    return np.bincount(ends, minlength=world.particle_count)


def _free_corners(world: World) -> NDArray[np.int64]:
    """The corners (of q) of active constraints whose particles are free, which is where constraints do something."""
    active = np.repeat(world.constraint_active, world.constraint_corners)
    return np.flatnonzero(active & (world.inverse_mass[world.corner_particle] > 0.0))


def _working(world: World) -> NDArray[np.bool_]:
    # A hand's is none: what it holds is as a pin that moves, which makes no network less stable.
    return world.spring_active & (reduced_masses(world) > 0.0) & (world.law != LAW_HAND)


@np.errstate(over="ignore", invalid="ignore")
def largest_eigenvalue(world: World) -> float:
    """Largest eigenvalue of sqrt(m_r) J W J^T sqrt(m_r) at the present positions, by power iteration, from below."""
    rows, ends, gradient = _incidence(world)
    if not len(rows):
        return 0.0
    pull_x, pull_y = np.ascontiguousarray((gradient * np.sqrt(world.inverse_mass[ends])[:, None]).T)
    vector: Floats = np.random.default_rng(1).standard_normal(int(rows.max()) + 1)
    size = _norm(vector)
    for _ in range(POWER_ITERATIONS):
        weights = (vector / size)[rows]
        along_x = np.bincount(ends, weights * pull_x, world.particle_count)
        along_y = np.bincount(ends, weights * pull_y, world.particle_count)
        # G times the vector  (4)
        vector = np.bincount(rows, pull_x * along_x[ends] + pull_y * along_y[ends]).astype(np.float64, copy=False)
        size = _norm(vector)
        if size == 0.0:
            break
    return size


def _incidence(world: World) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """The rows of sqrt(m) J, one per working spring, then per constraint: their number, particle and gradient (k,
    2)."""
    springs = np.flatnonzero(_working(world))
    a, b = world.particle_a[springs], world.particle_b[springs]
    separation = world.position[b] - world.position[a]
    length = np.sqrt(np.sum(separation**2, axis=1))
    normal = np.divide(separation, length[:, None], out=np.zeros_like(separation), where=length[:, None] > 0.0)
    normal[length == 0.0] = (1.0, 0.0)
    normal *= np.sqrt(reduced_masses(world)[springs])[:, None]
    _, rest_mass, slope = measure_constraints(world)
    owner, corners = np.repeat(np.arange(world.constraint_count), world.constraint_corners), _free_corners(world)
    squares = world.inverse_mass[world.corner_particle[corners]] * np.sum(slope[corners] ** 2, axis=1)
    present = np.bincount(owner[corners], squares, world.constraint_count).astype(np.float64)
    # The explicit solvers take the less of the two masses.
    mass = np.minimum(rest_mass, np.divide(1.0, present, out=np.full_like(present, np.inf), where=present > 0.0))
    gradient = slope[corners] * np.sqrt(mass)[owner[corners], None]
    number = np.arange(len(springs))
    rows = np.concatenate([number, number, len(springs) + owner[corners]])
    ends = np.concatenate([a, b, world.corner_particle[corners]])
    return rows, ends, np.concatenate([-normal, normal, gradient])


def _norm(vector: Floats) -> float:
    # The library's own norm wakes as many threads as there are cores for each vector: more work than the vector.
    return float(np.sqrt(np.sum(vector * vector)))
