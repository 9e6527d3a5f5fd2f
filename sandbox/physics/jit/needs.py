"""What the machine code of a kernel follows from: its instructions and constants, and those of all that it calls.

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

# Files of this folder that no machine code follows from.
_ASIDE = ("__init__.py", "cache.py", "interpreted.py", "needs.py")


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


def _named(function: FunctionType) -> Iterator[tuple[str, Any]]:
    # What a function finds by name outside itself. Builtins follow from the version of Python.
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    yield from ((name, cell.cell_contents) for name, cell in cells)
    package = __name__.partition(".")[0]
    for code in _codes(function.__code__):
        for name in code.co_names:
            if name not in function.__globals__:
                continue
            value = function.__globals__[name]
            yield name, value
            if isinstance(value, ModuleType) and value.__name__.partition(".")[0] == package:
                yield from ((other, getattr(value, other)) for other in code.co_names if hasattr(value, other))


def _read(held: Any) -> tuple[str, list[Any]]:
    """What one kernel says itself, and the kernels that it names."""
    function = getattr(held, "py_func", held)
    lines = [f"{function.__module__}.{function.__qualname__}", _plain(function.__defaults__)]
    lines.append(repr(sorted(getattr(held, "targetoptions", {}).items())))
    lines += [_text(code, function.__doc__) for code in _codes(function.__code__)]
    others = []
    for name, value in _named(function):
        if isinstance(getattr(value, "py_func", value), FunctionType):
            others.append(value)
            described = getattr(value, "py_func", value)
            lines.append(f"{name} = {described.__module__}.{described.__qualname__}")
        elif isinstance(value, ModuleType):
            lines.append(f"{name} = {value.__name__}")
        elif isinstance(value, type):
            lines.append(f"{name} = {class_text(value)}")
        else:
            lines.append(f"{name} = {_plain(value)}")
    return "\n".join(lines), others


def digest_of_needs(kernel: Any) -> str:
    """A digest of all that the machine code of one kernel follows from, but for versions and the types of arguments.

    Computed when it is asked for, from the values that names have then, as compiling does.
    """
    texts: dict[int, str] = {}
    open_ones = [kernel]
    while open_ones:
        one = open_ones.pop()
        if id(one) not in texts:
            texts[id(one)], others = _read(one)
            open_ones += others
    digest = hashlib.blake2b(_own_sources(), digest_size=8)
    for text in sorted(texts.values()):
        digest.update(text.encode())
    return digest.hexdigest()
