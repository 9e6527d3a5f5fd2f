"""The kinds of arrays that kernels take, and named tuples of empty ones."""

import functools
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ArrayKind:
    """The kind of an array in a named tuple. It stands beside numpy's alias, whose inside differs between versions."""

    dtype: type[np.generic]
    dimensions: int = 1

    def empty(self) -> NDArray[Any]:
        """An array of this kind without items."""
        return np.zeros((0,) * self.dimensions, self.dtype)


Floats = Annotated[NDArray[np.float64], ArrayKind(np.float64)]
Slots = Annotated[NDArray[np.int64], ArrayKind(np.int64)]
Flags = Annotated[NDArray[np.bool_], ArrayKind(np.bool_)]
Int8s = Annotated[NDArray[np.int8], ArrayKind(np.int8)]
Int32s = Annotated[NDArray[np.int32], ArrayKind(np.int32)]
FloatRows = Annotated[NDArray[np.float64], ArrayKind(np.float64, 2)]
SlotRows = Annotated[NDArray[np.int64], ArrayKind(np.int64, 2)]
FloatTables = Annotated[NDArray[np.float64], ArrayKind(np.float64, 3)]

Arrays = TypeVar("Arrays")
# Of a field: the class of named tuples that lies in it; or what array it is, and the lengths that stand beside it, as
# text, such as "contacts, 2": sums and products of numbers and names.
FieldLayout = type | tuple[ArrayKind, str]


@functools.cache
def layout_of(kind: type) -> dict[str, FieldLayout | None]:
    """What is known of the fields of a named tuple; None: neither."""
    hints = get_type_hints(kind, include_extras=True)
    return {name: _layout_of(hint) for name, hint in hints.items()}


def _layout_of(hint: Any) -> FieldLayout | None:
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return hint
    markers = get_args(hint)[1:]
    kinds = [marker for marker in markers if isinstance(marker, ArrayKind)]
    lengths = [marker for marker in markers if isinstance(marker, str)]
    return (kinds[0], lengths[0]) if kinds and lengths else None


def with_empty(kind: type[Arrays], **arrays: Any) -> Arrays:
    """A named tuple of these arrays, the others empty, of the kinds that its class declares.

    Raises TypeError where a field is neither given, nor has an ArrayKind, nor is such a tuple.
    """
    hints = get_type_hints(kind, include_extras=True)
    made: Any = kind(
        *(arrays[name] if name in arrays else _empty(hint, f"{kind.__name__}.{name}") for name, hint in hints.items())
    )
    return made


@functools.cache
def empty(kind: type[Arrays]) -> Arrays:
    """A named tuple of arrays without items, of the kinds that its class says: one and the same."""
    return with_empty(kind)


def _empty(hint: Any, place: str) -> Any:
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return empty(hint)
    for marker in get_args(hint):
        if isinstance(marker, ArrayKind):
            return marker.empty()
    raise TypeError(f"{place}: has no ArrayKind")
