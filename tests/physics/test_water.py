"""Water against what can be computed by hand: depths, periods, where boats tip, speeds, energy."""

import math

import numpy as np
import pytest

from sandbox.physics.analysis.energy import gravity_energy, water_energy
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.step import step
from sandbox.physics.water.displacers import FX, FY
from sandbox.physics.water.shapes import arc_cosine, disc_area_below, disc_depth, wet_shares
from tests.support.pools import (
    CALM,
    DENSITY,
    G,
    after,
    free,
    jelly,
    lift_over_weight,
    outline,
    pool,
    terminal_speed,
    water_world,
    wet_area,
)

SOLVERS = ("direct", "iterative", "single_pass")


def disc(share, y=0.0, radius=0.3, **more):
    return {
        "id": "disc",
        "radius": radius,
        "mass": share * DENSITY * math.pi * radius * radius,
        "position": [0, y],
    } | more


# ---- closed forms


def mean_depth(*depths):
    """Integral of the depth over what is wet of a triangle, over its area."""
    return sum(depth * share for depth, share in zip(depths, wet_shares(*depths), strict=True))


def test_wet_parts_are_what_small_steps_add_up_to():
    for x in np.linspace(-1.0, 1.0, 401).tolist():
        assert arc_cosine(x) == pytest.approx(math.acos(x), abs=3e-8)
    middles = (np.arange(100_000) + 0.5) * 1e-5
    for d in (-0.29, -0.1, 0.0, 0.17, 0.3, 2.0):
        y = 0.3 - 0.6 * middles  # from the top of the disc
        chord, depth = 2.0 * np.sqrt(0.09 - y * y), np.maximum(d - y, 0.0)
        assert disc_area_below(d, 0.3) == pytest.approx(np.sum(0.6e-5 * chord * (depth > 0.0)), abs=1e-5)
        assert disc_depth(d, 0.3) == pytest.approx(np.sum(0.6e-5 * chord * depth), abs=1e-6)


def test_shares_of_a_triangle_are_the_gradient_of_its_mean_depth_and_its_area_is_their_sum():
    rng = np.random.default_rng(3)
    for a, b, c in rng.uniform(-1.0, 1.0, (200, 3)).tolist():
        shares = wet_shares(a, b, c)
        h = 1e-6
        for k, share in enumerate(shares):
            up, down = [a, b, c], [a, b, c]
            up[k], down[k] = up[k] + h, down[k] - h
            assert (mean_depth(*up) - mean_depth(*down)) / (2 * h) == pytest.approx(share, abs=1e-6)
        # A triangle of area 1 with its corners so deep.
        corners = np.array([(0.0, -a), (2.0, -b), (0.0, -c)])
        whole = 0.5 * abs(np.linalg.det(np.c_[corners, np.ones(3)]))
        assert sum(shares) == pytest.approx(abs(wet_area(corners)) / whole if whole > 1e-9 else sum(shares), abs=1e-9)


@pytest.mark.parametrize("kind", ["jelly", "ring", "wheel", "disc"])
def test_lift_is_the_gradient_of_the_energy_of_the_water_that_is_displaced(kind):
    ring = {"type": "ring", "id": "b", "radius": 0.5, "segments": 12, "position": [0.1, -0.13], "angle": 0.2}
    bodies = {"jelly": jelly((1.0, 0.5), 0.5, -0.07, angle=0.4), "ring": {"bodies": [ring]},
              "wheel": {"bodies": [ring | {"type": "wheel", "thickness": 0.1}]},
              "disc": {"particles": [disc(0.5, -0.1)]}}  # fmt: skip
    # At rest, or what passes the surface would be lifted by a mean.
    world = water_world([pool(**CALM)], settings={"tick_rate": 10_000}, **bodies[kind])
    step(world)
    load = block_of(world).arrays.water.load.copy()
    world.velocity[:] = 0.0
    assert water_energy(world) > 0.0
    place = world.position.copy()
    # Ten-thousandths of a second ago it was where it was at the start.
    for p in np.flatnonzero(free(world)).tolist():
        for axis, column in ((0, FX), (1, FY)):
            energies = []
            for sign in (-1e-5, 1e-5):
                world.position[p, axis] = place[p, axis] + sign
                energies.append(water_energy(world))
            world.position[p] = place[p]
            force = -(energies[1] - energies[0]) / 2e-5
            assert load[p, column] == pytest.approx(force, abs=2e-3)


# ---- what rests


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("share", [0.5, 0.05])
def test_a_stiff_box_floats_as_deep_as_archimedes_says(solver, share):
    world = after(water_world(settings={"solver": solver, "iterations": 20}, **jelly((1.0, 0.5), share, 0.2)), 30)
    assert -world.position[free(world), 1].min() == pytest.approx(share * 0.5, rel=1e-3)
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-6)
    assert np.abs(world.velocity).max() < 1e-4


@pytest.mark.parametrize("share", [0.9, 0.5, 0.05])
def test_a_disc_displaces_its_weight(share):
    world = after(water_world(particles=[disc(share, 0.1)]), 30)
    displaced = disc_area_below(-world.position[0, 1], 0.3)
    assert DENSITY * displaced == pytest.approx(world.mass[0], rel=1e-5)


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("share", [0.5, 0.05])
def test_a_soft_jelly_displaces_its_weight_as_it_is_drawn(solver, share):
    parts = jelly((1.0, 0.5), share, 0.2, stiffness=0.4, damping=0.6)
    world = after(water_world(settings={"solver": solver, "iterations": 20}, **parts), 30)
    assert DENSITY * wet_area(outline(world)) == pytest.approx(world.mass[free(world)].sum(), rel=0.03)
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("depth", [0.3, 2.0, 10.0])
def test_no_depth_crushes_a_soft_jelly(depth):
    world = after(water_world(**jelly((1.0, 0.5), 1.0, -depth, stiffness=0.05, damping=0.2)), 10)
    assert wet_area(outline(world)) == pytest.approx(0.5, rel=0.04)


@pytest.mark.parametrize("kind", ["ring", "wheel"])
def test_a_ring_that_keeps_its_area_and_a_wheel_float_by_what_they_enclose(kind):
    body = {"type": kind, "id": "b", "radius": 0.5, "segments": 16, "position": [0, 0.1], "particle_mass": 0.12}
    body |= {"thickness": 0.1} if kind == "wheel" else {}
    world = after(water_world(materials={"default": {"stiffness": 1.0, "damping": 1.0}}, bodies=[body]), 30)
    rim = world.position[free(world)][-16:]
    # A ring is pressed flat a little, and a hull displaces what it is to enclose.
    expected = pytest.approx(world.mass[free(world)].sum(), rel=0.02 if kind == "ring" else 2e-3)
    assert DENSITY * wet_area(rim) == expected
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-5)


def test_a_ring_that_keeps_no_area_lets_water_in():
    body = {"type": "ring", "id": "b", "radius": 0.5, "segments": 16, "particle_mass": 0.12, "inflation": None}
    assert after(water_world(bodies=[body]), 5).position[0, 1] < -1.0


@pytest.mark.parametrize("solver", ["direct", "iterative"])
def test_a_boat_with_a_load_floats_by_the_weight_of_both(solver):
    boat = jelly((2.0, 0.5), 0.3, 0.0)
    load = jelly((0.5, 0.5), 0.4, 0.7)["bodies"][0] | {"id": "load"}
    parts = boat | {"bodies": [boat["bodies"][0], load], "settings": {"solver": solver, "iterations": 30}}
    world = after(water_world(contacts={}, **parts), 30)
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-3)
    weight = world.mass[free(world)].sum() / DENSITY
    assert -world.position[:27, 1].min() == pytest.approx(weight / 2.0, rel=0.01)


def test_what_floats_in_balance_does_not_move_from_the_first_tick_on():
    world = water_world(**jelly((1.0, 0.5), 0.5, 0.0))
    step(world)
    assert np.abs(world.velocity).max() < 1e-6


# ---- what moves


@pytest.mark.parametrize("share", [0.5, 0.05, 0.01])
def test_heave_has_the_period_of_its_water_line(share):
    amplitude = min(0.02, share * 0.125)
    world = water_world([pool(**CALM)], **jelly((1.0, 0.5), share, 0.25 - 0.5 * share + amplitude))
    mass, heights = world.mass * free(world), []
    for _ in range(1200):
        step(world)
        heights.append(float(mass @ world.position[:, 1] / mass.sum()))
    swing = np.array(heights) - 0.5 * (max(heights) + min(heights))
    up = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    crossing = up - swing[up] / (swing[up + 1] - swing[up])
    period = (crossing[-1] - crossing[0]) / (len(crossing) - 1) / 60.0
    assert period == pytest.approx(2.0 * math.pi * math.sqrt(share * 0.5 / G), rel=0.03)
    assert np.ptp(swing[-300:]) == pytest.approx(np.ptp(swing[:300]), rel=1e-3)


def test_heave_of_a_disc_neither_grows_nor_dies_out():
    world = water_world([pool(**CALM)], contacts={}, particles=[disc(0.5, 0.002)])
    heights = np.array([step(world) or world.position[0, 1] for _ in range(3600)])
    assert np.ptp(heights[-600:]) == pytest.approx(np.ptp(heights[:600]), rel=1e-3)
    up = np.flatnonzero((heights[:-1] < 0.0) & (heights[1:] >= 0.0))
    theory = 2.0 * math.pi * math.sqrt(0.5 * math.pi * 0.09 / (G * 0.6))
    assert (up[-1] - up[0]) / (len(up) - 1) / 60.0 == pytest.approx(theory, rel=0.01)


@pytest.mark.parametrize(("ratio", "stands"), [(1.21, False), (1.24, True)])
def test_a_box_half_as_heavy_as_water_tips_over_where_its_metacentre_says(ratio, stands):
    # It stands if width / height is above sqrt(6 s (1 - s)), s = 1/2: 1.2247.
    parts = jelly((0.5 * ratio, 0.5), 0.5, 0.0, spacing=0.125, angle=0.02)
    parts["bodies"][0]["particle_mass"] = 1.0
    probe = water_world(**parts)
    parts["bodies"][0]["particle_mass"] = 0.5 * DENSITY * 0.25 * ratio / int(free(probe).sum())
    world = after(water_world([pool(slow_drag=0.05)], **parts), 60)
    slots = np.flatnonzero(free(world))
    now, then = (places[slots] - places[slots].mean(axis=0) for places in (world.position, world.origin))
    turned = math.atan2(np.sum(then[:, 0] * now[:, 1] - then[:, 1] * now[:, 0]), np.sum(then * now)) + 0.02
    assert abs(turned) < 1e-3 if stands else math.radians(5.0) < abs(turned) < math.radians(40.0)


@pytest.mark.parametrize("share", [2.0, 0.5, 0.05, 0.01])
@pytest.mark.parametrize("substeps", [1, 4])
def test_a_disc_rises_and_sinks_at_the_speed_by_hand(share, substeps):
    deep = pool((-20.0, -500.0, 20.0, 500.0))
    world = after(water_world([deep], settings={"substeps": substeps}, particles=[disc(share, radius=0.1)]), 8)
    speed = terminal_speed(world.mass[0], math.pi * 0.01, DENSITY * 0.5 * 2.0 * math.pi * 0.1, DENSITY * 0.1)
    assert world.velocity[0, 1] == pytest.approx(speed if share < 1.0 else -speed, rel=1e-6)


@pytest.mark.parametrize("share", [2.0, 0.5])
def test_a_box_rises_and_sinks_at_the_speed_by_hand(share):
    deep = pool((-20.0, -500.0, 20.0, 500.0))
    world = after(water_world([deep], **jelly((1.0, 0.5), share, 0.0)), 8)
    # C/4 at top and bottom, slow drag along all sides.
    speed = terminal_speed(world.mass[free(world)].sum(), 0.5, DENSITY * 0.5 * 3.0, DENSITY * 0.25 * 2.0)
    assert world.velocity[free(world), 1].mean() == pytest.approx(speed if share < 1.0 else -speed, rel=0.002)


def test_water_that_flows_carries_what_floats():
    flow = pool((-500.0, -20.0, 500.0, 0.0), flow=[1.5, 0.0])
    world = after(water_world([flow], **jelly((1.0, 0.5), 0.5, 0.0)), 40)
    assert world.velocity[free(world), 0] == pytest.approx(1.5, abs=1e-3)


def test_water_slows_the_spin_of_a_disc():
    world = after(water_world([pool(slow_drag=0.01)], particles=[disc(1.0, -5.0, spin=5.0)], contacts={}), 2)
    # The rim moves along itself at r omega: a torque of density slow_drag 2 pi r (r omega) r, on m r^2 / 2.
    rate = DENSITY * 0.01 * 2.0 * math.pi * 0.3**3 / (0.5 * world.mass[0] * 0.09)
    assert world.spin[0] == pytest.approx(5.0 / (1.0 + rate / 60.0) ** 120, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("drag", [(1.0, 0.5), (1000.0, 0.0), (0.0, 1000.0), (1000.0, 1000.0)])
def test_no_drag_makes_anything_faster(solver, drag):
    soft = solver == "single_pass"
    parts = jelly((1.0, 0.5), 1.0, -3.0, *((0.1, 0.3) if soft else (0.4, 0.6)), velocity=[6.0, -3.0])
    settings = {"solver": solver, "gravity": [0.0, 0.0]}
    world = water_world([pool(fast_drag=drag[0], slow_drag=drag[1])], settings=settings, **parts)
    motions = []
    for _ in range(120):
        motions.append(float(np.sum(world.mass * np.sum(world.velocity**2, axis=1))))
        step(world)
    assert max(motions) == motions[0]
    assert motions[-1] < 0.1 * motions[0]


@pytest.mark.parametrize("kind", ["ring", "wheel", "jelly", "disc"])
@pytest.mark.parametrize("share", [0.02, 0.005, 0.002])
def test_what_is_hundreds_of_times_lighter_than_water_comes_up_and_rests(kind, share):
    body = {"type": kind, "id": "b", "radius": 0.5, "segments": 16, "position": [0, -2]}
    body |= {"thickness": 0.1} if kind == "wheel" else {}
    body["particle_mass"] = share * DENSITY * math.pi * 0.25 / (33 if kind == "wheel" else 16)
    parts = {"bodies": [body], "materials": {"default": {"stiffness": 0.9, "damping": 0.95}}}
    if kind == "jelly":
        parts = jelly((1.0, 0.5), share, -2.0, 0.9, 0.95)
    if kind == "disc":
        parts = {"particles": [disc(share, -2.0)]}
    world, fastest = water_world(contacts={}, **parts), 0.0
    for _ in range(900):
        step(world)
        fastest = max(fastest, float(np.abs(world.velocity).max()))
    # Without drag it would come up at sqrt(2 g 2 m / share), 44 to 140 m/s.
    assert fastest < 30.0
    assert np.abs(world.velocity).max() < 1.0
    assert world.position[free(world), 1].mean() > -0.2


# ---- energy


def test_energy_of_a_level_counts_the_water_that_is_displaced():
    deep, high = (water_world(particles=[disc(1.0, y)]) for y in (-2.0, -1.0))
    # As heavy as water: lifting it lifts nothing.
    assert gravity_energy(deep) == pytest.approx(gravity_energy(high), rel=1e-9)
    assert water_energy(deep) == pytest.approx(DENSITY * G * math.pi * 0.09 * 2.0)


# ---- cuts, pins, and what joins


def test_a_jelly_that_is_cut_in_two_displaces_as_much_as_before():
    world = after(water_world(**jelly((2.0, 0.5), 0.5, 0.0)), 1)
    middle = 0.5 * (world.position[world.particle_a, 0] + world.position[world.particle_b, 0])
    across = np.flatnonzero(world.spring_active & (np.abs(middle - 0.125) < 0.1)).tolist()
    world.cut(across)
    assert len({*world.owner[free(world)].tolist()}) > 1
    after(world, 30)
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-4)
    assert np.abs(world.velocity).max() < 1e-3


@pytest.mark.parametrize("kind", ["ring", "wheel"])
def test_a_hull_with_a_cut_spring_takes_in_water(kind):
    body = {"type": kind, "id": "b", "radius": 0.5, "segments": 16, "position": [0, 0.1], "particle_mass": 0.12}
    body |= {"thickness": 0.1} if kind == "wheel" else {}
    world = after(water_world(bodies=[body]), 3)
    assert world.position[free(world), 1].mean() > -0.5
    world.cut([world.grab_spring - 1 if kind == "ring" else 35])
    after(world, 6)
    assert world.position[free(world), 1].mean() < -0.6
    assert world.velocity[free(world), 1].mean() < -0.05


def test_what_is_pinned_stays_and_what_is_let_go_floats_again():
    world = after(water_world(**jelly((1.0, 0.5), 0.5, 0.0)), 1)
    world.pin(0)
    place = world.position[0].copy()
    assert np.array_equal(after(world, 1).position[0], place)
    world.unpin(0)
    assert lift_over_weight(after(world, 20)) == pytest.approx(1.0, abs=1e-5)


def test_side_by_side_pools_lift_each_what_is_in_it():
    pools = [pool((-9.0, -9.0, 0.0, 0.0)), pool((0.0, -9.0, 9.0, 1.0), density=20.0) | {"id": "other"}]
    one, other = disc(0.5) | {"position": [-3, 0]}, disc(0.5) | {"id": "b", "position": [3, 1]}
    world = after(water_world(pools, particles=[one, other]), 30)
    assert world.position[0, 1] == pytest.approx(0.0, abs=1e-6)
    assert 20.0 * disc_area_below(1.0 - world.position[1, 1], 0.3) == pytest.approx(world.mass[1], rel=1e-5)


def test_gravity_that_points_upwards_makes_no_pressure():
    world = after(water_world(settings={"gravity": [0.0, 9.81]}, particles=[disc(0.5, -3.0)]), 0.1)
    assert world.velocity[0, 1] > 0.3
    assert water_energy(world) == 0.0


# ---- bits


def test_a_snapshot_in_water_goes_on_as_before():
    world = water_world(contacts={}, particles=[disc(0.2, 1.0)], **jelly((1.0, 0.5), 0.5, 1.0, 0.4, 0.6, angle=0.3))
    kept, then = take(after(world, 0.5)), state_hash(after(world, 2))
    world.cut([3])
    after(world, 0.2)
    restore(world, kept)
    assert state_hash(after(world, 2)) == then


def test_a_level_has_edges_where_it_has_water_and_its_other_arrays_are_those_without():
    parts = jelly((1.0, 0.5), 0.5, 5.0)
    wet, dry = water_world(**parts), water_world([{"id": "a", "circle": [0, 0, 1]}], **parts)
    assert wet.edge.any() and not dry.edge.any()
    assert not wet.has_contacts
    assert len(block_of(dry).arrays.water.load) == 0
    assert np.array_equal(after(wet, 0.5).position, after(dry, 0.5).position)
