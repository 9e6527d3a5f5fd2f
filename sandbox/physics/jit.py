"""The only place that knows numba: compiled with a disk cache, uncached where none can be written, interpreted without it."""

import functools
import importlib.util
import os
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])


def _compiling() -> bool:
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return False
    return importlib.util.find_spec("numba") is not None


COMPILED = _compiling()


def _interpreted(function: Function) -> Function:
    """Run the kernel's own source on memory views, whose items are Python floats: the same IEEE doubles, 3x faster."""

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        return function(*[memoryview(item) if isinstance(item, np.ndarray) else item for item in arguments])

    return call  # type: ignore[return-value]


def _compiled(function: Function) -> Function:
    from numba import njit

    # Contract (determinism): never fastmath, never parallel; a zero divisor gives inf as in numpy, but kernels guard it.
    try:
        return njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # no folder can hold the cache
        return njit(error_model="numpy")(function)


def kernel(function: Function) -> Function:
    """Make `function` a kernel: scalars and C-contiguous arrays in, arrays changed in place, same bits compiled or not."""
    return _compiled(function) if COMPILED else _interpreted(function)


def scalar_kernel(function: Function) -> Function:
    """Make `function` a kernel that takes and gives scalars alone, to be called from other kernels."""
    return _compiled(function) if COMPILED else function
