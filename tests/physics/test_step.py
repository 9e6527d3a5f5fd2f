"""A tick: its order, its edge cases, and what never moves."""

import math

import numpy as np
import pytest

from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.substeps import substep_coefficients, substep_time, turned
from sandbox.physics.world import World
from tests.support.physics_scenes import STILL, grid_with_diagonals, lengths, network, run, scaled

every_solver = pytest.mark.parametrize("solver", list(SOLVERS))


@every_solver
def test_a_lone_particle_is_where_the_parabola_is_at_every_tick(solver):
    world = network([(1, 2)], [], solver=solver, gravity=(1.0, -10.0), tick_rate=10)
    for n in range(1, 20):
        step(world)
        # Symplectic Euler, whose velocities stand half a step behind: x = g t^2 / 2.
        assert world.velocity[0] == pytest.approx([0.1 * (n - 0.5), -1.0 * (n - 0.5)])
        assert world.position[0] == pytest.approx([1.0 + 0.01 * n * n / 2, 2.0 - 0.1 * n * n / 2], rel=1e-13)
    assert world.tick == 19


@every_solver
def test_an_empty_world_only_counts_its_ticks(solver):
    world = World(WorldSettings(solver=solver, substeps=4))
    run(world, 3)
    assert world.tick == 3
    assert world.particle_count == 0


@every_solver
@pytest.mark.parametrize("law", [0, LAW_HOOKE])
def test_a_spring_between_two_pinned_particles_does_nothing(solver, law):
    world = network([(0, 0), (1, 0), (5, 5)], [(0, 1)], pinned=[0, 1], solver=solver, stiffness=1.0, damping=1.0)
    world.change("law", law)
    world.hooke_stiffness[:] = 1e6
    world.rest_length[:] = 0.1
    run(world, 10)
    assert np.array_equal(world.position, [(0, 0), (1, 0), (5, 5)])
    assert np.array_equal(world.velocity, np.zeros((3, 2)))


@every_solver
@pytest.mark.parametrize("velocity", [STILL, (0.0, 3.0)])
@pytest.mark.parametrize("rest_length", [0.0, 1.0])
def test_coincident_particles_come_apart_to_their_rest_length(solver, velocity, rest_length):
    world = network([(2, 2), (2, 2)], [(0, 1)], solver=solver, stiffness=1.0, damping=1.0)
    world.rest_length[:] = rest_length
    world.velocity[1] = velocity
    run(world, 3)
    # The direct solver caps Cs and Cd at 1 - 1e-7: what is left after three steps is 3e-14.
    assert lengths(world)[0] == pytest.approx(rest_length, abs=1e-11)
    along = world.position[1] - world.position[0]
    assert along == pytest.approx([0.0, rest_length] if velocity[1] else [rest_length, 0.0], abs=1e-11)
    assert world.position.mean(axis=0) == pytest.approx([2.0, 2.0 + 1.5 * velocity[1] / 60.0], abs=1e-11)


@every_solver
def test_a_hundred_particles_in_one_place_stay_finite(solver):
    pairs = [(k, k + 1) for k in range(99)] + [(0, k) for k in range(2, 100)]
    world = network(np.zeros((100, 2)), pairs, solver=solver, gravity=(0.0, -10.0), stiffness=0.01, damping=0.01)
    world.rest_length[:50] = 1.0
    run(world, scaled(100, 20))
    assert np.all(np.isfinite(world.position))


@every_solver
@pytest.mark.parametrize("substeps", [1, 8])
def test_pinned_particles_never_move_by_a_single_bit(solver, substeps):
    generator = np.random.default_rng(1)
    pinned = [0, 7, 31, 56, 63]
    world = grid_with_diagonals(pinned=pinned, stiffness=0.9, damping=0.1, solver=solver, gravity=(3.0, -9.81))
    world.settings = WorldSettings(gravity=(3.0, -9.81), solver=solver, substeps=substeps)
    before = world.position[pinned].copy()
    for _ in range(scaled(50, 5)):
        free = world.inverse_mass > 0.0
        world.velocity[free] += generator.uniform(-50.0, 50.0, (np.count_nonzero(free), 2))
        step(world)
    assert np.array_equal(world.position[pinned], before)
    assert not np.any(world.velocity[pinned])


def test_an_unpinned_particle_falls_again_with_the_mass_it_had():
    world = network([(0, 0)], [], masses=3.0, pinned=[0], gravity=(0.0, -6.0), tick_rate=10)
    step(world)
    world.unpin(0)
    step(world)
    assert world.inverse_mass[0] == 1.0 / 3.0
    assert world.velocity[0, 1] == pytest.approx(-0.6)
    world.pin(0)
    step(world)
    assert not np.any(world.velocity[0])


def test_a_cut_spring_pulls_no_more():
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0], solver="iterative", gravity=(0.0, -9.81))
    run(world, 5)
    world.cut([0])
    assert not np.any(world.impulse)
    before = world.velocity[1].copy()
    step(world)
    assert world.velocity[1] == pytest.approx([before[0], before[1] - 9.81 / 60.0])


def test_substep_coefficients_are_as_many_halvings_as_substeps_need():
    world = network([(0, 0), (1, 0)], [(0, 1)], stiffness=0.3, damping=0.6, substeps=8)
    expected = world.stiffness, world.damping
    for _ in range(3):
        expected = turned(*expected, np.zeros(1), 2)
    assert np.array_equal(substep_coefficients(world), expected)
    assert substep_time(world.settings) == 1.0 / 480.0
    assert (world.stiffness[0], world.damping[0]) == (0.3, 0.6)


def test_hooke_springs_are_in_newtons_per_metre_and_substeps_do_not_retune_them():
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0], substeps=64, tick_rate=60)
    world.change("law", LAW_HOOKE)
    world.hooke_stiffness[:] = 25.0
    world.position[1, 0] = 1.1
    quarter = 2.0 * math.pi / 5.0 / 4.0
    run(world, round(2 * quarter * 60))
    assert world.position[1, 0] == pytest.approx(0.9, abs=0.001)


@every_solver
def test_a_tick_is_repeatable(solver):
    hashes = set()
    for _ in range(3):
        world = grid_with_diagonals(solver=solver, gravity=(0.0, -9.81), substeps=2)
        run(world, scaled(30, 5))
        hashes.add(state_hash(world))
    assert len(hashes) == 1
