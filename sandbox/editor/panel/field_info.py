"""fields_of(): what the models of the level format declare of each field, for people who edit it."""

import math
import re
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, get_args

from pydantic import BaseModel

from sandbox.editor.panel.typed import number_text
from sandbox.level.document.schema import described
from sandbox.level.format.limits import SAG_LIMIT
from sandbox.level.format.look import BALLS, LINES, PALETTE, SKINS
from sandbox.level.kinds.body_def import FirmnessDef

Kind = Literal[
    "number",
    "integer",
    "text",
    "yes_no",
    "choice",
    "flags",
    "point",
    "material",
    "list",
    "pairs",
    "outlines",
    "words",
    "form",
    "part",
    "key",
    "colour",
    "touches",
    "extras",
    "thing",
    "picture",
]

# What can be picked on the sheet in place of typing it: a mover is a body or a loose particle, a thing terrain too.
Pick = Literal["", "particle", "body", "box", "zone", "mover", "thing"]

_KEYS = ("key", "reverse_key")
# The unit of angles in a file, and what people read and type.
_RADIANS, DEGREES = "rad", "°"
# Fields that are shown as nothing else is.
_OWN_KINDS: dict[str, Kind] = {
    "material": "material", "shape": "form", "holes": "outlines", "extras": "extras", "skin": "choice",
    "follow": "thing", "picture": "picture", "always": "list", "eventually": "list",
    "line": "choice", "ball": "choice", "colour": "colour", "panel": "colour",
}  # fmt: skip
# What is chosen from a menu, which has no room to be empty and no need for words on names in a file.
_MENUS = ("choice", "colour", "material", "touches", "thing", "picture", "yes_no")
_OF_FILES = re.compile(r": a name of an? \w+\.")
# Names to choose from that the format takes as text, since one that it does not know counts as automatic.
_NAMES = {"skin": SKINS, "line": LINES, "ball": BALLS, "colour": tuple(PALETTE), "panel": tuple(PALETTE)}
_TITLES = {
    "a": "End a",
    "b": "End b",
    "id": "Name",
    "pin": "Pinned ends",
    "pinned": "Pinned",
    "cut": "Cut springs",
    "phase": "Phase, of a period",
    "drive": "Muscle",
    "area": "Keeps area",
    "collision_group": "In group",
    "collides": "Touches",
    "particle_radius": "Disc radius",
    "touches_mount": "Touches mount",
    "licence": "Licence",
    "warm_start": "Warm start",
    "restitution": "Bounce",
}


@dataclass(frozen=True)
class FieldInfo:
    """A field: kind, title, unit, limits (both included but where `above`), tooltip, choices, whether null is a value.

    empty: what null means, in words for an empty text field. A `point` is of two numbers; `flags` are any number of the
    choices, `pairs` lists of numbers in a list, `outlines` lists of corners in one; a `form` has a table of its own; a
    `part` is an object, of that model, or null. labels: words for the choices; tips: what is
    said of each, where they stand side by side; pick: what is clicked on the sheet for
    it. What has the unit DEGREES is read and typed in them; its value and limits are in radians.
    """

    kind: Kind
    title: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    above: bool = False
    tooltip: str = ""
    choices: tuple[str, ...] = ()
    optional: bool = False
    empty: str = ""
    model: type[BaseModel] | None = None
    labels: tuple[str, ...] = ()
    tips: tuple[str, ...] = ()
    pick: Pick = ""

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the most value of a number, infinite where it has no limit."""
        return -math.inf if self.low is None else self.low, math.inf if self.high is None else self.high


@cache
def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """A description of every field of a model, by name, in the model's order."""
    schema = model.model_json_schema(by_alias=False)
    # A model that holds others of its own kind is a definition of its own.
    fields = (schema if "properties" in schema else schema["$defs"][model.__name__])["properties"]
    return {name: _about(name, fields[name], _part(field.annotation)) for name, field in model.model_fields.items()}


def choice_of(title: str, names: tuple[str, ...], tip: str, labels: tuple[str, ...] = ()) -> FieldInfo:
    """A choice from a menu; labels: words for the names."""
    return FieldInfo("choice", title, choices=names, labels=labels, tooltip=tip)


def _part(annotation: Any) -> type[BaseModel] | None:
    """The model of a field that is one object or null."""
    kinds = [kind for kind in get_args(annotation) if kind is not type(None)]
    is_one = len(kinds) == 1 and isinstance(kinds[0], type) and issubclass(kinds[0], BaseModel)
    return kinds[0] if is_one else None


def title_of(field: str) -> str:
    """The title of a field in forms."""
    return _TITLES.get(field, field.replace("_", " ").capitalize())


def _about(name: str, schema: dict[str, Any], part: type[BaseModel] | None) -> FieldInfo:
    variants = [each for each in schema.get("anyOf", []) if each.get("type") != "null"]
    optional = any(each.get("type") == "null" for each in schema.get("anyOf", []))
    # Of several alternatives, each of which is a value, the table of choices says all.
    value = {**variants[0], **schema} if len(variants) == 1 else schema
    numbers = value.get("prefixItems", [value])[0]
    low = numbers.get("minimum", numbers.get("exclusiveMinimum"))
    kind = "part" if part is not None else _kind(name, value)
    unit = value.get("unit", value.get("items", {}).get("unit", ""))
    about = FieldInfo(
        kind=kind,
        title="Pinned particles" if name == "pinned" and kind == "list" else title_of(name),
        unit=DEGREES if unit == _RADIANS else unit,
        low=low,
        high=numbers.get("maximum"),
        above="exclusiveMinimum" in numbers,
        choices=_choices(name, kind, value),
        optional=optional,
        empty=schema.get("empty", ""),
        model=part,
    )
    is_menu = kind in _MENUS
    text = described(schema, "If nothing is chosen" if is_menu else "Empty").replace("`", "")
    if is_menu:
        text = _OF_FILES.sub(".", text)
    return FieldInfo(**{**about.__dict__, "tooltip": _tooltip(about, text)})


def _choices(name: str, kind: Kind, value: dict[str, Any]) -> tuple[str, ...]:
    if kind in ("choice", "colour") and name in _NAMES:
        return _NAMES[name]
    return tuple(map(str, value.get("enum", value.get("items", {}).get("enum", _constant(value)))))


def _constant(value: dict[str, Any]) -> tuple[str, ...]:
    constant = value.get("items", {}).get("const")
    return () if constant is None else (constant,)


def _kind(name: str, value: dict[str, Any]) -> Kind:
    items = value.get("items", {})
    if name in _KEYS:
        return "key"
    if name == "collides":
        return "touches"
    if name in _OWN_KINDS:
        return _OWN_KINDS[name]
    if "enum" in value:
        return "choice"
    if value.get("type") == "array":
        if len(value.get("prefixItems", ())) == 2:
            return "point"
        if "enum" in items or "const" in items:
            return "flags"
        return {"string": "words", "array": "pairs"}.get(items.get("type"), "list")  # type: ignore[return-value]
    kinds: dict[str, Kind] = {"number": "number", "integer": "integer", "boolean": "yes_no"}
    return kinds.get(value.get("type", ""), "text")


def _tooltip(about: FieldInfo, description: str) -> str:
    """The description, and the limits of a number."""
    is_limited = about.low is not None or about.high is not None
    # An angle's limits are so wide that nobody meets them.
    if about.kind not in ("number", "integer", "point") or not is_limited or about.unit == DEGREES:
        return description
    unit = f" {about.unit}" if about.unit else ""
    low = "" if about.low is None else f"{'above ' if about.above else ''}{number_text(about.low)}"
    if about.high is None:
        limits = f"At least {low}{unit}."
    else:
        limits = f"{low[:1].upper()}{low[1:]} to {number_text(about.high)}{unit}."
    return f"{description} {limits}"


# Of a body's firmness, as panels and tools show it: a sag in per cent.
PERCENT = 100.0
SAG = FieldInfo(
    "number", "Sag", "%", 0.0, PERCENT * SAG_LIMIT,
    tooltip="How far it sags under its own weight, in % of its height where it stands, or of its length where it is "
    f"held; 0 is rigid. 0 to {PERCENT * SAG_LIMIT:g} %.",
)  # fmt: skip
# Where each has a value of its own, nothing is left empty.
WOBBLE, RATIO = (
    replace(about, title=title, tooltip=about.tooltip.replace(f" Empty: {about.empty}.", ""), optional=False, empty="")
    for title, about in (("Wobble", fields_of(FirmnessDef)["hz"]), ("Damping ratio", fields_of(FirmnessDef)["ratio"]))
)
