"""Terrain, walls and collision groups of a level: what is refused, what they become, and what stays as it was."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import expansion
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.level.reading.parse import parse_level
from sandbox.level.reading.salvage import salvage
from sandbox.physics.marks import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.step import step

SQUARE = [[0, 0], [4, 0], [4, -1], [0, -1]]


def level(**parts):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "test", **parts}
    return parse_level(json.dumps(data).encode(), "test")


def faults(**parts):
    with pytest.raises(LevelError) as refusal:
        level(**parts)
    return [line.removeprefix("test: ") for line in refusal.value.faults]


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_a_level_without_terrain_walls_or_contacts_has_none(path):
    level = read_level(path)
    assert build_world(level).has_contacts == bool(level.contacts or level.walls or level.terrain)


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ({"terrain": [{"id": "g"}]}, "terrain.0: needs one of polyline and polygon"),
        ({"terrain": [{"id": "g", "polygon": [[0, 0], [1, 0]]}]}, "terrain.0.polygon: has 2 corners"),
        ({"terrain": [{"id": "g", "polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}]}, "sides touch or cross"),
        ({"terrain": [{"id": "g", "polyline": [[0, 0], [0, 0]]}]}, "a corner comes twice in a row"),
        ({"terrain": [{"id": "g", "polyline": [[0, 0], [1e7, 0]]}]}, "polyline.1.0: 10000000.0 is above the limit"),
        ({"terrain": [{"id": "g", "polygon": SQUARE}], "particles": [{"id": "g"}]}, 'terrain.0.id: "g" is taken'),
        ({"walls": {"box": [1, 0, 0, 1]}}, "walls.box: left and bottom come first"),
        ({"contacts": {"friction": -1}}, "contacts.friction: -1 is below the limit 0"),
        ({"particles": [{"id": "b", "collides": ["balls"]}]}, 'particles.0.collides.0: there is no group "balls"'),
        ({"particles": [{"id": "b", "collides": 3}]}, "particles.0.collides: 3: use true, false or a list"),
        ({"particles": [{"id": "b", "collision_group": "terrain"}]}, "is the group of terrain and walls"),
        ({"particles": [{"id": "b", "rolls": 1}]}, "particles.0.rolls: 1 is not true or false"),
        ({"particles": [{"id": "b", "rolling": 1.5}]}, "particles.0.rolling: 1.5 is above the limit 1"),
        ({"particles": [{"id": "b", "rolling": -0.1}]}, "particles.0.rolling: -0.1 is below the limit 0"),
        ({"particles": [{"id": "b", "spin": 1e5}]}, "particles.0.spin: 100000.0 is above the limit 10000"),
        ({"particles": [{"id": "b", "angle": "up"}]}, "particles.0.angle"),
    ],
)
def test_each_fault_is_one_clear_line(parts, told):
    found = faults(**parts)
    assert len(found) == 1
    assert told in found[0]


def test_what_is_valid_of_terrain_is_salvaged():
    data = {"format": "spring-sandbox/level", "version": 3, "name": "test",
            "terrain": [{"id": "a"}, {"id": "b", "polygon": SQUARE}]}  # fmt: skip
    kept, told = salvage(json.dumps(data).encode(), "test")
    assert [piece.id for piece in kept.terrain] == ["b"]
    assert len(told) == 1


def test_a_level_with_contacts_is_written_and_read_as_it_was():
    given = level(
        contacts={"friction": 0.3},
        walls={"box": [-5, -5, 5, 5]},
        terrain=[{"id": "g", "polygon": SQUARE, "restitution": 0.5}],
        particles=[{"id": "b", "collides": ["terrain"], "collision_group": "balls", "position": [1, 1]}],
    )
    assert parse_level(level_text(given).encode(), "test") == given


def test_bodies_touch_terrain_and_each_other_unless_they_say_otherwise():
    balls = [
        {"id": "a", "position": [1, 0.5], "radius": 0.2},
        {"id": "b", "position": [2, 0.5], "radius": 0.2, "collides": False},
        {"id": "c", "position": [1, 1.2], "radius": 0.2, "collides": ["terrain"]},
    ]
    world = build_world(level(terrain=[{"id": "g", "polygon": SQUARE}], particles=balls))
    for _ in range(90):
        step(world)
    a, b, c = world.position[:3, 1]
    assert a == pytest.approx(0.2, abs=1e-3)
    assert b < -3.0
    assert c == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize(
    "shape", [{"box": [2, 1]}, {"circle": 1.0}, {"polygon": [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]}]
)
def test_the_outline_of_a_jelly_is_closed_and_has_it_on_its_left(shape):
    body = level(bodies=[{"type": "jelly", "id": "j", "shape": shape, "spacing": 0.25}]).bodies[0]
    made = expansion(body)
    points, pairs, kind = made.form, made.pairs, made.edges
    a = np.where(kind == SOLID_RIGHT, pairs[:, 1], pairs[:, 0])
    b = np.where(kind == SOLID_RIGHT, pairs[:, 0], pairs[:, 1])
    outline = (kind == SOLID_LEFT) | (kind == SOLID_RIGHT)
    leaving, coming = (np.bincount(ends[outline], minlength=len(points)) for ends in (a, b))
    area = 0.5 * np.sum(points[a, 0] * points[b, 1] - points[b, 0] * points[a, 1], where=outline)
    assert np.array_equal(leaving, coming)
    assert area > 0.8
    assert np.count_nonzero(kind == NO_EDGE) > np.count_nonzero(outline)


def test_every_spring_of_a_rope_is_a_line():
    body = level(bodies=[{"type": "rope", "id": "r", "start": [0, 0], "end": [1, 0], "segments": 5}]).bodies[0]
    assert np.all(expansion(body).edges == LINE)


def test_loose_particles_roll_unless_they_say_otherwise_and_start_as_they_are_turned():
    rope = {"type": "rope", "id": "r", "start": [5, 0], "end": [6, 0], "segments": 1}
    balls = [
        {"id": "a"},
        {"id": "b", "rolls": False, "rolling": 0.02, "angle": 1.0, "spin": -3.0},
        {"id": "c", "pinned": True, "spin": 2.0},
        {"id": "d", "spin": 2.0},
    ]
    world = build_world(level(bodies=[rope], particles=balls, springs=[{"a": "d", "b": "r.0"}]))
    assert world.rolls[:6].tolist() == [True, True, True, False, True, True]
    assert world.rolling[:6].tolist() == [1e-3, 1e-3, 1e-3, 0.02, 1e-3, 1e-3]
    assert world.angle[:6].tolist() == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    assert world.spin[:6].tolist() == [0.0, 0.0, 0.0, -3.0, 0.0, 0.0]


def test_discs_that_are_welded_roll_where_both_do():
    balls = [{"id": name, "rolls": name != "c", "rolling": 0.01 * k} for k, name in enumerate("abc")]
    world = build_world(level(particles=balls, welds=[["a", "b"]]))
    assert world.rolls[:2].tolist() == [True, False] and world.rolling[:2].tolist() == [0.01, 0.02]
    world = build_world(level(particles=balls, welds=[["a", "c"]]))
    assert world.rolls[:2].tolist() == [False, True] and world.rolling[:2].tolist() == [0.02, 0.01]
