"""Motors: each a row between the turning of a wheel and of what its hub is mounted on."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_slots
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.driving import Actuators
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, with_point
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import JointRows, clamped
from sandbox.physics.state import State

# Below this moment of inertia [kg m^2] a group of particles has no direction to be turned in.
LEAST_INERTIA = 1e-150
# 1 - Cd of a motor, as of a spring at its cap: 0 would leave two motors of one wheel without a definite share.
MOTOR_SOFTNESS = 1e-7
# In place of where a side ends: the ground holds it.
GROUNDED = -1


class MotorRows(NamedTuple):
    """The rows of motors, which are a world's first, as kernels fill them in; the motors (k,): see Motors.

    middle (k,): the entry where the wheel ends and the mount begins; part (k,): where its value and its kept impulse
    are in actuator_value, actuator_impulse.
    """

    middle: Slots
    speed: Floats
    torque: Floats
    part: Slots


class DrivenWheels(NamedTuple):
    """The motors of a world as kernels read them, see Motors."""

    hub: Slots
    rim_start: Slots
    rim: Slots
    speed: Floats
    torque: Floats
    part: Slots


def wheels_of(actuators: Actuators) -> DrivenWheels:
    """The motors of some actuators."""
    given = actuators.motors
    return DrivenWheels(given.hub, given.rim_start, given.rim, given.speed, given.torque, given.part)


class MotorSides(NamedTuple):
    """The two sides of each motor k: its wheel, particle[first[2 k]:first[2 k + 1]], and its mount, the next ones.

    By particle, scratch: label, of what springs join; on_rim; at_hub, what springs join to the hub; turns, by label.
    """

    first: Slots
    particle: Slots
    label: Slots
    on_rim: Flags
    at_hub: Flags
    turns: Flags


@inner_kernel
def _label_free(state: State, label: Slots) -> None:
    for p in range(label.shape[0]):
        label[p] = p
    for s in range(state.spring_active.shape[0]):
        a = state.particle_a[s]
        b = state.particle_b[s]
        both_free = state.inverse_mass[a] > 0.0 and state.inverse_mass[b] > 0.0
        if both_free and state.spring_active[s] and state.material[s] >= 0:
            join(label, a, b)
    for p in range(label.shape[0]):
        label[p] = root_of(label, p)


@inner_kernel
def _mark_wheel(k: int, state: State, wheels: DrivenWheels, sides: MotorSides) -> bool:
    # Mark the rim, what springs join to the hub, and what turns with it; whether anything holds the rim to the hub.
    hub = wheels.hub[k]
    for p in range(sides.label.shape[0]):
        sides.on_rim[p] = sides.at_hub[p] = sides.turns[p] = False
    for at in range(wheels.rim_start[k], wheels.rim_start[k + 1]):
        sides.on_rim[wheels.rim[at]] = True
    for s in range(state.spring_active.shape[0]):
        if state.spring_active[s] and state.material[s] >= 0:
            if state.particle_a[s] == hub:
                sides.at_hub[state.particle_b[s]] = True
            if state.particle_b[s] == hub:
                sides.at_hub[state.particle_a[s]] = True
    held = False
    for p in range(sides.label.shape[0]):
        if sides.at_hub[p] and sides.on_rim[p]:
            held = True
            sides.turns[sides.label[p]] = True
    if state.inverse_mass[hub] > 0.0:
        for p in range(sides.label.shape[0]):
            sides.turns[p] = p == sides.label[hub]
    return held


@inner_kernel
def _list_side(hub: int, of_wheel: bool, top: int, state: State, sides: MotorSides) -> int:
    # List the particles of a side, the hub apart, from `top` on; where it ends, which may be beyond the room, or
    # GROUNDED.
    for p in range(sides.label.shape[0]):
        is_free = state.inverse_mass[p] > 0.0
        if of_wheel:
            belongs = sides.on_rim[p] and (sides.turns[sides.label[p]] or not is_free)
        else:
            belongs = sides.at_hub[p] and not sides.on_rim[p] and p != hub
        if belongs:
            if not is_free:
                return GROUNDED
            _enter(p, top, sides)
            top += 1
    return top


@inner_kernel
def _enter(p: int, top: int, sides: MotorSides) -> None:
    if top < sides.particle.shape[0]:
        sides.particle[top] = p


@inner_kernel
def list_motor_sides(state: State, wheels: DrivenWheels, sides: MotorSides) -> int:
    """List the sides of all motors; how many particles they have, which may be more than there is room for."""
    _label_free(state, sides.label)
    top = 0
    sides.first[0] = 0
    for k in range(wheels.hub.shape[0]):
        hub = wheels.hub[k]
        idle = not _mark_wheel(k, state, wheels, sides)
        middle = _list_side(hub, True, top, state, sides)
        middle = top if middle == GROUNDED else middle
        end = _list_side(hub, False, middle, state, sides)
        if end == GROUNDED or not state.inverse_mass[hub] > 0.0:
            end = middle
        else:
            idle = idle or end == middle
            _enter(hub, end, sides)
            end += 1
        if not idle:
            top = end
        sides.first[2 * k + 1] = top if idle else middle
        sides.first[2 * k + 2] = top
    return top


@inner_kernel
def new_motor_sides(state: State, wheels: DrivenWheels, arena: Arena) -> MotorSides:
    """The two sides that each motor turns against each other; a side that the ground holds has no particles.

    The mount is the hub and what springs join to it outside the wheel. Where springs hold nothing of the wheel to the
    hub, or nothing but the wheel, both are empty: there is nothing to turn, or to push against. What has come off the
    wheel is no part of it.
    """
    particles, count = state.owner.shape[0], wheels.hub.shape[0]
    room = particles if count > 0 else 0
    sides = MotorSides(
        new_slots(arena, 2 * count + 1), new_slots(arena, room), new_slots(arena, room), new_flags(arena, room),
        new_flags(arena, room), new_flags(arena, room),
    )  # fmt: skip
    if count == 0 or is_full(arena):
        return sides
    needed = list_motor_sides(state, wheels, sides)
    if needed > room:
        sides = MotorSides(
            sides.first, new_slots(arena, needed), sides.label, sides.on_rim, sides.at_hub, sides.turns
        )  # fmt: skip
        if not is_full(arena):
            list_motor_sides(state, wheels, sides)
    return sides


@inner_kernel
def list_motors(sides: MotorSides, rows: JointRows, motors: MotorRows) -> None:
    """List the particles of motors in the first rows."""
    for k in range(motors.middle.shape[0]):
        for at in range(sides.first[2 * k], sides.first[2 * k + 2]):
            rows.particle[at] = sides.particle[at]
        motors.middle[k] = sides.first[2 * k + 1]
        rows.first[k + 1] = sides.first[2 * k + 2]


@inner_kernel
def _turn_of(rows: JointRows, first: int, last: int, sign: float, state: State) -> float:
    # The gradient of a group's angular velocity about its centre of mass, times a sign, and 1/I; -1: it has none.
    # omega = sum m r x v / I,  I = sum m r^2,  g = m perp(r) / I;  sum m r = 0, so that sum g = 0  (24)
    position, mass = state.position, state.mass
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for e in range(first, last):
        p = rows.particle[e]
        sums = with_point(sums, mass[p], position[p, 0], position[p, 1], 0.0, 0.0)
    if not sums.weight > 0.0:
        return 0.0
    x, y, _, _, _, _ = centre_of(sums)
    inertia = 0.0
    for e in range(first, last):
        p = rows.particle[e]
        dx = position[p, 0] - x
        dy = position[p, 1] - y
        inertia += mass[p] * (dx * dx + dy * dy)
        rows.gradient[e, 0] = -sign * mass[p] * dy
        rows.gradient[e, 1] = sign * mass[p] * dx
    if not inertia > LEAST_INERTIA:
        return -1.0
    for e in range(first, last):
        rows.gradient[e, 0] /= inertia
        rows.gradient[e, 1] /= inertia
    return 1.0 / inertia


@inner_kernel
def load_motors(rows: JointRows, motors: MotorRows, state: State, h: float) -> None:
    """Fill in the rows of motors for a substep of h [s]: u = omega_wheel - omega_mount, target = speed times value."""
    for k in range(motors.middle.shape[0]):
        value = state.actuator_value[motors.part[k]]
        first, middle, last = rows.first[k], motors.middle[k], rows.first[k + 1]
        rows.limit[k] = 0.0
        rows.impulse[k] = 0.0
        if value == 0.0 or first == last:
            continue
        of_wheel = _turn_of(rows, first, middle, 1.0, state)
        of_mount = _turn_of(rows, middle, last, -1.0, state)
        if of_wheel < 0.0 or of_mount < 0.0:
            continue
        rows.target[k] = value * motors.speed[k]
        rows.softness[k] = MOTOR_SOFTNESS * (of_wheel + of_mount)  # (24)
        rows.limit[k] = motors.torque[k] * h
        rows.impulse[k] = clamped(state.actuator_impulse[motors.part[k]], rows.limit[k])


@inner_kernel
def store_motors(rows: JointRows, motors: MotorRows, state: State) -> None:
    """Keep the impulses of motors for the next substep."""
    for k in range(motors.middle.shape[0]):
        state.actuator_impulse[motors.part[k]] = rows.impulse[k]
