"""Makes the block of a world, and makes it larger where a step wants more room."""

import functools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.collision.broad_phase import Candidates, new_boxes, new_grid, new_pairs
from sandbox.physics.collision.outline import colliders_of, outline_of
from sandbox.physics.collision.types import NOTHING_KEPT, KeptContacts, room_for, room_near, room_to_keep
from sandbox.physics.driving import drives_of
from sandbox.physics.flight import new_flight
from sandbox.physics.jit import bundle, contents, kernel
from sandbox.physics.joints.joint_set import joints_of
from sandbox.physics.joints.joint_sweep import joints_by_mass, new_joints, no_joints
from sandbox.physics.pipeline.block import COUNT, MAY_FLY, TICK, Coefficients, WorldBlock
from sandbox.physics.pipeline.collide import (
    BOUND,
    CROSSED,
    ENTRIES,
    KEPT,
    OVERLAPPING,
    Collisions,
    bound_terrain,
)
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.contact.free_constraints import new_work
from sandbox.physics.solvers.contact.free_islands import new_islands as new_free_islands
from sandbox.physics.solvers.contact.gauss_seidel import new_contact_constraints, no_blocks
from sandbox.physics.solvers.direct.islands import COLUMNS, NUMBERS, IslandWorkspace, new_blocks, new_islands
from sandbox.physics.solvers.direct.layout import layout_of
from sandbox.physics.solvers.direct.system import System
from sandbox.physics.solvers.iterative import Iteration, iteration_of
from sandbox.physics.solvers.single_pass import ExplicitPass, new_explicit_pass
from sandbox.physics.state import Slots, good_of, state_of
from sandbox.physics.untangling.crossing_candidates import new_shape_bounds
from sandbox.physics.untangling.inversion import new_inversions, triangles_of
from sandbox.physics.untangling.overlaps import new_overlaps
from sandbox.physics.untangling.triangle_clamp import world_triangles
from sandbox.physics.world import GRAB_COUNT, LAW_HOOKE, TRIANGLE, World

# What a step may find before it asks for more room, at least; and by how much more than it needs it then gets.
LEAST_ROOM = 64
MORE_ROOM = 2


@kernel
def _bound_terrain(lent: Any) -> None:
    world = contents(lent)
    bound_terrain(world.collisions)


@dataclass(eq=False)
class Block:
    """The block of a world, and the pointer that kernels take.

    settings: those that it holds. wanted: the largest counts of collisions so far. kept: the contacts of the last tick,
    the first of those in the block; they are the world's own, which so has them without a copy.
    """

    arrays: WorldBlock
    settings: WorldSettings
    wanted: Slots
    pointer: Any = None
    kept: KeptContacts = NOTHING_KEPT

    def begin(self, world: World) -> None:
        """Take over a world's settings and tick, and the contacts of its last step, where they are not those here."""
        if self.settings is not world.settings:
            if self.settings.solver != world.settings.solver:
                self.arrays = _with_solver(world, self.arrays)
                self.point()
            self.settings = world.settings
            _load_settings(self.settings, self.arrays)
        if world.contact_impulse is not self.kept.impulse and self._has_other_contacts(world):
            self._take_contacts(world)
        progress = self.arrays.progress
        progress[TICK], progress[MAY_FLY], progress[COUNT] = world.tick, world.may_fly, 0

    def _take_contacts(self, world: World) -> None:
        count = self.arrays.collisions.counts[KEPT] = len(world.contact_particle)
        if count > len(self.arrays.collisions.kept.particle):
            self._grow_collisions(world)
        kept = self.arrays.collisions.kept
        kept.particle[:count], kept.feature[:count] = world.contact_particle, world.contact_feature
        kept.impulse[:count], kept.impact[:count] = world.contact_impulse, world.contact_impact
        self._share_contacts(world)

    def grow(self, world: World) -> None:
        """Make the room that a step has found to be too little; the contacts of the last step stay."""
        counts, delassus = self.arrays.workspace.islands.counts, self.arrays.workspace.delassus
        numbers, columns = int(counts[NUMBERS]), int(counts[COLUMNS])
        if numbers > len(delassus.numbers) or columns > len(delassus.columns):
            numbers, columns = max(len(delassus.numbers), numbers), max(len(delassus.columns), columns)
            delassus = delassus._replace(numbers=np.zeros(MORE_ROOM * numbers), columns=np.zeros(MORE_ROOM * columns))
            self.arrays = self.arrays._replace(workspace=self.arrays.workspace._replace(delassus=delassus))
            self.point()
        else:
            self._grow_collisions(world)

    def _grow_collisions(self, world: World) -> None:
        old, workspace = self.arrays.collisions, self.arrays.workspace
        self.wanted = np.maximum(self.wanted, old.counts[:BOUND])
        made, count = _make_collisions(world, self.wanted), len(old.kept.particle)
        made.counts[:] = old.counts
        for name in KeptContacts._fields:
            getattr(made.kept, name)[:count] = getattr(old.kept, name)
        terms = new_contact_constraints(len(made.bound.particle), workspace.terms.surface)
        self.arrays = self.arrays._replace(collisions=made, workspace=workspace._replace(terms=terms))
        self.kept = NOTHING_KEPT
        self.point()

    def point(self) -> None:
        """Make the pointer anew, once arrays are others."""
        self.pointer = bundle(self.arrays)
        _bound_terrain(self.pointer)

    def end(self, world: World) -> None:
        """Make the contacts of a tick's last step those of the world's state."""
        if len(world.contact_impulse) != self.arrays.collisions.counts[KEPT] or (
            world.contact_impulse is not self.kept.impulse and self._has_other_contacts(world)
        ):
            self._share_contacts(world)

    def _has_other_contacts(self, world: World) -> bool:
        # Two arrays of nothing are the same.
        return len(world.contact_impulse) > 0 or bool(self.arrays.collisions.counts[KEPT] > 0)

    def _share_contacts(self, world: World) -> None:
        count = self.arrays.collisions.counts[KEPT]
        self.kept = KeptContacts._make([array[:count] for array in self.arrays.collisions.kept])
        world.keep_contacts(*self.kept)


def block_of(world: World) -> Block:
    """The block of a world, made again after a change of topology."""
    return world.derived(_make_block)


def _make_block(world: World) -> Block:
    wanted = np.full(BOUND, len(world.contact_particle))
    wanted[[CROSSED, OVERLAPPING]] = 0
    wanted[ENTRIES] = world.particle_count
    nothing, springs, constraints = _nothing(), world.spring_count, world.constraint_count
    collisions = _make_collisions(world, wanted)
    arrays = WorldBlock(
        state=state_of(world),
        good=good_of(world),
        numbers=np.zeros(7),
        choices=np.zeros(5, np.int64),
        plan=np.zeros(5, np.int64),
        progress=np.zeros(5, np.int64),
        start=np.zeros((world.particle_count, 2)),
        start_length=np.zeros(springs),
        shortest=np.zeros(GRAB_COUNT),
        coefficients=Coefficients(*np.zeros((2, springs)), *np.zeros((2, constraints))),
        drives=drives_of(world.actuators),
        limits=_limits_of(world),
        flight=new_flight(world.particle_count),
        collisions=collisions,
        joints=joints_of(world),
        triangles=world_triangles(world),
        system=nothing.system,
        workspace=nothing.workspace,
        iteration=nothing.iteration,
        explicit=nothing.explicit,
    )
    made = Block(_with_solver(world, arrays), world.settings, wanted)
    _load_settings(world.settings, made.arrays)
    made.point()
    return made


class _Solving(NamedTuple):
    """What is there for one solver, each part empty where another is set."""

    system: System
    workspace: IslandWorkspace
    iteration: Iteration
    explicit: ExplicitPass


@functools.cache
def _nothing() -> _Solving:
    world = World()
    system = layout_of(world).system
    workspace = IslandWorkspace(
        new_islands(system, 0), no_blocks(0, no_joints()), new_contact_constraints(0, np.zeros(0))
    )
    explicit = new_explicit_pass(world, no_joints(), world.spring_active)
    return _Solving(system, workspace, iteration_of(world), explicit)


def _with_solver(world: World, arrays: WorldBlock) -> WorldBlock:
    """A block with what the present solver of its world needs, and no other."""
    system, workspace, iteration, explicit = _nothing()
    rows, count, hooke = arrays.joints.rows, world.particle_count, world.spring_active & (world.law == LAW_HOOKE)
    if world.settings.solver == "direct":
        layout = layout_of(world)
        system = layout.system
        islands = new_islands(system, count)
        joints = new_joints(rows, islands.row, system.bodies.row_start, count)
        workspace = workspace._replace(islands=islands, delassus=new_blocks(count, system, joints))
    elif world.settings.solver == "iterative":
        iteration = iteration_of(world)
        workspace = workspace._replace(delassus=no_blocks(count, joints_by_mass(rows)))
    else:
        explicit = new_explicit_pass(world, joints_by_mass(rows), world.spring_active)
        workspace = workspace._replace(delassus=no_blocks(count, no_joints()))
    if world.settings.solver != "single_pass" and hooke.any():
        explicit = new_explicit_pass(world, no_joints(), hooke)
    terms = new_contact_constraints(len(arrays.collisions.bound.particle), np.zeros(count))
    arrays.plan[:] = (
        world.has_contacts, hooke.any(), (world.constraint_corners > TRIANGLE).any(), world.grab_particle,
        world.grab_spring,
    )  # fmt: skip
    return arrays._replace(
        system=system, workspace=workspace._replace(terms=terms), iteration=iteration, explicit=explicit
    )


def _load_settings(settings: WorldSettings, arrays: WorldBlock) -> None:
    highest = SOLVERS[settings.solver].highest
    arrays.numbers[:] = (*settings.gravity, *settings.wind, settings.drag, settings.warm_start, highest)
    arrays.choices[:] = settings.choices


def _limits_of(world: World) -> MaterialLimits:
    limits, count = world.limits, world.spring_count
    if not limits.exist:
        never = np.zeros(0)
        return MaterialLimits(never, never, never, never, np.zeros(0, np.bool_), np.zeros(0, np.int64))
    return MaterialLimits(
        limits.tension, limits.compression, limits.yielding, limits.yield_share, world.actuators.springs(count),
        np.zeros(count, np.int64),
    )  # fmt: skip


def _make_collisions(world: World, wanted: Slots) -> Collisions:
    """The collisions of a world with room for more than is wanted; of one in which nothing can touch, empty ones."""
    contacts, kept, entries, pairs, terrain_pairs, crossings, overlaps = (MORE_ROOM * wanted + LEAST_ROOM).tolist()
    contacts = max(contacts, kept)
    if not world.has_contacts:
        return _no_collisions()._replace(kept=room_to_keep(contacts), counts=np.zeros(BOUND + 1, np.int64))
    outline, triangles, particles = outline_of(world), world.derived(triangles_of), world.particle_count
    objects = particles + int(outline.dynamic[0])
    boxes, shapes = new_boxes(particles, objects), len(outline.solid_of)
    return Collisions(
        outline=outline,
        triangles=triangles,
        colliders=colliders_of(world, outline, overlaps),
        boxes=boxes,
        grid=new_grid(objects, entries),
        candidates=Candidates(new_pairs(particles, pairs), new_pairs(particles, terrain_pairs), boxes.box),
        bounds=np.zeros((len(outline.solid), 5)),
        near=room_near(),
        contacts=room_for(contacts),
        bound=room_for(contacts),
        kept=room_to_keep(contacts),
        islands=new_free_islands(particles, contacts),
        work=new_work(particles, contacts),
        inversions=new_inversions(triangles),
        shape_bounds=new_shape_bounds(shapes),
        overlaps=new_overlaps(shapes, crossings, overlaps),
        moved=np.zeros(particles, np.bool_),
        counts=np.zeros(BOUND + 1, np.int64),
    )


@functools.cache
def _no_collisions() -> Collisions:
    world = World()
    world.add_particles(["a"], [[0.0, 0.0]], collides=1)
    return _make_collisions(world, np.zeros(BOUND, np.int64))
