"""Water where it ends and where something holds: seams, floors, sides, moorings, walls; and energy at any density."""

import itertools
import math

import numpy as np
import pytest

from sandbox.physics.analysis.energy import gravity_energy, spring_forces
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.step import step
from sandbox.physics.water.displacers import FY
from sandbox.physics.water.shapes import shares_within
from tests.support.pools import CALM, DENSITY, G, after, free, jelly, lift_over_weight, pool, water_world
from tests.support.situations import order, session_of

STEEL = {"steel": {"stiffness": 1.0, "damping": 1.0}}


def ball(share, x=0.0, y=0.0, radius=0.3, **more):
    return {"id": "ball", "radius": radius, "mass": share * DENSITY * math.pi * radius**2, "position": [x, y]} | more


def lift(world):
    """What water lifted in the last step [N]."""
    return float(block_of(world).arrays.water.load[free(world), FY].sum())


# ---- floors, sides and seams


def test_shares_of_a_triangle_between_two_sides_are_those_of_the_part_that_is_there():
    rng = np.random.default_rng(5)
    grid = (np.arange(400) + 0.5) / 400.0
    s, t = np.meshgrid(grid, grid)
    s, t = s[s + t < 1.0], t[s + t < 1.0]
    for x, y, z, a, b, c in rng.uniform(-1.0, 1.0, (50, 6)).tolist():
        across, depth = x + s * (y - x) + t * (z - x), a + s * (b - a) + t * (c - a)
        wet = (across >= -0.3) & (across <= 0.4) & (depth > 0.0)
        by_hand = [float(np.mean(shape * wet)) for shape in (1.0 - s - t, s, t)]
        assert shares_within(x, y, z, -0.3, 0.4, a, b, c) == pytest.approx(by_hand, abs=3e-3)


BODIES = {
    "disc": {"particles": [ball(1.0)]},
    "jelly": jelly((1.0, 0.5), 1.0, 0.0, angle=0.3),
    "ring": {"bodies": [{"type": "ring", "id": "b", "radius": 0.5, "segments": 16, "position": [0, 0]}]},
}


def moved(parts, x, y):
    [(kind, [thing])] = [(k, v) for k, v in parts.items() if k in ("particles", "bodies")]
    return parts | {kind: [thing | {"position": [x, y]}]}


@pytest.mark.parametrize("kind", BODIES)
@pytest.mark.parametrize("at", [(0.1, -2.1), (0.13, -3.0), (0.1, -0.05), (0.05, -2.0)])
def test_water_of_pools_that_are_flush_lifts_as_one_pool(kind, at):
    quarters = [((-9, -2, 0.1, 0), "p"), ((0.1, -2, 9, 0), "q"), ((-9, -6, 0.1, -2), "r"), ((0.1, -6, 9, -2), "s")]
    parts = moved(BODIES[kind], *at)
    one, many = (water_world(z, **parts) for z in ([pool((-9, -6, 9, 0))], [pool(b) | {"id": i} for b, i in quarters]))
    for _ in range(60):
        step(one)
        step(many)
        assert lift(many) == pytest.approx(lift(one), rel=1e-2 if kind == "disc" and at[1] > -0.3 else 1e-6)
    assert many.position == pytest.approx(one.position, abs=1e-3)


@pytest.mark.parametrize("kind", BODIES)
def test_water_lifts_the_half_of_what_is_half_out_of_its_side_or_under_its_floor(kind):
    brief = {"tick_rate": 10_000}
    whole = water_world([pool((-9, -9, 9, 0))], settings=brief, **moved(BODIES[kind], 0.0, -3.0))
    beside = water_world([pool((0.0, -9, 9, 0))], settings=brief, **moved(BODIES[kind], 0.0, -3.0))
    above = water_world([pool((-9, -3.0, 9, 0))], settings=brief, **moved(BODIES[kind], 0.0, -3.0))
    for world in (whole, beside, above):
        step(world)
    assert lift(beside) == pytest.approx(0.5 * lift(whole), rel=1e-3)
    assert lift(above) == pytest.approx(0.5 * lift(whole), rel=1e-3)


@pytest.mark.parametrize("density", [8.5, 9.5])
def test_a_box_floats_between_oil_and_water_where_it_displaces_its_weight_of_both(density):
    layers = [pool((-9, -2, 9, 0), density=8.0), pool((-9, -6, 9, -2)) | {"id": "lower"}]
    world = after(water_world(layers, **jelly((1.0, 0.5), density / DENSITY, -1.9)), 60)
    in_water = 0.5 * (density - 8.0) / (10.0 - 8.0)
    assert -2.0 - world.position[free(world), 1].min() == pytest.approx(in_water, abs=2e-3)


def test_what_is_heavier_than_all_layers_sinks_through_every_seam():
    layers = [pool((-9, -1.0 * k - 1.0, 9, -1.0 * k), density=10.0 + k) | {"id": f"l{k}"} for k in range(5)]
    ring = moved(BODIES["ring"], 0.0, -0.5)
    ring["bodies"][0]["particle_mass"] = 0.9
    for parts in (ring, {"particles": [ball(1.6, y=-0.5)]}):
        world = after(water_world(layers, **parts), 20)
        assert world.position[free(world), 1].max() < -5.0


# ---- what holds


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("density", [10.0, 1000.0])
@pytest.mark.parametrize("share", [0.1, 0.5, 2.0])
def test_a_river_leans_a_mooring_line_by_all_of_its_drag(solver, density, share):
    r = 0.3
    moored = ball(share * density / DENSITY, y=-4.0)
    parts = {"particles": [moored, {"id": "a", "position": [0, -6], "pinned": True, "radius": 0.01}],
             "springs": [{"a": "a", "b": "ball", "material": "steel"}], "materials": STEEL}  # fmt: skip
    river = pool((-40, -12, 40, 0), density=density, flow=[1.0, 0.0])
    world = after(water_world([river], settings={"solver": solver, "iterations": 20}, **parts), 40)
    drag = density * r * (1.0 + math.pi)
    lifted = (1.0 - share) * density * math.pi * r * r * G
    dx, dy = world.position[0] - world.position[1]
    assert math.atan2(dx, dy) == pytest.approx(math.atan2(drag, lifted), abs=0.02)


@pytest.mark.parametrize("density", [10.0, 1000.0])
def test_a_river_presses_a_ball_against_a_wall_with_all_of_its_drag(density):
    wall = {"terrain": [{"id": "wall", "polyline": [[0.5, -6], [0.5, 2]]}], "contacts": {}}
    river = pool((-40, -12, 40, 0), density=density, flow=[1.0, 0.0])
    world = after(water_world([river], particles=[ball(density / DENSITY, y=-3.0)], **wall), 10)
    pushed = float(np.max(block_of(world).arrays.collisions.kept.impulse[:, 0])) * 60.0
    assert pushed == pytest.approx(density * 0.3 * (1.0 + math.pi), rel=0.02)


@pytest.mark.parametrize("density", [10.0, 1000.0])
@pytest.mark.parametrize("size", [(1.0, 0.5), (0.5, 2.0)])
def test_a_box_pulls_the_two_ropes_that_hold_it_in_a_river_with_all_of_its_drag(size, density):
    (w, h), speed = size, 2.0
    parts = jelly(size, density / DENSITY, -4.0)
    corners = [[-w / 2.0, -4.0 - h / 2.0], [-w / 2.0, -4.0 + h / 2.0]]
    parts["particles"] = [{"id": f"p{k}", "position": [x - 3.0, y], "pinned": True} for k, (x, y) in enumerate(corners)]
    river = pool((-40, -12, 40, 0), density=density, flow=[speed, 0.0])
    held = water_world([river], **parts)
    ends = [np.argmin(np.hypot(*(held.position - corner).T)) for corner in corners]
    parts["springs"] = [{"a": f"p{k}", "b": f"box.{end}", "material": "steel"} for k, end in enumerate(ends)]
    parts["materials"] = parts.get("materials", {}) | STEEL
    world = after(water_world([river], **parts), 20)
    drag = density * (speed**2 / 2.0 * h + 0.5 * speed * 2.0 * (w + h))
    ropes = np.isin(world.particle_a, [world.particle_slot(name) for name in ("p0", "p1")])
    assert float(spring_forces(world)[ropes].sum()) == pytest.approx(drag, rel=0.02)


def test_a_net_across_a_river_hangs_from_its_posts_with_all_of_its_drag():
    names = [f"n{k}" for k in range(9)]
    net = [{"id": n, "position": [0.0, -2.0 - 0.5 * k], "radius": 0.1, "mass": 0.3} for k, n in enumerate(names)]
    net[0]["pinned"] = net[-1]["pinned"] = True
    ties = [{"a": a, "b": b, "material": "steel", "rest_length": 0.6} for a, b in itertools.pairwise(names)]
    river = pool((-40, -12, 40, 0), density=DENSITY, flow=[1.0, 0.0])
    world = after(water_world([river], particles=net, springs=ties, materials=STEEL), 30)
    along = world.position[world.particle_b] - world.position[world.particle_a]
    along /= np.hypot(*along.T)[:, None]
    pull = spring_forces(world)[:, None] * along
    held = float(pull[0, 0] - pull[7, 0])
    assert abs(held) == pytest.approx(7.0 * DENSITY * 0.1 * (1.0 + math.pi), rel=0.02)


def test_a_mill_turns_with_the_river_and_no_faster():
    paddles = {"type": "mesh", "id": "mill", "material": "steel", "particle_radius": 0.05, "masses": [0.5] * 9,
               "particles": [[0.0, 0.0]] + [[math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)] for k in range(8)],
               "springs": [[0, k] for k in range(1, 9)] + [[k, k % 8 + 1] for k in range(1, 9)],
               "pinned": [0]}  # fmt: skip
    river = pool((-40, -12, 40, -0.3), density=DENSITY, flow=[2.0, 0.0])
    world = water_world([river], bodies=[paddles], materials=STEEL)
    rates = []
    for _ in range(1200):
        step(world)
        x, v = world.position[1:9] - world.position[0], world.velocity[1:9]
        rates.append(float(np.mean(x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])))
    # What is under water goes with the river, to the right.
    assert 0.5 < np.mean(rates[-300:]) < 2.0


@pytest.mark.parametrize("density", [10.0, 1000.0])
def test_a_hand_holds_a_ball_in_a_river(density):
    river = pool((-40, -12, 40, 0), density=density, flow=[1.0, 0.0])
    session = session_of(zones=[river], particles=[ball(density / DENSITY, y=-4.0)])
    order(session, type="grab", grab=0, particle="ball", target=[0.0, -4.0])
    for _ in range(600):
        session.advance()
    assert np.hypot(*(session.world.position[0] - (0.0, -4.0))) < 0.05
    assert np.abs(session.world.velocity[0]).max() < 1e-3


def test_what_a_river_lets_go_is_never_faster_than_the_river():
    parts = {"particles": [ball(1.0, y=-4.0), {"id": "a", "position": [0, -6], "pinned": True, "radius": 0.01}],
             "springs": [{"a": "a", "b": "ball", "material": "steel"}], "materials": STEEL}  # fmt: skip
    world = after(water_world([pool((-400, -12, 400, 0), density=1000.0, flow=[1.0, 0.0])], **parts), 10)
    world.cut([0])
    for _ in range(120):
        step(world)
        assert world.velocity[0, 0] <= 1.0 + 1e-6


# ---- energy at any density


def energies(world, ticks):
    """Energy [J] at each tick, at the places that belong to the velocities: half a step back."""
    moves, found, h = free(world), [], 1.0 / world.settings.tick_rate
    for _ in range(ticks):
        step(world)
        place, velocity = world.position.copy(), world.velocity
        world.position[:] = place - 0.5 * h * velocity
        found.append(0.5 * float(np.sum(world.mass[moves, None] * velocity[moves] ** 2)) + gravity_energy(world))
        world.position[:] = place
    return np.array(found)


@pytest.mark.parametrize("density", [10.0, 1e3, 1e4, 1e6])
@pytest.mark.parametrize("drag", [{}, CALM, {"slow_drag": 0.0}])
def test_calm_water_gives_a_ball_no_energy_at_any_density(density, drag):
    thrown = {"id": "ball", "radius": 0.3, "mass": 2.0, "position": [0, 2], "velocity": [1, -20]}
    found = energies(water_world([pool((-400, -400, 400, 0), density=density, **drag)], particles=[thrown]), 600)
    assert found.max() <= 1.001 * found[0]


@pytest.mark.parametrize("stiffness", [1.0, 0.4])
@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("share", [0.5, 0.05])
def test_a_box_that_bobs_in_calm_water_never_has_more_energy_than_at_the_start(share, angle, stiffness):
    parts = jelly((1.0, 0.5), share, 1.25, stiffness, 1.0 if stiffness == 1.0 else 0.6, angle=angle)
    found = energies(water_world([pool(**CALM)], **parts), 1200)
    assert found.max() <= 1.001 * found[0]


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("kind", ["jelly", "ring"])
def test_a_soft_body_thrown_into_real_water_comes_out_with_no_more_energy(kind, solver):
    parts = moved(BODIES[kind], 0.0, 1.5) | {"materials": {"m": {"stiffness": 0.4, "damping": 0.6}}}
    parts["bodies"] = [parts["bodies"][0] | {"velocity": [0, -8], "particle_mass": 0.05, "material": "m"}]
    world = water_world([pool((-99, -99, 99, 0), density=1000.0, **CALM)], settings={"solver": solver}, **parts)
    found = energies(world, 300)
    assert found.max() <= 1.01 * found[0]


def test_a_ball_floats_at_rest_in_real_water():
    world = after(water_world([pool(density=1000.0)], particles=[ball(50.0, y=0.4)]), 30)
    assert lift_over_weight(world) == pytest.approx(1.0, abs=1e-5)
    assert np.abs(world.velocity).max() < 1e-4
