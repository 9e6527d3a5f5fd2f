"""Belts: a surface that runs carries what touches it at its speed, on terrain and on the edges of bodies."""

import json
import math

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.energy import energy_tests
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.step import step

GRAVITY = 9.81
BELT = 2.0
ACCURATE = ("direct", "iterative")
# Cs and Cd of boxes: rigid, firm and underdamped. Single pass allows no more than the last.
RIGID, FIRM, SPRINGY, EXPLICIT = (1.0, 1.0), (0.4, 0.6), (0.6, 0.2), (0.05, 0.1)


def parsed(**parts):
    data = {"format": "spring-sandbox/level", "version": 2, "name": "belts", "contacts": {"friction": 0.8}, **parts}
    return parse_level(json.dumps(data).encode(), "belts")


def built(solver="direct", gravity=-GRAVITY, **parts):
    settings = {"solver": solver, "gravity": [0.0, gravity], **({"iterations": 20} if solver == "iterative" else {})}
    return build_world(parsed(settings=settings, **parts))


def ground(degrees=0.0, belt=BELT, friction=0.8, form="polygon"):
    """A piece of ground whose surface goes up to the right."""
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    corners = [(-60, 0), (60, 0)] if form == "polyline" else [(-60, -1), (60, -1), (60, 0), (-60, 0)]
    turned = [(cosine * x - sine * y, sine * x + cosine * y) for x, y in corners]
    return {"id": "ground", form: turned, "friction": friction, "belt": belt}


def box(degrees=0.0, stiffness=FIRM, above=0.26, **more):
    """A box of 80 by 40 cm that stands on it."""
    angle = math.radians(degrees)
    return {
        "materials": {"m": {"stiffness": stiffness[0], "damping": stiffness[1]}},
        "bodies": [
            {
                "type": "jelly", "id": "b", "shape": {"box": [0.8, 0.4]}, "angle": angle, "spacing": 0.2,
                "position": [-above * math.sin(angle), above * math.cos(angle)], "material": "m", "particle_mass": 2.0,
                **more,
            }
        ],
    }  # fmt: skip


def disc(degrees=0.0, **more):
    """A disc of 30 cm that lies on it."""
    angle = math.radians(degrees)
    place = [-0.3 * math.sin(angle), 0.3 * math.cos(angle)]
    return {"particles": [{"id": "b", "position": place, "mass": 5.0, "radius": 0.3, **more}]}


def speed_along(world, degrees=0.0):
    chosen = [name.partition(".")[0] == "b" for name in world.particle_names]
    x, y = np.average(world.velocity[chosen], axis=0, weights=world.mass[chosen])
    return float(x * math.cos(math.radians(degrees)) + y * math.sin(math.radians(degrees)))


def speeds(world, degrees=0.0, ticks=360, last=120):
    """The speeds [m/s] of the last ticks."""
    found = []
    for _ in range(ticks):
        step(world)
        found.append(speed_along(world, degrees))
    return found[-last:]


@pytest.mark.parametrize("stiffness", [RIGID, FIRM, SPRINGY], ids=["rigid", "firm", "springy"])
@pytest.mark.parametrize("degrees", [0.0, 20.0, -20.0])
@pytest.mark.parametrize("solver", ACCURATE)
def test_a_box_goes_at_the_speed_of_the_belt_up_and_down(solver, degrees, stiffness):
    found = speeds(built(solver, terrain=[ground(degrees)], **box(degrees, stiffness)), degrees)
    np.testing.assert_allclose(found, BELT, rtol=0.01)


@pytest.mark.parametrize("degrees", [0.0, 20.0, -20.0])
@pytest.mark.parametrize("solver", [*ACCURATE, "single_pass"])
def test_a_disc_that_does_not_roll_goes_at_the_speed_of_the_belt(solver, degrees):
    found = speeds(built(solver, terrain=[ground(degrees)], **disc(degrees, rolls=False)), degrees)
    np.testing.assert_allclose(found, BELT, rtol=1e-9)


def test_single_pass_carries_a_soft_box_on_the_flat_at_the_speed_of_the_belt():
    found = speeds(built("single_pass", terrain=[ground()], **box(stiffness=EXPLICIT)), ticks=600, last=300)
    assert np.mean(found) == pytest.approx(BELT, rel=0.01)


@pytest.mark.parametrize("solver", [*ACCURATE, "single_pass"])
def test_a_disc_that_rolls_is_carried_at_a_third_of_the_speed(solver):
    # m v = J and m r^2 / 2 w = r J, until the surfaces move alike: v + r w = belt, of which r w is two thirds.
    world = built(solver, terrain=[ground()], **disc(rolling=0.0))
    np.testing.assert_allclose(speeds(world), BELT / 3.0, rtol=1e-6)
    assert 0.3 * world.spin[0] == pytest.approx(2.0 * BELT / 3.0, rel=1e-6)


@pytest.mark.parametrize("solver", ACCURATE)
def test_a_box_comes_from_rest_to_the_speed_in_the_time_that_friction_takes(solver):
    world, friction = built(solver, terrain=[ground(friction=0.5)], contacts={"friction": 0.5}, **box(above=0.25)), 0.5
    by_hand = 0.99 * BELT / (friction * GRAVITY)
    assert by_hand == pytest.approx(0.404, abs=1e-3)
    while speed_along(world) < 0.99 * BELT and world.tick < 120:
        step(world)
    assert world.tick / 60 == pytest.approx(by_hand, abs=1 / 60)


@pytest.mark.parametrize("solver", ACCURATE)
def test_on_a_belt_that_is_too_steep_a_box_slides_as_on_a_slope(solver):
    parts = {"terrain": [ground(35.0, friction=0.5)], "contacts": {"friction": 0.5}, **box(35.0, above=0.25)}
    world, angle = built(solver, **parts), math.radians(35.0)
    by_hand = -(math.sin(angle) - 0.5 * math.cos(angle)) * GRAVITY * 2.0
    assert speeds(world, 35.0, 120, 1)[0] == pytest.approx(by_hand, rel=1e-3)


@pytest.mark.parametrize("solver", [*ACCURATE, "single_pass"])
def test_a_body_whose_own_edges_run_drives(solver):
    # Who stands on its under side looks down, and has its left at the right.
    stiffness = EXPLICIT if solver == "single_pass" else FIRM
    world = built(solver, terrain=[ground(belt=0.0)], **box(stiffness=stiffness, belt=1.5))
    assert np.mean(speeds(world)) == pytest.approx(1.5, rel=0.01)


@pytest.mark.parametrize("solver", ACCURATE)
@pytest.mark.parametrize("pinned", [True, False])
def test_a_belt_of_springs_carries_what_lies_on_it_whether_its_ends_are_pinned_or_heavy(solver, pinned):
    belt = {
        "type": "mesh", "id": "belt", "particles": [[-30.0, 0.0], [30.0, 0.0]], "springs": [[0, 1]],
        "masses": [1e6, 1e6], "gravity_scale": 0.0, "belt": BELT, "pinned": [0, 1] if pinned else [],
    }  # fmt: skip
    world = built(solver, bodies=[belt], **disc(rolls=False))
    np.testing.assert_allclose(speeds(world), BELT, rtol=1e-3)


def test_a_line_of_terrain_carries_to_the_right_above_and_to_the_left_below():
    line = ground(form="polyline")
    above = built(terrain=[line], **disc(rolls=False))
    below = built(gravity=GRAVITY, terrain=[line], particles=[
        {"id": "b", "position": [0.0, -0.3], "radius": 0.3, "rolls": False}
    ])  # fmt: skip
    assert speeds(above, last=1)[0] == pytest.approx(BELT, rel=1e-9)
    assert speeds(below, last=1)[0] == pytest.approx(-BELT, rel=1e-9)


def test_an_edge_on_a_corner_of_a_belt_is_carried():
    # A plank that lies across the tip of a wedge, and is too long to touch anything else.
    wedge = {"id": "wedge", "polygon": [[-0.2, -1.0], [0.2, -1.0], [0.0, 0.0]], "belt": BELT}
    plank = {
        "type": "mesh", "id": "b", "particles": [[-3.0, 0.05], [3.0, 0.05]], "springs": [[0, 1]], "masses": [1.0, 1.0],
        "material": "rigid",
    }  # fmt: skip
    world = built(terrain=[wedge], bodies=[plank], materials={"rigid": {"stiffness": 1.0, "damping": 1.0}})
    assert speeds(world, ticks=40, last=1)[0] > 0.9 * BELT


def test_a_belt_takes_as_much_out_of_a_fast_box_as_it_gives_to_a_slow_one():
    world = built(terrain=[ground()], **box(velocity=[5.0, 0.0]))
    np.testing.assert_allclose(speeds(world), BELT, rtol=1e-6)
    tests = energy_tests(world)
    assert tests.slowed_down == tests.minimised == 0


def test_a_belt_that_does_not_run_changes_no_bit():
    still, plain = ground(belt=0.0), ground(belt=0.0)
    del plain["belt"]
    worlds = [built(terrain=[piece], **box(20.0)) for piece in (still, plain)]
    for _ in range(60):
        for world in worlds:
            step(world)
        assert state_hash(worlds[0]) == state_hash(worlds[1])


def test_states_with_belts_are_restored_to_the_bit():
    world = built(terrain=[ground()], **box(belt=0.5))
    speeds(world, ticks=20)
    start = take(world)
    speeds(world, ticks=20)
    hashed = state_hash(world)
    restore(world, start)
    speeds(world, ticks=20)
    assert state_hash(world) == hashed


def test_springs_that_are_no_edges_have_no_belt():
    world = built(terrain=[ground()], **box(belt=0.5))
    assert set(world.belt[world.edge != 0].tolist()) == {0.5}
    assert not world.belt[world.edge == 0].any()


@pytest.mark.parametrize(
    ("value", "told"), [(1e4, "10000.0 is above the limit 1000"), (-1e4, "below the limit"), ("fast", "belt")]
)
def test_a_belt_that_nobody_can_mean_is_refused_in_one_line(value, told):
    with pytest.raises(LevelError) as refusal:
        parsed(terrain=[ground(belt=value)])
    (fault,) = refusal.value.faults
    assert told in fault and "terrain.0.belt" in fault
