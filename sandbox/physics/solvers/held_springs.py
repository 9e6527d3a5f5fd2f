"""Springs at what a hand holds, in the iterative solver: each is solved with the hand, as one.

A hand is as stiff as the whole body is heavy; what it holds may be light, and much may hang on that. As a row of its own
it would bring in an iteration only what stops the light end, and swing what hangs there ever wider. So a spring is given
what it asks for where the hand answers at once: the hand is eliminated from the two (a Schur complement).

    y = G W n,      P(j) = the hand's impulse where the spring gives j, clamped,      w j + y . (P(j) - P) = r

G = the hand's rows, W = inverse masses, w = n W n, r = the change that the spring still asks for. Where the hand is not
at its limit the spring's effective mass is 1 / (w - y (G W G + 1/K)^-1 y): that of a light end is nearly a pin's. The left
side rises with j, so there is one j, and Newton's method finds it. P reaches the particles after all springs; until then
y . P is what it does to a spring.
"""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_float_rows, new_floats, new_slot_rows, new_slots
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_answers import Joints, own_response
from sandbox.physics.joints.joint_sweep import answer_of_two, give_impulse
from sandbox.physics.joints.rows import PAIR, JointRows, row_velocity, shortened
from sandbox.physics.state import State

# How often j is made better: where hands are clamped by no length once is enough, where along one line twice.
ROUNDS = 4
# The effective inverse mass of a spring with hands is at least this part of that without: what rounding leaves.
LEAST_SHARE = 1e-12


class HeldSprings(NamedTuple):
    """The hands that are solved with springs, and those springs.

    hand (g,): first row of each. By particle (n,): row = that of the hand that holds it, -1: none; entry = its place in
    the row. By spring that pulls (m,): at (m, 2) = the rows of hands at its ends, the first -1: none; answer (m, 4) = y
    of each; mass [kg] = effective mass where no hand is at its limit.
    """

    hand: Slots
    row: Slots
    entry: Slots
    at: SlotRows
    answer: FloatRows
    mass: Floats


@inner_kernel
def _room_for(hands: int, particles: int, springs: int, arena: Arena) -> HeldSprings:
    return HeldSprings(
        new_slots(arena, hands), new_slots(arena, particles), new_slots(arena, particles),
        new_slot_rows(arena, springs, 2), new_float_rows(arena, springs, 4), new_floats(arena, springs),
    )  # fmt: skip


@inner_kernel
def no_held_springs(arena: Arena) -> HeldSprings:
    """Those of a world without hands."""
    return _room_for(0, 0, 0, arena)


@inner_kernel
def _is_free(rows: JointRows, k: int, row: Slots) -> bool:
    # Whether no particle of a hand is held by one that was listed before.
    found = True
    for e in range(rows.first[k], rows.first[k + 1]):
        found = found and row[rows.particle[e]] < 0
    return found


@inner_kernel
def new_held_springs(rows: JointRows, state: State, springs: int, arena: Arena) -> HeldSprings:
    """The hands of a world of so many springs that share no particle with a hand before them."""
    hands = 0
    for k in range(rows.pair.shape[0]):
        hands += 1 if rows.pair[k] == PAIR else 0
    if hands == 0:
        return no_held_springs(arena)
    particles = state.owner.shape[0]
    made = _room_for(hands, particles, springs, arena)
    if is_full(arena):
        return made
    for p in range(particles):
        made.row[p] = -1
    count = 0
    for k in range(rows.pair.shape[0]):
        if rows.pair[k] == PAIR and _is_free(rows, k, made.row):
            made.hand[count] = k
            count += 1
            for e in range(rows.first[k], rows.first[k + 1]):
                made.row[rows.particle[e]] = k
                made.entry[rows.particle[e]] = e - rows.first[k]
    return HeldSprings(made.hand[:count], made.row, made.entry, made.at, made.answer, made.mass)


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
) -> None:
    """What hands answer to each spring that pulls; slot, normal, mass [kg]: of the first `count` of them."""
    for c in range(count):
        _find_answers(held, joints, state, slot[c], c, normal[c, 0], normal[c, 1])
        inverse = 1.0 / mass[c]
        left = inverse
        for place in range(2):
            if held.at[c, place] >= 0:
                x, y = held.answer[c, 2 * place], held.answer[c, 2 * place + 1]
                px, py = _asked(joints, held.at[c, place], x, y)
                left -= x * px + y * py
        held.mass[c] = 1.0 / max(left, LEAST_SHARE * inverse)


@inner_kernel
def begin_with_hands(held: HeldSprings, joints: Joints, velocity: FloatRows, change: FloatRows) -> None:
    """Look at what hands hold, before an iteration over all springs."""
    for i in range(held.hand.shape[0]):
        for k in range(held.hand[i], held.hand[i] + 2):
            joints.velocity[k] = row_velocity(joints.rows, k, velocity, change)
            joints.last_impulse[k] = joints.rows.impulse[k]


@inner_kernel
def end_with_hands(held: HeldSprings, joints: Joints, change: FloatRows, inverse_mass: Floats) -> None:
    """Let particles have what hands have answered in an iteration over all springs."""
    for i in range(held.hand.shape[0]):
        for k in range(held.hand[i], held.hand[i] + 2):
            more = joints.rows.impulse[k] - joints.last_impulse[k]
            give_impulse(joints.rows, k, more, change, inverse_mass)


@inner_kernel
def _hand_at(joints: Joints, k: int, x: float, y: float, j: float, clamps: bool) -> tuple[float, float, float]:
    # P(j) - P of a hand, and by how much less of its velocity a spring gets for each unit that it gives more; x, y = y.
    rows = joints.rows
    first, second = answer_of_two(joints, k, joints.velocity[k] + x * j, joints.velocity[k + 1] + y * j)
    px, py = _asked(joints, k, x, y)
    yields = x * px + y * py
    share = shortened(first, second, rows.limit[k]) if clamps else 1.0
    if share < 1.0:
        # Along its direction it gives no more.
        square = first * first + second * second
        yields = share * (yields - (x * first + y * second) * (px * first + py * second) / square)
    return share * first - rows.impulse[k], share * second - rows.impulse[k + 1], yields


@inner_kernel
def _give_with_hand(joints: Joints, k: int, dx: float, dy: float) -> None:
    couplings = joints.couplings
    both = couplings.response[couplings.own[k] + 1]
    joints.rows.impulse[k] += dx
    joints.rows.impulse[k + 1] += dy
    joints.velocity[k] += own_response(joints, k) * dx + both * dy
    joints.velocity[k + 1] += both * dx + own_response(joints, k + 1) * dy


@inner_kernel
def pull_held(
    held: HeldSprings, joints: Joints, c: int, wanted: float, mass: float, least: float, most: float
) -> float:  # fmt: skip
    """The impulse of a spring with hands at its ends, between bounds, who answer it at once.

    wanted [m/s]: what its velocity lacks where particles have nothing yet of what hands have answered in the iteration.
    """
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            wanted -= held.answer[c, 2 * place] * (joints.rows.impulse[k] - joints.last_impulse[k])
            wanted -= held.answer[c, 2 * place + 1] * (joints.rows.impulse[k + 1] - joints.last_impulse[k + 1])
    j = 0.0
    for turn in range(ROUNDS):
        left, slope = wanted - j / mass, 1.0 / mass
        for place in range(2):
            if held.at[c, place] >= 0:
                x, y = held.answer[c, 2 * place], held.answer[c, 2 * place + 1]
                dx, dy, yields = _hand_at(joints, held.at[c, place], x, y, j, turn > 0)
                left -= x * dx + y * dy
                slope -= yields
        j = min(max(j + left / max(slope, LEAST_SHARE / mass), least), most)
    for place in range(2):
        if held.at[c, place] >= 0:
            x, y = held.answer[c, 2 * place], held.answer[c, 2 * place + 1]
            dx, dy, _ = _hand_at(joints, held.at[c, place], x, y, j, True)
            _give_with_hand(joints, held.at[c, place], dx, dy)
            wanted -= x * dx + y * dy
    j = min(max(wanted * mass, least), most)
    for place in range(2):
        k = held.at[c, place]
        if k >= 0:
            joints.velocity[k] += held.answer[c, 2 * place] * j
            joints.velocity[k + 1] += held.answer[c, 2 * place + 1] * j
    return j
