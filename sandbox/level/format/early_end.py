"""Describes a JSON text that ends too early: which lists and objects are still open."""

import json
import re

from sandbox.level.format.level_error import json_path

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"?|[{}\[\]:,]|[^\s{}\[\]:,"]+', re.DOTALL)
# What may follow the place of an error in a text that merely stops: part of a word or number.
_STUMP = re.compile(r"[\w.+-]*\s*", re.ASCII)


def early_end(text: str, error: json.JSONDecodeError) -> str | None:
    """Where a text ends too early, in words; None if it has another fault."""
    is_cut = error.msg.startswith("Unterminated string") or _STUMP.fullmatch(text, error.pos)
    path = _open_path(text) if is_cut else None
    if path is None:
        return None
    return f"the file ends inside {json_path(path)}" if path else "the file ends inside the level"


def _open_path(text: str) -> list[str | int] | None:
    """Keys and indices of the lists and objects that are open at the end of a text; None if there are none."""
    opened: list[list[str | int | None]] = []
    last = ""
    for found in _TOKEN.finditer(text):
        token = found[0]
        if token in "{[":
            opened.append([None if token == "{" else 0])
        elif token in "}]":
            if not opened:
                return None
            opened.pop()
            if opened and not isinstance(opened[-1][0], int):
                opened[-1][0] = None
        elif not opened:
            return None
        elif token == ":":
            opened[-1][0] = last.strip('"')
        elif token == ",":
            place = opened[-1][0]
            opened[-1][0] = place + 1 if isinstance(place, int) else None
        last = token
    places = [place for (place,) in opened]
    return [place for place in places if place is not None] if opened else None
