"""Inversion: finds jellies so far out of shape that springs and areas alone may not bring them back.

A jelly (jellies.py) is inverted while a triangle of it is turned over, or drawn out to LARGEST times its area, or while
the triangles about one of its inner particles do not wind round that just once. It is wound where those about a
particle of its outline go on round that beyond where they began: then its outline crosses itself there though no
triangle is turned over, and what is next to it, which may not touch it, does not hold it apart. Where a jelly lies
folded over in its own form, some of its triangles counter-clockwise and others not, no turns are counted: there is no
number of them that is right.
"""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_slot_rows, new_slots
from sandbox.physics.arrays import Flags, FloatRows, SlotRows, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.geometry.segment import doubled_area, doubled_area_of, winding_of_side
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.state import State
from sandbox.physics.untangling.jellies import Jellies, group_triangles

# A jelly of which a triangle is drawn out to so many times its area wants to be back in a step, and cannot be without
# turning others over on its way: held from that, it would stand still. The softest jelly comes to a hundredth of it
# when it is stirred at 80 m/s.
LARGEST = 1e4


@inlined_kernel
def _crossing(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> int:
    # +1 where the corner at p, from a to b, sweeps over the direction (1, 0) counter-clockwise, -1 clockwise.
    return winding_of_side(ay < py, by < py, doubled_area(px, py, ax, ay, bx, by))


@inlined_kernel
def wind(place: FloatRows, a: int, b: int, c: int, member: SlotRows, at: int, turns: Slots) -> float:
    """Count the turns of triangle a b c, whose corners are member[at], round each of them; its area, doubled."""
    ax = place[a, 0]
    ay = place[a, 1]
    bx = place[b, 0]
    by = place[b, 1]
    cx = place[c, 0]
    cy = place[c, 1]
    turns[member[at, 0]] += _crossing(ax, ay, bx, by, cx, cy)
    turns[member[at, 1]] += _crossing(bx, by, cx, cy, ax, ay)
    turns[member[at, 2]] += _crossing(cx, cy, ax, ay, bx, by)
    return doubled_area(ax, ay, bx, by, cx, cy)


@inner_kernel
def is_wound(g: int, once: int, place: FloatRows, fan: SlotRows, fan_start: Slots) -> bool:
    """Whether jelly g is wound. once: 1 where its triangles run counter-clockwise, else -1; fan: see Jellies."""
    for f in range(fan_start[g], fan_start[g + 1]):
        p = fan[f, 0]
        begin = fan[f, 1]
        if (
            once * doubled_area_of(p, fan[f, 2], begin, place) >= 0.0
            and once * doubled_area_of(p, begin, fan[f, 3], place) > 0.0
        ):
            return True
    return False


class Triangles(NamedTuple):
    """The triangles of a world that keep their areas, t of them: constraint (t,), corners (t, 3), and their jellies."""

    constraint: Slots
    corners: SlotRows
    jellies: Jellies


class Inversions(NamedTuple):
    """By corner of a jelly: turns of triangles round it; by jelly: whether it is inverted. Filled in by each step."""

    turns: Slots
    is_inverted: Flags


@inlined_kernel
def is_out_of_shape(area: float, wanted: float, form: float) -> bool:
    """Whether a triangle of this area [m^2], which wants and at rest has those, is turned over or drawn out."""
    return wanted * form > 0.0 and not 0.0 < area * wanted < LARGEST * wanted * wanted


@inner_kernel
def find_inverted(
    position: FloatRows, constraint_rest: FloatRows, triangles: Triangles, found: Inversions, inverted: Flags
) -> None:
    """Find the inverted jellies; mark the particles, of all those in jellies, that belong to them or to wound ones."""
    corners = triangles.corners
    jellies = triangles.jellies
    turns = found.turns
    for i in range(turns.shape[0]):
        turns[i] = 0
    for g in range(found.is_inverted.shape[0]):
        found.is_inverted[g] = False
    for t in range(corners.shape[0]):
        doubled = wind(position, corners[t, 0], corners[t, 1], corners[t, 2], jellies.member, t, turns)
        k = triangles.constraint[t]
        if is_out_of_shape(0.5 * doubled, constraint_rest[k, 0], constraint_rest[k, 1]):
            found.is_inverted[jellies.group[t]] = True
    for i in range(turns.shape[0]):
        inverted[jellies.particle[i]] = False
    for g in range(found.is_inverted.shape[0]):
        once = 1 if constraint_rest[triangles.constraint[jellies.first[g]], 1] > 0.0 else -1
        for i in range(jellies.start[g], jellies.start[g + 1]):
            if jellies.inner[i] and turns[i] != once:
                found.is_inverted[g] = True
        if found.is_inverted[g] or is_wound(g, once, position, jellies.fan, jellies.fan_start):
            for i in range(jellies.start[g], jellies.start[g + 1]):
                inverted[jellies.particle[i]] = True


@inner_kernel
def choose_triangles(state: State, constraint: Slots, corners: SlotRows, is_left: Flags) -> int:
    """Choose the constraints that are triangles; how many there are."""
    count = 0
    for k in range(state.constraint_kind.shape[0]):
        if state.constraint_kind[k] == AREA and state.constraint_corners[k] == 3 and state.constraint_active[k]:
            constraint[count] = k
            for c in range(3):
                corners[count, c] = state.corner_particle[state.constraint_first[k] + c]
            is_left[count] = state.constraint_rest[k, 1] > 0.0
            count += 1
    return count


@inner_kernel
def triangles_of(state: State, arena: Arena) -> Triangles:
    """The triangles of a world, as its constraints are now."""
    room = state.constraint_kind.shape[0]
    constraint, corners, is_left = new_slots(arena, room), new_slot_rows(arena, room, 3), new_flags(arena, room)
    count = 0
    if not is_full(arena):
        count = choose_triangles(state, constraint, corners, is_left)
    jellies = group_triangles(corners[:count], is_left[:count], state.owner.shape[0], arena)
    return Triangles(constraint[:count], corners[:count], jellies)


@inner_kernel
def new_inversions(jellies: Jellies, arena: Arena) -> Inversions:
    """Lay out inversions for a step to fill in."""
    return Inversions(new_slots(arena, jellies.particle.shape[0]), new_flags(arena, jellies.first.shape[0]))
