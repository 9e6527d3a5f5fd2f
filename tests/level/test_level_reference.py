"""The reference in docs/ and the schema: generated, equal, and true."""

import json
import re
from importlib import resources
from pathlib import Path

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import LEVEL_KEYS
from sandbox.level.document.schema import SCHEMA_ID, TITLES, schema, schema_text
from sandbox.level.format.look import BALLS, GROUNDS, LINES, PALETTE, SKINS
from sandbox.level.kinds.bodies import KINDS
from sandbox.level.reading.files import parse_level
from sandbox.level.reference import examples, format_reference
from sandbox.physics.snapshot import state_hash
from tests.support.malformed_levels import GOOD, encoded

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "level-format.md"


def definitions():
    whole = schema()
    return [whole, *whole["$defs"].values()]


def test_the_reference_is_what_the_schema_says():
    stale = "renew it: python -m sandbox.level.reference > docs/level-format.md"
    assert REFERENCE.read_text(encoding="utf-8") == format_reference(), stale


def test_the_reference_s_example_is_a_level():
    assert parse_level(examples()[0].encode(), "example").bodies[0].id == "deck"


def tables():
    """Rows of every table of fields, as cells, by its title."""
    sections = re.split(r"^##+ ", format_reference(), flags=re.MULTILINE)[1:]
    found = {}
    for section in sections:
        if "| field | type |" in section:
            rows = [line for line in section.splitlines() if line.startswith("| `")]
            found[section.splitlines()[0]] = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    return found


def test_a_field_that_all_bodies_share_is_in_one_table():
    found = tables()
    shared = {row[0] for row in found["Every body"]}
    assert {"`type`", "`id`", "`pose`", "`look`"} < shared
    own = {kind: {row[0] for row in found[kind.capitalize()]} for kind in KINDS}
    assert all(own.values()) and not any(fields & shared for fields in own.values())


def test_every_table_is_there_and_every_row_has_type_unit_limits_and_default():
    found = tables()
    assert set(found) == {"Level", "Every material", "Every body", *TITLES.values()}
    assert [row for rows in found.values() for row in rows if len(row) != 6 or not all(row)] == []


def test_the_table_of_contents_has_every_heading_once_and_no_other():
    text = format_reference()
    contents = re.findall(r"\[([^]]+)\]\(#", text.split("## Contents\n")[1].split("\n## ")[0])
    headings = [title for title in re.findall(r"^##+ (.*)$", text, re.MULTILINE) if title != "Contents"]
    assert contents == headings and len(set(headings)) == len(headings)


def test_what_null_means_is_declared_of_every_field_that_may_be_null_in_few_words():
    fields = [field for item in definitions() for field in item["properties"].values()]
    may_be_null = [field for field in fields if any(each.get("type") == "null" for each in field.get("anyOf", ()))]
    assert len(may_be_null) > 40
    assert [field for field in may_be_null if not 0 < len(field.get("empty", "")) <= 30] == []
    assert [field for field in fields if "empty" in field and field not in may_be_null] == []


def test_every_mistake_that_the_reference_shows_is_refused():
    text = format_reference()
    assert text.count("levels/x.json: ") == text.count('- `"') > 5


def test_every_field_is_described_and_has_a_default_or_is_required():
    for definition in definitions():
        assert definition["description"] and definition["title"]
        for name, field in definition["properties"].items():
            assert field.get("description"), name
            assert ("default" in field) != (name in definition.get("required", [])), name


def test_every_length_mass_and_velocity_has_its_unit():
    units = {name: field.get("unit") for item in definitions() for name, field in item["properties"].items()}
    expected = {"start": "m", "height": "m", "mass": "kg", "particle_mass": "kg", "velocity": "m/s", "gravity": "m/s^2"}
    expected |= {
        "angle": "rad",
        "k": "N/m",
        "c": "N s/m",
        "after": "s",
        "tick_rate": "1/s",
        "spacing": "m",
        "view": "m",
    }
    assert {name: units[name] for name in expected} == expected


def test_every_definition_refuses_unknown_keys():
    assert all(definition["additionalProperties"] is False for definition in definitions())


def test_the_schema_is_json_and_knows_the_keys_of_a_good_level():
    whole = json.loads(json.dumps(schema()))
    assert whole["title"] == "Spring Sandbox level"
    assert set(GOOD) <= set(whole["properties"]) == set(LEVEL_KEYS)
    assert whole["required"] == ["format", "version", "name"]
    assert parse_level(encoded(GOOD), "x")


def test_the_shipped_schema_is_that_of_the_program():
    stale = "renew it: python -m sandbox.level.document.schema > sandbox/level/level.schema.json"
    shipped = resources.files("sandbox.level").joinpath("level.schema.json").read_text(encoding="utf-8")
    assert shipped == schema_text(), stale
    assert schema()["$id"] == SCHEMA_ID


def test_a_level_may_name_its_schema_which_is_kept_first_and_means_nothing():
    linked = parse_level(encoded({**GOOD, "$schema": "level.schema.json"}), "x")
    text = level_text(linked)
    assert text.splitlines()[1] == '  "$schema": "level.schema.json",'
    assert level_text(parse_level(text.encode(), "x")) == text
    plain = parse_level(encoded(GOOD), "x")
    assert "$schema" not in level_text(plain)
    assert state_hash(build_world(linked)) == state_hash(build_world(plain))


def test_terrain_of_neither_form_and_of_both_is_beyond_the_schema():
    forms = schema()["$defs"]["TerrainDef"]["allOf"][0]["oneOf"]
    assert [form["required"] for form in forms] == [["polyline"], ["polygon"]]
    assert all(next(iter(form["properties"].values())) == {"type": "array"} for form in forms)


def test_the_schema_completes_what_things_can_look_like():
    found = schema()["$defs"]
    looks = {"BodyLook": {"skin": SKINS, "line": LINES, "colour": PALETTE}, "ParticleLook": {"ball": BALLS}}
    for model, field, names in [(model, *each) for model, fields in looks.items() for each in fields.items()]:
        assert found[model]["properties"][field]["anyOf"][0]["examples"] == list(names)
    ground = found["LevelLook"]["properties"]["ground"]["patternProperties"]
    assert next(iter(ground.values()))["examples"] == list(GROUNDS)
