"""Every kind of edit of every part of the level format, drawn from its models: what a person may change in a file."""

import copy
import itertools
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from sandbox.level.document.model import Level
from sandbox.level.document.schema import definitions
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import level_data
from sandbox.level.reading.parse import parse_level

SCHEMA = definitions()
# Fields whose value is what the file is, and not what it says.
FIXED = {("Level", "format"), ("Level", "version"), ("HookeMaterial", "law")}
# Values of strings that are no name of a thing, and no word of a list.
WORDS = ["another", "b", "n", "0", "#336699", "wood", "CC0-1.0"]
NUMBERS = [0.25, 0.5, 1.0, 2, 3, 4, 8, 100]

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class LevelEdit:
    """An edit: a field of a part, what is done to it, where in the file, and the level that comes of it."""

    part: str
    field: str
    does: str
    path: Path
    level: Level

    def __str__(self) -> str:
        return f"{self.part}.{self.field}, {self.does}"


def parts_of(level: Level) -> Iterator[tuple[str, Path, BaseModel]]:
    """The models in a level, by name, with the path of each in its file."""

    def walk(value: Any, path: Path) -> Iterator[tuple[str, Path, BaseModel]]:
        if isinstance(value, BaseModel):
            yield type(value).__name__, path, value
            for name, field in type(value).model_fields.items():
                yield from walk(getattr(value, name), (*path, field.alias or name))
        elif isinstance(value, dict):
            for name, each in value.items():
                yield from walk(each, (*path, name))
        elif isinstance(value, tuple):
            for number, each in enumerate(value):
                yield from walk(each, (*path, number))

    return walk(level, ())


def edits_of(part: str, levels: list[Level]) -> list[tuple[Level, LevelEdit]]:
    """An edit of each kind of each field of a part, with the level that it edits: the first in which there is one."""
    found: dict[tuple[str, str], tuple[Level, LevelEdit]] = {}
    for level in levels:
        whole = json.loads(level.model_dump_json())
        samples = {name: _dumped(each) for other in levels for name, _, each in parts_of(other)}
        for name, path, model in parts_of(level):
            if name != part:
                continue
            for field, value in _dumped(model).items():
                if (part, field) in FIXED:
                    continue
                for does, values in _kinds(part, field, value, whole, samples):
                    if (field, does) not in found and (edited := _first(level, (*path, field), values)):
                        found[field, does] = level, LevelEdit(part, field, does, (*path, field), edited)
    return list(found.values())


def _dumped(model: BaseModel) -> dict[str, Any]:
    return json.loads(model.model_dump_json(by_alias=True))


# In place of a value: the field is left out; it is another, wherever its name stands.
ABSENT, CALLED_OTHERWISE = object(), object()


def _kinds(part: str, field: str, value: Any, whole: Any, samples: Any) -> Iterator[tuple[str, Iterator[Any]]]:
    """What can be done to a field, and values that would do it."""
    about = (SCHEMA if part == "Level" else SCHEMA["$defs"][part])["properties"][field]
    yield "another value", _others(about, value, whole, samples)
    yield "left out", iter([ABSENT])
    if field == "id":
        yield "called otherwise", iter([CALLED_OTHERWISE])
    if isinstance(value, list) and value and isinstance(value[0], dict | list) and "items" in str(about):
        yield "one less", ([*value[:k], *value[k + 1 :]] for k in range(len(value)))
        yield "one more", ([*value, _renamed(each)] for each in value)
        yield "another order", iter([value[::-1], [*value[1:], value[0]]])


def _renamed(value: Any) -> Any:
    return {**value, "id": "one more"} if isinstance(value, dict) and "id" in value else value


def _called_otherwise(data: Any, name: str) -> Any:
    text = json.dumps(data)
    for sign in '".:':
        text = text.replace(f'"{name}{sign}', f'"called otherwise{sign}')
    return json.loads(text)


def _others(about: dict[str, Any], value: Any, whole: Any, samples: Any) -> Iterator[Any]:
    """Values of a field that are not its own, the likeliest first."""
    for each in about.get("anyOf", about.get("oneOf", [])):
        yield from _others(each, value, whole, samples)
    if "enum" in about:
        yield from (each for each in about["enum"] if each != value)
    reference = about.get("$ref", "").rpartition("/")[2]
    if reference:
        sample = samples.get(reference, {})
        yield from [sample, *({key: each} for key, each in sample.items()), {}] if value is None else []
    match about.get("type"):
        case "boolean":
            yield not value
        case "integer" | "number":
            known = value if isinstance(value, int | float) and not isinstance(value, bool) else 1
            yield from (1.25 * known, known + 1, known - 1, 2 * known, 0.5 * known, -known, *NUMBERS)
        case "string":
            yield from itertools.chain(WORDS, _names(whole))
        case "object":
            if isinstance(value, dict):
                yield from ({**value, "another": each} for each in ({}, 1))
        case "array":
            yield from _other_arrays(about, value, whole, samples)


def _other_arrays(about: dict[str, Any], value: Any, whole: Any, samples: Any) -> Iterator[Any]:
    items = about.get("prefixItems") or [about.get("items", {})]
    if isinstance(value, list) and value:
        for place, each in enumerate(value):
            inner = items[min(place, len(items) - 1)]
            for other in itertools.islice(_others(inner, each, whole, samples), 40):
                yield [*value[:place], other, *value[place + 1 :]]
        return
    count = about.get("minItems", 1)
    for other in itertools.islice(_others(items[0], None, whole, samples), 200):
        yield [other] * count
        yield [other, *([0.5] * (count - 1))] if count > 1 else [other]
    # Corners of a shape, and sides of a box.
    yield from ([[-3, -3], [3, -3], [0, 3]], [-30, -20, 30, 20])


def _names(whole: Any) -> Iterator[str]:
    """Names of things in a level, and of parts of them."""
    for listed in ("bodies", "particles", "terrain", "zones", "counters", "rules"):
        yield from (each["id"] for each in whole[listed])
    yield from whole["materials"]
    yield from (f"{each['id']}{sign}" for each in whole["bodies"] for sign in (".0", ".2", ":0"))


def _first(level: Level, path: Path, values: Iterator[Any]) -> Level | None:
    """The first value with which the level is one, and another."""
    before = level_data(level)
    for value in values:
        data = copy.deepcopy(json.loads(level.model_dump_json(by_alias=True)))
        holder = data
        for step in path[:-1]:
            holder = holder[step]
        if value is CALLED_OTHERWISE:
            data = _called_otherwise(data, holder[path[-1]])
        elif value is ABSENT:
            del holder[path[-1]]
        else:
            holder[path[-1]] = value
        try:
            edited = parse_level(json.dumps(data).encode(), "edited")
        except LevelError:
            continue
        if level_data(edited) != before:
            return edited
    return None
