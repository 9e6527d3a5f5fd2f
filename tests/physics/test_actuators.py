"""Muscles and hydraulics: rest lengths that follow a wave or a value."""

import numpy as np
import pytest

from sandbox.physics.actuators import Actuators, Hydraulics, Muscles
from sandbox.physics.driving import drive_muscles, wave
from sandbox.physics.energy import kinetic_energy, spring_energy, total_energy
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import network, run


def driven(world, *, amplitude=0.3, period=20, phase=0.0):
    """The world with spring 0 as a muscle and its last spring as a hydraulic of 0.5 to 2 m at 3 m/s."""
    last = world.spring_count - 1
    muscles = Muscles(np.array([0]), np.array([amplitude]), np.array([period]), np.array([phase]))
    hydraulics = Hydraulics(np.array([last]), np.array([0.5]), np.array([2.0]), np.array([3.0]), np.array([0]))
    world.fit(Actuators(("jack",), muscles, hydraulics), [0.0])
    drive_muscles(world, 0)
    return world


def chain(solver="direct", **options):
    """Four particles in a row, 1 m apart, in space."""
    stiffness, damping = (0.2, 0.2) if solver == "single_pass" else (0.8, 0.9)
    points = [(k, 0.0) for k in range(4)]
    given = {"stiffness": stiffness, "damping": damping, **options}
    return driven(network(points, [(0, 1), (1, 2), (2, 3)], masses=[1.0, 2.0, 3.0, 4.0], solver=solver, **given))


def test_the_wave_goes_up_and_down_once_a_period_smoothly():
    values = np.array([wave(tick, 400, 0.0) for tick in range(801)])
    assert values[[0, 100, 200, 300, 400]].tolist() == [0.0, 1.0, 0.0, -1.0, 0.0]
    assert np.array_equal(values[:401], values[400:])
    assert np.abs(np.diff(values)).max() < 0.021
    # Never more than 6 % from a sine of the same period.
    assert np.abs(values - np.sin(2.0 * np.pi * np.arange(801) / 400)).max() < 0.06


def test_phase_moves_the_wave_ahead_by_a_part_of_the_period():
    assert [wave(tick, 8, 0.25) for tick in range(8)] == [wave(tick + 2, 8, 0.0) for tick in range(8)]
    assert wave(3, 8, 1.0) == wave(3, 8, 0.0)


def test_a_muscles_rest_length_is_that_of_its_tick_and_repeats_exactly():
    world, lengths = chain(), []
    for _ in range(61):
        lengths.append(world.rest_length[0])
        assert world.rest_length[0] == 1.0 + 0.3 * wave(world.tick, 20, 0.0)
        step(world)
    assert lengths[:20] == lengths[20:40] == lengths[40:60]
    assert len(set(lengths)) > 8


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_driven_springs_keep_the_momentum_of_a_body_in_space(solver):
    world = chain(solver)
    world.drive(0, 1.0)
    fastest = 0.0
    for _ in range(200):
        step(world)
        fastest = max(fastest, np.abs(world.velocity).max())
        assert np.abs(world.mass @ world.velocity).max() <= 1e-12
    assert fastest > 0.1


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_hydraulic_goes_to_its_ends_at_its_rate_and_stays(solver):
    world = chain(solver)
    world.drive(0, 0.5)
    run(world, 20)
    assert world.rest_length[2] == pytest.approx(1.5)
    world.drive(0, 0.0)
    run(world, 20)
    assert world.rest_length[2] == pytest.approx(1.5)
    world.drive(0, 1.0)
    run(world, 60)
    assert world.rest_length[2] == 2.0
    world.drive(0, -1.0)
    run(world, 60)
    assert world.rest_length[2] == 0.5
    run(world, 120)
    assert abs(world.position[3, 0] - world.position[2, 0]) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize(("stiffness", "damping", "bound"), [(0.8, 0.9, 1.0), (1.0, 1.0, 1.0), (0.9, 0.2, 4.0)])
def test_a_driven_body_gains_at_most_the_work_that_its_drives_do(stiffness, damping, bound, substeps):
    world = chain(stiffness=stiffness, damping=damping, substeps=substeps)
    allowed = total_energy(world)
    for tick in range(400):
        world.drive(0, float(tick // 40 % 3 - 1))
        before = spring_energy(world)
        # The work: what a change of rest lengths alone adds to the springs, at the places where the tick begins.
        ahead = take(world)
        step(world)
        lengths = world.rest_length.copy()
        after = take(world)
        restore(world, ahead)
        world.rest_length[:] = lengths
        work = spring_energy(world) - before
        restore(world, after)
        allowed += work if bound == 1.0 else max(0.0, work)
        assert total_energy(world) <= bound * allowed * (1.0 + 1e-9) + 1e-9
    assert kinetic_energy(world) > 0.0


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_driven_world_resumes_from_every_snapshot_bit_for_bit(solver):
    world = chain(solver, substeps=2)
    snapshots, hashes = [], []
    for tick in range(60):
        world.drive(0, 1.0 if tick % 30 < 15 else -0.7)
        snapshots.append(take(world))
        step(world)
        hashes.append(state_hash(world))
    assert len(set(hashes)) == 60
    restore(world, snapshots[37])
    for tick in range(37, 60):
        world.drive(0, 1.0 if tick % 30 < 15 else -0.7)
        step(world)
        assert state_hash(world) == hashes[tick]
