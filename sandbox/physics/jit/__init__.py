"""The only place that knows numba.

Kernels are compiled with a disk cache, uncached where none can be written, and interpreted where numba is missing or
does not work with this Python or numpy.
"""

import functools
import importlib
import os
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])


def _import_numba() -> Any:
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return None
    try:
        import numba
    except ImportError:  # also what an installed numba raises that is too old for this numpy
        return None
    return numba


_numba = _import_numba()
COMPILED = _numba is not None


def _using_numba(name: str) -> Any:
    """One of the modules of this folder that use inner parts of numba; None where this numba has others."""
    if not COMPILED:
        return None
    try:
        return importlib.import_module(f"{__name__}.{name}")
    except (ImportError, AttributeError):
        return None


_cache, _lending, _linking = map(_using_numba, ("cache", "lending", "linking"))

# Turns an index that is never negative into one that loops are vectorised for: of a signed one numba first asks whether
# it counts from the end. Never mix the two in one sum: that makes a float.
unsigned: Any = np.uint64 if COMPILED else int


def interpreter_function(name: str, result: str, *arguments: str) -> Any:
    """A function of Python's own C interface for compiled kernels, given the numba names of its types."""
    # By name, so that a cached kernel finds it again in the next process; its address would not last.
    kinds = _numba.types
    return kinds.ExternalFunction(name, getattr(kinds, result)(*(getattr(kinds, kind) for kind in arguments)))


def _viewed(item: Any) -> Any:
    if isinstance(item, np.ndarray):
        return memoryview(cast(Any, item))
    if isinstance(item, tuple) and hasattr(item, "_make"):
        return cast(Any, item)._make(map(_viewed, item))
    return item


def _interpreted(function: Function) -> Function:
    """Run the kernel's own source on memory views, whose items are Python floats: the same IEEE doubles, 3x faster."""

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        return function(*map(_viewed, arguments))

    return cast(Function, call)


def _dispatcher(function: Function, **options: Any) -> Any:
    # Determinism: never fastmath, never parallel. Kernels guard every divisor, so the error model decides nothing.
    return _numba.njit(error_model="numpy", **options)(function)


def _entry(function: Function, **options: Any) -> Function:
    if _linking is not None:
        options["pipeline_class"] = _linking.EntryCompiler
    dispatcher = _dispatcher(function, **options)
    if _cache is not None:
        _cache.keep(dispatcher)
    return cast(Function, dispatcher)


def _part(function: Function, **options: Any) -> Function:
    if _linking is not None:
        options["pipeline_class"] = _linking.PartCompiler
    dispatcher = _dispatcher(function, no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)
    if _lending is not None and "inline" not in options:
        _lending.lend_to(dispatcher)
    return cast(Function, dispatcher)


# Kernels hold no array longer than their call, so numba need not count who holds which: some 800 counts, 4 us, in a
# step of the direct solver. One that makes an array, or keeps one, does not compile with this.
_UNCOUNTED = {"_nrt": False}


def kernel(function: Function) -> Function:
    """Make `function` a kernel: scalars, contiguous arrays, named tuples of arrays, bundles in; same bits both ways."""
    return _entry(function, **_UNCOUNTED) if COMPILED else _interpreted(function)


def inner_kernel(function: Function) -> Function:
    """Make `function` a part of kernels, which alone may call it: compiled sooner, with no entry for Python."""
    return _part(function, **_UNCOUNTED) if COMPILED else function


def inlined_kernel(function: Function) -> Function:
    """Make `function` a part of kernels that is written into them: no call, which copies every array's shape."""
    return _part(function, inline="always", **_UNCOUNTED) if COMPILED else function


def scalar_kernel(function: Function) -> Function:
    """Make `function` a kernel that takes and gives scalars alone, to be called from other kernels."""
    return _entry(function) if COMPILED else function


def waiting_kernel(function: Function) -> Function:
    """Make `function` a kernel for a thread of its own: others run meanwhile, and may be waited for."""
    return _entry(function, nogil=True, **_UNCOUNTED) if COMPILED else _interpreted(function)


def bundle(items: tuple[Any, ...]) -> Any:
    """One argument for kernels in place of many that stay: arrays, and named tuples of them, there its `contents`.

    Otherwise a kernel unwraps each array at every call: 60 of them take 8 us, as long as 80 links of a rope. The bundle
    holds what it was made of.

    Raises:
        TypeError: for what is neither array nor tuple, and for arrays that are not contiguous.
    """
    if _lending is not None:
        return _lending.bundle(items)
    return items if COMPILED else _viewed(items)


def _contents(bundle: Any) -> Any:
    return bundle


# In kernels: the items of a bundle, as they were given to it.
contents: Any = _lending.contents if _lending is not None else inner_kernel(_contents)
