"""Malformed levels: each is refused in lines that a person can use, and nothing else is ever raised."""

import gc
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.level.format.limits import FAULT_LIMIT
from sandbox.level.reading.files import LevelError, parse_level
from tests.support.enormous_levels import ENORMOUS
from tests.support.malformed_levels import GOOD, changed, encoded, small

SMALL = list(small())

# What the validation library or Python would say, and no level maker should have to read.
JARGON = ("pydantic", "http", "Traceback", "Input should", "Value error", "discriminator", "Error", "<class", "tuple")


def faults_of(data):
    # Not by pytest.raises, which would keep all that was read of an enormous level, in a ring, until the next search.
    try:
        parse_level(data, "levels/x.json")
    except LevelError as error:
        return error.faults
    raise AssertionError("it was not refused")


def assert_clear(faults):
    assert 1 <= len(faults) <= FAULT_LIMIT
    for fault in faults:
        assert fault.startswith("levels/x.json: ")
        assert fault.isprintable() and len(fault) < 600
        assert not [word for word in JARGON if word in fault], fault
    assert len(set(faults)) == len(faults)


def test_the_level_that_the_corpus_mutates_is_good():
    assert parse_level(encoded(GOOD), "good").name == "Good"


def test_the_corpus_is_large():
    assert len(SMALL) > 250


@pytest.mark.parametrize("batch", range(10))
def test_every_malformed_level_is_refused_in_clear_lines(batch):
    for name, data in SMALL[batch::10]:
        try:
            assert_clear(faults_of(data))
        except BaseException as error:
            raise AssertionError(name) from error


def refuse_enormous(kind: str) -> None:
    """Look at the faults of all levels of a kind."""
    for name, data in next(each for each in ENORMOUS if each.__name__ == kind)():
        try:
            assert_clear(faults_of(data))
        except BaseException as error:
            raise AssertionError(name) from error


# Of those kinds one level or several take seconds to be refused.
LARGEST = ("of_many_parts", "of_many_springs", "of_many_keys", "of_long_words")
KINDS = [
    pytest.param(name, marks=pytest.mark.whole_world if name in LARGEST else ())
    for name in (each.__name__ for each in ENORMOUS)
]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_enormous_malformed_level_is_refused_in_clear_lines(kind):
    # Some hundred MB that this process would not give back.
    looked = f"from tests.level.test_malformed_levels import refuse_enormous; refuse_enormous({kind!r})"
    ended = subprocess.run(
        [sys.executable, "-c", looked], cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize("length", [1, 7, 64, 500])
def test_a_level_with_any_byte_damaged_is_read_or_refused(length):
    good = encoded(GOOD)
    for start in range(0, len(good), 13):
        damaged = good[:start] + bytes(255 - byte for byte in good[start : start + length]) + good[start + length :]
        try:
            parse_level(damaged, "x.json")
        except LevelError as error:
            assert all(fault.isprintable() for fault in error.faults)


def test_all_faults_are_listed_at_once_in_the_order_of_the_file():
    wrong = {**GOOD, "settings": {"tick_rate": 0, "substeps": 3}, "materials": {"steel": {"stiffness": 1.3}}}
    assert faults_of(encoded(wrong)) == [
        "levels/x.json: settings.tick_rate: 0 is below the limit 1",
        'levels/x.json: settings.substeps: 3: substeps are a power of two: 1, 2, 4, 8, 16, 32, 64; or "auto"',
        "levels/x.json: materials.steel.stiffness: 1.3 is above the limit 1",
    ]


def test_all_faults_of_references_are_listed_at_once():
    springs = [{"a": "ball", "b": "ball"}, {"a": "nobody", "b": "deck.1000"}]
    assert faults_of(encoded({**GOOD, "springs": springs})) == [
        'levels/x.json: springs.0: joins "ball" to itself; name two particles',
        'levels/x.json: springs.1.a: there is no body or particle "nobody"',
        'levels/x.json: springs.1.b: "deck" has the particles deck.0 to deck.81',
    ]


def test_of_thousands_of_faults_the_first_are_listed_and_the_rest_mentioned():
    springs = [{"a": "ball", "b": "ball"}] * 3_000 + [{"a": 1}] * 3_000
    faults = faults_of(encoded({**GOOD, "springs": springs}))
    assert faults[0] == "levels/x.json: springs.3000.a: 1 is not text in quotes"
    assert len(faults) == FAULT_LIMIT
    assert faults[-1] == "levels/x.json: there are more faults than these"


def test_a_flood_of_keys_does_not_make_present_keys_missing():
    keys = {f"k{number}": 1 for number in range(5_000)}
    faults = faults_of(encoded({**keys, "bodies": [{**keys, **GOOD["bodies"][0]}], **GOOD}))
    assert all("unknown key" in fault for fault in faults[:-1])


@pytest.mark.parametrize(
    ("place", "value", "fault"),
    [
        ("bodies.0", 5, "bodies.0: 5 is not an object {...} that describes a body"),
        ("bodies.0.extras", 5, "bodies.0.extras: 5 is not an object {...}"),
        ("bodies.0.type", "chain", 'bodies.0.type: "chain" is not a kind of body; use rope, bridge, girder, web, '),
        ("bodies.0.start", [1], "bodies.0.start: needs 2 numbers, has 1"),
        ("bodies.0.start", [1, 2, 3], "bodies.0.start: has 3 items; at most 2 are possible"),
        ("view", [1, 2], "view: needs 4 numbers, has 2"),
        ("bodies.0.segments", "30", 'bodies.0.segments: "30" is text, not a whole number'),
        ("bodies.0.segments", 3.0, "bodies.0.segments: 3.0 is not a whole number"),
        ("particles.0.pinned", 1, "particles.0.pinned: 1 is not true or false"),
        ("materials.steel.law", "x", 'materials.steel.law: "x" is not "hooke"'),
        ("bodies.2.shape", {"star": 5}, 'bodies.2.shape: a shape is {"box": [width, height]}, '),
        ("bodies.1.id", "rope", 'bodies.1.id: "rope" is taken; every body and loose particle needs an id of its own'),
        ("bodies.1.material", "stel", 'bodies.1.material: there is no material "stel"; did you mean "steel"?'),
        (
            "bodies.1.material",
            "st\u0435el",
            'bodies.1.material: there is no material "st\u0435el"; it only looks like "steel": '
            "its character 3 is CYRILLIC SMALL LETTER IE",
        ),
        ("bodies.0.pinned", [31], "bodies.0.pinned.0: 31 is beyond the last particle, 30"),
        ("bodies.6.cut", [15], "bodies.6.cut.0: 15 is beyond the last spring, 14"),
        ("bodies.8.pose", [[0, 0]], "bodies.8.pose: has 1 items for 7 particles; give one each"),
        ("bodies.8.thickness", 1.0, "bodies.8.thickness: 1.0 is not below the radius, 1.0"),
        ("bodies.6.end", [0.5, 0], "bodies.6.end: is where start is; a girder is at least 1e-06 long"),
        ("bodies.7.pin", ["hub"], 'bodies.7.pin.0: "hub" is not "rim"'),
        ("welds.0", ["rope.0"], "welds.0: needs 2 names, has 1"),
        ("welds.0", ["rope.0", "rope.start"], 'welds.0: joins "rope.0" to itself; name two particles'),
        ("welds.0.1", "dek.0", 'welds.0.1: there is no body or particle "dek"; did you mean "deck"?'),
        ("welds.0.1", "cart", 'welds.0.1: "cart" is a body; name one of its particles: cart.0 to cart.6 or cart.hub'),
        ("welds.0", ["ball", "deck.20"], "springs.0: the welds make one particle of both its ends; take a weld or"),
        (
            "welds.0",
            ["rope.3", "rope.4"],
            'bodies.0: the welds make one particle of both ends of "rope:3"; take a weld out or cut 3',
        ),
        ("version", 5, "version: 5: made by a newer program; this program reads version 4 of the format, update it"),
        ("format", "map", 'format: "map" is not "spring-sandbox/level"; this is no level'),
    ],
)
def test_a_fault_says_where_it_is_and_what_is_wrong(place, value, fault):
    assert faults_of(encoded(changed(place, value)))[0].startswith("levels/x.json: " + fault)


def test_a_syntax_fault_has_its_line_and_column():
    assert faults_of(b'{\n "format": 1,\n "name" "x"\n}') == [
        "levels/x.json: line 3, column 9: not JSON: expecting ':' delimiter"
    ]


def test_nesting_is_measured_outside_strings_alone():
    deepest = '{"a":' * 30 + '["[[[[", "\\\\", "{\\"{"]' + "}" * 30
    level = {**GOOD, "extras": {}}
    text = encoded(level).decode().replace('"extras": {}', f'"extras": {deepest}')
    assert parse_level(text.encode(), "x").extras
    deeper = text.replace('["[[[["', '[["[[[["]').encode()
    assert faults_of(deeper)[0].startswith("levels/x.json: line 1: lists and objects are nested more than 32 deep")


def test_the_collector_of_cycles_runs_on_after_a_large_file():
    assert gc.isenabled()
    faults_of(b'{"tags": [' + b"1," * 600_000 + b"1]}")
    assert gc.isenabled()


def test_every_name_in_the_corpus_stands_once():
    names = [name for name, _ in SMALL]
    assert len(set(names)) == len(names)
