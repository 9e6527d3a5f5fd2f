"""Outlines: the edges that springs make, and terrain, as topology alone decides; kept until topology changes."""

from typing import NamedTuple

from sandbox.physics.arena import (
    Arena,
    give_back,
    is_full,
    mark,
    new_flags,
    new_float_rows,
    new_floats,
    new_slot_rows,
    new_slots,
)
from sandbox.physics.arrays import Flags, SlotRows, Slots
from sandbox.physics.collision.close_edges import CloseEdges, close_edges, no_close_edges
from sandbox.physics.collision.filter import ALL_GROUPS, LINE, NO_EDGE, SOLID_RIGHT, TERRAIN_GROUP
from sandbox.physics.collision.pinned_edges import no_pins, pinned_edges
from sandbox.physics.collision.types import Colliders
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.state import State
from sandbox.physics.terrain import Terrain
from sandbox.physics.topology.sorting import list_by_key, list_ends, list_neighbours, sort_by_key, sort_by_value

# Owner of the first chain of terrain, the others below it; particles and bodies are above.
TERRAIN_OWNER = -2_000_000_000
# Places in `counts`: edges of bodies, of those and terrain, springs that join, rows of solid, shapes, their members.
EDGES, ALL_EDGES, JOINED, SPANS, SHAPES, MEMBERS, COUNTS = range(7)


class Outline(NamedTuple):
    """The edges of a world's springs and of its terrain, which topology alone decides; see Colliders.

    Shapes are the owners of edges of bodies, in the order of their edges.
    """

    edge_a: Slots
    edge_b: Slots
    side: Slots
    number: Slots
    edge_start: Slots
    edge_of: Slots
    near_start: Slots
    near_of: Slots
    solid: SlotRows  # (k, 2): first edge and one past the last of each owner with a solid edge; terrain's last
    owner: Slots
    shielded: Flags  # particles inside a solid body that no torn spring lays bare; discs do not hit them
    attached: Flags  # (n,): particles that a spring or a constraint holds
    dynamic: Slots  # (2,): edges of bodies, and how many rows of solid are bodies'
    shape: Slots  # by vertex, -1: none
    solid_of: Slots  # by shape: its row of solid, -1: it has lines alone
    member_start: Slots
    member: Slots  # particles of shape s: member[member_start[s]:member_start[s + 1]]
    close: CloseEdges  # edges of lines alone that were made close to each other
    spring_end: Slots  # one particle of each spring
    pins: Terrain  # edges of bodies with both ends pinned, as terrain; chain = the edge


class OutlineScratch(NamedTuple):
    """Scratch: rank (v,) = the number of a vertex's owner, ascending; by owner: start (v+1,), ways, flag; others long
    enough for twice the springs and all vertices."""

    rank: Slots
    start: Slots
    ways: Slots
    flag: Flags
    one: Slots
    other: Slots
    third: Slots


@inner_kernel
def _rank_owners(state: State, owner: Slots, work: OutlineScratch) -> int:
    # The owner of each vertex, and its number among them, ascending; how many owners there are.
    particles = state.owner.shape[0]
    for p in range(particles):
        owner[p] = state.owner[p]
    for v in range(particles, owner.shape[0]):
        owner[v] = 0
    for e in range(state.terrain.edge_a.shape[0]):
        owner[particles + state.terrain.edge_a[e]] = TERRAIN_OWNER - state.terrain.chain[e]
    for e in range(state.terrain.edge_b.shape[0]):
        owner[particles + state.terrain.edge_b[e]] = TERRAIN_OWNER - state.terrain.chain[e]
    for v in range(owner.shape[0]):
        work.one[v] = v
    sort_by_value(owner, work.one, 0, owner.shape[0], work.other)
    count = 0
    for at in range(owner.shape[0]):
        v = work.one[at]
        if at > 0 and owner[v] != owner[work.one[at - 1]]:
            count += 1
        work.rank[v] = count
    return count + 1 if owner.shape[0] > 0 else 0


@inner_kernel
def _choose_edges(state: State, owners: int, outline: Outline, work: OutlineScratch) -> int:
    # Edges of one owner lie together, so that a whole outline can be walked through. How many bodies have.
    chosen = 0
    for s in range(state.spring_active.shape[0]):
        work.other[s] = -1
        if state.spring_active[s] and state.edge[s] != NO_EDGE:
            work.one[chosen] = s
            # By where the edge begins, as its owner is found.
            begins = state.particle_b[s] if state.edge[s] == SOLID_RIGHT else state.particle_a[s]
            work.other[s] = work.rank[begins]
            chosen += 1
    sort_by_key(work.other, work.one, chosen, owners, work.start, outline.number)
    for e in range(chosen):
        s = outline.number[e]
        swapped = state.edge[s] == SOLID_RIGHT
        outline.edge_a[e] = state.particle_b[s] if swapped else state.particle_a[s]
        outline.edge_b[e] = state.particle_a[s] if swapped else state.particle_b[s]
    for e in range(state.terrain.edge_a.shape[0]):
        outline.edge_a[chosen + e] = state.owner.shape[0] + state.terrain.edge_a[e]
        outline.edge_b[chosen + e] = state.owner.shape[0] + state.terrain.edge_b[e]
        outline.side[chosen + e] = state.terrain.solid[e]
        outline.number[chosen + e] = e
    return chosen


@inner_kernel
def _find_sides(state: State, chosen: int, outline: Outline, work: OutlineScratch) -> None:
    # An outline that is torn open encloses nothing, so all its edges have two sides.
    for v in range(outline.owner.shape[0]):
        work.ways[v] = 0
        work.flag[v] = False
    for e in range(chosen):
        if state.edge[outline.number[e]] != LINE:
            work.ways[outline.edge_a[e]] += 1
            work.ways[outline.edge_b[e]] -= 1
    for v in range(outline.owner.shape[0]):
        if work.ways[v] != 0:
            work.flag[work.rank[v]] = True
    for e in range(chosen):
        whole = state.edge[outline.number[e]] != LINE and not work.flag[work.rank[outline.edge_a[e]]]
        outline.side[e] = 1 if whole else 0


@inner_kernel
def _find_neighbours(state: State, outline: Outline, work: OutlineScratch) -> int:
    # What each particle is joined to, and which ones a spring or a constraint holds; how many springs there are. Hands
    # are told apart, in every tick.
    joined = 0
    for s in range(state.spring_active.shape[0]):
        if state.spring_active[s] and state.material[s] != GRAB_MATERIAL:
            work.one[joined] = state.particle_a[s]
            work.other[joined] = state.particle_b[s]
            joined += 1
    particles = state.owner.shape[0]
    list_neighbours(work.one, work.other, joined, particles, outline.near_start, outline.near_of, work.third, work.ways)
    for p in range(particles):
        outline.attached[p] = outline.near_start[p + 1] > outline.near_start[p]
    corner = 0
    for k in range(state.constraint_active.shape[0]):
        for _ in range(state.constraint_corners[k]):
            if state.constraint_active[k]:
                outline.attached[state.corner_particle[corner]] = True
            corner += 1
    return joined


@inner_kernel
def _find_spans(count: int, outline: Outline) -> int:
    # First edge and one past the last of each owner that has solid ones; how many there are.
    spans = 0
    first = 0
    any_solid = False
    for e in range(count):
        any_solid = any_solid or outline.side[e] != 0
        if e + 1 == count or outline.owner[outline.edge_a[e + 1]] != outline.owner[outline.edge_a[e]]:
            if any_solid:
                outline.solid[spans, 0] = first
                outline.solid[spans, 1] = e + 1
                spans += 1
            first = e + 1
            any_solid = False
    return spans


@inner_kernel
def _find_shapes(state: State, chosen: int, spans: int, outline: Outline, work: OutlineScratch) -> int:
    # Number the owners of edges in the order of those, and list their particles; how many there are.
    shape, rank, number = outline.shape, work.rank, work.ways
    for v in range(shape.shape[0]):
        number[v] = -1
    shapes = 0
    for e in range(chosen):
        if number[rank[outline.edge_a[e]]] < 0:
            number[rank[outline.edge_a[e]]] = shapes
            outline.solid_of[shapes] = -1
            shapes += 1
    for v in range(shape.shape[0]):
        shape[v] = number[rank[v]]
    for k in range(spans):
        if outline.solid[k, 0] < chosen:
            outline.solid_of[shape[outline.edge_a[outline.solid[k, 0]]]] = k
            outline.dynamic[1] = k + 1
    for p in range(state.owner.shape[0]):
        work.one[p] = shape[p] if state.particle_active[p] else -1
    list_by_key(work.one, state.owner.shape[0], shapes, outline.member_start, outline.member)
    return shapes


@inner_kernel
def _find_shielded(state: State, chosen: int, outline: Outline, work: OutlineScratch) -> None:
    # A grab that holds nothing tears nothing.
    shielded = outline.shielded
    for v in range(outline.owner.shape[0]):
        work.flag[v] = False
    for e in range(chosen):
        if state.edge[outline.number[e]] != LINE:
            work.flag[work.rank[state.particle_a[outline.number[e]]]] = True
    for p in range(shielded.shape[0]):
        shielded[p] = work.flag[work.rank[p]]
    for s in range(state.spring_active.shape[0]):
        bare = not state.spring_active[s] or state.edge[s] != NO_EDGE
        if bare and state.material[s] != GRAB_MATERIAL:
            shielded[state.particle_a[s]] = False
            shielded[state.particle_b[s]] = False


@inner_kernel
def derive_edges(state: State, outline: Outline, counts: Slots, work: OutlineScratch) -> None:
    """Fill in an outline, all but its close edges and pins, and say in counts (COUNTS,) how much of it."""
    owners = _rank_owners(state, outline.owner, work)
    chosen = _choose_edges(state, owners, outline, work)
    count = chosen + state.terrain.edge_a.shape[0]
    _find_sides(state, chosen, outline, work)
    list_ends(outline.edge_a, outline.edge_b, count, outline.owner.shape[0], outline.edge_start, outline.edge_of)
    counts[JOINED] = _find_neighbours(state, outline, work)
    outline.dynamic[0] = chosen
    outline.dynamic[1] = 0
    counts[EDGES] = chosen
    counts[ALL_EDGES] = count
    counts[SPANS] = _find_spans(count, outline)
    counts[SHAPES] = _find_shapes(state, chosen, counts[SPANS], outline, work)
    counts[MEMBERS] = outline.member_start[counts[SHAPES]]
    _find_shielded(state, chosen, outline, work)
    for s in range(outline.spring_end.shape[0]):
        outline.spring_end[s] = state.particle_a[s]


@inner_kernel
def new_outline(state: State, arena: Arena) -> Outline:
    """The outline of a world's bodies, as its topology is now; nothing of it may be read where the arena is full."""
    particles, springs = state.owner.shape[0], state.spring_active.shape[0]
    vertices = particles + state.terrain.vertex.shape[0]
    room, counts = _room(particles, springs, vertices, state.terrain.edge_a.shape[0], arena), new_slots(arena, COUNTS)
    start, longest = mark(arena), max(vertices, 2 * springs)
    work = OutlineScratch(
        new_slots(arena, vertices + 1), new_slots(arena, vertices + 1), new_slots(arena, vertices + 1),
        new_flags(arena, vertices), new_slots(arena, longest), new_slots(arena, longest), new_slots(arena, longest),
    )  # fmt: skip
    if is_full(arena):
        return room
    derive_edges(state, room, counts, work)
    give_back(arena, start)
    every, shapes = counts[ALL_EDGES], counts[SHAPES]
    a, b, side = room.edge_a[: counts[EDGES]], room.edge_b[: counts[EDGES]], room.side[:every]
    solid_of = room.solid_of[:shapes]
    return Outline(
        room.edge_a[:every], room.edge_b[:every], side, room.number[:every], room.edge_start, room.edge_of[: 2 * every],
        room.near_start, room.near_of[: 2 * counts[JOINED]], room.solid[: counts[SPANS]], room.owner, room.shielded,
        room.attached, room.dynamic, room.shape, solid_of, room.member_start[: shapes + 1],
        room.member[: counts[MEMBERS]], close_edges(state.origin, a, b, room.shape, solid_of, arena), room.spring_end,
        pinned_edges(state, a, b, side, arena),
    )  # fmt: skip


@inner_kernel
def _room(particles: int, springs: int, vertices: int, edges: int, arena: Arena) -> Outline:
    # With room for edges of all springs; edges: of terrain.
    every = springs + edges
    return Outline(
        new_slots(arena, every), new_slots(arena, every), new_slots(arena, every), new_slots(arena, every),
        new_slots(arena, vertices + 1), new_slots(arena, 2 * every), new_slots(arena, particles + 1),
        new_slots(arena, 2 * springs), new_slot_rows(arena, every, 2), new_slots(arena, vertices),
        new_flags(arena, particles), new_flags(arena, particles), new_slots(arena, 2), new_slots(arena, vertices),
        new_slots(arena, springs), new_slots(arena, springs + 1), new_slots(arena, particles), no_close_edges(arena),
        new_slots(arena, springs), no_pins(arena),
    )  # fmt: skip


@inner_kernel
def fill_in_terrain(terrain: Terrain, colliders: Colliders) -> None:
    """Fill in the vertices of terrain, and the groups of all vertices as those are."""
    particles = colliders.owner.shape[0] - terrain.vertex.shape[0]
    for v in range(colliders.owner.shape[0]):
        colliders.group[v] = TERRAIN_GROUP
        colliders.collides[v] = ALL_GROUPS
    for v in range(terrain.vertex.shape[0]):
        for axis in range(2):
            colliders.position[particles + v, axis] = terrain.vertex[v, axis]
            colliders.origin[particles + v, axis] = terrain.vertex[v, axis]
    # A vertex between two edges is like the one that it ends.
    for e in range(terrain.edge_a.shape[0]):
        colliders.friction[particles + terrain.edge_a[e]] = terrain.friction[e]
        colliders.restitution[particles + terrain.edge_a[e]] = terrain.restitution[e]
    for e in range(terrain.edge_b.shape[0]):
        colliders.friction[particles + terrain.edge_b[e]] = terrain.friction[e]
        colliders.restitution[particles + terrain.edge_b[e]] = terrain.restitution[e]


@inner_kernel
def new_colliders(terrain: Terrain, outline: Outline, pairs: int, arena: Arena) -> Colliders:
    """The colliders of an outline: terrain is filled in; each tick and step fills in the particles.

    pairs: room for this many pairs of shapes that are separated.
    """
    total = outline.owner.shape[0]
    colliders = Colliders(
        new_float_rows(arena, total, 2), new_float_rows(arena, total, 2), new_float_rows(arena, total, 2),
        new_floats(arena, total), new_floats(arena, total), new_floats(arena, total), outline.owner,
        new_slots(arena, total), new_slots(arena, total), new_floats(arena, total), new_floats(arena, total),
        new_floats(arena, total), outline.edge_a, outline.edge_b, outline.side, outline.number, outline.edge_start,
        outline.edge_of, outline.near_start, outline.near_of, outline.shielded, new_flags(arena, total), outline.shape,
        new_flags(arena, total), new_flags(arena, total), new_slot_rows(arena, pairs, 3), new_slots(arena, 1),
    )  # fmt: skip
    if not is_full(arena):
        fill_in_terrain(terrain, colliders)
    return colliders
