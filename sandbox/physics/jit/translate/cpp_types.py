"""Definitions of kernels as their sources have them, and the types of what they compute with, as C++ writes them."""

import ast
import functools
import importlib
import inspect
import io
import tokenize
from dataclasses import dataclass
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from sandbox.physics.arrays import ArrayKind
from sandbox.physics.jit import Kernel, interpreted, kernel_of

# What an item of an array is in C++, by its dtype.
ITEMS = {
    "float64": "double",
    "float32": "float",
    "int64": "int64_t",
    "int32": "int32_t",
    "int8": "int8_t",
    "uint32": "uint32_t",
    "bool": "bool",
}
_UNSPOKEN = ("sandbox.",)


@dataclass(frozen=True)
class Scalar:
    """The type of a number or flag; rank: of two the wider one has the higher."""

    cpp: str
    rank: int


@dataclass(frozen=True)
class Array:
    """A contiguous array: the name of its dtype, and its dimensions."""

    dtype: str
    dimensions: int

    @property
    def cpp(self) -> str:
        """The array's type in C++."""
        return f"Array<{ITEMS[self.dtype]}, {self.dimensions}>"

    @property
    def item(self) -> Scalar:
        """Type of an item that is read: every integer is one of 64 bits."""
        return {"float64": FLOAT, "float32": FLOAT, "bool": FLAG}.get(self.dtype, INTEGER)


@dataclass(frozen=True)
class Struct:
    """A named tuple, or a class with such fields."""

    kind: type
    cpp: str
    fields: tuple[tuple[str, "Type"], ...]

    def field(self, name: str) -> "Type | None":
        """Type of a field; None: the tuple has no such field."""
        return dict(self.fields).get(name)


@dataclass(frozen=True)
class Several:
    """A tuple without names, which a kernel gives back."""

    items: tuple["Type", ...]

    @property
    def cpp(self) -> str:
        """The tuple's type in C++."""
        return f"Tuple{len(self.items)}<{', '.join(item.cpp for item in self.items)}>"


@dataclass(frozen=True)
class BundleType:
    """The words of a named tuple, or of a plain one, as one array."""

    items: "Type"

    @property
    def cpp(self) -> str:
        """The bundle's type in C++."""
        return f"Bundle<{self.items.cpp}>"


Type = Scalar | Array | Struct | Several | BundleType
FLAG = Scalar("bool", 0)
INTEGER = Scalar("int64_t", 1)
FLOAT = Scalar("double", 2)
NOTHING = Scalar("void", -1)
_SCALARS: dict[Any, Scalar] = {bool: FLAG, int: INTEGER, float: FLOAT, type(None): NOTHING, None: NOTHING}


class NoType(Exception):
    """An annotation says none of the types of kernels."""


class Types:
    """Types by their annotations; the structs that were met, each after those that lie in it."""

    def __init__(self) -> None:
        self.structs: dict[type, Struct] = {}

    def of(self, hint: Any) -> Type:
        """The type that an annotation says. Raises NoType."""
        if hint in _SCALARS:
            return _SCALARS[hint]
        for marker in get_args(hint):
            if isinstance(marker, ArrayKind):
                return Array(np.dtype(marker.dtype).name, marker.dimensions)
        if get_origin(hint) is interpreted.Bundle:
            return BundleType(self.of(*get_args(hint)))
        if get_origin(hint) is tuple:
            return Several(tuple(map(self.of, get_args(hint))))
        if isinstance(hint, type) and hasattr(hint, "_fields"):
            return self.struct(hint)
        raise NoType(str(hint))

    def struct(self, kind: type) -> Struct:
        """The struct of a class of named tuples. Raises NoType."""
        if kind not in self.structs:
            hints = get_type_hints(kind, include_extras=True)
            missing = [name for name in kind._fields if name not in hints]  # type: ignore[attr-defined]
            if missing:
                raise NoType(f"{kind.__name__}.{missing[0]}")
            fields = tuple((name, self.of(hints[name])) for name in kind._fields)  # type: ignore[attr-defined]
            taken = {struct.cpp for struct in self.structs.values()}
            name = kind.__name__.lstrip("_")
            if name in taken:
                name = f"{kind.__module__.rpartition('.')[2].title().replace('_', '')}{name}"
            self.structs[kind] = Struct(kind, name, fields)
        return self.structs[kind]


class Untranslatable(Exception):
    """Code outside the language of kernels; where, and why."""

    def __init__(self, module: str, line: int, reason: str) -> None:
        super().__init__(f"{module.replace('.', '/')}.py:{line}: {reason}")


@dataclass(frozen=True)
class Constant:
    """A number that a module gives a name, in the module where it does so."""

    module: str
    name: str
    value: bool | int | float


def joined(one: Type, other: Type) -> Type | None:
    """The type that holds both; None: none does."""
    if one == other:
        return one
    if isinstance(one, Scalar) and isinstance(other, Scalar) and min(one.rank, other.rank) >= 0:
        return max(one, other, key=lambda scalar: scalar.rank)
    return None


def fits(given: Type, wanted: Type) -> bool:
    """Whether a value of a type may stand where another type is needed: a number where a wider one is."""
    return given == wanted or joined(given, wanted) == wanted


@functools.cache
def _text(module: str) -> str:
    return inspect.getsource(importlib.import_module(module))


@functools.cache
def _tree(module: str) -> ast.Module:
    return ast.parse(_text(module))


@functools.cache
def comments(module: str) -> dict[int, tuple[bool, str]]:
    """The comments of a module by their lines: whether one has a line of its own, and what it says."""
    text = _text(module)
    lines = text.splitlines()
    found = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith("# fmt:"):
            row, column = token.start
            found[row] = (not lines[row - 1][:column].strip(), token.string.lstrip("# "))
    return found


def definition(kernel: Kernel) -> ast.FunctionDef:
    """The definition of a kernel."""
    function = kernel.function
    for node in _tree(function.__module__).body:
        if isinstance(node, ast.FunctionDef) and node.name == function.__name__:
            return node
    raise Untranslatable(
        function.__module__, function.__code__.co_firstlineno, "it stands not at the top of its module"
    )


@functools.cache
def _imports(module: str) -> dict[str, tuple[str, str]]:
    return {
        alias.asname or alias.name: (node.module or "", alias.name)
        for node in _tree(module).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def home(module: str, name: str) -> tuple[str, str]:
    """The module in which a name is given, and its name there."""
    while name in _imports(module) and _imports(module)[name][0].startswith(_UNSPOKEN):
        origin, name = _imports(module)[name]
        if not hasattr(importlib.import_module(origin), name):
            break
        module = origin
    return module, name


def meaning(module: str, name: str) -> Any:
    """The thing that a name is at the top of a module: a Constant, a Kernel, a class, another module, or None."""
    value = vars(importlib.import_module(module)).get(name)
    kernel = kernel_of(value)
    if kernel is not None:
        return kernel
    if isinstance(value, (bool, int, float)):
        return Constant(*home(module, name), _plain(value))
    return value


def _plain(value: Any) -> bool | int | float:
    return value if isinstance(value, (bool, float)) else int(value)
