"""Contacts: what touches stays out, slides, bounces and comes to rest, in every solver."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.energy import kinetic_energy, total_energy
from sandbox.physics.collision.contacts import PENETRATION_TICKS
from sandbox.physics.marks import ALL_GROUPS
from sandbox.physics.settings import AUTO
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.contact.gauss_seidel import FASTEST_PUSH
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from tests.support.contact_scenes import BODIES, FLOOR, GROUND, add_chain, add_discs, add_jelly, rugged, world
from tests.support.contacts import last_contacts
from tests.support.physics_scenes import run, scaled

every_solver = pytest.mark.parametrize("solver", SOLVERS)


@every_solver
def test_a_disc_rests_on_the_floor_without_sinking_or_creeping(solver):
    w = world(FLOOR, solver=solver)
    add_discs(w, [(0.0, 0.3)])
    run(w, 120)
    before = w.position.copy()
    run(w, 60)
    assert 0.099 < w.position[0, 1] <= 0.1001
    assert np.abs(w.position - before).max() < 1e-5


@every_solver
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_dropped_disc_bounces_to_the_height_that_its_restitution_says(solver, restitution):
    w = world(FLOOR, solver=solver)
    add_discs(w, [(0.0, 1.1)], restitution=restitution, mass=2.0)
    heights = []
    for _ in range(120):
        step(w)
        heights.append(w.position[0, 1] - 0.1)
    landing = int(np.argmin(heights[:40]))
    assert max(heights[landing : landing + 75]) == pytest.approx(restitution**2, abs=0.05)


@every_solver
@pytest.mark.parametrize("degrees", [-2.0, -1.0, 1.0, 2.0])
def test_a_disc_that_does_not_roll_slides_down_a_slope_if_and_only_if_that_exceeds_the_friction_angle(solver, degrees):
    angle = math.atan(0.5) + math.radians(degrees)
    along = np.array([math.cos(angle), math.sin(angle)])
    w = world(Chain([-60.0 * along, 60.0 * along]), solver=solver)
    add_discs(w, [(-0.1 * along[1], 0.1 * along[0])], rolls=False)
    start = w.position.copy()
    run(w, 120)
    travel = -float((w.position - start)[0] @ along)
    free = 0.5 * 9.81 * (math.sin(angle) - 0.5 * math.cos(angle)) * 4.0
    assert travel == pytest.approx(max(0.0, free), rel=0.02, abs=1e-6)


@pytest.mark.parametrize("degrees", [-2.0, 2.0])
def test_a_block_of_jelly_slides_if_and_only_if_the_slope_exceeds_the_friction_angle(degrees):
    angle = math.atan(0.5) + math.radians(degrees)
    along = np.array([math.cos(angle), math.sin(angle)])
    w = world(Chain([-60.0 * along, 60.0 * along]))
    add_jelly(w, (-0.275 * along[1], 0.275 * along[0]), size=(0.9, 0.5), angle=angle)
    start = w.position.mean(axis=0)
    run(w, 120)
    travel = -float((w.position.mean(axis=0) - start) @ along)
    free = 0.5 * 9.81 * (math.sin(angle) - 0.5 * math.cos(angle)) * 4.0
    assert travel == pytest.approx(max(0.0, free), rel=0.05, abs=2e-3)


@pytest.mark.parametrize("solver", ["iterative", "direct"])
def test_bodies_that_collide_keep_their_momentum_and_gain_no_energy(solver):
    w = world(solver=solver, gravity=(0.0, 0.0))
    add_jelly(w, (0.0, 0.0), size=(0.5, 0.5), velocity=(10.0, 1.0))
    add_jelly(w, (1.2, 0.1), size=(0.5, 0.5), angle=0.4, velocity=(-10.0, 0.0))
    add_discs(w, [(0.0, 2.0)], radius=0.3, mass=5.0, velocity=[(0.0, -9.0)], restitution=0.5)
    momentum, energy = (w.mass[:, None] * w.velocity).sum(axis=0), total_energy(w)
    met = 0
    for _ in range(scaled(120, 30)):
        step(w)
        met += len(last_contacts(w).gap)
        assert total_energy(w) <= energy * (1.0 + 1e-9)
    assert met > 20
    assert np.abs((w.mass[:, None] * w.velocity).sum(axis=0) - momentum).max() < 1e-10


@every_solver
@pytest.mark.parametrize("kind", ["line", "solid"])
def test_chains_of_balls_dropped_at_100_metres_a_second_stay_above_the_ground(solver, kind):
    generator = np.random.default_rng(5)
    ground, surface = rugged(generator, kind)
    w = world(ground, solver=solver)
    for x in np.linspace(-450.0, 450.0, scaled(60, 6)):
        add_chain(w, generator, (x, generator.uniform(5.0, 9.0)), (generator.uniform(-30.0, 30.0), -100.0))
    w.set_coefficients(0.2, 0.2, None)
    for _ in range(scaled(60, 12)):
        step(w)
        assert np.all(w.position[:, 1] > np.interp(w.position[:, 0], surface[:, 0], surface[:, 1]))


def test_a_heap_of_discs_comes_to_rest():
    w = world(Chain([(-1.5, 8.0), (-1.5, 0.0), (1.5, 0.0), (1.5, 8.0)]))
    generator = np.random.default_rng(1)
    k = np.arange(scaled(120, 12))
    points = np.stack([-1.2 + 0.29 * (k % 8) + 0.1 * (k // 8 % 2), 0.4 + 0.25 * (k // 8)], axis=1)
    radius = generator.uniform(0.07, 0.1, len(k))
    add_discs(w, points + generator.uniform(0.0, 0.05, points.shape), radius=radius, mass=100.0 * radius**2)
    peak = 0.0
    for _ in range(scaled(420, 60)):
        step(w)
        peak = max(peak, kinetic_energy(w))
    before = w.position.copy()
    run(w, 60)
    assert kinetic_energy(w) < 1e-4 * peak
    assert np.abs(w.position - before).max() < 1e-3
    assert -last_contacts(w).gap.min() < 0.05 * 0.07


@every_solver
@pytest.mark.parametrize("spread", [0.0, 1.0])
def test_discs_of_any_mass_lie_on_each_other_no_deeper_than_a_twentieth_of_a_radius(solver, spread):
    w = world(Chain([(-1.0, 8.0), (-1.0, 0.0), (1.0, 0.0), (1.0, 8.0)]), solver=solver)
    generator = np.random.default_rng(2)
    k = np.arange(scaled(60, 12))
    points = np.stack([-0.8 + 0.3 * (k % 6) + 0.1 * (k // 6 % 2), 0.3 + 0.25 * (k // 6)], axis=1)
    radius = generator.uniform(0.05, 0.12, len(k))
    add_discs(w, points, radius=radius, mass=10.0 ** generator.uniform(-spread, spread, len(k)))
    run(w, scaled(360, 90))
    contacts = last_contacts(w)
    smaller = np.minimum(w.radius[contacts.particle], np.where(contacts.end_a < 0, 1.0, w.radius[contacts.end_a]))
    assert np.max(-contacts.gap / smaller) < 0.05
    assert np.abs(w.velocity).max() < 1e-3


@pytest.mark.parametrize(("tick_rate", "substeps"), [(30, 1), (60, 1), (60, 2), (120, 1)])
def test_discs_bounce_the_same_wherever_in_a_tick_they_meet_the_ground(tick_rate, substeps):
    w = world(FLOOR, tick_rate=tick_rate, substeps=substeps)
    drops = np.linspace(1.0, 1.4, 40)
    add_discs(w, np.stack([np.arange(-20.0, 20.0), drops + 0.1], axis=1), restitution=0.5)
    heights = []
    for _ in range(tick_rate):
        step(w)
        heights.append(w.position[:40, 1] - 0.1)
    landing = np.argmin(heights[: round(0.6 * tick_rate)], axis=0)
    peaks = np.array([max(height[disc] for height in heights[tick:]) for disc, tick in enumerate(landing)])
    np.testing.assert_allclose(peaks / drops, 0.25, atol=0.02)


def test_discs_that_touch_each_other_bounce_no_higher_than_one_alone():
    w = world(FLOOR)
    add_discs(w, [(0.0, 0.4), (5.0, 0.4), (5.2, 0.4)], restitution=1.0, friction=0.0)
    heights = []
    for _ in range(scaled(300, 120)):
        step(w)
        heights.append(w.position[:3, 1] - 0.1)
    # After several bounces they are back to where they were dropped, to within what they fall in a small step.
    assert 0.3 - 1e-3 < np.max(heights[-60:]) <= np.max(heights) < 0.3 + 1e-5
    assert np.ptp(heights, axis=1).max() < 1e-9


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_discs_of_very_unequal_mass_in_a_closed_box_never_gain_energy(restitution):
    w = world(Chain([(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)], "hollow"), gravity=(0.0, 0.0))
    generator = np.random.default_rng(0)
    k = np.arange(60)
    places = np.stack([-1.6 + 0.45 * (k % 8), -1.6 + 0.45 * (k // 8)], axis=1)
    add_discs(w, places, radius=generator.uniform(0.05, 0.16, 60),
              mass=10.0 ** generator.uniform(-2.0, 2.0, 60), velocity=20.0 * generator.normal(size=(60, 2)),
              restitution=restitution)  # fmt: skip
    energy = kinetic_energy(w)
    for _ in range(scaled(120, 20)):
        step(w)
        assert kinetic_energy(w) <= energy * (1.0 + 1e-12)
        energy = kinetic_energy(w)
        assert np.all(np.abs(w.position) < 2.0)


def test_discs_that_collide_in_free_space_keep_their_momentum():
    w = world(gravity=(0.0, 0.0))
    generator = np.random.default_rng(4)
    places = generator.uniform(-1.5, 1.5, (40, 2))
    add_discs(w, places, mass=10.0 ** generator.uniform(-2.0, 2.0, 40), velocity=-5.0 * places, restitution=0.7)
    momenta = w.mass[:, None] * w.velocity
    met = 0
    for _ in range(60):
        step(w)
        met += int(np.count_nonzero(w.contact_impulse[:, 0]))
    assert met > 20
    assert np.abs((w.mass[:, None] * w.velocity - momenta).sum(axis=0)).max() < 1e-13 * np.abs(momenta).sum()


def test_a_heap_takes_the_same_steps_in_every_solver():
    reached = []
    for solver in SOLVERS:
        w = world(GROUND, solver=solver)
        add_discs(w, [(0.0, 0.1), (0.05, 0.35), (-0.02, 0.6)])
        run(w, 40)
        reached.append(w.position.copy())
    assert np.array_equal(reached[0], reached[1])
    assert np.array_equal(reached[0], reached[2])


def test_a_stack_of_jelly_cubes_stands():
    w = world(GROUND)
    cubes, corners = scaled(8, 2), scaled(10, 5)
    size = 0.1 * (corners - 1)
    for k in range(cubes):
        place = (0.02 * (-1) ** k, 0.05 + (size + 0.06) * k + 0.5 * size)
        add_jelly(w, place, size=(size, size), stiffness=0.99, damping=0.999)
    run(w, scaled(240, 60))
    top = w.position[-(corners**2) :].mean(axis=0)
    assert top == pytest.approx((0.0, (size + 0.05) * (cubes - 0.5)), abs=0.05)
    assert np.abs(w.velocity).max() < 0.02


def test_a_jelly_falls_on_another_and_neither_enters_it():
    w = world(GROUND)
    lower, upper = add_jelly(w, (0.0, 0.5)), add_jelly(w, (0.05, 1.8), angle=0.15)
    run(w, scaled(180, 60))
    assert w.position[upper, 1].mean() > w.position[lower, 1].mean() + 0.7
    assert -last_contacts(w).gap.min() < 0.05 * 0.05


@every_solver
@pytest.mark.parametrize("depth", [0.01, 0.1, 0.4])
def test_a_disc_inside_solid_ground_is_out_after_the_ticks_that_its_depth_takes_and_lies_on_it(solver, depth):
    w = world(GROUND, solver=solver)
    add_discs(w, [(0.3, -depth), (2.0, -depth)], radius=[0.1, 0.02])
    run(w, math.ceil(PENETRATION_TICKS + 60.0 * depth / FASTEST_PUSH + 12.0))
    assert np.all(w.position[:, 1] > 0.0)
    run(w, 60)
    assert np.all(w.position[:, 1] > 0.9 * w.radius)
    assert np.abs(w.velocity).max() < 1e-3


def turns_around(point, rim) -> int:
    """How often a closed line of points goes around a point; 0 where that lies outside."""
    angles = np.arctan2(*(rim - point).T)
    return round(np.sum((np.diff(angles, append=angles[:1]) + math.pi) % math.tau - math.pi) / math.tau)


def test_a_disc_inside_a_jelly_is_brought_out_within_a_second():
    w = world(gravity=(0.0, 0.0))
    jelly = add_jelly(w, (0.0, 0.0))
    disc = add_discs(w, [(0.1, 0.2)], radius=0.05)
    rim = np.r_[0:10, 19:100:10, 98:89:-1, 80:0:-10]
    assert abs(turns_around(w.position[disc], w.position[jelly][rim])) == 1
    run(w, 60)
    assert turns_around(w.position[disc], w.position[jelly][rim]) == 0
    assert len(last_contacts(w).gap) == 0


def test_nothing_leaves_walls():
    w = world(Chain([(-2.0, 0.0), (2.0, 0.0), (2.0, 3.0), (-2.0, 3.0)], "hollow"), gravity=(0.0, 0.0))
    generator = np.random.default_rng(3)
    add_discs(w, generator.uniform((-1.8, 0.2), (1.8, 2.8), (20, 2)), velocity=generator.uniform(-80, 80, (20, 2)),
              restitution=0.9)  # fmt: skip
    for _ in range(120):
        step(w)
        assert np.all((np.abs(w.position[:, 0]) < 2.0) & (w.position[:, 1] > 0.0) & (w.position[:, 1] < 3.0))


def test_groups_decide_who_touches_whom():
    w = world(FLOOR)
    add_discs(w, [(0.0, 0.5)])
    w.add_particles(["ghost"], [(1.0, 0.5)], radius=0.1, group=BODIES, collides=0)
    w.add_particles(["other"], [(0.0, 1.0)], radius=0.1, group=4, collides=ALL_GROUPS - BODIES)
    run(w, 90)
    assert w.position[0, 1] == pytest.approx(0.1, abs=1e-3)
    assert w.position[1, 1] < -5.0
    assert w.position[2, 1] == pytest.approx(0.1, abs=1e-3)


def test_what_nothing_touches_moves_as_in_a_world_without_contacts():
    alone, beside = world(), world(FLOOR)
    for w in (alone, beside):
        add_jelly(w, (0.0, 20.0), angle=0.3)
    alone.change("collides", 0)
    add_discs(beside, [(30.0, 0.1)])
    for _ in range(30):
        step(alone)
        step(beside)
    assert not alone.has_contacts
    assert len(last_contacts(beside).gap) == 1
    assert np.array_equal(alone.position, beside.position[: alone.particle_count])


@every_solver
@pytest.mark.parametrize("substeps", [4, AUTO])
def test_a_run_goes_on_from_a_snapshot_with_the_same_bits(solver, substeps):
    w = world(GROUND, solver=solver, substeps=substeps)
    add_jelly(w, (0.0, 0.6), size=(0.4, 0.4), stiffness=0.1, damping=0.1)
    add_discs(w, [(0.0, 1.2), (0.05, 1.5)])
    run(w, 25)
    kept = take(w)
    run(w, 15)
    expected = state_hash(w)
    restore(w, kept)
    run(w, 15)
    assert len(w.contact_particle) > 2
    assert state_hash(w) == expected


def test_a_large_jelly_rests_on_the_ground_by_the_same_contacts():
    w = world(GROUND)
    jelly = add_jelly(w, (0.0, 1.03), size=(2.0, 2.0), stiffness=0.99, damping=0.999)
    assert jelly.stop - jelly.start > 400
    run(w, scaled(90, 10))
    assert w.position[:, 1].min() == pytest.approx(0.025, abs=1e-3)
    assert np.abs(w.velocity).max() < 1e-3


@every_solver
@pytest.mark.parametrize("free", [0, 1, 4])
def test_what_cannot_move_touches_nothing_that_cannot(solver, free):
    # A pinned disc lies in a box of which some particles are free; and others lie on the ground.
    w = world(GROUND, solver=solver)
    add_jelly(w, (3.0, 0.6), size=(0.8, 0.8))
    box = add_jelly(w, (0.0, 2.0), size=(0.8, 0.8))
    for p in range(box.start + free, box.stop):
        w.pin(p)
    disc = add_discs(w, [(0.03, 2.05)], radius=0.15)
    w.pin(disc)
    for _ in range(60):
        step(w)
        contacts = last_contacts(w)
        ends = np.stack([contacts.particle, contacts.end_a, contacts.end_b], axis=1)
        assert (np.where(ends >= 0, w.inverse_mass[ends], 0.0).sum(axis=1) > 0.0).all()
    assert np.isfinite(w.position).all()
