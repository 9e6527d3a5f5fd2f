"""Impacts: what is thrown at a wedge, a corner, a wall or a row of balls leaves as textbooks say and gains nothing."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.applied_forces import contact_points
from sandbox.physics.arrays import Floats
from sandbox.physics.marks import ALL_GROUPS, LINE, TERRAIN_GROUP
from sandbox.physics.solvers.contact.free_constraints import small_steps
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.support.contact_scenes import BODIES, FLOOR, Chain, add_discs, world
from tests.support.physics_scenes import run, scaled

STILL = (0.0, 0.0)
GRAVITY = 9.81
RADIUS = 0.3
FALL = 2.0
both_cadences = pytest.mark.parametrize("substeps", [1, 4])


def _room(half_width: float, half_height: float) -> Chain:
    x, y = half_width, half_height
    return Chain([(-x, -y), (x, -y), (x, y), (-x, y)], "hollow")


def _kinetic(w: World) -> float:
    moves = w.inverse_mass > 0.0
    squared = np.sum(w.velocity**2, axis=1) + 0.5 * (w.radius * w.spin) ** 2
    return float(np.sum(0.5 * w.mass[moves] * squared[moves]))


def _dropped_into_wedge(half: float, restitution: float, friction: float, substeps: int) -> tuple[Floats, Floats]:
    """Heights [m] over where it would rest and energies [J/kg] over there, tick by tick, of a disc in a wedge."""
    x, y = 6.0 * math.sin(half), 6.0 * math.cos(half)
    w = world(Chain([(-x, y), (0.0, 0.0), (x, y)]), gravity=(0.0, -GRAVITY), substeps=substeps)
    rest = RADIUS / math.sin(half)
    disc = add_discs(w, [(0.0, rest + FALL)], radius=RADIUS, restitution=restitution, friction=friction)
    found = []
    for _ in range(150):
        step(w)
        height = w.position[disc, 1] - rest
        found.append((height, _kinetic(w) / w.mass[disc] + GRAVITY * height))
    heights, energies = np.array(found).T
    return heights, energies


def _first_apex(heights: Floats) -> float:
    lowest = next((k for k in range(5, len(heights) - 1) if heights[k + 1] >= heights[k]), len(heights) - 1)
    falls = [k for k in range(lowest, len(heights) - 1) if heights[k + 1] < heights[k]]
    return float(heights[falls[0]]) if falls else float(heights[-1])


@both_cadences
@pytest.mark.parametrize("degrees", [10, 30, 45, 60, 85][:: scaled(1, 2)])
@pytest.mark.parametrize("restitution", [0.0, 0.2, 0.5, 0.8, 1.0][:: scaled(1, 2)])
def test_a_disc_leaves_a_wedge_with_its_restitution_whatever_its_angle(degrees, restitution, substeps):
    # Both speeds along the normals are v sin a and turn round as -e of that: v' = e v, straight up.
    heights, energies = _dropped_into_wedge(math.radians(degrees), restitution, 0.0, substeps)
    wanted = restitution * restitution * FALL
    assert _first_apex(heights) == pytest.approx(wanted, rel=0.02, abs=4e-3)
    h = 1.0 / 60.0 / substeps
    fastest = math.sqrt(2.0 * GRAVITY * FALL)
    assert energies.max() <= GRAVITY * (FALL + 0.5 * h / small_steps(h) * fastest)


@pytest.mark.parametrize("degrees", [20, 45, 70])
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_friction_in_a_wedge_only_takes(degrees, restitution):
    heights, energies = _dropped_into_wedge(math.radians(degrees), restitution, 0.5, 1)
    assert _first_apex(heights) <= restitution * restitution * FALL * 1.001
    assert energies.max() <= GRAVITY * FALL * 1.001


def _thrown_at(kind: str, x: float, speed: float, radius: float) -> tuple[float, float]:
    """Velocities [m/s] just after a disc has met something at x = 5: its own, and that of a ball it met or 0."""
    chains = {"room": [_room(5.0, 5.0)], "line": [Chain([(5.0, -5.0), (5.0, 5.0)])]}.get(kind, [])
    w = world(*chains, gravity=STILL)
    add_discs(w, [(x, 0.0)], radius=radius, velocity=(speed, 0.0), restitution=1.0, friction=0.0)
    reach = radius
    if kind in ("peg", "ball"):
        add_discs(w, [(5.0, 0.0)], radius=radius, restitution=1.0, friction=0.0, pinned=kind == "peg")
        reach = 2.0 * radius
    elif kind == "edge":
        names, ends = ["a", "b"], [(5.0, -3.0), (5.0, 3.0)]
        w.add_particles(names, ends, pinned=True, radius=0.0, restitution=1.0, group=BODIES, collides=ALL_GROUPS)
        w.add_springs(["ab"], [1], [2], edge=LINE)
    run(w, int(60.0 * (5.0 - reach - x) / speed) + 3)
    return float(w.velocity[0, 0]), float(w.velocity[1, 0]) if kind == "ball" else 0.0


@pytest.mark.parametrize("kind", ["room", "line", "peg", "ball", "edge"])
def test_what_ends_a_tick_at_the_very_surface_bounces(kind):
    for x in (0.0, 1.0, 4.0, 0.5):
        for speed in (3.0, 5.0, 12.0, 15.0, 30.0)[:: scaled(1, 2)]:
            for radius in (0.2, 0.25, 0.5)[:: scaled(1, 2)]:
                own, other = _thrown_at(kind, x, speed, radius)
                wanted = (0.0, speed) if kind == "ball" else (-speed, 0.0)
                assert (own, other) == pytest.approx(wanted, abs=0.01 * speed), (x, speed, radius)


def _row(count: int, thrown: int, speed: float, gap: float, threads: bool, solver: str) -> Floats:
    """Velocities, as shares of the speed, of equal balls of which the first have been thrown at the others."""
    w = world(gravity=STILL, solver=solver)
    x = np.arange(count) * (2.0 * RADIUS + gap) - np.where(np.arange(count) < thrown, 1.0, 0.0)
    velocity = np.where(np.arange(count) < thrown, speed, 0.0)[:, None] * np.array([1.0, 0.0])
    balls = np.stack([x, np.zeros(count)], axis=1)
    add_discs(w, balls, radius=RADIUS, velocity=velocity, restitution=1.0, friction=0.0)
    if threads:
        w.add_particles([f"nail {k}" for k in range(count)], balls + np.array([0.0, 50.0]), pinned=True, collides=0)
        a = np.arange(count)
        w.add_springs([f"thread {k}" for k in a], a, a + count, stiffness=1.0, damping=1.0)
    run(w, int(60.0 / speed) + 8 + int(60.0 * gap * count / speed))
    return np.asarray(w.velocity[:count, 0] / speed)


@pytest.mark.parametrize("solver, threads", [("direct", False), ("direct", True), ("iterative", True)])
@pytest.mark.parametrize("speed, gap", [(1.0, 0.0), (5.0, 0.0), (5.0, 1e-3), (30.0, 0.0)])
def test_as_many_balls_leave_a_row_as_are_thrown_at_it(solver, threads, speed, gap):
    for count in (2, 3, 5, 10)[:: scaled(1, 2)]:
        for thrown in range(1, min(count, 4)):
            found = _row(count, thrown, speed, gap, threads, solver)
            wanted = np.where(np.arange(count) >= count - thrown, 1.0, 0.0)
            np.testing.assert_allclose(found, wanted, atol=0.02, err_msg=f"{thrown} of {count}")


def _thrown_into_corner(generator: np.random.Generator, speed: float) -> tuple[World, Floats]:
    """Discs that do not touch each other, and meet two walls within a tick; their velocities at the start."""
    count, radius = 10, 0.25
    angle = generator.uniform(0.1, 1.47, count)
    velocity = speed * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    position = np.array([8.0, 5.0]) - radius - generator.uniform(0.0, 1.0, (count, 2)) * velocity / 60.0
    w = world(_room(8.0, 5.0), gravity=STILL)
    w.add_particles(
        [f"disc {k}" for k in range(count)], position, velocity=velocity, radius=radius, restitution=1.0, friction=0.0,
        group=BODIES, collides=TERRAIN_GROUP,
    )  # fmt: skip
    return w, velocity


@pytest.mark.parametrize("speed", [5.0, 20.0, 50.0])
def test_a_disc_that_meets_two_walls_in_one_tick_turns_round_at_both(speed):
    generator = np.random.default_rng(1)
    for _ in range(scaled(30, 2)):
        w, velocity = _thrown_into_corner(generator, speed)
        # What met a wall more slowly than bodies bounce stays there; after a tenth of a second it is not back yet.
        bounces = (velocity > 0.5).all(axis=1)
        for _ in range(6):
            step(w)
            assert (w.position <= np.array([8.0, 5.0]) - w.radius[:, None] * (1.0 - 1e-3)).all()
        np.testing.assert_allclose(w.velocity[bounces], -velocity[bounces], atol=0.01 * speed)


def _crowded_room(seed: int) -> World:
    """Discs of any size, mass and speed among pegs in a closed room without gravity; one restitution and friction."""
    generator = np.random.default_rng(seed)
    touch = {"restitution": generator.choice([0.0, 0.3, 0.7, 1.0]), "friction": generator.choice([0.0, 0.3, 1.0])}
    w = world(_room(4.0, 4.0), gravity=STILL, substeps=int(generator.choice([1, 4])))
    placed: list[tuple[float, float, float]] = []
    for k in range(int(generator.integers(5, 28))):
        x, y, radius = *generator.uniform(-3.4, 3.4, 2), generator.uniform(0.1, 0.4)
        if any(math.hypot(x - a, y - b) <= radius + r for a, b, r in placed):
            continue
        placed.append((x, y, radius))
        velocity = generator.uniform(-1.0, 1.0, 2) * 10.0 ** generator.uniform(0.0, 1.5)
        pinned = k % 7 == 6
        add_discs(
            w, [(x, y)], radius=radius, mass=10.0 ** generator.uniform(-1.0, 1.0), pinned=pinned,
            velocity=STILL if pinned else velocity, **touch,
        )  # fmt: skip
    return w


def test_impacts_in_a_closed_room_never_add_energy():
    for seed in range(scaled(30, 2)):
        w = _crowded_room(seed)
        most = _kinetic(w) * (1.0 + 1e-9)
        for _ in range(scaled(100, 20)):
            step(w)
            assert _kinetic(w) <= most, seed


@pytest.mark.parametrize("held, substeps", [(False, 1), (False, 4), (True, 1)])
def test_the_impulse_of_an_impact_is_kept_for_a_tick_and_is_the_momentum_it_gave(substeps, held):
    w = world(FLOOR, gravity=(0.0, -GRAVITY), substeps=substeps)
    count = 2 if held else 1
    add_discs(w, [(0.4 * k, 1.0) for k in range(count)], restitution=0.5, mass=3.0, friction=0.0)
    if held:
        w.add_springs(["ab"], [0], [1], stiffness=1.0, damping=1.0)
    heard = 0
    for _ in range(45):
        before = w.velocity[:, 1].copy()
        step(w)
        gained = float(np.sum(w.mass * (w.velocity[:, 1] - before + GRAVITY / 60.0)))
        if w.contact_impact.any():
            heard += 1
            assert w.contact_impact.sum() == pytest.approx(gained, rel=1e-6)
            assert not w.contact_impulse.any()
            assert contact_points(w).force[:, 1].sum() / 60.0 == pytest.approx(gained, rel=1e-6)
    assert heard == 1
