"""step(world): one tick. A kernel does it (pipeline/tick.py); what is rare is answered here: growth, containment."""

from typing import Any

import numpy as np

from sandbox.physics.analysis.query import slot_name
from sandbox.physics.arena import FIRST_ARENA
from sandbox.physics.keeping.arguments import of_kind
from sandbox.physics.pipeline.block import BROKEN, CHECKED
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.rule_evaluation import judge
from sandbox.physics.pipeline.tick import BROKE, LOST, NO_ROOM, UNSOUND, find_broken, take_back, tick
from sandbox.physics.sanitise import Containment
from sandbox.physics.state import COLUMNS, Family
from sandbox.physics.world import World

# Changes only when the arithmetic of a tick changes; replays of another version are refused.
PHYSICS_VERSION = 11


def precompute(world: World) -> None:
    """Prepare the block of the next tick ahead of it. This changes nothing of a world's state."""
    block_of(world)


def step(world: World) -> None:
    """Advance the world by one tick of 1 / tick_rate seconds."""
    if not isinstance(world, World):
        of_kind("world", world, World)
    if len(world.broken):
        world.broken = world.broken[:0]
    block = block_of(world)
    block.begin(world)
    code = tick(block.pointer)
    while code in (NO_ROOM, UNSOUND):
        if code == NO_ROOM:
            block.grow()
        else:
            contain(world, block.pointer, UNSOUND)
            block = block_of(world)
            block.begin(world)
            # What was good is not always: nothing is looked at twice.
            block.inputs.progress[CHECKED] = 1
        code = tick(block.pointer)
    block.end(world)
    world.end_tick()
    if code == LOST:
        contain(world, block.pointer, LOST)
        code = BROKE if find_broken(block.pointer) else code
    if code == BROKE:
        world.break_springs(block.inputs.limits.broken[: block.inputs.progress[BROKEN]].copy())
    if world.rule_due.size:
        judge(block.pointer)


def contain(world: World, pointer: Any, code: int) -> None:
    """Take back the values that a tick reported as UNSOUND or LOST; pointer: to the world's block."""
    arena = np.zeros(FIRST_ARENA, np.int64)
    count = take_back(pointer, arena, code)
    while arena[0] > len(arena):
        arena = np.zeros(int(arena[0]), np.int64)
        count = take_back(pointer, arena, code)
    for number, slot in arena[1 : 1 + 2 * count].reshape(-1, 2).tolist():
        column = COLUMNS[number]
        owner, is_frozen = slot_name(world, column.stored, slot), column.family is Family.PARTICLE
        world.contained.append(Containment(world.tick, column.stored, owner, is_frozen))
    world.topology_version += 1
