"""The reference in docs/ and the schema: generated, equal, and true."""

import json
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.document.schema import schema
from sandbox.level.reading.files import parse_level
from sandbox.level.reference import EXAMPLE, format_reference
from tests.support.malformed_levels import GOOD, encoded

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "level-format.md"


def definitions():
    whole = schema()
    return [whole, *whole["$defs"].values()]


def test_the_reference_is_what_the_schema_says():
    stale = "write it anew: python -m sandbox.level.reference > docs/level-format.md"
    assert REFERENCE.read_text(encoding="utf-8") == format_reference(), stale


def test_the_reference_s_example_is_a_level():
    assert parse_level(EXAMPLE.encode(), "example").bodies[0].id == "deck"


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
    assert set(GOOD) <= set(whole["properties"]) == set(Level.model_fields)
    assert whole["required"] == ["format", "version", "name"]
    assert parse_level(encoded(GOOD), "x")
