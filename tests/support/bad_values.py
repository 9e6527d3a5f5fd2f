"""Sixty-five values that an argument may be given by mistake, and what comes of each in its place."""

import inspect
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

BAD: tuple[Any, ...] = (
    math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, 2e18, -1, -7, -1.0, 1.5, 10**6, 2**31, 2**53, 2**62, 2**63,
    -(2**63), 2**64, 10**30, 10**400, -(10**400), 1j, complex(math.nan, 0.0), "7", "", "x", "\ud800", "nan", b"7", None,
    True, False, [], [[]], [1, [2]], [None], ["a"], [math.nan], [math.inf, 0.0], [10**6], [-1], [2**63], [10**400],
    [1.5], [True], [1j], (), (0.0,), (0.0, 1.0, 2.0), (math.nan, 0.0), ("0", "1"), {}, {"a": 1}, {0}, range(3),
    range(0, 9, 4), range(10**6, 10**6 + 2), slice(None), np.array(5), np.array(math.nan), np.zeros(3),
    np.zeros((2, 2)), np.zeros((0, 2)), np.array(["a"]), object(),
)  # fmt: skip
assert len(BAD) == 65
# What is raised for a value that makes no sense.
RAISED = (IndexError, ValueError, KeyError, TypeError)
Act = Callable[[Any], Any]


def public_methods(kind: type) -> dict[str, inspect.Signature]:
    """The public methods of a class that take arguments, with their signatures."""
    found = {name: inspect.signature(method) for name, method in inspect.getmembers(kind, inspect.isfunction)}
    return {name: each for name, each in found.items() if name[0] != "_" and len(each.parameters) > 1}


def bad_calls(method: str, signature: inspect.Signature, right: Mapping[str, Any]) -> Iterator[tuple[str, Any, Act]]:
    """Calls of a method with right values by argument, but for one: its name, what is in its place, and the call."""
    several = {each.name for each in signature.parameters.values() if each.kind is each.VAR_KEYWORD}
    for argument in dict.fromkeys((*signature.parameters, *right)):
        for value in BAD if argument != "self" and argument not in several else ():
            yield argument, value, lambda target, given={**right, argument: value}: called(target, method, given)


def called(target: Any, method: str, given: Mapping[str, Any]) -> Any:
    """Call a method with arguments by name, those that go by place too."""
    left, placed = dict(given), []
    for each in inspect.signature(getattr(type(target), method)).parameters.values():
        if each.kind in (each.POSITIONAL_ONLY, each.VAR_POSITIONAL) and each.name in left:
            placed.append(left.pop(each.name))
    return getattr(target, method)(*placed, **left)
