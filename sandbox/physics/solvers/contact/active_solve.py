"""Exact active set: contacts that carry and those that stick as equations, solved at once between sweeps.

Each row, normal or tangent of a contact, is free or at its bound: no push, or friction at its limit. The free rows of
(W + R) dJ = -(u + R J) are solved at once, then the sign of one Jacobi step says which rows are free next: a Newton
step on min(J, u + R J) = 0 (primal-dual active set; Hintermueller, Ito and Kunisch 2002). Friction at its limit follows
the pushes with the same factor. It usually settles in 1 to 6 steps; where it does not, the impulses that miss least
stay. Joints, rolling resistance and what is fast are left to the sweeps after it.
"""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.active_rows import (
    SLIPS_DOWN,
    SLIPS_UP,
    STICK_SOFTNESS,
    fill_envelope,
    find_rows,
    lay_out_envelope,
    velocity_of,
)
from sandbox.physics.solvers.contact.active_set import factor_envelope, solve_envelope
from sandbox.physics.solvers.contact.contact_walk import order_contacts
from sandbox.physics.solvers.contact.gauss_seidel import (
    CONTACT_SOFTNESS,
    ContactConstraints,
    Delassus,
    push_contact,
)

# What contacts may miss [m/s] where they are settled, and where they are close enough though the set still changes.
EXACT = 1e-5
CLOSE = 1e-4
# Newton steps at most, and those that may pass without missing less.
STEPS = 6
VAIN_STEPS = 2
# How often friction at its limit follows the pushes in a step, until that moves no contact by more [m/s].
SLIP_ROUNDS = 6
SLIP_SETTLED = 1e-7


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
def _load_miss(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, count: int
) -> float:
    # Load the velocities of contacts; by how much they miss what is wanted [m/s].
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
        wanted = at.u[c, 0] + CONTACT_SOFTNESS * terms.normal[c] * jn
        worst = max(worst, abs(min(jn * terms.normal[c], wanted)))
        if terms.tangent[c] > 0.0:
            jt = contacts.impulse[c, 1]
            most = contacts.friction[c] * max(0.0, jn)
            j = min(most, max(-most, jt - at.u[c, 1] / terms.tangent[c]))
            worst = max(worst, terms.tangent[c] * abs(jt - j))
    return worst


@inner_kernel
def _follow_slip(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus,
    count: int,
) -> float:  # fmt: skip
    # What slips goes to the friction that its new push allows; by how much that moves a contact at most [m/s].
    at = terms.active
    moved = 0.0
    for i in range(count):
        c = at.order[i]
        if at.state[c, 1] == SLIPS_UP or at.state[c, 1] == SLIPS_DOWN:
            most = contacts.friction[c] * max(0.0, contacts.impulse[c, 0])
            jt = most if at.state[c, 1] == SLIPS_UP else -most
            moved = max(moved, abs(jt - contacts.impulse[c, 1]) * terms.tangent[c])
            _set_impulse(contacts, c, contacts.impulse[c, 0], jt, terms, delta_v, inverse_mass, delassus)
    return moved


@inner_kernel
def _go_to_bounds(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus,
    count: int,
) -> None:  # fmt: skip
    at = terms.active
    for i in range(count):
        c = at.order[i]
        jn = contacts.impulse[c, 0] if at.row[2 * c] >= 0 else 0.0
        jt = contacts.impulse[c, 1] if at.row[2 * c + 1] >= 0 else at.bound[c]
        _set_impulse(contacts, c, jn, jt, terms, delta_v, inverse_mass, delassus)


@inner_kernel
def _step(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, rows: int, count: int,
) -> None:  # fmt: skip
    # Rows that are free as equations; what stands at a bound goes there.
    at = terms.active
    _go_to_bounds(contacts, terms, delta_v, inverse_mass, delassus, count)
    if rows == 0:
        return
    fill_envelope(contacts, terms, rows, inverse_mass, delassus)
    factor_envelope(rows, at)
    for again in range(1 + SLIP_ROUNDS):
        if again > 0:
            moved = _follow_slip(contacts, terms, delta_v, inverse_mass, delassus, count)
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
def _keep(contacts: Contacts, terms: ContactConstraints, count: int) -> None:
    at = terms.active
    for i in range(count):
        c = at.order[i]
        at.best[c, 0] = contacts.impulse[c, 0]
        at.best[c, 1] = contacts.impulse[c, 1]


@inner_kernel
def _go_to_best(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus,
    count: int,
) -> None:  # fmt: skip
    # Within the bounds of Coulomb, which equations do not know.
    at = terms.active
    for i in range(count):
        c = at.order[i]
        if terms.normal[c] > 0.0:
            jn = max(0.0, at.best[c, 0])
            jt = at.best[c, 1]
            if terms.tangent[c] > 0.0:
                most = contacts.friction[c] * jn
                jt = min(most, max(-most, jt))
            _set_impulse(contacts, c, jn, jt, terms, delta_v, inverse_mass, delassus)


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
        _go_to_best(contacts, terms, delta_v, inverse_mass, delassus, count)
        settled = settled or best < CLOSE
    return settled and count == contacts.particle.shape[0], int(spent)
