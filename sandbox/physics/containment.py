"""Containment: what a tick has found impossible is taken back by a kernel, and a world told of it."""

from typing import Any

import numpy as np

from sandbox.physics.analysis.query import slot_name
from sandbox.physics.arena import FIRST_ARENA
from sandbox.physics.events import Containment
from sandbox.physics.pipeline.tick import take_back
from sandbox.physics.state import COLUMNS, Family
from sandbox.physics.world import World


def contain(world: World, pointer: Any, code: int) -> None:
    """Take back what a tick has said UNSOUND or LOST of; pointer: to the world's block."""
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
