"""Values of `extras`, a level maker's own data: a row each, and how a new one is typed."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.panel.field_info import FieldInfo, Kind
from sandbox.editor.panel.property import MIXED, Property, same
from sandbox.editor.panel.typed import read_number
from sandbox.level.format.level_error import shown
from sandbox.level.format.limits import TEXT_LIMIT

Values = Mapping[str, Any]
# Makes a document in which the extras are what the function makes of them.
ChangeExtras = Callable[[Document, Callable[[dict[str, Any]], dict[str, Any]]], Document]

HOW_TO_ADD = (
    "A name, = and a value: speed = 3 is a number, title = Cave a text, secret = yes is yes or no, "
    "path = 1, 2, 3 a list."
)
_WORDS = {"yes": True, "no": False, "true": True, "false": False}


def extras_properties(about: FieldInfo, values: Sequence[Values], change: ChangeExtras) -> list[Property]:
    """A row for what is in the extras of all of some things, and one by which more is added."""

    def add(document: Document, typed: str) -> Document:
        name, value = read_entry(typed)
        return change(document, lambda old: {**old, name: value})

    shared = [name for name in values[0] if all(name in each for each in values)]
    rows = [_row(name, same(each[name] for each in values), change) for name in shared]
    return [*rows, Property("extras", replace(about, title="Own data"), None, add)]


def _row(name: str, value: Any, change: ChangeExtras) -> Property:
    kind = _kind_of(value)
    about = FieldInfo(kind or "text", name, tooltip="Your own data; the program keeps it and does not use it.")

    def write(document: Document, new: Any) -> Document:
        return change(document, lambda old: {**old, name: _as_in_a_file(new)})

    def remove(document: Document) -> Document:
        return change(document, lambda old: {key: each for key, each in old.items() if key != name})

    text = value if kind is not None else json.dumps(value, ensure_ascii=False)
    return Property(f"extras.{name}", about, text, write if kind is not None else None, remove=remove)


def _kind_of(value: Any) -> Kind | None:
    """The kind of form field that a value gets; None where it is shown without being editable."""
    if value is MIXED:
        return "text"
    if isinstance(value, bool):
        return "yes_no"
    if isinstance(value, int | float):
        return "number"
    if isinstance(value, str):
        return "text"
    if isinstance(value, list | tuple):
        return "words" if value and all(isinstance(each, str) for each in value) else "list"
    return None


def read_entry(typed: str) -> tuple[str, Any]:
    """Name and value of a typed `name = value`. Raises EditError."""
    name, found, text = typed.partition("=")
    name, text = name.strip(), text.strip()
    if not found or not name:
        raise EditError(f"{shown(typed.strip()) if typed.strip() else 'nothing'} is not a name, = and a value")
    if len(name) > TEXT_LIMIT:
        raise EditError(f"the name has {len(name)} characters; at most {TEXT_LIMIT} are allowed")
    return name, _read_value(text)


def _read_value(text: str) -> Any:
    if text.casefold() in _WORDS:
        return _WORDS[text.casefold()]
    try:
        return _as_in_a_file(json.loads(text, parse_constant=_refuse))
    except (ValueError, RecursionError):
        pass
    parts = [part.strip() for part in text.split(",")]
    if len(parts) == 1 or text.startswith('"'):
        return text
    return [_part_of_a_list(part) for part in parts if part]


def _part_of_a_list(text: str) -> Any:
    try:
        return _as_in_a_file(read_number("", text))
    except EditError:
        return text


def _as_in_a_file(value: Any) -> Any:
    """A whole number without a point, and lists as JSON has them."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return [_as_in_a_file(each) for each in value] if isinstance(value, list | tuple) else value


def _refuse(name: str) -> None:
    raise ValueError(name)
