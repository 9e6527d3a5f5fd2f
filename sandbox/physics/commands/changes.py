"""What commands do to the arrays of a world, and none asks whether: hands, pins, coefficients, pushes, moves, freeing.

A body that is stuck in others, or in itself, is freed into the nearest free place, where it does not come apart by
itself (untangling/depenetration.py).
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.collision.ghost_vertices import winds
from sandbox.physics.collision.outline import Outline, new_colliders, new_outline
from sandbox.physics.collision.types import Colliders
from sandbox.physics.components import list_body
from sandbox.physics.geometry.rigid import best_turn, fit_of, rotated
from sandbox.physics.geometry.segment import segments_cross, squared_distance
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import (
    BANK_EMPTIED,
    BANK_UNOPENED,
    FARTHEST_PLACE,
    GRAB_COUNT,
    LAW_HAND,
    LAW_NISSEN,
    LEAST_MASS,
    MOST_MASS,
)
from sandbox.physics.ramps import set_constraint, set_number, set_spring
from sandbox.physics.settings import DRAG, WIND_X
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
def is_body(state: State, first_cursor: int, p: int) -> bool:
    """Whether a particle is there and in use, and no cursor of a hand."""
    return 0 <= p < state.owner.shape[0] and state.particle_active[p] and not is_cursor(first_cursor, p)


@inner_kernel
def is_cursor(first_cursor: int, p: int) -> bool:
    return 0 <= first_cursor <= p < first_cursor + GRAB_COUNT


@inner_kernel
def _set_hand(state: State, first_cursor: int, first_spring: int, hand: int, particle: int, holds: bool) -> int:
    # Let a hand hold a particle, or nothing; its cursor.
    cursor, spring = first_cursor + hand, first_spring + hand
    state.particle_active[cursor] = state.spring_active[spring] = holds
    state.particle_b[spring] = particle
    state.law[spring] = LAW_HAND if holds else LAW_NISSEN
    for axis in range(2):
        state.velocity[cursor, axis] = state.slow_velocity[cursor, axis] = state.hand_force[hand, axis] = 0.0
    return cursor


@inner_kernel
def grab(state: State, slots: Slots, numbers: Floats) -> None:
    hand, particle = slots[2], slots[3]
    cursor = _set_hand(state, slots[0], slots[1], hand, particle, True)
    state.position[cursor, 0], state.position[cursor, 1] = numbers[0], numbers[1]
    state.hand_strength[hand], state.hand_radius[hand] = numbers[2], numbers[3]
    state.spin[particle] = 0.0
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def release(state: State, slots: Slots) -> None:
    """Release a hand: slots = first cursor, first spring, hand."""
    # No bank keeps energy that the hand's work put into it. Not begun again: what overlaps where a hand lets go is no
    # start, at which parting costs nothing.
    hand, bank = slots[2], state.energy_bank
    held = state.particle_b[slots[1] + hand]
    for p in range(bank.shape[0]):
        if bank[p] > 0.0 or (p == held and bank[p] == 0.0):
            bank[p] = BANK_EMPTIED
    cursor = _set_hand(state, slots[0], slots[1], hand, 0, False)
    state.position[cursor, 0] = state.position[cursor, 1] = 0.0
    state.hand_strength[hand] = state.hand_radius[hand] = 0.0


@inner_kernel
def pin(state: State, particle: int) -> None:
    """Hold a particle where it is."""
    state.inverse_mass[particle] = 0.0
    for axis in range(2):
        state.velocity[particle, axis] = state.slow_velocity[particle, axis] = 0.0
    state.spin[particle] = 0.0
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def unpin(state: State, particle: int) -> None:
    state.inverse_mass[particle] = 1.0 / state.mass[particle]
    for axis in range(2):
        state.slow_velocity[particle, axis] = state.velocity[particle, axis]
    state.energy_bank[particle] = BANK_UNOPENED


@inner_kernel
def _is_of(material: int, slots: Slots) -> bool:
    return material == slots[1] if slots[0] != 0 else material >= 0


@inner_kernel
def set_air(state: State, settings: Floats, slots: Slots, numbers: Floats) -> None:
    if slots[0] != 0:
        for axis in range(2):
            set_number(state, settings, WIND_X + axis, numbers[1 + axis], slots[2])
    if slots[1] != 0:
        set_number(state, settings, DRAG, numbers[0], slots[2])


@inner_kernel
def set_coefficients(state: State, good: GoodValues, slots: Slots, numbers: Floats) -> None:
    # Of springs and areas; grabs, Hooke springs and constraints with Cs and Cd of their own keep theirs.
    for s in range(state.material.shape[0]):
        if _is_of(state.material[s], slots):
            stiffness = numbers[0] if slots[2] != 0 else state.stiffness[s]
            damping = numbers[1] if slots[3] != 0 else state.damping[s]
            set_spring(state, good, s, stiffness, damping, 0.0, slots[4])
    for k in range(state.constraint_material.shape[0]):
        if _is_of(state.constraint_material[k], slots):
            stiffness = numbers[0] if slots[2] != 0 else state.constraint_stiffness[k]
            damping = numbers[1] if slots[3] != 0 else state.constraint_damping[k]
            set_constraint(state, good, k, stiffness, damping, 0.0, slots[4])


@inner_kernel
def _can_move(state: State, first_cursor: int, p: int) -> bool:
    return state.particle_active[p] and not is_cursor(first_cursor, p) and state.inverse_mass[p] > 0.0


@inner_kernel
def _weight_of_push(state: State, first_cursor: int, p: int, numbers: Floats) -> float:
    # 1 - (d / radius)^2 of what is near and can move; -1 of all else.
    dx, dy = state.position[p, 0] - numbers[0], state.position[p, 1] - numbers[1]
    square, reach = dx * dx + dy * dy, numbers[5] * numbers[5]
    if not _can_move(state, first_cursor, p) or not square < reach:
        return -1.0
    return 1.0 - square / reach


@inner_kernel
def push(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
    # dv_i = (J + outward n_i) w_i / sum m w: what is near moves more, whatever its mass, and the momentum grows by J.
    total, count = 0.0, 0
    for p in range(state.owner.shape[0]):
        weight = _weight_of_push(state, first_cursor, p, numbers)
        if weight >= 0.0:
            total += state.mass[p] * weight
            count += 1
    for p in range(state.owner.shape[0]):
        weight = _weight_of_push(state, first_cursor, p, numbers)
        if weight >= 0.0:
            dx, dy = state.position[p, 0] - numbers[0], state.position[p, 1] - numbers[1]
            distance = math.sqrt(dx * dx + dy * dy)
            share = numbers[4] / distance if distance > 0.0 else 0.0
            for axis in range(2):
                away = dx if axis == 0 else dy
                dv = (numbers[2 + axis] + share * away) * (weight / total)
                state.velocity[p, axis] += dv
                good.velocity[p, axis] = state.velocity[p, axis]
                state.slow_velocity[p, axis] += dv
            state.energy_bank[p] = BANK_UNOPENED
    return count


@inner_kernel
def shake(state: State, good: GoodValues, first_cursor: int, numbers: Floats) -> int:
    # Seen from the frame, every free particle gets the opposite velocity: dv_i = -a / tick_rate, for any gravity scale.
    count = 0
    for p in range(state.owner.shape[0]):
        if _can_move(state, first_cursor, p):
            for axis in range(2):
                dv = numbers[axis] / numbers[2]
                state.velocity[p, axis] -= dv
                good.velocity[p, axis] = state.velocity[p, axis]
                state.slow_velocity[p, axis] -= dv
            state.energy_bank[p] = BANK_UNOPENED
            count += 1
    return count


@inner_kernel
def move_listed(state: State, good: GoodValues, body: Slots, dx: float, dy: float, stands: bool) -> bool:
    """Move particles (k,) by a way [m]; stands: they are at rest there.

    False, and nothing is moved, where any would be beyond FARTHEST_PLACE.
    """
    for k in range(body.shape[0]):
        x, y = state.position[body[k], 0] + dx, state.position[body[k], 1] + dy
        if not (abs(x) <= FARTHEST_PLACE and abs(y) <= FARTHEST_PLACE):
            return False
    for k in range(body.shape[0]):
        p = body[k]
        for axis in range(2):
            state.position[p, axis] += dx if axis == 0 else dy
            good.position[p, axis] = state.position[p, axis]
            if stands:
                state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0
        state.energy_bank[p] = BANK_UNOPENED
    return True


@inner_kernel
def scale_mass(state: State, good: GoodValues, particle: int, factor: float) -> bool:
    """Make every particle of the body of a particle so many times as heavy, pinned ones too.

    False, and nothing is changed, where any would weigh less than LEAST_MASS or more than MOST_MASS.
    """
    owner = state.owner[particle]
    for p in range(state.owner.shape[0]):
        is_of_body = state.particle_active[p] and state.owner[p] == owner
        if is_of_body and not LEAST_MASS <= state.mass[p] * factor <= MOST_MASS:
            return False
    for p in range(state.owner.shape[0]):
        if state.particle_active[p] and state.owner[p] == owner:
            state.mass[p] = good.mass[p] = state.mass[p] * factor
            if state.inverse_mass[p] > 0.0:
                state.inverse_mass[p] = 1.0 / state.mass[p]
            state.energy_bank[p] = BANK_UNOPENED
    return True


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
    touches = False
    for p in range(state.collides.shape[0]):
        touches = touches or state.collides[p] != 0
    if not touches:
        return NOTHING_TOUCHES
    for i in range(count):
        if state.inverse_mass[body[i]] == 0.0:
            return IS_PINNED
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
    if not _find_place(stuck):
        return NO_PLACE
    for i in range(count):
        p = body[i]
        for axis in range(2):
            state.position[p, axis] = good.position[p, axis] = stuck.colliders.position[p, axis]
            state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0
        state.energy_bank[p] = BANK_UNOPENED
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
        doubled_area, position = 0.0, colliders.position
        for e in range(outline.solid[k, 0], outline.solid[k, 1]):
            if outline.side[e] != 0:
                a, b = outline.edge_a[e], outline.edge_b[e]
                doubled_area += position[a, 0] * position[b, 1] - position[a, 1] * position[b, 0]
        # A hollow chain runs the other way round, and its outside is inside of it.
        stuck.outside[k] = 0 if doubled_area >= 0.0 else -1
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
            c, d = outline.edge_a[edge[j]], outline.edge_b[edge[j]]
            if segments_cross(
                position[a, 0], position[a, 1], position[b, 0], position[b, 1],
                position[c, 0], position[c, 1], position[d, 0], position[d, 1],
            ):  # fmt: skip
                return False
        for j in range(disc.shape[0]):
            if _are_near(disc[j], a, b, own + radius[disc[j]], position):
                return False
    return True
