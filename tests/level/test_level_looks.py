"""Looks in level files: what is refused, what is only found, and what is written."""

import json

import pytest

from sandbox.editor.lint.looks import unknown_looks
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_data, level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.look import PALETTE, colour_of
from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash

LEVEL = {
    "format": "spring-sandbox/level",
    "version": 4,
    "name": "Looks",
    "settings": {"solver": "single_pass"},
    "look": {"theme": "light", "ground": {"left glass": "glass"}, "faces": True},
    "materials": {"m": {"look": {"line": "chain", "width": 1.5}}},
    "bodies": [
        {"type": "rope", "id": "r", "start": [0, 0], "end": [2, 0], "segments": 2, "material": "m"}
        | {"look": {"skin": "jelly", "colour": "raspberry", "face": True, "panel": "#8D99B0", "window": [0, 1, 2]}}
    ],
    "particles": [{"id": "p", "position": [0, 3], "look": {"ball": "steel", "colour": "#8D99B0"}}],
}


def parsed(level):
    return parse_level(json.dumps(level).encode(), "looks")


def changed(path, value):
    level = json.loads(json.dumps(LEVEL))
    at = level
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return level


def test_a_look_is_written_as_it_was_read():
    level = parsed(LEVEL)
    assert level_data(level) == LEVEL
    assert parse_level(level_text(level).encode(), "again") == level


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("bodies", 0, "look", "colour"), "mauve", "is no colour"),
        (("bodies", 0, "look", "colour"), "#12345", "is no colour"),
        (("particles", 0, "look", "colour"), 7, "not a text|is not text"),
        (("bodies", 0, "look", "gloss"), 1, "unknown key"),
        (("look", "theme"), "sepia", '"dark" or "light"'),
        (("look", "faces"), 1, "not true or false"),
        (("materials", "m", "look", "width"), 0, "below the limit"),
        (("bodies", 0, "look", "window"), [-1], "below the limit"),
    ],
)
def test_what_no_look_can_be_is_refused_in_one_line(path, value, says):
    with pytest.raises(LevelError) as refusal:
        parsed(changed(path, value))
    (fault,) = refusal.value.faults
    assert any(each in fault for each in says.split("|")), fault
    assert ".".join(map(str, path)) in fault


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("bodies", 0, "look", "skin"), "jely", 'did you mean "jelly"?'),
        (("materials", "m", "look", "line"), "spaghetti", 'the material "m" has the line "spaghetti"'),
        (("particles", 0, "look", "ball"), "moon", '"p" has the ball "moon"'),
        (("look", "ground"), {"left glass": "cheese"}, "no ground"),
        (("look", "ground"), {"nowhere": "glass"}, "no terrain"),
    ],
)
def test_names_that_nobody_knows_are_found_and_do_no_harm(path, value, says):
    found = [each for each in unknown_looks(parsed(changed(path, value))) if each is not None]
    assert any(says in each.text for each in found), [each.text for each in found]


def test_a_level_whose_looks_are_known_has_nothing_to_be_found():
    level = changed(("look", "ground"), {})
    assert [each for each in unknown_looks(parsed(level)) if each is not None] == []


CORNERS, SIDES = [[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 2], [0, 2]]


CORNERS, SIDES = [[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 2], [0, 2]]


@pytest.mark.parametrize(
    ("body", "wears"),
    [
        ({"type": "rope", "start": [0, 0], "end": [1, 0], "segments": 4}, False),
        ({"type": "bridge", "start": [0, 0], "end": [4, 0], "segments": 6, "height": 0.5}, False),
        ({"type": "mesh", "particles": CORNERS, "springs": SIDES}, False),
        ({"type": "mesh", "particles": CORNERS, "springs": SIDES, "triangles": [[0, 1, 2]]}, True),
        ({"type": "jelly", "shape": {"box": [1, 1]}, "spacing": 0.5}, True),
        ({"type": "wheel", "radius": 0.5, "thickness": 0.1, "segments": 8}, True),
    ],
)
def test_a_picture_that_nobody_sees_is_found(body, wears):
    level = {**LEVEL, "bodies": [{"id": "b", **body, "look": {"picture": "hat.png"}}], "look": {}}
    found = [each.text for each in unknown_looks(parsed(level)) if each is not None]
    assert found == [] if wears else found[0].startswith('"b" shows no picture')


def test_no_look_reaches_the_state_of_a_world():
    bare = json.loads(json.dumps(LEVEL))
    del bare["look"]
    for part in (bare["materials"]["m"], bare["bodies"][0], bare["particles"][0]):
        del part["look"]
    assert state_hash(build_world(parsed(bare))) == state_hash(build_world(parsed(LEVEL)))


def test_colours_are_of_the_palette_or_of_six_digits():
    assert colour_of("lemon") == PALETTE["lemon"] and colour_of("#0A0b0C") == 0x0A0B0C
