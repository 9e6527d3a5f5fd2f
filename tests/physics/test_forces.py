"""Gravity scale, wind, drag and motors."""

import numpy as np
import pytest

from sandbox.physics.actuators import Actuators, Motors
from sandbox.physics.energy import gravity_energy, kinetic_energy, total_energy
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import network, run

SOFT = {"single_pass": (0.05, 0.1), "iterative": (0.3, 0.9), "direct": (0.5, 0.9)}


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_each_particle_falls_by_its_own_gravity(solver):
    world = network([(0, 0), (5, 0), (9, 0)], [], gravity=(0.0, -10.0), solver=solver)
    world.gravity_scale[:] = [1.0, 0.0, -0.5]
    run(world, 60)
    assert world.velocity[:, 1] == pytest.approx([-10.0, 0.0, 5.0])
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
        assert np.abs(world.velocity).max() <= 3.0 * (1.0 + 1e-9)
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


def wheel(solver, *, mount=True, pinned=(), speed=6.0, torque=20.0):
    """A wheel of six spokes about slot 0, motor and all; mount: slots 7 and 8 are joined to its hub."""
    angles = np.arange(6) * np.pi / 3.0
    points = [(0, 0), *np.stack([np.cos(angles), np.sin(angles)], axis=1).tolist(), (0.3, -2.0), (-0.3, -2.0)]
    springs = [(0, k) for k in range(1, 7)] + [(k, k % 6 + 1) for k in range(1, 7)]
    springs += [(0, 7), (0, 8), (7, 8)] if mount else []
    stiffness, damping = SOFT[solver]
    world = network(
        points, springs, masses=[1, 1, 1, 1, 1, 1, 1, 3, 5], pinned=pinned, solver=solver, stiffness=stiffness,
        damping=damping,
    )  # fmt: skip
    rim = np.arange(1, 7)
    motors = Motors(
        np.array([0]), np.array([speed]), np.array([torque]), np.array([0]), np.array([0, 6]), rim
    )  # fmt: skip
    world.fit(Actuators(("wheel",), motors=motors), [1.0])
    return world


def spin(world, group):
    """Angular velocity [rad/s] of a group of slots about its centre of mass."""
    mass = world.mass[group, None]
    r = world.position[group] - (mass * world.position[group]).sum(0) / mass.sum()
    v = world.velocity[group] - (mass * world.velocity[group]).sum(0) / mass.sum()
    return float((mass[:, 0] * (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0])).sum() / (mass * r * r).sum())


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_motor_turns_wheel_and_mount_against_each_other_and_keeps_momentum(solver):
    world = wheel(solver)
    for _ in range(180):
        step(world)
        assert np.abs(world.mass @ world.velocity).max() <= 1e-11
    if solver != "direct":  # whose springs act along directions ahead, which keeps no angular momentum to the bit
        x, v = world.position, world.velocity
        assert abs(np.sum(world.mass * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))) <= 1e-11
    assert spin(world, np.arange(1, 7)) > 0.5
    assert spin(world, np.array([0, 7, 8])) < -0.1


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_motor_on_a_pinned_hub_reaches_its_speed_and_stops_driving_at_value_0(solver):
    world = wheel(solver, mount=False, pinned=(0,), torque=1e6)
    run(world, 120)
    assert spin(world, np.arange(1, 7)) == pytest.approx(6.0, rel=0.05)
    world.drive(0, -0.5)
    run(world, 120)
    assert spin(world, np.arange(1, 7)) == pytest.approx(-3.0, rel=0.05)
    world.drive(0, 0.0)
    world.settings = type(world.settings)(gravity=(0.0, 0.0), solver=solver, drag=2.0)
    run(world, 300)
    assert abs(spin(world, np.arange(1, 7))) < 0.1


def test_a_motor_gives_no_more_than_its_torque():
    world = wheel("direct", mount=False, pinned=(0,), speed=1e3, torque=3.0)
    run(world, 30)
    # 3 N m on 6 kg m^2 for half a second.
    assert spin(world, np.arange(1, 7)) == pytest.approx(0.25, rel=0.01)


def test_a_motor_without_anything_to_push_against_does_nothing():
    world = wheel("iterative", mount=False)
    run(world, 60)
    assert np.abs(world.velocity).max() == 0.0


def test_a_wheel_of_which_a_particle_is_pinned_turns_its_mount_instead():
    world = wheel("iterative", pinned=(2,), torque=0.5)
    step(world)
    assert np.all(world.velocity[2] == 0.0)
    assert spin(world, np.array([0, 7, 8])) < 0.0
