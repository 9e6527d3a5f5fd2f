"""The types of what kernels compute with, by their annotations, and as C++ writes them."""

from dataclasses import dataclass
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from sandbox.physics.arrays import ArrayKind
from sandbox.physics.jit import interpreted

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


@dataclass(frozen=True)
class Scalar:
    """A number or a flag; rank: what of two is the wider one."""

    cpp: str
    rank: int


@dataclass(frozen=True)
class Array:
    """A contiguous array: the name of its dtype, and its dimensions."""

    dtype: str
    dimensions: int

    @property
    def cpp(self) -> str:
        """As C++ writes it."""
        return f"Array<{ITEMS[self.dtype]}, {self.dimensions}>"

    @property
    def item(self) -> Scalar:
        """What reading one gives: every integer is one of 64 bits."""
        return {"float64": FLOAT, "float32": FLOAT, "bool": FLAG}.get(self.dtype, INTEGER)


@dataclass(frozen=True)
class Struct:
    """A named tuple, or what has such fields, by its class."""

    kind: type
    cpp: str
    fields: tuple[tuple[str, "Type"], ...]

    def field(self, name: str) -> "Type | None":
        """The type of a field; None: there is none of this name."""
        return dict(self.fields).get(name)


@dataclass(frozen=True)
class Several:
    """A tuple without names, which a kernel gives back."""

    items: tuple["Type", ...]

    @property
    def cpp(self) -> str:
        """As C++ writes it."""
        return f"Tuple{len(self.items)}<{', '.join(item.cpp for item in self.items)}>"


@dataclass(frozen=True)
class BundleType:
    """The words of a named tuple, or of a plain one, as one array."""

    items: "Type"

    @property
    def cpp(self) -> str:
        """As C++ writes it."""
        return f"Bundle<{self.items.cpp}>"


Type = Scalar | Array | Struct | Several | BundleType

FLAG = Scalar("bool", 0)
INTEGER = Scalar("int64_t", 1)
FLOAT = Scalar("double", 2)
NOTHING = Scalar("void", -1)
_SCALARS: dict[Any, Scalar] = {bool: FLAG, int: INTEGER, float: FLOAT, type(None): NOTHING, None: NOTHING}


def joined(one: Type, other: Type) -> Type | None:
    """The type that holds both; None: none does."""
    if one == other:
        return one
    if isinstance(one, Scalar) and isinstance(other, Scalar) and min(one.rank, other.rank) >= 0:
        return max(one, other, key=lambda scalar: scalar.rank)
    return None


def fits(given: Type, wanted: Type) -> bool:
    """Whether what is given may stand where another type is wanted: a number where a wider one is."""
    return given == wanted or joined(given, wanted) == wanted


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
