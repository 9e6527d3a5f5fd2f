"""Turns errors of the validation library into words for level makers."""

import types
from collections.abc import Callable, Iterator
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag

from sandbox.level.document.model import Level, keys_of
from sandbox.level.format.level_error import Fault, json_path, shown, suggestion
from sandbox.level.format.look import COLOUR_PATTERN, PALETTE
from sandbox.level.format.picture import NAME_PATTERN, NAMED
from sandbox.level.format.quantities import ARROW_KEYS, ID_PATTERN, KEY_PATTERN
from sandbox.level.kinds.bodies import KINDS

Location = tuple[Any, ...]

_KINDS = "use {} or {}".format(", ".join([*KINDS][:-1]), [*KINDS][-1])
_SHAPE_FORMS = 'a shape is {"box": [width, height]}, {"circle": radius} or {"polygon": [[x, y], ...]}'


def worded(errors: list[dict[str, Any]]) -> Iterator[Fault]:
    """The errors of the library as faults, in its order, without repetitions."""
    seen = set()
    for error in errors:
        if error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]:
            # The library counts the sound items alone, and has named the others already.
            continue
        fault = _fault(error)
        if fault not in seen:
            seen.add(fault)
            yield fault


def place(location: Location) -> list[Any]:
    """A location of the library without the names of alternatives that it inserts."""
    parts = list(location)
    if parts[:1] in (["bodies"], ["materials"]) and len(parts) > 2:
        del parts[2]
        if parts[0] == "bodies" and parts[2:3] == ["shape"] and len(parts) > 3:
            del parts[3]
    return [part for part in parts if part != "[key]"]


def _fault(error: dict[str, Any]) -> Fault:
    location, kind, value = error["loc"], error["type"], error["input"]
    parts, context = place(location), error.get("ctx", {})
    if kind == "missing":
        if isinstance(location[-1], int):
            items = next(filter(None, map(get_args, _declared(Level, location[:-1]))))
            nouns = "names" if location[0] == "welds" else "numbers"
            return json_path(parts[:-1]), f"needs {len(items)} {nouns}, has {len(value)}"
        return json_path(parts), "is missing; it has no default"
    if kind.startswith("union_tag") or (kind == "dict_type" and len(parts) == 2 and parts[0] == "bodies"):
        return _kind_fault(parts, kind, value)
    if kind == "extra_forbidden":
        keys = [key for model in _models(Level, location[:-1]) for key in keys_of(model)]
        known = suggestion(parts[-1], keys) or "; the keys here are " + ", ".join(keys)
        return json_path(parts), "unknown key" + known
    if kind in _WORDS:
        return json_path(parts), _WORDS[kind](value, context)
    if kind in _NOUNS:
        text = f"{shown(value)} is text, not" if isinstance(value, str) else f"{shown(value)} is not"
        return json_path(parts), f"{text} {_NOUNS[kind]}"
    return json_path(parts), f"{shown(value)} cannot be used here"


def _kind_fault(parts: list[Any], kind: str, value: Any) -> Fault:
    if parts[-1:] == ["shape"]:
        return json_path(parts), _SHAPE_FORMS
    if not isinstance(value, dict):
        return json_path(parts), f"{shown(value)} is not an object {{...}} that describes a body"
    if "type" not in value:
        return json_path([*parts, "type"]), f"is missing; {_KINDS}"
    return json_path([*parts, "type"]), f"{shown(value['type'])} is not a kind of body; {_KINDS}"


def _models(declared: Any, location: Location) -> Iterator[type[BaseModel]]:
    """The models that a type allows at a location inside it; several if nothing chooses between them."""
    return (each for each in _declared(declared, location) if isinstance(each, type) and issubclass(each, BaseModel))


def _declared(declared: Any, location: Location) -> Iterator[Any]:
    """The types that a type allows at a location inside it: models, lists, objects and others."""
    origin = get_origin(declared)
    if origin is Annotated:
        yield from _declared(get_args(declared)[0], location)
    elif origin in (Union, types.UnionType):
        choices = get_args(declared)
        chosen = [choice for choice in choices if location and _tag(choice) == location[0]]
        for choice in chosen or choices:
            yield from _declared(choice, location[1:] if chosen else location)
    elif not location:
        yield declared
    elif isinstance(declared, type) and issubclass(declared, BaseModel):
        if location[0] in declared.model_fields:
            yield from _declared(declared.model_fields[location[0]].annotation, location[1:])
    elif origin in (tuple, list, dict):
        # All items of a list or an object have the same declaration.
        yield from _declared(get_args(declared)[1 if origin is dict else 0], location[1:])


def _tag(choice: Any) -> str | None:
    """The name by which the library lists an alternative: its tag, or the `type` that a body gives."""
    if get_origin(choice) is Annotated:
        return next((extra.tag for extra in choice.__metadata__ if isinstance(extra, Tag)), None)
    return next((name for name, kind in KINDS.items() if kind is choice), None)


_NOUNS = {
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "tuple_type": "a list [...]",
    "dict_type": "an object {...}",
    "model_type": "an object {...}",
}


def _literal(value: Any, context: dict[str, Any]) -> str:
    expected = context["expected"].replace("'", '"')
    return f"{shown(value)} is not {expected}"


def _pattern(value: Any, context: dict[str, Any]) -> str:
    if context["pattern"] == ID_PATTERN:
        return f"{shown(value)} holds one of . : , or a control character, or begins with +; an id may not"
    if context["pattern"] == KEY_PATTERN:
        return f"{shown(value)} is no key; use a small letter, a digit, or one of {', '.join(ARROW_KEYS)}"
    if context["pattern"] == COLOUR_PATTERN:
        return f'{shown(value)} is no colour; use one of {", ".join(PALETTE)}, or "#RRGGBB"'
    if context["pattern"] == NAME_PATTERN:
        return f"{shown(value)} cannot be used here: {NAMED}"
    return f"{shown(value)} holds control characters; take them out"


_WORDS: dict[str, Callable[[Any, dict[str, Any]], str]] = {
    "less_than_equal": lambda value, context: f"{shown(value)} is above the limit {context['le']:.15g}",
    "greater_than_equal": lambda value, context: f"{shown(value)} is below the limit {context['ge']:.15g}",
    "greater_than": lambda value, context: f"{shown(value)} is not above {context['gt']:.15g}",
    "finite_number": lambda value, context: f"{shown(value)} is not a finite number",
    "too_long": lambda value, context: f"has {len(value)} items; at most {context['max_length']} are possible",
    "too_short": lambda value, context: f"has {len(value)} items; at least {context['min_length']} are needed",
    "string_too_long": lambda value, context: (
        f"has {len(value)} characters; at most {context['max_length']} are allowed"
    ),
    "string_too_short": lambda value, context: "is empty; at least one character is needed",
    "string_pattern_mismatch": _pattern,
    "literal_error": _literal,
    "value_error": lambda value, context: f"{shown(value)}: {context['error']}",
}
