"""Rows of contacts that carry and stick: which they are, and the matrix (W + R) of their equations."""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.types import ENDS, Contacts, couple_of, weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.active_set import MOST_PRODUCTS, ActiveSet
from sandbox.physics.solvers.contact.contact_walk import node_at
from sandbox.physics.solvers.contact.gauss_seidel import (
    CONTACT_SOFTNESS,
    ContactConstraints,
    Delassus,
    answer_push,
    couple_velocity,
    has_couple,
    relative_velocity,
    surface_speeds,
    turn_surfaces,
)

# States of a row.
AT_BOUND, FREE, SLIPS_UP, SLIPS_DOWN = range(4)
# How soft a contact that sticks is, of W, about where the steps begin. 0 would leave contacts that share a load across
# without a definite share.
STICK_SOFTNESS = 1e-4
# What filling a matrix costs at least, in sweeps; and what one of its products costs, of a push in a sweep.
FILL_SWEEPS = 3.0
PRODUCT = 0.25
# What factoring once may cost, in sweeps.
MOST_SWEEPS = 40.0


@inner_kernel
def velocity_of(
    contacts: Contacts, c: int, velocity: FloatRows, delta_v: FloatRows, surface: Floats
) -> tuple[float, float]:  # fmt: skip
    """Velocity of a contact along its normal, and slip [m/s]."""
    ux, uy = relative_velocity(contacts, c, velocity, delta_v)
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    slip = nx * uy - ny * ux
    turn_p, turn_q = surface_speeds(contacts, c, contacts.arm, surface)
    slip -= turn_p + turn_q
    if has_couple(contacts, c):
        slip += couple_velocity(contacts, c, velocity, delta_v)
    return nx * ux + ny * uy, slip


@inner_kernel
def find_rows(contacts: Contacts, terms: ContactConstraints, count: int) -> int:
    """Find which rows are free, by the sign of one Jacobi step; how many, -1: they are those of last time.

    count: ordered contacts.
    """
    at = terms.active
    rows = 0
    same = True
    for i in range(count):
        c = at.order[i]
        was_n = at.state[c, 0]
        was_t = at.state[c, 1]
        at.row[2 * c] = at.row[2 * c + 1] = -1
        at.state[c, 0] = at.state[c, 1] = AT_BOUND
        at.bound[c] = 0.0
        normal = terms.normal[c]
        jn = contacts.impulse[c, 0]
        if normal > 0.0 and jn * (1.0 - CONTACT_SOFTNESS) * normal - at.u[c, 0] > 0.0:  # (33)
            at.state[c, 0] = FREE
            at.row[2 * c] = rows
            at.of_row[rows] = 2 * c
            rows += 1
            tangent = terms.tangent[c]
            most = contacts.friction[c] * max(0.0, jn)
            if tangent > 0.0 and most > 0.0:
                jt = contacts.impulse[c, 1]
                wanted = jt - (at.u[c, 1] + STICK_SOFTNESS * tangent * (jt - at.centre[c])) / tangent
                if abs(wanted) < most:
                    at.state[c, 1] = FREE
                    at.row[2 * c + 1] = rows
                    at.of_row[rows] = 2 * c + 1
                    rows += 1
                else:
                    at.state[c, 1] = SLIPS_UP if wanted > 0.0 else SLIPS_DOWN
                    at.bound[c] = most if wanted > 0.0 else -most
        same = same and was_n == at.state[c, 0] and was_t == at.state[c, 1]
    return -1 if same else rows


@inner_kernel
def lay_out_envelope(
    contacts: Contacts, at: ActiveSet, rows: int, inverse_mass: Floats, delassus: Delassus, cost: float
) -> float:
    """Find where rows of the matrix begin; what factoring it costs, in sweeps of so many pushes, -1: too much."""
    total = 0
    products = 0.0
    for i in range(rows):
        c = at.of_row[i] // 2
        first = i
        if at.of_row[i] % 2 == 1:
            first = at.first[at.row[2 * c]]
        else:
            for end in range(ENDS):
                node = node_at(contacts, c, end, inverse_mass, delassus)
                place = at.head[node] if node >= 0 else -1
                while place >= 0:
                    row = at.row[2 * (place // ENDS)]
                    if row >= 0:
                        first = min(first, row)
                    place = at.following[place]
        at.first[i] = first
        at.start[i] = total
        total += i - first + 1
        products += float(i - first) * float(i - first)
    at.start[rows] = total
    sweeps = FILL_SWEEPS + PRODUCT * products / max(1.0, cost)
    return sweeps if products <= MOST_PRODUCTS and sweeps <= MOST_SWEEPS else -1.0


@inner_kernel
def _answer_row(
    contacts: Contacts, c: int, axis: int, at: ActiveSet, inverse_mass: Floats, delassus: Delassus
) -> None:  # fmt: skip
    # What an impulse of 1 of a row does.
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    jx = nx if axis == 0 else -ny
    jy = ny if axis == 0 else nx
    for end in range(ENDS):
        p, weight = weight_of(contacts, c, end)
        if p >= 0 and inverse_mass[p] > 0.0:
            cx = 0.0
            cy = 0.0
            if axis == 1:
                cx, cy = couple_of(contacts, c, end)
            answer_push(p, weight * jx + cx, weight * jy + cy, at.answer, inverse_mass, delassus)
    if axis == 1:
        turn_surfaces(contacts, c, -contacts.arm[c, 0], -contacts.arm[c, 1], at.turned)


@inner_kernel
def _clear_answer(contacts: Contacts, c: int, at: ActiveSet, delassus: Delassus) -> None:
    for end in range(ENDS):
        p, _ = weight_of(contacts, c, end)
        if p < 0:
            continue
        k = delassus.block[p]
        if k < 0:
            at.answer[p, 0] = at.answer[p, 1] = 0.0
        else:
            for i in range(delassus.start[k], delassus.start[k + 1]):
                q = delassus.point[i]
                at.answer[q, 0] = at.answer[q, 1] = 0.0
    if contacts.turning[c, 0] > 0.0:
        at.turned[contacts.particle[c]] = 0.0
    if contacts.turning[c, 1] > 0.0:
        at.turned[contacts.end_a[c]] = 0.0


@inner_kernel
def _load_row(contacts: Contacts, c: int, i: int, at: ActiveSet, inverse_mass: Floats, delassus: Delassus) -> None:
    # What the answer gives the rows before row i of contact c, and itself.
    base = at.start[i] - at.first[i]
    for end in range(ENDS):
        node = node_at(contacts, c, end, inverse_mass, delassus)
        place = at.head[node] if node >= 0 else -1
        while place >= 0:
            other = place // ENDS
            place = at.following[place]
            j = at.row[2 * other]
            if not 0 <= j <= i:
                continue
            # Twice the answer, which is exact.
            un, ut = velocity_of(contacts, other, at.answer, at.answer, at.turned)
            turn_p, turn_q = surface_speeds(contacts, other, contacts.arm, at.turned)
            at.matrix[base + j] = 0.5 * un
            if 0 <= at.row[2 * other + 1] <= i:
                at.matrix[base + at.row[2 * other + 1]] = 0.5 * (ut - (turn_p + turn_q))


@inner_kernel
def fill_envelope(
    contacts: Contacts, terms: ContactConstraints, rows: int, inverse_mass: Floats, delassus: Delassus
) -> None:
    """Fill the matrix W + R of rows that are laid out: J W J^T, and on its diagonal how soft they are."""
    at = terms.active
    for k in range(at.start[rows]):
        at.matrix[k] = 0.0
    for i in range(rows):
        c = at.of_row[i] // 2
        axis = at.of_row[i] % 2
        _answer_row(contacts, c, axis, at, inverse_mass, delassus)
        _load_row(contacts, c, i, at, inverse_mass, delassus)
        _clear_answer(contacts, c, at, delassus)
        soft = CONTACT_SOFTNESS * terms.normal[c] if axis == 0 else STICK_SOFTNESS * terms.tangent[c]
        at.matrix[at.start[i] + i - at.first[i]] += soft
