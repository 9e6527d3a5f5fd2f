"""All joints of a world: their rows, made when topology changes, and their numbers, filled in at every substep.

A motor is a row between the turning of a wheel and of what its hub is mounted on. Springs of limited force, muscles and
hydraulics that give way, are clamped: |J| <= force h, where J is what the equation gives. In the direct solver each is
a row along its direction, out of the matrix, J = -K (u' + beta x / h): softness 1/K, target -beta x / h. The other
solvers clamp the spring itself, where it stands among all springs: with a row apart a light particle between it and a
heavy one would swing ever wider. Hands are in hands.py.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.driving import Actuators, Drives
from sandbox.physics.equation import direction, implicit_masses, reduced_mass
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, with_point
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.joints.hands import Grips, HandRows, load_hands, store_hands
from sandbox.physics.joints.joint_rows import PAIR, SECOND_OF_TWO, JointRows, any_on, clamped
from sandbox.physics.marks import LAW_NISSEN
from sandbox.physics.state import State

# K at least, as a share of the reduced mass: of a spring without damping it would be 0, and 1/K infinite.
LEAST_STIFFNESS_SHARE = 1e-9
# Below this moment of inertia [kg m^2] a group of particles has no direction to be turned in.
LEAST_INERTIA = 1e-150
# 1 - Cd of a motor, as of a spring at its cap: 0 would leave two motors of one wheel without a definite share.
MOTOR_SOFTNESS = 1e-7
# In place of where a side ends: the ground holds it.
GROUNDED = -1


class LimitedRows(NamedTuple):
    """The springs of limited force, s of them, from row first[0] on: spring (s,): slots, force [N] (s,)."""

    first: Slots
    spring: Slots
    force: Floats


class SpringForces(NamedTuple):
    """Limits of force: limit [N] (m,), infinite: none; limited (k,): slots of the springs that can be rows.

    Those are active, of the article's law, with an end that moves. unlimited (m,): which are active and can be none.
    """

    limit: Floats
    limited: Slots
    unlimited: Flags


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


class MotorSides(NamedTuple):
    """The two sides of each motor k: its wheel, particle[first[2 k]:first[2 k + 1]], and its mount, the next ones.

    By particle, scratch: label, of what springs join; on_rim; at_hub, what springs join to the hub; turns, by label.
    """

    first: Annotated[Slots, "2 * motors + 1"]
    particle: Annotated[Slots, "room"]
    label: Annotated[Slots, "particles"]
    on_rim: Annotated[Flags, "particles"]
    at_hub: Annotated[Flags, "particles"]
    turns: Annotated[Flags, "particles"]


class JointSet(NamedTuple):
    """The rows of a world's joints, and what they are filled in from: motors first, then springs, then hands."""

    rows: JointRows
    motors: MotorRows
    hands: HandRows
    limited: LimitedRows


@inner_kernel
def lay_out_joints(
    state: State, wheels: DrivenWheels, sides: MotorSides, forces: SpringForces, grips: Grips, arena: Arena,
    out: JointSet,
) -> None:  # fmt: skip
    """Lay out the joints of a world: its motors with their sides, its springs of limited force, its hands' grips."""
    count, limited, hands = wheels.hub.shape[0], forces.limited.shape[0], grips.hand.shape[0]
    alone = count + limited
    gripped = grips.start[hands]
    # A spring has two free ends at most; a hand has two rows.
    entries = sides.first[2 * count] + 2 * limited + 2 * gripped
    rows = new_tuple(JointRows, arena, rows=alone + 2 * hands, entries=entries)
    motor_rows = MotorRows(new_slots(arena, count), wheels.speed, wheels.torque, wheels.part)
    limited_rows = LimitedRows(new_slots(arena, 1), forces.limited, new_floats(arena, limited))
    first_of_hand = new_slots(arena, hands)
    if is_full(arena):
        return
    list_motors(sides, rows, motor_rows)
    list_limited(state, forces, count, rows, limited_rows)
    for i in range(hands):
        first_of_hand[i] = alone + 2 * i
        rows.pair[alone + 2 * i], rows.pair[alone + 2 * i + 1] = PAIR, SECOND_OF_TWO
        for row in range(alone + 2 * i, alone + 2 * i + 2):
            e = rows.first[row]
            for k in range(grips.start[i], grips.start[i + 1]):
                rows.particle[e] = grips.particle[k]
                e += 1
            rows.first[row + 1] = e
    used = rows.first[alone + 2 * hands]
    set_field(out, "rows", JointRows(
        rows.first, rows.particle[:used], rows.pair, rows.gradient[:used], rows.target, rows.softness, rows.limit,
        rows.impulse,
    ))  # fmt: skip
    set_field(out, "motors", motor_rows)
    set_field(out, "limited", limited_rows)
    set_field(out, "hands", HandRows(first_of_hand, grips))


@inner_kernel
def list_motors(sides: MotorSides, rows: JointRows, motors: MotorRows) -> None:
    """List the particles of motors in the first rows."""
    for k in range(motors.middle.shape[0]):
        for at in range(sides.first[2 * k], sides.first[2 * k + 2]):
            rows.particle[at] = sides.particle[at]
        motors.middle[k] = sides.first[2 * k + 1]
        rows.first[k + 1] = sides.first[2 * k + 2]


@inner_kernel
def list_limited(state: State, forces: SpringForces, first_row: int, rows: JointRows, out: LimitedRows) -> None:
    """List the free particles of each spring's row, both ends or one, from row `first_row` on, and its force."""
    out.first[0] = first_row
    for i in range(forces.limited.shape[0]):
        s, e = forces.limited[i], rows.first[first_row + i]
        out.force[i] = forces.limit[s]
        for end in range(2):
            p = state.particle_a[s] if end == 0 else state.particle_b[s]
            if state.inverse_mass[p] > 0.0:
                rows.particle[e] = p
                e += 1
        rows.first[first_row + i + 1] = e


@inner_kernel
def prepare_joints(joints: JointSet, state: State, stiffness: Floats, damping: Floats, h: float) -> bool:
    """Fill in the rows of joints for a substep of h [s], from where particles are at its start; whether any is on.

    stiffness, damping (m,): Cs and Cd of springs in the substep.
    """
    load_motors(joints.rows, joints.motors, state, h)
    load_limited(joints.rows, joints.limited, state, stiffness, damping, h)
    load_hands(joints.rows, joints.hands, state, h)
    return any_on(joints.rows)


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
def load_limited(
    rows: JointRows, limited: LimitedRows, state: State, stiffness: Floats, damping: Floats, h: float
) -> None:
    """Fill in the rows for a substep of h [s], in which springs have these Cs and Cd.

    The impulse of a spring keeps J as the iterative solver keeps that of its springs.
    """
    position, velocity, inverse_mass = state.position, state.velocity, state.inverse_mass
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        a, b = state.particle_a[s], state.particle_b[s]
        du, dv = difference(a, b, velocity)
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        for e in range(rows.first[k], rows.first[k + 1]):
            sign = 1.0 if rows.particle[e] == b else -1.0
            rows.gradient[e, 0] = sign * nx
            rows.gradient[e, 1] = sign * ny
        x = length - state.rest_length[s]
        m = reduced_mass(inverse_mass[a], inverse_mass[b])
        stiff, restoring = implicit_masses(stiffness[s], damping[s], m)
        stiff = max(stiff, LEAST_STIFFNESS_SHARE * m)
        rows.softness[k] = 1.0 / stiff
        rows.target[k] = -restoring / stiff * x / h
        rows.limit[k] = limited.force[i] * h
        rows.impulse[k] = clamped(nx * state.impulse[s, 0] + ny * state.impulse[s, 1], rows.limit[k])


@inner_kernel
def store_joint_impulses(joints: JointSet, state: State, h: float) -> None:
    """Store the joints' impulses in the state of the world, for the next substep."""
    store_motors(joints.rows, joints.motors, state)
    store_limited(joints.rows, joints.limited, state)
    store_hands(joints.rows, joints.hands, state, h)


@inner_kernel
def store_motors(rows: JointRows, motors: MotorRows, state: State) -> None:
    """Keep the impulses of motors for the next substep."""
    for k in range(motors.middle.shape[0]):
        state.actuator_impulse[motors.part[k]] = rows.impulse[k]


@inner_kernel
def store_limited(rows: JointRows, limited: LimitedRows, state: State) -> None:
    """Keep the impulses for the next substep; those along each spring's first entry's direction."""
    for i in range(limited.spring.shape[0]):
        s, k = limited.spring[i], limited.first[0] + i
        e = rows.first[k]
        sign = 1.0 if rows.particle[e] == state.particle_b[s] else -1.0
        state.impulse[s, 0] = sign * rows.gradient[e, 0] * rows.impulse[k]
        state.impulse[s, 1] = sign * rows.gradient[e, 1] * rows.impulse[k]


@inner_kernel
def new_motor_sides(state: State, wheels: DrivenWheels, arena: Arena) -> MotorSides:
    """The two sides that each motor turns against each other; a side that the ground holds has no particles.

    The mount is the hub and what springs join to it outside the wheel. Where springs hold nothing of the wheel to the
    hub, or nothing but the wheel, both are empty: there is nothing to turn, or to push against. What has come off the
    wheel is no part of it.
    """
    particles, count = state.owner.shape[0], wheels.hub.shape[0]
    capacity = particles if count > 0 else 0
    sides = new_tuple(MotorSides, arena, motors=count, particles=capacity, room=capacity)
    if count == 0 or is_full(arena):
        return sides
    needed = list_motor_sides(state, wheels, sides)
    if needed > capacity:
        sides = MotorSides(
            sides.first, new_slots(arena, needed), sides.label, sides.on_rim, sides.at_hub, sides.turns
        )  # fmt: skip
        if not is_full(arena):
            list_motor_sides(state, wheels, sides)
    return sides


@inner_kernel
def list_motor_sides(state: State, wheels: DrivenWheels, sides: MotorSides) -> int:
    """List the sides of all motors; how many particles they have, which may be more than there is room for."""
    label = sides.label
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


def wheels_of(actuators: Actuators) -> DrivenWheels:
    """The motors of some actuators."""
    motors = actuators.motors
    return DrivenWheels(motors.hub, motors.rim_start, motors.rim, motors.speed, motors.torque, motors.part)


@inner_kernel
def new_spring_forces(state: State, drives: Drives, arena: Arena) -> SpringForces:
    """The limits of force of a world's springs, as its topology is now."""
    springs = state.law.shape[0]
    limit, limited, unlimited = new_floats(arena, springs), new_slots(arena, springs), new_flags(arena, springs)
    if is_full(arena):
        return SpringForces(limit, limited, unlimited)
    for s in range(springs):
        limit[s] = math.inf
    for k in range(drives.muscle.shape[0]):
        limit[drives.muscle[k]] = min(limit[drives.muscle[k]], drives.muscle_force[k])
    for k in range(drives.hydraulic.shape[0]):
        limit[drives.hydraulic[k]] = min(limit[drives.hydraulic[k]], drives.hydraulic_force[k])
    count = 0
    for s in range(springs):
        moves = state.inverse_mass[state.particle_a[s]] > 0.0 or state.inverse_mass[state.particle_b[s]] > 0.0
        is_row = limit[s] < math.inf and state.spring_active[s] and state.law[s] == LAW_NISSEN and moves
        unlimited[s] = state.spring_active[s] and not is_row
        if is_row:
            limited[count] = s
            count += 1
    return SpringForces(limit, limited[:count], unlimited)
