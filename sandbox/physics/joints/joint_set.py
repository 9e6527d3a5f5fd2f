"""All joints of a world: their rows, made when topology changes, and their numbers, filled in at every substep."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import Floats
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.joints.hands import Grips, HandRows, load_hands, store_hands
from sandbox.physics.joints.limited_springs import (
    LimitedRows,
    SpringForces,
    list_limited,
    load_limited,
    store_limited,
)
from sandbox.physics.joints.motors import DrivenWheels, MotorRows, MotorSides, list_motors, load_motors, store_motors
from sandbox.physics.joints.rows import PAIR, SECOND_OF_TWO, JointRows, any_on
from sandbox.physics.state import State


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
def prepare_joints(joints: JointSet, state: State, stiffness: Floats, damping: Floats, h: float) -> bool:
    """Fill in the rows of joints for a substep of h [s], from where particles are at its start; whether any is on.

    stiffness, damping (m,): Cs and Cd of springs in the substep.
    """
    load_motors(joints.rows, joints.motors, state, h)
    load_limited(joints.rows, joints.limited, state, stiffness, damping, h)
    load_hands(joints.rows, joints.hands, state, h)
    return any_on(joints.rows)


@inner_kernel
def store_joint_impulses(joints: JointSet, state: State, h: float) -> None:
    """Store the joints' impulses in the state of the world, for the next substep."""
    store_motors(joints.rows, joints.motors, state)
    store_limited(joints.rows, joints.limited, state)
    store_hands(joints.rows, joints.hands, state, h)
