"""Kernels that the interpreter runs: where there is neither a library nor numba."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from sandbox.physics.jit.bundles import owner_of

COMPILED = False


class Unsigned(int):
    """An int that is to be an unsigned one in compiled kernels: constants of modules are known by it."""


unsigned: Any = Unsigned


class Bundle:
    """A bundle: what kernels get, and the objects that it was made of."""

    def __init__(self, items: tuple[Any, ...], like: "Bundle | None" = None) -> None:
        self.given = items
        views = [
            like.items[k] if like is not None and item is like.given[k] else _viewed(item)
            for k, item in enumerate(items)
        ]
        self.items: Any = items._make(views) if hasattr(items, "_make") else tuple(views)


@dataclass(frozen=True)
class InterpreterFunction:
    """A function of Python's own C interface, which only compiled kernels can call; types by their numba names."""

    name: str
    result: str
    arguments: tuple[str, ...]


def _viewed(item: Any) -> Any:
    if isinstance(item, np.ndarray):
        return memoryview(cast(Any, item)) if item.dtype.fields is None else Bundle(owner_of(item).whole.item)
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


def make(kernel: Any) -> Callable[..., Any]:
    """What modules hold of a kernel that Python calls; parts of kernels get views already, and are left as they are."""
    made: Any = interpreted(kernel.function, kernel.note)
    made._kernel = kernel
    return cast(Callable[..., Any], made)


def precompile(kernel: Any, arguments: tuple[Any, ...]) -> None:
    """While calls are recorded: remember the types of such arguments."""
    kernel.note(*arguments)


def bundle(items: tuple[Any, ...], like: Any = None) -> Any:
    """Arrays and named tuples as one argument, viewed once; like: a bundle whose items some of these are."""
    return Bundle(items, like)


def contents(bundle: Any) -> Any:
    """The items of a bundle."""
    return bundle.items
