"""Makes the block of a world, and makes it larger where a step wants more room."""

import functools
from collections.abc import Callable
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
from sandbox.physics.joints.rows import JointRows
from sandbox.physics.pipeline.block import CHECKED, COUNT, MAY_FLY, PROGRESS, TICK, Coefficients, WorldBlock
from sandbox.physics.pipeline.collide import (
    BOUND,
    CONTACTS,
    ENTRIES,
    KEPT,
    Collisions,
    bound_terrain,
)
from sandbox.physics.settings import WorldSettings
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


class Block:
    """The block of a world, which follows its topology and settings, and the pointer that kernels take.

    wanted: the largest counts of collisions so far. kept: the contacts of the last tick, the first of those in the
    block; they are the world's own, which so has them without a copy.
    """

    arrays: WorldBlock
    pointer: Any = None

    def __init__(self, world: World) -> None:
        self.wanted = np.zeros(BOUND, np.int64)
        self.kept = NOTHING_KEPT
        self._room = _Room(0, 0)
        self._scratch: dict[Callable[..., Any], tuple[tuple[int, ...], dict[str, Any]]] = {}
        self._make(world)

    def _make(self, world: World) -> None:
        self._topology, self._hands, self._settings = world.topology_version, world.hand_version, world.settings
        self.wanted[[CONTACTS, KEPT]] = np.maximum(self.wanted[[CONTACTS, KEPT]], len(world.contact_particle))
        self.wanted[ENTRIES] = max(self.wanted[ENTRIES], world.particle_count)
        collisions, joints = self._collisions(world), joints_of(world)
        solving = _for_solver(world, joints.rows, len(collisions.bound.particle), self._room)
        self.arrays = WorldBlock(
            state=state_of(world),
            good=good_of(world),
            plan=_plan_of(world),
            drives=drives_of(world.actuators),
            limits=_limits_of(world),
            collisions=collisions,
            joints=joints,
            triangles=world_triangles(world),
            **self._again(_new_scratch, world.particle_count, world.spring_count, world.constraint_count),
            **solving._asdict(),
        )
        _load_settings(world.settings, self.arrays)
        self._point()
        _bound_terrain(self.pointer)

    def _again(self, make: Callable[..., dict[str, Any]], *sizes: int) -> dict[str, Any]:
        """The scratch that was made last, where it is to be as large as then; else new scratch."""
        if make not in self._scratch or self._scratch[make][0] != sizes:
            self._scratch[make] = sizes, make(*sizes)
        return self._scratch[make][1]

    def _collisions(self, world: World) -> Collisions:
        """The collisions of a world with room for more than is wanted, which keep the contacts of the last step."""
        contacts, kept, *room = (MORE_ROOM * self.wanted + LEAST_ROOM).tolist()
        contacts, particles = max(contacts, kept), world.particle_count
        if world.has_contacts:
            outline, triangles = outline_of(world), world.derived(triangles_of, of_hands=False)
            objects, shapes = particles + int(outline.dynamic[0]), len(outline.solid_of)
            made = Collisions(
                outline=outline,
                triangles=triangles,
                colliders=colliders_of(world, outline, room[-1]),
                bounds=np.zeros((len(outline.solid), 5)),
                inversions=new_inversions(triangles),
                shape_bounds=new_shape_bounds(shapes),
                counts=np.zeros(BOUND + 1, np.int64),
                **self._again(_new_collision_scratch, particles, objects, shapes, contacts, *room),
            )
        else:
            made = _no_collisions()._replace(kept=room_to_keep(contacts), counts=np.zeros(BOUND + 1, np.int64))
        if self.kept.impulse.base is made.kept.impulse:
            made.counts[KEPT] = len(self.kept.particle)
        else:
            self.kept = NOTHING_KEPT
        return made

    def follow(self, world: World) -> None:
        """Follow what has changed of a world's topology."""
        if self._topology != world.topology_version:
            self._make(world)
        elif self._hands != world.hand_version:
            self._hands = world.hand_version
            arrays, joints = self.arrays, joints_of(world)
            solving = _Solving(arrays.system, arrays.workspace, arrays.iteration, arrays.explicit)
            solving = _with_joints(solving, self._settings.solver, world.particle_count, joints.rows)
            self.arrays = arrays._replace(joints=joints, **solving._asdict())
            self._point()

    def begin(self, world: World) -> None:
        """Take over a world's settings and tick, and the contacts of its last step, where they are not those here."""
        if self._settings is not world.settings:
            if self._settings.solver != world.settings.solver:
                contacts = len(self.arrays.collisions.bound.particle)
                solving = _for_solver(world, self.arrays.joints.rows, contacts, self._room)
                self.arrays = self.arrays._replace(plan=_plan_of(world), **solving._asdict())
                self._point()
            self._settings = world.settings
            _load_settings(world.settings, self.arrays)
        if self._has_other_contacts(world):
            self._take_contacts(world)
        progress = self.arrays.progress
        progress[TICK], progress[MAY_FLY], progress[COUNT], progress[CHECKED] = world.tick, world.may_fly, 0, 0

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
        workspace = self.arrays.workspace
        numbers, columns = int(workspace.islands.counts[NUMBERS]), int(workspace.islands.counts[COLUMNS])
        if numbers > self._room.numbers or columns > self._room.columns:
            self._room = _Room(
                max(MORE_ROOM * numbers, self._room.numbers), max(MORE_ROOM * columns, self._room.columns)
            )
            delassus = workspace.delassus._replace(
                numbers=np.zeros(self._room.numbers), columns=np.zeros(self._room.columns)
            )
            self.arrays = self.arrays._replace(workspace=workspace._replace(delassus=delassus))
            self._point()
        else:
            self._grow_collisions(world)

    def _grow_collisions(self, world: World) -> None:
        old, workspace = self.arrays.collisions, self.arrays.workspace
        self.wanted = np.maximum(self.wanted, old.counts[:BOUND])
        made, count = self._collisions(world), len(old.kept.particle)
        made.counts[:] = old.counts
        for name in KeptContacts._fields:
            getattr(made.kept, name)[:count] = getattr(old.kept, name)
        terms = new_contact_constraints(len(made.bound.particle), workspace.terms.surface)
        self.arrays = self.arrays._replace(collisions=made, workspace=workspace._replace(terms=terms))
        self._point()
        _bound_terrain(self.pointer)

    def _point(self) -> None:
        self.pointer = bundle(self.arrays, self.pointer)

    def end(self, world: World) -> None:
        """Make the contacts of a tick's last step those of the world's state."""
        count = self.arrays.collisions.counts[KEPT]
        if len(world.contact_impulse) != count or self._has_other_contacts(world):
            self._share_contacts(world)

    def _has_other_contacts(self, world: World) -> bool:
        # Two arrays of nothing are the same.
        is_other = world.contact_impulse is not self.kept.impulse
        return is_other and (len(world.contact_impulse) > 0 or bool(self.arrays.collisions.counts[KEPT] > 0))

    def _share_contacts(self, world: World) -> None:
        count = self.arrays.collisions.counts[KEPT]
        self.kept = KeptContacts._make([array[:count] for array in self.arrays.collisions.kept])
        world.keep_contacts(*self.kept)


def block_of(world: World) -> Block:
    """The block of a world, as its topology is now."""
    block = world.lasting(Block)
    block.follow(world)
    return block


class _Room(NamedTuple):
    """Room for the Delassus blocks of bodies: for their numbers, and for the columns of the largest."""

    numbers: int
    columns: int


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


def _for_solver(world: World, rows: JointRows, contacts: int, room: _Room) -> _Solving:
    """What the present solver of a world needs, and no other, with room for so many contacts; rows: of its joints."""
    system, workspace, iteration, explicit = _nothing()
    count, hooke = world.particle_count, world.spring_active & (world.law == LAW_HOOKE)
    if world.settings.solver == "direct":
        system = layout_of(world).system
        delassus = new_blocks(count, system, room.numbers, room.columns)
        workspace = workspace._replace(islands=new_islands(system, count), delassus=delassus)
    else:
        workspace = workspace._replace(delassus=no_blocks(count, no_joints()))
    if world.settings.solver == "iterative":
        iteration = iteration_of(world)
    # These take springs of Hooke's law apart, all others take all springs so.
    if world.settings.solver not in ("direct", "iterative"):
        explicit = new_explicit_pass(world, no_joints(), world.spring_active)
    elif hooke.any():
        explicit = new_explicit_pass(world, no_joints(), hooke)
    workspace = workspace._replace(terms=new_contact_constraints(contacts, np.zeros(count)))
    return _with_joints(_Solving(system, workspace, iteration, explicit), world.settings.solver, count, rows)


def _with_joints(solving: _Solving, solver: str, particles: int, rows: JointRows) -> _Solving:
    """The same with the rows of joints as a solver takes them that it is for."""
    workspace, explicit = solving.workspace, solving.explicit
    if solver == "single_pass":
        mass, given = np.zeros((2, len(rows.limit)))
        return solving._replace(explicit=explicit._replace(joints=joints_by_mass(rows), mass=mass, given=given))
    if solver == "direct":
        row_of, row_start = workspace.islands.row, solving.system.bodies.row_start
        joints = new_joints(rows, row_of, row_start, particles)
    else:
        joints = joints_by_mass(rows)
    return solving._replace(workspace=workspace._replace(delassus=workspace.delassus._replace(joints=joints)))


def _plan_of(world: World) -> Slots:
    has_hooke = bool((world.spring_active & (world.law == LAW_HOOKE)).any())
    has_rings = bool((world.constraint_corners > TRIANGLE).any())
    return np.array([world.has_contacts, has_hooke, has_rings, world.grab_particle, world.grab_spring], np.int64)


def _load_settings(settings: WorldSettings, arrays: WorldBlock) -> None:
    arrays.numbers[:], arrays.choices[:] = settings.numbers, settings.choices


def _limits_of(world: World) -> MaterialLimits:
    limits, count = world.limits, world.spring_count
    if not limits.exist:
        never = np.zeros(0)
        return MaterialLimits(never, never, never, never, np.zeros(0, np.bool_), np.zeros(0, np.int64))
    return MaterialLimits(
        limits.tension, limits.compression, limits.yielding, limits.yield_share, world.actuators.springs(count),
        np.zeros(count, np.int64),
    )  # fmt: skip


def _new_scratch(particles: int, springs: int, constraints: int) -> dict[str, Any]:
    """What a world of so many wants whatever is in it, by its names in the block."""
    return {
        "numbers": np.zeros(len(WorldSettings().numbers)),
        "choices": np.zeros(len(WorldSettings().choices), np.int64),
        "progress": np.zeros(PROGRESS, np.int64),
        "start": np.zeros((particles, 2)),
        "start_length": np.zeros(springs),
        "shortest": np.zeros(GRAB_COUNT),
        "coefficients": Coefficients(*np.zeros((2, springs)), *np.zeros((2, constraints))),
        "flight": new_flight(particles),
    }


def _new_collision_scratch(
    particles: int, objects: int, shapes: int, contacts: int, entries: int, pairs: int, terrain_pairs: int,
    crossings: int, overlaps: int,
) -> dict[str, Any]:  # fmt: skip
    """What steps fill in, with room for so many of each, by its names in Collisions."""
    boxes = new_boxes(particles, objects)
    return {
        "boxes": boxes,
        "grid": new_grid(objects, entries),
        "candidates": Candidates(new_pairs(particles, pairs), new_pairs(particles, terrain_pairs), boxes.box),
        "near": room_near(),
        "contacts": room_for(contacts),
        "bound": room_for(contacts),
        "kept": room_to_keep(contacts),
        "islands": new_free_islands(particles, contacts),
        "work": new_work(particles, contacts),
        "overlaps": new_overlaps(shapes, crossings, overlaps),
        "moved": np.zeros(particles, np.bool_),
        "attached": np.zeros(particles, np.bool_),
    }


@functools.cache
def _no_collisions() -> Collisions:
    world = World()
    world.add_particles(["a"], [[0.0, 0.0]], collides=1)
    return Block(world).arrays.collisions
