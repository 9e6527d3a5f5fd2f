"""Impacts of what springs hold: how fast each contact that bounces leaves, in passes as those of free particles.

    0 <= J,   u' >= b,   J (u' - b) = 0

of all hits of a pass at once (impacts.py), on the Delassus blocks of bodies. The passes only look ahead. What they find
is the velocity at which the sweeps of the step hold each contact, and the impulses with which these begin: the springs
and all that rests have their say in the sweeps.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.surfaces import SLOWEST_PASSED
from sandbox.physics.collision.types import ENDS, Contacts, contacts_between, weight_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.contact_order import ContactOrder
from sandbox.physics.solvers.contact.contact_solve import solve_contacts
from sandbox.physics.solvers.contact.gauss_seidel import (
    ContactConstraints,
    Delassus,
    add_change,
    approach_of,
    load_biases,
    load_responses,
    load_surfaces,
    push_contact,
    store_spins,
    terms_between,
)
from sandbox.physics.state import State

# Passes at most; a row of n balls takes n - 1. Sweeps of each at most, which end where no hit changed its velocity by
# more [m/s].
PASSES = 64
PASS_SWEEPS = 50
SETTLED = 1e-10
# What they may cost in all: so many pushes for each contact, and so many.
WORK_EACH = 200
LEAST_WORK = 4000


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
def _find_held(contacts: Contacts, terms: ContactConstraints, h: float) -> None:
    # What has been hit is stopped where it still approaches.
    for c in range(contacts.particle.shape[0]):
        terms.search_direction[c, 0] = 0.0
        terms.search_direction[c, 1] = -max(0.0, contacts.gap[c]) / h if terms.last_impulse[c, 0] > 0.0 else -math.inf


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
            wanted = terms.search_direction[c, 1]
            if wanted == -math.inf:
                continue
            old = terms.search_direction[c, 0]
            lacks = wanted - approach_of(contacts, c, velocity, delta_v)
            j = max(0.0, old + lacks / terms.normal[c]) - old  # (32)
            if j != 0.0:
                terms.search_direction[c, 0] += j
                push_contact(contacts, c, j, 0.0, terms.surface, delta_v, inverse_mass, delassus)
                largest = max(largest, abs(j) * terms.normal[c])
        if is_alone or largest < SETTLED:
            break
    for c in range(count):
        terms.last_impulse[c, 0] += terms.search_direction[c, 0]
        if terms.search_direction[c, 0] > 0.0:
            terms.last_impulse[c, 1] = 0.0
    return done


@inner_kernel
def _begins_with_passes(contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows) -> bool:
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
    return bounces


@inner_kernel
def propagate_impacts(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, h: float,
) -> None:  # fmt: skip
    """Find how fast all that bounces in a step of h [s] leaves, in passes from what is hit to what that hits in turn.

    Then `bounce` and bias say so, and contacts begin with these impulses. delta_v is zero before and after.
    """
    if not _begins_with_passes(contacts, terms, velocity, delta_v):
        return
    count = contacts.particle.shape[0]
    left = LEAST_WORK + WORK_EACH * count
    hits = _find_hits(contacts, terms, velocity, delta_v, True, h)
    for _ in range(PASSES):
        left -= hits * _solve_pass(contacts, terms, velocity, delta_v, inverse_mass, delassus, hits == 1)
        if left <= 0:
            break
        hits = _find_hits(contacts, terms, velocity, delta_v, False, h)
        if hits == 0:
            break
    _find_held(contacts, terms, h)
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
def propagate_all_impacts(
    contacts: Contacts, terms: ContactConstraints, order: ContactOrder, velocity: FloatRows, delta_v: FloatRows,
    inverse_mass: Floats, delassus: Delassus, h: float,
) -> None:  # fmt: skip
    """`propagate_impacts` of every island by itself."""
    for i in range(order.islands[0]):
        of_island, its_terms = _of_island(i, contacts, terms, order)
        propagate_impacts(of_island, its_terms, velocity, delta_v, inverse_mass, delassus, h)


@inner_kernel
def _of_island(
    i: int, contacts: Contacts, terms: ContactConstraints, order: ContactOrder
) -> tuple[Contacts, ContactConstraints]:
    first, last = order.first[i], order.first[i + 1]
    return contacts_between(contacts, first, last), terms_between(terms, first, last)


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
            of_island, its_terms, state.velocity, delta_v, state.inverse_mass, delassus, sweeps, sweeps, 0.0, 1.0, True
        )  # fmt: skip
    add_change(state.velocity, delta_v, state.inverse_mass)
    store_spins(terms, state.spin, state.radius)
