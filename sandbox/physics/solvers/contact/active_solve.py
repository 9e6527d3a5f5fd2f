"""Exact active set: contacts that carry and those that stick as equations, solved at once between sweeps.

Each row, normal or tangent of a contact, is free or at its bound: no push, or friction at its limit. The free rows of
(W + R) dJ = -(u + R J) are solved at once, then the sign of one Jacobi step says which rows are free next: a Newton
step on min(J, u + R J) = 0 (primal-dual active set; Hintermueller, Ito and Kunisch 2002). Friction at its limit follows
the pushes with the same factor. It usually settles in 1 to 6 steps; where it does not, the impulses that miss least
stay. Joints, rolling resistance and what is fast are left to the sweeps after it.
"""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.types import ENDS, Contacts, couple_of, weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.gauss_seidel import (
    CONTACT_SOFTNESS,
    MOST_PRODUCTS,
    ActiveSet,
    ContactConstraints,
    Delassus,
    answer_push,
    couple_velocity,
    has_couple,
    push_contact,
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
# What contacts may miss [m/s] where they are settled, and where they are close enough though the set still changes.
EXACT = 1e-5
CLOSE = 1e-4
# Newton steps at most, and those that may pass without missing less.
STEPS = 6
VAIN_STEPS = 2
# How often friction at its limit follows the pushes in a step, until that moves no contact by more [m/s].
SLIP_ROUNDS = 6
SLIP_SETTLED = 1e-7
# A pivot below this share of its diagonal is none: that row follows from those before it.
SMALLEST_PIVOT = 1e-12


@inner_kernel
def solve_active(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, affordable: float, cost: float,
) -> tuple[bool, int]:  # fmt: skip
    """Solve slow contacts that carry and stick as equations; whether that settles all contacts, and what it took.

    affordable: what it may take, in sweeps; cost: pushes of one sweep.
    """
    at = terms.active
    count = order_contacts(contacts, at, inverse_mass, delassus)
    best = _load_miss(contacts, terms, velocity, delta_v, count)
    if best <= EXACT:
        return count == contacts.particle.shape[0], 0
    for i in range(count):
        at.centre[at.order[i]] = contacts.impulse[at.order[i], 1]
        at.state[at.order[i], 0] = -1
    _keep(contacts, terms, count)
    settled = False
    vain = 0
    spent = 0.0
    for _ in range(STEPS):
        rows = find_rows(contacts, terms, count)
        if rows < 0:
            _keep(contacts, terms, count)
            settled = True
            break
        takes = lay_out_envelope(contacts, at, rows, inverse_mass, delassus, cost)
        if takes < 0.0 or spent + takes > affordable:
            break
        spent += takes
        _step(contacts, terms, velocity, delta_v, inverse_mass, delassus, rows, count)
        miss = _load_miss(contacts, terms, velocity, delta_v, count)
        if miss < best:
            best = miss
            vain = 0
            _keep(contacts, terms, count)
        else:
            vain += 1
        settled = best < EXACT
        if settled or vain >= VAIN_STEPS:
            break
    if spent > 0.0:
        # Within the bounds of Coulomb, which equations do not know.
        for i in range(count):
            c = at.order[i]
            if terms.normal[c] > 0.0:
                jn = max(0.0, at.best[c, 0])
                jt = at.best[c, 1]
                if terms.tangent[c] > 0.0:
                    most = contacts.friction[c] * jn
                    jt = min(most, max(-most, jt))
                _set_impulse(contacts, c, jn, jt, terms, delta_v, inverse_mass, delassus)
        settled = settled or best < CLOSE
    return settled and count == contacts.particle.shape[0], int(spent)


@inner_kernel
def order_contacts(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus) -> int:
    """Order slow contacts by the later rank of the nodes that they touch; how many there are."""
    # The slow contacts of each node, in their order.
    count = contacts.particle.shape[0]
    for c in range(count):
        for end in range(ENDS):
            node = node_at(contacts, c, end, inverse_mass, delassus)
            if node >= 0:
                at.head[node] = at.rank[node] = -1
    for c in range(count - 1, -1, -1):
        if not at.slow[c]:
            continue
        for end in range(ENDS):
            node = node_at(contacts, c, end, inverse_mass, delassus)
            if node >= 0:
                at.following[ENDS * c + end] = at.head[node]
                at.head[node] = ENDS * c + end
    # Ranks of all nodes with slow contacts, how many: joints may be all that holds two of them together.
    base = 0
    for c in range(contacts.particle.shape[0]):
        if not at.slow[c]:
            continue
        for side in range(ENDS):
            node = node_at(contacts, c, side, inverse_mass, delassus)
            if node < 0 or at.rank[node] >= 0:
                continue
            end = _walk(contacts, at, inverse_mass, delassus, node, base)
            # From an end of it.
            for _ in range(2):
                root = at.queue[end - 1]
                for i in range(base, end):
                    at.rank[at.queue[i]] = -1
                end = _walk(contacts, at, inverse_mass, delassus, root, base)
            base = end
    ranked = base
    placed = 0
    for rank in range(ranked):
        place = at.head[at.queue[rank]]
        while place >= 0:
            latest = -1
            for end in range(ENDS):
                other = node_at(contacts, place // ENDS, end, inverse_mass, delassus)
                if other >= 0:
                    latest = max(latest, at.rank[other])
            if latest == rank:
                at.order[placed] = place // ENDS
                placed += 1
            place = at.following[place]
    return placed


@inner_kernel
def node_at(contacts: Contacts, c: int, end: int, inverse_mass: Floats, delassus: Delassus) -> int:
    """The node of an end of a contact; -1: none, it cannot move, or an earlier end has it."""
    p, _ = weight_of(contacts, c, end)
    node = _node_of(p, inverse_mass, delassus)
    for earlier in range(end):
        q, _ = weight_of(contacts, c, earlier)
        if node >= 0 and _node_of(q, inverse_mass, delassus) == node:
            node = -1
    return node


@inner_kernel
def _node_of(p: int, inverse_mass: Floats, delassus: Delassus) -> int:
    if p < 0 or not inverse_mass[p] > 0.0:
        return -1
    k = delassus.block[p]
    return k if k >= 0 else delassus.start.shape[0] - 1 + p


@inner_kernel
def _walk(contacts: Contacts, at: ActiveSet, inverse_mass: Floats, delassus: Delassus, root: int, base: int) -> int:
    # Ranks of what hangs together with a node, breadth first, from `base` on; the rank after the last.
    at.queue[base] = root
    at.rank[root] = base
    end = base + 1
    begin = base
    while begin < end:
        place = at.head[at.queue[begin]]
        begin += 1
        while place >= 0:
            for side in range(ENDS):
                other = node_at(contacts, place // ENDS, side, inverse_mass, delassus)
                if other >= 0 and at.rank[other] < 0:
                    at.rank[other] = end
                    at.queue[end] = other
                    end += 1
            place = at.following[place]
    return end


@inner_kernel
def _load_miss(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, count: int
) -> float:
    # Load the velocities of contacts; by how much they miss the target [m/s].
    at = terms.active
    worst = 0.0
    for i in range(count):
        c = at.order[i]
        if not terms.normal[c] > 0.0:
            continue
        un, ut = velocity_of(contacts, c, velocity, delta_v, terms.surface)
        at.u[c, 0] = un + terms.bias[c]
        at.u[c, 1] = ut + contacts.belt[c]
        jn = contacts.impulse[c, 0]
        target = at.u[c, 0] + CONTACT_SOFTNESS * terms.normal[c] * jn
        worst = max(worst, abs(min(jn * terms.normal[c], target)))
        if terms.tangent[c] > 0.0:
            jt = contacts.impulse[c, 1]
            most = contacts.friction[c] * max(0.0, jn)
            j = min(most, max(-most, jt - at.u[c, 1] / terms.tangent[c]))
            worst = max(worst, terms.tangent[c] * abs(jt - j))
    return worst


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
def _keep(contacts: Contacts, terms: ContactConstraints, count: int) -> None:
    at = terms.active
    for i in range(count):
        c = at.order[i]
        at.best[c, 0] = contacts.impulse[c, 0]
        at.best[c, 1] = contacts.impulse[c, 1]


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
                target = jt - (at.u[c, 1] + STICK_SOFTNESS * tangent * (jt - at.centre[c])) / tangent
                if abs(target) < most:
                    at.state[c, 1] = FREE
                    at.row[2 * c + 1] = rows
                    at.of_row[rows] = 2 * c + 1
                    rows += 1
                else:
                    at.state[c, 1] = SLIPS_UP if target > 0.0 else SLIPS_DOWN
                    at.bound[c] = most if target > 0.0 else -most
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
def _step(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, rows: int, count: int,
) -> None:  # fmt: skip
    # Rows that are free as equations; what stands at a bound goes there.
    at = terms.active
    for i in range(count):
        c = at.order[i]
        jn = contacts.impulse[c, 0] if at.row[2 * c] >= 0 else 0.0
        jt = contacts.impulse[c, 1] if at.row[2 * c + 1] >= 0 else at.bound[c]
        _set_impulse(contacts, c, jn, jt, terms, delta_v, inverse_mass, delassus)
    if rows == 0:
        return
    fill_envelope(contacts, terms, rows, inverse_mass, delassus)
    factor_envelope(rows, at)
    for again in range(1 + SLIP_ROUNDS):
        if again > 0:
            # What slips goes to the friction that its new push allows; by how much that moves a contact at most [m/s].
            moved = 0.0
            for i in range(count):
                c = at.order[i]
                if at.state[c, 1] == SLIPS_UP or at.state[c, 1] == SLIPS_DOWN:
                    most = contacts.friction[c] * max(0.0, contacts.impulse[c, 0])
                    jt = most if at.state[c, 1] == SLIPS_UP else -most
                    moved = max(moved, abs(jt - contacts.impulse[c, 1]) * terms.tangent[c])
                    _set_impulse(contacts, c, contacts.impulse[c, 0], jt, terms, delta_v, inverse_mass, delassus)
            if moved < SLIP_SETTLED:
                break
        for i in range(rows):
            c = at.of_row[i] // 2
            un, ut = velocity_of(contacts, c, velocity, delta_v, terms.surface)
            if at.of_row[i] % 2 == 0:
                # (33)
                at.rhs[i] = -(un + terms.bias[c] + CONTACT_SOFTNESS * terms.normal[c] * contacts.impulse[c, 0])
            else:
                ut += contacts.belt[c]
                at.rhs[i] = -(ut + STICK_SOFTNESS * terms.tangent[c] * (contacts.impulse[c, 1] - at.centre[c]))
        solve_envelope(rows, at)
        for i in range(count):
            c = at.order[i]
            jn, jt = contacts.impulse[c, 0], contacts.impulse[c, 1]
            if at.row[2 * c] >= 0:
                jn += at.rhs[at.row[2 * c]]
            if at.row[2 * c + 1] >= 0:
                jt += at.rhs[at.row[2 * c + 1]]
            _set_impulse(contacts, c, jn, jt, terms, delta_v, inverse_mass, delassus)


@inner_kernel
def _set_impulse(
    contacts: Contacts, c: int, jn: float, jt: float, terms: ContactConstraints, delta_v: FloatRows,
    inverse_mass: Floats, delassus: Delassus,
) -> None:  # fmt: skip
    dn = jn - contacts.impulse[c, 0]
    dt = jt - contacts.impulse[c, 1]
    if dn != 0.0 or dt != 0.0:
        contacts.impulse[c, 0] = jn
        contacts.impulse[c, 1] = jt
        push_contact(contacts, c, dn, dt, terms.surface, delta_v, inverse_mass, delassus)


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
def factor_envelope(rows: int, at: ActiveSet) -> None:
    """L D L^T in place: row i of L from first[i] on, D apart."""
    m, first, start, pivot = at.matrix, at.first, at.start, at.pivot
    for i in range(rows):
        si = start[i] - first[i]
        for j in range(first[i], i):
            sj = start[j] - first[j]
            k = max(first[i], first[j])
            # Four sums, which do not wait for each other.
            a = m[si + j]
            b = 0.0
            c = 0.0
            d = 0.0
            while k + 4 <= j:
                a -= m[si + k] * m[sj + k]
                b -= m[si + k + 1] * m[sj + k + 1]
                c -= m[si + k + 2] * m[sj + k + 2]
                d -= m[si + k + 3] * m[sj + k + 3]
                k += 4
            while k < j:
                a -= m[si + k] * m[sj + k]
                k += 1
            # L_ij D_j for now.
            m[si + j] = (a + b) + (c + d)
        whole = m[si + i]
        remaining = whole
        for j in range(first[i], i):
            held = m[si + j]
            m[si + j] = held / pivot[j] if pivot[j] > 0.0 else 0.0
            remaining -= held * m[si + j]
        pivot[i] = remaining if remaining > SMALLEST_PIVOT * whole else 0.0


@inner_kernel
def solve_envelope(rows: int, at: ActiveSet) -> None:
    """Solve for the right side, in place."""
    m, first, start, pivot, x = at.matrix, at.first, at.start, at.pivot, at.rhs
    for i in range(rows):
        s = start[i] - first[i]
        for j in range(first[i], i):
            x[i] -= m[s + j] * x[j]
    for i in range(rows):
        x[i] = x[i] / pivot[i] if pivot[i] > 0.0 else 0.0
    for i in range(rows - 1, -1, -1):
        s = start[i] - first[i]
        for j in range(first[i], i):
            x[j] -= m[s + j] * x[i]
