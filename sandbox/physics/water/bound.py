"""Bound: lift gives no more energy in a step than the water loses, whichever way a body goes.

Lift is made for the way that a body would take as a whole, which nothing holds (push.py). What is soft, lands or is let
go takes another, and drag brakes at once what the place has run ahead of. At the velocities after the springs, and at
places that belong to them (lift.py), lift has given

    h F (v + v') / 2 + U(x + h v' / 2) - U(x - h v / 2)

too much. Where that is above 0, velocities go from v' towards -v, just so far that it is not: there a body is where it
was, as fast as it was, and between the two its energy is convex. They do so by its rise as a whole, or else in all.
"""

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
    RISE,
    RXX,
    RXY,
    RYY,
    SWING,
    TOOK_X,
    UNDER,
    WORK,
    U,
    V,
    Water,
)
from sandbox.physics.water.lift import add_energies

# Halvings of the range in which the velocities are looked for.
HALVINGS = 24
# What is slower than this [m/s] is not looked at.
SLOWEST = 1e-3
# Part of its work that lift may give too much, as it takes as much elsewhere; what is rounding of energy [1].
SPARED = 5e-4
ROUNDING = 1e-9
# Part of the velocity that is lost where all of it turns. Without, some goes to and fro for ever; more gives energy.
LOST = 0.01


@inner_kernel
def bound_lift(
    water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats, early: float, h: float
) -> None:  # fmt: skip
    """Slow down what lift has given too much energy in a step of h [s]; start, label, early: see push.py."""
    g, body, load, velocity = max(0.0, -numbers[GRAVITY_Y]), water.body, water.load, state.velocity
    if not g > 0.0 or not _find_wet(water, state, start, label):
        return
    for p in range(label.shape[0]):
        ahead = 0.0 if water.is_joined[p] else early
        for axis in range(2):
            water.before[p, axis] = state.position[p, axis] - (0.5 * h - ahead) * start[p, axis]
            load[p, U + axis] = velocity[p, axis]
        if water.due[p]:
            k, u, v = label[p], velocity[p, 0], velocity[p, 1]
            work = 0.5 * h * load[p, FY] * (start[p, 1] + v)
            body[k, EXCESS] += work
            body[k, WORK] += abs(work)
            if not water.is_joined[p]:
                # Drag of a velocity that lift has turned round would give energy, too.
                fx, fy = load[p, RXX] * u + load[p, RXY] * v, load[p, RXY] * u + load[p, RYY] * v
                body[k, TOOK_X] -= 0.5 * h * (fx * (start[p, 0] + u) + fy * (start[p, 1] + v))
            body[k, RISE] += state.mass[p] * (start[p, 1] + v)
            # Kinetic energy as the step begins, and that of weights as _measure has it.
            squared = start[p, 0] * start[p, 0] + start[p, 1] * start[p, 1]
            weight = g * state.gravity_scale[p]
            body[k, ALLOWED] += state.mass[p] * (0.5 * squared - weight * 0.5 * h * start[p, 1])
    _measure(water, state, start, label, g, early, h)
    found = False
    for p in range(label.shape[0]):
        if label[p] == p and water.due[p]:
            body[p, EXCESS] += body[p, UNDER] + max(0.0, body[p, TOOK_X])
            spared = (SPARED + body[p, SWING]) * body[p, WORK] + ROUNDING * abs(body[p, MOVES])
            water.due[p] = body[p, EXCESS] > spared
            found = found or water.due[p]
            # What all else has given.
            body[p, EXCESS] = body[p, MOVES] + body[p, UNDER] - body[p, EXCESS] - body[p, ALLOWED]
    if found:
        for p in range(label.shape[0]):
            water.due[p] = water.due[label[p]] and state.inverse_mass[p] > 0.0 and state.particle_active[p]
        _turn_back(water, state, start, label, g, early, h)


@inner_kernel
def _find_wet(water: Water, state: State, start: FloatRows, label: Slots) -> bool:
    # Bodies that are lifted and move are due, with nothing summed up of them; whether there are any.
    body, found = water.body, False
    for p in range(label.shape[0]):
        body[p, UNDER] = body[p, MOVES] = 0.0
        body[p, EXCESS] = body[p, TOOK_X] = body[p, WORK] = body[p, RISE] = body[p, ALLOWED] = 0.0
    for p in range(label.shape[0]):
        if water.load[p, FY] != 0.0:
            body[label[p], UNDER] = 1.0
        fastest = max(abs(start[p, 1]), abs(state.velocity[p, 1]))
        body[label[p], MOVES] = max(body[label[p], MOVES], fastest)
    for p in range(label.shape[0]):
        water.due[p] = (
            body[label[p], UNDER] > 0.0
            and body[label[p], MOVES] > SLOWEST
            and state.inverse_mass[p] > 0.0
            and state.particle_active[p]
        )
        found = found or water.due[p]
    return found


@inner_kernel
def _turn_back(
    water: Water, state: State, start: FloatRows, label: Slots, g: float, early: float, h: float
) -> None:  # fmt: skip
    # The least PART of the way from v' towards -v with which what is due has the energy that is allowed: in its rise,
    # RISE = 0 where that does not do, and then in all.
    body, load = water.body, water.load
    for p in range(label.shape[0]):
        body[p, RISE] = body[p, RISE] / body[p, MASS] if body[p, HELD] <= BY_CONTACTS and body[p, MASS] > 0.0 else 0.0
        body[p, PART], body[p, LOW], body[p, HIGH] = 1.0, 0.0, 1.0
    for halving in range(HALVINGS):
        for p in range(label.shape[0]):
            k = label[p]
            if water.due[p]:
                back, rise = body[k, PART], body[k, RISE]
                in_all = back if rise == 0.0 else 0.0
                # What went back all of its way would go to and fro for ever.
                kept = 1.0 - LOST * in_all if halving == HALVINGS - 1 else 1.0
                state.velocity[p, 0] = kept * (load[p, U] - in_all * (load[p, U] + start[p, 0]))
                state.velocity[p, 1] = kept * (load[p, V] - in_all * (load[p, V] + start[p, 1])) - back * rise
        _measure(water, state, start, label, g, early, h)
        for p in range(label.shape[0]):
            # An impulse works on the mean of the velocities before and after.
            other = body[p, EXCESS] if body[p, RISE] != 0.0 else (1.0 - body[p, PART]) * body[p, EXCESS]
            is_allowed = body[p, MOVES] + body[p, UNDER] <= body[p, ALLOWED] + other
            if halving == 0:
                body[p, RISE] = body[p, RISE] if is_allowed else 0.0
            elif is_allowed:
                body[p, HIGH] = body[p, PART]
            else:
                body[p, LOW] = body[p, PART]
            body[p, PART] = 0.5 * (body[p, LOW] + body[p, HIGH]) if halving < HALVINGS - 2 else body[p, HIGH]


@inner_kernel
def _measure(
    water: Water, state: State, start: FloatRows, label: Slots, g: float, early: float, h: float
) -> None:  # fmt: skip
    # Of bodies that are due, after their way: kinetic energy and that of weights in MOVES, what U gained in UNDER [J].
    body, velocity = water.body, state.velocity
    for p in range(label.shape[0]):
        body[p, MOVES] = body[p, UNDER] = water.lifted[p] = 0.0
    for p in range(label.shape[0]):
        ahead = 0.0 if water.is_joined[p] else early
        for axis in range(2):
            water.after[p, axis] = state.position[p, axis] + ahead * start[p, axis] + 0.5 * h * velocity[p, axis]
        if water.due[p]:
            squared = velocity[p, 0] * velocity[p, 0] + velocity[p, 1] * velocity[p, 1]
            weight = g * state.gravity_scale[p]
            body[label[p], MOVES] += state.mass[p] * (0.5 * squared + weight * 0.5 * h * velocity[p, 1])
    add_energies(water, state, g)
    for p in range(label.shape[0]):
        body[label[p], UNDER] += water.lifted[p]
