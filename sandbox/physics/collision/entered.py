"""Discs that have come into solid bodies: they go out where they came in, however deep they are by now."""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.collision.edge_geometry import is_behind, is_in
from sandbox.physics.collision.narrow_phase import EDGE, INSIDE, KINDS, may_collide, push_out
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Colliders, Contacts, KeptContacts
from sandbox.physics.geometry.segment import closest_on_segment
from sandbox.physics.jit import inner_kernel

# Edges along which it is followed, at most, where a disc is that has come into a body.
MOST_WALK = 64


@inner_kernel
def edge_of_spring(spring: int, colliders: Colliders, outline: Outline) -> int:
    """The edge that a spring is; -1: none."""
    if not 0 <= spring < outline.spring_end.shape[0]:
        return -1
    v = outline.spring_end[spring]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        e = colliders.edge_of[at]
        if e < outline.dynamic[0] and colliders.number[e] == spring:
            return e
    return -1


@inner_kernel
def _beside(e: int, end: int, colliders: Colliders) -> int:
    # The solid edge that goes on at an end of another one; that itself, if there is none.
    v = colliders.edge_a[e] if end == 0 else colliders.edge_b[e]
    for at in range(colliders.edge_start[v], colliders.edge_start[v + 1]):
        f = colliders.edge_of[at]
        if f != e and colliders.side[f] != 0:
            return f
    return e


@inner_kernel
def _nearest_from(p: int, e: int, colliders: Colliders) -> int:
    # From an edge on along the outline as long as that comes nearer to a particle.
    _, lowest, _, _ = closest_on_segment(p, colliders.edge_a[e], colliders.edge_b[e], colliders.position)
    for _ in range(MOST_WALK):
        found = e
        for end in range(2):
            f = _beside(e, end, colliders)
            _, distance, _, _ = closest_on_segment(p, colliders.edge_a[f], colliders.edge_b[f], colliders.position)
            if distance < lowest:
                found = f
                lowest = distance
        if found == e:
            break
        e = found
    return e


@inner_kernel
def find_entered(
    p: int, colliders: Colliders, outline: Outline, bounds: FloatRows, kept: KeptContacts, first: int, last: int,
    contacts: Contacts, count: int,
) -> tuple[int, int]:  # fmt: skip
    """Contact of a disc that has come into a solid body, to be pushed out where it came in.

    kept[first:last]: its contacts of the last step. Returned: the number of contacts then, and a vertex of the body
    (-1: none).
    """
    chosen = -1
    lowest = math.inf
    for at in range(first, last):
        kind = kept.feature[at] % KINDS
        if kind != EDGE and kind != INSIDE:
            continue
        e = edge_of_spring(kept.feature[at] // KINDS, colliders, outline)
        if e < 0 or colliders.side[e] == 0 or not may_collide(p, colliders.edge_a[e], colliders):
            continue
        g = _nearest_from(p, e, colliders)
        _, distance, signed, region = closest_on_segment(
            p, colliders.edge_a[g], colliders.edge_b[g], colliders.position
        )
        if not (distance < lowest and is_behind(p, g, signed, region, colliders)):
            continue
        # In one step it may have come out on the other side.
        if (kind == EDGE and region == 0) or is_in(
            p, colliders.owner[colliders.edge_a[g]], outline.solid, bounds, colliders
        ):
            chosen = g
            lowest = distance
    if chosen < 0:
        return count, -1
    share, distance, _, region = closest_on_segment(
        p, colliders.edge_a[chosen], colliders.edge_b[chosen], colliders.position
    )  # fmt: skip
    added = count
    count = push_out(p, chosen, share, distance, region, colliders, outline.dynamic[0], contacts, count)
    if added < contacts.particle.shape[0]:
        contacts.feature[added] = KINDS * colliders.number[chosen] + INSIDE
    return count, colliders.edge_a[chosen]
