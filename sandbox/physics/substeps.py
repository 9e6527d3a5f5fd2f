"""Substeps of a tick: what one is given, and how many a tick takes where that is left to it ("auto").

The choice is a pure function of the state at the tick's start, of + - * / and comparisons alone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.equation import HIGHEST_COEFFICIENT, half_step_of_network, part_of_network
from sandbox.physics.forces import StepStart
from sandbox.physics.jit import kernel
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import GRAB_COUNT, Floats, World

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


class Substep(NamedTuple):
    """The input of a solver: time step h [s] of one substep, their count, Cs and Cd of springs and constraints in it.

    ease: 1 + drag h, see `ease_of`. before: the start of the substep.
    """

    h: float
    substeps: int
    ease: float
    springs: Pair
    constraints: Pair
    step_start: StepStart


class Cadence(NamedTuple):
    """The substeps of a tick by some settings: the fewest, and the h [s] of each."""

    settings: WorldSettings
    substeps: int
    h: float


def cadence_of(settings: WorldSettings) -> Cadence:
    """That of some settings."""
    return Cadence(settings, settings.fewest_substeps, substep_time(settings))


def substep_time(settings: WorldSettings, count: int | None = None) -> float:
    """Time step h [s] of one of `count` substeps (None: of the fewest that the settings give a tick)."""
    return 1.0 / (settings.tick_rate * (count or settings.fewest_substeps))


def substep_coefficients(
    world: World | Snapshot, count: int | None = None, into: Pair | None = None, keeps_constant: bool = False,
    highest: float = 1.0,
) -> Pair:  # fmt: skip
    """Cs and Cd (m,) of one substep: the same k and c in the direct solver, else the same motion from tick to tick.

    count: substeps in the tick (None: the fewest that the settings give it). into: the arrays that are filled in and
    returned (None: new ones). keeps_constant: leave its k instead, as the direct solver's where ticks choose their
    parts, whatever the body. highest: one of several substeps is made of Cs and Cd of at most this, see `Solver`.
    """
    count = count or world.settings.fewest_substeps
    coefficients = world.stiffness, world.damping
    keeps, ease = _keeps(world.settings, keeps_constant), ease_of(world.settings, count)
    return _of_substep(coefficients, world.lowest_mode, count, into, keeps, highest, ease)


def constraint_coefficients(
    world: World, count: int | None = None, into: Pair | None = None, keeps_constant: bool = False,
    highest: float = 1.0,
) -> Pair:  # fmt: skip
    """Cs and Cd (t,) of constraints, as `substep_coefficients` gives those of springs."""
    count, modes = count or world.settings.fewest_substeps, world.constraint_lowest_mode
    keeps, ease = _keeps(world.settings, keeps_constant), ease_of(world.settings, count)
    return _of_substep(world.constraint_coefficients, modes, count, into, keeps, highest, ease)


def ease_of(settings: WorldSettings, count: int) -> float:
    """1 + drag h: how many times as heavily the air lets everything be moved in a substep of a tick of so many."""
    # Where ticks choose their parts, that of a whole tick: the energy of a spring does not depend on the parts.
    return 1.0 + settings.drag / (settings.tick_rate * (1 if settings.substeps == AUTO else count))


def _keeps(settings: WorldSettings, keeps_constant: bool) -> int:
    if keeps_constant:
        return ALL_CONSTANT
    return ALL_BUT_FIRM if settings.solver == "direct" and settings.substeps != AUTO else MOTION


def _of_substep(
    coefficients: Pair, lowest_mode: Floats, count: int, into: Pair | None, keeps: int, highest: float, ease: float
) -> Pair:
    # Of nothing there is nothing to copy, which takes a fifth of the tick of a few discs.
    if not len(coefficients[0]):
        return coefficients
    if count == 1 and ease == 1.0:
        return coefficients
    pair = into or (np.empty_like(coefficients[0]), np.empty_like(coefficients[1]))
    for part, whole in zip(pair, coefficients, strict=True):
        np.minimum(whole, highest if count > 1 else 1.0, out=part)
    if keeps == MOTION:
        halve(*pair, lowest_mode, count)
    else:
        divide(*pair, lowest_mode, count, keeps == ALL_BUT_FIRM)
    if ease != 1.0:
        weigh_down(*pair, ease)
    return pair


@kernel
def weigh_down(stiffness: Floats, damping: Floats, ease: float) -> None:
    """Turn Cs and Cd (m,), in place, into those of springs of the same k and c whose ends are heavier by a factor.

    The air takes part in every step: (1 + drag h) m (v' - v*) = J.
    """
    for s in range(stiffness.shape[0]):
        whole = damping[s] + (1.0 - damping[s]) * ease
        stiffness[s] /= whole
        damping[s] /= whole


@kernel
def halve(stiffness: Floats, damping: Floats, lowest_mode: Floats, substeps: int) -> None:
    """Turn Cs and Cd (m,) of a tick into those of a substep, in place; substeps is a power of two.

    lowest_mode (m,): that of the body whose firmness they come from, 0: they are their own.
    """
    # One exact halving of h at a time.
    for s in range(stiffness.shape[0]):
        count = 1
        while count < substeps:
            stiffness[s], damping[s] = half_step_of_network(stiffness[s], damping[s], lowest_mode[s])
            count *= 2


@kernel
def divide(stiffness: Floats, damping: Floats, lowest_mode: Floats, parts: int, firm: bool) -> None:
    """The same with the k of the tick in one part (`part_of_network`); firm: not of bodies that have a firmness."""
    if parts > 1:
        for s in range(stiffness.shape[0]):
            # What is rigid, k at its cap, stays as rigid as a step lets it be.
            if firm and (lowest_mode[s] > 0.0 or damping[s] > HIGHEST_COEFFICIENT):
                count = 1
                while count < parts:
                    stiffness[s], damping[s] = half_step_of_network(stiffness[s], damping[s], lowest_mode[s])
                    count *= 2
            else:
                stiffness[s], damping[s] = part_of_network(stiffness[s], damping[s], lowest_mode[s], parts)


@kernel
def _fastest_turn(
    velocity: Floats, inverse_mass: Floats, particle_a: NDArray[np.int32], particle_b: NDArray[np.int32],
    rest_length: Floats, spring_active: NDArray[np.bool_], grab_spring: int, grabs: int, h: float, shortest: Floats,
) -> float:  # fmt: skip
    # Largest ((|v_b - v_a| h) / L)^2; a grab's spring, which has no length, counts by the shortest spring at its end.
    largest = 0.0
    for s in range(rest_length.shape[0]):
        held = grab_spring <= s < grab_spring + grabs
        if not spring_active[s] or held:
            continue
        length = rest_length[s]
        a = particle_a[s]
        b = particle_b[s]
        if not length > 0.0 or (inverse_mass[a] == 0.0 and inverse_mass[b] == 0.0):
            continue
        u = (velocity[b, 0] - velocity[a, 0]) * h / length
        v = (velocity[b, 1] - velocity[a, 1]) * h / length
        turn = u * u + v * v
        if not turn <= largest:
            largest = turn
        for grab in range(grabs):
            if spring_active[grab_spring + grab]:
                end = particle_b[grab_spring + grab]
                if end in (a, b) and (shortest[grab] == 0.0 or length < shortest[grab]):
                    shortest[grab] = length
    for grab in range(grabs):
        s = grab_spring + grab
        if spring_active[s] and shortest[grab] > 0.0:
            u = (velocity[particle_b[s], 0] - velocity[particle_a[s], 0]) * h / shortest[grab]
            v = (velocity[particle_b[s], 1] - velocity[particle_a[s], 1]) * h / shortest[grab]
            turn = u * u + v * v
            if not turn <= largest:
                largest = turn
    return largest


def substep_count(world: World) -> int:
    """Substeps of the coming tick: as set, or, for "auto", the fewest (1, 2, 4, 8) in which no spring turns too far.

    Looked at are the springs' ends as they move at the tick's start, cursors of grabs and moved pins included.
    """
    if world.settings.substeps != AUTO:
        return world.settings.substeps
    # A whole tick's turn, halved at each doubling of the substeps.
    grabs = GRAB_COUNT if world.grab_spring >= 0 else 0
    turn = _fastest_turn(
        world.velocity, world.inverse_mass, world.particle_a, world.particle_b, world.rest_length, world.spring_active,
        world.grab_spring, grabs, 1.0 / world.settings.tick_rate, np.zeros(GRAB_COUNT),
    )  # fmt: skip
    count = 1
    while count < MOST_AUTO and not turn <= (LARGEST_TURN * count) * (LARGEST_TURN * count):
        count *= 2
    return count
