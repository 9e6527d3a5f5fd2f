"""Rules and the event log see where things go within a tick: through each bounce of it, and nowhere else."""

import json

import numpy as np
import pytest

from sandbox import Session
from sandbox.bodies import parse_level
from sandbox.commands import AddParticle
from sandbox.level.document.model import ZoneDef
from sandbox.level.plan.rules import zones_of
from sandbox.physics.snapshot import hash_by_array
from sandbox.physics.zones import depth_inside, span_inside
from sandbox.session.event_log import watched_event_log

# Throws of each kind, which reach the wall at as many times within a tick.
THROWS = 40
SPEEDS = (5.0, 15.0, 20.0, 60.0)
RADIUS = 0.1
WALL = {"id": "wall", "polyline": [[1, -5], [1, 5]]}
BOX = {"id": "box", "type": "jelly", "shape": {"box": [0.4, 0.4]}, "spacing": 0.2}


def level_of(zone, rules=(), gravity=(0, 0), restitution=1.0, solver="direct", substeps=1, **parts):
    data = {
        "format": "spring-sandbox/level", "version": 3, "name": "Ways", "zones": zone, "counters": [{"id": "hits"}],
        "settings": {"gravity": gravity, "solver": solver, "substeps": substeps}, "rules": list(rules),
        "contacts": {"restitution": restitution},
    }  # fmt: skip
    return parse_level(json.dumps(data | parts).encode(), "ways")


def crossing(zone, **who):
    return {"id": zone, "when": {"crosses": zone, **who}, "then": [{"count": "hits"}]}


def ball(x, speed, y=0.0, up=0.0):
    return {"id": "ball", "position": [x, y], "velocity": [speed, up], "radius": RADIUS}


def starts(speed, throws=THROWS):
    """Places over the way of a tick from which a ball meets the wall at x = 1 in the second tick or the third."""
    return [1 - RADIUS - (1 + (k + 0.5) / throws) * speed / 60 for k in range(throws)]


def thrown(level, ticks=5):
    run = Session(level)
    for _ in range(ticks):
        run.advance()
    return run


def test_a_way_is_in_a_zone_where_its_places_are():
    chance = np.random.default_rng(7)
    star = [(0.0, 1.0), (-0.2, 0.2), (-1.0, 0.3), (-0.3, -0.2), (-0.6, -1.0), (0.1, -0.4), (0.9, -0.8), (0.3, 0.1)]
    zones = zones_of([
        ZoneDef(id="box", box=(-0.5, -0.3, 0.4, 0.6)), ZoneDef(id="disc", circle=(0.1, -0.2, 0.7)),
        ZoneDef(id="star", polygon=tuple(star)),
    ])  # fmt: skip
    shares = np.linspace(0.0, 1.0, 201)
    for ax, ay, bx, by in chance.uniform(-1.5, 1.5, (50, 4)):
        places = [(ax + share * (bx - ax), ay + share * (by - ay)) for share in shares]
        for z in range(3):
            inside = shares[[depth_inside(zones, z, x, y) >= 0.0 for x, y in places]]
            first, last = span_inside(zones, z, ax, ay, bx, by)
            if inside.size:
                assert (first, last) == pytest.approx((inside[0], inside[-1]), abs=6e-3)
            else:
                assert first > last or last - first < 6e-3


@pytest.mark.parametrize("depth", [0.2, RADIUS + 0.001])
@pytest.mark.parametrize("restitution", [1.0, 0.3])
def test_every_ball_that_bounces_off_a_wall_has_crossed_the_zone_on_it(depth, restitution):
    missed = []
    for speed in SPEEDS:
        for x in starts(speed):
            level = level_of(
                [{"id": "target", "box": [1 - depth, -1, 1, 1]}], [crossing("target", particle="ball")],
                terrain=[WALL], particles=[ball(x, speed)], restitution=restitution,
            )  # fmt: skip
            run = thrown(level)
            if run.world.velocity[0, 0] < 0.0 and run.world.counter[0] != 1.0:
                missed.append((speed, x))
    assert not missed


def test_no_ball_crosses_a_zone_that_is_nearer_to_the_wall_than_its_centre_comes():
    for speed in SPEEDS:
        for x in starts(speed):
            level = level_of(
                [{"id": "target", "box": [1 - RADIUS + 0.001, -1, 2, 1]}], [crossing("target", particle="ball")],
                terrain=[WALL], particles=[ball(x, speed)],
            )  # fmt: skip
            run = thrown(level)
            assert run.world.velocity[0, 0] < 0.0 and run.world.counter[0] == 0.0, (speed, x)


@pytest.mark.parametrize("apart", [0.3, 0.6])
def test_a_ball_between_two_plates_crosses_what_lies_on_each_plate_in_every_tick_in_which_it_meets_it(apart):
    zones = [{"id": "left", "box": [0, -1, 0.11, 1]}, {"id": "right", "box": [apart - 0.11, -1, apart, 1]}]
    plates = [
        {"id": "l", "polyline": [[0, -5], [0, 5]]}, {"id": "r", "polyline": [[apart, 5], [apart, -5]]}
    ]  # fmt: skip
    rules = [crossing(zone, particle="ball") for zone in ("left", "right")]
    met, room = 0, apart - 2 * RADIUS
    for speed in SPEEDS:
        for k in range(THROWS):
            x = RADIUS + room * (k + 0.5) / THROWS
            run = Session(level_of(zones, rules, terrain=plates, particles=[ball(x, speed)]))
            for _ in range(10):
                x, velocity = run.world.position[0, 0], run.world.velocity[0, 0]
                if abs(velocity) < 0.99 * speed:
                    # It has met the other plate in a tick as well, which has stopped it there.
                    break
                run.advance()
                to_left, to_right = x - RADIUS, apart - RADIUS - x
                to_left, to_right = (
                    (to_left + 2 * to_right, to_right) if velocity > 0 else (to_left, to_right + 2 * to_left)
                )
                for rule, way in enumerate((to_left, to_right)):
                    if way < speed / 60 - 0.02:
                        met += 1
                        assert run.world.rule_held[rule] > 0, (speed, x, velocity, rule)
    assert met > 500


@pytest.mark.parametrize("zone", [[0.85, -1, 1, 5], [-9, -1, 1, -0.85]])
def test_a_ball_that_bounces_out_of_a_corner_crosses_what_lies_on_both_walls(zone):
    corner = {"id": "corner", "polyline": [[-9, -1], [1, -1], [1, 5]]}
    for speed in SPEEDS:
        for x in starts(speed):
            level = level_of(
                [{"id": "target", "box": zone}], [crossing("target", particle="ball")], terrain=[corner],
                particles=[ball(x, speed, -x - 0.05, -speed)],
            )  # fmt: skip
            run = thrown(level)
            assert run.world.counter[0] >= 1.0, (speed, x)


@pytest.mark.parametrize("pushed", [0.42, 0.39])
def test_a_ball_crosses_a_ring_around_a_bumper_only_where_it_comes_so_near(pushed):
    for speed in SPEEDS:
        for x in starts(speed):
            bumper = {"id": "bumper", "position": [1.3, 0], "pinned": True, "radius": 0.3}
            level = level_of(
                [{"id": "ring", "circle": [1.3, 0, pushed]}], [crossing("ring", particle="ball")],
                particles=[ball(x, speed, 0.1), bumper],
            )  # fmt: skip
            run = thrown(level)
            assert abs(run.world.velocity[0, 1]) > 0.1 * speed
            assert run.world.counter[0] == (1.0 if pushed > 0.4 else 0.0), (speed, x)


@pytest.mark.parametrize(("solver", "substeps"), [("direct", 1), ("direct", 4), ("iterative", 1), ("single_pass", 1)])
def test_bodies_and_what_a_spring_holds_cross_what_lies_on_the_wall_that_they_bounce_off(solver, substeps):
    zone, soft = [{"id": "target", "box": [0.85, -1, 1, 1]}], {"weak": {"stiffness": 1e-6, "damping": 0.0}}
    for speed in SPEEDS:
        for x in starts(speed, 12):
            body = BOX | {"position": [x - 0.3, 0], "velocity": [speed, 0]}
            held = {
                "particles": [ball(x, speed), {"id": "pin", "position": [-20, 0], "pinned": True}],
                "springs": [{"a": "pin", "b": "ball", "material": "weak"}], "materials": soft,
            }  # fmt: skip
            for who, parts in ({"body": "box"}, {"bodies": [body]}), ({"particle": "ball"}, held):
                level = level_of(
                    zone, [crossing("target", **who)], solver=solver, substeps=substeps, terrain=[WALL], **parts
                )  # fmt: skip
                run = thrown(level)
                assert run.world.velocity[0, 0] >= 0.0 or run.world.counter[0] >= 1.0, (speed, x, who)


def test_what_is_behind_in_a_body_never_crosses_what_lies_on_the_wall_that_its_front_meets():
    for speed in SPEEDS:
        for x in starts(speed, 12):
            body = BOX | {"position": [x, 0], "velocity": [speed, 0]}
            rules = [crossing("target", particle=f"box.{slot}") for slot in (0, 3, 6)]
            rules = [rule | {"id": f"behind {k}"} for k, rule in enumerate(rules)]
            level = level_of(
                [{"id": "target", "box": [0.8, -1, 1, 1]}], rules, terrain=[WALL], bodies=[body],
            )  # fmt: skip
            run = thrown(level)
            assert run.world.counter[0] == 0.0, (speed, x)


def test_the_event_log_tells_what_enters_a_zone_between_the_ends_of_a_tick():
    zone = [{"id": "target", "box": [0.5, -1, 1, 1]}, {"id": "thin", "box": [0.8, -1, 1, 1]}]
    for speed in SPEEDS:
        for x in [x - 0.5 for x in starts(speed, 12)]:
            body = BOX | {"position": [x - 0.3, 2], "velocity": [speed, 0]}
            run = Session(level_of(zone, terrain=[WALL], particles=[ball(x, speed)]))
            told = {each.text.partition(" (")[0] for each in watched_event_log(run, 24)}
            assert {"ball entered target", "ball left target", "ball entered thin"} <= told, (speed, x)
            high = [each | {"box": [each["box"][0], 1, 1, 3]} for each in zone]
            run = Session(level_of(high, terrain=[WALL], bodies=[body], materials={"default": {"stiffness": 1.0}}))
            told = {each.text.partition(" (")[0] for each in watched_event_log(run, 24)}
            assert "box entered target" in told and "box entered thin" not in told, (speed, x)


def test_who_watches_a_run_changes_nothing_of_it():
    zone = [{"id": "target", "box": [0.5, -1, 1, 1]}]
    level = level_of(zone, [crossing("target", particle="ball")], terrain=[WALL], particles=[ball(0.0, 30.0)],
                     bodies=[BOX | {"position": [-2.0, 0.1], "velocity": [20.0, 3.0]}])  # fmt: skip
    alone, watched = thrown(level, 60), Session(level)
    watched_event_log(watched, 60)
    assert hash_by_array(alone.world) == hash_by_array(watched.world)


def test_what_joined_while_it_was_followed_may_be_undone():
    zone = [{"id": "target", "box": [0.5, -1, 1, 1]}]
    run = Session(level_of(zone, [crossing("target", particle="ball")], terrain=[WALL], particles=[ball(-6.0, 30.0)]))
    watched_event_log(run, 2)
    count, gesture = run.world.particle_count, run.new_gesture()
    run.submit(AddParticle((0.0, 3.0)), gesture)
    watched_event_log(run, 4)
    assert run.world.particle_count > count
    run.undo()
    run.advance()
    assert run.world.particle_count == count
    told = watched_event_log(run, 20)
    assert run.world.counter[0] == 1.0 and "ball entered target" in {each.text for each in told}
