"""Tips: corners of terrain that stand out, on edges of bodies.

A contact whose feature is TIP is one of an edge with such a corner: `particle` and `end_b` are the ends of the edge,
with shares 1 - s and s, and end_a is -1. At its ends an edge meets terrain as a particle does.
"""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.collision.narrow_phase import KINDS, TIP, TIP_SHIFT, add_contact, may_collide
from sandbox.physics.collision.types import Colliders, Contacts
from sandbox.physics.geometry.segment import SHORTEST, segment_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.terrain import Terrain, cells_between

# Sine of the angle by which an edge may lean beyond a side of a corner of terrain and still lie on that.
LEAN = 1e-6
# A corner of terrain deeper inside a solid body than this share of an edge is none of that edge's.
DEEPEST_TIP = 0.5
# A contact of an edge with a tip exists from this gap on, as a share of the radius: what a solver does to the edge is
# not foreseen.
NEAR_TIP = 0.5


@inner_kernel
def meet_tip(
    e: int, i: int, v: int, near: float, reach: float, h: float, velocity: FloatRows, terrain: Terrain,
    colliders: Colliders,
) -> tuple[bool, float, float, float, float]:  # fmt: skip
    """Whether an edge of a body is within `near` [m] of tip i of terrain, vertex v, or comes as near as `reach` in h.

    Then the place along the edge that meets it, the normal from the tip towards the edge and the distance along that
    now. Where the nearest place of the edge is an end of it, that is hit as a particle.
    """
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    ax, ay, dx, dy = segment_of(a, b, colliders.position)
    px = colliders.position[v, 0] - ax
    py = colliders.position[v, 1] - ay
    squared = dx * dx + dy * dy
    if not squared > SHORTEST:
        return False, 0.0, 0.0, 0.0, 0.0
    length = math.sqrt(squared)
    way = 1.0
    signed = (px * dy - py * dx) / length
    if colliders.side[e] == 0 and signed < 0.0:
        way, signed = -1.0, -signed
    share = (px * dx + py * dy) / squared
    distance = signed
    when = 0.0
    if signed > near:
        # a, b and so the area of a, b and the tip go along: signed area - reach * length = 0
        ax, ay = h * velocity[a, 0], h * velocity[a, 1]
        tx, ty = h * velocity[b, 0] - ax, h * velocity[b, 1] - ay
        when = _first_root(
            (signed - reach) * length, way * (px * ty - ax * dy - py * tx + ay * dx), way * (ay * tx - ax * ty)
        )  # fmt: skip
        if when > 1.0:
            return False, 0.0, 0.0, 0.0, 0.0
        px -= when * ax
        py -= when * ay
        dx += when * tx
        dy += when * ty
        squared = dx * dx + dy * dy
        if not squared > SHORTEST:
            return False, 0.0, 0.0, 0.0, 0.0
        length = math.sqrt(squared)
        share = (px * dx + py * dy) / squared
    elif signed < -DEEPEST_TIP * length:
        return False, 0.0, 0.0, 0.0, 0.0
    if not 0.0 < share < 1.0:
        return False, 0.0, 0.0, 0.0, 0.0
    nx = -way * dy / length
    ny = way * dx / length
    # What crosses a tip does so whichever way it lies.
    if reach > 0.0 and not _is_in_cone(i, nx, ny, terrain):
        return False, 0.0, 0.0, 0.0, 0.0
    if when > 0.0:
        x = (1.0 - share) * colliders.position[a, 0] + share * colliders.position[b, 0] - colliders.position[v, 0]
        y = (1.0 - share) * colliders.position[a, 1] + share * colliders.position[b, 1] - colliders.position[v, 1]
        distance = nx * x + ny * y
    return True, share, nx, ny, distance


@inlined_kernel
def _is_in_cone(i: int, nx: float, ny: float, terrain: Terrain) -> bool:
    # Whether an edge of this normal can lie on tip i: none of the ways from that leads through it.
    for at in range(terrain.way_start[i], terrain.way_start[i + 1]):
        if nx * terrain.way[at, 0] + ny * terrain.way[at, 1] > LEAN:
            return False
    return True


@inner_kernel
def collide_tip(
    e: int, i: int, first: int, h: float, terrain: Terrain, colliders: Colliders, contacts: Contacts, count: int
) -> int:
    """Contact of an edge of a body with tip i of terrain; the number of contacts then.

    first: the vertex at which those of terrain begin.
    """
    a = colliders.edge_a[e]
    b = colliders.edge_b[e]
    v = first + terrain.tip[i]
    if not may_collide(a, v, colliders):
        return count
    reach = colliders.radius[a]
    meets, share, nx, ny, distance = meet_tip(
        e, i, v, (1.0 + NEAR_TIP) * reach, reach, h, colliders.velocity, terrain, colliders
    )  # fmt: skip
    if not meets:
        return count
    feature = KINDS * (terrain.tip[i] * TIP_SHIFT + colliders.number[e]) + TIP
    return add_contact(count, contacts, a, feature, -1, b, share, nx, ny, distance - reach, v, colliders)


@inlined_kernel
def _first_root(c: float, b: float, a: float) -> float:
    # The first t > 0 at which c + b t + a t^2, which is above 0 at 0, is 0; 2: never.
    inside = b * b - 4.0 * a * c
    if inside < 0.0:
        return 2.0
    # b < 0 or a < 0, else it only grows.
    root = math.sqrt(inside)
    if b < 0.0:
        when = 2.0 * c / (root - b)
        return when if when > 0.0 else 2.0
    if a < 0.0:
        return (-b - root) / (2.0 * a)
    return 2.0


@inner_kernel
def _next_tip(last: int, k: int, box: FloatRows, terrain: Terrain) -> int:
    # The tip of the lowest number above `last` in a box, -1: there is none. Cells are as the whole of the terrain has
    # them.
    per_cell = 1.0 / terrain.cell[0]
    found = -1
    left, right = cells_between(box[k, 0], box[k, 2], terrain.corner[0], per_cell, terrain.size[0])
    bottom, top = cells_between(box[k, 1], box[k, 3], terrain.corner[1], per_cell, terrain.size[1])
    for row in range(bottom, top + 1):
        cell = row * terrain.size[0]
        # Tips of a row of cells lie together.
        for entry in range(terrain.tip_start[cell + left], terrain.tip_start[cell + right + 1]):
            i = terrain.cell_tip[entry]
            if i <= last or (found >= 0 and i >= found):
                continue
            x = terrain.vertex[terrain.tip[i], 0]
            y = terrain.vertex[terrain.tip[i], 1]
            if box[k, 0] <= x <= box[k, 2] and box[k, 1] <= y <= box[k, 3]:
                found = i
    return found


@inner_kernel
def find_tips(
    p: int, h: float, box: FloatRows, terrain: Terrain, colliders: Colliders, contacts: Contacts, dynamic: int,
    particles: int, count: int,
) -> int:  # fmt: skip
    """Contacts of the edges that begin at particle p with tips of terrain; the number of contacts then."""
    for at in range(colliders.edge_start[p], colliders.edge_start[p + 1]):
        e = colliders.edge_of[at]
        k = particles + e
        if e >= dynamic or colliders.edge_a[e] != p or not box[k, 0] <= box[k, 2]:
            continue
        if colliders.inverse_mass[p] + colliders.inverse_mass[colliders.edge_b[e]] == 0.0:
            continue
        i = _next_tip(-1, k, box, terrain)
        while i >= 0:
            count = collide_tip(e, i, particles, h, terrain, colliders, contacts, count)
            i = _next_tip(i, k, box, terrain)
    return count
