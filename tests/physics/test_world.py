"""World: slots, names, pins, coefficients, hands."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, spring_energy
from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.constraints import AREA
from sandbox.physics.marks import GRAB_COUNT, LAW_HOOKE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import FAMILIES, Family
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.physics_scenes import STILL, grid_with_diagonals, network, rope, run, scaled


def held_rope(**options):
    world = rope(links=4, **options)
    world.reserve_grabs()
    return world


def test_slots_are_appended_and_named():
    world = network([(0, 0), (1, 0)], [(0, 1)])
    assert world.add_particles(["extra"], [[4.0, 4.0]], mass=2.0, velocity=(1.0, 2.0)) == 2
    assert world.add_springs(["tie"], [0], [2]) == 1
    assert world.particle_slot("extra") == 2 and world.particle_names[2] == "extra"
    assert world.spring_slot("tie") == 1 and world.spring_names[1] == "tie"
    assert world.rest_length[1] == np.sqrt(32.0)
    assert world.inverse_mass[2] == 0.5
    with pytest.raises(KeyError):
        world.particle_slot("nobody")


def test_every_array_keeps_its_type_and_one_item_per_slot():
    world = held_rope()
    world.add_constraints(AREA, [[0, 1, 2, 3]])
    counts = (5 + GRAB_COUNT, 4 + GRAB_COUNT, 1, 4, 0, 0, GRAB_COUNT, 6, 0, 0, 0, 0, 0, 0)
    for family, count in zip(Family, counts, strict=True):
        for column in FAMILIES[family]:
            array = getattr(world, column.name)
            assert array.dtype == column.dtype and array.flags.c_contiguous and len(array) == count
    assert (world.particle_count, world.spring_count, world.constraint_count) == counts[:3]
    assert world.particle_a.dtype == np.int32 and world.position.dtype == np.float64


def test_a_name_is_given_once():
    world = network([(0, 0), (1, 0)], [])
    for names in (["p.0"], ["new", "new"]):
        with pytest.raises(ValueError, match="is taken"):
            world.add_particles(names, np.zeros((len(names), 2)))
    assert world.particle_count == 2 and world.particle_names == ["p.0", "p.1"]


@pytest.mark.parametrize(("a", "b", "fault"), [(0, 0, "two different"), (0, 2, "b 2: "), (-1, 0, "a -1: ")])
def test_a_spring_joins_two_particles_that_exist(a, b, fault):
    world = network([(0, 0), (1, 0)], [])
    with pytest.raises((IndexError, ValueError), match=fault):
        world.add_springs(["s"], [a], [b])
    assert world.spring_count == 0 and world.spring_names == []


@pytest.mark.parametrize("mass", [0.0, -1.0, float("nan")])
def test_a_mass_is_above_0(mass):
    with pytest.raises(ValueError, match="mass"):
        World().add_particles(["p"], [[0, 0]], mass=mass)


def test_a_pinned_particle_starts_at_rest():
    world = World()
    world.add_particles(["a", "b"], np.zeros((2, 2)), velocity=(3.0, 4.0), pinned=[True, False])
    assert np.array_equal(world.velocity, [(0, 0), (3, 4)])
    assert np.array_equal(world.inverse_mass, [0.0, 1.0])


def test_rest_lengths_that_are_not_given_are_as_placed():
    world = network([(0, 0), (3, 4), (6, 8)], [])
    world.add_springs(["s", "t"], [0, 1], [1, 2], rest_length=[np.nan, 0.0])
    assert np.array_equal(world.rest_length, [5.0, 0.0])


def test_coefficients_are_set_by_material_and_never_on_hands():
    world = World(material_names=("steel", "jelly"))
    world.add_particles(["a", "b", "c"], [(0, 0), (1, 0), (2, 0)])
    world.add_springs(["s", "t", "u"], [0, 1, 0], [1, 2, 2], stiffness=0.1, damping=0.2, material=[0, 1, 1])
    world.reserve_grabs()
    hands = world.stiffness[3:].copy(), world.damping[3:].copy()
    world.set_coefficients(0.7, None, 1)
    assert np.array_equal(world.stiffness[:3], [0.1, 0.7, 0.7])
    world.set_coefficients(None, 0.4, None)
    assert np.array_equal(world.damping[:3], [0.4, 0.4, 0.4])
    assert np.array_equal(world.stiffness[3:], hands[0]) and np.array_equal(world.damping[3:], hands[1])


def test_hands_are_reserved_once_at_the_end_and_rest():
    world = held_rope()
    world.reserve_grabs()
    assert (world.grab_particle, world.grab_spring) == (5, 4)
    assert [slot for slot in range(-1, 20) if world.is_grab_particle(slot)] == list(range(5, 5 + GRAB_COUNT))
    assert [slot for slot in range(-1, 20) if world.is_grab_spring(slot)] == list(range(4, 4 + GRAB_COUNT))
    assert not world.particle_active[5:].any() and not world.spring_active[4:].any()
    assert not any(world.is_held(hand) for hand in range(GRAB_COUNT))


def test_unused_hands_change_nothing():
    with_hands, without = held_rope(gravity=(0.0, -9.81)), rope(links=4, gravity=(0.0, -9.81))
    for world in (with_hands, without):
        run(world, 50)
    assert np.array_equal(with_hands.position[:5], without.position)


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("substeps", [1, 2, 8, 64])
def test_a_moved_hand_arrives_at_its_target_after_one_tick_and_stops(solver, substeps):
    world = held_rope(solver=solver, substeps=substeps)
    world.hold(3, 4, (4.0, 0.0))
    cursor = world.grab_particle + 3
    for target in [(4.5, 0.25), (-7.1, 3.3), (-7.1, 3.3), (1e3, -1e3)]:
        world.move_grab(3, target)
        step(world)
        assert world.position[cursor] == pytest.approx(target, rel=1e-13, abs=1e-13)
        assert np.array_equal(world.velocity[cursor], STILL)
    before = world.position[cursor].copy()
    step(world)
    assert np.array_equal(world.position[cursor], before)


def test_a_hand_draws_a_particle_to_its_cursor():
    world = network([(0, 0)], [], gravity=STILL)
    world.hold(0, 0, (2.0, 1.0))
    run(world, 200)
    assert world.position[0] == pytest.approx([2.0, 1.0], abs=1e-6)
    assert world.is_held(0)


def test_a_released_hand_pulls_no_more_and_its_slots_serve_again():
    world = held_rope()
    before = take(world)
    world.hold(2, 4, (9.0, 9.0))
    world.release(2)
    assert all(np.array_equal(getattr(world, name), old) for name, old in before.arrays.items())
    count = world.particle_count, world.spring_count
    world.hold(2, 1, (1.0, 1.0))
    step(world)
    assert (world.particle_count, world.spring_count) == count
    assert world.velocity[1, 1] > 0.0
    world.release(2)
    assert not world.is_held(2)


def test_a_released_hand_leaves_no_force_for_a_warm_start():
    world = held_rope(solver="iterative")
    world.hold(2, 4, (9.0, 9.0))
    run(world, 2)
    assert world.hand_force[2].any() and not world.hand_force[:2].any()
    world.release(2)
    assert not world.hand_force.any()


def test_ten_hands_hold_at_once():
    world = grid_with_diagonals(stiffness=1.0 / 9.0, damping=1.0 / 9.0)
    world.reserve_grabs()
    for hand in range(GRAB_COUNT):
        world.hold(hand, 5 * hand, (0.0, 0.0))
    assert all(world.is_held(hand) for hand in range(GRAB_COUNT))
    run(world, 100)
    assert np.all(np.isfinite(world.position))


def test_no_hand_holds_what_is_pinned_and_none_holds_two_things():
    world = held_rope()
    with pytest.raises(RefusedCommand, match="is pinned"):
        world.hold(0, 0, (0.0, 5.0))
    world.hold(0, 1, (0.0, 5.0))
    with pytest.raises(RefusedCommand, match="hand 0 holds something already"):
        world.hold(0, 2, (0.0, 5.0))


@pytest.mark.parametrize("substeps", [1, 4])
def test_dragging_a_body_at_the_article_s_limit_leaves_it_bounded(substeps):
    generator = np.random.default_rng(2)
    world = grid_with_diagonals(stiffness=1.0 / 9.0, damping=1.0 / 9.0, substeps=substeps)
    world.reserve_grabs()
    held, target = 27, np.array([3.0, 3.0])
    world.hold(0, held, tuple(target))
    for _ in range(scaled(600, 20)):
        target = np.clip(target + generator.uniform(-1.0, 1.0, 2), -10.0, 10.0)
        world.move_grab(0, tuple(target))
        step(world)
        assert np.max(np.abs(world.position[:64])) < 40.0
    energy = []
    for _ in range(scaled(1500, 100)):
        step(world)
        energy.append(kinetic_energy(world) + spring_energy(world))
    # At first the hand still draws it in.
    assert max(energy) <= 2.0 * energy[0] and energy[-1] <= 1.01 * energy[0]


def test_hooke_springs_keep_their_k_and_c_when_sliders_move():
    world = network([(0, 0), (1, 0)], [(0, 1)])
    world.change("law", LAW_HOOKE)
    world.hooke_stiffness[:], world.hooke_damping[:] = 5.0, 0.5
    world.set_coefficients(1.0, 1.0, None)
    assert (world.hooke_stiffness[0], world.hooke_damping[0]) == (5.0, 0.5)


def test_an_empty_world_has_no_hands_until_it_has_a_particle():
    world = World(WorldSettings())
    world.reserve_grabs()
    assert world.grab_particle == -1 and world.particle_count == 0
    world.add_particles(["+.0"], [(0.0, 0.0)])
    world.hold(0, 0, (1.0, 0.0))
    step(world)
    assert world.is_held(0) and world.velocity[0, 0] > 0.0
