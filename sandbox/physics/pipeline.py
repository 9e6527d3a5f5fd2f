"""Collisions of a step, in two entries: `_collide` before a solver moves bodies, `_finish` after it.

The first finds what touches and solves what no spring holds; the second keeps the contacts for the next step, holds
particles out of terrain and moves them. Where no spring holds anything, the first is the whole tick. Their arrays are
made when the topology changes. Those whose length a step decides have room for more than there is; a kernel that finds
too little says so, and is called again with more.
"""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.collision.broad_phase import (
    Boxes,
    Candidates,
    Grid,
    cell_size,
    fill_grid,
    find_pairs,
    new_boxes,
    new_grid,
    new_pairs,
)
from sandbox.physics.collision.contacts import bound_solids, carry_over, fill_boxes, find_contacts, find_terrain
from sandbox.physics.collision.disc_stop import stop_discs
from sandbox.physics.collision.outline import Outline, colliders_of, outline_of
from sandbox.physics.collision.restitution import find_bounces
from sandbox.physics.collision.terrain_clamp import clamp_at_pins, clamp_at_terrain, clamp_at_tips
from sandbox.physics.collision.turning import SURFACE_WEIGHT, load_arms
from sandbox.physics.collision.types import (
    NO_CONTACTS,
    NOTHING_KEPT,
    Colliders,
    Contacts,
    Flags,
    KeptContacts,
    LentContacts,
    Near,
    room_for,
    room_near,
    room_to_keep,
)
from sandbox.physics.forces import Forces, add_gravity_and_air, forces_of
from sandbox.physics.integrate import advance, follow, turn
from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.sanitise import LOST, UNSOUND, CheckedArrays, are_sound, checked_arrays, keep_if_sound
from sandbox.physics.solvers.contact.free_constraints import FreeContactScratch, new_work
from sandbox.physics.solvers.contact.free_contacts import solve_free_contacts
from sandbox.physics.solvers.contact.free_islands import Islands, find_islands, new_islands, sort_free_contacts
from sandbox.physics.solvers.contact.small_steps import small_steps
from sandbox.physics.state import Floats, Slots
from sandbox.physics.substeps import Cadence
from sandbox.physics.terrain import Terrain
from sandbox.physics.untangling.crossing_candidates import ShapeBounds, new_shape_bounds
from sandbox.physics.untangling.inversion import Inversions, Triangles, find_inverted, new_inversions, triangles_of
from sandbox.physics.untangling.overlaps import (
    CROSSINGS,
    OVERLAPS,
    Overlaps,
    find_crossings,
    new_overlaps,
    pair_overlaps,
)
from sandbox.physics.untangling.parting import MovedParticles, part_overlaps
from sandbox.physics.world import World

# What a step may find before it asks for more room, at least; and by how much more than it needs it then gets.
LEAST_ROOM = 64
MORE_ROOM = 2
# Places in `counts`: contacts of the present step and of the last, entries of the grid, pairs by boxes, with terrain,
# crossings of outlines, pairs of shapes that overlap; substeps that are done of a tick of free particles.
CONTACTS, KEPT, ENTRIES, PAIRS, TERRAIN_PAIRS, CROSSED, OVERLAPPING, DONE = range(8)
# Rounds in which edges are stopped at corners of terrain, and particles at terrain; the latter has the last word.
TIP_ROUNDS = 4
# What `_collide` returns in place of a number of contacts where there is too little room.
NO_ROOM = -1


class CollidingParticles(NamedTuple):
    """The arrays of a world that collisions read and change, see StateArrays."""

    position: Floats
    velocity: Floats
    slow_velocity: Floats
    slow_change: Floats
    origin: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    friction: Floats
    restitution: Floats
    group: Slots
    collides: Slots
    particle_active: Flags
    energy_bank: Floats
    parting_reserve: Floats
    angle: Floats
    spin: Floats
    rolls: Flags
    rolling: Floats
    constraint_rest: Floats


class CollisionScratch(NamedTuple):
    """Arrays that a step fills in. bounds (k, 5): see bound_solids. bound: the contacts that are left to a solver.

    moved (n,): scratch.
    """

    boxes: Boxes
    grid: Grid
    candidates: Candidates
    bounds: Floats
    near: Near
    contacts: Contacts
    bound: Contacts
    kept: KeptContacts
    islands: Islands
    work: FreeContactScratch
    inversions: Inversions
    shape_bounds: ShapeBounds
    overlaps: Overlaps
    moved: Flags
    counts: Slots


@inner_kernel
def _load_particles(particles: CollidingParticles, attached: Flags, colliders: Colliders) -> None:
    for p in range(particles.radius.shape[0]):
        for axis in range(2):
            colliders.position[p, axis] = particles.position[p, axis]
            colliders.velocity[p, axis] = particles.velocity[p, axis]
            colliders.origin[p, axis] = particles.origin[p, axis]
        colliders.radius[p] = particles.radius[p]
        colliders.friction[p] = particles.friction[p]
        colliders.restitution[p] = particles.restitution[p]
        colliders.group[p] = particles.group[p]
        colliders.collides[p] = particles.collides[p] if particles.particle_active[p] else 0
        colliders.inverse_mass[p] = particles.inverse_mass[p]
        colliders.rolling[p] = particles.rolling[p]
        turns = particles.rolls[p] and not attached[p] and particles.radius[p] > 0.0
        colliders.turning[p] = SURFACE_WEIGHT * particles.inverse_mass[p] if turns else 0.0


@kernel
def _bound_terrain(items: Any) -> None:
    # What is solid of terrain stays where it is.
    _, outline, _, _, colliders, room, _, _ = contents(items)
    bound_solids(colliders, outline, outline.dynamic[1], outline.solid.shape[0], room.bounds)


@inner_kernel
def _find_overlaps(outline: Outline, colliders: Colliders, room: CollisionScratch, larges: int) -> bool:
    # Which bodies part in this step; whether there is room for them.
    overlaps = room.overlaps
    room.counts[CROSSED] = find_crossings(
        room.boxes, room.grid, larges, colliders, outline, room.shape_bounds, overlaps
    )  # fmt: skip
    if overlaps.counts[CROSSINGS] > overlaps.edge.shape[0]:
        return False
    room.counts[OVERLAPPING] = pair_overlaps(
        colliders, outline, room.bounds, room.kept, room.counts[KEPT], overlaps
    )  # fmt: skip
    return room.counts[OVERLAPPING] <= overlaps.shape.shape[0]


@inner_kernel
def _detect(
    particles: CollidingParticles, outline: Outline, terrain: Terrain, triangles: Triangles, colliders: Colliders,
    room: CollisionScratch, tick: int, h: float,
) -> int:  # fmt: skip
    # Broad and narrow phase: the contacts of the step, but for bounces and impulses; their number, or NO_ROOM.
    _load_particles(particles, outline.attached, colliders)
    if triangles.constraint.shape[0] > 0:
        find_inverted(
            particles.position, particles.constraint_rest, triangles, room.inversions, colliders.inverted
        )  # fmt: skip
    fill_boxes(colliders, outline.dynamic[0], h, room.boxes)
    cell = cell_size(room.boxes.box)
    larges, entries = fill_grid(room.boxes, cell, room.grid)
    room.counts[ENTRIES] = entries
    if entries > room.grid.object.shape[0]:
        return NO_ROOM
    pairs, terrain_pairs = room.candidates.pairs, room.candidates.terrain
    room.counts[PAIRS] = find_pairs(room.boxes, room.grid, larges, pairs)
    room.counts[TERRAIN_PAIRS] = find_terrain(room.boxes, terrain, terrain_pairs)
    if room.counts[PAIRS] > pairs.other.shape[0] or room.counts[TERRAIN_PAIRS] > terrain_pairs.other.shape[0]:
        return NO_ROOM
    bound_solids(colliders, outline, 0, outline.dynamic[1], room.bounds)
    if not _find_overlaps(outline, colliders, room, larges):
        return NO_ROOM
    count = find_contacts(
        colliders, outline, room.candidates, room.bounds, room.near,
        room.kept, room.counts[KEPT], tick, h, room.contacts, terrain,
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
            to.rolling[k] = contacts.rolling[c]
            for axis in range(2):
                to.normal[k, axis] = contacts.normal[c, axis]
                to.impulse[k, axis] = contacts.impulse[c, axis]
            k += 1


@inner_kernel
def _before_solver(
    particles: CollidingParticles, outline: Outline, terrain: Terrain, triangles: Triangles, colliders: Colliders,
    room: CollisionScratch, start: Floats, tick: int, h: float,
) -> int:  # fmt: skip
    # Find contacts and solve the free ones; how many are left to a solver, or NO_ROOM.
    count = _detect(particles, outline, terrain, triangles, colliders, room, tick, h)
    if count == NO_ROOM:
        return count
    contacts = room.contacts
    if room.overlaps.counts[OVERLAPS] > 0:
        moved = MovedParticles(
            particles.velocity, start, particles.mass, particles.inverse_mass, particles.energy_bank,
            particles.parting_reserve,
        )  # fmt: skip
        part_overlaps(outline, colliders, room.bounds, moved, room.overlaps, room.moved)
    find_bounces(contacts, count, start, particles.velocity, outline.attached, h, h / small_steps(h))
    carry_over(contacts, count, room.kept, room.counts[KEPT])
    bound = find_islands(contacts, count, particles.inverse_mass, outline.attached, room.islands)
    found = sort_free_contacts(count, room.islands) if bound < count else 0
    solve_free_contacts(
        contacts, room.islands, found, colliders, start, particles.velocity, particles.spin, h, room.work
    )
    if bound > 0:
        _copy_bound(contacts, count, room.islands.bound, room.bound)
        load_arms(room.bound, bound, colliders)
    return bound


@inner_kernel
def _after_solver(
    particles: CollidingParticles, terrain: Terrain, room: CollisionScratch, moves: bool, h: float
) -> int:  # fmt: skip
    # Keep the contacts, clamp at terrain, move if asked to; how many contacts there are.
    contacts = room.contacts
    count = room.counts[CONTACTS]
    k = 0
    for c in range(count):
        if room.islands.bound[c]:
            contacts.impulse[c, 0], contacts.impulse[c, 1] = room.bound.impulse[k, 0], room.bound.impulse[k, 1]
            if room.bound.bounce[k] >= 0.0:
                # The impulse of an impact is no guess of what the next step needs.
                contacts.impact[c] += room.bound.impulse[k, 0]
                contacts.impulse[c, 0], contacts.impulse[c, 1] = 0.0, 0.0
            k += 1
        room.kept.particle[c] = contacts.particle[c]
        room.kept.feature[c] = contacts.feature[c]
        room.kept.impulse[c, 0] = contacts.impulse[c, 0]
        room.kept.impulse[c, 1] = contacts.impulse[c, 1]
        room.kept.impact[c] = contacts.impact[c]
    room.counts[KEPT] = count
    ahead = room.work.ahead
    clamp_at_terrain(
        particles.position, particles.velocity, ahead, particles.collides, particles.particle_active,
        particles.inverse_mass, terrain, room.boxes.box, room.candidates.terrain.start, h,
    )  # fmt: skip
    for p in range(ahead.shape[0]):
        particles.position[p, 0] += ahead[p, 0]
        particles.position[p, 1] += ahead[p, 1]
    if moves:
        advance(particles.position, particles.velocity, particles.particle_active, h)
        turn(particles.angle, particles.spin, h)
    return count


@kernel
def _collide(items: Any, first: int, last: int, tracks_slow_velocity: bool, tick: int, h: float) -> int:
    # last 0: what comes before the solver of a substep, forces included if first is 0; how many contacts are left to
    # it. Else substeps first..last of a tick in which nothing is held, and what is to come before and after them; how
    # many contacts there are.
    particles, outline, terrain, triangles, colliders, room, forced, checked = contents(items)
    if last > 0 and first == 0:
        if not are_sound(checked, room.kept.impulse, room.kept.impact, room.counts[KEPT]):
            return UNSOUND
        for c in range(room.counts[KEPT]):
            room.kept.impact[c] = 0.0
    substep = first
    while True:
        if last > 0 or first == 0:
            add_gravity_and_air(forced, h)
        bound = _before_solver(particles, outline, terrain, triangles, colliders, room, forced.start, tick, h)
        if last == 0:
            return bound
        if bound == NO_ROOM:
            for p in range(forced.start.shape[0]):
                particles.velocity[p, 0] = forced.start[p, 0]
                particles.velocity[p, 1] = forced.start[p, 1]
            room.counts[DONE] = substep
            return NO_ROOM
        if tracks_slow_velocity:
            follow(particles.velocity, particles.slow_velocity, particles.slow_change, particles.particle_active)
        count = _after_solver(particles, terrain, room, True, h)
        substep += 1
        if substep == last:
            return count if keep_if_sound(checked) else LOST


@kernel
def _finish(items: Any, moves: bool, h: float) -> int:
    particles, outline, terrain, _, colliders, room, _, _ = contents(items)
    if outline.dynamic[1] > 0:
        stop_discs(
            room.contacts, room.counts[CONTACTS], outline, colliders, particles.velocity,
            particles.mass, particles.inverse_mass, h,
        )  # fmt: skip
    clamp_at_pins(
        particles.position, particles.velocity, room.work.ahead, particles.inverse_mass, outline, colliders,
        room.boxes.box, room.candidates.pairs.start, h,
    )  # fmt: skip
    for k in range(TIP_ROUNDS):
        if not clamp_at_tips(
            particles.velocity, particles.inverse_mass, terrain, outline.dynamic[0], colliders, k == TIP_ROUNDS - 1, h
        ):
            break
        clamp_at_terrain(
            particles.position, particles.velocity, room.work.ahead, particles.collides, particles.particle_active,
            particles.inverse_mass, terrain, room.boxes.box, room.candidates.terrain.start, h,
        )  # fmt: skip
    return _after_solver(particles, terrain, room, moves, h)


@dataclass(eq=False)
class Collisions:
    """Scratch of a world's collisions: arrays that follow from topology, arrays that a step fills in, and one bundle.

    is_free: whether no spring or constraint holds anything. wanted: the largest counts so far. solved: those
    left to a solver, by their number. kept: the contacts of the last tick, the first of those in room; they are the
    world's own, which so has them without a copy. cadence: that of the last tick in which nothing was held.
    """

    particles: CollidingParticles
    outline: Outline
    terrain: Terrain
    triangles: Triangles
    colliders: Colliders
    room: CollisionScratch
    forces: Forces
    checked: CheckedArrays
    is_free: bool
    wanted: Slots
    items: Any = None
    solved: dict[int, LentContacts] = field(default_factory=dict)
    kept: KeptContacts = NOTHING_KEPT
    count: int = 0
    cadence: Cadence | None = None

    def begin(self, world: World) -> None:
        """Take over the contacts of the world's last step, where they are not those of the last tick already."""
        if world.contact_impulse is self.kept.impulse:
            return
        self.count = self.room.counts[KEPT] = len(world.contact_particle)
        if self.count > len(self.room.kept.particle):
            _grow(self)
        room = self.room.kept
        room.particle[: self.count] = world.contact_particle
        room.feature[: self.count] = world.contact_feature
        room.impulse[: self.count] = world.contact_impulse
        room.impact[: self.count] = world.contact_impact
        _share_kept(world, self)

    def forget_impacts(self) -> None:
        """Begin a tick, in which no impact has happened yet."""
        self.room.kept.impact[: self.count] = 0.0

    def collide(self, has_begun: bool, tick: int, h: float) -> LentContacts | None:
        """Find the contacts of a step of h [s] and solve those of free particles; the others, returned, are a solver's.

        None: there are no others. has_begun: forces have acted already; otherwise they act now.
        """
        count = _collide(self.items, 1 if has_begun else 0, 0, False, tick, h)
        while count == NO_ROOM:
            _grow(self)
            count = _collide(self.items, 1, 0, False, tick, h)
        if count and count not in self.solved:
            arrays = Contacts._make([array[:count] for array in self.room.bound])
            self.solved[count] = LentContacts(arrays, bundle((arrays,)))
        return self.solved[count] if count else None

    def step_free(self, substeps: int, tracks_slow_velocity: bool, tick: int, h: float) -> int:
        """A tick of substeps of h [s], forces included, of a world in which no spring or constraint holds anything.

        What it begins with is looked at, and what it ends with kept as good: UNSOUND, LOST, or how many contacts there
        are. tracks_slow_velocity: whether the solver keeps the slow part of velocities, the only thing that is left to
        it.
        """
        count = _collide(self.items, 0, substeps, tracks_slow_velocity, tick, h)
        while count == NO_ROOM:
            _grow(self)
            count = _collide(self.items, int(self.room.counts[DONE]), substeps, tracks_slow_velocity, tick, h)
        self.count = count if count >= 0 else int(self.room.counts[KEPT])
        return count

    def touched(self) -> Slots:
        """The particles that contacts of the present step push."""
        count = int(self.room.counts[CONTACTS])
        contacts, bound = self.room.contacts, self.room.islands.bound[:count]
        pushes = contacts.impulse[:count, 0] > 0.0
        pushes[np.flatnonzero(bound)] = self.room.bound.impulse[: int(bound.sum()), 0] > 0.0
        ends = [array[:count][pushes] for array in (contacts.particle, contacts.end_a, contacts.end_b)]
        slots = np.concatenate(ends).astype(np.int64)
        return slots[slots >= 0]

    def finish(self, h: float, moves: bool) -> None:
        """Keep a step's contacts with their impulses, stop what would cross terrain, and move particles over h [s].

        moves: False leaves the last to what follows.
        """
        self.count = _finish(self.items, moves, h)

    def end(self, world: World) -> None:
        """Make the contacts of a tick's last step those of the world's state."""
        if self.count != len(self.kept.particle) or self.kept is NOTHING_KEPT:
            _share_kept(world, self)


def collisions_of(world: World) -> Collisions | None:
    """The scratch of a world's collisions, made again after a change of topology; None: nothing can touch."""
    return world.derived(_make_collisions)


def _make_collisions(world: World) -> Collisions | None:
    if not world.has_contacts:
        return None
    outline, triangles = outline_of(world), world.derived(triangles_of)
    particles = CollidingParticles._make([getattr(world, name) for name in CollidingParticles._fields])
    wanted = np.full(DONE, len(world.contact_particle))
    wanted[[CROSSED, OVERLAPPING]] = 0
    wanted[ENTRIES] = world.particle_count
    made = Collisions(
        particles, outline, world.terrain, triangles, colliders_of(world, outline, _room(wanted)[OVERLAPPING]),
        _make_room(outline, triangles, wanted), forces_of(world), checked_arrays(world), not outline.attached.any(),
        wanted,
    )  # fmt: skip
    _bundle_up(made)
    return made


def _room(wanted: Slots) -> list[int]:
    return (MORE_ROOM * wanted + LEAST_ROOM).tolist()


def _make_room(outline: Outline, triangles: Triangles, wanted: Slots) -> CollisionScratch:
    particles = len(outline.attached)
    objects = particles + int(outline.dynamic[0])
    contacts, kept, entries, pairs, terrain_pairs, crossings, overlaps = _room(wanted)
    contacts, boxes = max(contacts, kept), new_boxes(particles, objects)
    candidates = Candidates(new_pairs(particles, pairs), new_pairs(particles, terrain_pairs), boxes.box)
    return CollisionScratch(
        boxes, new_grid(objects, entries), candidates, np.zeros((len(outline.solid), 5)), room_near(),
        room_for(contacts), room_for(contacts), room_to_keep(contacts), new_islands(particles, contacts),
        new_work(particles, contacts), new_inversions(triangles), new_shape_bounds(len(outline.solid_of)),
        new_overlaps(len(outline.solid_of), crossings, overlaps), np.zeros(particles, np.bool_),
        np.zeros(DONE + 1, np.int64),
    )  # fmt: skip


def _bundle_up(made: Collisions) -> None:
    made.items = bundle((
        made.particles, made.outline, made.terrain, made.triangles, made.colliders, made.room, made.forces.particles,
        made.checked,
    ))  # fmt: skip
    _bound_terrain(made.items)


def _grow(collisions: Collisions) -> None:
    """Give a step the room that it has found to be too little; the contacts kept of the last step stay."""
    old = collisions.room
    collisions.wanted = np.maximum(collisions.wanted, old.counts[:DONE])
    collisions.room = _make_room(collisions.outline, collisions.triangles, collisions.wanted)
    parted = np.zeros((len(collisions.room.overlaps.shape), 3), np.int64)
    collisions.colliders = collisions.colliders._replace(parted=parted)
    collisions.room.counts[:] = old.counts
    count = len(old.kept.particle)
    new = collisions.room.kept
    new.particle[:count], new.feature[:count], new.impulse[:count], new.impact[:count] = old.kept
    collisions.solved, collisions.kept = {}, NOTHING_KEPT
    _bundle_up(collisions)


def _share_kept(world: World, collisions: Collisions) -> None:
    count = collisions.count
    collisions.kept = KeptContacts._make([array[:count] for array in collisions.room.kept])
    world.keep_contacts(*collisions.kept)


def last_contacts(world: World) -> Contacts:
    """A copy of the contacts of the world's last step; none where topology has changed since."""
    collisions = collisions_of(world)
    if collisions is None:
        return NO_CONTACTS
    return Contacts._make([array[: collisions.room.counts[CONTACTS]].copy() for array in collisions.room.contacts])
