"""format_reference(): the reference of the level format for level makers, generated from `reference.md` and the models.

`python -m sandbox.level.reference > docs/level-format.md` renews it.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sandbox.level.checks import STILL
from sandbox.level.document.model import MaterialDef
from sandbox.level.document.schema import TITLES, definitions
from sandbox.level.format import limits
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.quantities import Description
from sandbox.level.hints import CONTROLS, KEY
from sandbox.level.kinds.bodies import EXPANSIONS
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.reading.parse import parse_level
from sandbox.level.rules.player_limits import MEANINGS

# Prose of the page.
TEMPLATE = Path(__file__).with_suffix(".md").read_text(encoding="utf-8")
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
    """The reference as Markdown: the template, in which tables, lists and numbers stand for their names.

    `{{### Title}}` is the table of the model with that title.
    """
    whole = definitions()
    models = _models(whole)
    words = {name: _number(value) for name, value in vars(limits).items() if isinstance(value, int | float)}
    words |= {
        "FILE_LIMIT": str(limits.FILE_LIMIT // 1024 // 1024),
        "still": f"{STILL:g}",
        "plurals": ", ".join(each.plural for each in EXPANSIONS.values()),
        "kinds": "\n\n".join(
            _table(f"### {name.capitalize()}", models, whole)
            for kind, each in EXPANSIONS.items()
            for name in (kind, *each.alternatives)
        ),
        "generation": "\n".join(each.generation for each in EXPANSIONS.values() if each.generation),
        "controls": "\n".join(
            f"| `{{{name}}}` | {each.does} | "
            f"{' | '.join((word or '–').replace(KEY, 'its key') for word in each[-3:])} |"
            for name, each in CONTROLS.items()
        ),
        "hands": "\n".join(
            f"| `{deed}` | {', '.join(f'`{kind}`' for kind in meaning.commands)} |"
            for deed, meaning in MEANINGS.items()
        ),
        "mistakes": "\n".join(_mistakes()),
        "index": _index(models),
        "contents": "{{contents}}",
    }
    text = re.sub(r"\{\{(.+?)\}\}", lambda found: words.get(found[1]) or _table(found[1], models, whole), TEMPLATE)
    return text.replace("{{contents}}", "\n".join(_contents(text.partition("{{contents}}")[2])))


def examples() -> list[str]:
    """The levels that the page has as examples."""
    return [text for text in re.findall(r"```json\n(.*?)```", TEMPLATE, re.DOTALL) if '"format"' in text]


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


def _table(heading: str, models: dict[str, Model], whole: Model) -> str:
    model = models[heading.lstrip("# ")]
    required = model.get("required", [])
    rows = [_row(name, field, name in required, whole) for name, field in model["properties"].items()]
    return "\n".join([f"{heading}\n", f"{model['description']}\n", _HEAD, *rows])


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
    """The type of a field without its wrapping: its alternatives, its items."""
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
    """Limits in words; of: the counted things, in the plural."""
    if high is None:
        return "" if low is None else f"{_number(low)}{of if low != 1 else of[:-1]} or more"
    of = of if high != 1 else of[:-1]
    return f"up to {_number(high)}{of}" if low is None else f"{_number(low)} to {_number(high)}{of}"


def _number(value: float) -> str:
    """A number for people: 1,000,000 and not 1e+06, but 1e+15."""
    return f"{value:,.0f}" if value == int(value) and abs(value) < 1e10 else f"{value:g}"


def _without(field: Field) -> str:
    """Words for a field that a file leaves out: what null means, the default, or words for an empty one."""
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


def _mistakes() -> Iterator[str]:
    example = examples()[0]
    for right, wrong in _MISTAKES:
        try:
            parse_level(example.replace(right, wrong, 1).encode(), "levels/x.json")
        except LevelError as error:
            yield from (f"- `{wrong}`", "", "  ```text", *(f"  {fault}" for fault in error.faults), "  ```")


def _index(models: dict[str, Model]) -> str:
    """Every field, by name, with the tables that explain it."""
    tables: dict[str, list[str]] = {}
    for title, model in models.items():
        for name in model["properties"]:
            tables.setdefault(name, []).append(title)
    return "\n".join(f"- `{name}`: {', '.join(map(_link, titles))}" for name, titles in sorted(tables.items()))


if __name__ == "__main__":
    print(format_reference(), end="")
