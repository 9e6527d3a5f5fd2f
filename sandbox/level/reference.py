"""format_reference(): the reference of the level format for level makers, generated from the models.

`python -m sandbox.level.reference > docs/level-format.md` renews it.
"""

import json
import re
from collections.abc import Iterable, Iterator
from typing import Any

from sandbox.level import reference_prose as prose
from sandbox.level.document.model import MaterialDef
from sandbox.level.document.schema import TITLES, definitions
from sandbox.level.format import limits
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.quantities import Description
from sandbox.level.kinds.bodies import EXPANSIONS
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.reading.parse import parse_level

# Each is one mistake in the example of the page, which shows what the program says to it.
_MISTAKES = [
    ('"stiffness": 1.0', '"stiffness": 1.3'),
    ('"stiffness": 1.0', '"stifness": 1.0'),
    ('"segments": 20', '"segments": true'),
    ('"segments": 20', '"segments": 1000000000000'),
    ('"b": "deck.31"', '"b": "dek.31"'),
    ('"b": "deck.31"', '"b": "deck"'),
    ('"height": 0.5', '"height": 0.5, "cut": [101]'),
    ('"mass": 20', '"mass": -20'),
    ('"mass": 20', '"mass": 20, "mass": 30'),
    ('"mass": 20,', '"mass": 20'),
]
NOTHING = "–"
_HEAD = "| field | type | unit | limits | if left out | meaning |\n|---|---|---|---|---|---|"
# Fields that several tables share, which a table of their own explains: its title, and the model that has them.
_SHARED: dict[str, type[Description]] = {"Every material": MaterialDef, "Every body": BodyDef}
_WORDS = {"integer": "whole number", "string": "text", "boolean": "true or false"}

Field = dict[str, Any]
Model = dict[str, Any]


def format_reference() -> str:
    """The reference as Markdown."""
    whole = definitions()
    body = "\n".join(_sections(_models(whole), whole))
    contents = "\n".join(_contents(body))
    return f"# Level format, version {limits.VERSION}\n\n{prose.INTRO}\n## Contents\n\n{contents}\n\n{body}"


def _models(whole: Model) -> dict[str, Model]:
    """Models by the titles of their tables; a field that a table of shared fields explains is only there."""
    found = {"Level": whole, **{title: whole["$defs"][name] for name, title in TITLES.items()}}
    materials = ["Material", "Hooke material"]
    kinds = [kind.capitalize() for kind in EXPANSIONS]
    for (title, base), users in zip(_SHARED.items(), (materials, kinds), strict=True):
        first = found[users[0]]["properties"]
        shared = {name: first[name] for name in base.model_fields}
        if base is BodyDef:
            kind = {"enum": [*EXPANSIONS]}
            shared["type"] = {**{key: value for key, value in shared["type"].items() if key != "const"}, **kind}
        required = [name for name in shared if name in found[users[0]].get("required", ())]
        found[title] = {"description": base.__doc__, "properties": shared, "required": required}
        for user in users:
            own = {
                name: field for name, field in found[user]["properties"].items() if not _is_shared(field, name, shared)
            }
            found[user] = {**found[user], "properties": own}
    return found


def _is_shared(field: Field, name: str, shared: dict[str, Field]) -> bool:
    return name in shared and (name == "type" or field == shared[name])


def _sections(models: dict[str, Model], whole: Model) -> Iterator[str]:
    """The sections of the page, in its order."""

    def table(title: str, level: int = 3) -> str:
        return _table(title, models[title], whole, level)

    yield from (prose.A_FILE, prose.TABLES, table("Level", 2), prose.HINTS, table("Settings", 2), "## Materials\n")
    yield from map(table, ("Every material", "Material", "Hooke material"))
    yield "## Contacts, walls and terrain\n"
    yield from map(table, ("Contacts", "Walls", "Terrain"))
    yield "## Zones and water\n"
    yield from (*map(table, ("Zone", "Water")), prose.WATER)
    yield from (prose.BODIES, table("Every body"))
    yield from (table(name.capitalize()) for kind, each in EXPANSIONS.items() for name in (kind, *each.alternatives))
    yield from map(table, ("Firmness", "Bending"))
    yield "## Loose particles and springs\n"
    yield from map(table, ("Loose particle", "Loose spring"))
    yield "## Actuators\n"
    yield from (*map(table, ("Muscle", "Hydraulic", "Motor")), prose.ACTUATORS)
    yield from (
        prose.RULES,
        *map(table, ("Rule", "Question", "Action", "Stars", "Counter")),
        prose.HANDS,
        *map(table, ("Hands", "Budget")),
    )
    yield from (prose.CHECKS, table("Acceptance check"), table("Key that is held"), prose.METRICS)
    yield from (prose.LOOKS, *map(table, ("Level look", "Body look", "Particle look", "Zone look")))
    yield from (prose.NAMES, prose.COLLISIONS, prose.AREAS, prose.FIRMNESS, prose.LIMITS, _faults(), _index(models))


def _table(title: str, model: Model, whole: Model, level: int) -> str:
    required = model.get("required", [])
    rows = [_row(name, field, name in required, whole) for name, field in model["properties"].items()]
    parts = [f"{'#' * level} {title}\n", f"{model['description']}\n", _HEAD, *rows, ""]
    return "\n".join(parts)


def _row(name: str, field: Field, is_required: bool, whole: Model) -> str:
    """The line of a field; null is explained where it is not what leaving the field out means."""
    meaning = field["description"]
    if "empty" in field and not is_required and field["default"] is not None:
        meaning += f" `null`: {field['empty']}."
    unit, limit = _unit(field) or NOTHING, _limits(field) or NOTHING
    without = "**required**" if is_required else _without(field)
    return f"| `{name}` | {_type(field, whole)} | {unit} | {limit} | {without} | {meaning} |"


def _type(field: Field, whole: Model) -> str:
    """The type of a field in words, without null."""
    if "discriminator" in field and set(field["discriminator"].get("mapping", ())) == set(EXPANSIONS):
        return "[body](#bodies)"
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if names := field.get("enum") or field.get("examples"):
        return ", ".join(f"`{json.dumps(value)}`" for value in names)
    choices = [each for each in field.get("anyOf") or field.get("oneOf") or () if each.get("type") != "null"]
    if choices:
        return " or ".join(_type(choice, whole) for choice in choices)
    if "$ref" in field:
        return _link(whole["$defs"][field["$ref"].rsplit("/", 1)[1]]["title"])
    if "prefixItems" in field:
        return "[" + ", ".join(_type(item, whole) for item in field["prefixItems"]) + "]"
    if field["type"] == "array":
        return f"list of {_type(field['items'], whole)}"
    if "patternProperties" in field:
        return "object of " + " or ".join(_type(item, whole) for item in field["patternProperties"].values())
    name: str = field["type"]
    return _WORDS.get(name, name)


def _link(title: str) -> str:
    return f"[{title.lower().replace('hooke', 'Hooke')}](#{anchor(title)})"


def _inner(field: Field) -> list[Field]:
    """What a field is made of: its alternatives, its items."""
    items = field.get("items")
    return [*field.get("anyOf", ()), *field.get("prefixItems", ())[:1], *([items] if isinstance(items, dict) else [])]


def _unit(field: Field) -> str:
    if "unit" in field:
        return str(field["unit"])
    return next((unit for unit in map(_unit, _inner(field)) if unit), "")


def _limits(field: Field) -> str:
    """Counts of items, and limits of a number or of a text's length; empty where there are none."""
    counts = ""
    if "prefixItems" not in field:
        counts = _span(field.get("minItems"), field.get("maxItems", field.get("maxProperties")), " items")
    if "exclusiveMinimum" in field:
        own = f"above {_number(field['exclusiveMinimum'])}, up to {_number(field['maximum'])}"
    elif field.get("type") == "string" and "enum" not in field and "examples" not in field:
        own = _span(field.get("minLength"), field.get("maxLength"), " characters")
    else:
        own = _span(field.get("minimum"), field.get("maximum"))
    inner = own or next((text for text in map(_limits, _inner(field)) if text), "")
    return f"{counts}; each {inner}" if counts and inner else counts or inner


def _span(low: float | None, high: float | None, of: str = "") -> str:
    """Limits in words; of: what is counted, in the plural."""
    if high is None:
        return "" if low is None else f"{_number(low)}{of if low != 1 else of[:-1]} or more"
    of = of if high != 1 else of[:-1]
    return f"up to {_number(high)}{of}" if low is None else f"{_number(low)} to {_number(high)}{of}"


def _number(value: float) -> str:
    """A number for people: 1,000,000 and not 1e+06, but 1e+15."""
    return f"{value:,.0f}" if value == int(value) and abs(value) < 1e10 else f"{value:g}"


def _without(field: Field) -> str:
    """What holds when a file leaves a field out: what null means, a value, or words for an empty one."""
    value = field["default"]
    if value is None:
        return str(field["empty"])
    if value in ([], {}):
        return "none"
    if value == "":
        return "no text"
    if isinstance(value, dict):
        return "the defaults below"
    return f"`{json.dumps(_whole(value))}`"


def _whole(value: Any) -> Any:
    """A default as a person writes it: 1, not 1.0."""
    if isinstance(value, list):
        return [_whole(each) for each in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


def anchor(title: str) -> str:
    """The name by which a link finds a heading."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def _contents(text: str) -> Iterator[str]:
    """The table of contents: a line for each section, with its tables after it."""
    lines: list[str] = []
    for level, title in re.findall(r"^(##+) (.*)$", text, re.MULTILINE):
        entry = f"[{title}](#{anchor(title)})"
        if level == "##":
            lines.append(f"- {entry}")
        else:
            lines[-1] += f"{': ' if ': [' not in lines[-1] else ', '}{entry}"
    return iter(lines)


def _faults() -> str:
    lines = [prose.FAULTS]
    for right, wrong in _MISTAKES:
        try:
            parse_level(prose.EXAMPLE.replace(right, wrong, 1).encode(), "levels/x.json")
        except LevelError as error:
            lines += [f"- `{wrong}`", "", "  ```text", *(f"  {fault}" for fault in error.faults), "  ```"]
    return "\n".join([*lines, ""])


def _index(models: dict[str, Model]) -> str:
    """Every field, by name, with the tables that explain it."""
    tables: dict[str, list[str]] = {}
    for title, model in models.items():
        for name in model["properties"]:
            tables.setdefault(name, []).append(title)
    lines = [f"- `{name}`: {_links(titles)}" for name, titles in sorted(tables.items())]
    return "\n".join(["## Every field, by name\n", *lines, ""])


def _links(titles: Iterable[str]) -> str:
    return ", ".join(map(_link, titles))


if __name__ == "__main__":
    print(format_reference(), end="")
