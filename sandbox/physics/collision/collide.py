"""Collisions of a step, in two entries: `collide` before a solver moves bodies, `finish` after it.

The first finds what touches and solves what no spring holds; the second keeps the contacts for the next step, holds
particles out of terrain and moves them. Their arrays are made when the topology changes. Those whose length a step
decides have room for more than there is; a kernel that finds too little says so, and is called again with more.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.broad_phase import (
    Boxes,
    Grid,
    Pairs,
    cell_size,
    fill_grid,
    find_pairs,
    new_boxes,
    new_grid,
    new_pairs,
)
from sandbox.physics.collision.contacts import bound_solids, carry_over, fill_boxes, find_contacts, find_terrain
from sandbox.physics.collision.inversion import Inversions, Triangles, find_inverted, new_inversions, triangles_of
from sandbox.physics.collision.outline import Outline, colliders_of, outline_of
from sandbox.physics.collision.restitution import find_bounces
from sandbox.physics.collision.terrain_clamp import clamp_at_terrain
from sandbox.physics.collision.types import (
    NO_CONTACTS,
    Colliders,
    Contacts,
    Flags,
    KeptContacts,
    Near,
    room_for,
    room_near,
    room_to_keep,
)
from sandbox.physics.integrate import advance
from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.solvers.contact.free_contacts import Work, new_work, solve_free_contacts
from sandbox.physics.solvers.contact.free_islands import Islands, find_islands, new_islands, sort_free_contacts
from sandbox.physics.state import Floats, Slots
from sandbox.physics.terrain import Terrain
from sandbox.physics.world import World

# What a step may find before it asks for more room, at least; and by how much more than it needs it then gets.
LEAST_ROOM = 64
MORE_ROOM = 2
# Places in `counts`: contacts of the present step and of the last, entries of the grid, pairs by boxes, with terrain.
CONTACTS, KEPT, ENTRIES, PAIRS, TERRAIN_PAIRS = range(5)
# What `_collide` returns where there is too little room.
NO_ROOM = -1


class CollidingParticles(NamedTuple):
    """The arrays of a world that collisions read and change, see StateArrays."""

    position: Floats
    velocity: Floats
    origin: Floats
    inverse_mass: Floats
    radius: Floats
    friction: Floats
    restitution: Floats
    group: Slots
    collides: Slots
    particle_active: Flags
    element_rest: Floats


class CollisionRoom(NamedTuple):
    """What a step fills in. bounds (k, 5): see bound_solids. bound: the contacts that are left to a solver."""

    boxes: Boxes
    grid: Grid
    pairs: Pairs
    terrain_pairs: Pairs
    bounds: Floats
    near: Near
    contacts: Contacts
    bound: Contacts
    kept: KeptContacts
    islands: Islands
    work: Work
    inversions: Inversions
    counts: Slots


@inner_kernel
def _load_particles(particles: CollidingParticles, colliders: Colliders) -> None:
    # What stays as it is in a tick.
    for p in range(particles.radius.shape[0]):
        for axis in range(2):
            colliders.origin[p, axis] = particles.origin[p, axis]
        colliders.radius[p] = particles.radius[p]
        colliders.friction[p] = particles.friction[p]
        colliders.restitution[p] = particles.restitution[p]
        colliders.group[p] = particles.group[p]
        colliders.collides[p] = particles.collides[p] if particles.particle_active[p] else 0
        colliders.inverse_mass[p] = particles.inverse_mass[p]


@kernel
def _begin(items: Any, particle: NDArray[np.int32], feature: Slots, impulse: Floats) -> bool:
    # Load what stays in a tick, and the contacts kept from the last one; whether there is room.
    particles, outline, _, _, colliders, room = contents(items)
    _load_particles(particles, colliders)
    bound_solids(colliders, outline, outline.dynamic[1], outline.solid.shape[0], room.bounds)
    room.counts[KEPT] = particle.shape[0]
    if particle.shape[0] > room.kept.particle.shape[0]:
        room.counts[CONTACTS] = particle.shape[0]
        return False
    for c in range(particle.shape[0]):
        room.kept.particle[c] = particle[c]
        room.kept.feature[c] = feature[c]
        room.kept.impulse[c, 0] = impulse[c, 0]
        room.kept.impulse[c, 1] = impulse[c, 1]
    return True


@inner_kernel
def _detect(
    particles: CollidingParticles, outline: Outline, terrain: Terrain, triangles: Triangles, colliders: Colliders,
    room: CollisionRoom, tick: int, h: float,
) -> int:  # fmt: skip
    # Broad and narrow phase: the contacts of the step, but for bounces and impulses; their number, or NO_ROOM.
    for p in range(particles.radius.shape[0]):
        for axis in range(2):
            colliders.position[p, axis] = particles.position[p, axis]
            colliders.velocity[p, axis] = particles.velocity[p, axis]
    if triangles.element.shape[0] > 0:
        find_inverted(
            particles.position, particles.element_rest, triangles, room.inversions, colliders.inverted
        )  # fmt: skip
    fill_boxes(colliders, outline.dynamic[0], h, room.boxes)
    cell = cell_size(room.boxes.box)
    larges, entries = fill_grid(room.boxes, cell, room.grid)
    room.counts[ENTRIES] = entries
    if entries > room.grid.object.shape[0]:
        return NO_ROOM
    room.counts[PAIRS] = find_pairs(room.boxes, room.grid, larges, room.pairs)
    room.counts[TERRAIN_PAIRS] = find_terrain(room.boxes, terrain, room.terrain_pairs)
    if room.counts[PAIRS] > room.pairs.other.shape[0] or room.counts[TERRAIN_PAIRS] > room.terrain_pairs.other.shape[0]:
        return NO_ROOM
    bound_solids(colliders, outline, 0, outline.dynamic[1], room.bounds)
    count = find_contacts(
        colliders, outline, room.pairs, room.terrain_pairs, room.bounds, room.near, room.kept, room.counts[KEPT], tick,
        h, room.contacts,
    )  # fmt: skip
    room.counts[CONTACTS] = count
    return count if count <= room.contacts.particle.shape[0] else NO_ROOM


@inner_kernel
def _copy_bound(contacts: Contacts, count: int, bound: Flags, to: Contacts) -> None:
    # The contacts that are bound, in their order.
    k = 0
    for c in range(count):
        if bound[c]:
            to.particle[k] = contacts.particle[c]
            to.feature[k] = contacts.feature[c]
            to.end_a[k] = contacts.end_a[c]
            to.end_b[k] = contacts.end_b[c]
            to.share[k] = contacts.share[c]
            to.gap[k] = contacts.gap[c]
            to.friction[k] = contacts.friction[c]
            to.restitution[k] = contacts.restitution[c]
            to.bounce[k] = contacts.bounce[c]
            for axis in range(2):
                to.normal[k, axis] = contacts.normal[c, axis]
                to.impulse[k, axis] = contacts.impulse[c, axis]
            k += 1


@kernel
def _collide(items: Any, start: Floats, tick: int, h: float) -> int:
    # Everything before the solver; how many contacts are left to it, or NO_ROOM.
    particles, outline, terrain, triangles, colliders, room = contents(items)
    count = _detect(particles, outline, terrain, triangles, colliders, room, tick, h)
    if count == NO_ROOM:
        return count
    contacts = room.contacts
    find_bounces(contacts, count, start, particles.velocity, h)
    carry_over(contacts, count, room.kept, room.counts[KEPT])
    bound = find_islands(contacts, count, particles.inverse_mass, outline.held, room.islands)
    found = sort_free_contacts(count, room.islands) if bound < count else 0
    solve_free_contacts(
        contacts, room.islands, found, particles.inverse_mass, particles.radius, start, particles.velocity, h, room.work
    )
    if bound > 0:
        _copy_bound(contacts, count, room.islands.bound, room.bound)
    return bound


@kernel
def _finish(items: Any, h: float) -> None:
    particles, _, terrain, _, _, room = contents(items)
    contacts = room.contacts
    count = room.counts[CONTACTS]
    k = 0
    for c in range(count):
        if room.islands.bound[c]:
            contacts.impulse[c, 0] = room.bound.impulse[k, 0]
            contacts.impulse[c, 1] = room.bound.impulse[k, 1]
            k += 1
        room.kept.particle[c] = contacts.particle[c]
        room.kept.feature[c] = contacts.feature[c]
        room.kept.impulse[c, 0] = contacts.impulse[c, 0]
        room.kept.impulse[c, 1] = contacts.impulse[c, 1]
    room.counts[KEPT] = count
    ahead = room.work.ahead
    clamp_at_terrain(
        particles.position, particles.velocity, ahead, particles.collides, particles.particle_active,
        particles.inverse_mass, terrain, h,
    )  # fmt: skip
    for p in range(ahead.shape[0]):
        particles.position[p, 0] += ahead[p, 0]
        particles.position[p, 1] += ahead[p, 1]
    advance(particles.position, particles.velocity, particles.particle_active, h)


@kernel
def _end(items: Any, particle: NDArray[np.int32], feature: Slots, impulse: Floats) -> None:
    _, _, _, _, _, room = contents(items)
    for c in range(particle.shape[0]):
        particle[c] = room.kept.particle[c]
        feature[c] = room.kept.feature[c]
        impulse[c, 0] = room.kept.impulse[c, 0]
        impulse[c, 1] = room.kept.impulse[c, 1]


@dataclass(eq=False)
class Collision:
    """The scratch of a world's collisions: what topology decides, what a step fills in, and all as one argument.

    wanted: the largest counts so far. solved: the contacts that the last step left to a solver.
    """

    particles: CollidingParticles
    outline: Outline
    terrain: Terrain
    triangles: Triangles
    colliders: Colliders
    room: CollisionRoom
    wanted: Slots
    items: Any
    solved: Contacts


def collision_of(world: World) -> Collision:
    """The scratch of a world's collisions, made anew where topology has changed."""
    return world.derived(_make_collision)


def _make_collision(world: World) -> Collision:
    outline, triangles = outline_of(world), triangles_of(world)
    particles = CollidingParticles._make([getattr(world, name) for name in CollidingParticles._fields])
    wanted = np.full(5, len(world.contact_particle))
    wanted[ENTRIES] = world.particle_count
    room = _make_room(outline, triangles, wanted)
    made = Collision(
        particles, outline, world.terrain, triangles, colliders_of(world, outline), room, wanted, None, NO_CONTACTS
    )
    made.items = _bundled(made)
    return made


def _bundled(of: Collision) -> Any:
    return bundle((of.particles, of.outline, of.terrain, of.triangles, of.colliders, of.room))


def _make_room(outline: Outline, triangles: Triangles, wanted: Slots) -> CollisionRoom:
    particles = len(outline.held)
    objects = particles + int(outline.dynamic[0])
    contacts, kept, entries, pairs, terrain_pairs = (MORE_ROOM * wanted + LEAST_ROOM).tolist()
    contacts = max(contacts, kept)
    return CollisionRoom(
        new_boxes(particles, objects), new_grid(objects, entries), new_pairs(particles, pairs),
        new_pairs(particles, terrain_pairs), np.zeros((len(outline.solid), 5)), room_near(), room_for(contacts),
        room_for(contacts), room_to_keep(contacts), new_islands(particles, contacts), new_work(particles, contacts),
        new_inversions(triangles), np.zeros(5, np.int64),
    )  # fmt: skip


def _grow(collision: Collision) -> None:
    """Give a step the room that it has found to be too little; the contacts kept of the last step stay."""
    old = collision.room
    collision.wanted = np.maximum(collision.wanted, old.counts)
    collision.room = _make_room(collision.outline, collision.triangles, collision.wanted)
    collision.room.counts[:] = old.counts
    for new, kept in zip(collision.room.kept, old.kept, strict=True):
        new[: len(kept)] = kept
    collision.solved = NO_CONTACTS
    collision.items = _bundled(collision)


def begin_collisions(world: World) -> Collision:
    """Load what a tick's collisions need of the world: its particles, and the contacts of its last step."""
    collision = collision_of(world)
    while not _begin(collision.items, world.contact_particle, world.contact_feature, world.contact_impulse):
        _grow(collision)
    return collision


def collide(collision: Collision, start: Floats, tick: int, h: float) -> Contacts:
    """Find the contacts of a step of h [s] and solve those of free particles; the others, returned, are a solver's.

    start [m/s] (n, 2): the velocities before gravity and all else from outside.
    """
    count = _collide(collision.items, start, tick, h)
    while count == NO_ROOM:
        _grow(collision)
        count = _collide(collision.items, start, tick, h)
    if count != len(collision.solved.particle):
        collision.solved = Contacts._make([array[:count] for array in collision.room.bound]) if count else NO_CONTACTS
    return collision.solved


def finish(collision: Collision, h: float) -> None:
    """Keep a step's contacts with their impulses, stop what would cross terrain, and move particles over h [s]."""
    _finish(collision.items, h)


def end_collisions(world: World, collision: Collision) -> None:
    """Make the contacts of a tick's last step a part of the world's state."""
    count = int(collision.room.counts[KEPT])
    if count != len(world.contact_particle):
        world.keep_contacts(np.zeros(count, np.int32), np.zeros(count, np.int64), np.zeros((count, 2)))
    _end(collision.items, world.contact_particle, world.contact_feature, world.contact_impulse)


def last_contacts(world: World) -> Contacts:
    """A copy of the contacts of the world's last step; none where topology has changed since."""
    room = collision_of(world).room
    return Contacts._make([array[: room.counts[CONTACTS]].copy() for array in room.contacts])
