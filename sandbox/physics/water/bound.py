"""Bound: lift gives no more energy in a step than the water loses, whichever way a body goes.

Lift is made for the way that a body would take as a whole, which nothing holds (push.py). What is soft, lands or is let
go takes another. At the velocities after the springs, and places that belong to them (lift.py), lift has given

    h F (v + v') / 2 + U(x + h v' / 2) - U(x - h v / 2)

too much. Where that is above 0, as much energy is taken: first of what moves beside the motion as a whole, of what is
held of all, and then of how it rises.
"""

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.settings import GRAVITY_Y
from sandbox.physics.state import State
from sandbox.physics.water.displacers import (
    DX,
    DY,
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
    SWING,
    UNDER,
    Water,
)
from sandbox.physics.water.lift import AFTER, BEFORE, add_energies

# Halvings of the range in which what remains of the motion is looked for, and what is rounding of its energy [1].
HALVINGS = 16
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
                load[p, DX + axis] = state.velocity[p, axis]
                body[label[p], PX + axis] += state.mass[p] * state.velocity[p, axis]
            body[label[p], EXCESS] += 0.5 * h * load[p, FY] * (start[p, 1] + state.velocity[p, 1])
    _sum_under(water, state, label, g, BEFORE)
    for p in range(label.shape[0]):
        body[p, EXCESS] -= body[p, UNDER]
    _measure(water, state, start, label, g, early, h)
    found = False
    for p in range(label.shape[0]):
        if label[p] == p and water.due[p]:
            body[p, EXCESS] += body[p, UNDER]
            water.due[p] = body[p, EXCESS] > max(body[p, SWING], ROUNDING) * body[p, MOVES]
            found = found or water.due[p]
            # What may be left of all.
            body[p, EXCESS] = body[p, MOVES] + body[p, UNDER] - body[p, EXCESS]
            body[p, LOW], body[p, HIGH] = 0.0, WHOLE
    if not found:
        return
    for p in range(label.shape[0]):
        water.due[p] = water.due[label[p]] and state.inverse_mass[p] > 0.0 and state.particle_active[p]
    for halving in range(HALVINGS):
        for p in range(label.shape[0]):
            # At the end what is known to be little enough.
            body[p, PART] = 0.5 * (body[p, LOW] + body[p, HIGH]) if halving < HALVINGS - 1 else body[p, LOW]
        _slow(water, state, label)
        if halving < HALVINGS - 1:
            _measure(water, state, start, label, g, early, h)
            for p in range(label.shape[0]):
                if body[p, MOVES] + body[p, UNDER] <= body[p, EXCESS]:
                    body[p, LOW] = body[p, PART]
                else:
                    body[p, HIGH] = body[p, PART]


@inner_kernel
def _find_wet(water: Water, state: State, label: Slots) -> bool:
    # Bodies that are lifted are due, with nothing summed up of them; whether there are any.
    body, found = water.body, False
    for p in range(label.shape[0]):
        body[p, UNDER] = 0.0
        body[p, PX] = body[p, PY] = body[p, EXCESS] = 0.0
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


@inner_kernel
def _slow(water: Water, state: State, label: Slots) -> None:
    # Leave PART of the motion of what is due: up to 1 of its rise, and from there on of what moves beside that.
    body, load = water.body, water.load
    for p in range(label.shape[0]):
        if not water.due[p]:
            continue
        part, m = body[label[p], PART], body[label[p], MASS]
        is_free = 0.0 if body[label[p], HELD] > 0.0 else 1.0
        u, v = is_free * body[label[p], PX] / m, is_free * body[label[p], PY] / m
        beside = max(0.0, part - AS_ONE)
        state.velocity[p, 0] = u + beside * (load[p, DX] - u)
        state.velocity[p, 1] = min(part, AS_ONE) * v + beside * (load[p, DY] - v)
