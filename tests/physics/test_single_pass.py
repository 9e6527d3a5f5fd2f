"""The article's claims about one spring and about networks in a single pass (Nissen 2019)."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, spring_energy
from sandbox.physics.analysis.stability import report
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.step import step
from tests.support.physics_scenes import SCENES, STILL, lengths, network, random_graph, run, scaled
from tests.support.wholes import part_and_whole

SUBSTEPS = (1, 2, 4, 8, 16, 32, 64)


def random_pair(generator, **options):
    """Two free particles on the x axis, the first at the origin, moving along it; rest length [m] apart or nearly."""
    masses = 10.0 ** generator.uniform(-6.0, 6.0, 2)
    rest = float(10.0 ** generator.uniform(-3.0, 3.0))
    tick_rate = int(10.0 ** generator.uniform(0.0, 4.0))
    world = network([(0, 0), (rest, 0)], [(0, 1)], masses=masses, tick_rate=tick_rate, **options)
    world.position[1, 0] = rest * generator.uniform(0.1, 3.0)
    world.velocity[:, 0] = generator.uniform(-1.0, 1.0, 2) * rest * tick_rate
    return world, rest


@pytest.mark.parametrize("springs", part_and_whole(200, 1000))
@pytest.mark.parametrize("solver", ["single_pass", "iterative"])
def test_a_rigid_spring_has_its_exact_length_after_one_step_and_is_at_rest_after_two(solver, springs):
    generator = np.random.default_rng(1)
    for _ in range(springs):
        substeps = int(generator.choice(SUBSTEPS)) if SOLVERS[solver].highest == 1.0 else 1
        world, rest = random_pair(generator, stiffness=1.0, damping=1.0, solver=solver, substeps=substeps)
        step(world)
        assert abs(lengths(world)[0] - rest) <= 1e-12 * rest
        step(world)
        assert abs(lengths(world)[0] - rest) <= 1e-12 * rest
        separating = world.velocity[1, 0] - world.velocity[0, 0]
        assert abs(separating) / world.settings.tick_rate <= 1e-12 * rest


def test_a_rigid_spring_of_several_iterative_substeps_has_lost_its_error_after_two_steps():
    generator = np.random.default_rng(1)
    for _ in range(scaled(300, 30)):
        substeps = int(generator.choice(SUBSTEPS[1:]))
        world, rest = random_pair(generator, stiffness=1.0, damping=1.0, solver="iterative", substeps=substeps)

        def error(world=world, rest=rest):
            closing = abs(world.velocity[1, 0] - world.velocity[0, 0]) / world.settings.tick_rate
            return abs(lengths(world)[0] - rest) + closing

        at_first = error()
        run(world, 2)
        assert error() <= 2e-5 * at_first


def test_a_rigid_spring_at_rest_does_not_move_at_all():
    world = network([(0, 0), (3, 4)], [(0, 1)], stiffness=1.0, damping=1.0, masses=[1e-6, 1e6])
    before = world.position.copy()
    run(world, 10)
    assert np.array_equal(world.position, before)


def test_impulse_and_force_form_give_the_same_trajectory():
    generator = np.random.default_rng(2)
    for _ in range(scaled(100, 30)):
        stiffness, damping = generator.random(2)
        world, rest = random_pair(generator, stiffness=stiffness, damping=damping)
        world.velocity *= 0.01
        h = 1.0 / world.settings.tick_rate
        mass = 1.0 / np.sum(world.inverse_mass)
        position, velocity = world.position[:, 0].copy(), world.velocity[:, 0].copy()
        for _ in range(20):
            step(world)
            side = np.sign(position[1] - position[0])
            error, closing = abs(position[1] - position[0]) - rest, side * (velocity[1] - velocity[0])
            # F = -(Cs m_r / h^2) x - (Cd m_r / h) u, then symplectic Euler.
            force = (-(stiffness * mass / h**2) * error - (damping * mass / h) * closing) * side
            velocity += np.array([-force, force]) * world.inverse_mass * h
            position += velocity * h
            assert world.position[:, 0] == pytest.approx(position, rel=1e-11, abs=1e-11 * rest)


def test_changing_the_masses_changes_nothing_about_the_length_of_one_spring():
    generator = np.random.default_rng(4)
    for _ in range(scaled(100, 30)):
        stiffness, damping = generator.random(2)
        history = []
        for masses in ([1.0, 1.0], 10.0 ** generator.uniform(-6.0, 6.0, 2)):
            world = network([(0, 0), (2, 0)], [(0, 1)], masses=masses, stiffness=stiffness, damping=damping)
            world.position[1, 0] = 2.2
            world.velocity[1, 0] = 1.0
            history.append([])
            for _ in range(30):
                step(world)
                history[-1].append(lengths(world)[0])
        assert history[1] == pytest.approx(history[0], rel=1e-11)


@pytest.mark.parametrize("substeps", SUBSTEPS)
def test_substeps_leave_the_motion_of_a_spring_from_tick_to_tick_as_it_was(substeps):
    generator = np.random.default_rng(substeps)
    pairs = [(1, 1), (0, 0), (1, 0), (0, 1), (0.3, 0), (1e-5, 1e-5), *generator.random((scaled(40, 10), 2))]
    for stiffness, damping in pairs:
        world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0], stiffness=stiffness, damping=damping, substeps=substeps)
        world.position[1, 0] = 1.1
        world.velocity[1, 0] = 0.02 * world.settings.tick_rate
        error = [0.1]
        for _ in range(12):
            step(world)
            error.append(world.position[1, 0] - 1.0)
        # The two-term recurrence of one spring: x[n+2] = (2 - Cs - Cd) x[n+1] - (1 - Cd) x[n].
        predicted = (2.0 - stiffness - damping) * np.array(error[1:-1]) - (1.0 - damping) * np.array(error[:-2])
        assert np.max(np.abs(predicted - error[2:])) <= 1e-12


@pytest.mark.parametrize("substeps", [1, 4])
def test_a_hanging_mass_sags_by_the_same_length_whatever_it_weighs(substeps):
    for mass in (1e-6, 1.0, 1e6):
        world = network(
            [(0, 0), (0, -1)], [(0, 1)], masses=[1.0, mass], pinned=[0], stiffness=0.2, damping=0.3,
            gravity=(0.0, -10.0), substeps=substeps,
        )  # fmt: skip
        run(world, 400)
        sag = lengths(world)[0] - 1.0
        if substeps == 1:
            assert sag == pytest.approx((1.0 - 0.3) * 10.0 / 60.0**2 / 0.2, rel=1e-9)
        assert sag == pytest.approx(0.0097222, rel=0.5)
        assert abs(world.velocity[1, 1]) < 1e-9


def test_a_fully_damped_spring_does_not_sag_at_all():
    world = network([(0, 0), (0, -1)], [(0, 1)], pinned=[0], stiffness=0.2, damping=1.0, gravity=(0.0, -10.0))
    run(world, 200)
    assert lengths(world)[0] == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("substeps", [1, 4])
def test_linear_momentum_is_kept_to_rounding(solver, substeps):
    generator = np.random.default_rng(6)
    for _ in range(10):
        world = random_graph(generator, decades=3.0, stiffness=0.05, damping=0.05, solver=solver, substeps=substeps)
        world.velocity[:] = generator.uniform(-1.0, 1.0, world.velocity.shape)
        before = world.mass @ world.velocity
        moved = np.sum(world.mass[:, None] * np.abs(world.velocity))
        run(world, 60)
        assert np.max(np.abs(world.mass @ world.velocity - before)) <= 1e-12 * moved


def scene_of_masses(scene, decades, generator):
    """A scene whose masses lie anywhere in so many decades about 1 kg."""
    world = SCENES[scene]()
    world.mass[:] = 10.0 ** generator.uniform(-decades / 2.0, decades / 2.0, world.particle_count)
    world.change("inverse_mass", np.where(world.inverse_mass > 0.0, 1.0 / world.mass, 0.0))
    return world, world.inverse_mass > 0.0


def energy_norm(world):
    """The square root of twice the energy, which a kick of velocities dv raises by at most the norm of dv."""
    return np.sqrt(2.0 * (kinetic_energy(world) + spring_energy(world)))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("decades", [0.0, 1.0, 6.0])
def test_at_the_article_s_limit_networks_never_hold_more_energy_than_kicks_gave(scene, decades):
    generator = np.random.default_rng(7)
    world, free = scene_of_masses(scene, decades, generator)
    springs_at_ends = np.bincount(np.concatenate([world.particle_a, world.particle_b]))
    limit = 1.0 / (springs_at_ends.max() + 1.0)
    world.set_coefficients(limit, limit, None)
    for ticks in [scaled(100, 10)] * scaled(20, 4) + [scaled(3000, 30)]:
        kick = generator.uniform(-20.0, 20.0, (np.count_nonzero(free), 2))
        given = energy_norm(world) + np.sqrt(np.sum(world.mass[free, None] * kick**2))
        world.velocity[free] += kick
        for _ in range(ticks):
            step(world)
            assert energy_norm(world) <= 1.01 * given


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("decades", [0.0, 6.0])
def test_the_linear_limit_separates_stable_from_unstable_within_5_percent(scene, decades):
    grown = {}
    for share in (0.95, 1.05):
        generator = np.random.default_rng(8)
        world, free = scene_of_masses(scene, decades, generator)
        coefficient = share * report(world).estimated_limit
        world.set_coefficients(coefficient, coefficient, None)
        world.position[free] += generator.uniform(-1e-9, 1e-9, (np.count_nonzero(free), 2))
        before = np.max(np.abs(lengths(world) - world.rest_length))
        run(world, scaled(300, 150))
        grown[share] = np.max(np.abs(lengths(world) - world.rest_length)) / before
    assert grown[0.95] < 1.0
    assert grown[1.05] > 1e3


@pytest.mark.parametrize("solver", ["single_pass", "iterative"])
def test_a_hooke_spring_is_the_textbook_spring_with_k_and_c(solver):
    stiffness, damping, h, masses = 40.0, 0.5, 1.0 / 60.0, np.array([1.0, 3.0])
    world = network([(0, 0), (1, 0)], [(0, 1)], masses=masses, solver=solver)
    world.change("law", LAW_HOOKE)
    world.hooke_stiffness[:], world.hooke_damping[:] = stiffness, damping
    world.position[1, 0] = 1.3
    position, velocity = world.position[:, 0].copy(), np.zeros(2)
    for _ in range(200):
        step(world)
        force = -stiffness * (position[1] - position[0] - 1.0) - damping * (velocity[1] - velocity[0])
        velocity += np.array([-force, force]) / masses * h
        position += velocity * h
        assert world.position[:, 0] == pytest.approx(position, abs=1e-12)
    assert abs(position[1] - position[0] - 1.0) < 0.3


def hooke_pair(stiffness, damping=0.0):
    world = network([(0, 0), (1, 0)], [(0, 1)], pinned=[0])
    world.change("law", LAW_HOOKE)
    world.hooke_stiffness[:], world.hooke_damping[:] = stiffness, damping
    world.position[1, 0] = 1.001
    return world


def test_a_hooke_spring_explodes_past_k_h_squared_of_4_masses_and_not_before():
    limit = 4.0 * 60.0**2
    calm, wild = hooke_pair(0.95 * limit), hooke_pair(1.05 * limit)
    run(calm, 2000)
    run(wild, 2000)
    assert abs(calm.position[1, 0] - 1.0) < 0.01
    assert not abs(wild.position[1, 0]) < 100.0


@pytest.mark.parametrize("solver", ["single_pass", "iterative"])
def test_nothing_that_blows_up_moves_what_is_pinned(solver):
    world = network([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2), (0, 2)], pinned=[0], solver=solver)
    world.change("law", LAW_HOOKE, slice(2))
    world.hooke_stiffness[:2] = 1e9
    world.position[1, 0] = 1.001
    run(world, 400)
    assert world.contained
    assert np.all(np.isfinite(world.position))
    assert np.array_equal(world.position[0], STILL)
    assert np.array_equal(world.velocity[0], STILL)
