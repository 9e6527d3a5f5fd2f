"""Gravity scale, wind and drag; orbits about springs of rest length 0, whose ellipses keep their axes."""

import math

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


def orbiting(stiffness, damping, speed, *, pinned=(0,), **settings):
    """A particle at 1.2 m from another, sideways at this speed, on a spring of rest length 0."""
    world = network(
        [(0.0, 0.0), (1.2, 0.0)], [(0, 1)], masses=[4.0, 1.0], pinned=pinned, stiffness=stiffness, damping=damping,
        **settings,
    )  # fmt: skip
    world.change("rest_length", 0.0)
    world.change("velocity", np.array([[0.0, -speed / 4.0 if not pinned else 0.0], [0.0, speed]]))
    return world


def axes(world, ticks):
    """Longest and shortest distance of the two."""
    found = []
    for _ in range(ticks):
        step(world)
        found.append(float(np.hypot(*(world.position[1] - world.position[0]))))
    return max(found), min(found)


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("pinned", [(0,), ()])
@pytest.mark.parametrize(("stiffness", "speed"), [(0.004, 2.0), (0.02, 9.0), (0.06, 4.0)])
def test_an_orbit_about_a_spring_of_length_0_keeps_its_axes_for_a_minute(solver, substeps, pinned, stiffness, speed):
    world = orbiting(stiffness, 0.0, speed, pinned=pinned, solver=solver, substeps=substeps)
    # k = Cs m_r / h^2, whatever the masses; it goes at its speed against the other.
    against = speed if pinned else 1.25 * speed
    across = against / (60.0 * math.sqrt(stiffness))
    first = axes(world, 300)
    last = axes(world, 3300)
    assert first == pytest.approx((max(1.2, across), min(1.2, across)), rel=0.02)
    assert last == pytest.approx(first, rel=0.01)


@pytest.mark.parametrize(("stiffness", "damping"), [(0.02, 0.001), (0.05, 0.01), (0.02, 0.02)])
def test_damping_makes_such_an_orbit_the_same_circle_in_every_solver(stiffness, damping):
    found = [axes_after(orbiting(stiffness, damping, 5.0, solver=solver), 600) for solver in SOLVERS]
    for one in found:
        assert one == pytest.approx(found[0], rel=0.02)


def axes_after(world, ticks):
    """The axes of ten seconds, after so many ticks."""
    axes(world, ticks)
    return axes(world, 600)
