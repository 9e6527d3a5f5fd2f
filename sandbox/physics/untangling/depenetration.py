"""Depenetration: bodies whose outlines overlap come apart and keep their form.

Both are moved as wholes, away from what they share, while contacts between them are left out (overlaps.py): nothing
holds them, so their springs restore them, until nothing crosses. A line that crosses a solid body, a rope or a cloth,
is moved where it crosses alone. Nothing is kept from step to step but contacts, of which what parts has none, and what
it is paid with: energy that the two have lost before.
"""

import math
from typing import NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats
from sandbox.physics.collision.ghost_vertices import edge_normal, place_on, winds
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders
from sandbox.physics.geometry.rigid import RigidMotion, WeightedSums, centre_of, with_point
from sandbox.physics.geometry.segment import difference, segment_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.untangling.overlaps import OVERLAPS, Overlaps, mark_separating

# Bodies that overlap part at this speed [m/s]. Faster frees no more of them, slower takes longer.
DEPENETRATION_SPEED = 1.0
# Where what is inside of both outlines looks to all sides alike, less than this share of its length, the one goes right
# through the other, and they part along the line of their centres of mass.
ONE_SIDED = 0.3
# Places of an edge that are looked at for whether they are inside.
SAMPLES = 4
# Lengths [m] below this have no direction.
LEAST_LENGTH = 1e-12


class MovedParticles(NamedTuple):
    """The arrays of particles that parting reads and changes, see StateArrays; start [m/s] (n, 2): before forces
    acted.
    """

    velocity: FloatRows
    start: FloatRows
    mass: Floats
    inverse_mass: Floats
    energy_bank: Floats
    parting_reserve: Floats


@inner_kernel
def depenetrate(
    outline: Outline, colliders: Colliders, bounds: FloatRows, particles: MovedParticles, found: Overlaps, flags: Flags
) -> None:
    """Push apart the pairs that part, in their order. flags (n,): scratch."""
    for pair in range(found.counts[OVERLAPS]):
        # What has come through itself its own springs restore; lines cross lines as they like.
        s = found.shape[pair, 0]
        t = found.shape[pair, 1]
        if not found.separates[pair] or s == t or (outline.solid_of[s] < 0 and outline.solid_of[t] < 0):
            continue
        for side in range(2):
            k = found.shape[pair, side]
            for i in range(outline.member_start[k], outline.member_start[k + 1]):
                flags[outline.member[i]] = False
        mark_separating(pair, colliders, outline, bounds, found, flags)
        _depenetrate_pair(pair, outline, colliders, particles, found, flags)


@inner_kernel
def _depenetrate_pair(
    pair: int, outline: Outline, colliders: Colliders, particles: MovedParticles, found: Overlaps, flags: Flags
) -> None:
    # Bring what parts to DEPENETRATION_SPEED, or as near to it as what was saved allows.
    s = found.shape[pair, 0]
    t = found.shape[pair, 1]
    a, mass_a, fixed_a = _moved(s, outline, colliders, particles, flags)
    b, mass_b, fixed_b = _moved(t, outline, colliders, particles, flags)
    if outline.solid_of[s] < 0:
        nx, ny = _off(pair, 1, outline, colliders, found)
    elif outline.solid_of[t] < 0:
        nx, ny = _off(pair, 0, outline, colliders, found)
        nx = -nx
        ny = -ny
    else:
        nx, ny = _apart(s, t, a, b, outline, colliders)
    # What is held does not move, unless both are.
    of_a = 1.0 / mass_a if mass_a > 0.0 and fixed_a <= fixed_b else 0.0
    of_b = 1.0 / mass_b if mass_b > 0.0 and fixed_b <= fixed_a else 0.0
    if not of_a + of_b > 0.0:
        return
    along = 0.0
    if of_a > 0.0:
        along += a.u * nx + a.v * ny
    if of_b > 0.0:
        along -= b.u * nx + b.v * ny
    # J u + J^2 / (2 m_r) = m_r / 2 (speed^2 - u^2)
    reduced = 1.0 / (of_a + of_b)
    saved_a, fresh_a = _saved(s, outline, particles)
    saved_b, fresh_b = _saved(t, outline, particles)
    speed = DEPENETRATION_SPEED
    if not (fresh_a or fresh_b):
        speed = min(speed, math.sqrt(along * along + 2.0 * (saved_a + saved_b) / reduced))
    if not speed > along:
        return
    impulse = (speed - along) * reduced  # (31)
    _push(s, nx, ny, impulse * of_a, outline, particles, flags)
    _push(t, -nx, -ny, impulse * of_b, outline, particles, flags)
    _spend(t, _spend(s, 0.5 * reduced * (speed * speed - along * along), outline, particles), outline, particles)


@inner_kernel
def _moved(
    s: int, outline: Outline, colliders: Colliders, particles: MovedParticles, flags: Flags
) -> tuple[RigidMotion, float, int]:
    # How what of shape s is flagged moves as a whole, its mass, and 1 where a particle of it is pinned.
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    fixed = 0
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        p = outline.member[i]
        if not flags[p]:
            continue
        if particles.inverse_mass[p] == 0.0:
            fixed = 1
            continue
        sums = with_point(
            sums, particles.mass[p], colliders.position[p, 0], colliders.position[p, 1], particles.start[p, 0],
            particles.start[p, 1],
        )  # fmt: skip
    if sums.weight > 0.0:
        return centre_of(sums), sums.weight, fixed
    p = outline.member[outline.member_start[s]]
    return RigidMotion(colliders.position[p, 0], colliders.position[p, 1], 0.0, 0.0, 0.0, 0.0), 0.0, 1


@inner_kernel
def _off(pair: int, side: int, outline: Outline, colliders: Colliders, found: Overlaps) -> tuple[float, float]:
    # The direction in which a line is to leave the solid body at `side` of a pair: away from the longest part of its
    # outline between two crossings, across the straight line between these.
    k = outline.solid_of[found.shape[pair, side]]
    most = outline.solid[k, 1] - outline.solid[k, 0]
    first = found.first[pair]
    last = first
    longest = -1.0
    c = first
    while c >= 0:
        following, way = _next_crossing(c, pair, side, most, colliders, found)
        if way > longest:
            longest = way
            first = c
            last = following
        c = found.following[c]
    # The outline runs with what is solid on its left, so that the way back is the outside's.
    dx = _place(first, side, 0, colliders, found) - _place(last, side, 0, colliders, found)
    dy = _place(first, side, 1, colliders, found) - _place(last, side, 1, colliders, found)
    length = math.sqrt(dx * dx + dy * dy)
    if length > LEAST_LENGTH:
        return dy / length, -dx / length
    return edge_normal(found.edge[first, side], colliders)


@inner_kernel
def _next_crossing(c: int, pair: int, side: int, most: int, colliders: Colliders, found: Overlaps) -> tuple[int, float]:
    # The next crossing of a pair after c along the solid outline, which is at `side` of each, and the way to it [m].
    f = found.edge[c, side]
    passed = found.ratio[c, side]
    way = 0.0
    for _ in range(most + 1):
        dx, dy = difference(colliders.edge_a[f], colliders.edge_b[f], colliders.position)
        length = math.sqrt(dx * dx + dy * dy)
        nearest = -1
        ratio = 2.0
        other = found.first[pair]
        while other >= 0:
            at = found.ratio[other, side]
            if found.edge[other, side] == f and (at > passed or passed < 0.0) and at < ratio:
                nearest = other
                ratio = at
            other = found.following[other]
        if nearest >= 0:
            return nearest, way + (ratio - max(0.0, passed)) * length
        way += (1.0 - max(0.0, passed)) * length
        passed = -1.0
        f = _next_edge(f, colliders)
        if f < 0:
            break
    return c, way


@inner_kernel
def _next_edge(f: int, colliders: Colliders) -> int:
    # The edge of a solid outline that goes on where f ends; -1: none.
    v = colliders.edge_b[f]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        g = colliders.edge_of[at]
        if colliders.edge_a[g] == v and colliders.side[g] != 0:
            return g
    return -1


@inner_kernel
def _place(c: int, side: int, axis: int, colliders: Colliders, found: Overlaps) -> float:
    return place_on(found.edge[c, side], found.ratio[c, side], axis, colliders)


@inner_kernel
def _apart(
    s: int, t: int, a: RigidMotion, b: RigidMotion, outline: Outline, colliders: Colliders
) -> tuple[float, float]:
    # The direction in which solid body s is to leave solid body t.
    ax, ay, length_a = _inside_normal(outline.solid_of[s], outline.solid_of[t], outline, colliders)
    bx, by, length_b = _inside_normal(outline.solid_of[t], outline.solid_of[s], outline, colliders)
    nx = bx - ax
    ny = by - ay
    length = math.sqrt(nx * nx + ny * ny)
    if length < ONE_SIDED * (length_a + length_b) + LEAST_LENGTH:
        nx = a.x - b.x
        ny = a.y - b.y
        length = math.sqrt(nx * nx + ny * ny)
    if length > LEAST_LENGTH:
        return nx / length, ny / length
    return 1.0, 0.0


@inner_kernel
def _inside_normal(k: int, other: int, outline: Outline, colliders: Colliders) -> tuple[float, float, float]:
    # Sum of the outward normals, by length, of what of solid k's outline lies inside another, and that length: the
    # shared area shrinks fastest where k moves against it.
    nx = 0.0
    ny = 0.0
    total = 0.0
    first = outline.solid[other, 0]
    last = outline.solid[other, 1]
    for e in range(outline.solid[k, 0], outline.solid[k, 1]):
        if colliders.side[e] == 0:
            continue
        ax, ay, dx, dy = segment_of(colliders.edge_a[e], colliders.edge_b[e], colliders.position)
        length = math.sqrt(dx * dx + dy * dy)
        for sample in range(SAMPLES):
            ratio = (sample + 0.5) / SAMPLES
            if winds(ax + ratio * dx, ay + ratio * dy, first, last, colliders) > 0:
                nx += dy / SAMPLES
                ny -= dx / SAMPLES
                total += length / SAMPLES
    return nx, ny, total


@inner_kernel
def _saved(s: int, outline: Outline, particles: MovedParticles) -> tuple[float, bool]:
    # What a shape has lost before and may spend [J]; whether its energy budget is begun in this step, for all of it.
    total = 0.0
    fresh = True
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        p = outline.member[i]
        if particles.inverse_mass[p] > 0.0:
            total += max(0.0, particles.parting_reserve[p])
            fresh = fresh and particles.energy_bank[p] == BANK_UNOPENED
    return total, fresh


@inner_kernel
def _push(s: int, nx: float, ny: float, dv: float, outline: Outline, particles: MovedParticles, flags: Flags) -> None:
    # Add to the velocities of what of a shape is flagged.
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        p = outline.member[i]
        if flags[p] and particles.inverse_mass[p] > 0.0:
            particles.velocity[p, 0] += dv * nx
            particles.velocity[p, 1] += dv * ny
            particles.start[p, 0] += dv * nx
            particles.start[p, 1] += dv * ny


@inner_kernel
def _spend(s: int, cost: float, outline: Outline, particles: MovedParticles) -> float:
    # Take a cost [J] from what a shape has saved; what is left of it.
    for i in range(outline.member_start[s], outline.member_start[s + 1]):
        p = outline.member[i]
        if cost > 0.0 and particles.inverse_mass[p] > 0.0:
            paid = min(cost, max(0.0, particles.parting_reserve[p]))
            particles.parting_reserve[p] -= paid
            cost -= paid
    return cost
