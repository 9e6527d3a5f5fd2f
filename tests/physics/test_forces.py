"""Gravity scale, wind and drag."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, total_energy
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import network, run

SOFT = {"single_pass": (0.05, 0.1), "iterative": (0.3, 0.9), "direct": (0.5, 0.9)}


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_each_particle_falls_by_its_own_gravity(solver):
    world = network([(0, 0), (5, 0), (9, 0)], [], gravity=(0.0, -10.0), solver=solver)
    world.gravity_scale[:] = [1.0, 0.0, -0.5]
    run(world, 60)
    assert world.position[:, 1] == pytest.approx([-5.0, 0.0, 2.5], rel=1e-12)
    # Half a step behind.
    assert world.velocity[:, 1] == pytest.approx([-10.0 * 59.5 / 60.0, 0.0, 5.0 * 59.5 / 60.0])
    expected = sum(10.0 * scale * y for scale, y in zip((1.0, 0.0, -0.5), world.position[:, 1], strict=True))
    assert gravity_energy(world) == pytest.approx(expected)


def test_the_direct_solver_bounds_the_energy_of_a_balloon_on_a_string():
    world = network([(0, 0), (0, 1), (0.5, 1.5)], [(0, 1), (1, 2)], pinned=(0,), gravity=(0.0, -9.81), solver="direct")
    world.set_coefficients(0.9, 0.95, None)
    world.gravity_scale[:] = [1.0, 1.0, -4.0]
    allowed = total_energy(world)
    for _ in range(600):
        step(world)
        # Symplectic Euler gives falling bodies h g v more than their height, hence the tolerance.
        assert total_energy(world) <= allowed + 0.05 * 9.81
    assert world.position[2, 1] > 1.6


def test_drag_takes_velocity_towards_the_wind_at_its_rate_whatever_the_mass():
    world = network([(0, 0), (5, 0)], [], masses=[1e-6, 1e6], wind=(4.0, 0.0), drag=2.0, tick_rate=1000)
    run(world, 500)
    # One second of rate 1 per second: e^-1 of the difference is left.
    assert world.velocity[:, 0] == pytest.approx(4.0 * (1.0 - np.exp(-1.0)), rel=2e-3)
    assert world.velocity[0, 0] == world.velocity[1, 0]


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("drag", [1e-3, 60.0, 1e6])
def test_drag_never_overshoots_the_wind_and_spares_pinned_particles(solver, drag):
    stiffness, damping = SOFT[solver]
    world = network(
        [(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2)], pinned=(0,), solver=solver, wind=(0.0, 3.0), drag=drag,
        stiffness=stiffness, damping=damping,
    )  # fmt: skip
    before = 0.0
    for _ in range(30):
        step(world)
        assert np.all(world.velocity[0] == 0.0)
        # Of a step's end: on the way there, a chord of its arc, what turns is slower by the square of its turn.
        assert np.abs(world.velocity).max() <= 3.0 * (1.0 + 1e-3)
        before = max(before, world.velocity[2, 1])
    assert before > 0.0


def test_drag_without_wind_only_takes_energy_out():
    world = network([(0, 0), (1, 0)], [(0, 1)], solver="direct", drag=3.0, stiffness=0.3, damping=0.4)
    world.velocity[:] = [(1.0, 2.0), (-3.0, 4.0)]
    energy = total_energy(world)
    for _ in range(120):
        step(world)
        assert total_energy(world) <= energy * (1.0 + 1e-12)
        energy = max(total_energy(world), 0.95 * energy)
    assert kinetic_energy(world) < 1e-3
