"""Stands between Python and the kernels that it calls."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from sandbox.physics import jit

# What is called in place of a kernel: with the kernel, what runs it, and the arguments of the call.
InPlace = Callable[[jit.Kernel, Callable[..., Any], tuple[Any, ...]], Any]


@contextmanager
def in_place_of(kernels: Callable[[], list[jit.Kernel]], call: InPlace) -> Iterator[Callable[[], None]]:
    """While this lasts, Python calls `call` in place of kernels that modules hold by their names.

    It gives what is to be called now and then, for kernels and modules that are there only later.
    """
    replaced: list[tuple[Any, str, Any]] = []

    def replace() -> None:
        for kernel in kernels():
            name, run = kernel.function.__name__, kernel.ready()
            for holder in [module for module in sys.modules.values() if getattr(module, name, None) is run]:
                replaced.append((holder, name, run))
                setattr(holder, name, partial(lambda one, run, *given: call(one, run, given), kernel, run))

    try:
        replace()
        yield replace
    finally:
        for holder, name, run in replaced:
            setattr(holder, name, run)


@contextmanager
def counted_calls() -> Iterator[list[str]]:
    """The names of kernels that were called before, each time that Python calls one while this lasts."""
    calls: list[str] = []

    def count(kernel: jit.Kernel, run: Callable[..., Any], given: tuple[Any, ...]) -> Any:
        calls.append(kernel.function.__name__)
        return run(*given)

    with in_place_of(lambda: [one for one in jit.entries() if not isinstance(one.held, jit.Entry)], count):
        yield calls
