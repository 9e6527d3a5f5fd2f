"""Substeps of a tick: what one is given, and how many a tick takes where that is left to it ("auto").

The choice is a pure function of the state at the tick's start, of + - * / and comparisons alone.
"""

import math

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.constraints import HIGHEST_RING_COEFFICIENT, TRIANGLE
from sandbox.physics.equation import HIGHEST_COEFFICIENT, capped, half_step_of_network, part_of_network
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.settings import DIRECT, WorldSettings
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.state import State
from sandbox.physics.world import World

# No tick chooses more substeps than this. 4 leaves a rope dragged at 20 m/s at a stretch above 1e-2, 16 doubles the
# time.
MOST_AUTO = 8
# The ends of a spring move by at most this share of its rest length against each other in a substep. A link that turns
# over within one step is beyond any linear solve; a smaller share costs time on every swing.
LARGEST_TURN = 0.5

# What substeps leave as it is: the motion of each spring, k of all springs, or that of all but those of a body with a
# firmness, whose wobble stays.
MOTION, ALL_CONSTANT, ALL_BUT_FIRM = range(3)

# Cs and Cd of springs (m,) or constraints (t,).
Pair = tuple[Floats, Floats]


def substep_time(settings: WorldSettings, count: int | None = None) -> float:
    """Time step h [s] of one of `count` substeps (None: of the fewest that the settings give a tick)."""
    return 1.0 / (settings.tick_rate * (count or settings.fewest_substeps))


def substep_coefficients(world: World | Snapshot, highest: float = 1.0) -> Pair:
    """Cs and Cd (m,) of one substep, of the fewest that the settings give a tick.

    In the direct solver they make the same k and c, else the same motion from tick to tick. highest: one of several
    substeps is made of Cs and Cd of at most this, see `Solver`.
    """
    return _of_substep(world, (world.stiffness, world.damping), world.lowest_mode, highest)


def constraint_coefficients(world: World, highest: float = 1.0) -> Pair:
    """Cs and Cd (t,) of constraints in a substep, as `substep_coefficients` for springs."""
    return _of_substep(world, tick_constraint_coefficients(world), world.constraint_lowest_mode, highest)


def tick_constraint_coefficients(world: World) -> Pair:
    """Cs and Cd (t,) of constraints in a tick, as solvers take them; areas of more than three corners give way."""
    stiffness, damping = world.constraint_stiffness.copy(), world.constraint_damping.copy()
    for k in np.flatnonzero(world.constraint_corners > TRIANGLE).tolist():
        stiffness[k], damping[k] = capped(float(stiffness[k]), float(damping[k]), HIGHEST_RING_COEFFICIENT)
    return stiffness, damping


def _of_substep(world: World | Snapshot, coefficients: Pair, lowest_mode: Floats, highest: float) -> Pair:
    settings = world.settings
    count, (solver, tick_rate, _, is_auto, _) = settings.fewest_substeps, settings.choices
    drag_factor = drag_factor_of(settings.drag, tick_rate, count)
    if count == 1 and drag_factor == 1.0:
        return coefficients
    return turned(*coefficients, lowest_mode, count, kept_by(solver, is_auto), highest, drag_factor)


def turned(
    stiffness: Floats, damping: Floats, lowest_mode: Floats, count: int, keeps: int = MOTION, highest: float = math.inf,
    drag_factor: float = 1.0,
) -> Pair:  # fmt: skip
    """Cs and Cd (m,) of a substep of so many from those of a tick; see `turn_into_substep`.

    lowest_mode (m,): that of the body whose firmness they come from, 0: they are their own.
    """
    pair = np.array(stiffness, np.float64), np.array(damping, np.float64)
    _turn_into_substep(*pair, lowest_mode, count, keeps, highest, drag_factor)
    return pair


@scalar_kernel
def drag_factor_of(drag: float, tick_rate: int, parts: int) -> float:
    """1 + drag h, by which drag makes masses heavier in one of so many parts of a tick."""
    return 1.0 + drag / (tick_rate * parts)


@scalar_kernel
def kept_by(solver: int, is_auto: int) -> int:
    """Which columns of springs substeps leave as they are, MOTION or the like; is_auto: ticks choose the count."""
    if solver != DIRECT:
        return MOTION
    return ALL_CONSTANT if is_auto != 0 else ALL_BUT_FIRM


@inner_kernel
def turn_into_substep(
    stiffness: Floats, damping: Floats, lowest_mode: Floats, count: int, keeps: int, highest: float, drag_factor: float
) -> None:
    """Turn Cs and Cd (m,) of a tick, in place, into those of a substep of so many; see `substep_coefficients`.

    keeps: see `kept_by`; drag_factor: see `drag_factor_of`; highest: where there are several substeps, Cs and Cd of a
    tick count as this at most.
    """
    if count > 1:
        for s in range(stiffness.shape[0]):
            stiffness[s] = min(stiffness[s], highest)
            damping[s] = min(damping[s], highest)
    for s in range(stiffness.shape[0] if count > 1 else 0):
        # What is rigid, k at its cap, stays as rigid as a step lets it be.
        is_firm = keeps == ALL_BUT_FIRM and (lowest_mode[s] > 0.0 or damping[s] > HIGHEST_COEFFICIENT)
        if keeps == MOTION or is_firm:
            # One exact halving of h at a time.
            parts = 1
            while parts < count:
                stiffness[s], damping[s] = half_step_of_network(stiffness[s], damping[s], lowest_mode[s])
                parts *= 2
        else:
            stiffness[s], damping[s] = part_of_network(stiffness[s], damping[s], lowest_mode[s], count)
    if drag_factor != 1.0:
        # Those of springs of the same k and c whose ends are heavier by a factor. The air takes part in every step:
        # (1 + drag h) m (v' - v*) = J.
        for s in range(stiffness.shape[0]):
            whole = damping[s] + (1.0 - damping[s]) * drag_factor
            stiffness[s] /= whole
            damping[s] /= whole


@kernel
def _turn_into_substep(
    stiffness: Floats, damping: Floats, lowest_mode: Floats, count: int, keeps: int, highest: float, drag_factor: float
) -> None:
    turn_into_substep(stiffness, damping, lowest_mode, count, keeps, highest, drag_factor)


@inner_kernel
def limit_rings(state: State, stiffness: Floats, damping: Floats) -> None:
    """Fill in Cs and Cd (t,) of constraints in a tick: see `tick_constraint_coefficients`."""
    for k in range(stiffness.shape[0]):
        stiffness[k] = state.constraint_stiffness[k]
        damping[k] = state.constraint_damping[k]
        if state.constraint_corners[k] > TRIANGLE:
            stiffness[k], damping[k] = capped(stiffness[k], damping[k], HIGHEST_RING_COEFFICIENT)


@inner_kernel
def _fastest_turn(state: State, grab_spring: int, grabs: int, h: float, shortest: Floats) -> float:
    # Largest ((|v_b - v_a| h) / L)^2; a grab's spring, which has no length, counts by the shortest spring at its end.
    velocity, inverse_mass = state.velocity, state.inverse_mass
    for grab in range(grabs):
        shortest[grab] = 0.0
    largest = 0.0
    for s in range(state.rest_length.shape[0]):
        of_hand = grab_spring <= s < grab_spring + grabs
        if not state.spring_active[s] or of_hand:
            continue
        length = state.rest_length[s]
        a, b = state.particle_a[s], state.particle_b[s]
        if not length > 0.0 or (inverse_mass[a] == 0.0 and inverse_mass[b] == 0.0):
            continue
        u, v = (velocity[b, 0] - velocity[a, 0]) * h / length, (velocity[b, 1] - velocity[a, 1]) * h / length
        turn = u * u + v * v
        if not turn <= largest:
            largest = turn
        for grab in range(grabs):
            if state.spring_active[grab_spring + grab]:
                end = state.particle_b[grab_spring + grab]
                if end in (a, b) and (shortest[grab] == 0.0 or length < shortest[grab]):
                    shortest[grab] = length
    for grab in range(grabs):
        s = grab_spring + grab
        if state.spring_active[s] and shortest[grab] > 0.0:
            a, b = state.particle_a[s], state.particle_b[s]
            u = (velocity[b, 0] - velocity[a, 0]) * h / shortest[grab]
            v = (velocity[b, 1] - velocity[a, 1]) * h / shortest[grab]
            turn = u * u + v * v
            if not turn <= largest:
                largest = turn
    return largest


@inner_kernel
def choose_substeps(state: State, grab_spring: int, tick_rate: int, shortest: Floats) -> int:
    """Substeps of the coming tick: the fewest (1, 2, 4, 8) in which no spring turns too far.

    Looked at are the springs' ends as they move at the tick's start, cursors of grabs and moved pins included.
    grab_spring: the first one, -1: there is none. shortest (GRAB_COUNT,): scratch.
    """
    # A whole tick's turn, halved at each doubling of the substeps.
    grabs = GRAB_COUNT if grab_spring >= 0 else 0
    turn = _fastest_turn(state, grab_spring, grabs, 1.0 / tick_rate, shortest)
    count = 1
    while count < MOST_AUTO and not turn <= (LARGEST_TURN * count) * (LARGEST_TURN * count):
        count *= 2
    return count
