"""Kernels that numba compiles, with what of its inner parts can be used in the version that is installed."""

import importlib
from types import CellType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np

from sandbox.physics import jit
from sandbox.physics.jit import bundles, interpreted, lending
from sandbox.physics.jit.needs import is_own, named, names_in

COMPILED = True


def _using_numba(name: str) -> Any:
    """One of the modules of this folder that use inner parts of numba; None where this numba has others."""
    try:
        return importlib.import_module(f"{__name__.rpartition('.')[0]}.{name}")
    except (ImportError, AttributeError):
        return None


_cache, _linking = map(_using_numba, ("cache", "linking"))

# Kernels hold no array longer than their call, so numba need not count who holds which: some 800 counts, 4 us, in a
# step of the direct solver. One that makes an array, or keeps one, does not compile with this.
_UNCOUNTED = {"_nrt": False}
_PART = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_OPTIONS: dict[str, dict[str, Any]] = {
    "kernel": _UNCOUNTED,
    "scalar_kernel": _UNCOUNTED,
    "inner_kernel": _UNCOUNTED,
    "inlined_kernel": _UNCOUNTED | {"inline": "always"},
}


def make(kernel: Any) -> Any:
    """A dispatcher for a kernel that Python calls, whose machine code is kept on disk.

    It costs little until it has to compile: what the kernel calls is made then.
    """
    options = {} if _linking is None else {"pipeline_class": _linking.EntryCompiler}
    dispatcher = _dispatcher(kernel, _OPTIONS[kernel.role] | options)
    if _cache is None or not _cache.keep(dispatcher, kernel.function, _name_parts):
        _name_parts(dispatcher)
    return dispatcher


# What stands for numba's own functions in the sources of kernels.
_INTRINSICS: dict[Any, Any] = {
    getattr(interpreted, name): getattr(lending, name)
    for name in (
        "contents", "put", "slots_in", "slot_rows_in", "floats_in", "float_rows_in", "float_tables_in", "flags_in",
        "int32s_in",
    )
}  # fmt: skip


def _part(kernel: Any) -> Any:
    """A dispatcher for a kernel that other kernels call, which links it into each of them."""
    if kernel.part is None:
        options = {} if _linking is None else {"pipeline_class": _linking.PartCompiler}
        kernel.part = _dispatcher(kernel, _PART | _OPTIONS[kernel.role] | options)
        if kernel.role != "inlined_kernel":
            lending.lend_to(kernel.part)
    return kernel.part


def lowered(kernel: Any, signature: tuple[Any, ...]) -> Any:
    """What numba gives for an entry that is lowered as a part is: neither optimised nor made machine code.

    Raises:
        RuntimeError: where this numba has other inner parts.
    """
    if _linking is None or not _linking.links_once():
        raise RuntimeError("this numba has other inner parts than the maker of libraries knows")
    options = _PART | _OPTIONS[kernel.role] | {"pipeline_class": _linking.PartCompiler}
    dispatcher = _dispatcher(kernel, options)
    _name_parts(dispatcher)
    dispatcher.compile(signature)
    return dispatcher.overloads[signature]


def _dispatcher(kernel: Any, options: dict[str, Any]) -> Any:
    # Determinism: never fastmath, never parallel. Kernels guard every divisor, so the error model decides nothing.
    dispatcher = numba.njit(error_model="numpy", **options)(_twin(kernel.function))
    dispatcher._kernel = kernel
    return dispatcher


def _twin(function: FunctionType) -> FunctionType:
    """A function for numba alone, with names of its own: `function` keeps those that the interpreter needs."""
    closure = tuple(CellType() for _ in function.__code__.co_freevars)
    twin = FunctionType(function.__code__, {}, function.__name__, function.__defaults__, closure)
    twin.__module__, twin.__qualname__, twin.__doc__ = function.__module__, function.__qualname__, function.__doc__
    return twin


def _name_parts(dispatcher: Any) -> None:
    """Give a kernel that numba is to compile, and all that it calls, what they find by name, as numba knows it."""
    waiting, seen = [dispatcher], set()
    while waiting:
        one = waiting.pop()
        if one in seen:
            continue
        seen.add(one)
        function, twin = one._kernel.function, one.py_func
        cells = dict(zip(function.__code__.co_freevars, twin.__closure__ or (), strict=True))
        for name, value in named(function):
            known = _known(value, function)
            if name in cells:
                cells[name].cell_contents = known
            else:
                twin.__globals__[name] = known
            held = vars(known).values() if isinstance(known, ModuleType) and known is not value else (known,)
            waiting += [part for part in held if getattr(part, "_kernel", None) is not None]


def _known(value: Any, function: FunctionType) -> Any:
    """What a name of the interpreter is to numba."""
    kernel = jit.kernel_of(value)
    if kernel is not None:
        return _part(kernel)
    if value is interpreted.unsigned or type(value) is interpreted.Unsigned:
        return np.uint64 if value is interpreted.unsigned else np.uint64(value)
    if type(value) is FunctionType and value in _INTRINSICS:
        return _INTRINSICS[value]
    if isinstance(value, ModuleType) and is_own(value):
        known = ModuleType(value.__name__)
        vars(known).update({name: _known(item, function) for name, item in names_in(value, function)})
        return known
    return value


def precompile(kernel: Any, arguments: tuple[Any, ...]) -> None:
    """Compile a kernel for such arguments, or load it."""
    kernel.ready().compile(types_of(arguments))


def types_of(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """The types for which a kernel is compiled that is called with such arguments, those of interpreted ones too."""
    return tuple(
        numba.typeof(bundles.bundle(argument.given) if isinstance(argument, interpreted.Bundle) else argument)
        for argument in arguments
    )


bundle, hold, items_of = bundles.bundle, bundles.hold, bundles.items_of
