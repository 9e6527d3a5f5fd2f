"""The block of a world, which follows what changes in it, and grows where a step wants more room."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, lay_out
from sandbox.physics.arrays import empty, with_empty
from sandbox.physics.breaking import MaterialLimits
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import KeptContacts
from sandbox.physics.driving import drives_of
from sandbox.physics.jit import bundle, items_of
from sandbox.physics.joints.joint_set import wheels_of
from sandbox.physics.pipeline.block import (
    CHECKED,
    COUNT,
    GRAB_PARTICLE,
    GRAB_SPRING,
    MAY_FLY,
    PLANNED,
    PROGRESS,
    TICK,
    WorldBlock,
)
from sandbox.physics.pipeline.collide import COUNTED, KEPT, Collisions
from sandbox.physics.pipeline.derive import DEMANDS, derive_hands, derive_topology, make_room
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers.direct.islands import IslandWorkspace
from sandbox.physics.solvers.direct.layout import tuning
from sandbox.physics.solvers.direct.system import WAYS
from sandbox.physics.state import RANGES, good_of, state_of
from sandbox.physics.water.displacers import Water
from sandbox.physics.ways import of_present
from sandbox.physics.world import World, areas_of


class BlockOwner:
    """The block of a world, and the pointer that kernels take.

    inputs: what Python gives, all else is empty there. A world's contacts are the first of those that the block has
    room for, so that it has them without a copy.
    """

    inputs: WorldBlock
    pointer: Any = None

    def __init__(self, world: World) -> None:
        self._arenas = [np.zeros(FIRST_ARENA, np.int64) for _ in range(3)]
        self._arrays: WorldBlock | None = None
        self._topology = self._hands = -1
        self._kept = self._kept_room = empty(KeptContacts)
        self.inputs = with_empty(
            WorldBlock,
            state=state_of(world),
            good=good_of(world),
            numbers=np.zeros(len(WorldSettings().numbers)),
            choices=np.zeros(len(WorldSettings().choices), np.int64),
            plan=np.zeros(PLANNED, np.int64),
            progress=np.zeros(PROGRESS, np.int64),
            demand=np.zeros(DEMANDS, np.int64),
            ranges=RANGES,
            collisions=with_empty(Collisions, counts=np.zeros(COUNTED, np.int64)),
            workspace=with_empty(IslandWorkspace, ways=np.zeros(WAYS, np.int64)),
        )
        # A tick reads and writes a few numbers of these, which numpy takes three times as long for.
        self._progress, self._counts = self.inputs.progress.data, self.inputs.collisions.counts.data
        self._constant: tuple[Any, ...] = ()
        self._follow_topology(world)

    @property
    def arrays(self) -> WorldBlock:
        """The block's contents as numpy arrays."""
        if self._arrays is None:
            self._arrays = items_of(self.pointer)
        return self._arrays

    def follow(self, world: World) -> None:
        """Take over changes of a world's topology."""
        if self._topology != world.topology_version:
            self._follow_topology(world)
        elif self._hands != world.hand_version:
            self._hands = world.hand_version
            self._lay_out_hands()

    def _follow_topology(self, world: World) -> None:
        world.ways = of_present(world.ways, world.particle_count)
        self._topology, self._hands = world.topology_version, world.hand_version
        constant = world.actuators, world.limits, world.spring_count
        if constant != self._constant:
            self._constant = constant
            self.inputs = self.inputs._replace(
                drives=drives_of(world.actuators), wheels=wheels_of(world.actuators), limits=_limits_of(world)
            )
        water, table = with_empty(Water, pool=world.water, hull=world.hulls), world.form_table
        self.inputs = self.inputs._replace(
            state=state_of(world), good=good_of(world), areas=areas_of(world), forms=table.forms, modes=table.modes,
            tuning=tuning(), rules=world.rules, ways=world.ways, water=water,
        )  # fmt: skip
        self.inputs.plan[GRAB_PARTICLE], self.inputs.plan[GRAB_SPRING] = world.grab_particle, world.grab_spring
        self._lay_out(world)

    def _lay_out(self, world: World) -> None:
        self._load(world.settings)
        kept = _contacts_of(world)
        self.pointer = bundle(self.inputs, self.pointer)
        self._arenas[0] = lay_out(derive_topology, self.pointer, self._arenas[0])
        self._lay_out_hands()
        self.inputs.collisions.counts[:] = 0
        self._make_room(kept)
        if self._has_other_contacts(world):
            self._share_contacts(world)

    def _lay_out_hands(self) -> None:
        self._arenas[1] = lay_out(derive_hands, self.pointer, self._arenas[1])
        self._arrays = None

    def _make_room(self, kept: Iterable[Any]) -> None:
        """Grow arrays to the sizes that a step asked for, and put these contacts of the last step back."""
        copies = [array.copy() for array in kept]
        self.inputs.collisions.counts[KEPT] = len(copies[0])
        self._arenas[2] = lay_out(make_room, self.pointer, self._arenas[2])
        self._arrays = None
        # What the world has lies where other arrays do now.
        self._kept, self._kept_room = empty(KeptContacts), items_of(self.pointer, ("collisions", "kept"))
        _write(copies, self._kept_room)

    def _load(self, settings: WorldSettings) -> None:
        self._settings = settings
        self.inputs.numbers[:], self.inputs.choices[:] = settings.numbers, settings.choices

    def begin(self, world: World) -> None:
        """Take over a world's settings and tick, and the contacts of its last step, where they are not those here."""
        if self._settings is not world.settings:
            if self._settings.solver != world.settings.solver:
                self._lay_out(world)
            self._load(world.settings)
        if self._has_other_contacts(world):
            self._take_contacts(world)
        progress = self._progress
        progress[TICK], progress[MAY_FLY], progress[COUNT], progress[CHECKED] = world.tick, world.may_fly, 0, 0

    def _take_contacts(self, world: World) -> None:
        contacts = _contacts_of(world)
        count = self.inputs.collisions.counts[KEPT] = len(contacts[0])
        if count > len(self._kept_room.particle):
            self._make_room(contacts)
        _write(contacts, self._kept_room)
        self._share_contacts(world)

    def grow(self) -> None:
        """Make the room that a step has found to be too little; the contacts of the last step stay."""
        count = self.inputs.collisions.counts[KEPT]
        self._make_room([array[:count] for array in self._kept_room])

    def end(self, world: World) -> None:
        """Make the contacts of a tick's last step those of the world's state."""
        if len(world.contact_impulse) != self._counts[KEPT] or self._has_other_contacts(world):
            self._share_contacts(world)

    def _has_other_contacts(self, world: World) -> bool:
        # Two arrays of nothing are the same.
        is_other = world.contact_impulse is not self._kept.impulse
        return is_other and (len(world.contact_impulse) > 0 or self._counts[KEPT] > 0)

    def _share_contacts(self, world: World) -> None:
        count = self.inputs.collisions.counts[KEPT]
        self._kept = KeptContacts._make([array[:count] for array in self._kept_room])
        world.contact_particle, world.contact_feature, world.contact_impulse, world.contact_impact = self._kept


def block_of(world: World) -> BlockOwner:
    """The block of a world with its present topology."""
    block = world.lasting(BlockOwner)
    block.follow(world)
    return block


def outline_of(world: World) -> Outline:
    """The outline of a world's bodies, whether anything can touch or not; it holds until topology changes."""
    outline: Outline = block_of(world).arrays.collisions.outline
    return outline


def _contacts_of(world: World) -> KeptContacts:
    return KeptContacts(world.contact_particle, world.contact_feature, world.contact_impulse, world.contact_impact)


def _write(contacts: Iterable[Any], into: Iterable[Any]) -> None:
    for values, array in zip(contacts, into, strict=True):
        array[: len(values)] = values


def _limits_of(world: World) -> MaterialLimits:
    limits, count = world.limits, world.spring_count
    if not limits.exist:
        return empty(MaterialLimits)
    return MaterialLimits(
        limits.tension, limits.compression, limits.yielding, limits.yield_share, world.actuators.springs(count),
        np.zeros(count, np.int64),
    )  # fmt: skip
