"""Rigid bodies that contacts or hands hold keep their motion: no tick takes what nothing dissipates.

Right values are those of rigid bodies and of energy alone. Of a swing a reading at the end of a tick knows the height
to within what falls at its speed in half a tick; a loss in one tick is read to within g^2 h^2 / 2.
"""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from sandbox.cli import main
from sandbox.level.reading.files import load_level
from sandbox.physics.analysis.energy import EnergyTests, energy_tests, forget_energy_tests, total_energy
from sandbox.physics.jit import COMPILED
from sandbox.physics.snapshot import state_hash
from sandbox.session.session import Session
from sandbox.session.summary import run
from tests.support.situations import RIGID, advance, order, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

G = 9.81
SMOOTH = {"friction": 0.0, "restitution": 0.0}
# What a tick may take of what swings.
SHARE = 1e-3
SOFTER = {"stiffness": 0.9, "damping": 0.95}


def ground(**parts):
    """A long level ground at y = 0."""
    return {"terrain": [{"id": "ground", "polyline": [[-90, 0], [90, 0]]}], "contacts": SMOOTH, **parts}


def losses(session, ticks, mass, swing):
    """The largest loss of energy in a tick beyond what is not known of heights, and what is left: shares of swing."""
    world = session.world
    h = 1.0 / world.settings.tick_rate
    start = before = total_energy(world)
    worst = -math.inf
    for _ in range(ticks):
        session.advance()
        now = total_energy(world)
        worst = max(worst, (before - now - 0.5 * mass * G * G * h * h) / swing)
        before = now
    return worst, (before - start) / swing + 1.0


def cart(mass, bob, length, degrees, **settings):
    """The parts of a level: a pendulum under a cart on smooth ground; and its energy [J] above its lowest point."""
    a = math.radians(degrees)
    parts = ground(
        settings=settings, springs=[{"a": "cart", "b": "bob", "material": "m"}],
        particles=[
            {"id": "cart", "position": [0, 0.05], "mass": mass, "collides": ["terrain"]},
            {"id": "bob", "position": [length * math.sin(a), 0.05 - length * math.cos(a)], "mass": bob,
             "collides": False},
        ],
    )  # fmt: skip
    return parts, bob * G * length * (1.0 - math.cos(a))


@pytest.mark.parametrize(
    "settings", [{}, {"tick_rate": 30}, {"tick_rate": 240}, {"substeps": 4}, {"substeps": 16}], ids=str
)
@pytest.mark.parametrize(
    ("mass", "bob", "length", "degrees"), [(12.0, 3.0, 1.5, 80.0), (3.0, 4.0, 3.0, 120.0), (90.0, 2.0, 0.8, 45.0)]
)
def test_a_pendulum_under_a_cart_loses_nothing_in_any_tick(mass, bob, length, degrees, settings):
    parts, swing = cart(mass, bob, length, degrees, **settings)
    session = session_of(**parts)
    rate = session.world.settings.tick_rate
    worst, left = losses(session, 8 * rate, bob, swing)
    assert worst < SHARE * max(1.0, 60.0 / rate) ** 2
    assert left == pytest.approx(1.0, abs=0.05 if rate >= 60 else 0.12)


def rod(points, friction, **settings):
    """A rod of points [m] along it that leans by 0.06, its foot on the ground, and the speed its head is to land at."""
    lean = 0.06
    places = [[k * math.sin(lean), 0.05 + k * math.cos(lean)] for k in points]
    session = session_of(**ground(
        settings=settings, contacts={"friction": friction, "restitution": 0},
        particles=[{"id": f"p{k}", "position": place, "radius": 0.05} for k, place in enumerate(places)],
        springs=[{"a": f"p{k}", "b": f"p{k + 1}", "material": "m"} for k in range(len(points) - 1)],
    ))  # fmt: skip
    fall = G * sum(points) * math.cos(lean)
    # On a rough floor it rolls on the rim of its foot.
    about = sum(k * k + (0.05**2 if friction > 0.0 else 0.0) for k in points)
    return session, fall, points[-1] * math.sqrt(2.0 * fall / about)


@pytest.mark.parametrize("settings", [{}, {"tick_rate": 120}, {"substeps": 4}], ids=str)
@pytest.mark.parametrize("friction", [0.0, 0.9])
@pytest.mark.parametrize("length", [0.7, 1.4, 3.0])
def test_a_rod_that_falls_over_lands_as_fast_as_its_height_makes_it(length, friction, settings):
    session, fall, right = rod([0.0, length], friction, **settings)
    world = session.world
    head, worst, seen = world.particle_slot("p1"), 0.0, 0.0
    h = 1.0 / world.settings.tick_rate
    before = total_energy(world)
    while world.tick < 4 * world.settings.tick_rate and world.position[head, 1] > 0.05 + h * seen:
        lands = world.position[head, 1] < 0.05 + 2.0 * h * seen
        session.advance()
        worst, before = max(worst, 0.0 if lands else before - total_energy(world)), total_energy(world)
        seen = max(seen, -float(world.velocity[head, 1]))
    assert seen == pytest.approx(right, rel=0.09)
    assert worst / fall < 5.0 * SHARE


def over_edge(u, r, link):
    """The place u [m] along the way over a square edge at the origin, on which no link of radius r is in the table."""
    far = math.hypot(r, link / 2.0)
    start, end = math.atan2(r, -link / 2.0), math.atan2(-link / 2.0, r)
    angle = start - u / far
    if u <= 0.0:
        return [u - link / 2.0, r]
    return [far * math.cos(angle), far * math.sin(angle)] if angle > end else [r, far * (angle - end) - link / 2.0]


def chain_over_edge(links, length, over, r, **settings):
    """A chain on a smooth table, no link strained, and how much of it hangs over [m]: about as much as is asked for."""
    link, ways = length / links, [over - length]
    for _ in range(links):
        low, high, last = ways[-1], ways[-1] + 2.0 * link, over_edge(ways[-1], r, link)
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if math.dist(over_edge(middle, r, link), last) < link else (low, middle)
        ways.append(high)
    pose = [over_edge(u, r, link) for u in ways]
    session = session_of(
        contacts=SMOOTH, settings=settings,
        terrain=[{"id": "table", "polygon": [[-9, -0.5], [0, -0.5], [0, 0], [-9, 0]]}],
        bodies=[{
            "type": "rope", "id": "c", "start": [over - length, r], "end": [over, r], "segments": links,
            "particle_mass": 0.1, "particle_radius": r, "material": "m", "pose": pose,
        }],
    )  # fmt: skip
    return session, r - pose[-1][1]


@pytest.mark.parametrize("settings", [{}, {"tick_rate": 120}, {"substeps": 4}, {"substeps": 16}], ids=str)
@pytest.mark.parametrize(("links", "length", "over", "r"), [(30, 2.4, 0.4, 0.05), (24, 3.0, 0.7, 0.08)])
def test_a_chain_slides_off_a_smooth_table(links, length, over, r, settings):
    session, over = chain_over_edge(links, length, over, r, **settings)
    world = session.world
    start = total_energy(world)
    for _ in range(world.settings.tick_rate):
        session.advance()
        assert total_energy(world) < start + 0.01 * 0.1 * links * G * length
    rate = math.sqrt(G / length)
    # The corner takes a part of what is straight.
    seen = float(world.velocity[slots_of(session, "c")[0], 0])
    assert seen == pytest.approx(over * rate * math.sinh(rate), rel=0.2)


def string(length, mass, segments=1):
    """A straight rope out to the right of the origin with a weight at its end, and the energy [J] of its swing."""
    rope = {
        "type": "rope", "start": [0, 0], "end": [length, 0], "segments": segments, "particle_mass": 0.01,
        "end_mass": mass,
    }  # fmt: skip
    return rope, (mass + 0.005 * segments) * G * length


def jelly(size, mass, **firmness):
    """A square that hangs by its upper left corner, to the right of that, and the energy [J] of its swing."""
    box = {
        "type": "jelly", "shape": {"box": [size, size]}, "spacing": size / 4.0, "particle_mass": mass / 25.0,
        "position": [size / 2.0, -size / 2.0], **firmness,
    }  # fmt: skip
    return box, mass * G * size * (math.sqrt(0.5) - 0.5)


def left_of_swing(body, energy, held, seconds, radius=0.0, material=None, **settings):
    """What share of its energy [J] a body has left that has swung so long [s] from a pin, or a hand that is still."""
    session = session_of(
        settings=settings, materials={"m": material or {"stiffness": 1, "damping": 1}},
        bodies=[{"id": "s", "material": "m", **body}],
    )  # fmt: skip
    world = session.world
    own = slots_of(session, "s")
    corner = world.particle_names[own[np.argmin(np.sum(world.position[own] ** 2, axis=1))]]
    if held:
        order(session, type="grab", grab=0, particle=corner, target=[0.0, 0.0], radius=radius)
    else:
        order(session, type="pin", particle=corner)
    start = total_energy(world)
    advance(session, seconds * world.settings.tick_rate)
    return 1.0 + (total_energy(world) - start) / energy


SWINGS = {
    "string": (string(1.5, 3.0), {}),
    "short string": (string(0.7, 0.6), {}),
    "long string, 30 Hz": (string(3.0, 1.0), {"tick_rate": 30}),
    "string, 240 Hz": (string(1.2, 1.0), {"tick_rate": 240}),
    "string, 4 substeps": (string(1.5, 3.0), {"substeps": 4}),
    "string, 16 substeps": (string(1.5, 3.0), {"substeps": 16}),
    "softer string": (string(1.5, 3.0), {"material": SOFTER}),
    "chain of 6": (string(1.8, 4.0, 6), {}),
    "chain of 12": (string(2.4, 4.0, 12), {}),
    "rigid jelly": (jelly(0.8, 4.0), {"radius": 0.5}),
    "jelly": (jelly(0.8, 4.0), {"radius": 0.5, "material": SOFTER}),
    "jelly by one particle": (jelly(0.8, 2.0), {"material": SOFTER}),
    "jelly of a firmness": (jelly(1.2, 4.0, firmness={"sag": 0.02}), {"radius": 0.5}),
}


@pytest.mark.parametrize("kind", SWINGS)
def test_what_hangs_from_a_hand_that_is_still_swings_nearly_as_long_as_from_a_pin(kind):
    (body, energy), given = SWINGS[kind]
    hand = left_of_swing(body, energy, True, 6, **given)
    pin = left_of_swing(body, energy, False, 6, **{key: value for key, value in given.items() if key != "radius"})
    # A hand gives way by millimetres, and takes the work of that.
    assert pin - 0.08 < hand < pin + 0.02
    assert pin > 0.9


@pytest.mark.parametrize("level", ["egg_drop", "jelly_pile", "truck_bridge", "walker", "wrecking_crane"])
def test_hardly_a_step_of_a_shipped_level_is_slowed_down(level):
    session = advance(Session(load_level(f"levels/{level}.json")), 300)
    counts = energy_tests(session.world)
    assert counts.passed > 300
    assert counts.slowed_down <= 2


def test_interpreted_kernels_count_the_same_ways_through_the_energy_test(tmp_path, capsys):
    level = {"format": "spring-sandbox/level", "version": 3, "name": "cart", "materials": {"m": RIGID}}
    path = tmp_path / "cart.json"
    path.write_text(json.dumps({**level, **cart(12.0, 3.0, 1.5, 80.0)[0]}))
    command = ["run", str(path), "--ticks", "60", "--json"]
    assert main(command) == 0
    here = json.loads(capsys.readouterr().out)
    environment = {**os.environ, "SANDBOX_KERNELS": "interpreted"}
    there = json.loads(subprocess.check_output([sys.executable, "-m", "sandbox", *command], env=environment, text=True))
    assert there["energy_tests"] == here["energy_tests"]
    assert there["hash"] == here["hash"]
    assert here["energy_tests"]["solved_on"] > 0
    assert here["energy_tests"]["slowed_down"] > 0


def test_counts_of_the_energy_test_begin_with_each_run_and_are_no_state():
    session = session_of(**cart(12.0, 3.0, 1.5, 80.0)[0])
    first = run(session, 60).energy_tests
    assert first.passed + first.solved_on + first.slowed_down == 60
    state = state_hash(session.world)
    forget_energy_tests(session.world)
    assert energy_tests(session.world) == EnergyTests(0, 0, 0, 0)
    assert state_hash(session.world) == state
    second = run(session, 10).energy_tests
    assert second.passed + second.solved_on + second.slowed_down == 10
