"""The input of a kernel's machine code: its instructions and constants, and those of all kernels that it calls.

Neither the place of a file nor its docstrings, comments and other functions are among it, so none of them throws a
compiled kernel away; whatever numba reads is, so none is ever used after a change.
"""

import functools
import hashlib
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from sandbox.physics.jit import kernel_of

# Files of this folder that no machine code follows from.
_ASIDE = ("__init__.py", "cache.py", "interpreted.py", "library.py", "needs.py", "sources.py")


@functools.cache
def _own_sources() -> bytes:
    digest = hashlib.blake2b()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        if file.name not in _ASIDE:
            digest.update(file.read_bytes())
    return digest.digest()


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _plain(value: Any) -> str:
    if isinstance(value, CodeType):
        return "code"
    if isinstance(value, frozenset):
        return repr(sorted(map(_plain, value)))
    if isinstance(value, tuple):
        return repr(list(map(_plain, value)))
    if isinstance(value, np.ndarray):
        return f"{value.dtype.str}{value.shape}{hashlib.blake2b(value.tobytes()).hexdigest()}"
    return f"{type(value).__name__} {value!r}"


def class_text(kind: type) -> str:
    """A class by its name and, of a named tuple, its fields."""
    return f"{kind.__module__}.{kind.__qualname__}{getattr(kind, '_fields', '')}"


def _text(code: CodeType, documentation: str | None) -> str:
    constants = [_plain(None if constant == documentation else constant) for constant in code.co_consts]
    shape = (code.co_argcount, code.co_kwonlyargcount, code.co_flags, code.co_varnames, code.co_freevars)
    return repr((code.co_code, code.co_exceptiontable, code.co_names, shape, constants))


def is_own(module: ModuleType) -> bool:
    """Whether a module is one of this package."""
    return module.__name__.partition(".")[0] == __name__.partition(".")[0]


def named(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The names that a function reads outside itself. Builtins follow from the version of Python."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    yield from ((name, cell.cell_contents) for name, cell in cells)
    for code in _codes(function.__code__):
        for name in code.co_names:
            if name in function.__globals__:
                yield name, function.__globals__[name]


def names_in(module: ModuleType, function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The names of a module that a function may read."""
    for code in _codes(function.__code__):
        yield from ((name, getattr(module, name)) for name in code.co_names if hasattr(module, name))


def _read(function: Any) -> tuple[str, list[Any]]:
    """What one kernel says itself, and the functions that it names."""
    kernel = kernel_of(function)
    lines = [f"{function.__module__}.{function.__qualname__}", _plain(function.__defaults__)]
    lines.append("" if kernel is None else kernel.role)
    lines += [_text(code, function.__doc__) for code in _codes(function.__code__)]
    others = []
    found = list(named(function))
    for _, value in list(found):
        if isinstance(value, ModuleType) and is_own(value):
            found += names_in(value, function)
    for name, value in found:
        kernel = kernel_of(value)
        one = value if kernel is None else kernel.function
        if isinstance(one, FunctionType):
            others.append(one)
            lines.append(f"{name} = {one.__module__}.{one.__qualname__}")
        elif isinstance(value, ModuleType):
            lines.append(f"{name} = {value.__name__}")
        elif isinstance(value, type):
            lines.append(f"{name} = {class_text(value)}")
        else:
            lines.append(f"{name} = {_plain(value)}")
    return "\n".join(lines), others


def digest_of_needs(function: Any) -> str:
    """A digest of all that the machine code of one kernel follows from, but for versions and the types of arguments.

    Computed when it is asked for, from the values that names have then, as compiling does.
    """
    texts: dict[Any, str] = {}
    open_ones = [function]
    while open_ones:
        one = open_ones.pop()
        if one not in texts:
            texts[one], others = _read(one)
            open_ones += others
    digest = hashlib.blake2b(_own_sources(), digest_size=8)
    for text in sorted(texts.values()):
        digest.update(text.encode())
    return digest.hexdigest()
