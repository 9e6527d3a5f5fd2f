"""Ramps: Cs, Cd, wanted areas, gravity and air go from what they are to what is set, their goal, in so many ticks.

Arrays and settings hold the goals, but for within a tick: it begins with what is in force then, which lies in arrays of
its own between ticks, and puts the goals back at its end.

With n ticks left, this one too, and r = (n - 1) / n, a tick leaves r^2 of the way: fast at first and gently at its end,
from wherever a new goal finds it. That is the way of a wanted area, of gravity and air, and of what a spring gives way
by under a load, y: in the direct solver (1 - Cd) / Cs, in the others 1 / Cs. So what sags sinks or rises evenly.

What firms up gives back what its springs hold, which throws it. So a Cd that rises runs ahead, by r^8: at first the
body becomes tough as honey. And Cs is at least Cd (1 - r^2), so that in each tick it takes back that part of what it
lacks, and all of it in the last one. A heap of the softest jellies becomes rigid in 1.25 s without a leap.
"""

import numpy as np

from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.marks import BANK_UNOPENED, GRAB_MATERIAL
from sandbox.physics.settings import DIRECT, IS_AUTO, ITERATIONS, SOLVER, SUBSTEP_COUNT, WARM_START
from sandbox.physics.state import GoodValues, State, StateArrays

# Added to Cs and 1 - Cd, so that a spring of Cs 0 gives way by a number.
LEAST_STIFFNESS, LEAST_GIVE = 1e-3, 1.0 - HIGHEST_COEFFICIENT
# Rows that have Cs and Cd, by how the names of their arrays begin; and those names.
SPRINGS, CONSTRAINTS = "", "constraint_"
COEFFICIENTS = ("stiffness", "damping", "lowest_mode")
# Cs and Cd from which what is made whole firms up: soft, and so damped that it creeps to its form rather than leaps.
SOFT_STIFFNESS, SOFT_DAMPING = 0.05, 0.9


@scalar_kernel
def way_of_tick(ticks: int) -> float:
    """The part of the rest of its way that a ramp goes in a tick, with so many ticks left, this one too."""
    # 1 - ((n - 1) / n)^2
    return (2.0 * ticks - 1.0) / (1.0 * ticks * ticks)


@scalar_kernel
def _nearer(now: float, goal: float, ticks: int) -> float:
    return goal if ticks <= 1 else now + way_of_tick(ticks) * (goal - now)


@scalar_kernel
def next_pair(
    stiffness: float, damping: float, stiffness_goal: float, damping_goal: float, ticks: int, solver: int
) -> tuple[float, float]:
    """Cs and Cd of a tick, from those of the tick before; ticks: left, this one too. Cs <= Cd stays so."""
    if ticks <= 1:
        return stiffness_goal, damping_goal
    part = way_of_tick(ticks)
    rest = (1.0 - part) * (1.0 - part)
    ahead = 1.0 - rest * rest if damping_goal > damping else part
    damps = damping + ahead * (damping_goal - damping)
    here, there, after = 1.0, 1.0, 1.0
    if solver == DIRECT:
        here, there, after = 1.0 - damping + LEAST_GIVE, 1.0 - damping_goal + LEAST_GIVE, 1.0 - damps + LEAST_GIVE
    gives, wanted = here / (stiffness + LEAST_STIFFNESS), there / (stiffness_goal + LEAST_STIFFNESS)
    found = after / (gives + part * (wanted - gives)) - LEAST_STIFFNESS
    found = min(max(found, min(stiffness, stiffness_goal)), max(stiffness, stiffness_goal))
    return max(found, min(stiffness_goal, damps * part)), damps


@inner_kernel
def _disturb_ends(state: State, s: int) -> None:
    state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED


@inner_kernel
def _disturb_corners(state: State, k: int) -> None:
    first = state.constraint_first[k]
    for corner in range(first, first + state.constraint_corners[k]):
        state.energy_bank[state.corner_particle[corner]] = BANK_UNOPENED


@inner_kernel
def _swap(goal: Floats, now: Floats, k: int) -> None:
    kept = goal[k]
    goal[k] = now[k]
    now[k] = kept


@inner_kernel
def _swap_areas(rest: FloatRows, now: Floats, k: int) -> None:
    kept = rest[k, 0]
    rest[k, 0] = now[k]
    now[k] = kept


@inner_kernel
def begin_ramps(state: State, numbers: Floats, solver: int) -> None:
    """Replace goals by the values of the coming tick; numbers: the settings; solver: see settings.py."""
    ticks, cs, cd = state.ramp_ticks, state.stiffness_now, state.damping_now
    for s in range(ticks.shape[0]):
        if ticks[s] > 0:
            cs[s], cd[s] = next_pair(cs[s], cd[s], state.stiffness[s], state.damping[s], ticks[s], solver)
            _swap(state.stiffness, cs, s)
            _swap(state.damping, cd, s)
            _swap(state.lowest_mode, state.lowest_mode_now, s)
            _disturb_ends(state, s)
    ticks, cs, cd = state.constraint_ramp_ticks, state.constraint_stiffness_now, state.constraint_damping_now
    firm, damps = state.constraint_stiffness, state.constraint_damping
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            cs[k], cd[k] = next_pair(cs[k], cd[k], firm[k], damps[k], ticks[k], solver)
            _swap(firm, cs, k)
            _swap(damps, cd, k)
            _swap(state.constraint_lowest_mode, state.constraint_lowest_mode_now, k)
            _disturb_corners(state, k)
    ticks, area = state.constraint_area_ticks, state.constraint_area_now
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            area[k] = _nearer(area[k], state.constraint_rest[k, 0], ticks[k])
            _swap_areas(state.constraint_rest, area, k)
            _disturb_corners(state, k)
    ticks, now = state.setting_ticks, state.setting_now
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            now[k] = _nearer(now[k], numbers[k], ticks[k])
            _swap(numbers, now, k)


@inner_kernel
def end_ramps(state: State, numbers: Floats) -> None:
    """Put goals back, and end the ramps that have come to theirs."""
    ticks = state.ramp_ticks
    for s in range(ticks.shape[0]):
        if ticks[s] > 0:
            _swap(state.stiffness, state.stiffness_now, s)
            _swap(state.damping, state.damping_now, s)
            _swap(state.lowest_mode, state.lowest_mode_now, s)
            ticks[s] -= 1
            if ticks[s] == 0:
                state.stiffness_now[s] = state.damping_now[s] = state.lowest_mode_now[s] = 0.0
    ticks, mode = state.constraint_ramp_ticks, state.constraint_lowest_mode_now
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            _swap(state.constraint_stiffness, state.constraint_stiffness_now, k)
            _swap(state.constraint_damping, state.constraint_damping_now, k)
            _swap(state.constraint_lowest_mode, mode, k)
            ticks[k] -= 1
            if ticks[k] == 0:
                state.constraint_stiffness_now[k] = state.constraint_damping_now[k] = mode[k] = 0.0
    ticks = state.constraint_area_ticks
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            _swap_areas(state.constraint_rest, state.constraint_area_now, k)
            ticks[k] -= 1
            if ticks[k] == 0:
                state.constraint_area_now[k] = 0.0
    ticks = state.setting_ticks
    for k in range(ticks.shape[0]):
        if ticks[k] > 0:
            _swap(numbers, state.setting_now, k)
            ticks[k] -= 1
            if ticks[k] == 0:
                state.setting_now[k] = 0.0


@inner_kernel
def set_spring(
    state: State, good: GoodValues, s: int, stiffness: float, damping: float, lowest_mode: float, duration: int
) -> None:
    """Set Cs, Cd and lowest mode of a spring, to be in force in so many ticks; 0: at once. Without a lowest mode Cs and
    Cd are its own.

    A lowest mode above 0 is in force from the start, none only at the end: until then what becomes rigid moves as a
    body.
    """
    if state.ramp_ticks[s] == 0 or duration == 0:
        state.stiffness_now[s] = state.stiffness[s] if duration > 0 else 0.0
        state.damping_now[s] = state.damping[s] if duration > 0 else 0.0
        state.lowest_mode_now[s] = state.lowest_mode[s] if duration > 0 else 0.0
    if duration > 0 and lowest_mode > 0.0:
        state.lowest_mode_now[s] = lowest_mode
    state.ramp_ticks[s] = duration
    state.stiffness[s] = good.stiffness[s] = stiffness
    state.damping[s] = good.damping[s] = damping
    state.lowest_mode[s] = good.lowest_mode[s] = lowest_mode
    _disturb_ends(state, s)


@inner_kernel
def set_constraint(
    state: State, good: GoodValues, k: int, stiffness: float, damping: float, lowest_mode: float, duration: int
) -> None:
    """Set Cs, Cd and lowest mode of a constraint, as `set_spring` does."""
    if state.constraint_ramp_ticks[k] == 0 or duration == 0:
        state.constraint_stiffness_now[k] = state.constraint_stiffness[k] if duration > 0 else 0.0
        state.constraint_damping_now[k] = state.constraint_damping[k] if duration > 0 else 0.0
        state.constraint_lowest_mode_now[k] = state.constraint_lowest_mode[k] if duration > 0 else 0.0
    if duration > 0 and lowest_mode > 0.0:
        state.constraint_lowest_mode_now[k] = lowest_mode
    state.constraint_ramp_ticks[k] = duration
    state.constraint_stiffness[k] = good.constraint_stiffness[k] = stiffness
    state.constraint_damping[k] = good.constraint_damping[k] = damping
    state.constraint_lowest_mode[k] = good.constraint_lowest_mode[k] = lowest_mode
    _disturb_corners(state, k)


@inner_kernel
def set_number(state: State, numbers: Floats, place: int, value: float, duration: int) -> None:
    """Set a number of the settings, to be in force in so many ticks; 0: at once."""
    if state.setting_ticks[place] == 0 or duration == 0:
        state.setting_now[place] = numbers[place] if duration > 0 else 0.0
    state.setting_ticks[place] = duration
    numbers[place] = value


def in_force(state: StateArrays, family: str) -> tuple[Floats, Floats, Floats]:
    """Cs, Cd and lowest mode of the last tick, of all SPRINGS or CONSTRAINTS; the set ones where none ramps."""
    ramps = getattr(state, f"{family}ramp_ticks") > 0
    stiffness, damping, mode = (
        np.where(ramps, getattr(state, f"{family}{name}_now"), getattr(state, f"{family}{name}"))
        for name in COEFFICIENTS
    )
    return stiffness, damping, mode


@inner_kernel
def _is_of_body(state: State, areas: SlotRows, body: int, k: int) -> bool:
    # Whether a constraint is of a body, or was added to a piece of it by a cut.
    for b in range(areas.shape[0]):
        if areas[b, 0] <= k < areas[b, 1]:
            return b == body
    owner, is_piece = state.owner[state.corner_particle[state.constraint_first[k]]], False
    for other in range(areas[body, 0], areas[body, 1]):
        own = state.owner[state.corner_particle[state.constraint_first[other]]]
        is_piece = is_piece or (state.constraint_active[other] and own == owner)
    return is_piece


@inner_kernel
def inflate(state: State, good: GoodValues, areas: SlotRows, body: int, inflation: float, duration: int) -> None:
    """Let each area of a body, by its row in areas, want this multiple of its form's, in so many ticks; 0: at once.

    areas (k, 2): first constraint of each body that keeps areas, and the one behind its last.
    """
    now, ticks = state.constraint_area_now, state.constraint_area_ticks
    for k in range(state.constraint_kind.shape[0]):
        if state.constraint_kind[k] != AREA or not _is_of_body(state, areas, body, k):
            continue
        if ticks[k] == 0 or duration == 0:
            now[k] = state.constraint_rest[k, 0] if duration > 0 else 0.0
        ticks[k] = duration
        state.constraint_rest[k, 0] = inflation * state.constraint_rest[k, 1]
        good.constraint_rest[k, 0] = state.constraint_rest[k, 0]
        first = state.constraint_first[k]
        for corner in range(first, first + state.constraint_corners[k]):
            state.energy_bank[state.corner_particle[corner]] = BANK_UNOPENED


@inner_kernel
def firm_up(state: State, duration: int) -> None:
    """Make every spring and constraint soft at once, and let what is set be in force again in so many ticks."""
    for s in range(state.law.shape[0]):
        if state.material[s] == GRAB_MATERIAL:
            continue
        ramps = state.ramp_ticks[s] > 0
        stiffness = state.stiffness_now[s] if ramps else state.stiffness[s]
        damping = state.damping_now[s] if ramps else state.damping[s]
        state.lowest_mode_now[s] = state.lowest_mode_now[s] if ramps else state.lowest_mode[s]
        state.stiffness_now[s], state.damping_now[s] = min(stiffness, SOFT_STIFFNESS), max(damping, SOFT_DAMPING)
        state.ramp_ticks[s] = duration
    mode = state.constraint_lowest_mode_now
    for k in range(state.constraint_kind.shape[0]):
        if not state.constraint_active[k]:
            continue
        ramps = state.constraint_ramp_ticks[k] > 0
        stiffness = state.constraint_stiffness_now[k] if ramps else state.constraint_stiffness[k]
        damping = state.constraint_damping_now[k] if ramps else state.constraint_damping[k]
        mode[k] = mode[k] if ramps else state.constraint_lowest_mode[k]
        state.constraint_stiffness_now[k] = min(stiffness, SOFT_STIFFNESS)
        state.constraint_damping_now[k] = max(damping, SOFT_DAMPING)
        state.constraint_ramp_ticks[k] = duration
    for p in range(state.owner.shape[0]):
        state.energy_bank[p] = BANK_UNOPENED


@inner_kernel
def _fewest(choices: Slots) -> float:
    return 1.0 if choices[IS_AUTO] != 0 else 1.0 * choices[SUBSTEP_COUNT]


@inner_kernel
def solve_by(state: State, choices: Slots, wanted: Slots) -> float:
    """Solve by other choices (settings.py) from now on. Another solver begins what solvers keep anew; where substeps
    become auto, or are no more, energy banks begin anew, and kept impulses become those of a step of the other length.

    By what impulses of the last step's contacts, which are not part of `state`, are to be multiplied.
    """
    factor = 1.0
    if choices[SOLVER] != wanted[SOLVER]:
        factor = 0.0
        for p in range(state.owner.shape[0]):
            for axis in range(2):
                state.slow_velocity[p, axis] = state.velocity[p, axis]
            state.energy_bank[p] = BANK_UNOPENED
        for hand in range(state.hand_strength.shape[0]):
            state.hand_force[hand, 0] = state.hand_force[hand, 1] = 0.0
    if choices[IS_AUTO] != wanted[IS_AUTO]:
        factor *= _fewest(choices) / _fewest(wanted)
        for p in range(state.owner.shape[0]):
            state.energy_bank[p] = BANK_UNOPENED
    if factor != 1.0:
        for s in range(state.law.shape[0]):
            for axis in range(2):
                state.impulse[s, axis] = _times(state.impulse[s, axis], factor)
            state.tension[s] = _times(state.tension[s], factor)
        for part in range(state.actuator_value.shape[0]):
            state.actuator_impulse[part] = _times(state.actuator_impulse[part], factor)
    for place in (SOLVER, SUBSTEP_COUNT, IS_AUTO, ITERATIONS):
        choices[place] = wanted[place]
    return factor


@inner_kernel
def _times(value: float, factor: float) -> float:
    # Without the sign of 0, and whatever is not finite goes.
    return value * factor if factor != 0.0 else 0.0


@inner_kernel
def set_warm_start(state: State, numbers: Floats, warm_start: float) -> None:
    """Set the warm start, in force at once."""
    if numbers[WARM_START] != warm_start:
        state.setting_now[WARM_START] = 0.0
        state.setting_ticks[WARM_START] = 0
    numbers[WARM_START] = warm_start
