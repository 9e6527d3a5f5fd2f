"""The only place that knows numba.

Kernels are compiled with a disk cache, uncached where none can be written, and interpreted where numba is missing or
does not work with this Python or numpy.
"""

import functools
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
if COMPILED:
    from sandbox.physics.jit import cache, linking

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
    dispatcher = _dispatcher(function, pipeline_class=linking.EntryCompiler, **options)
    dispatcher._cache = cache.KernelCache(dispatcher)
    return cast(Function, dispatcher)


def _part(function: Function, **options: Any) -> Function:
    unwrapped = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return cast(Function, _dispatcher(function, pipeline_class=linking.PartCompiler, **unwrapped, **options))


# Kernels hold no array longer than their call, so numba need not count who holds which: some 800 counts, 4 us, in a
# step of the direct solver. One that makes an array, or keeps one, does not compile with this.
_UNCOUNTED = {"_nrt": False}


def kernel(function: Function) -> Function:
    """Make `function` a kernel: scalars, contiguous arrays and named tuples of arrays in; same bits both ways."""
    return _entry(function, **_UNCOUNTED) if COMPILED else _interpreted(function)


def bundle_kernel(function: Function) -> Function:
    """Make `function` a kernel that takes bundles too."""
    return _entry(function) if COMPILED else _interpreted(function)


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


if COMPILED:
    from numba.core import cgutils
    from numba.core.runtime.context import NRTContext
    from numba.experimental import structref

    @structref.register
    class _BundleType(structref.types.StructRef):
        pass

    class _Bundle(structref.StructRefProxy):
        pass

    structref.define_proxy(_Bundle, _BundleType, ["items"])

    @_numba.extending.intrinsic
    def contents(typing_context: Any, bundle_type: Any) -> Any:
        """The items of a bundle, lent: a kernel that counts who holds them takes 25 ns for each array."""

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            holder = cgutils.create_struct_proxy(bundle_type)(context, builder, value=arguments[0])
            data_type = bundle_type.get_data_type()
            data = NRTContext(context, True).meminfo_data(builder, holder.meminfo)
            kind = context.data_model_manager[data_type].get_value_type()
            data = builder.bitcast(data, kind.as_pointer())
            return cgutils.create_struct_proxy(data_type)(context, builder, ref=data).items

        return bundle_type.field_dict["items"](bundle_type), generate

else:

    class _Bundle:  # type: ignore[no-redef]
        def __init__(self, items: tuple[Any, ...]) -> None:
            self.items = tuple(map(_viewed, items))

    def contents(bundle: Any) -> Any:
        return bundle.items


@bundle_kernel
def bundle(items: tuple[Any, ...]) -> Any:
    """One argument for kernels in place of many that stay: arrays and named tuples, there the bundle's `items`.

    Otherwise a kernel unwraps each array at every call: 60 of them take 8 us, as long as 80 links of a rope. The types
    of named tuples belong to this room, since the cache of kernels refers to them.
    """
    return _Bundle(items)
