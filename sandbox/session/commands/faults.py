"""Words for what is wrong with a command, the same on the desktop and in pages, which are given them with the table."""

import re
from collections.abc import Collection
from typing import Any

from pydantic import ValidationError

from sandbox.level.format.level_error import shown


class CommandError(ValueError):
    """A command that cannot be carried out; its text is one line for a person, of a definition one line per fault."""

    @property
    def faults(self) -> list[str]:
        """The lines, one for each fault."""
        return str(self).splitlines()


# By kinds of faults: the library's names of them, and for which of its errors they stand.
WORDS = {
    "missing": "is missing",
    "unexpected": "there is no such field",
    "name": "must be a name in quotes",
    "integer": "must be a valid integer",
    "number": "must be a valid number",
    "finite": "must be a finite number",
    "boolean": "must be true or false",
    "text": "must be text in quotes",
    "array": "must be a list",
    "long": "must be a list of at most {}",
    "minimum": "must be greater than or equal to {}",
    "exclusiveMinimum": "must be greater than {}",
    "choice": "must be {}",
    "maximum": "must be less than or equal to {}",
    "exclusiveMaximum": "must be less than {}",
}
NO_COMMAND = "a command is an object with its type in quotes"
UNKNOWN = "unknown command {}; there are {}"
NO_NAME = "a {} goes by its name in quotes"
NO_SLOT = "there is no {} {}"
_WORDS_OF = {
    "missing": ("missing", ""),
    "unexpected_keyword_argument": ("unexpected", ""),
    "int_type": ("integer", ""),
    "int_from_float": ("integer", ""),
    "float_type": ("number", ""),
    "finite_number": ("finite", ""),
    "bool_type": ("boolean", ""),
    "string_type": ("text", ""),
    "tuple_type": ("array", ""),
    "too_long": ("long", "max_length"),
    "greater_than_equal": ("minimum", "ge"),
    "greater_than": ("exclusiveMinimum", "gt"),
    "less_than_equal": ("maximum", "le"),
    "less_than": ("exclusiveMaximum", "lt"),
    "literal_error": ("choice", "expected"),
}
_PLAIN = re.compile(r"\w+", re.ASCII)


def plain_fault(error: ValidationError, named: Collection[str] = ()) -> str:
    """The first fault of a validation as `field: fault`, in one line. named: fields that go by name."""
    fault = error.errors(include_url=False, include_input=False)[0]
    parts = [str(part) for part in fault["loc"]]
    place = ".".join(part if _PLAIN.fullmatch(part) else shown(part) for part in parts)[:80]
    text = fault["msg"].replace("Input should be", "must be").splitlines()[0]
    if fault["type"] in _WORDS_OF:
        kind, limit = _WORDS_OF[fault["type"]]
        if kind == "integer" and fault["loc"][0] in named:
            kind = "name"
        text = WORDS[kind].format(limit and digits(fault["ctx"][limit]))
    return f"{place}: {text}" if place else text


def digits(limit: Any) -> str:
    """A number as JavaScript writes it, where that is without an exponent; else as Python does. Words stay."""
    if isinstance(limit, str):
        return limit
    return str(int(limit)) if abs(limit) < 1e21 and limit == int(limit) else repr(limit)
