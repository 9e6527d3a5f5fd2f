"""The shipped levels: canonical, complete, and true to the checks that they carry."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import judge
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import load_level, parse_level, read_level, shipped_levels
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.jit import COMPILED
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step

LEVELS = [path.stem for path in shipped_levels()]

# The format's own example, as its description gives it.
EXAMPLE = """
    {"format": "spring-sandbox/level", "version": 3, "name": "Rope, bridge, jelly", "description": "...", "author": "...", "licence": "...", "tags": ["demo"],
     "settings": {"gravity": [0.0, -9.81], "tick_rate": 60, "substeps": 1, "solver": "iterative", "iterations": 10, "warm_start": 0.5},
     "view": [-12.0, -1.0, 12.0, 12.0],
     "materials": {"steel": {"stiffness": 1.0, "damping": 1.0}, "jelly": {"stiffness": 0.02, "damping": 0.1}},
     "bodies": [
       {"type": "rope", "id": "rope", "start": [0, 5], "end": [3, 5], "segments": 30, "particle_mass": 1.0, "end_mass": 1000.0, "rest_length": 0.1, "pin": ["start"], "material": "steel"},
       {"type": "bridge", "id": "deck", "start": [-5, 2], "end": [5, 2], "segments": 40, "height": 0.5, "particle_mass": 1.0, "pin": ["start", "end"], "material": "steel"},
       {"type": "jelly", "id": "cube", "shape": {"box": [2.0, 2.0]}, "position": [0, 6], "angle": 0.0, "spacing": 0.25, "particle_mass": 0.1, "material": "jelly"},
       {"type": "mesh", "id": "net", "particles": [[0, 0], [1, 0]], "masses": [1.0, 2.0], "velocities": [[0, 0], [0, 1]], "pinned": [0], "springs": [[0, 1]], "material": "steel"}],
     "particles": [{"id": "ball", "position": [0, 3], "mass": 100.0, "radius": 0.3, "pinned": false}],
     "springs": [{"a": "ball", "b": "deck.20", "rest_length": null, "material": "steel"}]}
"""  # noqa: E501


def test_the_format_s_example_expands_as_described():
    world = build_world(parse_level(EXAMPLE.encode(), "example"))
    assert world.grab_particle == 31 + 2 * 41 + 9 * 9 + 2 + 1
    assert world.grab_spring == 30 + (5 * 40 + 1) + (2 * 72 + 2 * 64) + 1 + 1
    assert world.particle_b[world.grab_spring - 1] == world.particle_slot("deck.20") == 31 + 20


def test_the_shipped_example_shows_each_kind_of_the_format_s_example():
    example, shipped = parse_level(EXAMPLE.encode(), "example"), load_level("rope_bridge_jelly")
    assert {body.type for body in shipped.bodies} >= {body.type for body in example.bodies}
    assert {body.id for body in shipped.bodies} >= {body.id for body in example.bodies}
    assert "ball" in {particle.id for particle in shipped.particles}


def test_the_promised_levels_are_shipped():
    promised = {"rope_bridge_jelly", "rope", "wrecking_ball", "suspension_bridge", "truss_bridge", "girder", "mast"}
    promised |= {"quad_mesh", "spider_web", "jelly_cube", "jelly_wheel", "side_by_side", "hooke_comparison"}
    promised |= {"breaking_bridge", "catapult", "ferris_wheel", "curtain", "beating_heart"}
    promised |= {"rope_bridge_wheel", "truck_bridge", "wrecking_crane", "trampoline", "newtons_cradle", "walker"}
    promised |= {"suspension_car", "dominoes", "marble_mill", "hourglass", "tumble_drum", "pinball", "balloons"}
    promised |= {"clock_spring", "jelly_pile"}
    assert promised <= set(LEVELS)


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_a_shipped_level_is_canonical_and_complete(path):
    level = read_level(path)
    assert level_text(level).encode() == path.read_bytes()
    assert level.description and level.tags and level.view
    assert (level.author, level.licence) == ("Spring Sandbox", "CC0-1.0")
    assert 1 <= len(level.checks) <= 3
    assert json.loads(path.read_text())["settings"]["solver"] in ("single_pass", "iterative", "direct")


def measured(level):
    """What each check of a shipped level asks for, by check, from one run of the level by itself."""
    world = build_world(level)
    rate = level.settings.tick_rate
    due = {check: round(check.after * rate) for check in level.checks}
    strains, values = [], {}
    for tick in range(1, max(due.values()) + 1):
        step(world)
        strains.append(float(np.abs(strain(world)[load_bearing(world)]).max(initial=0.0)))
        for check in (check for check in level.checks if due[check] == tick):
            values[check] = metric(world, check, max(strains[-2 * rate :]))
    return values


def metric(world, check, largest_strain):
    """The value of a check's metric in a world as it is now."""
    speeds = np.sqrt(np.sum(world.velocity**2, axis=1))
    if check.particle is not None:
        slot = world.particle_slot(check.particle)
        return {"x": world.position[slot, 0], "y": world.position[slot, 1], "speed": speeds[slot]}[check.metric]
    return {
        "max_strain": largest_strain,
        "max_speed": float(speeds.max()),
        "broken_springs": float(np.count_nonzero(~world.spring_active[: world.grab_spring])),
        "non_finite": float(np.count_nonzero(~np.isfinite(world.position))),
    }[check.metric]


@pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes; the next test takes its place")
@pytest.mark.parametrize("name", LEVELS)
def test_a_shipped_level_keeps_its_own_checks(name):
    level = load_level(name)
    results = [judge(check, value) for check, value in measured(level).items()]
    assert len(results) == len(level.checks)
    assert [result.text for result in results if not result.passed] == []


@pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")
@pytest.mark.parametrize("name", LEVELS)
def test_a_shipped_level_runs_twice_with_the_same_bits(name):
    hashes = []
    for _ in range(2):
        world = build_world(load_level(name))
        for _ in range(60):
            step(world)
        hashes.append(state_hash(world))
    assert hashes[0] == hashes[1]


@pytest.mark.parametrize("name", LEVELS)
def test_a_shipped_level_starts_inside_its_view_and_finite(name):
    level = load_level(name)
    world = build_world(level)
    for _ in range(60 if COMPILED else 1):
        step(world)
    left, bottom, right, top = level.view
    shown = world.position[: world.grab_particle]
    assert np.all(np.isfinite(shown))
    if name not in ("hooke_comparison", "sorting_belt"):
        assert np.all((shown >= [left, bottom]) & (shown <= [right, top]))
