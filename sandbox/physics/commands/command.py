"""Commands: what people do to a world between ticks, on its arrays, as one kernel. None of it is part of a tick.

Whoever gives a command, by mouse, script, page, link or rule: the kernel asks whether what it names is there and in
range, whether the level lets hands do it and whether its budget is left, in this order; then it does it and takes it
from the budget. A command that is refused changes nothing. Whether a level lets hands give a kind of command, touch a
thing, and how often, lies in state: one that says nothing of hands has no rows of the family DEED. Rules of a level and
programs may do everything.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_flags, new_slots, new_tuple
from sandbox.physics.arrays import Flags, Floats, SlotRows, Slots
from sandbox.physics.collision.pieces import PieceScratch, end_constraints, part
from sandbox.physics.commands.changes import (
    IS_PINNED,
    NO_PLACE,
    NOTHING_TOUCHES,
    free_body,
    grab,
    is_body,
    move_listed,
    pin,
    push,
    release,
    scale_mass,
    set_air,
    set_coefficients,
    shake,
    unpin,
)
from sandbox.physics.commands.cutting import ASKED, ROWS_MISSING, cut_along
from sandbox.physics.components import list_body
from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.marks import BANK_UNOPENED, LONGEST_RAMP
from sandbox.physics.ramps import firm_up, inflate, set_number, set_warm_start, solve_by
from sandbox.physics.settings import (
    GRAVITY_X,
    IS_AUTO,
    ITERATIONS,
    SOLVER,
    SOLVER_NAMES,
    SUBSTEP_COUNT,
    SUBSTEPS,
    TICK_RATE,
)
from sandbox.physics.softness.kernels.firm import (
    SPRINGS,
    Firming,
    FormModes,
    Forms,
    body_of_number,
    count_pieces_of,
    firm,
    number_of_spring,
)
from sandbox.physics.softness.kernels.reach import (
    BY_FREQUENCY,
    BY_SAG,
    BY_WOBBLE,
    NO_BODY,
    NO_HEIGHT,
    NOT_STIFF,
    OUT_OF_REACH,
    Asked,
)
from sandbox.physics.state import GoodValues, State
from sandbox.physics.topology.sorting import list_ends

GRAB, MOVE_GRAB, RELEASE, PIN, UNPIN, CUT, BREAK, PART, SET_COEFFICIENTS, DRIVE, PUSH, SHAKE = range(12)
SET_GRAVITY, SET_AIR, HOLD_KEY, SOFTEN, SET_INFLATION, SCALE_MASS, MOVE_BODY = range(12, 19)
SET_SOLVER, SET_FIRMNESS, FREE, REMOVE, ADD_PARTICLE, ADD_SPRING, ADD_BODY = range(19, 26)
# Why a command was refused, and nothing was changed. A result is -(reason + REASONS k): k is the place among slots and
# numbers, counted through, of what it is about.
REASONS = 64
(
    BAD, FORBIDDEN, UNTOUCHABLE, EXHAUSTED, HOLDS, HOLDS_NOTHING, TOO_PINNED, PINNED, NOT_PINNED, NOTHING_THERE,
    NOTHING_MOVES, TOO_FAR, TOO_HEAVY, NOTHING_TO_FREE, BODY_PINNED, NO_FREE_PLACE,
    UNSAID, NO_FIRMNESS, FLAT, BEYOND_REACH, NO_ROWS, TOO_MANY,
) = range(2, 24)  # fmt: skip
MOST_ITERATIONS = 1000
_SOLVER_COUNT, _MOST_SUBSTEPS = len(SOLVER_NAMES), SUBSTEPS[-1]
# Who gives a command.
HAND, RULE, PROGRAM = range(3)
# Why a kind of command is refused: hands may not give it, its budget is spent, or it is about something that they may
# not touch.
GRANTED, NOT_ALLOWED, SPENT, UNTOUCHED = range(4)
# Kernels beside `command` that ask answer -(reason DENIED + k); k: the place of what it is about.
DENIED = 2**40


class Commanded(NamedTuple):
    """The arrays that commands change; a world block begins with them.

    numbers, choices: the settings, see settings.py. areas (k, 2): of each body that keeps areas its first constraint,
    and the one behind its last. forms, modes: of bodies that may be stiff by their form.
    """

    state: State
    good: GoodValues
    numbers: Floats
    choices: Slots
    areas: SlotRows
    forms: Forms
    modes: FormModes


class CutScratch(NamedTuple):
    """Scratch of a cut, of zeros: what is taken out; the pieces; the springs of each particle."""

    gone: Annotated[Flags, "springs"]
    pieces: PieceScratch
    start: Annotated[Slots, "particles + 1"]
    listed: Annotated[Slots, "2 * springs"]


@kernel
def command(pointer: Bundle[Commanded], arena: Arena, giver: int, kind: int, slots: Slots, numbers: Floats) -> int:
    """Carry out a command of KINDS that a hand, a rule or a program gives: 0, NO_ARENA, or why it is refused."""
    world = unpack(pointer)
    state, needs = world.state, 1
    bad = _first_bad(world, kind, slots, numbers)
    if bad >= 0:
        return _refused(BAD, bad)
    result = _unfit(state, kind, slots)
    if result == 0 and kind == CUT:
        needs = _different(slots, state.law.shape[0], arena)
        result = NO_ARENA if needs < 0 else 0
    if result == 0 and giver == HAND:
        result = _not_for_hands(world, arena, kind, slots, needs)
    if result == 0:
        result = _carry_out(world, arena, kind, slots, numbers)
    if result == 0:
        spend(state, giver, kind, needs)
    return result


@inner_kernel
def _first_bad(world: Commanded, kind: int, slots: Slots, numbers: Floats) -> int:
    # The first of slots and numbers, counted through, that is not there, not finite or out of range; -1: none.
    state = world.state
    particles, springs = state.owner.shape[0], state.law.shape[0]
    if kind in (GRAB, MOVE_GRAB, RELEASE):
        has_hand = 0 <= slots[2] < state.hand_strength.shape[0]
        if not has_hand or not 0 <= slots[0] + slots[2] < particles or not 0 <= slots[1] + slots[2] < springs:
            return 2
    place = _place_of_particle(kind)
    if place >= 0 and not is_body(state, slots[0], slots[place]):
        return place
    if kind in (CUT, BREAK, PART):
        for k in range(slots.shape[0]):
            if not 0 <= slots[k] < springs or not state.spring_active[slots[k]] or state.material[slots[k]] < 0:
                return k
    rows = -1
    if kind == DRIVE:
        rows = state.actuator_value.shape[0]
    elif kind == HOLD_KEY:
        rows = state.key_down.shape[0]
    elif kind == SET_INFLATION:
        rows = world.areas.shape[0]
    if rows >= 0 and not 0 <= slots[0] < rows:
        return 0
    place = _place_of_duration(kind)
    if place >= 0 and not 0 <= slots[place] <= LONGEST_RAMP:
        return place
    for k in range(numbers.shape[0]):
        if not -math.inf < numbers[k] < math.inf:
            return slots.shape[0] + k
    if kind == CUT and numbers.shape[0] not in (ASKED, slots.shape[0] + ASKED):
        return slots.shape[0]
    for k in range(numbers.shape[0] - ASKED if kind == CUT else 0):
        if not 0.0 <= numbers[k] <= 1.0:
            return slots.shape[0] + k
    if kind == SET_COEFFICIENTS and slots[0] != 0 and not 0 <= slots[1] < slots[5]:
        return 1
    return _first_bad_choice(slots) if kind == SET_SOLVER else -1


@inner_kernel
def _place_of_particle(kind: int) -> int:
    if kind == GRAB:
        return 3
    return 1 if kind in (PIN, UNPIN, SCALE_MASS, MOVE_BODY, FREE) else -1


@inner_kernel
def _place_of_duration(kind: int) -> int:
    if kind == SET_GRAVITY:
        return 0
    if kind == SET_INFLATION:
        return 1
    if kind == SET_AIR:
        return 2
    if kind == SOFTEN:
        return 3
    if kind in (SET_COEFFICIENTS, SET_FIRMNESS):
        return 4
    return 7 if kind == SET_SOLVER else -1


@inner_kernel
def _first_bad_choice(slots: Slots) -> int:
    # Substeps are a power of two, or 0, by which each tick chooses.
    if slots[0] != 0 and not 0 <= slots[1] < _SOLVER_COUNT:
        return 1
    if slots[2] != 0 and not 1 <= slots[3] <= MOST_ITERATIONS:
        return 3
    substeps = slots[5]
    if slots[4] != 0 and (not 0 <= substeps <= _MOST_SUBSTEPS or (substeps & (substeps - 1)) != 0):
        return 5
    return -1


@inner_kernel
def _unfit(state: State, kind: int, slots: Slots) -> int:
    # Why what is there cannot be done to as it is; 0: it can.
    if kind in (GRAB, MOVE_GRAB, RELEASE):
        holds = state.spring_active[slots[1] + slots[2]]
        if holds and kind == GRAB:
            return _refused(HOLDS, 2)
        if not holds and kind != GRAB:
            return _refused(HOLDS_NOTHING, 2)
    if kind == SET_FIRMNESS and ((slots[1] != 0) == (slots[2] != 0) or (slots[1] != 0 and slots[3] != 0)):
        return _refused(UNSAID, 0)
    if kind == GRAB and state.inverse_mass[slots[3]] == 0.0:
        return _refused(TOO_PINNED, 3)
    if kind == PIN and state.inverse_mass[slots[1]] == 0.0:
        return _refused(PINNED, 1)
    if kind == UNPIN and state.inverse_mass[slots[1]] > 0.0:
        return _refused(NOT_PINNED, 1)
    return 0


@inner_kernel
def _different(slots: Slots, bound: int, arena: Arena) -> int:
    # How many different slots, all below a bound, a list has; below 0: the arena is full.
    begin(arena)
    seen, count = new_flags(arena, bound), 0
    if is_full(arena):
        return -1
    for k in range(slots.shape[0]):
        count += 0 if seen[slots[k]] else 1
        seen[slots[k]] = True
    return count


@inner_kernel
def _not_for_hands(world: Commanded, arena: Arena, kind: int, slots: Slots, needs: int) -> int:
    # Why hands may not give a command whose slots are there; 0: they may.
    state = world.state
    why = refusal(state, HAND, kind, needs)
    if why == NOT_ALLOWED:
        return _refused(FORBIDDEN, 0)
    place = _place_of_particle(kind)
    if place >= 0 and state.untouchable[slots[place]]:
        return _refused(UNTOUCHABLE, place)
    if kind == CUT:
        for k in range(slots.shape[0]):
            if state.spring_untouchable[slots[k]]:
                return _refused(UNTOUCHABLE, k)
    if kind == SET_INFLATION:
        first = world.areas[slots[0], 0]
        if first < world.areas[slots[0], 1] and state.untouchable[state.corner_particle[state.constraint_first[first]]]:
            return _refused(UNTOUCHABLE, 0)
    if kind == SET_FIRMNESS:
        begin(arena)
        body, _ = body_of_number(state, world.forms, slots[0], arena)
        if is_full(arena):
            return NO_ARENA
        if body >= 0 and state.spring_untouchable[world.forms.spring[world.forms.first[body, SPRINGS]]]:
            return _refused(UNTOUCHABLE, 0)
    return 0 if why == GRANTED else _refused(EXHAUSTED, 0)


@inner_kernel
def refusal(state: State, giver: int, kind: int, needs: int) -> int:
    """GRANTED, or why a kind of command, which takes so many of its budget, is refused."""
    if giver != HAND or state.deed_refused.shape[0] == 0:
        return GRANTED
    if state.deed_refused[kind]:
        return NOT_ALLOWED
    row = state.deed_budget[kind]
    return SPENT if row >= 0 and state.counter[row] < needs else GRANTED


@inner_kernel
def _refused(reason: int, place: int) -> int:
    return -(reason + REASONS * place)


@inner_kernel
def spend(state: State, giver: int, kind: int, needs: int) -> None:
    """Take the cost of a command that was carried out from its budget."""
    if giver == HAND and state.deed_refused.shape[0] > 0:
        row = state.deed_budget[kind]
        if row >= 0:
            state.counter[row] -= needs


@inner_kernel
def denied(why: int, place: int) -> int:
    """The answer of a kernel that refuses."""
    return -(why * DENIED + place)


@inner_kernel
def _carry_out(world: Commanded, arena: Arena, kind: int, slots: Slots, numbers: Floats) -> int:
    state, good = world.state, world.good
    if kind == GRAB:
        grab(state, slots, numbers)
    elif kind == MOVE_GRAB:
        cursor = slots[0] + slots[2]
        for axis in range(2):
            state.velocity[cursor, axis] = (numbers[axis] - state.position[cursor, axis]) * numbers[2]
    elif kind == RELEASE:
        release(state, slots)
    elif kind == PIN:
        pin(state, slots[1])
    elif kind == UNPIN:
        unpin(state, slots[1])
    elif kind in (CUT, BREAK, PART):
        begin(arena)
        work = new_tuple(CutScratch, arena, particles=state.owner.shape[0], springs=state.law.shape[0])
        missing = NO_ARENA if is_full(arena) else 0
        if missing == 0 and kind == CUT and numbers.shape[0] > ASKED:
            missing = cut_along(state, good, slots, numbers, arena)
        if missing != 0:
            return NO_ARENA if missing < 0 else _refused(NO_ROWS if missing == ROWS_MISSING else TOO_MANY, 0)
        cut(state, good, slots, kind, work)
    elif kind == SET_COEFFICIENTS:
        set_coefficients(state, good, slots, numbers)
    elif kind == SET_GRAVITY:
        for axis in range(2):
            set_number(state, world.numbers, GRAVITY_X + axis, numbers[axis], slots[0])
    elif kind == SET_AIR:
        set_air(state, world.numbers, slots, numbers)
    elif kind == DRIVE:
        state.actuator_value[slots[0]] = numbers[0]
    elif kind in (SET_FIRMNESS, SOFTEN):
        return _soften(world, kind, slots, numbers, arena)
    elif kind == HOLD_KEY:
        state.key_down[slots[0]] = slots[1] != 0
    elif kind == PUSH:
        return 0 if push(state, good, slots[0], numbers) > 0 else _refused(NOTHING_THERE, 0)
    elif kind == SHAKE:
        return 0 if shake(state, good, slots[0], numbers) > 0 else _refused(NOTHING_MOVES, 0)
    elif kind == SET_INFLATION:
        inflate(state, good, world.areas, slots[0], numbers[0], slots[1])
    elif kind == SCALE_MASS:
        return 0 if scale_mass(state, good, slots[1], numbers[0]) else _refused(TOO_HEAVY, 1)
    elif kind == MOVE_BODY:
        begin(arena)
        label, body = new_slots(arena, state.owner.shape[0]), new_slots(arena, state.owner.shape[0])
        if is_full(arena):
            return NO_ARENA
        count = list_body(state, slots[1], label, body)
        is_moved = move_listed(state, good, body[:count], numbers[0], numbers[1], slots[2] != 0)
        return 0 if is_moved else _refused(TOO_FAR, 1)
    elif kind == FREE:
        return _free(state, good, slots[1], arena)
    elif kind == SET_SOLVER:
        return _set_solver(world, slots, numbers, arena)
    return 0


@inner_kernel
def cut(state: State, good: GoodValues, springs: Slots, kind: int, work: CutScratch) -> None:
    """Take springs out, and the constraints that they were a side of, unless another spring holds that side.

    What falls into pieces becomes several bodies; those of what breaks by itself keep the energy of the body. PART: the
    bodies of springs have lost others already.
    """
    count = state.law.shape[0]
    for k in range(springs.shape[0] if kind != PART else 0):
        work.gone[springs[k]] = True
        state.spring_active[springs[k]] = False
    list_ends(state.particle_a, state.particle_b, count, state.owner.shape[0], work.start, work.listed)
    end_constraints(state, work.start, work.listed, work.gone)
    part(state, good, springs, work.start, work.listed, work.gone, work.pieces)
    for s in range(count):
        if work.gone[s]:
            state.impulse[s, 0] = state.impulse[s, 1] = state.tension[s] = 0.0
            if kind == CUT:
                state.energy_bank[state.particle_a[s]] = state.energy_bank[state.particle_b[s]] = BANK_UNOPENED


@inner_kernel
def _soften(world: Commanded, kind: int, slots: Slots, numbers: Floats, arena: Arena) -> int:
    # What hands ask under the gravity of now, of a body or of a piece; or what a level asks of the whole of a body.
    found = numbers[numbers.shape[0] - 2 : numbers.shape[0]]
    way = slots[2]
    value, second, duration = numbers[0], numbers[1], slots[3]
    x, y, is_whole = numbers[2], numbers[3], kind == SOFTEN and slots[1] != 0
    if kind == SET_FIRMNESS:
        way = BY_SAG if slots[1] != 0 else (BY_WOBBLE if slots[3] != 0 else BY_FREQUENCY)
        value, second, duration = numbers[0] if way == BY_SAG else numbers[1], numbers[2], slots[4]
        x, y = world.numbers[GRAVITY_X], world.numbers[GRAVITY_X + 1]
    firming = Firming(Asked(way, value, second), x, y, 1.0 * world.choices[TICK_RATE], duration)
    code = firm(world.state, world.good, world.forms, world.modes, arena, slots[0], is_whole, firming, found)
    if code == NO_BODY:
        return _refused(BAD, 0)
    if code == NOT_STIFF:
        return _refused(NO_FIRMNESS, 0)
    if code == NO_HEIGHT:
        return _refused(FLAT, 0)
    return _refused(BEYOND_REACH, 0) if code == OUT_OF_REACH else code


@inner_kernel
def _set_solver(world: Commanded, slots: Slots, numbers: Floats, arena: Arena) -> int:
    # With a duration everything is soft at first by another solver.
    begin(arena)
    wanted = new_slots(arena, world.choices.shape[0])
    if is_full(arena):
        return NO_ARENA
    for place in range(wanted.shape[0]):
        wanted[place] = world.choices[place]
    if slots[0] != 0:
        wanted[SOLVER] = slots[1]
    if slots[2] != 0:
        wanted[ITERATIONS] = slots[3]
    if slots[4] != 0:
        wanted[SUBSTEP_COUNT], wanted[IS_AUTO] = slots[5], 1 if slots[5] == 0 else 0
    is_other = wanted[SOLVER] != world.choices[SOLVER]
    numbers[1] = solve_by(world.state, world.choices, wanted)
    if slots[6] != 0:
        set_warm_start(world.state, world.numbers, numbers[0])
    if slots[7] > 0 and is_other:
        firm_up(world.state, slots[7])
    return 0


@inner_kernel
def _free(state: State, good: GoodValues, particle: int, arena: Arena) -> int:
    why = free_body(state, good, arena, particle)
    if why == NOTHING_TOUCHES:
        return _refused(NOTHING_TO_FREE, 1)
    if why == IS_PINNED:
        return _refused(BODY_PINNED, 1)
    return _refused(NO_FREE_PLACE, 1) if why == NO_PLACE else why


@kernel
def count_pieces(arena: Arena, pointer: Bundle[Commanded], count: Slots) -> int:
    """How many pieces each body (b,) is that may be stiff by its form; NO_ARENA: the arena is too small."""
    world = unpack(pointer)
    return count_pieces_of(world.state, world.forms, arena, count)


@kernel
def form_of_spring(arena: Arena, pointer: Bundle[Commanded], spring: int) -> int:
    """The number of the body, or of the piece of one, that may be stiff by its form and has a spring; -1: none has."""
    world = unpack(pointer)
    return number_of_spring(world.state, world.forms, arena, spring)


@kernel
def solve(pointer: Bundle[Commanded], wanted: Slots) -> float:
    """Change solver and substeps, see `solve_by`."""
    world = unpack(pointer)
    return solve_by(world.state, world.choices, wanted)
