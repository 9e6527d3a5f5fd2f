"""Position and velocity of free contacts within a small step, and how impulses change them."""

import math

from sandbox.physics.geometry.segment import SHORTEST
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.solvers.contact.free_constraints import (
    ALONG,
    ALONG_CENTRES,
    APART_X,
    APART_Y,
    ARM,
    BOUNCE,
    FOLLOWS,
    GAP,
    NX,
    NY,
    PER_REACH,
    RATIO_P,
    RATIO_Q,
    REACH,
    ROLL_P,
    ROLL_Q,
    ROLLING,
    ROLLING_MASS,
    SURFACE,
    TURN_P,
    TURN_Q,
    VX,
    VY,
    WAY,
    WEIGHT_P,
    WEIGHT_Q,
    WX,
    WY,
    FreeContactScratch,
)


@inner_kernel
def _time_until(dx: float, dy: float, ux: float, uy: float, reach: float) -> float:
    # When two discs meet that are d apart and move by u; infinite where they never do.
    # |d + t u| = reach
    squared = ux * ux + uy * uy
    along = dx * ux + dy * uy
    apart = dx * dx + dy * dy - reach * reach
    if apart <= 0.0:
        return 0.0
    inside = along * along - squared * apart
    if not (along < 0.0 and inside >= 0.0):
        return math.inf
    return apart / (math.sqrt(inside) - along)


@inner_kernel
def meet(work: FreeContactScratch, i: int, p: int, q: int, small: float) -> float:
    """When two discs that are coming meet [s], and so the normal then; infinite: not in this small step [s]."""
    row, motion = work.constraint, work.motion
    ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
    wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
    wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
    late = _time_until(wx, wy, ux, uy, -row[i, REACH])
    if not late < small:
        return math.inf
    dx, dy = wx + late * ux, wy + late * uy
    distance = math.sqrt(dx * dx + dy * dy)
    if distance > SHORTEST:
        row[i, NX] = dx / distance
        row[i, NY] = dy / distance
    row[i, GAP] = row[i, REACH] + row[i, NX] * wx + row[i, NY] * wy
    row[i, ARM] = distance * row[i, PER_REACH]
    row[i, WAY] = FOLLOWS
    row[i, BOUNCE] = 0.0
    return late


@inner_kernel
def look(work: FreeContactScratch, first: int, last: int) -> None:
    """Update the gaps of contacts, and the normals and arms of discs, which follow the centres."""
    row, end, motion = work.constraint, work.end, work.motion
    for i in range(first, last):
        p = end[i, 0]
        q = end[i, 1]
        nx, ny = row[i, NX], row[i, NY]
        wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
        wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
        gap = row[i, REACH] + nx * wx + ny * wy
        if row[i, WAY] == FOLLOWS:
            if abs(nx * wy - ny * wx) > -ALONG_CENTRES * row[i, REACH]:
                distance = math.sqrt(wx * wx + wy * wy)
                if distance > SHORTEST:
                    per_distance = 1.0 / distance
                    row[i, NX] = wx * per_distance
                    row[i, NY] = wy * per_distance
                gap = row[i, REACH] + distance
            row[i, ARM] = 1.0 + gap * row[i, PER_REACH]
        row[i, GAP] = gap


@inner_kernel
def look_at(work: FreeContactScratch, i: int, late: float) -> None:
    """Where a contact is so much later [s] within the small step; its gap is that of now along this normal."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    wx = row[i, APART_X] + (motion[p, WX] - motion[q, WX])
    wy = row[i, APART_Y] + (motion[p, WY] - motion[q, WY])
    if row[i, WAY] == FOLLOWS:
        dx = wx + late * (motion[p, VX] - motion[q, VX])
        dy = wy + late * (motion[p, VY] - motion[q, VY])
        distance = math.sqrt(dx * dx + dy * dy)
        if distance > SHORTEST:
            row[i, NX] = dx / distance
            row[i, NY] = dy / distance
        row[i, ARM] = distance * row[i, PER_REACH]
    row[i, GAP] = row[i, REACH] + row[i, NX] * wx + row[i, NY] * wy


@inlined_kernel
def apply(
    work: FreeContactScratch, i: int, nx: float, ny: float, jn: float, jt: float, arm: float, late: float, rolls: bool
) -> None:  # fmt: skip
    """Push both ends of a contact by an impulse [N s], jn along its normal and jt across, so late [s].

    rolls: against their turn on each other acts a torque as well, as an impulse at the smaller radius, of at most
    ROLLING times that along the normal.
    """
    # v += J / m, and what it does to the surfaces.
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    jx, jy = jn * nx - jt * ny, jn * ny + jt * nx
    weight_p, weight_q = row[i, WEIGHT_P], row[i, WEIGHT_Q]
    surface_p, surface_q = motion[p, SURFACE], motion[q, SURFACE]
    roll_p, roll_q = row[i, ROLL_P], row[i, ROLL_Q]
    turn = row[i, RATIO_P] * surface_p - row[i, RATIO_Q] * surface_q
    surface_p -= jt * (arm * row[i, TURN_P])  # (35)
    surface_q -= jt * (arm * row[i, TURN_Q])
    if rolls and row[i, ROLLING] > 0.0:
        most = row[i, ROLLING] * row[i, ALONG]
        turn -= jt * (arm * (roll_p - roll_q))
        j = min(most, max(-most, -turn * row[i, ROLLING_MASS]))
        surface_p += j * roll_p
        surface_q -= j * roll_q
    motion[p, VX] += jx * weight_p
    motion[p, VY] += jy * weight_p
    motion[q, VX] -= jx * weight_q
    motion[q, VY] -= jy * weight_q
    motion[p, SURFACE], motion[q, SURFACE] = surface_p, surface_q
    if late > 0.0:
        # It acts where discs meet that are coming: what it changes of their ways until then is taken off.
        motion[p, WX] -= late * jx * weight_p
        motion[p, WY] -= late * jy * weight_p
        motion[q, WX] += late * jx * weight_q
        motion[q, WY] += late * jy * weight_q


@inlined_kernel
def approach(work: FreeContactScratch, i: int) -> float:
    """Velocity of two ends of a contact apart along its normal [m/s]."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    return row[i, NX] * (motion[p, VX] - motion[q, VX]) + row[i, NY] * (motion[p, VY] - motion[q, VY])


@inlined_kernel
def slip(work: FreeContactScratch, i: int) -> float:
    """Velocity of two surfaces against each other across the normal [m/s]."""
    row, motion = work.constraint, work.motion
    p, q = work.end[i, 0], work.end[i, 1]
    ux, uy = motion[p, VX] - motion[q, VX], motion[p, VY] - motion[q, VY]
    return row[i, NX] * uy - row[i, NY] * ux - row[i, ARM] * (motion[p, SURFACE] + motion[q, SURFACE])
