"""Kernels that numba compiles, with what of its inner parts can be used in the version that is installed."""

import importlib
from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np

from sandbox.physics.jit import interpreted

COMPILED = True
unsigned: Any = np.uint64


def _using_numba(name: str) -> Any:
    """One of the modules of this folder that use inner parts of numba; None where this numba has others."""
    try:
        return importlib.import_module(f"{__name__.rpartition('.')[0]}.{name}")
    except (ImportError, AttributeError):
        return None


_cache, _lending, _linking = map(_using_numba, ("cache", "lending", "linking"))

# Kernels hold no array longer than their call, so numba need not count who holds which: some 800 counts, 4 us, in a
# step of the direct solver. One that makes an array, or keeps one, does not compile with this.
_UNCOUNTED = {"_nrt": False}
_OPTIONS: dict[str, dict[str, Any]] = {
    "kernel": _UNCOUNTED,
    "waiting_kernel": _UNCOUNTED | {"nogil": True},
    "scalar_kernel": {},
    "inner_kernel": _UNCOUNTED,
    "inlined_kernel": _UNCOUNTED | {"inline": "always"},
}


def make(role: str, function: Callable[..., Any], note: Callable[..., None] | None = None) -> Any:
    """A dispatcher for a kernel: of an entry, whose machine code is kept on disk, or of a part of entries.

    note: is told nothing; what a call is compiled for, the dispatcher knows.
    """
    # Determinism: never fastmath, never parallel. Kernels guard every divisor, so the error model decides nothing.
    options = {"error_model": "numpy", **_OPTIONS[role]}
    is_part = role in ("inner_kernel", "inlined_kernel")
    if is_part:
        options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    if _linking is not None:
        options["pipeline_class"] = _linking.PartCompiler if is_part else _linking.EntryCompiler
    dispatcher = numba.njit(**options)(function)
    if not is_part and _cache is not None:
        _cache.keep(dispatcher)
    if role == "inner_kernel" and _lending is not None:
        _lending.lend_to(dispatcher)
    return dispatcher


def bundle(items: tuple[Any, ...]) -> Any:
    """Arrays and named tuples as one argument; where numba's inner parts are unknown, as many as they are."""
    return items if _lending is None else _lending.bundle(items)


def _contents(bundle: Any) -> Any:
    return bundle


contents: Any = make("inner_kernel", _contents) if _lending is None else _lending.contents


def interpreter_function(name: str, result: str, *arguments: str) -> Any:
    """A function of Python's own C interface, given the numba names of its types."""
    # By name, so that a cached kernel finds it again in the next process; its address would not last.
    kinds = numba.types
    return kinds.ExternalFunction(name, getattr(kinds, result)(*(getattr(kinds, kind) for kind in arguments)))


def types_of(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """The types for which a kernel is compiled that is called with such arguments, those of interpreted ones too."""
    return tuple(
        numba.typeof(bundle(argument.given) if isinstance(argument, interpreted._Bundle) else argument)
        for argument in arguments
    )


def load_kept(dispatcher: Any) -> Iterator[Any]:
    """Load what is kept of a kernel, for one signature after the other."""
    kept: Any = getattr(dispatcher, "_cache", None)
    for signature in kept.signatures(dispatcher.targetctx) if hasattr(kept, "signatures") else ():
        dispatcher.compile(signature)
        yield signature
