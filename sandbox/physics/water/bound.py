"""Bound: lift gives no more energy in a step than the water loses, whichever way a body goes.

Lift is made for the way that a body would take as a whole, which nothing holds (push.py). What is soft, lands or is let
go takes another. At the velocities after the springs, and places that belong to them (lift.py), lift has given

    h F (v + v') / 2 + U(x + h v' / 2) - U(x - h v / 2)

too much. Where that is above 0, as much energy is taken: first of what moves beside the motion as a whole, of what is
held of all, and then of how it rises. Drag that acts on a velocity which lift has turned round would give energy, too, and counts as lift.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.settings import GRAVITY_Y
from sandbox.physics.state import State
from sandbox.physics.water.displacers import (
    ALLOWED,
    BY_CONTACTS,
    EXCESS,
    FY,
    HELD,
    HIGH,
    LOW,
    MASS,
    MOVES,
    PART,
    PX,
    PY,
    RISE,
    RXX,
    RXY,
    RYY,
    SWING,
    TOOK_X,
    UNDER,
    UNDONE,
    U,
    V,
    Water,
)
from sandbox.physics.water.lift import AFTER, BEFORE, add_energies

# Halvings of the range in which what remains of a motion is looked for, how far from there its energy is looked at, too,
# and what is rounding of that [1].
HALVINGS = 24
NEXT = 1e-6
ROUNDING = 1e-9
# All of the motion, and none of what moves beside the motion as a whole.
WHOLE, AS_ONE = 2.0, 1.0


@inner_kernel
def bound_lift(
    water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats, early: float, h: float
) -> None:  # fmt: skip
    """Slow down what lift has given too much energy in a step of h [s]; start, label, early: see push.py."""
    g, body, load = max(0.0, -numbers[GRAVITY_Y]), water.body, water.load
    if not g > 0.0 or not _find_wet(water, state, label):
        return
    for p in range(label.shape[0]):
        if water.due[p]:
            ahead = 0.0 if water.is_joined[p] else early
            for axis in range(2):
                water.before[p, axis] = state.position[p, axis] - (0.5 * h - ahead) * start[p, axis]
                load[p, U + axis] = state.velocity[p, axis]
                body[label[p], PX + axis] += state.mass[p] * state.velocity[p, axis]
            u, v = state.velocity[p, 0], state.velocity[p, 1]
            fx, fy = load[p, RXX] * u + load[p, RXY] * v, load[p, RXY] * u + load[p, RYY] * v
            body[label[p], EXCESS] += 0.5 * h * load[p, FY] * (start[p, 1] + v)
            body[label[p], TOOK_X] -= 0.5 * h * (fx * (start[p, 0] + u) + fy * (start[p, 1] + v))
    _sum_under(water, state, label, g, BEFORE)
    for p in range(label.shape[0]):
        body[p, EXCESS] -= body[p, UNDER]
    _measure(water, state, start, label, g, early, h)
    found = False
    for p in range(label.shape[0]):
        if label[p] == p and water.due[p]:
            body[p, EXCESS] += body[p, UNDER] + max(0.0, body[p, TOOK_X])
            total = body[p, MOVES] + body[p, UNDER]
            rounding = ROUNDING * (abs(body[p, MOVES]) + ROUNDING * abs(body[p, UNDER]))
            water.due[p] = body[p, EXCESS] > rounding + body[p, SWING] * abs(body[p, MOVES])
            found = found or water.due[p]
            body[p, ALLOWED] = total - body[p, EXCESS]
    if found:
        for p in range(label.shape[0]):
            water.due[p] = water.due[label[p]] and state.inverse_mass[p] > 0.0 and state.particle_active[p]
        _slow(water, state, start, label, g, early, h)


@inner_kernel
def _slow(
    water: Water, state: State, start: FloatRows, label: Slots, g: float, early: float, h: float
) -> None:  # fmt: skip
    # Of the motions of each body that is due, from all of it down to the rise with the least energy, the first one that
    # has no more than is allowed, or that with the least: by halving, with a look at where it falls.
    body = water.body
    for p in range(label.shape[0]):
        # No faster than all that is allowed would make it, and no slower than what falls from rest.
        most = math.sqrt(2.0 * max(0.0, body[p, ALLOWED]) / body[p, MASS]) if body[p, MASS] > 0.0 else 0.0
        body[p, RISE], body[p, PART] = most + h * g, AS_ONE
        body[p, LOW], body[p, HIGH] = AS_ONE if body[p, HELD] > BY_CONTACTS else 0.0, WHOLE
    _measure_part(water, state, start, label, g, early, h)
    for p in range(label.shape[0]):
        body[p, UNDONE], body[p, PART] = body[p, MOVES] + body[p, UNDER], AS_ONE - NEXT
    _measure_part(water, state, start, label, g, early, h)
    for p in range(label.shape[0]):
        if body[p, MOVES] + body[p, UNDER] >= body[p, UNDONE]:
            body[p, RISE] = -h * g
    for _ in range(HALVINGS):
        for p in range(label.shape[0]):
            body[p, PART] = 0.5 * (body[p, LOW] + body[p, HIGH])
        _measure_part(water, state, start, label, g, early, h)
        for p in range(label.shape[0]):
            body[p, UNDONE] = body[p, MOVES] + body[p, UNDER]
            body[p, PART] -= NEXT
        _measure_part(water, state, start, label, g, early, h)
        for p in range(label.shape[0]):
            rises = body[p, MOVES] + body[p, UNDER] < body[p, UNDONE]
            if body[p, UNDONE] > body[p, ALLOWED] and rises:
                body[p, HIGH] = body[p, PART] + NEXT
            else:
                body[p, LOW] = body[p, PART] + NEXT
    for p in range(label.shape[0]):
        body[p, PART] = body[p, LOW]
    _measure_part(water, state, start, label, g, early, h)


@inner_kernel
def _measure_part(
    water: Water, state: State, start: FloatRows, label: Slots, g: float, early: float, h: float
) -> None:  # fmt: skip
    # Leave PART of the motion of what is due, and measure that: from 2 to 1 less of what moves beside its motion as a
    # whole, of what is held of all, and from there on another rise.
    body, load = water.body, water.load
    for p in range(label.shape[0]):
        if not water.due[p]:
            continue
        part, m = body[label[p], PART], body[label[p], MASS]
        u, v = body[label[p], PX] / m, body[label[p], PY] / m
        if body[label[p], HELD] > BY_CONTACTS:
            u, v = 0.0, 0.0
        beside, other = max(0.0, part - AS_ONE), max(0.0, AS_ONE - part)
        state.velocity[p, 0] = u + beside * (load[p, U] - u)
        state.velocity[p, 1] = v + beside * (load[p, V] - v) + other * (body[label[p], RISE] - v)
    _measure(water, state, start, label, g, early, h)


@inner_kernel
def _find_wet(water: Water, state: State, label: Slots) -> bool:
    # Bodies that are lifted are due, with nothing summed up of them; whether there are any.
    body, found = water.body, False
    for p in range(label.shape[0]):
        body[p, UNDER] = 0.0
        body[p, PX] = body[p, PY] = body[p, EXCESS] = body[p, TOOK_X] = 0.0
    for p in range(label.shape[0]):
        if water.wet[p] and water.load[p, FY] != 0.0:
            body[label[p], UNDER] = 1.0
            found = True
    for p in range(label.shape[0]):
        water.due[p] = body[label[p], UNDER] > 0.0 and state.inverse_mass[p] > 0.0 and state.particle_active[p]
    return found


@inner_kernel
def _measure(
    water: Water, state: State, start: FloatRows, label: Slots, g: float, early: float, h: float
) -> None:  # fmt: skip
    # Of bodies that are due, after their way: kinetic energy and that of weights in MOVES, U in UNDER [J].
    body, velocity = water.body, state.velocity
    for p in range(label.shape[0]):
        body[p, MOVES] = 0.0
    for p in range(label.shape[0]):
        ahead = 0.0 if water.is_joined[p] else early
        for axis in range(2):
            water.after[p, axis] = state.position[p, axis] + ahead * start[p, axis] + 0.5 * h * velocity[p, axis]
        if water.due[p]:
            squared = velocity[p, 0] * velocity[p, 0] + velocity[p, 1] * velocity[p, 1]
            weight = g * state.gravity_scale[p]
            body[label[p], MOVES] += state.mass[p] * (0.5 * squared + weight * 0.5 * h * velocity[p, 1])
    _sum_under(water, state, label, g, AFTER)


@inner_kernel
def _sum_under(water: Water, state: State, label: Slots, g: float, column: int) -> None:
    for p in range(label.shape[0]):
        water.lifted[p] = water.body[p, UNDER] = 0.0
    add_energies(water, state, g, column, 1.0)
    for p in range(label.shape[0]):
        water.body[label[p], UNDER] += water.lifted[p]
