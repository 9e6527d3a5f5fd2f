"""Outlines: the edges that springs make, and terrain, as topology alone decides; kept until topology changes."""

from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.close_edges import CloseEdges, close_edges
from sandbox.physics.collision.filter import ALL_GROUPS, LINE, NO_EDGE, SOLID_RIGHT, TERRAIN_GROUP
from sandbox.physics.collision.types import Colliders, Flags
from sandbox.physics.state import Slots
from sandbox.physics.terrain import Chain, Terrain, make_terrain
from sandbox.physics.world import GRAB_MATERIAL, World

# Owner of the first chain of terrain, the others below it; particles and bodies are above.
TERRAIN_OWNER = -2_000_000_000


class Outline(NamedTuple):
    """The edges of a world's springs and of its terrain, which topology alone decides; see Colliders.

    shielded: particles inside a solid body that no torn spring lays bare; discs do not hit them. attached (n,):
    particles that a spring or a constraint holds. solid (k, 2): first edge and one past the last of each owner's edges
    where any is solid, terrain's last. dynamic (2,): edges of bodies, and how many of those in solid are bodies'.
    Shapes are the owners of edges of bodies, in the order of their edges: shape, by vertex, -1: none; solid_of = by
    shape, the row of solid, -1: lines alone; particles of shape s: member[member_start[s]:member_start[s + 1]]. close:
    edges of lines alone that were made close to each other. spring_end: one particle of each spring. pins: edges of
    bodies of which both ends are pinned, as terrain; chain = the edge.
    """

    edge_a: Slots
    edge_b: Slots
    side: Slots
    number: Slots
    edge_start: Slots
    edge_of: Slots
    near_start: Slots
    near_of: Slots
    solid: Slots
    owner: Slots
    shielded: Flags
    attached: Flags
    dynamic: Slots
    shape: Slots
    solid_of: Slots
    member_start: Slots
    member: Slots
    close: CloseEdges
    spring_end: Slots
    pins: Terrain


def outline_of(world: World) -> Outline:
    """The outline of a world's bodies, made again after a change of topology."""
    return world.derived(_make_outline)


def _make_outline(world: World) -> Outline:
    terrain, count = world.terrain, world.particle_count
    chosen = np.flatnonzero(world.spring_active & (world.edge != NO_EDGE))
    # Edges of one owner lie together, so that a whole outline can be walked through.
    chosen = chosen[np.argsort(world.owner[world.particle_a[chosen]], kind="stable")]
    a, b = world.particle_a[chosen].astype(np.int64), world.particle_b[chosen].astype(np.int64)
    swapped = world.edge[chosen] == SOLID_RIGHT
    a, b = np.where(swapped, b, a), np.where(swapped, a, b)
    edge_a, edge_b = np.append(a, count + terrain.edge_a), np.append(b, count + terrain.edge_b)
    owner = np.append(world.owner.astype(np.int64), _owners(terrain))
    side = np.append(_sides(world.edge[chosen] != LINE, a, b, owner), terrain.solid)
    joined = np.flatnonzero(world.spring_active)
    ends = world.particle_a[joined].astype(np.int64), world.particle_b[joined].astype(np.int64)
    edges = np.arange(len(edge_a))
    near_start, near_of = _listed(np.append(*ends), np.append(*ends[::-1]), count)
    attached = np.diff(near_start) > 0
    attached[world.corner_particle[np.repeat(world.constraint_active, world.constraint_corners)]] = True
    solid = _solid(owner[edge_a] if len(edge_a) else edge_a, side)
    shape, solid_of, member_start, member = _shapes(world, owner, a, solid)
    return Outline(
        edge_a,
        edge_b,
        side,
        np.append(chosen, np.arange(len(terrain.edge_a))),
        *_listed(np.append(edge_a, edge_b), np.append(edges, edges), len(owner)),
        near_start,
        near_of,
        solid,
        owner,
        _shielded(world, chosen),
        attached,
        np.array([len(chosen), np.count_nonzero(solid[:, 0] < len(chosen))]),
        shape,
        solid_of,
        member_start,
        member,
        close_edges(world.origin, a, b, shape[a], solid_of < 0),
        world.particle_a.astype(np.int64),
        _pins(world, a, b, side),
    )


def _pins(world: World, a: Slots, b: Slots, side: Slots) -> Terrain:
    """The edges a to b that pins hold at both ends, as terrain."""
    still = (world.inverse_mass[a] == 0.0) & (world.inverse_mass[b] == 0.0)
    still &= ~world.velocity[a].any(axis=1) & ~world.velocity[b].any(axis=1)
    edges = np.flatnonzero(still & (world.position[a] != world.position[b]).any(axis=1))
    made = make_terrain([Chain(world.position[[a[e], b[e]]]) for e in edges.tolist()], tips=False)
    return made._replace(solid=side[edges].astype(np.int64), chain=edges.astype(np.int64))


def _shapes(world: World, owner: Slots, edge_a: Slots, solid: Slots) -> tuple[Slots, Slots, Slots, Slots]:
    """The shapes of an outline whose edges of bodies begin at edge_a: see Outline."""
    owners = owner[edge_a][np.sort(np.unique(owner[edge_a], return_index=True)[1])] if len(edge_a) else edge_a
    order = np.argsort(owners, kind="stable")
    found = np.searchsorted(owners[order], owner)
    found = np.append(order, -1)[np.minimum(found, len(owners))]
    shape = np.where(np.append(owners, 0)[found] == owner, found, -1) if len(owners) else np.full(len(owner), -1)
    solid_of = np.full(len(owners), -1)
    first = solid[solid[:, 0] < len(edge_a), 0]
    solid_of[shape[edge_a[first]]] = np.arange(len(first))
    members = np.flatnonzero(world.particle_active & (shape[: world.particle_count] >= 0))
    return shape, solid_of, *_listed(shape[members], members, len(owners))


def _sides(solid: Flags, a: Slots, b: Slots, owner: Slots) -> Slots:
    """Side of each edge a to b: an outline that is torn open encloses nothing, so all its edges have two sides."""
    ways = np.bincount(a[solid], minlength=len(owner)) != np.bincount(b[solid], minlength=len(owner))
    return (solid & ~np.isin(owner[a], owner[ways])).astype(np.int64)


def _shielded(world: World, edges: Slots) -> Flags:
    solid = edges[world.edge[edges] != LINE]
    shielded = np.isin(world.owner, world.owner[world.particle_a[solid]])
    for bare in (edges, np.flatnonzero(~world.spring_active)):
        # A grab that holds nothing tears nothing.
        bare = bare[world.material[bare] != GRAB_MATERIAL]
        shielded[world.particle_a[bare]] = shielded[world.particle_b[bare]] = False
    return shielded


def _owners(terrain: Terrain) -> Slots:
    owner = np.zeros(len(terrain.vertex), dtype=np.int64)
    owner[terrain.edge_a] = TERRAIN_OWNER - terrain.chain
    owner[terrain.edge_b] = TERRAIN_OWNER - terrain.chain
    return owner


def _listed(keys: Slots, values: Slots, count: int) -> tuple[Slots, Slots]:
    """Where the values of each of `count` keys begin, and the values by key."""
    order = np.lexsort((values, keys))
    return np.append(0, np.cumsum(np.bincount(keys, minlength=count))).astype(np.int64), values[order]


def _solid(owner: Slots, side: Slots) -> Slots:
    starts = np.flatnonzero(np.diff(owner, prepend=owner[:1] - 1))
    spans = np.stack([starts, np.append(starts[1:], len(owner))], axis=1) if len(owner) else np.zeros((0, 2), np.int64)
    return spans[[bool(side[first:last].any()) for first, last in spans.tolist()]] if len(spans) else spans


def colliders_of(world: World, outline: Outline, pairs: int) -> Colliders:
    """The colliders of an outline: terrain is filled in; each tick and step fills in the particles.

    pairs: room for this many pairs of shapes that are separated.
    """
    terrain, count = world.terrain, world.particle_count
    total = count + len(terrain.vertex)
    position, velocity, origin = np.zeros((3, total, 2))
    radius, friction, restitution, inverse_mass, turning, rolling = np.zeros((6, total))
    group, collides = np.full(total, TERRAIN_GROUP), np.full(total, ALL_GROUPS)
    inverted, parting, caught = np.zeros((3, total), np.bool_)
    position[count:] = origin[count:] = terrain.vertex
    for ends in (terrain.edge_a, terrain.edge_b):
        friction[count + ends], restitution[count + ends] = terrain.friction, terrain.restitution
    return Colliders(
        position, velocity, origin, radius, friction, restitution, outline.owner, group, collides, inverse_mass,
        turning, rolling, outline.edge_a, outline.edge_b, outline.side, outline.number, outline.edge_start,
        outline.edge_of, outline.near_start, outline.near_of, outline.shielded, inverted, outline.shape, parting,
        caught, np.zeros((pairs, 3), np.int64), np.zeros(1, np.int64),
    )  # fmt: skip
