"""Contacts of what springs hold: impacts first, then sweeps, with one exact solve between them where they settle late.

How fast each contact that bounces leaves is found in passes as those of free particles (free_impacts.py),

    0 <= J,   u' >= b,   J (u' - b) = 0

of all hits of a pass at once, on the Delassus blocks of bodies. The passes only look ahead. What they find is the
velocity at which the sweeps of the step hold each contact, and the impulses with which these begin: the springs and all
that rests have their say in the sweeps.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.surfaces import SLOWEST_PASSED
from sandbox.physics.collision.types import ENDS, Contacts, contacts_between, weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_rows import Joints, go_on_with_joints, start_joints, sweep_joints, swept_by
from sandbox.physics.solvers.contact.active_solve import EXACT, solve_active
from sandbox.physics.solvers.contact.gauss_seidel import (
    CALM_SETTLED,
    ContactConstraints,
    ContactOrder,
    Delassus,
    add_change,
    approach_of,
    load_biases,
    load_responses,
    load_surfaces,
    push_contact,
    store_spins,
    sweep,
    terms_between,
    warm_start_contacts,
)
from sandbox.physics.state import State

# Sweeps end where no contact changed its velocity by more [m/s].
SETTLED = 1e-6
# A round of sweeps that leaves more than this share of what the one before has left goes nowhere, once that is less
# than so much [m/s]: no more rounds. Without that machines that carry a load take three times as long.
STALLED = 0.8
STALLS_BELOW = 1e-3
# Sweeps before the exact solve, and after one that settles. Fewer before leave it more to find, more take time.
SWEEPS_BEFORE = 8
SWEEPS_AFTER = 2
# Passes of impacts at most; a row of n balls takes n - 1. Sweeps of each at most, which end where no hit changed its
# velocity by more [m/s].
PASSES = 64
PASS_SWEEPS = 50
PASS_SETTLED = 1e-10
# What they may cost in all: so many pushes for each contact, and so many.
WORK_EACH = 200
LEAST_WORK = 4000


@inner_kernel
def sweep_masses(
    contacts: Contacts, terms: ContactConstraints, order: ContactOrder, state: State, delta_v: FloatRows,
    delassus: Delassus, sweeps: int, h: float,
) -> None:  # fmt: skip
    """Solve contacts of particles that answer by their own mass; bring velocities and spins to the end of the step.

    delta_v (n, 2): scratch.
    """
    for p in range(delta_v.shape[0]):
        delta_v[p, 0] = 0.0
        delta_v[p, 1] = 0.0
    load_surfaces(terms, state.spin, state.radius)
    load_biases(contacts, terms, h)
    load_responses(contacts, terms, state.inverse_mass, delassus)
    for i in range(order.islands[0]):
        of_island, its_terms = _of_island(i, contacts, terms, order)
        propagate_impacts(of_island, its_terms, state.velocity, delta_v, state.inverse_mass, delassus, h)
        solve_contacts(
            of_island, its_terms, state.velocity, delta_v, state.inverse_mass, delassus, sweeps, sweeps, 0.0, 1.0
        )  # fmt: skip
    add_change(state.velocity, delta_v, state.inverse_mass)
    store_spins(terms, state.spin, state.radius)


@inner_kernel
def _of_island(
    i: int, contacts: Contacts, terms: ContactConstraints, order: ContactOrder
) -> tuple[Contacts, ContactConstraints]:
    first, last = order.first[i], order.first[i + 1]
    return contacts_between(contacts, first, last), terms_between(terms, first, last)


@inner_kernel
def propagate_all_impacts(
    contacts: Contacts, terms: ContactConstraints, order: ContactOrder, velocity: FloatRows, delta_v: FloatRows,
    inverse_mass: Floats, delassus: Delassus, h: float,
) -> None:  # fmt: skip
    """`propagate_impacts` of every island by itself."""
    for i in range(order.islands[0]):
        of_island, its_terms = _of_island(i, contacts, terms, order)
        propagate_impacts(of_island, its_terms, velocity, delta_v, inverse_mass, delassus, h)


@inner_kernel
def propagate_impacts(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, h: float,
) -> None:  # fmt: skip
    """Find how fast all that bounces in a step of h [s] leaves, in passes from what is hit to what that hits in turn.

    Then `bounce` and bias say so, and contacts begin with these impulses. delta_v is zero before and after.
    """
    # Whether anything bounces at all, and what `before` is then.
    bounces = False
    for c in range(contacts.particle.shape[0]):
        bounces = bounces or (contacts.bounce[c] >= 0.0 and terms.normal[c] > 0.0)
    if bounces:
        for c in range(contacts.particle.shape[0]):
            terms.last_impulse[c, 0] = 0.0
            terms.last_impulse[c, 1] = 0.0
            if not contacts.bounce[c] >= 0.0:
                terms.last_impulse[c, 1] = min(0.0, approach_of(contacts, c, velocity, delta_v))
    if not bounces:
        return
    count = contacts.particle.shape[0]
    remaining = LEAST_WORK + WORK_EACH * count
    hits = _find_hits(contacts, terms, velocity, delta_v, True, h)
    for _ in range(PASSES):
        remaining -= hits * _solve_pass(contacts, terms, velocity, delta_v, inverse_mass, delassus, hits == 1)
        if remaining <= 0:
            break
        hits = _find_hits(contacts, terms, velocity, delta_v, False, h)
        if hits == 0:
            break
    # What has been hit is stopped where it still approaches.
    for c in range(contacts.particle.shape[0]):
        terms.search_direction[c, 0] = 0.0
        terms.search_direction[c, 1] = -max(0.0, contacts.gap[c]) / h if terms.last_impulse[c, 0] > 0.0 else -math.inf
    _solve_pass(contacts, terms, velocity, delta_v, inverse_mass, delassus, False)
    for c in range(count):
        terms.search_direction[c, 0] = 0.0
        terms.search_direction[c, 1] = 0.0
        if terms.last_impulse[c, 0] > 0.0:
            contacts.impulse[c, 0] += terms.last_impulse[c, 0]
            if contacts.restitution[c] > 0.0:
                contacts.bounce[c] = max(0.0, approach_of(contacts, c, velocity, delta_v))
                terms.bias[c] = -contacts.bounce[c]
    for c in range(count):
        for end in range(ENDS):
            p, _ = weight_of(contacts, c, end)
            if p >= 0:
                # That is all: a body answers where contacts touch it.
                delta_v[p, 0] = 0.0
                delta_v[p, 1] = 0.0


@inner_kernel
def _find_hits(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, is_first: bool, h: float
) -> int:  # fmt: skip
    # direction = impulse in this pass, and the velocity along the normal that is wanted (-inf: no hit); before = the
    # sum of impulses, and how fast forces alone bring it near. How many hits there are.
    hits = 0
    for c in range(contacts.particle.shape[0]):
        terms.search_direction[c, 0] = 0.0
        terms.search_direction[c, 1] = -math.inf
        if not terms.normal[c] > 0.0:
            continue
        if is_first:
            if contacts.bounce[c] >= 0.0:
                terms.search_direction[c, 1] = contacts.bounce[c]
                hits += 1
            continue
        u = approach_of(contacts, c, velocity, delta_v)
        v = u - terms.last_impulse[c, 1]
        gap = contacts.gap[c]
        if v < -SLOWEST_PASSED and gap + h * u <= 0.0:
            e = contacts.restitution[c]
            terms.search_direction[c, 1] = -e * v if e > 0.0 else -max(0.0, gap) / h
            hits += 1
    return hits


@inner_kernel
def _solve_pass(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, is_alone: bool,
) -> int:  # fmt: skip
    # J = max(0, J + (b - u) / W) in sweeps; how many. Then `last_impulse` has what they have given.
    count = contacts.particle.shape[0]
    done = 0
    for _ in range(PASS_SWEEPS):
        largest = 0.0
        done += 1
        for c in range(count):
            target = terms.search_direction[c, 1]
            if target == -math.inf:
                continue
            old = terms.search_direction[c, 0]
            lacks = target - approach_of(contacts, c, velocity, delta_v)
            j = max(0.0, old + lacks / terms.normal[c]) - old  # (32)
            if j != 0.0:
                terms.search_direction[c, 0] += j
                push_contact(contacts, c, j, 0.0, terms.surface, delta_v, inverse_mass, delassus)
                largest = max(largest, abs(j) * terms.normal[c])
        if is_alone or largest < PASS_SETTLED:
            break
    for c in range(count):
        terms.last_impulse[c, 0] += terms.search_direction[c, 0]
        if terms.search_direction[c, 0] > 0.0:
            terms.last_impulse[c, 1] = 0.0
    return done


@inner_kernel
def solve_contacts(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, sweeps: int, most: int, affordable: float, cost: float,
) -> int:  # fmt: skip
    """Sweep until nothing changes, at most so many times, or `most` where what is calm changes still; what it took, in
    sweeps.

    affordable: what an exact solve may take, in sweeps of `cost` pushes; 0: there is none. Each sweep goes on in the
    direction of those before it. Joints are swept before contacts.
    """
    # Nonlinear conjugate gradients on the sweep as a fixed point (Silcowitz-Poulsen and others 2010).
    start_sweeps(contacts, terms, delta_v, inverse_mass, delassus)
    previous = 0.0
    done = 0
    checked = math.inf
    spent = 0
    settled = False
    while True:
        of_joints, swept, calm = sweep_all(contacts, terms, velocity, delta_v, inverse_mass, delassus)
        largest = max(of_joints, swept)
        done += 1
        if largest < SETTLED or done >= most or (done >= sweeps and calm < CALM_SETTLED):
            return done + spent
        # The exact solve has settled: two sweeps more for what bounds depend on, unless joints change still.
        if settled and of_joints < EXACT and (swept < EXACT or done >= SWEEPS_BEFORE + SWEEPS_AFTER):
            return done + spent
        if done == SWEEPS_BEFORE and swept > EXACT and affordable > 0.0:
            settled, spent = solve_active(
                contacts, terms, velocity, delta_v, inverse_mass, delassus, affordable, cost
            )  # fmt: skip
            previous = 0.0
            for c in range(contacts.particle.shape[0]):
                terms.search_direction[c, 0] = terms.search_direction[c, 1] = 0.0
            continue
        if done % sweeps == 0:
            if calm < STALLS_BELOW and calm > STALLED * checked:
                return done + spent
            checked = calm
        squared = change_of_sweep(contacts, terms, delassus.joints)
        ratio = squared / previous if previous > 0.0 else 0.0
        go_on(contacts, terms, delta_v, inverse_mass, delassus, ratio if ratio < 1.0 else 0.0)
        previous = squared


@inner_kernel
def start_sweeps(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus
) -> None:
    """Apply the impulses that joints and contacts bring along."""
    start_joints(delassus.joints, delta_v)
    warm_start_contacts(contacts, terms, delta_v, inverse_mass, delassus)


@inner_kernel
def sweep_all(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus,
) -> tuple[float, float, float]:  # fmt: skip
    """One sweep over joints, then contacts; the largest changes of a velocity [m/s], of joints, contacts, calm ones."""
    for c in range(contacts.particle.shape[0]):
        terms.last_impulse[c, 0] = contacts.impulse[c, 0]
        terms.last_impulse[c, 1] = contacts.impulse[c, 1]
    of_joints = sweep_joints(delassus.joints, delta_v)
    swept, calm = sweep(contacts, terms, velocity, delta_v, inverse_mass, delassus)
    return of_joints, swept, calm


@inner_kernel
def change_of_sweep(contacts: Contacts, terms: ContactConstraints, joints: Joints) -> float:
    """The squared change of impulses in the last sweep, in the metric of the responses."""
    squared = swept_by(joints)
    for c in range(contacts.particle.shape[0]):
        jn = contacts.impulse[c, 0] - terms.last_impulse[c, 0]
        jt = contacts.impulse[c, 1] - terms.last_impulse[c, 1]
        squared += terms.normal[c] * jn * jn + terms.tangent[c] * jt * jt
    return squared


@inner_kernel
def go_on(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus,
    ratio: float,
) -> None:  # fmt: skip
    """Move impulses along the search direction times a ratio, and add the last sweep's change to that direction."""
    # J += ratio p, clamped;  p = ratio p + what the sweep has changed.
    go_on_with_joints(delassus.joints, delta_v, ratio)
    for c in range(contacts.particle.shape[0]):
        old_n = contacts.impulse[c, 0]
        old_t = contacts.impulse[c, 1]
        more_n = ratio * terms.search_direction[c, 0]
        more_t = ratio * terms.search_direction[c, 1]
        terms.search_direction[c, 0] = more_n + (old_n - terms.last_impulse[c, 0])
        terms.search_direction[c, 1] = more_t + (old_t - terms.last_impulse[c, 1])
        new_n = max(0.0, old_n + more_n)
        most = contacts.friction[c] * new_n
        new_t = min(most, max(-most, old_t + more_t))
        if new_n != old_n or new_t != old_t:
            contacts.impulse[c, 0] = new_n
            contacts.impulse[c, 1] = new_t
            push_contact(contacts, c, new_n - old_n, new_t - old_t, terms.surface, delta_v, inverse_mass, delassus)
