"""The kinds of arrays that kernels take, and named tuples of empty ones."""

import functools
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Flags = NDArray[np.bool_]
Int32s = NDArray[np.int32]
# Of two dimensions, and of three.
FloatRows = Annotated[NDArray[np.float64], 2]
SlotRows = Annotated[NDArray[np.int64], 2]
FloatTables = Annotated[NDArray[np.float64], 3]

Arrays = TypeVar("Arrays")


def with_empty(kind: type[Arrays], **given: Any) -> Arrays:
    """A named tuple of arrays without items, of the kinds that its class says, but for what is given."""
    hints = get_type_hints(kind, include_extras=True)
    made: Any = kind(*(given[name] if name in given else _empty(hint) for name, hint in hints.items()))
    return made


@functools.cache
def empty(kind: type[Arrays]) -> Arrays:
    """A named tuple of arrays without items, of the kinds that its class says: one and the same."""
    return with_empty(kind)


def _empty(hint: Any) -> Any:
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return empty(hint)
    dimensions = 1
    if get_origin(hint) is Annotated:
        hint, dimensions = get_args(hint)
    dtype = get_args(get_args(hint)[1])[0]
    return np.zeros((0,) * dimensions, dtype)
