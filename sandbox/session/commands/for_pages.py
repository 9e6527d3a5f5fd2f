"""The commands as data for pages, which read records by it as `from_record` and `apply` do."""

from typing import Any

from sandbox.physics.commands.command_table import UNEQUAL
from sandbox.physics.softness.firmness import BUT_RIGID
from sandbox.session.commands.command import COMMAND_TYPES, Command, adapter
from sandbox.session.commands.faults import NO_COMMAND, NO_NAME, NO_SLOT, UNKNOWN, WORDS, digits

# Of a schema, what is checked; beside the kind and noun of what goes by name.
_LIMITS = ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum")
_CHECKED = ("type", "names", "noun", "maxItems", "enum", *_LIMITS)


def table_of(names: set[str]) -> dict[str, Any]:
    """The words of faults, and every command by its type: of those named its fields, else nothing."""
    words = WORDS | {"noCommand": NO_COMMAND, "unknown": UNKNOWN, "noName": NO_NAME, "noSlot": NO_SLOT}
    words |= {"butRigid": BUT_RIGID, "unequal": UNEQUAL}
    commands = {name: _entry(kind) if name in names else None for name, kind in COMMAND_TYPES.items()}
    return {"messages": words, "commands": commands}


def _entry(kind: type[Command]) -> dict[str, Any]:
    schema = adapter(kind).json_schema()
    fields = {name: _field(each) for name, each in schema["properties"].items()}
    for name in schema.get("required", ()):
        fields[name]["isRequired"] = True
    return {"fields": fields}


def _field(schema: dict[str, Any]) -> dict[str, Any]:
    """A field as JSON Schema has it, and whether it may be null."""
    choices = schema.get("anyOf", [schema])
    found = _checked(next(each for each in choices if each.get("type") != "null"))
    if schema.get("default") is not None:
        found["default"] = schema["default"]
    return found | {"isNullable": len(choices) > 1}


def _checked(schema: dict[str, Any]) -> dict[str, Any]:
    # Limits in the digits that messages have.
    found = {key: schema[key] for key in _CHECKED if key in schema}
    found |= {key: digits(schema[key]) for key in _LIMITS if key in schema}
    if "enum" in schema:
        *rest, last = map(repr, schema["enum"])
        found["expected"] = f"{', '.join(rest)} or {last}"
    if "items" in schema:
        found["items"] = _checked(schema["items"])
    if "prefixItems" in schema:
        found["prefixItems"] = [_checked(each) for each in schema["prefixItems"]]
    return found
