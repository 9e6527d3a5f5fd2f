"""Sums that are typed into number fields: + - * / and brackets, in plain numbers, with no names."""

import re

_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([-+*/()]))")


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
