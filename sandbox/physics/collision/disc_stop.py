"""Discs do not go through jellies: one that is pressed flat, so that no triangle gives way, stops them as a whole."""

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.collision.entered import edge_of_spring
from sandbox.physics.collision.narrow_phase import EDGE, INSIDE, KINDS, TIP
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, with_point
from sandbox.physics.jit import inner_kernel

# How near the centre of a disc comes to an edge, as a share of the radii.
CLOSEST = 0.5


@inner_kernel
def _motion_of(
    s: int, outline: Outline, mass: Floats, inverse_mass: Floats, velocity: FloatRows
) -> tuple[float, float, float]:
    # 1 / mass of a body and the velocity of its centre; 0: a pin holds it.
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        q = outline.member[i]
        if inverse_mass[q] == 0.0:
            return 0.0, 0.0, 0.0
        sums = with_point(sums, mass[q], 0.0, 0.0, velocity[q, 0], velocity[q, 1])
    centre = centre_of(sums)
    return 1.0 / sums.weight, centre.u, centre.v


@inner_kernel
def _move(s: int, outline: Outline, velocity: FloatRows, vx: float, vy: float) -> None:
    # Add to the velocities of all of a body.
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        velocity[outline.member[i], 0] += vx
        velocity[outline.member[i], 1] += vy


@inner_kernel
def _stop_at_tip(
    contacts: Contacts, c: int, outline: Outline, colliders: Colliders, velocity: FloatRows, mass: Floats,
    inverse_mass: Floats, h: float,
) -> None:  # fmt: skip
    # The same of a body on a corner of terrain.
    a = contacts.particle[c]
    b = contacts.end_b[c]
    s = colliders.shape[a]
    if s < 0 or outline.solid_of[s] < 0:
        return
    share = contacts.share[c]
    nx = contacts.normal[c, 0]
    ny = contacts.normal[c, 1]
    vx = (1.0 - share) * velocity[a, 0] + share * velocity[b, 0]
    vy = (1.0 - share) * velocity[a, 1] + share * velocity[b, 1]
    deepest = max((1.0 - CLOSEST) * colliders.radius[a], -contacts.gap[c])
    excess = -(contacts.gap[c] + h * (vx * nx + vy * ny)) - deepest
    if not excess > 0.0:
        return
    lightness, ux, uy = _motion_of(s, outline, mass, inverse_mass, velocity)
    more = min(excess / h, -(ux * nx + uy * ny))
    if lightness > 0.0 and more > 0.0:
        _move(s, outline, velocity, more * nx, more * ny)


@inner_kernel
def stop_discs(
    contacts: Contacts, order: Slots, outline: Outline, colliders: Colliders, velocity: FloatRows, mass: Floats,
    inverse_mass: Floats, h: float,
) -> None:  # fmt: skip
    """Stop discs whose centres would come behind an edge of a solid body that they touch in the coming h [s].

    order: which contacts, one after another. Both get what takes their centres of mass, at most, to a common velocity
    along the normal, so energy is only lost.
    """
    for k in range(order.shape[0]):
        c = order[k]
        kind = contacts.feature[c] % KINDS
        p = contacts.particle[c]
        if kind == TIP:
            _stop_at_tip(contacts, c, outline, colliders, velocity, mass, inverse_mass, h)
            continue
        if (kind != EDGE and kind != INSIDE) or colliders.shape[p] >= 0 or inverse_mass[p] == 0.0:
            continue
        a = contacts.end_a[c]
        b = contacts.end_b[c]
        s = colliders.shape[a]
        if outline.solid_of[s] < 0:
            continue
        e = edge_of_spring(contacts.feature[c] // KINDS, colliders, outline)
        if e < 0 or colliders.side[e] == 0:
            continue
        share = contacts.share[c]
        nx = contacts.normal[c, 0]
        ny = contacts.normal[c, 1]
        vx = velocity[p, 0] - (1.0 - share) * velocity[a, 0] - share * velocity[b, 0]
        vy = velocity[p, 1] - (1.0 - share) * velocity[a, 1] - share * velocity[b, 1]
        # What was deeper before is pushed out by its contact, and comes no deeper.
        deepest = max((1.0 - CLOSEST) * (colliders.radius[p] + colliders.radius[a]), -contacts.gap[c])
        excess = -(contacts.gap[c] + h * (vx * nx + vy * ny)) - deepest
        if not excess > 0.0:
            continue
        lightness, ux, uy = _motion_of(s, outline, mass, inverse_mass, velocity)
        closing = -((velocity[p, 0] - ux) * nx + (velocity[p, 1] - uy) * ny)
        j = min(excess / h, closing) / (inverse_mass[p] + lightness)
        if not j > 0.0:
            continue
        velocity[p, 0] += j * inverse_mass[p] * nx
        velocity[p, 1] += j * inverse_mass[p] * ny
        if lightness > 0.0:
            _move(s, outline, velocity, -(j * lightness * nx), -(j * lightness * ny))
