"""All joints of a world: their rows, made when topology changes, and their numbers, filled in at every substep."""

import itertools
from typing import NamedTuple

import numpy as np

from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.hands import HandRows, grips_of, load_hands, store_hands
from sandbox.physics.joints.limited_springs import (
    LimitedRows,
    limited_particles,
    limited_rows,
    limited_springs,
    load_limited,
    store_limited,
)
from sandbox.physics.joints.motors import MotorRows, load_motors, motor_groups, store_motors
from sandbox.physics.joints.rows import PAIR, SCALAR, SECOND_OF_TWO, JointRows, any_on, new_rows
from sandbox.physics.state import Floats, State
from sandbox.physics.world import World


class JointSet(NamedTuple):
    """The rows of a world's joints, and what they are filled in from: motors first, then springs, then hands."""

    rows: JointRows
    motors: MotorRows
    hands: HandRows
    limited: LimitedRows


def joints_of(world: World) -> JointSet:
    """The joints of a world, made again after a change of topology."""
    return world.derived(_make_joints)


def _make_joints(world: World) -> JointSet:
    motors, grips = world.actuators.motors, grips_of(world)
    groups, count, springs = motor_groups(world), len(grips.hand), limited_springs(world)
    particles = [np.concatenate(group) for group in groups] + limited_particles(world, springs)
    alone = len(particles)
    for first, last in itertools.pairwise(grips.start.tolist()):
        particles += [grips.particle[first:last]] * 2
    rows = new_rows(particles, [SCALAR] * alone + [PAIR, SECOND_OF_TWO] * count)
    middle = rows.first[: len(groups)] + np.array([len(wheel) for wheel, _ in groups], dtype=np.int64)
    return JointSet(
        rows, MotorRows(middle, motors.speed, motors.torque, motors.part),
        HandRows(alone + 2 * np.arange(count), grips), limited_rows(world, springs, len(groups)),
    )  # fmt: skip


@inner_kernel
def prepare_joints(
    joints: JointSet, state: State, stiffness: Floats, damping: Floats, solver: int, h: float
) -> bool:  # fmt: skip
    """Fill in the rows of joints for a substep of h [s], from where particles are at its start; whether any is on.

    stiffness, damping (m,): Cs and Cd of springs in the substep. solver: see settings.py.
    """
    load_motors(joints.rows, joints.motors, state, h)
    load_limited(joints.rows, joints.limited, state, stiffness, damping, solver, h)
    load_hands(joints.rows, joints.hands, state, h)
    return any_on(joints.rows)


@inner_kernel
def store_joint_impulses(joints: JointSet, state: State, solver: int, h: float) -> None:
    """Store the joints' impulses in the state of the world, for the next substep."""
    store_motors(joints.rows, joints.motors, state)
    store_limited(joints.rows, joints.limited, state, solver)
    store_hands(joints.rows, joints.hands, state, h)
