"""Snapshots and hashes: every bit of state, and nothing that is not state."""

import copy
import dataclasses

import numpy as np
import pytest

from sandbox.physics import snapshot as snapshot_module
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.driving import Actuators
from sandbox.physics.keeping.growing import grow
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import canonical_bytes, hash_by_array, restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import COLUMNS, Family
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.physics_scenes import grid, network, run, scaled


def busy_world(solver="iterative"):
    world = grid(5, 5, solver=solver, gravity=(0.5, -9.81), substeps=2, stiffness=0.2)
    world.change("law", LAW_HOOKE, 3)
    world.hooke_stiffness[3], world.hooke_damping[3] = 50.0, 0.1
    world.add_constraints(AREA, [[0, 1, 6], [6, 7, 12]], stiffness=0.1)
    world.add_constraints(BEND, [[0, 1, 2]], damping=0.1, material=-1)
    world.fit(Actuators(("part",)), [0.5])
    for family in (Family.RULE, Family.COUNTER, Family.PROBE, Family.STILL, Family.KEY, Family.DEED):
        grow(world, family, 1, {})
    world.reserve_grabs()
    world.hold(0, 12, (2.0, 2.5))
    run(world, 5)
    return world


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_resuming_from_a_snapshot_is_the_straight_run_bit_for_bit(solver):
    world = busy_world(solver)
    snapshot, hashes = take(world), []
    ticks = scaled(60, 10)
    for tick in range(ticks):
        world.move_grab(0, (2.0 + 0.01 * tick, 2.5))
        step(world)
        hashes.append(state_hash(world))
    # Slots, settings and edits after the snapshot leave no trace.
    first = world.add_particles(["+.0", "+.1"], [(9, 9), (8, 8)])
    world.add_springs(["+:0"], [first], [first + 1])
    world.settings = WorldSettings(gravity=(0.0, 0.0), solver="single_pass", substeps=8)
    world.pin(7)
    world.cut([0, 1])
    run(world, 3)
    restore(world, snapshot)
    for tick in range(ticks):
        world.move_grab(0, (2.0 + 0.01 * tick, 2.5))
        step(world)
        assert state_hash(world) == hashes[tick]


def test_restoring_forgets_the_names_of_slots_added_since():
    world = busy_world()
    snapshot = take(world)
    first = world.add_particles(["+.0"], [(9, 9)])
    world.add_springs(["+:0"], [first], [0])
    restore(world, snapshot)
    with pytest.raises(KeyError):
        world.particle_slot("+.0")
    with pytest.raises(KeyError):
        world.spring_slot("+:0")
    assert len(world.particle_names) == world.particle_count
    assert world.add_particles(["+.0"], [(9, 9)]) == first
    assert world.particle_slot("p.3") == 3


def test_restoring_to_before_the_hands_were_reserved_lets_them_be_reserved_again():
    world = network([(0, 0), (1, 0)], [(0, 1)])
    snapshot = take(world)
    world.hold(0, 1, (5.0, 5.0))
    held = state_hash(world)
    restore(world, snapshot)
    assert not world.is_held(0) and world.particle_count == 2
    world.hold(0, 1, (5.0, 5.0))
    assert state_hash(world) == held


def test_a_snapshot_is_a_read_only_copy():
    world = busy_world()
    snapshot = take(world)
    before = snapshot.position.copy()
    run(world, 3)
    assert np.array_equal(snapshot.position, before)
    for column in COLUMNS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(snapshot, column.name)[:] = 0
    restore(world, snapshot)
    step(world)
    assert np.array_equal(snapshot.position, before)


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.stored)
def test_each_array_changes_the_hash_and_its_own_hash_alone(column):
    world = busy_world()
    grow(world, Family.CONTACT, 1, {"contact_feature": 1, "contact_impulse": 1.0, "contact_impact": 1.0})
    before, by_array = state_hash(world), hash_by_array(world)
    array = getattr(world, column.name).copy()
    if array.dtype.kind == "f":
        array.flat[-1] = np.nextafter(array.flat[-1], np.inf)
    elif array.dtype.kind == "b":
        array[-1] = not array[-1]
    else:
        array[-1] += 1
    setattr(world, column.name, array)
    assert state_hash(world) != before
    assert [other for other, digest in hash_by_array(world).items() if digest != by_array.get(other)] == [column.stored]


@pytest.mark.parametrize(
    "change",
    [
        {"gravity": (0.5, np.nextafter(-9.81, 0.0))},
        {"gravity": (0.0, -9.81)},
        {"tick_rate": 61},
        {"substeps": 4},
        {"solver": "single_pass"},
        {"iterations": 11},
        {"warm_start": 0.25},
        {"wind": (0.0, 1e-300)},
        {"drag": 0.5},
    ],
)
def test_each_setting_changes_the_hash(change):
    world = busy_world()
    before = state_hash(world)
    world.settings = dataclasses.replace(world.settings, **change)
    assert state_hash(world) != before


def test_the_tick_changes_the_hash():
    world = busy_world()
    before = state_hash(world)
    world.tick += 1
    assert state_hash(world) != before


def test_all_settings_are_covered_by_the_test_of_settings():
    assert {field.name for field in dataclasses.fields(WorldSettings)} == {
        "gravity", "tick_rate", "substeps", "solver", "iterations", "warm_start", "wind",
        "drag",
    }  # fmt: skip


def test_whole_numbers_and_floats_of_the_same_value_hash_alike():
    hashes = {
        state_hash(World(WorldSettings(gravity=gravity, warm_start=warm_start)))
        for gravity, warm_start in [((0, -10), 1), ((0.0, -10.0), 1.0), ((-0.0, -10.0), 1.0)]
    }
    assert len(hashes) == 1


def test_negative_zero_and_every_nan_are_canonical():
    odd_nan = np.array([0xFFF8_0000_0000_0001], dtype=np.uint64).view(np.float64)
    assert canonical_bytes(np.array([-0.0])) == canonical_bytes(np.array([0.0]))
    assert canonical_bytes(odd_nan) == canonical_bytes(np.array([np.nan])) == canonical_bytes(np.array([-np.nan]))
    assert canonical_bytes(np.array([1.0], dtype=">f8")) == canonical_bytes(np.array([1.0], dtype="<f8"))
    assert canonical_bytes(np.array([1, -2], dtype=np.int32)) == b"\x01\0\0\0\xfe\xff\xff\xff"


def test_making_bytes_canonical_changes_nothing_in_the_world():
    world = busy_world()
    world.position[0] = (-0.0, np.nan)
    state_hash(world)
    assert np.signbit(world.position[0, 0])


def test_the_hash_can_be_made_from_the_arrays_hashes():
    world = busy_world()
    assert state_hash(world, hash_by_array(world)) == state_hash(world)
    assert len(state_hash(world)) == 32
    assert {len(digest) for digest in hash_by_array(world).values()} == {16}


def test_what_stays_the_same_is_hashed_once_in_each_of_two_worlds_that_run_side_by_side(monkeypatch):
    worlds = [busy_world("iterative"), busy_world("single_pass")]
    alone = [hash_by_array(copy.copy(take(world))) for world in worlds]
    assert [hash_by_array(world) for world in worlds] == alone
    hashed = []
    monkeypatch.setattr(snapshot_module, "canonical_bytes", lambda array: hashed.append(1) or canonical_bytes(array))
    assert [hash_by_array(world) for world in worlds] == alone
    assert not hashed
    worlds[0].position[0, 0] += 0.5
    assert hash_by_array(worlds[0]) == hash_by_array(take(worlds[0])) != alone[0]
    assert hash_by_array(worlds[1]) == alone[1]
