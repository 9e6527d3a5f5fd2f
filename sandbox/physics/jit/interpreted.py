"""Kernels that the interpreter runs: where there is no library."""

import functools
import math
from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar, cast, get_type_hints

import numpy as np

from sandbox.physics.arrays import ArrayKind, layout_of
from sandbox.physics.jit.bundles import owner_of

COMPILED = False
Items = TypeVar("Items")


class LentTuple:
    """A named tuple that was lent: its items by name, which kernels may write others in place of."""

    def __init__(self, kind: Any, items: Iterable[Any]) -> None:
        self.__dict__.update(zip(kind._fields, items, strict=True))


class Bundle(Generic[Items]):
    """A bundle for interpreted kernels: their views, and the objects behind them."""

    def __init__(self, items: tuple[Any, ...]) -> None:
        self.given = items
        self.items = _lent(items)


def _lent(item: Any) -> Any:
    if not isinstance(item, tuple):
        return _viewed(item)
    items = map(_lent, item)
    return LentTuple(type(item), items) if hasattr(item, "_make") else tuple(items)


def _viewed(item: Any) -> Any:
    if isinstance(item, np.ndarray):
        return memoryview(cast(Any, item)) if item.dtype.fields is None else Bundle(owner_of(item).whole.item)
    if isinstance(item, tuple) and hasattr(item, "_make"):
        return cast(Any, item)._make(map(_viewed, item))
    return item


def interpreted(function: Callable[..., Any]) -> Callable[..., Any]:
    """Run the kernel's own source on memory views, whose items are Python floats: the same IEEE doubles, 3x faster."""

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        return function(*map(_viewed, arguments))

    return call


def make(kernel: Any) -> Callable[..., Any]:
    """The function that modules get for a kernel which Python calls; parts of kernels are left as they are."""
    made: Any = interpreted(kernel.function)
    made._kernel = kernel
    return cast(Callable[..., Any], made)


def bundle(items: tuple[Any, ...], like: Any = None) -> Any:
    """Arrays and named tuples as one argument, viewed once."""
    return Bundle(items)


def unpack(bundle: Bundle[Items]) -> Items:
    """The items of a bundle."""
    return bundle.items


def hold(bundle: Any, memory: Any) -> None:
    """Do nothing: the views of a bundle keep their arrays alive."""


def use_threads(count: int, worth: int) -> None:
    """Do nothing: loops are run in turn."""


def threads_started() -> int:
    """None: loops are run in turn."""
    return 0


def items_of(bundle: Any, path: tuple[str, ...] = ()) -> Any:
    """The items of a bundle as they are now."""
    items, given = bundle.items, bundle.given
    for name in path:
        items, given = getattr(items, name), getattr(given, name)
    return _returned(items, given)


def _returned(item: Any, given: Any) -> Any:
    if isinstance(given, tuple):
        parts = vars(item).values() if isinstance(item, LentTuple) else item
        returned = [_returned(part, other) for part, other in zip(parts, given, strict=True)]
        return cast(Any, given)._make(returned) if hasattr(given, "_make") else tuple(returned)
    return item.obj if isinstance(item, memoryview) and item.obj is given else np.asarray(item)


def parallel(items: int, work: int) -> range:
    """The numbers below `items`, in their order."""
    return range(items)


def set_field(place: Any, field: str, value: Any) -> None:
    """Set a field of a named tuple in a bundle to another array, or named tuple of arrays."""
    if isinstance(value, LentTuple):
        vars(vars(place)[field]).update(vars(value))
    else:
        setattr(place, field, _lent(value))


def _array_in(dtype: Any) -> Any:
    item = np.dtype(dtype).itemsize

    def array_in(memory: Any, first: int, *shape: int) -> Any:
        if min(shape) < 0:
            raise ValueError(f"an array has no {min(shape)} rows")
        count = math.prod(shape)
        words = -(-count * item // 8)
        # What finds no room is not touched, and need not lie there.
        lies = np.asarray(memory)[first : first + words] if memory[0] <= len(memory) else np.zeros(words, np.int64)
        return memoryview(lies.view(dtype)[:count].reshape(shape))

    return array_in


# Arrays in the memory of another, an int64 array, from its item `first` on: of so many rows, or rows and columns.
slots_in, slot_rows_in = _array_in(np.int64), _array_in(np.int64)
floats_in, float_rows_in, float_tables_in = _array_in(np.float64), _array_in(np.float64), _array_in(np.float64)
flags_in, int32s_in = _array_in(np.bool_), _array_in(np.int32)


class ArenaLayout:
    """In kernels: lays out a named tuple in an arena.

    kernels: what lays out an array there, by its kind: kernel(arena, *lengths).
    """

    def __init__(self, *kernels: Callable[..., Any]) -> None:
        hints = [get_type_hints(kernel, include_extras=True)["return"] for kernel in kernels]
        self.kernels: dict[ArrayKind, Callable[..., Any]] = {
            hint.__metadata__[0]: kernel for hint, kernel in zip(hints, kernels, strict=True)
        }

    def __call__(self, kind: type[Items], arena: Any, /, **given: Any) -> Items:
        """A named tuple of what is given by the names of its fields, and else of arrays that begin at 0.

        given: also the names in the lengths that stand beside those, and beside those of tuples in it.
        """
        items = []
        for name, layout in layout_of(cast(Any, kind)).items():
            if name in given:
                items.append(given[name])
            elif isinstance(layout, type):
                items.append(self(layout, arena, **given))
            elif layout is not None:
                items.append(self.kernels[layout[0]](arena, *_lengths(layout[1], given)))
        return kind(*items)


def _lengths(text: str, given: dict[str, Any]) -> tuple[int, ...]:
    return cast(tuple[int, ...], eval(_compiled(text), {}, given))


@functools.cache
def _compiled(text: str) -> Any:
    return compile(f"({text},)", "lengths", "eval")
