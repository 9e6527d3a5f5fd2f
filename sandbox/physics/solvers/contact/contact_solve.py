"""Contacts in sweeps, with one exact solve between them where they do not settle soon."""

import math

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_answers import Joints
from sandbox.physics.joints.joint_sweep import go_on_with_joints, start_joints, sweep_joints, swept_by
from sandbox.physics.solvers.contact.active_solve import EXACT, solve_active
from sandbox.physics.solvers.contact.gauss_seidel import (
    CALM_SETTLED,
    ContactConstraints,
    Delassus,
    push_contact,
    sweep,
    warm_start_contacts,
)

# Sweeps end where no contact changed its velocity by more [m/s].
SETTLED = 1e-6
# A round of sweeps that leaves more than this share of what the one before has left goes nowhere, once that is less
# than so much [m/s]: no more rounds. Without that machines that carry a load take three times as long.
STALLED = 0.8
STALLS_BELOW = 1e-3
# Sweeps before the exact solve, and after one that settles. Fewer before leave it more to find, more take time.
SWEEPS_BEFORE = 8
SWEEPS_AFTER = 2


@inner_kernel
def solve_contacts(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus, sweeps: int, most: int, affordable: float, cost: float, accelerate: bool,
) -> int:  # fmt: skip
    """Sweep until nothing changes, at most so many times, or `most` where what is calm changes still; what it took, in
    sweeps.

    affordable: what an exact solve may take, in sweeps of `cost` pushes; 0: there is none. accelerate: each sweep goes
    on in the direction of those before it. Joints are swept before contacts.
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
        ratio = squared / previous if accelerate and previous > 0.0 else 0.0
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
