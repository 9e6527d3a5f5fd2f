"""Springs at what a hand holds, in the iterative solver: each is solved with the hand, as one.

A hand is as stiff as the whole body is heavy; what it holds may be light, and much may hang on that. As a row of its
own it would give in an iteration only what stops the light end, and swing what hangs there ever wider. So a spring is
given what it asks for where the hand answers at once: the hand is eliminated from the two (a Schur complement).

    y = G W n,    A = (G W G + 1/K)^-1,    P(j) = the hand's impulse where the spring gives j:  P0 - A y j, clamped
    w j + y . (P(j) - P) = r

G = the hand's rows, W = inverse masses, w = n W n, r = the change that the spring still asks for. Where the hand is not
at its limit, the spring's effective mass is 1 / (w - y A y): that of a light end is nearly a pin's. The left side rises
with j, so there is one j; at the limit Newton's method finds it. P reaches the particles after all springs; until then
y . P is what it does to a spring.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_tuple
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.hands import Grips, HandRows
from sandbox.physics.joints.joint_answers import Joints, own_response
from sandbox.physics.joints.joint_sweep import answer_of_two, give_impulse
from sandbox.physics.joints.rows import row_velocity, shortened
from sandbox.physics.state import State

# A hand answers at once to a spring of whose impulse it takes more than this part. One that holds a soft body all over
# takes next to nothing of that of any of many springs.
LEAST_TAKEN = 0.2
# How often j is made better where a hand is at its limit: along one line once is enough.
ROUNDS = 4
# The effective inverse mass of a spring with hands is at least this part of that without: what rounding leaves.
LEAST_INVERSE_MASS_SHARE = 1e-12


class HeldSprings(NamedTuple):
    """The hands that are solved with springs, and those springs."""

    hand: Annotated[Slots, "hands"]  # first row of each
    row: Annotated[Slots, "particles"]  # by particle: that of the hand that holds it, -1: none
    entry: Annotated[Slots, "particles"]  # by particle: its place in the row
    at: Annotated[SlotRows, "springs, 2"]  # by spring that pulls: the rows of hands at its ends, the first -1: none
    answer: Annotated[FloatRows, "springs, 4"]  # y of each
    asked: Annotated[FloatRows, "springs, 4"]  # A y of each
    mass: Annotated[Floats, "springs"]  # [kg]: effective mass where no hand that answers at once is at its limit
    free: Annotated[FloatRows, "2, 2"]  # scratch, P0


@inner_kernel
def no_held_springs(arena: Arena) -> HeldSprings:
    """Those of a world without hands."""
    return new_tuple(HeldSprings, arena, hands=0, particles=0, springs=0)


@inner_kernel
def _is_apart(grips: Grips, i: int, row: Slots) -> bool:
    # Whether no hand before it holds anything of what a hand holds.
    found = True
    for e in range(grips.start[i], grips.start[i + 1]):
        found = found and row[grips.particle[e]] < 0
    return found


@inner_kernel
def new_held_springs(hands: HandRows, state: State, springs: int, arena: Arena) -> HeldSprings:
    """The hands of a world of so many springs that hold no particle that one before them holds."""
    grips = hands.grips
    count, particles = grips.hand.shape[0], state.owner.shape[0]
    if count == 0:
        return no_held_springs(arena)
    made = new_tuple(HeldSprings, arena, hands=count, particles=particles, springs=springs)
    if is_full(arena):
        return made
    for p in range(particles):
        made.row[p] = -1
    last = 0
    for i in range(count):
        if _is_apart(grips, i, made.row):
            made.hand[last] = hands.row[i]
            last += 1
            for e in range(grips.start[i], grips.start[i + 1]):
                made.row[grips.particle[e]] = hands.row[i]
                made.entry[grips.particle[e]] = e - grips.start[i]
    return HeldSprings(
        made.hand[:last], made.row, made.entry, made.at, made.answer, made.asked, made.mass, made.free
    )  # fmt: skip


@inner_kernel
def _asked(joints: Joints, k: int, x: float, y: float) -> tuple[float, float]:
    # (G W G + 1/K)^-1 (x, y): the impulse that takes such a velocity from what a hand holds.
    couplings = joints.couplings
    a = own_response(joints, k) + joints.rows.softness[k]
    b = couplings.response[couplings.own[k] + 1]
    d = own_response(joints, k + 1) + joints.rows.softness[k + 1]
    determinant = a * d - b * b
    if not determinant > 0.0:
        return 0.0, 0.0
    return (d * x - b * y) / determinant, (a * y - b * x) / determinant


@inner_kernel
def _find_answers(held: HeldSprings, joints: Joints, state: State, s: int, c: int, nx: float, ny: float) -> None:
    # y of the hands at the ends of a spring; one that holds both is entered once.
    rows = joints.rows
    held.at[c, 0] = held.at[c, 1] = -1
    for end in range(2):
        p, sign = (state.particle_b[s], 1.0) if end == 1 else (state.particle_a[s], -1.0)
        k = held.row[p]
        if k < 0:
            continue
        place = 0 if held.at[c, 0] < 0 or held.at[c, 0] == k else 1
        if held.at[c, place] < 0:
            held.at[c, place] = k
            held.answer[c, 2 * place] = held.answer[c, 2 * place + 1] = 0.0
        along, across = rows.first[k] + held.entry[p], rows.first[k + 1] + held.entry[p]
        change = sign * state.inverse_mass[p]
        held.answer[c, 2 * place] += change * (rows.gradient[along, 0] * nx + rows.gradient[along, 1] * ny)
        held.answer[c, 2 * place + 1] += change * (rows.gradient[across, 0] * nx + rows.gradient[across, 1] * ny)


@inner_kernel
def load_held_springs(
    held: HeldSprings, joints: Joints, state: State, slot: Slots, normal: FloatRows, mass: Floats, count: int
) -> bool:
    """What hands answer to each spring that pulls, and whether any answers at once.

    slot, normal, mass [kg]: of the first `count` springs that pull.
    """
    found = False
    for c in range(count):
        _find_answers(held, joints, state, slot[c], c, normal[c, 0], normal[c, 1])
        held.mass[c] = mass[c]
        if held.at[c, 0] < 0:
            continue
        taken, less = 0.0, 0.0
        for place in range(2):
            if held.at[c, place] >= 0:
                x, y = held.answer[c, 2 * place], held.answer[c, 2 * place + 1]
                px, py = _asked(joints, held.at[c, place], x, y)
                held.asked[c, 2 * place], held.asked[c, 2 * place + 1] = px, py
                taken = max(taken, px * px + py * py)
                less += x * px + y * py
        if taken > LEAST_TAKEN * LEAST_TAKEN:
            inverse = 1.0 / mass[c]
            held.mass[c] = 1.0 / max(inverse - less, LEAST_INVERSE_MASS_SHARE * inverse)
            found = True
    return found


@inner_kernel
def begin_with_hands(held: HeldSprings, joints: Joints, velocity: FloatRows, change: FloatRows) -> None:
    """Look at what hands hold, before an iteration over all springs."""
    for i in range(held.hand.shape[0]):
        for k in range(held.hand[i], held.hand[i] + 2):
            joints.velocity[k] = row_velocity(joints.rows, k, velocity, change)
            joints.last_impulse[k] = joints.rows.impulse[k]


@inner_kernel
def end_with_hands(held: HeldSprings, joints: Joints, change: FloatRows, inverse_mass: Floats) -> None:
    """Add to particles what hands have answered in an iteration over all springs."""
    for i in range(held.hand.shape[0]):
        for k in range(held.hand[i], held.hand[i] + 2):
            more = joints.rows.impulse[k] - joints.last_impulse[k]
            give_impulse(joints.rows, k, more, change, inverse_mass)


@inner_kernel
def _along(held: HeldSprings, c: int, place: int, x: float, y: float) -> float:
    return held.answer[c, 2 * place] * x + held.answer[c, 2 * place + 1] * y


@inner_kernel
def _hand_at(held: HeldSprings, c: int, place: int, j: float) -> tuple[float, float]:
    # P0 - A y j
    return held.free[place, 0] - held.asked[c, 2 * place] * j, held.free[place, 1] - held.asked[c, 2 * place + 1] * j


@inner_kernel
def _search(
    held: HeldSprings, joints: Joints, c: int, wanted: float, mass: float, least: float, most: float, j: float
) -> float:  # fmt: skip
    # j where hands are at their limits, from that where they are not.
    rows = joints.rows
    for _ in range(ROUNDS):
        left, slope = wanted - j / mass, 1.0 / mass
        for place in range(2):
            k = held.at[c, place]
            if k < 0:
                continue
            first, second = _hand_at(held, c, place, j)
            ax, ay = held.asked[c, 2 * place], held.asked[c, 2 * place + 1]
            yields = _along(held, c, place, ax, ay)
            share = shortened(first, second, rows.limit[k])
            if share < 1.0:
                # In its own direction a hand gives no more.
                along = _along(held, c, place, first, second) * (ax * first + ay * second)
                yields = share * (yields - along / (first * first + second * second))
            left -= _along(held, c, place, share * first - rows.impulse[k], share * second - rows.impulse[k + 1])
            slope -= yields
        j = min(max(j + left / max(slope, LEAST_INVERSE_MASS_SHARE / mass), least), most)  # (23)
    return j


@inner_kernel
def _give_with_hand(joints: Joints, k: int, dx: float, dy: float) -> None:
    couplings = joints.couplings
    both = couplings.response[couplings.own[k] + 1]
    joints.rows.impulse[k] += dx
    joints.rows.impulse[k + 1] += dy
    joints.velocity[k] += own_response(joints, k) * dx + both * dy
    joints.velocity[k + 1] += both * dx + own_response(joints, k + 1) * dy


@inner_kernel
def _let_hands_answer(
    held: HeldSprings, joints: Joints, c: int, wanted: float, mass: float, least: float, most: float
) -> float:  # fmt: skip
    # Give the hands of a spring the impulses P(j); what its velocity lacks with those.
    rows, left, clamps = joints.rows, wanted, False
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            first, second = answer_of_two(joints, k, joints.velocity[k], joints.velocity[k + 1])
            held.free[place, 0], held.free[place, 1] = first, second
            left -= _along(held, c, place, first - rows.impulse[k], second - rows.impulse[k + 1])
    j = min(max(left * held.mass[c], least), most)
    for place in range(2):
        if held.at[c, place] >= 0:
            first, second = _hand_at(held, c, place, j)
            clamps = clamps or shortened(first, second, rows.limit[held.at[c, place]]) < 1.0
    if clamps:
        j = _search(held, joints, c, wanted, mass, least, most, j)
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            first, second = _hand_at(held, c, place, j)
            share = shortened(first, second, rows.limit[k])
            dx, dy = share * first - rows.impulse[k], share * second - rows.impulse[k + 1]
            _give_with_hand(joints, k, dx, dy)
            wanted -= _along(held, c, place, dx, dy)
    return wanted


@inner_kernel
def pull_held(
    held: HeldSprings, joints: Joints, c: int, wanted: float, mass: float, least: float, most: float
) -> float:  # fmt: skip
    """The impulse of a spring with hands at its ends, between bounds, to which they answer at once.

    wanted [m/s]: what its velocity lacks, where particles have nothing yet of what hands answered in the iteration.
    """
    rows = joints.rows
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            dx, dy = rows.impulse[k] - joints.last_impulse[k], rows.impulse[k + 1] - joints.last_impulse[k + 1]
            wanted -= _along(held, c, place, dx, dy)
    if held.mass[c] > mass:
        wanted = _let_hands_answer(held, joints, c, wanted, mass, least, most)
    j = min(max(wanted * mass, least), most)
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            joints.velocity[k] += held.answer[c, 2 * place] * j
            joints.velocity[k + 1] += held.answer[c, 2 * place + 1] * j
    return j
