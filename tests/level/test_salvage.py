"""Salvage: what is valid of a level is kept, what is not is told, and nothing is ever raised."""

import copy

import pytest

from sandbox.level.document.canonical import level_text
from sandbox.level.faults.validate import check_level
from sandbox.level.format.limits import FAULT_LIMIT
from sandbox.level.reading.files import LevelError, parse_level
from sandbox.level.reading.salvage import salvage
from tests.support.malformed_levels import GOOD, changed, encoded, small

SMALL = list(small())


def good():
    return parse_level(encoded(GOOD), "x.json")


def salvaged(raw):
    level, lines = salvage(encoded(raw), "x.json")
    assert level is not None
    check_level(level, "x.json")
    return level, lines


def ids(items):
    return [item.id for item in items]


@pytest.mark.parametrize("batch", range(10))
def test_of_every_malformed_level_comes_nothing_or_a_level_that_can_be_saved(batch):
    for name, data in SMALL[batch::10]:
        try:
            level, lines = salvage(data, "levels/x.json")
            assert 1 <= len(lines) <= FAULT_LIMIT
            assert all(line.startswith("levels/x.json: ") and line.isprintable() for line in lines), lines
            if level is not None:
                assert parse_level(level_text(level).encode(), "x.json") == level
        except BaseException as error:
            raise AssertionError(name) from error


@pytest.mark.parametrize("length", [1, 7, 64, 500])
def test_of_a_level_with_any_byte_damaged_comes_nothing_or_a_level_that_can_be_saved(length):
    data = encoded(GOOD)
    for start in range(0, len(data), 29):
        damaged = data[:start] + bytes(255 - byte for byte in data[start : start + length]) + data[start + length :]
        level, lines = salvage(damaged, "x.json")
        assert lines or level == parse_level(damaged, "x.json")
        if level is not None:
            check_level(level, "x.json")


def test_a_valid_level_is_salvaged_whole_and_without_a_word():
    assert salvage(encoded(GOOD), "x.json") == (good(), [])


@pytest.mark.parametrize(
    ("place", "value", "line"),
    [
        ("bodies.0.segments", "30", 'bodies.0.segments: "30" is text, not a whole number'),
        ("bodies.0", 5, "bodies.0: 5 is not an object {...} that describes a body"),
        ("bodies.0.type", "chain", 'bodies.0.type: "chain" is not a kind of body; use rope, '),
    ],
)
def test_a_body_that_cannot_be_is_left_out_alone(place, value, line):
    level, lines = salvaged(changed(place, value))
    assert level == good().model_copy(update={"bodies": good().bodies[1:]})
    assert len(lines) == 1 and lines[0].startswith("x.json: " + line)


def test_an_invalid_field_falls_to_its_default_and_an_unknown_one_away():
    raw = changed("bodies.0.velocity", [1, "fast"])
    raw["bodies"][0]["colour"] = "red"
    level, lines = salvaged(raw)
    assert level == good()
    assert [line.split(": ")[1] for line in lines] == ["bodies.0.velocity.1", "bodies.0.colour"]


def test_what_refers_to_a_part_that_falls_falls_with_it_and_places_stay_those_of_the_file():
    raw = copy.deepcopy(GOOD)
    raw["springs"] = [{"a": "ball"}, *raw["springs"], {"a": "rope.3", "b": "net.0"}]
    raw["particles"][0]["id"] = 7
    level, lines = salvaged(raw)
    assert level.particles == () and level.checks == ()
    assert [(spring.a, spring.b) for spring in level.springs] == [("rope.3", "net.0")]
    assert [line.split(": ")[1] for line in lines] == [
        "particles.0.id",
        "springs.0.b",
        "springs.1.a",
        "checks.0.particle",
    ]


def test_a_material_that_falls_leaves_its_springs_to_the_default():
    level, lines = salvaged(changed("materials.steel", 5))
    assert "steel" not in level.materials and "classic" in level.materials
    assert level.springs[0].material == level.bodies[5].material == "default"
    assert len(lines) == 1 + sum(getattr(part, "material", "") == "steel" for part in (*good().bodies, *good().springs))


def test_of_bodies_of_one_name_the_first_is_kept():
    level, lines = salvaged(changed("bodies.1.id", "rope"))
    assert ids(level.bodies) == [body.id for body in good().bodies if body.id != "deck"]
    assert lines[0].startswith('x.json: bodies.1.id: "rope" is taken')


def test_of_lists_of_indices_only_the_wrong_ones_go():
    net = {**GOOD["bodies"][5], "pinned": [1, 9, 0], "springs": [[0, 1], [0, 5], [1, 1]]}
    level, lines = salvaged({**GOOD, "bodies": [net], "springs": [], "welds": [], "checks": []})
    assert level.bodies[0].pinned == (1, 0) and level.bodies[0].springs == ((0, 1),)
    assert len(lines) == 3


def test_settings_are_kept_one_by_one():
    settings = {"gravity": [0, -1], "tick_rate": 0, "solver": "magic", "iterations": 7}
    level, lines = salvaged({**GOOD, "settings": settings})
    assert level.settings.gravity == (0.0, -1.0) and level.settings.iterations == 7 and level.settings.tick_rate == 60
    assert [line.split(": ")[1] for line in lines] == ["settings.tick_rate", "settings.solver"]


def test_a_weld_that_squeezes_a_body_goes_before_the_body():
    level, lines = salvaged({**GOOD, "welds": [["rope.0", "rope.1"], ["deck.0", "net.0"]]})
    assert level.welds == (("deck.0", "net.0"),)
    assert level.bodies == good().bodies
    assert len(lines) == 1


def test_a_body_beyond_all_measure_falls_and_the_ones_after_it_stay():
    level, lines = salvaged(changed("bodies.1.segments", 10**9))
    assert ids(level.bodies) == [body.id for body in good().bodies if body.id != "deck"]
    assert "bodies.1.segments" in lines[0]


def test_a_body_that_no_longer_fits_beside_the_loose_particles_falls():
    particles = [{"id": f"p{number}", "position": [number, 0]} for number in range(60_000)]
    ropes = [
        {"type": "rope", "id": f"rope{segments}", "start": [0, 0], "end": [9, 0], "segments": segments}
        for segments in (30_000, 20_000, 9_998)
    ]
    raw = {**GOOD, "bodies": ropes, "particles": particles, "springs": [], "welds": [], "checks": []}
    level, lines = salvaged(raw)
    assert len(level.particles) == 60_000
    assert ids(level.bodies) == ["rope30000", "rope9998"]
    assert lines == ["x.json: bodies.1.segments: brings the level above 100,000 particles; make it smaller or coarser"]


def test_a_list_longer_than_a_file_may_hold_is_cut():
    level, lines = salvaged({**GOOD, "tags": [f"tag {number}" for number in range(150)]})
    assert level.tags == tuple(f"tag {number}" for number in range(100))
    assert lines == ["x.json: tags: has 150 items; the first 100 are taken"]


def test_a_level_without_a_name_is_untitled():
    level, lines = salvaged({key: value for key, value in GOOD.items() if key != "name"})
    assert level.name == "Untitled"
    assert lines == ['x.json: name: is missing; it is taken for "Untitled"']


def test_a_key_that_stands_twice_counts_as_it_stood_last():
    text = encoded(GOOD).decode().replace('"name": "Good"', '"name": "First", "name": "Good"')
    assert salvage(text.encode(), "x.json") == (good(), ['x.json: the key "name" stands more than once in one object'])


def test_bytes_that_are_no_text_cost_only_themselves():
    data = encoded(GOOD).replace(b"Every kind", b"Ev\xffry kind")
    level, lines = salvage(b"\xef\xbb\xbf" + data, "x.json")
    assert level == good().model_copy(update={"description": "Ev\ufffdry kind of thing once."})
    assert len(lines) == 1  # a mark is no fault


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (b"", "x.json: line 1, column 1: not JSON: expecting value"),
        (encoded(GOOD)[:-40], "x.json: line 1, column"),
        (b"[1]", "x.json: a level is an object {...}; this is a list"),
        (encoded({**GOOD, "format": "map"}), 'x.json: format: "map" is not "spring-sandbox/level"; this is no level'),
        (
            encoded({**GOOD, "version": 99}),
            "x.json: version: 99: made by a newer program; this program reads version 4 of the format, update it",
        ),
        (b"[" * 100_000, "x.json: line 1: lists and objects are nested"),
    ],
)
def test_what_is_no_level_gives_none_and_a_line(data, line):
    level, lines = salvage(data, "x.json")
    assert level is None
    assert len(lines) == 1 and lines[0].startswith(line)
    with pytest.raises(LevelError):
        parse_level(data, "x.json")


def test_of_a_flood_of_faults_fifty_lines_are_told():
    springs = [{"a": "ball", "b": "nobody"}] * 3_000 + GOOD["springs"]
    level, lines = salvaged({**GOOD, "springs": springs})
    assert level == good()
    assert len(lines) == FAULT_LIMIT and lines[-1] == "x.json: there are more faults than these"
