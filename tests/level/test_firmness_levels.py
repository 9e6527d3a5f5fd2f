"""Firmness in level files: what is refused, and why; what files keep."""

import json

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level
from tests.support.wobbles import firm_level

BOX = {"shape": {"box": [1, 1]}, "spacing": 0.25}
NOT_STIFF = "firmness: is for forms that are stiff without pins, and this {} is not: it gives way without any spring"


def fault(firmness, **body):
    with pytest.raises(LevelError) as refused:
        parse_level(firm_level(firmness, **(body or BOX)), "x.json")
    (text,) = refused.value.faults
    return text


@pytest.mark.parametrize(
    ("firmness", "text"),
    [
        ({}, "firmness: an object: say sag, or hz: one of the two"),
        ({"ratio": 0.2}, "firmness: an object: say sag, or hz: one of the two"),
        ({"sag": 0.1, "hz": 2.0}, "firmness: an object: say sag, or hz: one of the two"),
        ({"sag": 0.1, "ratio": 0.2}, "firmness: an object: ratio goes with hz; take it out beside sag"),
        ({"sag": 0.5}, "firmness.sag: 0.5 is above the limit 0.4"),
        ({"sag": -0.1}, "firmness.sag: -0.1 is below the limit 0"),
        ({"hz": 0.001}, "firmness.hz: 0.001 is below the limit 0.01"),
        ({"sag": "soft"}, 'firmness.sag: "soft" is text, not a number'),
        ({"sagg": 0.1}, 'firmness.sagg: unknown key; did you mean "sag"?'),
        ("soft", 'firmness: "soft" is text, not an object {...}'),
        ({"hz": 10.0, "ratio": 0.15},
         "firmness: 10 Hz at ratio 0.15 is out of reach at 60 ticks a second; the nearest is 10 Hz at ratio 0.479"),
        ({"sag": 1e-9}, "firmness: sag 1e-09 is out of reach at 60 ticks a second; the nearest is sag"),
    ],
)  # fmt: skip
def test_what_cannot_be_had_is_a_fault_that_says_what_can(firmness, text):
    assert f"bodies.0.{text}" in fault(firmness)


@pytest.mark.parametrize(
    "body",
    [
        {"type": "rope", "start": [0, 0], "end": [1, 0], "segments": 4},
        {"type": "ring", "radius": 1.0, "segments": 8},
        {"type": "web", "radius": 1.0, "spokes": 6, "rings": 2},
        {"type": "mesh", "particles": [[0, 0], [1, 0], [1, 1], [0, 1]], "springs": [[0, 1], [1, 2], [2, 3], [3, 0]]},
        {"type": "jelly", "shape": {"box": [2, 0.1]}, "spacing": 0.5},
        {"type": "girder", "start": [0, 0], "end": [4, 0], "segments": 4, "cut": [1]},
    ],
    ids=lambda body: body["type"],
)
def test_forms_that_give_way_are_refused(body):
    assert NOT_STIFF.format(body["type"]) in fault({"hz": 1.0}, **body)


@pytest.mark.parametrize(
    "body",
    [
        {"type": "rope", "start": [0, 0], "end": [1, 0], "segments": 4, "bending": {}},
        {"type": "ring", "radius": 1.0, "segments": 8, "bending": {}},
        {"type": "mesh", "particles": [[0, 0], [1, 0], [1, 1], [0, 1]],
         "springs": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]},
        {"type": "girder", "start": [0, 0], "end": [4, 0], "segments": 4},
        {"type": "bridge", "start": [0, 0], "end": [4, 0], "segments": 4, "pin": ["start", "end"]},
        {"type": "wheel", "radius": 1.0, "thickness": 0.2, "segments": 8},
    ],
    ids=lambda body: body["type"],
)  # fmt: skip
def test_forms_that_are_stiff_without_pins_are_taken(body):
    world = build_world(parse_level(firm_level({"hz": 1.0}, **body), "x.json"))
    assert len(set(world.stiffness[: len(world.forms[0].springs)])) == 1
    assert np.all(world.lowest_mode[world.forms[0].springs] > 0.0)


def test_hooke_springs_have_no_firmness():
    data = json.loads(firm_level({"sag": 0.1}, **BOX, material="classic"))
    data["materials"] = {"classic": {"law": "hooke"}}
    with pytest.raises(LevelError, match='firmness: is not for springs of Hooke\'s law, which "classic" is'):
        parse_level(json.dumps(data).encode(), "x.json")


def test_a_file_keeps_what_it_says_and_one_that_says_nothing_means_what_it_meant():
    for firmness in ({"sag": 0.1}, {"hz": 2.3, "ratio": 0.15}, {"hz": 2.3}):
        level = parse_level(firm_level(firmness, **BOX), "x.json")
        assert json.loads(level_text(level))["bodies"][0]["firmness"] == firmness
        assert parse_level(level_text(level).encode(), "y.json") == level
    world = build_world(parse_level(firm_level(None, **BOX), "x.json"))
    assert set(world.stiffness[:-10]) == {0.5} and set(world.damping[:-10]) == {0.9}
    assert not world.lowest_mode.any()


def test_bodies_that_are_moved_or_joined_have_the_same_firmness():
    data = json.loads(firm_level({"hz": 2.0}, **BOX))
    data["bodies"].append({**data["bodies"][0], "id": "other", "position": [1.0, 0.0]})
    apart = build_world(parse_level(json.dumps(data).encode(), "x.json"))
    data["welds"] = [["body.4", "other.0"]]
    welded = build_world(parse_level(json.dumps(data).encode(), "x.json"))
    assert len({*apart.stiffness[:-10], *welded.stiffness[:-10]}) == 1
