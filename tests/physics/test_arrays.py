"""Named tuples of arrays know what they hold from markers of their own, not from the insides of numpy's aliases."""

import copy
import subprocess
import sys
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from sandbox.physics.arena import FIRST_ARENA, lay_out
from sandbox.physics.arrays import ArrayKind, FloatRows, Slots, empty, with_empty
from sandbox.physics.pipeline import block_owner
from sandbox.physics.pipeline.block import WorldBlock
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.derive import derive_topology
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from tests.determinism.kernel_script import busy_world, touching_world
from tests.support.tangles import tangle

ROOT = Path(__file__).resolve().parents[2]

# Runs a level where numpy's alias of arrays has no inside at all.
WITH_A_STAND_IN = """
import sys
import numpy.typing

class Opaque:
    def __class_getitem__(cls, item):
        return cls

numpy.typing.NDArray = Opaque
from sandbox.cli import main
sys.exit(main(["run", "breaking_bridge", "--ticks", "3"]))
"""


class Inner(NamedTuple):
    """Of one array, whose annotation says nothing."""

    flag: Annotated[object, ArrayKind(np.bool_, 3)]


class Outer(NamedTuple):
    """Of arrays and of another tuple."""

    row: FloatRows
    slot: Slots
    inner: Inner
    bare: int = 0


class Whole(NamedTuple):
    """As Outer, without what is no array."""

    row: FloatRows
    slot: Slots
    inner: Inner


def test_arrays_of_a_named_tuple_have_the_dtype_and_dimensions_of_their_markers():
    made = empty(Whole)
    assert (made.row.dtype, made.row.shape) == (np.float64, (0, 0))
    assert (made.slot.dtype, made.slot.shape) == (np.int64, (0,))
    assert (made.inner.flag.dtype, made.inner.flag.shape) == (np.bool_, (0, 0, 0))


def test_what_is_given_takes_the_place_of_an_empty_array():
    slots = np.arange(3)
    assert with_empty(Whole, slot=slots).slot is slots


def test_a_field_without_a_marker_is_named():
    with pytest.raises(TypeError, match=r"Outer\.bare"):
        empty(Outer)


def test_levels_run_whatever_the_aliases_of_numpy_look_like_inside():
    run = subprocess.run([sys.executable, "-c", WITH_A_STAND_IN], cwd=ROOT, capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, ""), run.stderr


SOLVERS = ("single_pass", "iterative", "direct")


def arrays_of(item: Any, path: str = "") -> dict[str, np.ndarray]:
    """The arrays of a tuple, by where they are in it."""
    if isinstance(item, np.ndarray):
        return {path: item}
    parts = zip(item._fields, item, strict=True)
    return {name: array for field, part in parts for name, array in arrays_of(part, f"{path}.{field}").items()}


def test_a_full_arena_is_asked_for_again_and_nothing_is_lost(monkeypatch):
    wanted = block_of(busy_world("direct", 1)).arrays
    monkeypatch.setattr(block_owner, "FIRST_ARENA", 2)
    found = block_of(busy_world("direct", 1)).arrays
    for (name, one), other in zip(arrays_of(wanted).items(), arrays_of(found).values(), strict=True):
        assert np.array_equal(one, other, equal_nan=True), name


@pytest.mark.parametrize("words", [1, 50, 400])
def test_what_finds_no_room_touches_nothing_beyond_its_arena(words):
    block = block_of(tangle(1))
    memory = np.zeros(FIRST_ARENA, np.int64)
    memory[words:] = 7
    derive_topology(block.pointer, memory[:words])
    assert memory[0] > words
    assert (memory[words:] == 7).all()
    lay_out(derive_topology, block.pointer, memory[:words])


@pytest.mark.parametrize("make", [busy_world, touching_world])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_block_that_was_changed_is_as_one_that_is_made(make, solver):
    # What hands held, what was cut and what was pinned leaves nothing behind.
    world = make(solver, 2)
    for tick in range(12):
        if tick == 2:
            world.hold(0, 7, (1.0, 1.5), 60.0, 0.9)
        if tick == 5:
            world.cut([1])
        if tick == 7:
            world.release(0)
        if tick == 9:
            world.pin(3)
        other = copy.deepcopy(world)
        step(world)
        step(other)
        assert state_hash(world) == state_hash(other), tick


def test_arrays_of_the_block_are_those_of_the_world_and_of_its_arenas():
    world = busy_world("direct", 1)
    arrays: WorldBlock = block_of(world).arrays
    assert arrays.state.position is world.position
    assert np.shares_memory(arrays.triangles.clamped.position, world.position)
    rows = arrays.system.rows
    assert rows.particle.max() < world.particle_count and len(rows.mass) == len(rows.particle)
    assert len(set(arrays.system.rows.particle.tolist())) == len(rows.particle)
