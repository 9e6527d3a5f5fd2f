"""The iterative, warm-started solver: a literal transcription of it, the wrecking ball, its state."""

import numpy as np
import pytest

from sandbox.physics.analysis.query import strain
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.step import step
from tests.support.physics_scenes import grid, grid_with_diagonals, lengths, network, random_graph, run, scaled


def textbook_step(world, accumulated):
    """One tick of one substep, written as the five lines of the method, on arrays of its own; returns x and v."""
    settings, h = world.settings, 1.0 / world.settings.tick_rate
    position, velocity, inverse = world.position.copy(), world.velocity.copy(), world.inverse_mass
    velocity[inverse > 0.0] += np.array(settings.gravity) * h
    change, springs = np.zeros_like(velocity), []
    lightest = [
        min((w for w in inverse[[a, b]] if w > 0.0), default=np.inf)
        for a, b in zip(world.particle_a, world.particle_b, strict=True)
    ]
    for s in np.argsort(lightest, kind="stable"):
        a, b = world.particle_a[s], world.particle_b[s]
        if not world.spring_active[s] or inverse[a] + inverse[b] == 0.0:
            accumulated[s] = 0.0
            continue
        separation = position[b] - position[a]
        n = separation / np.linalg.norm(separation)
        x = np.linalg.norm(separation) - world.rest_length[s]
        u = n @ (velocity[b] - velocity[a])
        wanted = -(world.stiffness[s] * x / h + world.damping[s] * u)
        springs.append((s, a, b, n, wanted, 1.0 / (inverse[a] + inverse[b])))
        pulled = n @ accumulated[s]
        if pulled < 0.0:
            change[a] -= settings.warm_start * pulled * n * inverse[a]
            change[b] += settings.warm_start * pulled * n * inverse[b]
        accumulated[s] = 0.0
    for _ in range(settings.iterations):
        for s, a, b, n, wanted, mass in springs:
            impulse = -(n @ (change[b] - change[a]) - wanted) * mass * n
            change[a] -= impulse * inverse[a]
            change[b] += impulse * inverse[b]
            accumulated[s] += impulse
    velocity += change
    return position + velocity * h, velocity


@pytest.mark.parametrize("warm_start", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("iterations", [1, 10])
def test_a_tick_is_the_five_lines_of_the_method(warm_start, iterations):
    generator = np.random.default_rng(1)
    for pinned in (0, 2):
        world = random_graph(generator, decades=1.0, pinned=pinned, stiffness=0.2, damping=0.8)
        world.settings = WorldSettings(
            gravity=(1.0, -9.81), solver="iterative", iterations=iterations, warm_start=warm_start
        )
        world.cut([3])
        # The method, without the half step that what flies begins with.
        world.unmoved[:] = False
        accumulated = world.impulse.copy()
        for _ in range(5):
            expected = textbook_step(world, accumulated)
            step(world)
            assert world.position == pytest.approx(expected[0], rel=1e-9, abs=1e-9)
            assert world.velocity == pytest.approx(expected[1], rel=1e-9, abs=1e-7)
            assert world.impulse == pytest.approx(accumulated, rel=1e-8, abs=1e-6)


@pytest.mark.parametrize("warm_start", [0.0, 0.5])
@pytest.mark.parametrize("iterations", [1, 4, 10])
def test_one_spring_moves_as_it_does_in_a_single_pass_whatever_the_iterations(iterations, warm_start):
    generator = np.random.default_rng(2)
    for _ in range(scaled(50, 20)):
        masses, (stiffness, damping) = 10.0 ** generator.uniform(-6.0, 6.0, 2), generator.random(2)
        velocity = generator.uniform(-10.0, 10.0, (2, 2))
        history = []
        for solver in ("single_pass", "iterative"):
            world = network([(0, 0), (3, 4)], [(0, 1)], masses=masses, stiffness=stiffness, damping=damping)
            world.settings = WorldSettings((0.0, -9.81), solver=solver, iterations=iterations, warm_start=warm_start)
            world.velocity[:] = velocity
            run(world, 30)
            history.append(world.position.copy())
        assert history[1] == pytest.approx(history[0], rel=1e-9, abs=1e-9)


def wrecking_ball(warm_start, iterations=10):
    """12 springs of 30 m, the end mass 1000 times the others, dropped from horizontal."""
    world = network(
        [(30.0 * k, 0.0) for k in range(13)], [(k, k + 1) for k in range(12)], masses=[1.0] * 12 + [1000.0],
        pinned=[0], stiffness=1.0, damping=1.0, gravity=(0.0, -20.0), solver="iterative", iterations=iterations,
        warm_start=warm_start,
    )  # fmt: skip
    worst = 0.0
    for _ in range(600):
        step(world)
        worst = max(worst, float(np.max(np.abs(strain(world)))))
    return worst


@pytest.mark.parametrize(
    ("warm_start", "required", "reached"), [(0.0, 0.06, 0.056), (0.5, 0.042, 0.0376), (1.0, 0.032, 0.0292)]
)
def test_the_wrecking_ball_s_chain_stretches_no_more_than_in_the_author_s_demo(warm_start, required, reached):
    worst = wrecking_ball(warm_start)
    assert worst <= required
    assert worst == pytest.approx(reached, abs=0.001)


def test_more_iterations_halve_the_wrecking_ball_s_strain():
    strains = [wrecking_ball(0.5, iterations) for iterations in (5, 10, 20)]
    assert strains == pytest.approx([0.076, 0.0376, 0.019], rel=0.05)


def test_pushing_impulses_are_not_used_again():
    histories = []
    for warm_start in (0.0, 1.0):
        world = network([(0, 0), (1, 0), (2.0, 0)], [(0, 1), (1, 2)], pinned=[0], stiffness=0.3, damping=0.3)
        world.settings = WorldSettings((0.0, 0.0), solver="iterative", iterations=4, warm_start=warm_start)
        world.position[2, 0] = 1.5
        step(world)
        assert np.all(world.impulse[:, 0] >= 0.0) and world.impulse[1, 0] > 0.0
        step(world)
        histories.append(world.position.copy())
    assert np.array_equal(*histories)


def test_without_a_warm_start_the_sums_decide_nothing():
    worlds = [grid(solver="iterative", warm_start=0.0, gravity=(0.0, -9.81)) for _ in range(2)]
    for _ in range(scaled(20, 5)):
        for world in worlds:
            step(world)
        worlds[1].impulse[:] = 0.0
    assert np.array_equal(worlds[0].position, worlds[1].position)


def test_the_sums_are_state_without_which_a_warm_start_goes_elsewhere():
    worlds = [grid(solver="iterative", warm_start=0.5, gravity=(0.0, -9.81)) for _ in range(2)]
    for world in worlds:
        run(world, 5)
    worlds[1].impulse[:] = 0.0
    for world in worlds:
        run(world, 1)
    assert not np.array_equal(worlds[0].position, worlds[1].position)


def test_the_usual_settings_hold_a_mesh_together_that_the_single_pass_blows_up():
    spread = {}
    for solver in ("single_pass", "iterative"):
        world = grid_with_diagonals(stiffness=0.2, damping=0.9, solver=solver, gravity=(0.0, -9.81))
        with np.errstate(all="ignore"):
            run(world, scaled(300, 40))
            spread[solver] = float(np.max(np.nan_to_num(np.abs(lengths(world)), nan=np.inf)))
    assert spread["iterative"] < 2.0
    assert spread["single_pass"] > 5.0


def test_hooke_springs_act_once_whatever_the_iterations():
    positions = []
    for iterations in (1, 50):
        world = network([(0, 0), (1, 0)], [(0, 1)], solver="iterative", iterations=iterations)
        world.change("law", LAW_HOOKE)
        world.hooke_stiffness[:] = 100.0
        world.position[1, 0] = 1.2
        run(world, 20)
        positions.append(world.position.copy())
        assert not np.any(world.impulse)
    assert np.array_equal(*positions)
