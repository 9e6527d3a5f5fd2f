"""Ramping: begins ramps (ramps.py) of areas and of everything in a world, and changes what a tick is solved by."""

from sandbox.physics.arrays import Floats, SlotRows, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED, GRAB_MATERIAL
from sandbox.physics.settings import IS_AUTO, ITERATIONS, SOLVER, SUBSTEP_COUNT, WARM_START
from sandbox.physics.state import GoodValues, State

# Cs and Cd from which what is made whole firms up: soft, and so damped that it creeps to its form rather than leaps.
SOFT_STIFFNESS, SOFT_DAMPING = 0.05, 0.9


@inner_kernel
def inflate(state: State, good: GoodValues, areas: SlotRows, body: int, inflation: float, duration: int) -> None:
    """Let each area of a body, by its row in areas, want this multiple of its form's, in so many ticks; 0: at once.

    areas (k, 2): first constraint of each body that keeps areas, and the one behind its last.
    """
    now, ticks = state.constraint_area_now, state.constraint_area_ticks
    for k in range(areas[body, 0], areas[body, 1]):
        if state.constraint_kind[k] != AREA:
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
