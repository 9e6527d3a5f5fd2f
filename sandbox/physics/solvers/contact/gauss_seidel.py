"""Projected Gauss-Seidel: contacts as springs that only push, in sweeps with accumulated, clamped impulses.

Along the normal a contact is the spring of Cs and Cd below whose impulse cannot pull; across it is one that stops the
surfaces, whose impulse is at most friction times the push (Coulomb). Both act on the effective mass at the contact, 1 /
(J W J^T): W is 1 / m for a free particle, and the Delassus block for a body that the direct solver has factored. Sweeps
start with the impulses of the last step, so a body at rest is at rest from the first sweep on.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.collision.surfaces import spin_of
from sandbox.physics.collision.types import ENDS, TOUCHING, Contacts, couple_of, weight_of
from sandbox.physics.equation import implicit_update
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_rows import Joints, push_at
from sandbox.physics.topology.sorting import list_by_key

# What one matrix may cost, for which there has to be room: the sum of the squares of the lengths of its rows.
MOST_PRODUCTS = 4e6
# Cs / Cd of a contact that penetrates: the part of the penetration that a step removes. Higher shakes what rests, lower
# leaves heaps soft.
PENETRATION_SHARE = 0.1
# What penetrates parts at this speed [m/s] at most: a body is not thrown out of another that it was put into.
FASTEST_PUSH = 3.0
# 1 - Cd of a contact. 0 would leave contacts that carry the same load without a definite share; a larger value lets
# heaps sink into each other.
CONTACT_SOFTNESS = 7e-4
# Contacts of what is slower [m/s] are calm: they are swept on until none of them changes its velocity by more [m/s].
# A tower of boxes creeps and falls where that is ten times as much; a tenth costs sweeps for nothing that is seen.
CALM = 0.5
CALM_SETTLED = 1e-4


class ActiveSet(NamedTuple):
    """Scratch of the exact solve of one island's contacts that carry and stick.

    Nodes are the blocks of the Delassus operator, then particles. A place is ENDS contact + end.
    """

    head: Annotated[Slots, "2 * touched"]  # by node: place of its first contact, -1: none
    following: Annotated[Slots, f"{ENDS} * contacts"]  # by place: the next one of the node
    rank: Annotated[Slots, "2 * touched"]  # by node: in a walk
    queue: Annotated[Slots, "2 * touched"]  # nodes by rank
    slow: Annotated[Flags, "contacts"]  # by contact: all that it touches is slow, and firm
    order: Annotated[Slots, "contacts"]  # slow contacts along the walk
    row: Annotated[Slots, "2 * contacts"]  # row of a contact's normal and tangent, -1: at its bound
    state: Annotated[SlotRows, "contacts, 2"]  # see active_solve.py
    u: Annotated[FloatRows, "contacts, 2"]  # [m/s]
    bound: Annotated[Floats, "contacts"]  # [N s]: friction that a contact goes to
    centre: Annotated[Floats, "contacts"]  # [N s]: friction from which sticking is soft
    best: Annotated[FloatRows, "contacts, 2"]  # [N s]: the impulses that miss least
    of_row: Annotated[Slots, "2 * contacts"]  # by row: 2 contact + axis
    start: Annotated[Slots, "2 * contacts + 1"]  # by row: where it begins in matrix
    first: Annotated[Slots, "2 * contacts"]  # by row: its first column
    pivot: Annotated[Floats, "2 * contacts"]
    rhs: Annotated[Floats, "2 * contacts"]
    matrix: Annotated[Floats, "capacity"]  # [1/kg]
    answer: Annotated[FloatRows, "touched, 2"]  # [m/s] by particle: velocities by a unit impulse, else 0
    turned: Annotated[Floats, "touched"]  # [m/s] by particle: the same of surfaces


class ContactOrder(NamedTuple):
    """Contacts of island i: first[i] to first[i + 1]; islands (1,): how many there are.

    By contact, scratch: island, order.
    """

    first: Annotated[Slots, "groups + 1"]
    islands: Annotated[Slots, "1"]
    island: Annotated[Slots, "contacts"]
    order: Annotated[Slots, "contacts"]


class Delassus(NamedTuple):
    """The Delassus operator W of bodies: block and place in it of each particle (n,); -1: free, it answers by its own
    mass.

    Points of block k: point[start[k]:start[k + 1]]; its numbers [1/kg], two rows of a square for each point, from
    base[k] on. columns: scratch of blocks, by lane. joints: those of the bodies and particles.
    """

    block: Annotated[Slots, "particles"]
    place: Annotated[Slots, "particles"]
    start: Annotated[Slots, "blocks + 1"]
    point: Annotated[Slots, "rows"]
    base: Annotated[Slots, "blocks + 1"]
    numbers: Floats
    columns: Floats
    joints: Joints


class ContactConstraints(NamedTuple):
    """Terms of sweeps by contact, with room for more contacts; surface is by particle."""

    bias: Annotated[Floats, "contacts"]  # [m/s]: added to its velocity
    normal: Annotated[Floats, "contacts"]  # J W J^T [1/kg]: along the normal,
    coupling: Annotated[Floats, "contacts"]  # between both,
    tangent: Annotated[Floats, "contacts"]  # and along the tangent
    last_impulse: Annotated[FloatRows, "contacts, 2"]  # [N s]: before a sweep
    search_direction: Annotated[FloatRows, "contacts, 2"]  # [N s]: where the sweeps so far have led
    resisted: Annotated[Floats, "contacts"]  # [N s]: of its rolling resistance, at the smaller radius
    surface: Annotated[Floats, "particles"]  # [m/s]: spin times radius, which sweeps change
    calm: Annotated[Floats, "contacts"]  # 1, or 0 where what it touches is fast or not rigid
    active: ActiveSet  # see active_solve.py


@inner_kernel
def order_by_label(source: Slots, contact_label: Slots, order: ContactOrder, number: Slots) -> None:
    """Put contacts into the order of the islands that they make alone.

    source: which contacts; contact_label: a particle that stands for the island of each. number (n,): scratch.
    """
    for p in range(number.shape[0]):
        number[p] = -1
    islands = 0
    for k in range(source.shape[0]):
        label = contact_label[source[k]]
        if number[label] < 0:
            number[label] = islands
            islands += 1
        order.island[k] = number[label]
    put_in_order(source, order, islands)


@inner_kernel
def put_in_order(source: Slots, order: ContactOrder, islands: int) -> None:
    """Put contacts into the order of their islands, so many; those of one island stay in theirs.

    source: which contacts; order.island has the island of each.
    """
    count = source.shape[0]
    list_by_key(order.island, count, islands, order.first, order.order)
    for k in range(count):
        order.island[k] = source[order.order[k]]
    for k in range(count):
        source[k] = order.island[k]
    order.islands[0] = islands


@inner_kernel
def terms_between(terms: ContactConstraints, first: int, last: int) -> ContactConstraints:
    """The constraints of the contacts first..last, in the same arrays."""
    return ContactConstraints(
        terms.bias[first:last], terms.normal[first:last], terms.coupling[first:last], terms.tangent[first:last],
        terms.last_impulse[first:last], terms.search_direction[first:last], terms.resisted[first:last], terms.surface,
        terms.calm[first:last], terms.active,
    )  # fmt: skip


@inner_kernel
def load_surfaces(terms: ContactConstraints, spin: Floats, radius: Floats) -> None:
    """Set the speeds of surfaces from the spins of their particles."""
    for p in range(terms.surface.shape[0]):
        terms.surface[p] = spin[p] * radius[p]


@inner_kernel
def store_spins(terms: ContactConstraints, spin: Floats, radius: Floats) -> None:
    """Set the spins of particles from the speeds that sweeps left their surfaces."""
    for p in range(terms.surface.shape[0]):
        spin[p] = spin_of(terms.surface[p], spin[p], radius[p])


@inner_kernel
def load_responses(contacts: Contacts, terms: ContactConstraints, inverse_mass: Floats, delassus: Delassus) -> None:
    """J W J^T of every contact: along its normal, between that and its tangent, and along the tangent."""
    for c in range(contacts.particle.shape[0]):
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        normal = 0.0
        coupling = 0.0
        tangent = 0.0
        for end in range(ENDS):
            p, weight = weight_of(contacts, c, end)
            if p < 0:
                continue
            cx, cy = couple_of(contacts, c, end)
            for other in range(ENDS):
                q, weight_q = weight_of(contacts, c, other)
                if q < 0:
                    continue
                dx, dy = couple_of(contacts, c, other)
                xx, xy, yx, yy = _response(p, q, inverse_mass, delassus)
                ax = weight_q * (xx * nx + xy * ny)
                ay = weight_q * (yx * nx + yy * ny)
                bx = xx * (dx - weight_q * ny) + xy * (dy + weight_q * nx)
                by = yx * (dx - weight_q * ny) + yy * (dy + weight_q * nx)
                normal += weight * (nx * ax + ny * ay)
                coupling += (cx - weight * ny) * ax + (cy + weight * nx) * ay
                tangent += (cx - weight * ny) * bx + (cy + weight * nx) * by
        for end in range(2):
            tangent += contacts.arm[c, end] * contacts.arm[c, end] * contacts.turning[c, end]
        terms.normal[c] = normal
        terms.coupling[c] = coupling
        terms.tangent[c] = tangent


@inner_kernel
def _response(p: int, q: int, inverse_mass: Floats, delassus: Delassus) -> tuple[float, float, float, float]:
    # The block xx, xy, yx, yy of W between two particles.
    if p < 0 or q < 0 or inverse_mass[p] == 0.0 or inverse_mass[q] == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    k = delassus.block[p]
    if k < 0:
        w = inverse_mass[p] if p == q else 0.0
        return w, 0.0, 0.0, w
    if delassus.block[q] != k:
        return 0.0, 0.0, 0.0, 0.0
    points = delassus.start[k + 1] - delassus.start[k]
    at = delassus.base[k] + delassus.place[p] * 4 * points + 2 * delassus.place[q]
    below = at + 2 * points
    return delassus.numbers[at], delassus.numbers[at + 1], delassus.numbers[below], delassus.numbers[below + 1]


@inner_kernel
def load_biases(contacts: Contacts, terms: ContactConstraints, h: float) -> None:
    """Set the bias of each contact, from its gap, its penetration or its bounce, and clear the direction of the
    sweeps.
    """
    for c in range(contacts.particle.shape[0]):
        terms.search_direction[c, 0] = 0.0
        terms.search_direction[c, 1] = 0.0
        gap = contacts.gap[c]
        terms.bias[c] = gap / h if gap >= 0.0 else max(PENETRATION_SHARE * gap / h, -FASTEST_PUSH)  # (26)
        if contacts.bounce[c] >= 0.0:
            terms.bias[c] = -contacts.bounce[c]


@inner_kernel
def mark_calm(
    contacts: Contacts, terms: ContactConstraints, velocity: FloatRows, block: Slots, rigid: Flags, firm: Flags
) -> None:  # fmt: skip
    """Which contacts are slow: all that they touch is, and firm; and which are calm: that is rigid, too."""
    for c in range(contacts.particle.shape[0]):
        terms.calm[c] = 1.0
        terms.active.slow[c] = True
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p >= 0 and block[p] >= 0:
                if not rigid[block[p]]:
                    terms.calm[c] = 0.0
                if not firm[block[p]]:
                    terms.active.slow[c] = False
            if p >= 0 and velocity[p, 0] * velocity[p, 0] + velocity[p, 1] * velocity[p, 1] > CALM * CALM:
                terms.calm[c] = 0.0
                terms.active.slow[c] = False


@inner_kernel
def warm_start_contacts(
    contacts: Contacts, terms: ContactConstraints, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus
) -> None:
    """Apply the impulses that contacts bring along; that of rolling resistance begins with none."""
    for c in range(contacts.particle.shape[0]):
        terms.resisted[c] = 0.0
        jn, jt = contacts.impulse[c, 0], contacts.impulse[c, 1]
        if jn != 0.0 or jt != 0.0:
            push_contact(contacts, c, jn, jt, terms.surface, delta_v, inverse_mass, delassus)


@inner_kernel
def sweep(
    contacts: Contacts,
    terms: ContactConstraints,
    velocity: FloatRows,
    delta_v: FloatRows,
    inverse_mass: Floats,
    delassus: Delassus,
) -> tuple[float, float]:
    """One sweep over all contacts; the largest change of a contact's velocity [m/s], and that of the calm ones."""
    # J = max(0, J - (u + b + J / K) / (W + 1 / K)), 1 / K = W (1 - Cd) / Cd;  |J_t| <= friction J, against the slip of
    # the surfaces;  rolling resistance <= rolling J
    largest = 0.0
    calm = 0.0
    for c in range(contacts.particle.shape[0]):
        normal = terms.normal[c]
        if not normal > 0.0:
            continue
        ux, uy = relative_velocity(contacts, c, velocity, delta_v)
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        soft = CONTACT_SOFTNESS * normal
        old = contacts.impulse[c, 0]
        new = max(0.0, implicit_update(old, nx * ux + ny * uy + terms.bias[c], normal, soft))  # (27)
        jn = new - old
        contacts.impulse[c, 0] = new
        jt = 0.0
        if terms.tangent[c] > 0.0:
            slip = nx * uy - ny * ux + terms.coupling[c] * jn + contacts.belt[c]  # (37)
            turn_p, turn_q = surface_speeds(contacts, c, contacts.arm, terms.surface)
            slip -= turn_p + turn_q
            if has_couple(contacts, c):
                slip += couple_velocity(contacts, c, velocity, delta_v)
            most = contacts.friction[c] * new
            last = contacts.impulse[c, 1]
            jt = min(most, max(-most, last - slip / terms.tangent[c])) - last  # (28)
            contacts.impulse[c, 1] = last + jt
        if jn != 0.0 or jt != 0.0:
            push_contact(contacts, c, jn, jt, terms.surface, delta_v, inverse_mass, delassus)
            changed = max(abs(jn) * normal, abs(jt) * terms.tangent[c])
            largest = max(largest, changed)
            calm = max(calm, terms.calm[c] * changed)
        if contacts.rolling[c] > 0.0 and (new > 0.0 or terms.resisted[c] != 0.0):
            _resist_rolling(contacts, c, terms)
    return largest, calm


@inner_kernel
def relative_velocity(contacts: Contacts, c: int, velocity: FloatRows, delta_v: FloatRows) -> tuple[float, float]:
    """Velocity of the particle relative to the other side of the contact, from velocity + delta_v."""
    p = contacts.particle[c]
    ux = velocity[p, 0] + delta_v[p, 0]
    uy = velocity[p, 1] + delta_v[p, 1]
    a = contacts.end_a[c]
    if a >= 0:
        b = contacts.end_b[c]
        ratio = contacts.share[c] if b >= 0 else 0.0
        ux -= (1.0 - ratio) * (velocity[a, 0] + delta_v[a, 0])
        uy -= (1.0 - ratio) * (velocity[a, 1] + delta_v[a, 1])
        if b >= 0:
            ux -= ratio * (velocity[b, 0] + delta_v[b, 0])
            uy -= ratio * (velocity[b, 1] + delta_v[b, 1])
    elif contacts.end_b[c] >= 0:
        b = contacts.end_b[c]
        ratio = contacts.share[c]
        ux = (1.0 - ratio) * ux + ratio * (velocity[b, 0] + delta_v[b, 0])
        uy = (1.0 - ratio) * uy + ratio * (velocity[b, 1] + delta_v[b, 1])
    return ux, uy


@inner_kernel
def surface_speeds(contacts: Contacts, c: int, by: FloatRows, surface: Floats) -> tuple[float, float]:
    """The speeds of both surfaces of a contact, times their arms or ratios; 0 where a particle does not roll."""
    p = 0.0
    q = 0.0
    if contacts.turning[c, 0] > 0.0:
        p = by[c, 0] * surface[contacts.particle[c]]
    if contacts.turning[c, 1] > 0.0:
        q = by[c, 1] * surface[contacts.end_a[c]]
    return p, q


@inner_kernel
def has_couple(contacts: Contacts, c: int) -> bool:
    """Whether a tangential impulse turns a body that does not roll."""
    return contacts.partner[c, 0] >= 0 or contacts.partner[c, 1] >= 0


@inner_kernel
def couple_velocity(contacts: Contacts, c: int, velocity: FloatRows, delta_v: FloatRows) -> float:
    """Relative speed of the surfaces of a contact that do not roll, from turning with their partners."""
    slip = 0.0
    for of in range(2):
        q = contacts.partner[c, of]
        if q >= 0:
            p = contacts.particle[c] if of == 0 else contacts.end_a[c]
            ux = velocity[p, 0] + delta_v[p, 0] - velocity[q, 0] - delta_v[q, 0]
            uy = velocity[p, 1] + delta_v[p, 1] - velocity[q, 1] - delta_v[q, 1]
            slip += contacts.couple[c, 2 * of] * ux + contacts.couple[c, 2 * of + 1] * uy
    return slip


@inner_kernel
def _resist_rolling(contacts: Contacts, c: int, terms: ContactConstraints) -> None:
    # A torque against the turn of two surfaces on each other: an impulse at the smaller radius, clamped by the push.
    answer = 0.0
    for end in range(2):
        answer += contacts.ratio[c, end] * contacts.ratio[c, end] * contacts.turning[c, end]
    if not answer > 0.0:
        return
    p, q = surface_speeds(contacts, c, contacts.ratio, terms.surface)
    most = contacts.rolling[c] * contacts.impulse[c, 0]
    new = min(most, max(-most, terms.resisted[c] - (p - q) / answer))
    j = new - terms.resisted[c]
    terms.resisted[c] = new
    turn_surfaces(contacts, c, j * contacts.ratio[c, 0], -j * contacts.ratio[c, 1], terms.surface)


@inner_kernel
def turn_surfaces(contacts: Contacts, c: int, jp: float, jq: float, surface: Floats) -> None:
    """Add an impulse to the surface speeds of rolling particles: s += 2 / m J."""
    if contacts.turning[c, 0] > 0.0:
        surface[contacts.particle[c]] += jp * contacts.turning[c, 0]  # (35)
    if contacts.turning[c, 1] > 0.0:
        surface[contacts.end_a[c]] += jq * contacts.turning[c, 1]


@inner_kernel
def push_contact(
    contacts: Contacts, c: int, jn: float, jt: float, surface: Floats, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus,
) -> None:  # fmt: skip
    """Push both sides of a contact by impulses [N s] along normal and tangent, which turns them."""
    # v += W J
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    jx = jn * nx - jt * ny
    jy = jn * ny + jt * nx
    for side in range(2):
        # The particle and its partner, then both ends of an edge: two of one body, mostly.
        other = TOUCHING if side == 0 else TOUCHING - 1
        p, weight = weight_of(contacts, c, side)
        q, weight_q = weight_of(contacts, c, other)
        if p < 0 and q < 0:
            continue
        px, py = couple_of(contacts, c, side)
        qx, qy = couple_of(contacts, c, other)
        _push_two(
            p, weight * jx + jt * px, weight * jy + jt * py, q, weight_q * jx + jt * qx, weight_q * jy + jt * qy,
            delta_v, inverse_mass, delassus,
        )  # fmt: skip
    if jt != 0.0:
        p, _ = weight_of(contacts, c, ENDS - 1)
        if p >= 0:
            px, py = couple_of(contacts, c, ENDS - 1)
            _push_particle(p, jt * px, jt * py, delta_v, inverse_mass, delassus)
        turn_surfaces(contacts, c, -jt * contacts.arm[c, 0], -jt * contacts.arm[c, 1], surface)


@inner_kernel
def _push_two(
    p: int, jx: float, jy: float, q: int, kx: float, ky: float, delta_v: FloatRows, inverse_mass: Floats,
    delassus: Delassus,
) -> None:  # fmt: skip
    # Push two particles, -1: none; those of one body in one pass over its points.
    if q < 0 or (kx == 0.0 and ky == 0.0):
        _push_particle(p, jx, jy, delta_v, inverse_mass, delassus)
        return
    block = delassus.block[q]
    if p < 0 or block < 0 or delassus.block[p] != block:
        if p >= 0:
            _push_particle(p, jx, jy, delta_v, inverse_mass, delassus)
        _push_particle(q, kx, ky, delta_v, inverse_mass, delassus)
        return
    push_at(delassus.joints, p, jx, jy)
    push_at(delassus.joints, q, kx, ky)
    first = delassus.start[block]
    points = delassus.start[block + 1] - first
    of_p = delassus.base[block] + delassus.place[p] * 4 * points
    of_q = delassus.base[block] + delassus.place[q] * 4 * points
    numbers = delassus.numbers
    for i in range(points):
        r = delassus.point[first + i]
        x = 2 * i
        for axis in range(2):
            delta_v[r, axis] += (
                numbers[of_p + x] * jx
                + numbers[of_p + 2 * points + x] * jy
                + numbers[of_q + x] * kx
                + numbers[of_q + 2 * points + x] * ky
            )
            x += 1


@inner_kernel
def _push_particle(p: int, jx: float, jy: float, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus) -> None:
    push_at(delassus.joints, p, jx, jy)
    answer_push(p, jx, jy, delta_v, inverse_mass, delassus)


@inner_kernel
def answer_push(p: int, jx: float, jy: float, delta_v: FloatRows, inverse_mass: Floats, delassus: Delassus) -> None:
    """Add the velocity that an impulse at a particle causes, joints aside: v += W J."""
    k = delassus.block[p]
    if k < 0:
        delta_v[p, 0] += jx * inverse_mass[p]
        delta_v[p, 1] += jy * inverse_mass[p]
        return
    first = delassus.start[k]
    points = delassus.start[k + 1] - first
    row = delassus.base[k] + delassus.place[p] * 4 * points
    lower = row + 2 * points
    for i in range(points):
        q = delassus.point[first + i]
        j = 2 * i
        delta_v[q, 0] += delassus.numbers[row + j] * jx + delassus.numbers[lower + j] * jy
        delta_v[q, 1] += delassus.numbers[row + j + 1] * jx + delassus.numbers[lower + j + 1] * jy


@inner_kernel
def approach_of(contacts: Contacts, c: int, velocity: FloatRows, delta_v: FloatRows) -> float:
    """Velocity along its normal [m/s] of a contact, from velocity + delta_v."""
    ux, uy = relative_velocity(contacts, c, velocity, delta_v)
    return contacts.normal[c, 0] * ux + contacts.normal[c, 1] * uy


@inner_kernel
def add_change(velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Add the velocity changes of a step to particles that can move."""
    for p in range(inverse_mass.shape[0]):
        if inverse_mass[p] > 0.0:
            velocity[p, 0] += delta_v[p, 0]
            velocity[p, 1] += delta_v[p, 1]


@inner_kernel
def new_active_set(count: int, particles: int, arena: Arena) -> ActiveSet:
    """Scratch for so many contacts of so many particles."""
    rows = 2 * count
    touched = particles if count > 0 else 0
    # (sum of lengths)^2 <= rows times the sum of their squares.
    capacity = rows + int(math.sqrt(MOST_PRODUCTS * rows)) + 1 if count > 0 else 0
    return new_tuple(ActiveSet, arena, contacts=count, touched=touched, capacity=capacity)
