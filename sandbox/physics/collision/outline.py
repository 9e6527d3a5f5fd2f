"""Outlines: the edges that springs make, and terrain, as topology alone decides; kept until topology changes.

With them are kept which edges of a form lie close to each other without meeting, as those may cross first when the form
is bent, and the edges of which both ends are pinned: terrain of their own, as they stand.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.collision.types import Colliders
from sandbox.physics.geometry.segment import SHORTEST
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import ALL_GROUPS, GRAB_MATERIAL, LINE, NO_EDGE, SOLID_RIGHT, TERRAIN_GROUP
from sandbox.physics.state import State
from sandbox.physics.terrain import Chain, GridScratch, Terrain, fill_cells, size_grid
from sandbox.physics.topology.sorting import list_by_key, list_ends, list_neighbours, sort_by_key, sort_by_value

# Owner of the first chain of terrain, the others below it; particles and bodies are above.
TERRAIN_OWNER = -2_000_000_000
# Places in `counts`: edges of bodies, of those and terrain, springs that join, rows of solid, shapes, their members.
EDGES, ALL_EDGES, JOINED, SPANS, SHAPES, MEMBERS, COUNTS = range(7)
# Forms of more edges are not looked at, their pairs are too many; of the others so many pairs for each edge are kept.
MOST_EDGES = 160
KEPT = 8
# Classes of distance by which pairs are sorted out before they are sorted.
CLASSES = 64
FRICTION, RESTITUTION = Chain.friction, Chain.restitution


class CloseEdges(NamedTuple):
    """Pairs of edges of some forms that have no common end and do not cross, the closest first.

    Those of form s: edge[start[s]:start[s + 1]] (k, 2), as far apart as distance [m] (k,). beyond [m] (s,): all others
    of the form are farther apart than this; 0: not known.
    """

    start: Annotated[Slots, "shapes + 1"]
    edge: Annotated[SlotRows, "room, 2"]
    distance: Annotated[Floats, "room"]
    beyond: Annotated[Floats, "shapes"]


class FormEdges(NamedTuple):
    """Edges a to b (e,) between places of a form [m] (n, 2); shape (n,) of each place; solid_of: see Outline."""

    form: FloatRows
    a: Slots
    b: Slots
    shape: Slots
    solid_of: Slots


class PairScratch(NamedTuple):
    """Scratch. Of edges (e,): key, listed; start (s+1,). Of pairs of one form: one, other, order, spare, distance."""

    key: Annotated[Slots, "edges"]
    listed: Annotated[Slots, "edges"]
    start: Annotated[Slots, "shapes + 1"]
    one: Annotated[Slots, "pairs"]
    other: Annotated[Slots, "pairs"]
    order: Annotated[Slots, "pairs"]
    spare: Annotated[Slots, "pairs"]
    distance: Annotated[Floats, "pairs"]


class Outline(NamedTuple):
    """The edges of a world's springs and of its terrain, which topology alone decides; see Colliders.

    Shapes are the owners of edges of bodies, in the order of their edges.
    """

    edge_a: Annotated[Slots, "every"]
    edge_b: Annotated[Slots, "every"]
    side: Annotated[Slots, "every"]
    number: Annotated[Slots, "every"]
    edge_start: Annotated[Slots, "vertices + 1"]
    edge_of: Annotated[Slots, "2 * every"]
    near_start: Annotated[Slots, "particles + 1"]
    near_of: Annotated[Slots, "2 * springs"]
    solid: Annotated[SlotRows, "every, 2"]  # by owner with a solid edge: its first, one past its last; terrain last
    owner: Annotated[Slots, "vertices"]
    shielded: Annotated[Flags, "particles"]  # inside a solid body, no torn spring lays it bare: discs do not hit it
    attached: Annotated[Flags, "particles"]  # (n,): particles that a spring or a constraint holds
    dynamic: Annotated[Slots, "2"]  # (2,): edges of bodies, and how many rows of solid are bodies'
    shape: Annotated[Slots, "vertices"]  # by vertex, -1: none
    solid_of: Annotated[Slots, "springs"]  # by shape: its row of solid, -1: it has lines alone
    member_start: Annotated[Slots, "springs + 1"]
    member: Annotated[Slots, "particles"]  # particles of shape s: member[member_start[s]:member_start[s + 1]]
    close: CloseEdges  # edges of lines alone that were made close to each other
    spring_end: Annotated[Slots, "springs"]  # one particle of each spring
    pins: Terrain  # edges of bodies with both ends pinned, as terrain; chain = the edge


class OutlineScratch(NamedTuple):
    """Scratch: rank (v,) = the number of a vertex's owner, ascending; by owner: start (v+1,), ways, flag; others long
    enough for twice the springs and all vertices."""

    rank: Annotated[Slots, "vertices + 1"]
    start: Annotated[Slots, "vertices + 1"]
    ways: Annotated[Slots, "vertices + 1"]
    flag: Annotated[Flags, "vertices"]
    one: Annotated[Slots, "longest"]
    other: Annotated[Slots, "longest"]
    third: Annotated[Slots, "longest"]


@inner_kernel
def new_outline(state: State, arena: Arena) -> Outline:
    """The outline of a world's bodies, as its topology is now; nothing of it may be read where the arena is full."""
    particles, springs = state.owner.shape[0], state.spring_active.shape[0]
    vertices = particles + state.terrain.vertex.shape[0]
    room = new_tuple(
        Outline, arena, every=springs + state.terrain.edge_a.shape[0], particles=particles, springs=springs,
        vertices=vertices, shapes=0, room=0, pins=_new_pins(0, arena),
    )  # fmt: skip
    counts = new_slots(arena, COUNTS)
    start, longest = mark(arena), max(vertices, 2 * springs)
    work = new_tuple(OutlineScratch, arena, vertices=vertices, longest=longest)
    if is_full(arena):
        return room
    _derive_edges(state, room, counts, work)
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
def _derive_edges(state: State, outline: Outline, counts: Slots, work: OutlineScratch) -> None:
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
def _rank_owners(state: State, owner: Slots, work: OutlineScratch) -> int:
    # The owner of each vertex, and its number among them, ascending; how many owners there are.
    particles = state.owner.shape[0]
    for p in range(particles):
        owner[p] = state.owner[p]
    for v in range(particles, owner.shape[0]):
        owner[v] = 0
    for e in range(state.terrain.edge_a.shape[0]):
        a, b = particles + state.terrain.edge_a[e], particles + state.terrain.edge_b[e]
        owner[a] = owner[b] = TERRAIN_OWNER - state.terrain.chain[e]
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
            shielded[state.particle_a[s]] = shielded[state.particle_b[s]] = False


@inner_kernel
def close_edges(form: FloatRows, a: Slots, b: Slots, shape: Slots, solid_of: Slots, arena: Arena) -> CloseEdges:
    """The close edges, a[k] to b[k], of forms [m] (n, 2); shape (n,): of each place; solid_of (s,): -1: looked at."""
    edges, shapes = a.shape[0], solid_of.shape[0]
    if edges == 0:
        return new_tuple(CloseEdges, arena, shapes=0, room=0)
    longest, room = min(edges, MOST_EDGES), KEPT * edges
    pairs = max(longest * longest // 2, CLASSES)
    found = new_tuple(CloseEdges, arena, shapes=shapes, room=room)
    start = mark(arena)
    work = new_tuple(PairScratch, arena, edges=edges, shapes=shapes, pairs=pairs)
    if is_full(arena):
        return found
    count = _find_close_edges(FormEdges(form, a, b, shape, solid_of), found, work)
    give_back(arena, start)
    return CloseEdges(found.start, found.edge[:count], found.distance[:count], found.beyond)


@inner_kernel
def _find_close_edges(given: FormEdges, found: CloseEdges, work: PairScratch) -> int:
    """Find the close edges of the forms that are lines alone, solid_of below 0; how many pairs there are."""
    shapes = given.solid_of.shape[0]
    for e in range(given.a.shape[0]):
        work.key[e] = given.shape[given.a[e]]
    list_by_key(work.key, given.a.shape[0], shapes, work.start, work.listed)
    top = 0
    found.start[0] = 0
    for s in range(shapes):
        edges = work.start[s + 1] - work.start[s]
        found.beyond[s] = 0.0
        if given.solid_of[s] < 0 and edges <= MOST_EDGES:
            pairs = _find_pairs(work.start[s], work.start[s + 1], given, work)
            kept = KEPT * edges
            sorted_out = _sort_closest(pairs, kept + 1, work)
            found.beyond[s] = work.distance[work.order[kept]] if kept < pairs else math.inf
            for k in range(min(kept, sorted_out)):
                pair = work.order[k]
                found.edge[top, 0] = work.one[pair]
                found.edge[top, 1] = work.other[pair]
                found.distance[top] = work.distance[pair]
                top += 1
        found.start[s + 1] = top
    return top


@inner_kernel
def _find_pairs(first: int, last: int, given: FormEdges, work: PairScratch) -> int:
    # The pairs of edges that may come to cross, of one form, whose edges are listed[first:last]; how many there are.
    count = 0
    for i in range(first, last):
        for j in range(i + 1, last):
            distance = _apart(work.listed[i], work.listed[j], given)
            if distance >= 0.0:
                work.one[count] = work.listed[i]
                work.other[count] = work.listed[j]
                work.distance[count] = distance
                count += 1
    return count


@inner_kernel
def _apart(one: int, other: int, given: FormEdges) -> float:
    # How far apart two edges are that have no common end and do not cross; -1: they have, or do.
    a, b = given.a[one], given.b[one]
    c, d = given.a[other], given.b[other]
    if a in (c, d) or b in (c, d):
        return -1.0
    c_left, of_c = _end_from(one, c, given)
    d_left, of_d = _end_from(one, d, given)
    a_left, of_a = _end_from(other, a, given)
    b_left, of_b = _end_from(other, b, given)
    if c_left != d_left and a_left != b_left:
        return -1.0
    return math.sqrt(min(min(of_c, of_d), min(of_a, of_b)))


@inner_kernel
def _end_from(edge: int, p: int, given: FormEdges) -> tuple[bool, float]:
    # On which side of the line along an edge a place is, and the square of how far it is from the edge.
    a = given.a[edge]
    form = given.form
    wx, wy = form[given.b[edge], 0] - form[a, 0], form[given.b[edge], 1] - form[a, 1]
    x, y = form[p, 0] - form[a, 0], form[p, 1] - form[a, 1]
    share = (wx * x + wy * y) * (1.0 / max(wx * wx + wy * wy, SHORTEST))
    is_left = wx * y - wy * x > 0.0
    share = min(max(share, 0.0), 1.0)
    x -= share * wx
    y -= share * wy
    return is_left, x * x + y * y


@inner_kernel
def _sort_closest(count: int, wanted: int, work: PairScratch) -> int:
    # The order of so many of `count` pairs, the closest first, or of more; how many. Only those are sorted that lie in
    # the classes of distance, all alike, that hold the wanted ones.
    farthest = 0.0
    for k in range(count):
        farthest = max(farthest, work.distance[k])
    per_class = (CLASSES - 1.0) / farthest if farthest > 0.0 else 0.0
    for c in range(CLASSES):
        work.spare[c] = 0
    for k in range(count):
        work.spare[math.floor(work.distance[k] * per_class)] += 1
    last = 0
    found = work.spare[0]
    while found < wanted and last + 1 < CLASSES:
        last += 1
        found += work.spare[last]
    found = 0
    for k in range(count):
        if math.floor(work.distance[k] * per_class) <= last:
            work.order[found] = k
            found += 1
    sort_by_value(work.distance, work.order, 0, found, work.spare)
    return found


@inner_kernel
def pinned_edges(state: State, edge_a: Slots, edge_b: Slots, side: Slots, arena: Arena) -> Terrain:
    """Those of the edges a to b of bodies that pins hold at both ends, as terrain; chain = the edge."""
    edges = edge_a.shape[0]
    found = _new_pins(edges, arena)
    start = mark(arena)
    work = GridScratch(new_floats(arena, edges), new_slots(arena, edges), new_slots(arena, edges))
    if is_full(arena):
        return found
    count = _find_pinned(state, edge_a, edge_b, side, found, work)
    give_back(arena, start)
    if count == 0:
        return _new_pins(0, arena)
    cells, entries = found.size[0] * found.size[1], 4 * count
    cell_start, tip_start = new_slots(arena, cells + 1), new_slots(arena, cells + 1)
    found = _with_cells(found, count, cell_start, new_slots(arena, entries), tip_start)
    if is_full(arena):
        return found
    needed = fill_cells(count, found)
    if needed > entries:
        found = _with_cells(found, count, cell_start, new_slots(arena, needed), tip_start)
        if is_full(arena):
            return found
        fill_cells(count, found)
    return _with_cells(found, count, cell_start, found.cell_edge[:needed], tip_start)


@inner_kernel
def _new_pins(edges: int, arena: Arena) -> Terrain:
    # Room for so many pinned edges, in no cells yet.
    pins = new_tuple(Terrain, arena, vertices=2 * edges, edges=edges, cells=0, entries=0, tips=0, ways=0)
    if not is_full(arena):
        pins.cell[0] = 1.0
    return pins


@inner_kernel
def _with_cells(pins: Terrain, count: int, cell_start: Slots, cell_edge: Slots, tip_start: Slots) -> Terrain:
    # The first `count` edges, with these lists of cells.
    return Terrain(
        pins.vertex[: 2 * count], pins.edge_a[:count], pins.edge_b[:count], pins.solid[:count], pins.chain[:count],
        pins.friction[:count], pins.restitution[:count], pins.belt[:count], pins.corner, pins.cell, pins.size,
        cell_start, cell_edge, pins.tip, pins.way_start, pins.way, tip_start, pins.cell_tip,
    )  # fmt: skip


@inner_kernel
def _find_pinned(state: State, edge_a: Slots, edge_b: Slots, side: Slots, pins: Terrain, work: GridScratch) -> int:
    """Fill in the edges that are pinned, and corner, cell and size of their grid; how many there are."""
    count = 0
    for e in range(edge_a.shape[0]):
        a, b = edge_a[e], edge_b[e]
        if not (_is_still(a, state) and _is_still(b, state)):
            continue
        dx, dy = state.position[b, 0] - state.position[a, 0], state.position[b, 1] - state.position[a, 1]
        if dx == 0.0 and dy == 0.0:
            continue
        for axis in range(2):
            # -0.0 becomes 0.0
            pins.vertex[2 * count, axis] = state.position[a, axis] + 0.0
            pins.vertex[2 * count + 1, axis] = state.position[b, axis] + 0.0
        pins.edge_a[count] = 2 * count
        pins.edge_b[count] = 2 * count + 1
        pins.solid[count] = side[e]
        pins.chain[count] = e
        pins.friction[count] = FRICTION
        pins.restitution[count] = RESTITUTION
        count += 1
    if count > 0:
        size_grid(count, pins, work)
    return count


@inner_kernel
def _is_still(p: int, state: State) -> bool:
    return state.inverse_mass[p] == 0.0 and state.velocity[p, 0] == 0.0 and state.velocity[p, 1] == 0.0


@inner_kernel
def new_colliders(terrain: Terrain, outline: Outline, pairs: int, arena: Arena) -> Colliders:
    """The colliders of an outline: terrain is filled in; each tick and step fills in the particles.

    pairs: room for this many pairs of shapes that are separated.
    """
    total = outline.owner.shape[0]
    colliders = new_tuple(
        Colliders, arena, owner=outline.owner, edge_a=outline.edge_a, edge_b=outline.edge_b, side=outline.side,
        number=outline.number, edge_start=outline.edge_start, edge_of=outline.edge_of, near_start=outline.near_start,
        near_of=outline.near_of, shielded=outline.shielded, shape=outline.shape, vertices=total, pairs=pairs,
    )  # fmt: skip
    if not is_full(arena):
        _fill_in_terrain(terrain, colliders)
    return colliders


@inner_kernel
def _fill_in_terrain(terrain: Terrain, colliders: Colliders) -> None:
    """Fill in the vertices of terrain, and the collision groups of all vertices."""
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
