"""Ramps: Cs, Cd, wanted areas, gravity and air go from what they are to a goal in so many ticks.

Each tick covers a part of the rest of the way, w = (2 n - 1) / n^2 with n ticks left: all of it goes as 1 - (n / N)^2,
fast at first and gently at its end, from wherever a new goal found it. Cd and numbers of the settings go so themselves.
Cs goes by how far a spring gives way under a load, which is what is seen of it: in the direct solver by

    y = (1 - Cd) / Cs,   in the others by   y = 1 / Cs,

so that a body that sags rises or sinks evenly. By Cs itself most of its height would come back in the last ticks.
"""

from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.settings import DIRECT
from sandbox.physics.state import GoodValues, State

# Added to Cs and 1 - Cd, so that a spring of Cs 0 gives way by a number.
LEAST_STIFFNESS, LEAST_GIVE = 1e-3, 1.0 - HIGHEST_COEFFICIENT


@scalar_kernel
def way_of_tick(ticks: int) -> float:
    """The part of the rest of its way that a ramp goes in a tick, with so many ticks left, this one too."""
    # 1 - ((n - 1) / n)^2
    return (2.0 * ticks - 1.0) / (1.0 * ticks * ticks)


@scalar_kernel
def next_pair(
    stiffness: float, damping: float, stiffness_goal: float, damping_goal: float, ticks: int, solver: int
) -> tuple[float, float]:
    """Cs and Cd of a tick, from those of the tick before; ticks: left until the goal, this one too."""
    if ticks <= 1:
        return stiffness_goal, damping_goal
    part = way_of_tick(ticks)
    damps = damping + part * (damping_goal - damping)
    here, there, after = 1.0, 1.0, 1.0
    if solver == DIRECT:
        here, there, after = 1.0 - damping + LEAST_GIVE, 1.0 - damping_goal + LEAST_GIVE, 1.0 - damps + LEAST_GIVE
    gives, wanted = here / (stiffness + LEAST_STIFFNESS), there / (stiffness_goal + LEAST_STIFFNESS)
    found = after / (gives + part * (wanted - gives)) - LEAST_STIFFNESS
    # Between the two but for rounding.
    return min(max(found, min(stiffness, stiffness_goal)), max(stiffness, stiffness_goal)), damps


@inner_kernel
def _ramp_springs(state: State, good: GoodValues, solver: int) -> None:
    stiffness, damping, ticks = state.stiffness, state.damping, state.ramp_ticks
    firm, damps, mode = state.stiffness_goal, state.damping_goal, state.lowest_mode_goal
    for s in range(ticks.shape[0]):
        if ticks[s] <= 0:
            continue
        stiffness[s], damping[s] = next_pair(stiffness[s], damping[s], firm[s], damps[s], ticks[s], solver)
        ticks[s] -= 1
        if ticks[s] == 0:
            state.lowest_mode[s] = mode[s]
            firm[s] = damps[s] = mode[s] = 0.0
        good.stiffness[s], good.damping[s], good.lowest_mode[s] = stiffness[s], damping[s], state.lowest_mode[s]
        state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED


@inner_kernel
def disturb_corners(state: State, k: int) -> None:
    """Begin new energy banks for the bodies of a constraint."""
    first = state.constraint_first[k]
    for corner in range(first, first + state.constraint_corners[k]):
        state.energy_bank[state.corner_particle[corner]] = BANK_UNOPENED


@inner_kernel
def _ramp_constraints(state: State, good: GoodValues, solver: int) -> None:
    stiffness, damping, ticks = state.constraint_stiffness, state.constraint_damping, state.constraint_ramp_ticks
    firm, damps, mode = state.constraint_stiffness_goal, state.constraint_damping_goal, state.constraint_lowest_mode_goal
    for k in range(ticks.shape[0]):
        if ticks[k] <= 0:
            continue
        stiffness[k], damping[k] = next_pair(stiffness[k], damping[k], firm[k], damps[k], ticks[k], solver)
        ticks[k] -= 1
        if ticks[k] == 0:
            state.constraint_lowest_mode[k] = mode[k]
            firm[k] = damps[k] = mode[k] = 0.0
        good.constraint_stiffness[k], good.constraint_damping[k] = stiffness[k], damping[k]
        good.constraint_lowest_mode[k] = state.constraint_lowest_mode[k]
        disturb_corners(state, k)


@inner_kernel
def _ramp_areas(state: State, good: GoodValues) -> None:
    rest, goal, ticks = state.constraint_rest, state.constraint_rest_goal, state.constraint_rest_ticks
    for k in range(ticks.shape[0]):
        if ticks[k] <= 0:
            continue
        rest[k, 0] = goal[k] if ticks[k] == 1 else rest[k, 0] + way_of_tick(ticks[k]) * (goal[k] - rest[k, 0])
        good.constraint_rest[k, 0] = rest[k, 0]
        ticks[k] -= 1
        if ticks[k] == 0:
            goal[k] = 0.0
        disturb_corners(state, k)


@inner_kernel
def _ramp_settings(state: State, numbers: Floats) -> None:
    goal, ticks = state.setting_goal, state.setting_ticks
    for k in range(ticks.shape[0]):
        if ticks[k] <= 0:
            continue
        numbers[k] = goal[k] if ticks[k] == 1 else numbers[k] + way_of_tick(ticks[k]) * (goal[k] - numbers[k])
        ticks[k] -= 1
        if ticks[k] == 0:
            goal[k] = 0.0


@inner_kernel
def follow_ramps(state: State, good: GoodValues, numbers: Floats, solver: int) -> None:
    """Bring all that goes to a goal to what it is in the coming tick; numbers: the settings; solver: see settings.py."""
    _ramp_springs(state, good, solver)
    _ramp_constraints(state, good, solver)
    _ramp_areas(state, good)
    _ramp_settings(state, numbers)


@inner_kernel
def begin_spring(state: State, good: GoodValues, s: int, stiffness: float, damping: float, duration: int) -> None:
    """Bring a spring to Cs and Cd of its own in so many ticks; 0: at once."""
    state.ramp_ticks[s] = duration
    state.stiffness_goal[s] = stiffness if duration > 0 else 0.0
    state.damping_goal[s] = damping if duration > 0 else 0.0
    state.lowest_mode_goal[s] = 0.0
    if duration == 0:
        state.stiffness[s] = good.stiffness[s] = stiffness
        state.damping[s] = good.damping[s] = damping
        state.lowest_mode[s] = good.lowest_mode[s] = 0.0
    state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED


@inner_kernel
def begin_constraint(state: State, good: GoodValues, k: int, stiffness: float, damping: float, duration: int) -> None:
    """Bring a constraint to Cs and Cd of its own in so many ticks; 0: at once."""
    state.constraint_ramp_ticks[k] = duration
    state.constraint_stiffness_goal[k] = stiffness if duration > 0 else 0.0
    state.constraint_damping_goal[k] = damping if duration > 0 else 0.0
    state.constraint_lowest_mode_goal[k] = 0.0
    if duration == 0:
        state.constraint_stiffness[k] = good.constraint_stiffness[k] = stiffness
        state.constraint_damping[k] = good.constraint_damping[k] = damping
        state.constraint_lowest_mode[k] = good.constraint_lowest_mode[k] = 0.0
    disturb_corners(state, k)


@inner_kernel
def set_number(state: State, numbers: Floats, place: int, value: float, duration: int) -> None:
    """Bring a number of the settings to a value in so many ticks; 0: at once."""
    state.setting_ticks[place] = duration
    state.setting_goal[place] = value if duration > 0 else 0.0
    if duration == 0:
        numbers[place] = value

