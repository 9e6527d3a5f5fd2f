"""Energy: by hand on small worlds, kept where it should be."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import (
    gravity_energy,
    kinetic_energy,
    reduced_masses,
    spring_energy,
    spring_lengths,
)
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.physics_scenes import network, run


def test_kinetic_and_gravity_energy_count_free_active_particles():
    world = network([(0, 0), (1, 3), (2, 5)], [], masses=[1.0, 2.0, 4.0], pinned=[0], gravity=(0.0, -10.0))
    world.velocity[1:] = [(3.0, 4.0), (1.0, 0.0)]
    assert kinetic_energy(world) == pytest.approx(0.5 * 2.0 * 25.0 + 0.5 * 4.0)
    assert gravity_energy(world) == pytest.approx(10.0 * (2.0 * 3.0 + 4.0 * 5.0))
    world.change("particle_active", False, 2)
    assert kinetic_energy(world) == pytest.approx(25.0)
    assert gravity_energy(world) == pytest.approx(60.0)


def test_a_moving_hand_has_no_energy():
    world = network([(0, 0)], [])
    world.reserve_grabs()
    world.hold(0, 0, (1.0, 1.0))
    world.move_grab(0, (9.0, 9.0))
    assert kinetic_energy(world) == 0.0


def test_spring_energy_is_half_k_x_squared_with_the_k_of_cs():
    world = network([(0, 0), (1.0, 0)], [(0, 1)], masses=[1.0, 3.0], stiffness=0.2)
    world.position[1, 0] = 1.5
    assert reduced_masses(world)[0] == pytest.approx(0.75)
    assert spring_lengths(world)[0] == pytest.approx(1.5)
    assert spring_energy(world) == pytest.approx(0.5 * (0.2 * 0.75 * 60.0**2) * 0.25)
    world.change("spring_active", False)
    assert spring_energy(world) == 0.0


def test_a_hooke_spring_stores_energy_by_its_own_k_and_a_pinned_pair_none():
    world = network([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2)], pinned=[0, 1])
    world.change("law", [0, LAW_HOOKE])
    world.hooke_stiffness[1] = 8.0
    world.rest_length[:] = 0.5
    assert spring_energy(world) == pytest.approx(0.5 * 8.0 * 0.25)


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_soft_undamped_spring_keeps_its_energy_and_a_damped_one_loses_it(solver):
    for damping in (0.0, 0.01):
        world = network([(0, 0), (1, 0)], [(0, 1)], stiffness=1e-4, damping=damping, solver=solver)
        world.position[1, 0] = 1.2
        start, lowest, highest = spring_energy(world), np.inf, 0.0
        for _ in range(2000):
            step(world)
            energy = kinetic_energy(world) + spring_energy(world)
            lowest, highest = min(lowest, energy), max(highest, energy)
        assert highest <= 1.02 * start
        assert lowest >= 0.98 * start if damping == 0.0 else energy < 1e-6 * start


def test_a_falling_particle_turns_gravity_energy_into_motion():
    world = network([(0, 100)], [], masses=2.0, gravity=(0.0, -9.81))
    before = gravity_energy(world)
    run(world, 120)
    assert gravity_energy(world) + kinetic_energy(world) == pytest.approx(before, rel=0.01)


def test_an_empty_world_has_no_energy():
    assert (kinetic_energy(World()), spring_energy(World()), gravity_energy(World())) == (0.0, 0.0, 0.0)
