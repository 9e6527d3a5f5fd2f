"""Muscles and hydraulics: rest lengths that follow a wave or a value."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, reduced_masses, spring_energy, spring_lengths, total_energy
from sandbox.physics.driving import Actuators, Hydraulics, Muscles, wave
from sandbox.physics.equation import implicit_spring_constant
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import network, random_graph, run, scaled


def driven(world, *, amplitude=0.3, period=20, phase=0.0):
    """The world with spring 0 as a muscle and its last spring as a hydraulic of 0.5 to 2 m at 3 m/s."""
    last = world.spring_count - 1
    muscles = Muscles(np.array([0]), np.array([amplitude]), np.array([period]), np.array([phase]))
    hydraulics = Hydraulics(np.array([last]), np.array([0.5]), np.array([2.0]), np.array([3.0]), np.array([0]))
    world.fit(Actuators(("jack",), muscles, hydraulics), [0.0])
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


STIFF = {"single_pass": (0.5, 0.9), "iterative": (1.0, 1.0), "direct": (1.0, 1.0)}


def jack(solver, share, *, substeps=1, start=1.0, value=1.0):
    """A hydraulic of 0.5 to 2 m at 0.6 m/s below 10 kg, on a pin; its force: a share of their weight."""
    stiffness, damping = STIFF[solver]
    world = network(
        [(0.0, 0.0), (0.0, start)], [(0, 1)], masses=[1.0, 10.0], pinned=(0,), gravity=(0.0, -10.0), solver=solver,
        substeps=substeps, stiffness=stiffness, damping=damping,
    )  # fmt: skip
    hydraulics = Hydraulics(
        np.array([0]), np.array([0.5]), np.array([2.0]), np.array([0.6]), np.array([0]), np.array([share * 100.0])
    )
    world.fit(Actuators(("jack",), hydraulics=hydraulics), [value])
    return world


@pytest.mark.parametrize("solver", list(SOLVERS))
@pytest.mark.parametrize("substeps", [1, 4, "auto"])
def test_a_hydraulic_of_limited_force_lifts_exactly_what_that_carries(solver, substeps):
    weak = run(jack(solver, 0.9, substeps=substeps), 30)
    # A tenth of the weight is left.
    assert weak.velocity[1, 1] == pytest.approx(-0.1 * 10.0 * 30 / 60, rel=1e-9)
    strong = run(jack(solver, 1.1, substeps=substeps), 60)
    height = strong.position[1, 1]
    assert run(strong, 20).position[1, 1] - height == pytest.approx(0.6 * 20 / 60, rel=0.03)
    free = run(jack(solver, np.inf, substeps=substeps), 60)
    assert free.position[1, 1] == pytest.approx(1.6, abs=0.02)


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_hydraulic_that_was_held_back_does_not_leap_when_it_is_let_go(solver):
    world = jack(solver, 2.0)
    world.pin(1)
    run(world, 90)
    assert world.rest_length[0] < 1.2
    world.unpin(1)
    for _ in range(30):
        step(world)
        # Wound up it would start at 54 m/s.
        assert world.velocity[1, 1] <= 1.0


@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_muscle_of_limited_force_swings_less_where_it_is_too_weak(solver):
    stiffness, damping = STIFF[solver]
    widths = []
    for force in (5.0, 1e6):
        world = network(
            [(0.0, 0.0), (1.0, 0.0)], [(0, 1)], masses=[1.0, 4.0], pinned=(0,), solver=solver, stiffness=stiffness,
            damping=damping,
        )  # fmt: skip
        muscles = Muscles(np.array([0]), np.array([0.3]), np.array([40]), np.array([0.0]), np.array([force]))
        world.fit(Actuators((), muscles), [])
        places = []
        for _ in range(120):
            before = world.velocity[1, 0]
            step(world)
            places.append(world.position[1, 0])
            assert abs(world.velocity[1, 0] - before) * 4.0 * 60 <= force * (1.0 + 1e-9)
        widths.append(max(places) - min(places))
    assert widths[0] < 0.4 and widths[1] > 0.5


def test_a_body_that_only_a_hydraulic_of_limited_force_holds_to_another_is_solved_with_it():
    points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
    world = network(points, [(0, 1), (2, 3), (0, 2), (1, 3)], masses=2.0, solver="direct", stiffness=1.0, damping=1.0)
    hydraulics = Hydraulics(
        np.array([2, 3]), np.full(2, 0.5), np.full(2, 2.0), np.full(2, 0.5), np.array([0, 0]), np.full(2, 8.0)
    )
    world.fit(Actuators(("jack",), hydraulics=hydraulics), [1.0])
    for _ in range(60):
        step(world)
        assert np.abs(world.mass @ world.velocity).max() <= 1e-9
    assert world.position[2:, 1] - world.position[:2, 1] == pytest.approx([1.5, 1.5], abs=0.05)
    kept = take(world)
    expected = [state_hash(run(world, 5)) for _ in range(2)]
    restore(world, kept)
    assert [state_hash(run(world, 5)) for _ in range(2)] == expected


def stored(world, springs, force):
    """Energy of motion, of all other springs, and of these, which stretch on at their force once they give way."""
    active = world.spring_active.copy()
    world.change("spring_active", False, springs)
    others = spring_energy(world)
    world.change("spring_active", active)
    constant = implicit_spring_constant(
        world.stiffness[springs], world.damping[springs], reduced_masses(world)[springs], 1.0 / 60.0
    )
    error = np.abs(spring_lengths(world)[springs] - world.rest_length[springs])
    beyond = force * error - 0.5 * force * force / np.maximum(constant, 1e-300)
    return kinetic_energy(world) + others + np.where(constant * error <= force, 0.5 * constant * error**2, beyond).sum()


@pytest.mark.parametrize("speed", [3.0, 60.0])
def test_springs_of_limited_force_give_a_violent_network_no_energy(speed):
    for seed in range(scaled(6, 2)):
        generator = np.random.default_rng(seed)
        damping = float(10.0 ** generator.uniform(-2.0, 0.0))
        world = random_graph(
            generator, decades=2.0, solver="direct", stiffness=damping * float(generator.uniform(0.1, 1.0)),
            damping=damping,
        )  # fmt: skip
        springs, force = generator.choice(24, 6, replace=False), 10.0 ** generator.uniform(-1.0, 4.0, 6)
        lengths = world.rest_length[springs]
        hydraulics = Hydraulics(
            springs, 0.5 * lengths, 2.0 * lengths, np.zeros(6), np.zeros(6, dtype=np.int64), force
        )  # fmt: skip
        world.fit(Actuators(("jack",), hydraulics=hydraulics), [0.0])
        world.velocity[:] = generator.normal(0.0, speed, world.velocity.shape)
        energy = stored(world, springs, force)
        for _ in range(scaled(120, 15)):
            step(world)
            assert stored(world, springs, force) <= energy * (1.0 + 1e-9)


def returning(world, first=1.0):
    """The world with its last spring as a hydraulic of 0.5 to 2 m at 3 m/s that goes back to its first length."""
    last = np.array([world.spring_count - 1])
    one = np.array([0])
    hydraulics = Hydraulics(last, np.array([0.5]), np.array([2.0]), np.array([3.0]), one, returns=np.array([True]))
    world.fit(Actuators(("jack",), Muscles(), hydraulics), [0.0])
    assert world.natural_length[last[0]] == first
    return world


@pytest.mark.parametrize("value", [1.0, -1.0, 0.25])
@pytest.mark.parametrize("solver", list(SOLVERS))
def test_a_hydraulic_that_returns_goes_back_to_its_first_length_at_its_rate_and_stays_there(solver, value):
    world = returning(chain(solver))
    world.actuator_value[0] = value
    run(world, 8)
    driven_to = world.rest_length[-1]
    assert driven_to == pytest.approx(min(max(1.0 + 8 * value * 3.0 / 60.0, 0.5), 2.0))
    world.actuator_value[0] = 0.0
    lengths = []
    for _ in range(40):
        step(world)
        lengths.append(world.rest_length[-1])
    steps = np.abs(np.diff([driven_to, *lengths]))
    assert steps.max() <= 3.0 / 60.0 + 1e-12
    assert lengths[-1] == 1.0 and np.argmax(np.array(lengths) == 1.0) <= 20
    assert all(length == 1.0 for length in lengths[20:])


def test_a_hydraulic_that_does_not_return_runs_bit_for_bit_as_one_that_was_never_asked():
    worlds = [chain(), returning(chain())]
    for world in worlds:
        world.actuator_value[0] = 1.0
        run(world, 30)
    assert worlds[0].rest_length[-1] == worlds[1].rest_length[-1] == 2.0
    for world in worlds:
        world.actuator_value[0] = 0.0
        run(world, 10)
    assert worlds[0].rest_length[-1] == 2.0 > worlds[1].rest_length[-1]
