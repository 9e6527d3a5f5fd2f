"""A level file that ends too early: what it ends inside of is said."""

import json

import pytest

from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level

LEVEL = (
    '{"format": "spring-sandbox/level", "name": "A, b: [c", "bodies": [{"type": "rope", "id": "r"},'
    ' {"id": "s", "start": [1, 2.5]}], "materials": {"m": {"stiffness": 0.5}}}'
)


@pytest.mark.parametrize(
    ("end", "place"),
    [
        ('"A, b: ', "name"),
        ('"bodies": [', "bodies"),
        ('"bodies": [{"type": "ro', "bodies.0.type"),
        ('"id": "r"}', "bodies"),
        ('"start": [1, 2.', "bodies.1.start.1"),
        ('{"m": {"stiffness": 0', "materials.m.stiffness"),
        ('0.5}}', "the level"),
    ],
)  # fmt: skip
def test_the_message_names_what_is_open_at_the_end(end, place):
    text = LEVEL[: LEVEL.index(end) + len(end)]
    with pytest.raises(LevelError) as caught:
        parse_level(text.encode(), "cut.json")
    assert f"the file ends inside {place}" in str(caught.value)


def test_every_cut_of_a_level_is_said_to_end_early_and_nothing_else_is():
    for length in range(1, len(LEVEL)):
        with pytest.raises(LevelError, match="the file ends inside"):
            parse_level(LEVEL[:length].encode(), "cut.json")
    for wrong in (LEVEL.replace(":", "", 1), LEVEL + "}", LEVEL.replace("[1,", "[1,,"), "nonsense"):
        with pytest.raises(LevelError) as caught:
            parse_level(wrong.encode(), "wrong.json")
        assert "the file ends" not in str(caught.value)
    json.loads(LEVEL)
