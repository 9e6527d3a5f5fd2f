"""Against tunnelling, late in a step: after any solver, nothing crosses in the step what it cannot pass.

No particle's centre crosses terrain or an edge that pins hold; no edge of a body crosses a corner of terrain. A disc
does not go through a jelly: one that is pressed flat, so that no triangle gives way, stops it as a whole.
"""

import math

from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.collision.contacts import edge_of_spring, meet_tip
from sandbox.physics.collision.narrow_phase import are_joined, may_collide
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.geometry.rigid import WeightedSums, centre_of, with_point
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.marks import EDGE, INSIDE, KINDS, TERRAIN_GROUP, TIP
from sandbox.physics.terrain import Terrain, cells_between

# A particle that would cross a line of terrain is stopped this far in front of it, in units of its distance, and at
# least SKIN [m], so that rounding never carries it across. More would be seen, less could not be told from rounding.
STOP_SHARE = 0.01
SKIN = 1e-6
STOPS = 3
# How near the centre of a disc comes to an edge, as a share of the radii.
CLOSEST = 0.5


@inner_kernel
def clamp_at_terrain(
    position: FloatRows, velocity: FloatRows, ahead: FloatRows, collides: Slots, active: Flags, inverse_mass: Floats,
    terrain: Terrain, box: FloatRows, near_start: Slots, h: float,
) -> None:  # fmt: skip
    """Cut the velocities [m/s] of particles that would cross terrain in the coming h [s], on ways h v + ahead [m].

    box [m] (n, 4): where each was expected; near_start (n + 1,): how many edges of terrain are there, summed up.
    """
    if terrain.edge_a.shape[0] == 0:
        return
    for p in range(position.shape[0]):
        if not active[p] or inverse_mass[p] == 0.0 or (collides[p] & TERRAIN_GROUP) == 0:
            continue
        wx, wy = h * velocity[p, 0] + ahead[p, 0], h * velocity[p, 1] + ahead[p, 1]
        if near_start[p] == near_start[p + 1] and _stays_in(box, p, position[p, 0], position[p, 1], wx, wy):
            continue
        stops, x, y = stopped(position[p, 0], position[p, 1], wx, wy, terrain)
        _cut(p, stops, x - wx, y - wy, velocity, ahead, h)


@inner_kernel
def stop_at_terrain(p: int, position: FloatRows, velocity: FloatRows, terrain: Terrain, h: float) -> bool:
    """Cut the velocity [m/s] of row p, which moves by that alone, if it would cross terrain in the coming h [s].

    Returned: whether it would.
    """
    wx, wy = h * velocity[p, 0], h * velocity[p, 1]
    stops, x, y = stopped(position[p, 0], position[p, 1], wx, wy, terrain)
    _cut(p, stops, x - wx, y - wy, velocity, velocity, h)
    return stops > 0


@inlined_kernel
def _cut(p: int, stops: int, dx: float, dy: float, velocity: FloatRows, ahead: FloatRows, h: float) -> None:
    # Take from a particle's velocity what its way was cut by, -d; all that moves it, where it was cut too often.
    if stops > STOPS:
        for axis in range(2):
            velocity[p, axis] = ahead[p, axis] = 0.0
    elif stops > 0:
        velocity[p, 0] += dx / h
        velocity[p, 1] += dy / h


@inner_kernel
def stopped(x: float, y: float, wx: float, wy: float, terrain: Terrain) -> tuple[int, float, float]:
    """The way w [m] of a particle's centre, cut towards each edge of terrain that it would cross, and how often it was.

    More often than STOPS: it stays where it is.
    """
    for stop in range(STOPS + 1):
        e, signed, nx, ny = _crossing(x, y, wx, wy, terrain)
        if e < 0:
            return stop, wx, wy
        missing = max(STOP_SHARE * signed, SKIN) - (signed + wx * nx + wy * ny)
        wx += missing * nx
        wy += missing * ny
    return STOPS + 1, 0.0, 0.0


@inner_kernel
def _crossing(x: float, y: float, wx: float, wy: float, terrain: Terrain) -> tuple[int, float, float, float]:
    # The first edge that the way w of a particle's centre crosses (-1: none), distance from it, normal towards it.
    left, right, bottom, top = _cells_of_way(x, y, wx, wy, terrain)
    soonest = 2.0
    found = -1
    distance = 0.0
    nx, ny = 0.0, 0.0
    for row in range(bottom, top + 1):
        for column in range(left, right + 1):
            at = row * terrain.size[0] + column
            for entry in range(terrain.cell_start[at], terrain.cell_start[at + 1]):
                e = terrain.cell_edge[entry]
                a, b = terrain.edge_a[e], terrain.edge_b[e]
                when, signed, mx, my = _meet_line(
                    terrain.vertex[a, 0], terrain.vertex[a, 1], terrain.vertex[b, 0], terrain.vertex[b, 1],
                    terrain.solid[e] != 0, x, y, wx, wy,
                )  # fmt: skip
                if when < soonest:
                    soonest, found, distance, nx, ny = when, e, signed, mx, my
    return found, distance, nx, ny


@inlined_kernel
def _cells_of_way(x: float, y: float, wx: float, wy: float, terrain: Terrain) -> tuple[int, int, int, int]:
    # The cells that the way w lies in: left, right, bottom, top.
    per_cell = 1.0 / terrain.cell[0]
    left, right = cells_between(
        x + min(0.0, wx) - SKIN, x + max(0.0, wx) + SKIN, terrain.corner[0], per_cell, terrain.size[0]
    )
    bottom, top = cells_between(
        y + min(0.0, wy) - SKIN, y + max(0.0, wy) + SKIN, terrain.corner[1], per_cell, terrain.size[1]
    )
    return left, right, bottom, top


@inlined_kernel
def _meet_line(
    ax: float, ay: float, bx: float, by: float, is_solid: bool, x: float, y: float, wx: float, wy: float
) -> tuple[float, float, float, float]:
    # When the way w of a centre crosses a line from a to b (2: never), the distance from it and the normal towards it.
    dx, dy = bx - ax, by - ay
    px, py = x - ax, y - ay
    # Twice the area between line and centre, above 0 on the right of the line; it grows by `growth` on the way.
    area = px * dy - py * dx
    growth = wx * dy - wy * dx
    if area < 0.0 and not is_solid:
        area, growth, dx, dy = -area, -growth, -dx, -dy
        px, py = x - bx, y - by
    squared = dx * dx + dy * dy
    skin = SKIN * math.sqrt(squared)
    if not (growth < 0.0 and area > -skin and area + growth < 0.5 * skin):
        return 2.0, 0.0, 0.0, 0.0
    when = max(0.0, area / -growth)
    share = ((px + when * wx) * dx + (py + when * wy) * dy) / squared
    if not -1e-9 <= share <= 1.0 + 1e-9:
        return 2.0, 0.0, 0.0, 0.0
    length = math.sqrt(squared)
    return when, area / length, dy / length, -dx / length


@inner_kernel
def _stays_in(box: FloatRows, p: int, x: float, y: float, wx: float, wy: float) -> bool:
    # Whether the way w of a particle's centre stays in its box, and SKIN away from what is outside.
    return (
        x + min(0.0, wx) - SKIN >= box[p, 0]
        and y + min(0.0, wy) - SKIN >= box[p, 1]
        and x + max(0.0, wx) + SKIN <= box[p, 2]
        and y + max(0.0, wy) + SKIN <= box[p, 3]
    )


@inner_kernel
def clamp_at_pins(
    position: FloatRows, velocity: FloatRows, ahead: FloatRows, inverse_mass: Floats, outline: Outline,
    colliders: Colliders, box: FloatRows, near_start: Slots, h: float,
) -> None:  # fmt: skip
    """Stop particles at edges of other bodies that pins hold, as `clamp_at_terrain` does at terrain.

    near_start (n + 1,): how many discs and edges of bodies are in each box, summed up.
    """
    pins = outline.pins
    if pins.edge_a.shape[0] == 0:
        return
    for p in range(position.shape[0]):
        if colliders.collides[p] == 0 or inverse_mass[p] == 0.0:
            continue
        wx, wy = h * velocity[p, 0] + ahead[p, 0], h * velocity[p, 1] + ahead[p, 1]
        if near_start[p] == near_start[p + 1] and _stays_in(box, p, position[p, 0], position[p, 1], wx, wy):
            continue
        x, y = wx, wy
        stops = 0
        while stops <= STOPS:
            e, signed, nx, ny = _pin_crossing(p, position[p, 0], position[p, 1], x, y, outline, colliders)
            if e < 0:
                break
            missing = max(STOP_SHARE * signed, SKIN) - (signed + x * nx + y * ny)
            x += missing * nx
            y += missing * ny
            stops += 1
        _cut(p, stops, x - wx, y - wy, velocity, ahead, h)


@inner_kernel
def _pin_crossing(
    p: int, x: float, y: float, wx: float, wy: float, outline: Outline, colliders: Colliders
) -> tuple[int, float, float, float]:
    # As _crossing, of those edges that the particle may touch.
    terrain = outline.pins
    left, right, bottom, top = _cells_of_way(x, y, wx, wy, terrain)
    soonest = 2.0
    found = -1
    distance = 0.0
    nx, ny = 0.0, 0.0
    for row in range(bottom, top + 1):
        for column in range(left, right + 1):
            at = row * terrain.size[0] + column
            for entry in range(terrain.cell_start[at], terrain.cell_start[at + 1]):
                e = terrain.cell_edge[entry]
                a, b = colliders.edge_a[terrain.chain[e]], colliders.edge_b[terrain.chain[e]]
                if colliders.owner[a] == colliders.owner[p] or not may_collide(p, a, colliders):
                    continue
                if are_joined(p, a, colliders) or are_joined(p, b, colliders):
                    continue
                when, signed, mx, my = _meet_line(
                    colliders.position[a, 0], colliders.position[a, 1], colliders.position[b, 0],
                    colliders.position[b, 1], terrain.solid[e] != 0, x, y, wx, wy,
                )  # fmt: skip
                if when < soonest:
                    soonest, found, distance, nx, ny = when, e, signed, mx, my
    return found, distance, nx, ny


@inner_kernel
def clamp_at_tips(
    velocity: FloatRows, inverse_mass: Floats, terrain: Terrain, dynamic: int, colliders: Colliders, holds: bool,
    h: float,
) -> bool:  # fmt: skip
    """Cut the velocities of the ends of edges that would cross a corner of terrain in the coming h [s]; whether any.

    holds: such ends stay where they are.
    """
    found = False
    if terrain.tip.shape[0] == 0:
        return found
    first = velocity.shape[0]
    per_cell = 1.0 / terrain.cell[0]
    for e in range(dynamic):
        a, b = colliders.edge_a[e], colliders.edge_b[e]
        if colliders.collides[a] == 0 or colliders.collides[b] == 0 or inverse_mass[a] + inverse_mass[b] == 0.0:
            continue
        ax, ay = colliders.position[a, 0], colliders.position[a, 1]
        bx, by = colliders.position[b, 0], colliders.position[b, 1]
        ux, uy = ax + h * velocity[a, 0], ay + h * velocity[a, 1]
        vx, vy = bx + h * velocity[b, 0], by + h * velocity[b, 1]
        low_x, high_x = min(min(ax, bx), min(ux, vx)), max(max(ax, bx), max(ux, vx))
        low_y, high_y = min(min(ay, by), min(uy, vy)), max(max(ay, by), max(uy, vy))
        left, right = cells_between(low_x, high_x, terrain.corner[0], per_cell, terrain.size[0])
        bottom, top = cells_between(low_y, high_y, terrain.corner[1], per_cell, terrain.size[1])
        for row in range(bottom, top + 1):
            cell = row * terrain.size[0]
            for entry in range(terrain.tip_start[cell + left], terrain.tip_start[cell + right + 1]):
                i = terrain.cell_tip[entry]
                x, y = terrain.vertex[terrain.tip[i], 0], terrain.vertex[terrain.tip[i], 1]
                v = first + terrain.tip[i]
                if low_x <= x <= high_x and low_y <= y <= high_y and may_collide(a, v, colliders):
                    stopped_here = _stop_edge(e, i, v, velocity, inverse_mass, terrain, colliders, holds, h)
                    found = found or stopped_here
    return found


@inner_kernel
def _stop_edge(
    e: int, i: int, v: int, velocity: FloatRows, inverse_mass: Floats, terrain: Terrain, colliders: Colliders,
    holds: bool, h: float,
) -> bool:  # fmt: skip
    found = False
    a, b = colliders.edge_a[e], colliders.edge_b[e]
    for _ in range(STOPS):
        meets, share, nx, ny, distance = meet_tip(e, i, v, 0.0, 0.0, h, velocity, terrain, colliders)
        if not meets:
            break
        ux = (1.0 - share) * velocity[a, 0] + share * velocity[b, 0]
        uy = (1.0 - share) * velocity[a, 1] + share * velocity[b, 1]
        missing = STOP_SHARE * max(0.0, distance) - (distance + h * (ux * nx + uy * ny))
        answer = (1.0 - share) * (1.0 - share) * inverse_mass[a] + share * share * inverse_mass[b]
        if not (missing > 0.0 and answer > 0.0 and distance > 0.0):
            break
        found = True
        if holds:
            for axis in range(2):
                velocity[a, axis] = velocity[b, axis] = 0.0
            break
        j = missing / (h * answer)
        velocity[a, 0] += (1.0 - share) * j * inverse_mass[a] * nx
        velocity[a, 1] += (1.0 - share) * j * inverse_mass[a] * ny
        velocity[b, 0] += share * j * inverse_mass[b] * nx
        velocity[b, 1] += share * j * inverse_mass[b] * ny
    return found


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
        a, b = contacts.end_a[c], contacts.end_b[c]
        s = colliders.shape[a]
        if outline.solid_of[s] < 0:
            continue
        e = edge_of_spring(contacts.feature[c] // KINDS, colliders, outline)
        if e < 0 or colliders.side[e] == 0:
            continue
        share = contacts.share[c]
        nx, ny = contacts.normal[c, 0], contacts.normal[c, 1]
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
    nx, ny = contacts.normal[c, 0], contacts.normal[c, 1]
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
