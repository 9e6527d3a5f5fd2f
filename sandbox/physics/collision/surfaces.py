"""Surfaces at contacts: the arm and the couple of friction, how discs turn, belts, and restitution.

A particle of a body has no spin of its own: it turns with a spring that holds it. So an impulse J across a contact,
which acts at its surface, so far [m], the arm, from the particle, gives it and its partner at the other end of that
spring a couple as well: J arm/|d| across the spring. Slip is measured at the surface by the same couple, so W stays
symmetric, and a body's angular momentum changes by what friction does at its rim.

A loose disc, which no spring, constraint or pin holds, has a spin. Its moment of inertia m r^2 / 2 is written for the
speed of its surface, spin times radius: an impulse J there changes that by J r^2 / I = 2 J / m, so the weight of a
surface is twice that of its particle, whatever its radius.

Belts are surfaces of terrain and of bodies' edges that run along, to the right of who stands on them. Restitution is
the velocity with which what meets fast enough leaves again.
"""

import math

from sandbox.physics.arrays import Flags, FloatRows
from sandbox.physics.collision.narrow_phase import FAST, MARGIN
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import TOUCHING, Colliders, Contacts, weight_of
from sandbox.physics.geometry.segment import difference
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import EDGE, INSIDE, KINDS, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.state import State

# A partner that is touched itself is taken if it is as far off as this share of the farthest. On a short spring of soft
# or light particles a couple bends the body where it touches; a wheel's turns with its spokes instead.
FAR_ENOUGH = 0.5
# A spring shorter than so many arms, on which two discs overlap, takes a part of the couple: what is crushed would be
# thrown about.
SHORT = 2.0
# r^2 / I of a disc, times its mass.
SURFACE_WEIGHT = 2.0
# Bodies that meet more slowly [m/s] do not bounce. Lower makes what rests tremble, higher cuts off a last bounce.
SLOWEST_BOUNCE = 0.5
# What a bounce pushes passes it on to what it approaches faster than this [m/s].
# Less costs passes, more leaves balls of a row with a part of the impulse.
SLOWEST_PASSED = 0.05


@inner_kernel
def choose_partners(contacts: Contacts, count: int, attached: Flags, colliders: Colliders, touched: Flags) -> None:
    """Choose the partners of the first `count` contacts; see Contacts.

    attached (n,): what springs hold; touched (n,): scratch.
    """
    for p in range(touched.shape[0]):
        touched[p] = False
    for c in range(count):
        for end in range(TOUCHING):
            p, _ = weight_of(contacts, c, end)
            if p >= 0:
                touched[p] = True
    for c in range(count):
        contacts.partner[c, 0] = contacts.partner[c, 1] = -1
        if not contacts.friction[c] > 0.0:
            continue
        p = contacts.particle[c]
        a = contacts.end_a[c]
        # The ends of an edge turn with each other.
        of_particle = contacts.end_b[c] if a < 0 else -1
        contacts.partner[c, 0] = _partner_of(p, of_particle, attached, colliders, touched)
        if a >= 0:
            contacts.partner[c, 1] = _partner_of(a, contacts.end_b[c], attached, colliders, touched)


@inner_kernel
def _partner_of(p: int, end_b: int, attached: Flags, colliders: Colliders, touched: Flags) -> int:
    # Who turns with a particle: the other end of its edge, unless that is short, else the farthest that a spring joins
    # to it, or one that is near to as far and touched itself, so that nothing more answers to contacts. -1: none. What
    # is far is so where particles were made: in what is crushed it would be another in every step.
    radius = colliders.radius[p]
    if not radius > 0.0:
        return -1
    if end_b >= 0 and _distance(p, end_b, colliders.origin) > SHORT * radius:
        return end_b
    if not attached[p] or not colliders.inverse_mass[p] > 0.0:
        return -1
    first, last = colliders.near_start[p], colliders.near_start[p + 1]
    farthest = 0.0
    for at in range(first, last):
        farthest = max(farthest, _distance(p, colliders.near_of[at], colliders.origin))
    partner = -1
    longest = 0.0
    for at in range(first, last):
        q = colliders.near_of[at]
        distance = _distance(p, q, colliders.origin)
        is_far = distance > max(FAR_ENOUGH * farthest, SHORT * radius)
        preferred = distance + farthest if touched[q] and is_far else distance
        if preferred > longest:
            partner = q
            longest = preferred
    return partner


@inner_kernel
def load_arms(contacts: Contacts, count: int, colliders: Colliders) -> None:
    """Load the moment arms of the particles of the first `count` contacts; see Contacts."""
    for c in range(count):
        p = contacts.particle[c]
        a, b = contacts.end_a[c], contacts.end_b[c]
        disc = a if b < 0 else -1
        contacts.turning[c, 0] = colliders.turning[p]
        contacts.turning[c, 1] = colliders.turning[a] if disc >= 0 else 0.0
        contacts.arm[c, 0] = 1.0
        contacts.arm[c, 1] = 0.0
        contacts.ratio[c, 0], contacts.ratio[c, 1] = rolling_ratios(p, disc, colliders)
        arm = 1.0
        if a >= 0:
            # So all that is turned is turned by both; but what is followed along its way is not there yet.
            reach = colliders.radius[p] + colliders.radius[a]
            if reach > 0.0:
                arm = min(1.0 + MARGIN + FAST, _reach_of(contacts, c, colliders) / reach)
            contacts.arm[c, 0] = arm
            contacts.arm[c, 1] = arm if disc >= 0 else 0.0
        _load_couple(contacts, c, 0, p, arm * colliders.radius[p], colliders)
        _load_couple(contacts, c, 1, a, arm * colliders.radius[a] if a >= 0 else 0.0, colliders)


@inner_kernel
def _load_couple(contacts: Contacts, c: int, of: int, p: int, arm: float, colliders: Colliders) -> None:
    """Load the couple of a contact's particle (of 0) or its end_a (of 1), which is p, for an arm [m]."""
    contacts.couple[c, 2 * of] = contacts.couple[c, 2 * of + 1] = 0.0
    q = contacts.partner[c, of]
    if q >= 0:
        dx, dy = difference(p, q, colliders.position)
        squared = max(dx * dx + dy * dy, SHORT * SHORT * arm * arm)
        if squared > 0.0:
            contacts.couple[c, 2 * of] = -arm * dy / squared  # (36)
            contacts.couple[c, 2 * of + 1] = arm * dx / squared


@inner_kernel
def _distance(p: int, q: int, position: FloatRows) -> float:
    dx, dy = difference(p, q, position)
    return math.sqrt(dx * dx + dy * dy)


@inner_kernel
def _reach_of(contacts: Contacts, c: int, colliders: Colliders) -> float:
    # From the particle of a contact to the middle of what it touches.
    p = contacts.particle[c]
    a = contacts.end_a[c]
    b = contacts.end_b[c] if contacts.end_b[c] >= 0 else a
    share = contacts.share[c]
    dx = colliders.position[p, 0] - (1.0 - share) * colliders.position[a, 0] - share * colliders.position[b, 0]
    dy = colliders.position[p, 1] - (1.0 - share) * colliders.position[a, 1] - share * colliders.position[b, 1]
    return math.sqrt(dx * dx + dy * dy)


@inlined_kernel
def rolling_ratios(p: int, q: int, colliders: Colliders) -> tuple[float, float]:
    """The smaller radius of two discs, at which rolling resistance acts, over that of each; q -1: there is one disc."""
    if q < 0:
        return 1.0, 0.0
    own = colliders.radius[p]
    other = colliders.radius[q]
    smaller = min(own, other)
    return smaller / own if own > 0.0 else 0.0, smaller / other if other > 0.0 else 0.0


@inlined_kernel
def spin_of(surface: float, spin: float, radius: float) -> float:
    """The spin [rad/s] of a disc of that surface, which was `spin` before: the same bits where it has not changed."""
    return spin if surface == spin * radius else surface / radius


@inner_kernel
def has_belts(state: State) -> bool:
    """Whether any surface runs."""
    found = False
    for s in range(state.belt.shape[0]):
        found = found or state.belt[s] != 0.0
    for e in range(state.terrain.belt.shape[0]):
        found = found or state.terrain.belt[e] != 0.0
    return found


@inner_kernel
def load_belts(contacts: Contacts, count: int, outline: Outline, state: State) -> None:
    """Load how fast both surfaces of the first `count` contacts run, each to the right of who stands on it."""
    for c in range(count):
        kind, number = contacts.feature[c] % KINDS, contacts.feature[c] // KINDS
        p = contacts.particle[c]
        if kind == TIP:
            # An edge of a body on a corner of terrain.
            corner = state.owner.shape[0] + number // TIP_SHIFT
            contacts.belt[c] = state.belt[number % TIP_SHIFT] + _belt_at(corner, outline, state)
            continue
        belt = 0.0
        if kind == TERRAIN:
            belt = state.terrain.belt[number]
        elif kind in (EDGE, INSIDE):
            belt = state.belt[number]
        contacts.belt[c] = belt + _belt_at(p, outline, state)


@inner_kernel
def _belt_at(v: int, outline: Outline, state: State) -> float:
    # The mean speed of the edges that end at a vertex, 0: there are none.
    first, last = outline.edge_start[v], outline.edge_start[v + 1]
    total = 0.0
    for at in range(first, last):
        e = outline.edge_of[at]
        number = outline.number[e]
        total += state.belt[number] if e < outline.dynamic[0] else state.terrain.belt[number]
    return total / (last - first) if last > first else 0.0


@inner_kernel
def find_bounces(
    contacts: Contacts, count: int, start: FloatRows, velocity: FloatRows, attached: Flags, h: float, small: float
) -> None:
    """Find the bounce [m/s] of every contact, from the velocities before and after gravity and other loads.

    attached (n,): particles that a spring or a constraint holds; they fall in steps of h [s], others in those of
    `small`.
    """
    for c in range(count):
        contacts.bounce[c] = -1.0
        if contacts.restitution[c] == 0.0:
            continue
        nx, ny = contacts.normal[c, 0], contacts.normal[c, 1]
        u0 = 0.0
        u = 0.0
        for end in range(3):
            p, weight = weight_of(contacts, c, end)
            if p >= 0:
                u0 += weight * (start[p, 0] * nx + start[p, 1] * ny)
                u += weight * (velocity[p, 0] * nx + velocity[p, 1] * ny)
        gap = contacts.gap[c]
        if u < -SLOWEST_BOUNCE and gap + h * u < 0.0:
            p = contacts.particle[c]
            q = contacts.end_a[c]
            fallen = h if attached[p] and (q < 0 or attached[q]) else small
            contacts.bounce[c] = bounce_of(contacts.restitution[c], -u0, (u0 - u) / h, gap, fallen, h)


@inner_kernel
def bounce_of(restitution: float, speed: float, fall: float, gap: float, fallen: float, h: float) -> float:
    """Velocity [m/s] after a step of h [s] in which what approaches at `speed` and falls at `fall` [m/s^2] bounces."""
    # It bounces off at the height of the surface, not where the step begins, and then is at gap + h v: symplectic Euler
    # in steps of `fallen` keeps v^2/2 + g x - g fallen v/2 in free fall, and restitution^2 is left.
    energy = 0.5 * speed * speed + fall * gap + 0.5 * fall * fallen * speed
    late = h - 0.5 * fallen
    left = 2.0 * (restitution * restitution * energy - fall * gap) + fall * fall * late * late
    return max(0.0, math.sqrt(max(0.0, left)) - fall * late)
