"""All joints of a world: their rows, made when topology changes, and their numbers, filled in at every substep."""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.jit import bundle, contents, kernel
from sandbox.physics.joints.hands import HandRows, grips_of, keep_hands, load_hands
from sandbox.physics.joints.limited_springs import (
    keep_limited,
    limited_particles,
    limited_rows,
    limited_springs,
    load_limited,
)
from sandbox.physics.joints.motors import MotorRows, keep_motors, load_motors, motor_groups
from sandbox.physics.joints.rows import PAIR, SCALAR, SECOND_OF_TWO, JointRows, any_on, new_rows
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import Floats, World


@dataclass(eq=False)
class JointSet:
    """The joints of a world; on: whether any of them acts in the present substep. lent: what kernels fill rows from."""

    rows: JointRows
    lent: Any
    on: bool = False


def joints_of(world: World) -> JointSet | None:
    """The joints of a world, made again after a change of topology; None: it has none."""
    return world.derived(_make_joints)


def _make_joints(world: World) -> JointSet | None:
    motors, grips = world.actuators.motors, grips_of(world)
    springs = limited_springs(world)
    if not len(motors.hub) and not len(grips.hand) and not len(springs):
        return None
    groups, count = motor_groups(world), len(grips.hand)
    particles = [np.concatenate(group) for group in groups] + limited_particles(world, springs)
    alone = len(particles)
    for first, last in itertools.pairwise(grips.start.tolist()):
        particles += [grips.particle[first:last]] * 2
    rows = new_rows(particles, [SCALAR] * alone + [PAIR, SECOND_OF_TWO] * count)
    middle = rows.first[: len(groups)] + np.array([len(wheel) for wheel, _ in groups], dtype=np.int64)
    of_motors = MotorRows(
        middle, motors.speed, motors.torque, motors.part, world.position, world.mass, world.actuator_value,
        world.actuator_impulse,
    )  # fmt: skip
    of_hands = HandRows(
        alone + 2 * np.arange(count), grips, world.position, world.velocity, world.hand_strength, world.hand_force,
    )  # fmt: skip
    of_springs = limited_rows(world, springs, len(groups))
    return JointSet(rows, bundle((rows, of_motors, of_hands, of_springs)))


@kernel
def _load(lent: Any, stiffness: Floats, damping: Floats, form: int, h: float) -> bool:
    rows, motors, hands, limited = contents(lent)
    load_motors(rows, motors, h)
    load_limited(rows, limited, stiffness, damping, form, h)
    load_hands(rows, hands, h)
    return any_on(rows)


@kernel
def _keep(lent: Any, form: int, h: float) -> None:
    rows, motors, hands, limited = contents(lent)
    keep_motors(rows, motors)
    keep_limited(rows, limited, form)
    keep_hands(rows, hands, h)


def _form(world: World) -> int:
    # In which form springs of limited force are rows, see load_limited.
    solver = SOLVERS[world.settings.solver]
    return 0 if not solver.joints_bear_load else 1 if solver.bounded else 2


def load_joints(joints: JointSet, world: World, springs: tuple[Floats, Floats], h: float) -> None:
    """Fill in the rows of joints for a substep of h [s], from where particles are at its start.

    springs: Cs and Cd (m,) of the substep.
    """
    joints.on = _load(joints.lent, *springs, _form(world), h)


def keep_joints(joints: JointSet, world: World, h: float) -> None:
    """Store the joints' impulses in the state of the world, for the next substep."""
    _keep(joints.lent, _form(world), h)
