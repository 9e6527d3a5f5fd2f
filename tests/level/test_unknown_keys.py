"""An unknown key in any object that the JSON Schema knows is named in one clear line; new objects come along."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

from sandbox.level.document.schema import schema
from sandbox.level.reading.files import LevelError, parse_level
from sandbox.level.reading.salvage import salvage

SCHEMA = schema()
UNKNOWN = "qqq"


def resolved(part: dict[str, Any]) -> dict[str, Any]:
    return SCHEMA["$defs"][part["$ref"].rpartition("/")[2]] if "$ref" in part else part


def choices(part: dict[str, Any]) -> list[dict[str, Any]]:
    """The part itself, or its alternatives, but for null."""
    part = resolved(part)
    given = part.get("anyOf") or part.get("oneOf")
    return [each for choice in given for each in choices(choice)] if given else [part]


def sample(part: dict[str, Any]) -> Any:
    """A value that the library takes for this part of the schema."""
    part = next(choice for choice in choices(part) if choice.get("type") != "null")
    if "const" in part or "enum" in part:
        return part.get("const", part.get("enum", [None])[0])
    if part["type"] == "array":
        return [sample(item) for item in part.get("prefixItems", [part.get("items")] * part.get("minItems", 0))]
    if part["type"] == "object":
        return {key: sample(part["properties"][key]) for key in part.get("required", ())}
    return {"string": "a", "boolean": True}.get(part["type"], part.get("minimum", 1))


def objects(part: dict[str, Any], outer: tuple[str, ...] = ()) -> Iterator[tuple[list[str], dict[str, Any], Any]]:
    """The place of every object inside a part of the schema, the object's own schema, and a value that holds it.

    outer: titles of the objects around it; one that holds others of its kind is gone into once.
    """
    for choice in choices(part):
        if "properties" in choice:
            if outer.count(choice["title"]) > 1:
                continue
            whole = sample(choice)
            yield [], choice, {**whole, UNKNOWN: 1}
            for key, inner in choice["properties"].items():
                for place, found, value in objects(inner, (*outer, choice["title"])):
                    yield [key, *place], found, {**whole, key: value}
        elif choice.get("type") == "array" and "items" in choice:
            for place, found, value in objects(choice["items"], outer):
                yield ["0", *place], found, [value]
        else:
            for items in choice.get("patternProperties", {}).values():
                for place, found, value in objects(items, outer):
                    yield ["a", *place], found, {"a": value}


CASES = {f"{'.'.join(place)} of {found['title']}": (place, found, level) for place, found, level in objects(SCHEMA)}


def test_every_object_of_the_schema_is_reached():
    assert {found["title"] for _, found, _ in CASES.values()} == {
        SCHEMA["title"],
        *(definition["title"] for definition in SCHEMA["$defs"].values()),
    }


@pytest.mark.parametrize("case", CASES)
def test_an_unknown_key_is_refused_in_one_line_that_lists_the_keys_there(case):
    place, found, level = CASES[case]
    with pytest.raises(LevelError) as refused:
        parse_level(json.dumps(level).encode(), "x.json")
    (fault,) = refused.value.faults
    where, _, keys = fault.partition("; the keys here are ")
    assert where == f"x.json: {'.'.join([*place, UNKNOWN])}: unknown key"
    assert set(keys.split(", ")) == set(found["properties"])


@pytest.mark.parametrize("case", CASES)
def test_an_unknown_key_is_named_when_what_is_valid_is_salvaged(case):
    place, _, level = CASES[case]
    _, faults = salvage(json.dumps(level).encode(), "x.json")
    assert any(f"{'.'.join([*place, UNKNOWN])}: unknown key" in fault for fault in faults)
