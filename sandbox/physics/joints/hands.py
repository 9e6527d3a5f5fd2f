"""Hands (mouse joints): each two rows that draw a point of a body to the hand's cursor, with a force that is bounded.

    F = -K (u' - w),  |F| <= a M h        w = v_c + n min(x / APPROACH, sqrt(2 b x), FASTEST_HAND),  |w| <= FASTEST_HAND

u' = velocity of the point after the step; x, n = distance and direction from there to the cursor, which moves at v_c;
a = strength of the hand, M = mass of what can move of the body, K = M h / YIELDING: the article's spring of length 0
(equation.py), of Cs 0.37 and Cd 0.67 at 60 Hz. It comes in no faster than a part of its force can brake it, at b, so
that it does not overshoot.

The point is a particle; of a body that would tear there it moves as the place of that particle in a frame that goes
along with many (an interpolation constraint): their mean, turned to fit as shape matching does it (Mueller and others
2005). Each bears a share s of the force by its mass and by how near to the point it is, and of the torque that makes it
up:

    u = sum s v + omega x r,    omega = sum s d x v / I,    I = sum s |d|^2,    F_i = s_i (F + (r x F) perp(d_i) / I)

d = place about the mean, r = the point's in the frame, perp(d) = (-d_y, d_x). x is the particle's own: the corner of a
jelly 3 m wide that bends behind its frame would lag by 0.17 m otherwise, at a start to 5 m/s. But only so far: a force
that follows the one place and moves another can give energy to what swings.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_floats, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.components import find_joined
from sandbox.physics.geometry.rigid import best_turn, rotated, with_pair
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_rows import JointRows, shortened
from sandbox.physics.marks import GRAB_COUNT, GRAB_MATERIAL
from sandbox.physics.state import State

# No hand wants what it holds to be faster than this [m/s]. Higher lets a mouse shoot one body through others.
FASTEST_HAND = 30.0
# Near the cursor a hand wants what it holds to be there in this time [s]; more lags behind.
APPROACH = 0.03
# It brakes with this part of its force, and no harder than [m/s^2]. More lets swing past the cursor what is soft, or is
# held off its middle and turns, since what is held stops before the rest does; less makes hands slow.
BRAKE_SHARE = 0.25
HARDEST_BRAKE = 17.0
# In about this time [s] a hand brings a body that is free to the speed that it wants. With a quarter of APPROACH
# nothing swings past the cursor by more than a few hundredths of its way; less is harder on what tears.
YIELDING = 1.0 / 120.0
# Below this moment of inertia for the mass of one [m^2] what is gripped lies in a point and cannot turn.
LEAST_SPREAD = 1e-150
# How far the frame is led beyond the cursor, of the root mean square of the distances from its mean, so that the
# particle that is held comes there. More lets what is very soft swing ever wider in a hand that stands still.
LARGEST_LEAD = 0.05


class Grips(NamedTuple):
    """The hands that hold something that can move, g of them, and the particles that they grip, k in all."""

    hand: Annotated[Slots, "hands"]  # its number
    cursor: Annotated[Slots, "hands"]  # slot of its particle, as spring and held
    spring: Annotated[Slots, "hands"]
    held: Annotated[Slots, "hands"]
    mass: Annotated[Floats, "hands"]  # M [kg]
    arm: Annotated[FloatRows, "hands, 2"]  # [m]: the held point about the mean, in the form at creation
    lead: Annotated[Floats, "hands"]  # [m]: how far that point may be off the held particle
    start: Annotated[Slots, "hands + 1"]  # particles of hand i: particle[start[i]:start[i + 1]]
    particle: Annotated[Slots, "particles"]
    ratio: Annotated[Floats, "particles"]  # s of each
    form: Annotated[FloatRows, "particles, 2"]  # [m]: its place about the mean in that form


class HandRows(NamedTuple):
    """The rows of hands as kernels fill them in: row (g,) = the first of each one's two."""

    row: Slots
    grips: Grips


@inner_kernel
def label_bodies(state: State, joins: Flags, free: Flags, label: Slots) -> None:
    """Label particles (n,): what springs and constraints join by free particles has the same label.

    joins (m,), free (n,): scratch.
    """
    for s in range(joins.shape[0]):
        joins[s] = state.spring_active[s] and state.material[s] != GRAB_MATERIAL
    for p in range(free.shape[0]):
        free[p] = state.inverse_mass[p] > 0.0
    find_joined(state, joins, free, label)


@inner_kernel
def new_grips(state: State, label: Slots, grab_particle: int, grab_spring: int, arena: Arena) -> Grips:
    """The grips of a world's hands; label (n,): see label_bodies; the slots of the first hand, or -1."""
    grips = new_tuple(Grips, arena, hands=0, particles=0)
    hands, particles = 0, 0
    if grab_spring >= 0:
        for hand in range(GRAB_COUNT):
            end = _list_gripped(state, label, hand, grab_spring + hand, particles, grips)
            hands += 1 if end > particles else 0
            particles = end
    grips = new_tuple(Grips, arena, hands=hands, particles=particles)
    work = new_floats(arena, particles)
    if hands == 0 or is_full(arena):
        return grips
    i, first = 0, 0
    for hand in range(GRAB_COUNT):
        end = _list_gripped(state, label, hand, grab_spring + hand, first, grips)
        if end > first:
            grips.hand[i] = hand
            grips.cursor[i] = grab_particle + hand
            grips.spring[i] = grab_spring + hand
            grips.start[i + 1] = end
            _fill_in_grip(state, label, i, grab_spring + hand, work, grips)
            i += 1
            first = end
    return grips


@inner_kernel
def _list_gripped(state: State, label: Slots, hand: int, spring: int, first: int, grips: Grips) -> int:
    # List what a hand grips, from an entry on, where there is room, with its weight; where it ends.
    last, held = first, state.particle_b[spring]
    if not state.spring_active[spring]:
        return last
    for p in range(label.shape[0]):
        weight = _weight_in_grip(state, label, hand, held, p)
        if weight >= 0.0:
            if last < grips.particle.shape[0]:
                grips.particle[last] = p
                grips.ratio[last] = weight
            last += 1
    return last


@inner_kernel
def _weight_in_grip(state: State, label: Slots, hand: int, held: int, p: int) -> float:
    # Of the free particles of a body those that a hand grips which holds one of them; -1: of what it does not.
    if label[p] != label[held] or not state.inverse_mass[p] > 0.0:
        return -1.0
    radius = state.hand_radius[hand]
    if not radius > 0.0:
        return state.mass[p] if p == held else -1.0
    # What else is joined to the body, a rope or a weight, is not gripped with it.
    if state.owner[p] != state.owner[held]:
        return -1.0
    dx = state.origin[p, 0] - state.origin[held, 0]
    dy = state.origin[p, 1] - state.origin[held, 1]
    near = 1.0 - math.sqrt(dx * dx + dy * dy) / radius
    return near * state.mass[p] if near > 0.0 else -1.0


@inner_kernel
def _fill_in_grip(state: State, label: Slots, i: int, spring: int, work: Floats, grips: Grips) -> None:
    # Shares by weight, and the frame of what is gripped. Of a body that is torn the hand keeps the part that it has its
    # point in. work (k,): scratch.
    first, last, held = grips.start[i], grips.start[i + 1], state.particle_b[spring]
    grips.held[i] = held
    begun = False
    for p in range(label.shape[0]):
        if label[p] == label[held] and state.inverse_mass[p] > 0.0:
            grips.mass[i] = grips.mass[i] + state.mass[p] if begun else state.mass[p]
            begun = True
    whole = _sum_in_order(grips.ratio, first, last)
    for k in range(first, last):
        grips.ratio[k] /= whole
    for axis in range(2):
        for k in range(first, last):
            work[k] = grips.ratio[k] * state.origin[grips.particle[k], axis]
        middle = _sum_in_order(work, first, last)
        for k in range(first, last):
            grips.form[k, axis] = state.origin[grips.particle[k], axis] - middle
        grips.arm[i, axis] = state.origin[held, axis] - middle
    for k in range(first, last):
        x, y = grips.form[k, 0], grips.form[k, 1]
        work[k] = grips.ratio[k] * (x * x + y * y)
    grips.lead[i] = LARGEST_LEAD * math.sqrt(_sum_in_order(work, first, last))


@inner_kernel
def _sum_in_order(values: Floats, first: int, last: int) -> float:
    total = values[first]
    for k in range(first + 1, last):
        total += values[k]
    return total


@inner_kernel
def load_hands(rows: JointRows, hands: HandRows, state: State, h: float) -> None:
    """Fill in the rows of hands for a substep of h [s]."""
    grips = hands.grips
    for i in range(grips.hand.shape[0]):
        x, y = _load_gradients(rows, hands, state.position, i)
        hand, k = grips.hand[i], hands.row[i]
        # w, where the point is at x, y in the frame.
        cursor = hands.grips.cursor[i]
        held = hands.grips.held[i]
        wx = state.velocity[cursor, 0]
        wy = state.velocity[cursor, 1]
        dx, dy = difference(held, cursor, state.position)
        bent_x = x - state.position[held, 0]
        bent_y = y - state.position[held, 1]
        beyond = 1.0 - shortened(bent_x, bent_y, hands.grips.lead[i])
        dx -= beyond * bent_x
        dy -= beyond * bent_y
        away = math.sqrt(dx * dx + dy * dy)
        if away > 0.0:
            brake = min(BRAKE_SHARE * state.hand_strength[hands.grips.hand[i]], HARDEST_BRAKE)
            speed = min(away / max(APPROACH, h), math.sqrt(2.0 * brake * away))
            ratio = min(speed, FASTEST_HAND) / away
            wx += ratio * dx
            wy += ratio * dy
        ratio = shortened(wx, wy, FASTEST_HAND)
        rows.target[k], rows.target[k + 1] = wx * ratio, wy * ratio
        limit = state.hand_strength[hand] * grips.mass[i] * h
        jx = state.hand_force[hand, 0] * h
        jy = state.hand_force[hand, 1] * h
        ratio = shortened(jx, jy, limit)
        rows.impulse[k] = jx * ratio
        rows.impulse[k + 1] = jy * ratio
        for row in range(k, k + 2):
            rows.softness[row] = YIELDING / (grips.mass[i] * h)
            rows.limit[row] = limit


@inner_kernel
def _load_gradients(rows: JointRows, hands: HandRows, position: FloatRows, i: int) -> tuple[float, float]:
    # The two rows of a hand, u along x and along y; where the point is in the frame.
    grips = hands.grips
    first, last = grips.start[i], grips.start[i + 1]
    x = 0.0
    y = 0.0
    for k in range(first, last):
        p = grips.particle[k]
        x += grips.ratio[k] * position[p, 0]
        y += grips.ratio[k] * position[p, 1]
    along = 0.0
    across = 0.0
    spread = 0.0
    for k in range(first, last):
        dx = position[grips.particle[k], 0] - x
        dy = position[grips.particle[k], 1] - y
        along, across = with_pair(along, across, grips.ratio[k], grips.form[k, 0], grips.form[k, 1], dx, dy)
        spread += grips.ratio[k] * (dx * dx + dy * dy)
    cosine, sine = best_turn(along, across)
    rx, ry = rotated(cosine, sine, grips.arm[i, 0], grips.arm[i, 1])
    along_x, along_y = rows.first[hands.row[i]], rows.first[hands.row[i] + 1]
    turns = 1.0 / spread if spread > LEAST_SPREAD else 0.0
    for k in range(first, last):
        s = grips.ratio[k]
        dx = (position[grips.particle[k], 0] - x) * turns
        dy = (position[grips.particle[k], 1] - y) * turns
        e = k - first
        rows.gradient[along_x + e, 0] = s * (1.0 + ry * dy)
        rows.gradient[along_x + e, 1] = -s * ry * dx
        rows.gradient[along_y + e, 0] = -s * rx * dy
        rows.gradient[along_y + e, 1] = s * (1.0 + rx * dx)
    return x + rx, y + ry


@inner_kernel
def store_hands(rows: JointRows, hands: HandRows, state: State, h: float) -> None:
    """Keep the forces of hands for the next substep."""
    for i in range(hands.grips.hand.shape[0]):
        for axis in range(2):
            state.hand_force[hands.grips.hand[i], axis] = rows.impulse[hands.row[i] + axis] / h
