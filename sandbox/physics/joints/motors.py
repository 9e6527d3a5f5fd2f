"""Motors: each a row between the turning of a wheel and of what its hub is mounted on."""

from typing import NamedTuple

import numpy as np

from sandbox.physics.components import label_bodies
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, with_point
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.rows import JointRows, clamped
from sandbox.physics.state import Floats, Slots, State
from sandbox.physics.world import World

# Below this moment of inertia [kg m^2] a group of particles has no direction to be turned in.
LEAST_INERTIA = 1e-150
# 1 - Cd of a motor, as of a spring at its cap: 0 would leave two motors of one wheel without a definite share.
MOTOR_SOFTNESS = 1e-7


class MotorRows(NamedTuple):
    """The rows of motors, which are a world's first, as kernels fill them in; the motors (k,): see Motors.

    middle (k,): the entry where the wheel ends and the mount begins; part (k,): where its value and its kept impulse
    are in actuator_value, actuator_impulse.
    """

    middle: Slots
    speed: Floats
    torque: Floats
    part: Slots


def motor_groups(world: World) -> list[tuple[Slots, Slots]]:
    """The two sides that each motor turns against each other: particles of its wheel and of its mount; a side that the
    ground holds has none.

    The mount is the hub and what springs join to it outside the wheel. Where springs hold nothing of the wheel to the
    hub, or nothing but the wheel, both are empty: there is nothing to turn, or to push against. What has come off the
    wheel is no part of it.
    """
    motors = world.actuators.motors
    joined = world.spring_active & (world.material >= 0)
    a, b = world.particle_a[joined].astype(np.int64), world.particle_b[joined].astype(np.int64)
    free = world.inverse_mass > 0.0
    label = np.arange(world.particle_count)
    both = free[a] & free[b]
    label_bodies(a[both], b[both], label)
    none = np.zeros(0, dtype=np.int64)
    groups = []
    for k, hub in enumerate(motors.hub.tolist()):
        rim = motors.rim[motors.rim_start[k] : motors.rim_start[k + 1]]
        ends = np.unique(np.concatenate([b[a == hub], a[b == hub]]))
        spokes, mount = np.intersect1d(ends, rim), np.setdiff1d(ends, rim)
        bodies = label[[hub]] if free[hub] else label[spokes]
        wheel = np.unique(rim[np.isin(label[rim], bodies) | ~free[rim]])
        mount = np.append(mount[mount != hub], hub)
        wheel, mount = (none if not np.all(free[group]) else group for group in (wheel, mount))
        idle = not len(spokes) or len(mount) == 1
        groups.append((none, none) if idle else (wheel, mount))
    return groups


@inner_kernel
def _turn_of(rows: JointRows, first: int, last: int, sign: float, state: State) -> float:
    # The gradient of a group's angular velocity about its centre of mass, times a sign, and 1/I; -1: it has none.
    # omega = sum m r x v / I,  I = sum m r^2,  g = m perp(r) / I;  sum m r = 0, so that sum g = 0
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
        rows.softness[k] = MOTOR_SOFTNESS * (of_wheel + of_mount)
        rows.limit[k] = motors.torque[k] * h
        rows.impulse[k] = clamped(state.actuator_impulse[motors.part[k]], rows.limit[k])


@inner_kernel
def store_motors(rows: JointRows, motors: MotorRows, state: State) -> None:
    """Keep the impulses of motors for the next substep."""
    for k in range(motors.middle.shape[0]):
        state.actuator_impulse[motors.part[k]] = rows.impulse[k]
