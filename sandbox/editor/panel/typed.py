"""Typed values: values as text that a person can change, and back; a fault is one line."""

import json
import math
import re
from collections.abc import Sequence
from typing import Any, NoReturn

from sandbox.editor.document import EditError
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import significant

# Digits that a number is shown with where they say all of it.
DIGITS = 9
# Digits that a sum is taken with: 0.1+0.2 is 0.3.
SUM_DIGITS = 15
# What differs by less than this share is one number, as 0.30000000000000004 and 0.3 are.
DUST = 1e-14
# What is typed for all groups, and for none.
EVERYTHING, NOTHING = "everything", "nothing"
_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([-+*/()]))")


def number_text(value: float) -> str:
    """A number as short as it can be without becoming another one, but for the dust of arithmetic: 0.3, 1e+100, ∞."""
    if isinstance(value, int):
        return str(value)
    if math.isinf(value):
        return "\u221e" if value > 0.0 else "-\u221e"
    text = f"{value:.{DIGITS}g}"
    return text if math.isclose(float(text), value, rel_tol=DUST) else repr(value)


def exact_text(value: float) -> str:
    """A number as short as it can be without becoming another one; of lists, all of which are read when one changes."""
    text = number_text(value)
    return text if float(text) == value else repr(value)


def stepped(value: float, steps: int, low: float | None, high: float | None, *, whole: bool = False) -> float:
    """A number that many steps up or down, within its limits: whole ones by 1, others by a tenth of their first digit.

    Near 0 steps are no smaller than a hundredth, or than a thousandth of the way between the limits.
    """
    least, most = -math.inf if low is None else low, math.inf if high is None else high
    if whole:
        return int(min(max(value + steps, least), most))
    smallest = min(0.01, (most - least) / 1000.0)
    step = max(10.0 ** (math.floor(math.log10(abs(value))) - 1), smallest) if value else smallest
    return min(max(significant(round(value / step) * step + steps * step, DIGITS), least), most)


def list_text(values: Sequence[Any]) -> str:
    """A list as in a file without its outer brackets; words are set apart by commas alone where that can be undone."""
    if values and all(isinstance(value, str) for value in values):
        is_plain = all(word and word == word.strip() and not set(word) & {",", '"'} for word in values)
        return ", ".join(values) if is_plain else json.dumps(list(values), ensure_ascii=False)[1:-1]
    return ", ".join(_entry(value) for value in values)


def _entry(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_entry(part) for part in value) + "]"
    return exact_text(value)


def line_text(text: str) -> str:
    r"""A text on one line: its line breaks are \n, its tabs \t, its backslashes \\."""
    return text.replace("\\", "\\\\").replace("\n", "\\n").replace("\t", "\\t")


def read_line(text: str) -> str:
    """The text that `line_text` has made a line of; a backslash before anything else is one."""
    result, letters = [], iter(text)
    for letter in letters:
        if letter != "\\":
            result.append(letter)
            continue
        following = next(letters, "")
        result.append({"n": "\n", "t": "\t", "\\": "\\"}.get(following, "\\" + following))
    return "".join(result)


def read_number(title: str, text: str) -> float:
    """A finite number, or a sum such as 2*3 or 1+0.5; a comma counts as a point. Raises EditError."""
    try:
        value = float(text.strip().replace(",", ".").replace("_", " "))
    except ValueError:
        try:
            value = significant(value_of(text), SUM_DIGITS)
        except NoSum:
            _refuse(title, text, "a number")
    if not math.isfinite(value):
        _refuse(title, text, "a finite number")
    return value


def read_integer(title: str, text: str) -> int:
    """A whole number. Raises EditError."""
    value = read_number(title, text)
    if value != int(value):
        _refuse(title, text, "a whole number")
    return int(value)


def read_list(title: str, text: str) -> list[Any]:
    """A list of numbers, with or without brackets around. Raises EditError."""
    values = _read_json(title, text, "a list such as 0, 4, 5")
    return values[0] if len(values) == 1 and isinstance(values[0], list) else values


def read_pairs(title: str, text: str) -> list[Any]:
    """A list of lists of numbers, with or without brackets around the whole. Raises EditError."""
    values = _read_json(title, text, "a list such as [0, 1], [2, 3]")
    is_whole = len(values) == 1 and isinstance(values[0], list) and all(isinstance(part, list) for part in values[0])
    return values[0] if is_whole else values


def read_outlines(title: str, text: str) -> list[Any]:
    """A list of outlines, each a list of corners, with or without brackets around the whole. Raises EditError."""
    values = _read_json(title, text, "a list of outlines such as [[0, 0], [1, 0], [0, 1]]")
    # In what stands for the whole, brackets and all, a corner is one list deeper.
    inner = values
    for _ in range(3):
        if not inner or not isinstance(inner[0], list):
            return [] if values == [[]] else values
        inner = inner[0]
    return values[0] if len(values) == 1 else values


def _read_json(title: str, text: str, kind: str) -> list[Any]:
    try:
        values: list[Any] = json.loads(f"[{text}]", parse_constant=_refuse_constant)
    except (ValueError, RecursionError):
        _refuse(title, text, kind)
    return values


def read_words(title: str, text: str) -> list[str]:
    """Words set apart by commas; in quotes, as in a file, where they hold commas or quotes. Raises EditError."""
    if not text.lstrip().startswith('"'):
        return [word.strip() for word in text.split(",") if word.strip()]
    try:
        words = json.loads(f"[{text}]")
    except (ValueError, RecursionError):
        _refuse(title, text, 'a list such as rope, bridge or "rope", "bridge"')
    if not all(isinstance(word, str) for word in words):
        _refuse(title, text, "a list of words")
    return list(words)


def touched_text(collides: bool | Sequence[str]) -> str:
    """The things that an object touches, in words: everything, nothing, or groups."""
    if isinstance(collides, bool):
        return EVERYTHING if collides else NOTHING
    return list_text(collides) if collides else NOTHING


def read_touched(title: str, text: str) -> bool | list[str]:
    """The pairs that a text of `touched_text` lists. Raises EditError."""
    words = read_words(title, text)
    if text.strip().casefold() in (EVERYTHING, NOTHING, ""):
        return text.strip().casefold() == EVERYTHING
    return words


def _refuse(title: str, text: str, kind: str) -> NoReturn:
    raise EditError(f"{title}: {shown(text.strip()) if text.strip() else 'nothing'} is not {kind}") from None


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(name)


class NoSum(ValueError):
    """A text that is no sum, or one without a value."""


def value_of(text: str) -> float:
    """The value of a sum; a comma counts as a point. Raises NoSum."""
    tokens, at = [], 0
    text = text.replace(",", ".").rstrip()
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            raise NoSum
        tokens.append(found[1] or found[2])
        at = found.end()
    try:
        value, rest = _sum(tokens)
    except (IndexError, RecursionError, ZeroDivisionError, OverflowError):
        raise NoSum from None
    if rest:
        raise NoSum
    return value


def _sum(tokens: list[str]) -> tuple[float, list[str]]:
    value, rest = _product(tokens)
    while rest and rest[0] in "+-":
        sign = rest[0]
        term, rest = _product(rest[1:])
        value = value + term if sign == "+" else value - term
    return value, rest


def _product(tokens: list[str]) -> tuple[float, list[str]]:
    value, rest = _signed(tokens)
    while rest and rest[0] in "*/":
        sign = rest[0]
        factor, rest = _signed(rest[1:])
        value = value * factor if sign == "*" else value / factor
    return value, rest


def _signed(tokens: list[str]) -> tuple[float, list[str]]:
    first, rest = tokens[0], tokens[1:]
    if first in "+-":
        value, rest = _signed(rest)
        return (value if first == "+" else -value), rest
    if first == "(":
        value, rest = _sum(rest)
        if rest[0] != ")":
            raise NoSum
        return value, rest[1:]
    if first in "*/)":
        raise NoSum
    return float(first), rest
