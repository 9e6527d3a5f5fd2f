import math
import random
import sys

import numpy as np
import pytest

from sandbox.physics.constraints import AREA
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.tick import UNSOUND, take_back
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import CHECKED, COLUMNS, Family
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.contact_scenes import FLOOR, add_discs, add_jelly
from tests.support.contact_scenes import world as contact_world

IMPOSSIBLE = (math.nan, math.inf, -math.inf, 1e308, -1e308)


def _net(solver: str) -> World:
    """A hanging net of 6 x 5 particles and a chain of two Hooke springs beside it."""
    world = World(WorldSettings(solver=solver))
    grid = [(float(x), -float(y)) for y in range(5) for x in range(6)]
    world.add_particles([f"net.{k}" for k in range(30)], grid, pinned=[k < 6 for k in range(30)], mass=1.0)
    pairs = [(k, k + 1) for k in range(30) if k % 6 < 5] + [(k, k + 6) for k in range(24)]
    world.add_springs([f"net:{k}" for k in range(len(pairs))], *zip(*pairs, strict=True), stiffness=0.2, damping=0.2)
    first = world.add_particles(["hook.0", "hook.1"], [(9.0, 0.0), (9.0, -1.0)], pinned=[True, False])
    world.add_springs(["hook:0"], [first], [first + 1], law=1, hooke_stiffness=50.0, hooke_damping=1.0)
    world.reserve_grabs()
    return world


def _steps(world: World, count: int) -> None:
    for _ in range(count):
        step(world)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_thousand_impossible_values_are_contained_the_same_tick(solver):
    world, generator = _net(solver), random.Random(5)
    _steps(world, 30)
    start = take(world)
    arrays = ("position", "velocity", "mass", "inverse_mass", "rest_length", "stiffness", "damping", "hooke_damping")
    for _ in range(1000 // len(SOLVERS) + 1):
        restore(world, start)
        array, value = generator.choice(arrays), generator.choice(IMPOSSIBLE)
        values = getattr(world, array)
        slot = generator.randrange(20, 30)
        values[(slot, generator.randrange(2)) if values.ndim == 2 else slot] = value
        step(world)
        assert [(hit.array, hit.name) for hit in world.contained] == [(array, _name(world, array, slot))]
        world.contained.clear()
        _steps(world, 3)
        assert not world.contained
        assert np.abs(world.velocity).max() < 50.0
        assert np.abs(world.position).max() < 50.0


def _name(world: World, array: str, slot: int) -> str:
    particles = ("position", "velocity", "mass", "inverse_mass")
    return world.particle_names[slot] if array in particles else world.spring_names[slot]


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_rest_moves_as_if_the_particle_had_been_pinned(solver):
    hit, pinned = _net(solver), _net(solver)
    for world in (hit, pinned):
        _steps(world, 30)
    pinned.pin(22)
    hit.position[22, 0] = math.nan
    for world in (hit, pinned):
        _steps(world, 60)
    assert state_hash(hit) == state_hash(pinned)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_frozen_particle_can_be_let_go(solver):
    world = _net(solver)
    _steps(world, 30)
    before = world.position[22].copy()
    world.velocity[22] = math.inf
    step(world)
    assert np.array_equal(world.position[22], before)
    world.unpin(22)
    _steps(world, 200)
    assert not np.array_equal(world.position[22], before)
    assert np.isfinite(world.position).all()


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_spring_gets_its_last_good_constant_back(solver):
    hit, untouched = _net(solver), _net(solver)
    for world in (hit, untouched):
        world.set_coefficients(0.15, 0.3, None)
        _steps(world, 10)
    for name in ("rest_length", "stiffness", "damping", "hooke_stiffness"):
        getattr(hit, name)[7] = math.nan
    for world in (hit, untouched):
        _steps(world, 10)
    assert state_hash(hit) == state_hash(untouched)
    assert len(hit.contained) == 4
    assert str(hit.contained[0]) == "tick 10: net:7: an impossible rest length was taken back"


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_mistuned_hooke_spring_freezes_its_own_particle_and_nothing_else(solver):
    world, quiet = _net(solver), _net(solver)
    world.hooke_stiffness[world.spring_slot("hook:0")] = 1e9
    world.position[world.particle_slot("hook.1"), 1] -= 0.1
    _steps(world, 400)
    _steps(quiet, 400)
    assert np.isfinite(world.position).all()
    assert {hit.name for hit in world.contained} == {"hook.1"}
    assert np.array_equal(world.position[:30], quiet.position[:30])


@pytest.mark.parametrize("name", ["angle", "spin"])
@pytest.mark.parametrize("value", IMPOSSIBLE)
def test_how_a_disc_turns_is_guarded(name, value):
    world = contact_world(FLOOR)
    add_discs(world, [(0.0, 0.1), (1.0, 0.1)], velocity=(1.0, 0.0))
    _steps(world, 10)
    turned = float(world.angle[0])
    getattr(world, name)[0] = value
    _steps(world, 3)
    assert {(hit.array, hit.name) for hit in world.contained} == {(name, "disc.0")}
    assert (world.angle[0], world.spin[0], world.inverse_mass[0]) == (turned, 0.0, 0.0)
    assert world.spin[1] < 0.0 and np.isfinite(world.angle).all()


def test_hands_and_new_particles_are_guarded_too():
    world = _net("single_pass")
    step(world)
    world.hold(0, 20, (2.0, -3.0))
    added = world.add_particles(["late"], [(5.0, 5.0)])
    world.position[added, 1] = math.nan
    world.position[world.grab_particle, 0] = 1e300
    step(world)
    assert {hit.name for hit in world.contained} == {"late", "+hand.0"}
    assert world.position[added].tolist() == [5.0, 5.0]
    assert sys.float_info.max > np.abs(world.position).max() < 1e6


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", ["radius", "friction", "restitution", "gravity_scale", "rolling", "contact_impulse"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -1e308])
def test_what_levels_set_of_a_surface_is_guarded_and_only_what_was_hit_freezes(solver, name, value):
    w = contact_world(FLOOR, solver=solver)
    jelly = add_jelly(w, (0.0, 0.2), size=(0.3, 0.3), stiffness=0.05, damping=0.1)
    disc = add_discs(w, [(2.0, 0.1)])
    _steps(w, 5)
    before = getattr(w, name).copy()
    slot = int(np.flatnonzero(w.contact_particle == disc)[0]) if name == "contact_impulse" else disc
    getattr(w, name)[slot] = value
    step(w)
    assert [hit.array for hit in w.contained] == [name]
    assert w.contained[0].name.endswith(w.particle_names[disc])
    assert np.isfinite(getattr(w, name)).all()
    frozen = w.inverse_mass == 0.0
    assert np.flatnonzero(frozen).tolist() == ([] if name == "contact_impulse" else [disc])
    if name != "contact_impulse":
        assert np.array_equal(getattr(w, name), before)
    _steps(w, 30)
    assert len(w.contained) == 1
    assert np.abs(w.velocity[jelly]).max() < 1.0


@pytest.mark.parametrize("substeps", [1, 4])
def test_of_free_discs_as_well_only_what_was_hit_freezes(substeps):
    w = contact_world(FLOOR, substeps=substeps)
    hit, left = add_discs(w, [(0.0, 0.1)]), add_discs(w, [(3.0, 1.0)])
    _steps(w, 5)
    place, height = w.position[hit].copy(), w.position[left, 1]
    w.velocity[hit, 0] = math.nan
    _steps(w, 5)
    assert [taken.array for taken in w.contained] == ["velocity"]
    assert np.flatnonzero(w.inverse_mass == 0.0).tolist() == [hit]
    assert np.array_equal(w.position[hit], place)
    assert w.position[left, 1] < height


def test_what_a_tick_of_free_discs_itself_blows_up_stays_where_it_was_and_alone():
    w = contact_world(FLOOR)
    hit, left = add_discs(w, [(0.0, 5.0)], gravity_scale=1e18), add_discs(w, [(3.0, 5.0)])
    w.settings = WorldSettings(gravity=(0.0, -1e6))
    _steps(w, 2)
    name = w.particle_names[hit]
    assert {taken.name for taken in w.contained} <= {name, f"contact of {name}"}
    assert w.contained
    assert w.position[hit].tolist() == [0.0, 5.0]
    assert np.isfinite(w.velocity).all()
    assert 0.0 < w.position[left, 1] < 5.0
    assert w.inverse_mass[left] > 0.0


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", ["stiffness", "rest_length", "mass"])
def test_a_tick_ends_even_where_what_was_last_good_is_impossible_too(name, solver):
    world = _net(solver)
    _steps(world, 2)
    getattr(world, name)[8] = math.nan
    world.trust()
    _steps(world, 3)
    assert world.tick == 5 and world.contained
    assert np.isfinite(world.position).all()


def _found(world: World) -> list[tuple[str, int]]:
    """What is taken back of a world at the beginning of a tick: array and slot of each."""
    block, arena = block_of(world), np.zeros(100, np.int64)
    block.begin(world)
    count = take_back(block.pointer, arena, UNSOUND)
    return [(COLUMNS[column].name, slot) for column, slot in arena[1 : 1 + 2 * count].reshape(-1, 2).tolist()]


@pytest.mark.parametrize("column", CHECKED, ids=[column.name for column in CHECKED])
def test_the_ends_of_a_range_are_good_and_what_lies_beyond_them_is_taken_back(column):
    world = contact_world(FLOOR)
    add_jelly(world, (0.0, 0.2), size=(0.3, 0.3), stiffness=0.05, damping=0.1)
    last = world.particle_count - 1
    world.add_constraints(AREA, [[0, 1, last], [1, 2, last]])
    _steps(world, 20)
    values, lowest, highest = getattr(world, column.name), column.within.lowest, column.within.high
    slot, place = 1, (1, 1) if values.ndim == 2 else 1
    before = float(values[place]) if column.guarded else 0.0
    for good in (lowest, highest):
        values[place] = good
        assert _found(world) == []
    for bad in (math.nan, math.inf, -math.inf, np.nextafter(lowest, -math.inf), np.nextafter(highest, math.inf)):
        values[place] = bad
        assert _found(world) == [(column.name, slot)]
        assert _found(world) == []
        if column.name not in ("velocity", "spin"):
            assert values[place] == before
        assert (world.inverse_mass[slot] == 0.0) == (column.family is Family.PARTICLE)


def test_as_many_values_are_taken_back_as_there_are():
    world = _net("direct")
    _steps(world, 3)
    start = take(world)
    for column in CHECKED:
        if column.family is not Family.CONTACT:
            getattr(world, column.name)[:] = math.nan
    step(world)
    restored = [column.name for column in CHECKED if column.guarded and column.name not in ("velocity", "spin")]
    assert all(np.array_equal(getattr(world, name), start.arrays[name]) for name in restored)
    particles = [hit.name for hit in world.contained if hit.frozen]
    assert sorted(particles) == sorted(world.particle_names)
    springs = [column for column in CHECKED if column.family is Family.SPRING]
    assert len(world.contained) == len(particles) + len(springs) * world.spring_count
