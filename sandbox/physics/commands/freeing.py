"""Freeing: puts a body that is stuck in others, or in itself, into the nearest free place.

For bodies that do not come apart by themselves (untangling/depenetration.py). Not part of a tick: a person asks for it.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Slots
from sandbox.physics.collision.ghost_vertices import winds
from sandbox.physics.collision.outline import Outline, new_colliders, new_outline
from sandbox.physics.collision.types import Colliders
from sandbox.physics.components import list_body
from sandbox.physics.geometry.rigid import best_turn, fit_of, rotated
from sandbox.physics.geometry.segment import segments_cross, squared_distance
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.state import GoodValues, State

# Why a body stays where it is: nothing touches anything here; a particle of it is pinned; there is no free place near
# by. 0: it was freed.
FREED, NOTHING_TOUCHES, IS_PINNED, NO_PLACE = range(4)
# Places are tried on rings, each so many radii of a particle farther away, in so many directions; of smaller particles
# those of this radius [m].
RING, DIRECTIONS, RINGS, LEAST_RADIUS = 2.0, 24, 400, 1e-3
# How far what is free is from all else, in units of what touches: a little more than nothing, so that rounding does not
# decide.
CLEAR = 1.01


class Stuck(NamedTuple):
    """A body among colliders, in which it stands where a place is tried, and what it may touch there."""

    colliders: Colliders
    outline: Outline
    body: Slots  # (k,): its particles, ascending
    form: Annotated[FloatRows, "rows, 2"]  # [m] (k, 2): their places, before they go anywhere
    is_own: Annotated[Flags, "vertices"]
    outside: Annotated[Slots, "solids"]  # how often each row of outline.solid runs round what is outside of it
    edge: Annotated[Slots, "edges"]  # of others, near by
    disc: Annotated[Slots, "vertices"]  # particles of others, near by
    turn: Annotated[FloatRows, f"{DIRECTIONS}, 2"]  # cosine and sine of each direction


@inner_kernel
def free_body(state: State, good: GoodValues, arena: Arena, particle: int) -> int:
    """Move the body of a particle to the nearest place where it touches nothing, at rest: FREED, or why it stays.

    One solid body gets the form that it was made in; several bodies that hang together keep their present shape.
    particle: one that is in use. NO_ARENA: see arena.py; nothing was changed.
    """
    begin(arena)
    label, body = new_slots(arena, state.owner.shape[0]), new_slots(arena, state.owner.shape[0])
    if is_full(arena):
        return NO_ARENA
    count = list_body(state, particle, label, body)
    reason = _why_not(state, body[:count])
    if reason != FREED:
        return reason
    outline = new_outline(state, arena)
    if is_full(arena):
        return NO_ARENA
    stuck = new_tuple(
        Stuck, arena, rows=count, vertices=outline.owner.shape[0], solids=outline.solid.shape[0],
        edges=outline.edge_a.shape[0], colliders=new_colliders(state.terrain, outline, 0, arena), outline=outline,
        body=body[:count],
    )  # fmt: skip
    if is_full(arena):
        return NO_ARENA
    _set_up(state, stuck)
    return _move(state, good, stuck) if _find_place(stuck) else NO_PLACE


@inner_kernel
def _why_not(state: State, body: Slots) -> int:
    touches = False
    for p in range(state.collides.shape[0]):
        touches = touches or state.collides[p] != 0
    if not touches:
        return NOTHING_TOUCHES
    for i in range(body.shape[0]):
        if state.inverse_mass[body[i]] == 0.0:
            return IS_PINNED
    return FREED


@inner_kernel
def _set_up(state: State, stuck: Stuck) -> None:
    # Fill in what holds at each place that is tried.
    colliders, outline, body, form = stuck.colliders, stuck.outline, stuck.body, stuck.form
    for p in range(state.radius.shape[0]):
        for axis in range(2):
            colliders.position[p, axis] = state.position[p, axis]
        colliders.radius[p] = state.radius[p]
        colliders.collides[p] = state.collides[p] if state.particle_active[p] else 0
    for k in range(outline.solid.shape[0]):
        # A hollow chain runs the other way round, and its outside is inside of it.
        stuck.outside[k] = 0 if _runs_counter_clockwise(k, stuck) else -1
    for i in range(body.shape[0]):
        stuck.is_own[body[i]] = True
        for axis in range(2):
            form[i, axis] = state.position[body[i], axis] + 0.0
    if _is_one_solid(state, stuck):
        x, y, form_x, form_y, along, across = fit_of(state.origin, state.position, body)
        cosine, sine = best_turn(along, across)
        for i in range(body.shape[0]):
            dx, dy = rotated(cosine, sine, state.origin[body[i], 0] - form_x, state.origin[body[i], 1] - form_y)
            form[i, 0], form[i, 1] = x + dx, y + dy
    _fill_turns(stuck.turn)


@inner_kernel
def _runs_counter_clockwise(k: int, stuck: Stuck) -> bool:
    outline, position, doubled_area = stuck.outline, stuck.colliders.position, 0.0
    for e in range(outline.solid[k, 0], outline.solid[k, 1]):
        if outline.side[e] != 0:
            a, b = outline.edge_a[e], outline.edge_b[e]
            doubled_area += position[a, 0] * position[b, 1] - position[a, 1] * position[b, 0]
    return doubled_area >= 0.0


@inner_kernel
def _is_one_solid(state: State, stuck: Stuck) -> bool:
    outline, body = stuck.outline, stuck.body
    for i in range(body.shape[0]):
        if state.owner[body[i]] != state.owner[body[0]]:
            return False
    shape = outline.shape[body[0]]
    return shape >= 0 and outline.solid_of[shape] >= 0


@inner_kernel
def _fill_turns(turn: FloatRows) -> None:
    # Cosines of a quarter as they are written here, so that no library's sine decides where a body goes.
    half, quarter = DIRECTIONS // 2, DIRECTIONS // 4
    turn[0, 0], turn[1, 0], turn[2, 0] = 1.0, 0.965925826, 0.866025404
    turn[3, 0], turn[4, 0], turn[5, 0] = 0.707106781, 0.5, 0.258819045
    for k in range(quarter):
        turn[(DIRECTIONS - k) % DIRECTIONS, 0] = turn[k, 0]
        turn[half - k, 0] = turn[half + k, 0] = -turn[k, 0]
    for k in range(DIRECTIONS):
        turn[k, 1] = turn[(k + DIRECTIONS - quarter) % DIRECTIONS, 0]


@inner_kernel
def _find_place(stuck: Stuck) -> bool:
    # Try ways, the shortest first, until the body is clear of all else.
    body, form, turn, position = stuck.body, stuck.form, stuck.turn, stuck.colliders.position
    ring = RING * max(_largest_radius(stuck), LEAST_RADIUS)
    for k in range(DIRECTIONS - 1, DIRECTIONS * (RINGS + 1)):
        far = ring * (k // DIRECTIONS)
        x, y = turn[k % DIRECTIONS, 0] * far, turn[k % DIRECTIONS, 1] * far
        for i in range(body.shape[0]):
            position[body[i], 0], position[body[i], 1] = form[i, 0] + x, form[i, 1] + y
        if _is_clear(stuck):
            return True
    return False


@inner_kernel
def _largest_radius(stuck: Stuck) -> float:
    largest = 0.0
    for i in range(stuck.body.shape[0]):
        largest = max(largest, stuck.colliders.radius[stuck.body[i]])
    return largest


@inner_kernel
def _is_clear(stuck: Stuck) -> bool:
    # Whether a body touches nothing where it stands, and nothing is inside of it or round it.
    colliders, outline = stuck.colliders, stuck.outline
    x, y = colliders.position[stuck.body[0], 0], colliders.position[stuck.body[0], 1]
    # Of places beyond walls there are most, and they are found at once.
    for k in range(outline.solid.shape[0]):
        first, last = outline.solid[k, 0], outline.solid[k, 1]
        if not stuck.is_own[outline.edge_a[first]] and winds(x, y, first, last, colliders) != stuck.outside[k]:
            return False
    edges, discs = _list_near(stuck)
    edge, disc = stuck.edge[:edges], stuck.disc[:discs]
    if not (_particles_are_clear(stuck, edge, disc) and _edges_are_clear(stuck, edge, disc)):
        return False
    for k in range(outline.dynamic[1]):
        first, last = outline.solid[k, 0], outline.solid[k, 1]
        for j in range(discs if stuck.is_own[outline.edge_a[first]] else 0):
            if winds(colliders.position[disc[j], 0], colliders.position[disc[j], 1], first, last, colliders) != 0:
                return False
    return True


@inner_kernel
def _list_near(stuck: Stuck) -> tuple[int, int]:
    # List the edges and the particles of others that are near the body; how many there are.
    colliders, outline, is_own, position = stuck.colliders, stuck.outline, stuck.is_own, stuck.colliders.position
    left = right = position[stuck.body[0], 0]
    bottom = top = position[stuck.body[0], 1]
    for i in range(stuck.body.shape[0]):
        x, y = position[stuck.body[i], 0], position[stuck.body[i], 1]
        left, right, bottom, top = min(left, x), max(right, x), min(bottom, y), max(top, y)
    margin, edges, discs = 2.0 * _largest_radius(stuck), 0, 0
    left, right, bottom, top = left - margin, right + margin, bottom - margin, top + margin
    for e in range(outline.edge_a.shape[0]):
        a, b = outline.edge_a[e], outline.edge_b[e]
        reach = colliders.radius[a]
        if (
            not (is_own[a] and is_own[b])
            and max(position[a, 0], position[b, 0]) >= left - reach
            and min(position[a, 0], position[b, 0]) <= right + reach
            and max(position[a, 1], position[b, 1]) >= bottom - reach
            and min(position[a, 1], position[b, 1]) <= top + reach
        ):
            stuck.edge[edges] = e
            edges += 1
    for p in range(colliders.shielded.shape[0]):
        x, y, reach = position[p, 0], position[p, 1], colliders.radius[p]
        is_other = colliders.collides[p] != 0 and not is_own[p]
        if is_other and left - reach <= x <= right + reach and bottom - reach <= y <= top + reach:
            stuck.disc[discs] = p
            discs += 1
    return edges, discs


@inner_kernel
def _are_near(p: int, a: int, b: int, reach: float, position: FloatRows) -> bool:
    # Whether a particle is nearer to the segment from a to b than what is free is from what reaches so far [m].
    squared = squared_distance(
        position[p, 0], position[p, 1], position[a, 0], position[a, 1], position[b, 0], position[b, 1]
    )
    return math.sqrt(squared) < CLEAR * reach


@inner_kernel
def _cross(a: int, b: int, c: int, d: int, position: FloatRows) -> bool:
    return segments_cross(
        position[a, 0], position[a, 1], position[b, 0], position[b, 1],
        position[c, 0], position[c, 1], position[d, 0], position[d, 1],
    )  # fmt: skip


@inner_kernel
def _particles_are_clear(stuck: Stuck, edge: Slots, disc: Slots) -> bool:
    # Whether no particle of the body touches an edge or a particle of these.
    outline, radius, position = stuck.outline, stuck.colliders.radius, stuck.colliders.position
    for i in range(stuck.body.shape[0]):
        p = stuck.body[i]
        for j in range(edge.shape[0]):
            a, b = outline.edge_a[edge[j]], outline.edge_b[edge[j]]
            if _are_near(p, a, b, radius[p] + radius[a], position):
                return False
        for j in range(disc.shape[0]):
            d = disc[j]
            if _are_near(p, d, d, radius[p] + radius[d], position):
                return False
    return True


@inner_kernel
def _edges_are_clear(stuck: Stuck, edge: Slots, disc: Slots) -> bool:
    # Whether no edge of the body crosses one of these edges, or touches one of these particles.
    outline, radius, position = stuck.outline, stuck.colliders.radius, stuck.colliders.position
    own = _largest_radius(stuck)
    for e in range(outline.dynamic[0]):
        a, b = outline.edge_a[e], outline.edge_b[e]
        if not (stuck.is_own[a] and stuck.is_own[b]):
            continue
        for j in range(edge.shape[0]):
            if _cross(a, b, outline.edge_a[edge[j]], outline.edge_b[edge[j]], position):
                return False
        for j in range(disc.shape[0]):
            if _are_near(disc[j], a, b, own + radius[disc[j]], position):
                return False
    return True


@inner_kernel
def _move(state: State, good: GoodValues, stuck: Stuck) -> int:
    for i in range(stuck.body.shape[0]):
        p = stuck.body[i]
        for axis in range(2):
            state.position[p, axis] = good.position[p, axis] = stuck.colliders.position[p, axis]
            state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0
        state.energy_bank[p] = BANK_UNOPENED
    return FREED
