"""How many parts ticks take that choose them, and how tests choose in their place."""

import copy
from collections.abc import Callable

import pytest

from sandbox.physics.pipeline.block import COUNT
from sandbox.physics.pipeline.block_owner import BlockOwner, block_of
from sandbox.physics.settings import SUBSTEP_COUNT
from sandbox.physics.step import step
from sandbox.physics.world import World


def parts_taken(world: World) -> int:
    """The parts that the last tick of a world took; no spring broke in it."""
    return int(block_of(world).inputs.progress[COUNT])


def parts_of_next_tick(world: World) -> int:
    """The parts that the next tick of a world takes, which is not changed."""
    other = copy.deepcopy(world)
    step(other)
    return parts_taken(other)


def set_parts(monkeypatch: pytest.MonkeyPatch, choose: Callable[[], int]) -> None:
    """Let `choose` say how many parts each tick takes, in place of what moves."""
    begin = BlockOwner.begin

    def begin_with_parts(block: BlockOwner, world: World) -> None:
        begin(block, world)
        block.inputs.choices[SUBSTEP_COUNT] = choose()

    monkeypatch.setattr(BlockOwner, "begin", begin_with_parts)
