"""Zones and water of a level: what is refused, in which words, and what is kept."""

import json

import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.salvage import salvage
from sandbox.level.reference import examples
from sandbox.physics.step import step

POOL = {"id": "pool", "box": [-5, -2, 5, 0]}
GOAL = {"id": "goal", "circle": [1, 2, 0.5]}
GATE = {"id": "gate", "polygon": [[0, 0], [1, 0], [1, 1]]}


def encoded(**parts):
    return json.dumps({"format": "spring-sandbox/level", "version": 3, "name": "test", **parts}).encode()


def faults(**parts):
    with pytest.raises(LevelError) as refusal:
        parse_level(encoded(**parts), "test")
    return [line.removeprefix("test: ") for line in refusal.value.faults]


FAULTS = [
    ({"id": "z"}, "needs one of box, circle and polygon"),
    ({**POOL, "circle": [0, 0, 1]}, "needs one of box, circle and polygon"),
    ({"id": "z", "box": [5, -2, -5, 0]}, "box: left and bottom come first and must be below right and top"),
    ({"id": "z", "box": [0, 0, 1]}, "box: needs 4 numbers, has 3"),
    ({"id": "z", "circle": [0, 0]}, "circle: needs 3 numbers, has 2"),
    ({"id": "z", "circle": [0, 0, 0]}, "circle.2: 0 is not above 0"),
    ({"id": "z", "polygon": [[0, 0], [1, 0]]}, "polygon: has 2 items; at least 3 are needed"),
    ({"id": "z", "polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}, "polygon: its sides touch or cross"),
    ({"id": "ball", "circle": [0, 0, 1]}, 'id: "ball" is taken; every zone needs an id of its own'),
    ({"id": "ground", "circle": [0, 0, 1]}, 'id: "ground" is taken'),
    ({**GOAL, "water": {}}, "water: only a box holds water; give the zone a box, or take the water out"),
    ({**POOL, "water": {"density": 0}}, "water.density: 0 is not above 0"),
    ({**POOL, "water": {"fast_drag": -1}}, "water.fast_drag: -1 is below the limit 0"),
    ({**POOL, "water": {"slow_drag": "much"}}, 'water.slow_drag: "much" is text, not a number'),
    ({**POOL, "water": {"flow": 1}}, "water.flow: 1 is not a list [...]"),
    ({**POOL, "water": {"drag": 1}}, 'water.drag: unknown key; did you mean "slow_drag"?'),
    ({**POOL, "look": {"colour": "red"}}, "look.colour: "),
    ({**POOL, "solid": True}, "solid: unknown key"),
]


@pytest.mark.parametrize(("zone", "told"), FAULTS)
def test_each_fault_of_a_zone_is_one_clear_line(zone, told):
    ground = {"id": "ground", "polyline": [[0, 0], [1, 0]]}
    path = "zones.0" if told.startswith("needs one") else "zones.0."
    found = faults(particles=[{"id": "ball"}], terrain=[ground], zones=[zone])
    assert len(found) == 1
    assert found[0].startswith(f"{path}{': ' if path == 'zones.0' else ''}{told}")


def test_faults_of_several_zones_are_told_at_once():
    found = faults(zones=[{"id": "a"}, {**GOAL, "water": {}}, {**GOAL, "circle": [0, 0, 2]}])
    assert [line.split(": ")[0] for line in found] == ["zones.0", "zones.1.water", "zones.2.id"]


def test_a_list_of_too_few_numbers_says_how_many_each_place_needs():
    assert faults(walls={"box": [0, 1, 2]}) == ["walls.box: needs 4 numbers, has 3"]
    assert faults(view=[0, 1]) == ["view: needs 4 numbers, has 2"]
    assert faults(particles=[{"id": "a", "position": [1]}]) == ["particles.0.position: needs 2 numbers, has 1"]
    assert faults(welds=[["a"]]) == ["welds.0: needs 2 names, has 1"]


def test_a_level_with_zones_is_written_and_read_as_it_was():
    water = {"density": 4.0, "fast_drag": 0.5, "flow": [1.0, 0.0]}
    zones = [{**POOL, "water": water, "look": {"colour": "lagoon"}}, GOAL, {**GATE, "extras": {"by": "me"}}]
    level = parse_level(encoded(zones=zones), "test")
    text = level_text(level)
    assert parse_level(text.encode(), "test") == level
    assert '    {"id": "goal", "circle": [1.0, 2.0, 0.5]},\n' in text
    assert level_text(parse_level(encoded(zones=[{**POOL, "water": {}}]), "test")).count('"water": {}') == 1


def test_water_that_is_not_described_is_ten_kilograms_a_square_metre():
    water = parse_level(encoded(zones=[{**POOL, "water": {}}]), "test").zones[0].water
    assert (water.density, water.fast_drag, water.slow_drag, water.flow) == (10.0, 1.0, 0.5, (0.0, 0.0))


def test_what_is_valid_of_zones_is_salvaged():
    zones = [{"id": "a"}, {**POOL, "water": {"density": -1}}, {**GOAL, "water": {}}, GATE]
    kept, told = salvage(encoded(zones=zones), "test")
    assert [zone.id for zone in kept.zones] == ["pool", "goal", "gate"]
    assert kept.zones[0].water is None and kept.zones[1].water is None
    assert len(told) == 3


def test_a_zone_alone_makes_nothing_touch():
    assert not parse_level(encoded(zones=[POOL, GOAL, GATE]), "test").has_contacts


def test_the_reference_s_example_of_water_is_a_level_whose_raft_floats_as_deep_as_it_says():
    level = parse_level(examples()[1].encode(), "example")
    world = build_world(level)
    for _ in range(900):
        step(world)
    raft = world.position[: world.grab_particle, 1]
    assert -raft.min() == pytest.approx(0.27 * 0.5, rel=0.02)
