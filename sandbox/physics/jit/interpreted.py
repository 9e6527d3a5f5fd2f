"""Kernels that the interpreter runs: without numba, and until compiled ones are ready."""

import functools
from collections.abc import Callable
from typing import Any, cast

import numpy as np

COMPILED = False


class Unsigned(int):
    """An int that is to be an unsigned one in compiled kernels: constants of modules are known by it."""


unsigned: Any = Unsigned


class _Bundle:
    """What kernels get of a bundle, and what went into it."""

    def __init__(self, items: tuple[Any, ...]) -> None:
        self.given = items
        self.items = tuple(map(_viewed, items)) if not hasattr(items, "_make") else _viewed(items)


class _InterpreterFunction:
    """What only compiled kernels can call."""


def _viewed(item: Any) -> Any:
    if isinstance(item, np.ndarray):
        return memoryview(cast(Any, item))
    if isinstance(item, tuple) and hasattr(item, "_make"):
        return cast(Any, item)._make(map(_viewed, item))
    return item


def interpreted(function: Callable[..., Any], note: Callable[..., None] | None = None) -> Callable[..., Any]:
    """Run the kernel's own source on memory views, whose items are Python floats: the same IEEE doubles, 3x faster.

    note: is told the arguments of each call.
    """

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        if note is not None:
            note(*arguments)
        return function(*map(_viewed, arguments))

    return call


def make(role: str, function: Callable[..., Any], note: Callable[..., None]) -> Callable[..., Any]:
    """What modules hold of a kernel; parts of kernels get views already, and are left as they are."""
    return interpreted(function, note) if role in ("kernel", "waiting_kernel") else function


def bundle(items: tuple[Any, ...]) -> Any:
    """Arrays and named tuples as one argument, viewed once."""
    return _Bundle(items)


def contents(bundle: Any) -> Any:
    """The items of a bundle."""
    return bundle.items


def interpreter_function(name: str, result: str, *arguments: str) -> Any:
    """A place for a function that nobody calls here."""
    return _InterpreterFunction()
