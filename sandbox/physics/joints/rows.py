"""Joint rows: velocities that an impulse of bounded size brings to a target; motors and hands are such rows.

A row is u = sum g . v over some particles, and its impulse P gives each of them g P. It obeys the equation in its
implicit form, K made as large as it likes, and the impulse is clamped:

    P = -K (u' - target),   1/K = softness,   |P| <= limit

so what a joint can carry is its limit alone, and it gives no more than it needs. Solvers find P with all else that acts
on the particles: the direct one among its contacts, the iterative one among its springs.

Another kind of joint makes its rows in `joint_set.py` and fills in their numbers at the start of every substep.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel

# Of a row: alone; the first of two whose impulses together are clamped by their length; the second of them.
SCALAR, PAIR, SECOND_OF_TWO = 0, 1, -1


class JointRows(NamedTuple):
    """The rows of a world's joints. Topology decides the first three fields, a substep the others."""

    first: Annotated[Slots, "rows + 1"]  # entries of row k are first[k] to first[k + 1]
    particle: Annotated[Slots, "entries"]  # free ones, each at most once in a row
    pair: Annotated[Slots, "rows"]  # SCALAR, or one of two that follow each other
    gradient: Annotated[FloatRows, "entries, 2"]
    target: Annotated[Floats, "rows"]
    softness: Annotated[Floats, "rows"]  # 1/K
    limit: Annotated[Floats, "rows"]  # of the impulse, 0: the row is off; two that are clamped together have the same
    impulse: Annotated[Floats, "rows"]  # that of the last substep, then of this one


@inner_kernel
def any_on(rows: JointRows) -> bool:
    """Whether any row is on."""
    found = False
    for k in range(rows.limit.shape[0]):
        found = found or rows.limit[k] > 0.0
    return found


@inner_kernel
def row_velocity(rows: JointRows, k: int, velocity: FloatRows, delta_v: FloatRows) -> float:
    """u = sum g . v of a row, from velocity + delta_v (n, 2)."""
    u = 0.0
    for e in range(rows.first[k], rows.first[k + 1]):
        p = rows.particle[e]
        u += rows.gradient[e, 0] * (velocity[p, 0] + delta_v[p, 0])
        u += rows.gradient[e, 1] * (velocity[p, 1] + delta_v[p, 1])
    return u


@inner_kernel
def clamped(impulse: float, limit: float) -> float:
    """An impulse of at most this size, either way."""
    return min(max(impulse, -limit), limit)


@inner_kernel
def shortened(first: float, second: float, limit: float) -> float:
    """By what two impulses at right angles are multiplied so that they are no longer than the limit."""
    # Compared as squares: most are short, and no root is taken of them.
    square = first * first + second * second
    if square > limit * limit:
        return limit / math.sqrt(square)
    return 1.0
