"""Arguments: what programs hand to a world, checked before anything is written.

Every fault raises IndexError, for a slot that is not there, or ValueError; its text names argument, value and range.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.marks import LONGEST_RAMP
from sandbox.physics.state import FAMILIES, Column, Family, Range, StateArrays

# Words for the rows of families, where a slot of one is asked for.
PARTICLES, SPRINGS, CONSTRAINTS = "particles", "springs", "constraints"
HANDS, PARTS, KEYS = "hands", "driven parts", "keys that rules ask for"
# Types of what is given; a tuple is asked in a quarter of a union's time.
_WHOLE, _NUMBERS, _LISTS = (int, np.integer), (float, int, np.integer, np.floating), (tuple, list, np.ndarray, Sequence)
# Slots beyond this are beyond any array; kernels take no more digits.
FARTHEST = 2**62
ANY = Range(-math.inf, math.inf)


def shown(value: Any) -> str:
    """A value as Python writes it, on one line and cut short."""
    return " ".join(repr(value.item() if isinstance(value, np.generic) else value).split())[:60]


def no_slot(argument: str, value: Any, rows: str, count: int) -> IndexError:
    """The error for a slot that does not exist."""
    there = f"a world with {rows} 0 to {count - 1}" if count else f"a world without {rows}"
    return IndexError(f"{argument} {shown(value)}: {there}")


def whole(argument: str, value: Any) -> int:
    """A whole number; neither true nor false, nor a float."""
    if isinstance(value, bool) or not isinstance(value, _WHOLE):
        raise ValueError(f"{argument} {shown(value)}: a whole number is needed")
    return int(value)


def ticks(argument: str, value: Any) -> int:
    """A number of ticks, none or more."""
    found = whole(argument, value)
    if not 0 <= found <= LONGEST_RAMP:
        raise ValueError(f"{argument} {found}: 0 to {LONGEST_RAMP} ticks are needed")
    return found


def slot(argument: str, value: Any, rows: str, count: int) -> int:
    """A slot from 0 to count - 1."""
    found = whole(argument, value)
    if not 0 <= found < count:
        raise no_slot(argument, value, rows, count)
    return found


def whole_numbers(argument: str, values: Any) -> Slots:
    """A list of whole numbers (k,); what is farther than any slot is FARTHEST."""
    array = np.asarray(listed(argument, values))
    if array.dtype.kind == "i" and (array is values or bool not in map(type, values)):
        return array.astype(np.int64)
    return np.array([max(-1, min(whole(argument, each), FARTHEST)) for each in values], np.int64)


def slots(argument: str, values: Any, rows: str, count: int) -> Slots:
    """A list of slots (k,) from 0 to count - 1."""
    found = whole_numbers(argument, values)
    outside = np.flatnonzero((found < 0) | (found >= count))
    if len(outside):
        raise no_slot(argument, list(values)[outside[0]], rows, count)
    return found


def slot_rows(argument: str, values: Any, rows: str, count: int) -> Slots:
    """Rows of slots (k, n) from 0 to count - 1."""
    array = _plain(argument, values)
    if array.ndim != 2:
        raise ValueError(f"{argument} {shown(values)}: rows of slots are needed")
    return slots(argument, array.reshape(-1), rows, count).reshape(array.shape)


def check_rows(argument: str, rows: Any, count: int) -> None:
    """Whether rows of an array, by one slot, a list, a slice or flags, are there."""
    if isinstance(rows, slice):
        return
    array = _plain(argument, rows)
    if array.dtype.kind == "b" and array.shape == (count,):
        return
    slots(argument, array.reshape(-1), "rows", count)


def check_materials(material: NDArray[np.integer], count: int) -> None:
    """Refuse materials that a world does not have; -1 stands for none. Raises IndexError."""
    if material.size and not -1 <= material.min() <= material.max() < count:
        raise no_slot("material", int(material.max()), "materials", count)


def active_particles(world: StateArrays, argument: str, values: Any) -> Slots:
    """Slots of particles that are in use (k,)."""
    found = slots(argument, values, PARTICLES, len(world.particle_active))
    unused = found[~world.particle_active[found]]
    if len(unused):
        raise IndexError(f"{argument} {unused[0]}: it is not in use")
    return found


def number(argument: str, value: Any, least: float = -math.inf, most: float = math.inf) -> float:
    """A finite number from least to most."""
    if isinstance(value, bool) or not isinstance(value, _NUMBERS):
        raise ValueError(f"{argument} {shown(value)}: a number is needed")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not least <= found <= most or not math.isfinite(found):
        raise ValueError(f"{argument} {shown(value)}: {_range_of(least, most)} is needed")
    return found


def point(argument: str, value: Any) -> tuple[float, float]:
    """A pair of finite numbers."""
    if isinstance(value, str) or not isinstance(value, _LISTS) or len(value) != 2:
        raise ValueError(f"{argument} {shown(value)}: a pair of numbers is needed")
    return number(argument, value[0]), number(argument, value[1])


def floats(
    argument: str, values: ArrayLike, shape: tuple[int, ...], least: float = -math.inf, most: float = math.inf
) -> Floats:
    """Finite numbers from least to most, spread over a shape."""
    array = _numbers(argument, values)
    is_bad = ~(np.isfinite(array) & (array >= least) & (array <= most))
    if is_bad.any():
        raise ValueError(f"{argument} {shown(float(array[is_bad].flat[0]))}: {_range_of(least, most)} is needed")
    return _spread(argument, array.astype(np.float64), shape)


def floats_or(argument: str, values: ArrayLike, usual: Floats, least: float = -math.inf) -> Floats:
    """Finite numbers of at least `least`, with `usual` in place of each NaN."""
    array = _numbers(argument, values)
    is_left_out = np.isnan(array)
    found = floats(argument, np.where(is_left_out, max(least, 0.0), array), usual.shape, least)
    return np.where(is_left_out, usual, found)


def flags(argument: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """True or false, spread over a shape."""
    array = _plain(argument, values)
    if array.dtype.kind != "b":
        raise ValueError(f"{argument} {shown(values)}: true or false is needed")
    return _spread(argument, array, shape)


def listed(argument: str, values: Any) -> Sequence[Any] | NDArray[Any]:
    """A list or an array of one dimension."""
    is_list = isinstance(values, _LISTS) and not isinstance(values, str)
    if not is_list or np.ndim(_plain(argument, values)) != 1:
        raise ValueError(f"{argument} {shown(values)}: a list is needed")
    found: Sequence[Any] | NDArray[Any] = values
    return found


def rows_of(family: Family, count: int, arrays: dict[str, ArrayLike]) -> dict[str, NDArray[Any]]:
    """Rows of a family's arrays, by name, as their columns hold them; (count, ...) or one value for all."""
    columns = {column.name: column for column in FAMILIES[family]}
    strangers = [name for name in arrays if name not in columns]
    if strangers:
        raise ValueError(f"{family.value}s have no {', '.join(strangers)}; they have {', '.join(columns)}")
    return {name: _rows(columns[name], values, count) for name, values in arrays.items()}


def _rows(column: Column, values: ArrayLike, count: int) -> NDArray[Any]:
    shape = (count,) if column.width == 1 else (count, column.width)
    kind = np.dtype(column.dtype).kind
    if kind == "f":
        within = column.within or ANY
        return floats(column.name, values, shape, within.lowest, within.high)
    if kind == "b":
        return flags(column.name, values, shape)
    array = _plain(column.name, values)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{column.name} {shown(values)}: whole numbers are needed")
    return _spread(column.name, array, shape)


def _spread(argument: str, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise ValueError(f"{argument} of shape {array.shape}: {shape} is needed") from None


def _plain(argument: str, values: Any) -> NDArray[Any]:
    try:
        return np.asarray(values)
    except (ValueError, TypeError):
        raise ValueError(f"{argument} {shown(values)}: rows of one length are needed") from None


def _numbers(argument: str, values: ArrayLike) -> NDArray[Any]:
    array = _plain(argument, values)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{argument} {shown(values)}: numbers are needed")
    return array


def _range_of(least: float, most: float) -> str:
    if least == -math.inf:
        return "a finite number"
    return f"a number of at least {least:g}" if most == math.inf else f"a number from {least:g} to {most:g}"
