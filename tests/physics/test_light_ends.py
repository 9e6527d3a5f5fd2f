"""Light particles that a hand, a muscle or a hydraulic drives, with much weight behind them."""

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy
from sandbox.physics.driving import Actuators, Hydraulics
from sandbox.physics.step import step
from tests.support.hands import world_of
from tests.support.physics_scenes import network, run, scaled

GRAVITY = 9.81


def string(load, links=1, stiffness=1.0, damping=1.0, **settings):
    """A string of 1.5 m down from slot 0, of particles of 0.5 kg, with a load of so many times that at its end."""
    points = [(0.0, -1.5 * k / links) for k in range(links + 1)]
    masses = [0.5] * links + [0.5 * load]
    return network(
        points, [(k, k + 1) for k in range(links)], masses=masses, gravity=(0.0, -GRAVITY), solver="iterative",
        stiffness=stiffness, damping=damping, **settings,
    )  # fmt: skip


def weight(world):
    """What all that can move weighs [N]."""
    return float(np.sum(world.mass[world.particle_active & (world.inverse_mass > 0.0)])) * GRAVITY


def hangs_still(world, ticks=480):
    """Whether hand 0 comes to bear all that hangs on it, a few millimetres below where it wants it, without motion."""
    held = int(world.particle_b[world.grab_spring])
    place = world.position[held].copy()
    run(world, ticks)
    for _ in range(30):
        step(world)
        assert np.abs(world.velocity).max() < 1e-5
        assert world.hand_force[0] == pytest.approx([0.0, weight(world)], rel=1e-5, abs=1e-5 * weight(world))
    assert np.abs(world.position[held] - place).max() < 0.004
    return True


@pytest.mark.parametrize("load", [12.0, 75.0, 900.0])
@pytest.mark.parametrize(("iterations", "substeps"), [(1, 1), (3, 1), (10, 1), (1, 4), (10, 2), (7, "auto")])
@pytest.mark.parametrize(("stiffness", "damping"), [(1.0, 1.0), (0.6, 0.85), (0.15, 0.4)])
def test_a_light_end_in_a_hand_hangs_still_with_much_weight_on_it(load, iterations, substeps, stiffness, damping):
    world = string(load, stiffness=stiffness, damping=damping, iterations=iterations, substeps=substeps)
    world.hold(0, 0, (0.0, 0.0))
    assert hangs_still(world)


@pytest.mark.parametrize("strength", [15.0, 45.0, 250.0, 4000.0])
@pytest.mark.parametrize("rate", [30, 120])
@pytest.mark.parametrize("radius", [0.0, 0.4, 2.5])
def test_a_hand_of_any_strength_and_reach_holds_a_light_end_still(strength, rate, radius):
    world = string(220.0, iterations=2, tick_rate=rate)
    world.hold(0, 0, (0.0, 0.0), strength, radius)
    assert hangs_still(world, 8 * rate)


@pytest.mark.parametrize("load", [40.0, 600.0])
@pytest.mark.parametrize("iterations", [1, 10])
def test_a_frame_with_one_light_corner_hangs_still_by_that(load, iterations):
    world = network(
        [(0.0, 0.0), (-0.6, -1.1), (0.6, -1.1)], [(0, 1), (0, 2), (1, 2)], masses=[1.0, load / 2.0, load / 2.0],
        gravity=(0.0, -GRAVITY), solver="iterative", stiffness=1.0, damping=1.0, iterations=iterations,
    )  # fmt: skip
    world.hold(0, 0, (0.0, 0.0))
    run(world, 900)
    assert np.abs(world.velocity).max() < 1e-3


@pytest.mark.parametrize("links", [2, 4])
@pytest.mark.parametrize("load", [25.0, 120.0])
def test_a_chain_hangs_from_a_hand_as_from_a_pin(links, load):
    held, pinned = string(load, links), string(load, links)
    held.hold(0, 0, (0.0, 0.0))
    pinned.pin(0)
    for world in (held, pinned):
        run(world, 900)
    low = held.position[links, 1] - pinned.position[links, 1]
    assert low == pytest.approx(held.position[0, 1], abs=0.004)
    assert np.abs(held.velocity).max() <= 1.1 * np.abs(pinned.velocity).max() + 1e-6


@pytest.mark.parametrize("load", [2.0, 60.0, 800.0])
@pytest.mark.parametrize("iterations", [2, 10])
def test_a_weak_hand_lets_a_light_end_fall_with_what_its_force_leaves(load, iterations):
    world = string(load, iterations=iterations)
    world.hold(0, 0, (0.0, 0.0), 4.0)
    run(world, 60)
    assert world.velocity[1, 1] == pytest.approx(4.0 - GRAVITY, rel=0.02)


@pytest.mark.parametrize("load", [30.0, 90.0, 700.0])
@pytest.mark.parametrize("iterations", [1, 10])
def test_a_hand_that_jumps_about_with_a_light_end_gives_no_more_energy_than_its_work(load, iterations):
    for seed in range(scaled(4, 1)):
        generator = np.random.default_rng(seed)
        world = string(load, iterations=iterations)
        world.hold(0, 0, (0.0, 0.0))
        mass = np.where(world.inverse_mass > 0.0, world.mass, 0.0)
        work, start, largest, most = 0.0, float(mass @ world.position[:, 1]) * GRAVITY, 0.0, -np.inf
        for tick in range(scaled(480, 120)):
            if tick % 24 == 0:
                world.move_grab(0, tuple(generator.uniform(-2.5, 2.5, 2)))
            place = world.position[0].copy()
            step(world)
            work += float(world.hand_force[0] @ (world.position[0] - place))
            moving = kinetic_energy(world)
            largest = max(largest, moving)
            most = max(most, moving + float(mass @ world.position[:, 1]) * GRAVITY - start - work)
        # A tick does not know the work to better than its force by half of what it changes its velocity.
        assert most <= 0.1 * largest


@pytest.mark.parametrize("hands", [((0, 0.0), (1, 0.0)), ((0, -0.2), (1, 0.2))])
def test_two_hands_share_the_weight_on_a_light_end(hands):
    world = string(90.0)
    for hand, at in hands:
        world.hold(hand, 0, (at, 0.0))
    run(world, 900)
    # Two that pull against each other with all their force leave it to drift between them.
    assert np.abs(world.velocity).max() < 0.05
    assert np.sum(world.hand_force[:2], axis=0) == pytest.approx([0.0, weight(world)], abs=1e-2 * weight(world))


def crane(load, share, *, links=1, stiffness=1.0, damping=1.0, solver="iterative", **settings):
    """A hydraulic between a pin and a light hook, from which links and a load hang; its force: a share of their weight.

    None: a spring that nothing drives.
    """
    points = [(0.0, -1.0 * k) for k in range(links + 2)]
    masses = [1.0] * (links + 1) + [load]
    world = network(
        points, [(k, k + 1) for k in range(links + 1)], masses=masses, pinned=(0,), gravity=(0.0, -GRAVITY),
        solver=solver, stiffness=stiffness, damping=damping, **settings,
    )  # fmt: skip
    if share is not None:
        one = np.array([0])
        hydraulics = Hydraulics(
            one, np.array([0.5]), np.array([2.0]), np.array([0.4]), one, np.array([share * sum(masses[1:]) * GRAVITY])
        )
        world.fit(Actuators(("jack",), hydraulics=hydraulics), [0.0])
    return world


@pytest.mark.parametrize("load", [8.0, 75.0, 850.0])
@pytest.mark.parametrize(("solver", "iterations", "substeps"), [
    ("iterative", 1, 1), ("iterative", 10, 1), ("iterative", 4, 4), ("iterative", 10, "auto"), ("single_pass", 10, 1),
    ("single_pass", 10, 2),
])  # fmt: skip
def test_a_spring_of_limited_force_is_an_ordinary_one_where_that_suffices(load, solver, iterations, substeps):
    stiffness, damping = (0.3, 0.6) if solver == "single_pass" else (0.9, 0.95)
    worlds = [
        crane(
            load, share, links=2, stiffness=stiffness, damping=damping, solver=solver, iterations=iterations,
            substeps=substeps,
        )
        for share in (None, 1e4)
    ]  # fmt: skip
    for _ in range(scaled(300, 60)):
        for world in worlds:
            step(world)
        assert np.array_equal(worlds[0].position, worlds[1].position)


@pytest.mark.parametrize("load", [8.0, 75.0])
@pytest.mark.parametrize("iterations", [3, 10])
@pytest.mark.parametrize("share", [1.3, 2.5, 100.0])
def test_a_light_hook_on_a_spring_of_limited_force_hangs_still_with_much_weight_on_it(load, iterations, share):
    world = crane(load, share, iterations=iterations)
    run(world, 900)
    assert np.abs(world.velocity).max() < 1e-3
    assert world.position[1, 1] == pytest.approx(-1.0, abs=0.01)


@pytest.mark.parametrize("load", [8.0, 75.0])
@pytest.mark.parametrize("iterations", [3, 10])
def test_a_light_hook_on_a_spring_of_too_little_force_falls_with_what_that_leaves(load, iterations):
    world = crane(load, 0.6, iterations=iterations)
    speeds = []
    for _ in range(2):
        run(world, 30)
        speeds.append(world.mass[1:3] @ world.velocity[1:3, 1] / np.sum(world.mass[1:3]))
    # The first ticks bring the force to its limit.
    assert speeds[1] - speeds[0] == pytest.approx(-0.4 * GRAVITY * 30 / 60, rel=0.02)


def test_a_soft_body_that_a_hand_holds_all_over_moves_as_before_in_the_iterative_solver():
    body = {
        "type": "jelly", "id": "body", "position": (0.0, 0.0), "shape": {"box": (1.0, 1.0)}, "spacing": 0.125,
        "particle_mass": 0.1,
    }  # fmt: skip
    world = world_of(body, solver="iterative")
    world.hold(0, 40, (0.0, 0.0), 100.0, 3.0)
    run(world, 240)
    assert world.hand_force[0] == pytest.approx([0.0, weight(world)], rel=1e-3, abs=1e-3 * weight(world))
