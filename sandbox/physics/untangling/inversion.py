"""Inversion: finds jellies so far out of shape that springs and areas alone may not bring them back.

A jelly is a group of triangles that share sides. It is inverted while a triangle of it is turned over, or drawn out to
LARGEST times its area, or while the triangles about one of its inner particles do not wind round that just once. It is
wound where those about a particle of its outline go on round that beyond where they began: then its outline crosses
itself there though no triangle is turned over, and what is next to it, which may not touch it, does not hold it apart.
Where a jelly lies folded over in its own form, some of its triangles counter-clockwise and others not, no turns are
counted: there is no number of them that is right.
"""

import functools
from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import Flags
from sandbox.physics.components import label_bodies
from sandbox.physics.constraints import AREA
from sandbox.physics.geometry.polygon import winding_of_side
from sandbox.physics.geometry.segment import doubled_area, doubled_area_of
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.state import Floats, Slots
from sandbox.physics.world import World

# A jelly of which a triangle is drawn out to so many times its area wants to be back in a step, and cannot be without
# turning others over on its way: held from that, it would stand still. The softest jelly comes to a hundredth of it
# when it is stirred at 80 m/s.
LARGEST = 1e4
# A run needs two of them, of particles and of the rows of the direct solver; a person takes some steps back and forth.
KEPT_GROUPINGS = 6


class Jellies(NamedTuple):
    """Jellies of t triangles: g of them, with k particles in all.

    Of triangles: group (t,) and member (t, 3) = their corners among the k. first (g,): a triangle of each jelly; start
    (g+1,): where its particles begin; particle (k,); corner (k,): one of the 3 t corners that stands there; inner (k,):
    whether triangles are all round it. fan (f, 4): a particle of an outline, the next one on that, and the other two
    corners of each triangle about it but the first; those of jelly g: fan[fan_start[g]:fan_start[g + 1]]. gap (q, 4):
    the triangle at which those about a particle of an outline begin, that particle, the one before and the next one on
    that outline.
    """

    group: Slots
    member: Slots
    first: Slots
    start: Slots
    particle: Slots
    corner: Slots
    inner: Flags
    fan: Slots
    fan_start: Slots
    gap: Slots


def group_triangles(corners: Slots, areas: Floats) -> Jellies:
    """The jellies that triangles of these particles (t, 3) make, in the order of their first triangles; to be read.

    areas (t,) [m^2]: of their forms. Those of the same triangles are the same, since pins, hands and cuts leave
    triangles as they are.
    """
    return _grouped(corners.tobytes(), (areas > 0.0).tobytes())


@functools.lru_cache(maxsize=KEPT_GROUPINGS)
def _grouped(content: bytes, signs: bytes) -> Jellies:
    corners, is_left = np.frombuffer(content, dtype=np.int64).reshape(-1, 3), np.frombuffer(signs, dtype=np.bool_)
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    keys = sides.min(axis=1) << 32 | sides.max(axis=1)
    order = np.argsort(keys, kind="stable")
    shared = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    label = np.arange(len(corners))
    label_bodies(order[shared] // 3, order[shared + 1] // 3, label)
    first, group = np.unique(label, return_inverse=True)
    particles, corner, member = np.unique(group[:, None] << 32 | corners, return_index=True, return_inverse=True)
    member = member.reshape(-1, 3)
    # Once round: as many triangles as neighbours.
    pairs = np.stack([member, np.roll(member, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends = np.unique(np.append(pairs[:, 0] << 32 | pairs[:, 1], pairs[:, 1] << 32 | pairs[:, 0])) >> 32
    neighbours, triangles = (np.bincount(each, minlength=len(particles)) for each in (ends, member.reshape(-1)))
    start = np.searchsorted(particles >> 32, np.arange(len(first) + 1))
    # The same triangle twice is round nothing.
    lies_flat = np.bincount(group, is_left, len(first)) % np.bincount(group) == 0
    inner = lies_flat[particles >> 32] & (neighbours == triangles) & (triangles > 2)
    fan, fan_start, gap = _fans(corners, keys, group, lies_flat)
    return Jellies(group, member, first, start, particles & 0xFFFFFFFF, corner, inner, fan, fan_start, gap)


def _fans(corners: Slots, keys: Slots, group: Slots, lies_flat: Flags) -> tuple[Slots, Slots, Slots]:
    """The fans of triangles about particles of outlines and their gaps, see Jellies, of jellies g that lie flat (g,).

    keys (3 t,): of sides, the same where shared.
    """
    _, side, count = np.unique(keys, return_inverse=True, return_counts=True)
    about = np.stack([np.roll(corners, -k, axis=1) for k in range(3)], axis=-1).reshape(-1, 3)
    owner = np.repeat(group, 3) << 32 | about[:, 0]
    begins = np.flatnonzero((count[side] == 1) & np.repeat(lies_flat[group], 3))
    # Where two fans meet in a particle, neither is told from the other.
    begun, at, fans = np.unique(owner[begins], return_index=True, return_counts=True)
    begins = begins[at[fans == 1]]
    begun, following = owner[begins], about[begins, 1]
    # What begins with one side ends with one, but where triangles lie over each other.
    ends = np.flatnonzero((count[side].reshape(-1, 3)[:, [2, 0, 1]] == 1).reshape(-1))
    ended, at, sides = np.unique(owner[ends], return_index=True, return_counts=True)
    whole, of_begun, of_ended = np.intersect1d(begun, ended[sides == 1], assume_unique=True, return_indices=True)
    last = about[ends[at[sides == 1][of_ended]], 2]
    gap = np.stack([begins[of_begun] // 3, whole & 0xFFFFFFFF, last, following[of_begun]], axis=1)
    chosen = np.flatnonzero(np.isin(owner, begun))
    chosen = chosen[np.argsort(group[chosen // 3], kind="stable")]
    following = following[np.searchsorted(begun, owner[chosen])]
    beyond = following != about[chosen, 1]
    chosen, following = chosen[beyond], following[beyond]
    fan = np.stack([about[chosen, 0], following, about[chosen, 1], about[chosen, 2]], axis=1)
    return fan, np.searchsorted(group[chosen // 3], np.arange(len(lies_flat) + 1)), gap


@inlined_kernel
def _crossing(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> int:
    # +1 where the corner at p, from a to b, sweeps over the direction (1, 0) counter-clockwise, -1 clockwise.
    return winding_of_side(ay < py, by < py, doubled_area(px, py, ax, ay, bx, by))


@inlined_kernel
def wind(place: Floats, a: int, b: int, c: int, member: Slots, at: int, turns: Slots) -> float:
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
def is_wound(g: int, once: int, place: Floats, fan: Slots, fan_start: Slots) -> bool:
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
    corners: Slots
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
    position: Floats, constraint_rest: Floats, triangles: Triangles, found: Inversions, inverted: Flags
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


def triangles_of(world: World) -> Triangles:
    """The triangles of a world, as its constraints are now."""
    kept = (world.constraint_kind == AREA) & (world.constraint_corners == 3) & world.constraint_active
    constraint = np.flatnonzero(kept)
    corners = world.corner_particle[world.constraint_first[constraint, None] + np.arange(3)].astype(np.int64)
    return Triangles(constraint, corners, group_triangles(corners, world.constraint_rest[constraint, 1]))


def new_inversions(triangles: Triangles) -> Inversions:
    """Inversions to be filled in."""
    jellies = triangles.jellies
    return Inversions(np.zeros(len(jellies.particle), np.int64), np.zeros(len(jellies.first), np.bool_))
