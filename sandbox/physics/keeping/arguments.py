"""Arguments: what programs hand to a world, checked before anything is written.

Every fault raises IndexError, for a slot that is not there, or ValueError; its text names argument, value and range.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.constraints import BEND
from sandbox.physics.driving import Actuators
from sandbox.physics.marks import DISC, KINDS, LONGEST_RAMP, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.state import (
    ABSURD,
    BY_NAME,
    FAMILIES,
    FEATURES,
    FINITE,
    MATERIALS,
    OR_NONE,
    Column,
    Family,
    StateArrays,
)

# Words for the rows of families, where a slot of one is asked for.
PARTICLES, SPRINGS, CONSTRAINTS = "particles", "springs", "constraints"
HANDS, PARTS, KEYS = "hands", "driven parts", "keys that rules ask for"
# Types of what is given; a tuple is asked in a quarter of a union's time.
_WHOLE, _NUMBERS, _LISTS = (int, np.integer), (float, int, np.integer, np.floating), (tuple, list, np.ndarray, Sequence)
# Slots beyond this are beyond any array; kernels take no more digits.
FARTHEST = 2**62
# Arrays that have to fit to each other: see `check_ends` and, with a prefix, `check_corners`.
_ENDS, _CORNERS = ("particle_a", "particle_b"), ("constraint_kind", "constraint_first", "constraint_corners")
_TOGETHER = {name: ("", _ENDS) for name in _ENDS} | {name: ("constraint", _CORNERS) for name in _CORNERS}
# Families whose rows come one by one; those of others come with what they are of.
_ADDABLE = (Family.PARTICLE, Family.SPRING)
# Rows that one call may add [1]; more fill the memory of a small computer.
MOST_ADDED = 1_000_000
Instance = TypeVar("Instance")


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


def whole_from(argument: str, value: Any, least: int, most: int) -> int:
    """A whole number from least to most."""
    found = whole(argument, value)
    if not least <= found <= most:
        raise ValueError(f"{argument} {shown(value)}: a whole number from {least} to {most} is needed")
    return found


def of_kind(argument: str, value: Any, kind: type[Instance]) -> Instance:
    """A value of a class."""
    if not isinstance(value, kind):
        raise ValueError(f"{argument} {shown(value)}: one of {kind.__name__} is needed")
    return value


def all_of_kind(argument: str, values: Any, kind: type[Instance]) -> Iterator[Instance]:
    """The values of a class that are iterated, each looked at as it comes."""
    try:
        each = iter(values)
    except TypeError:
        raise ValueError(f"{argument} {shown(values)}: any number of {kind.__name__} are needed") from None
    return (of_kind(argument, value, kind) for value in each)


def text(argument: str, value: Any) -> str:
    """A text of Unicode, without lone surrogates."""
    if not isinstance(value, str) or not _is_unicode(value):
        raise ValueError(f"{argument} {shown(value)}: a text is needed")
    return value


def texts(argument: str, values: Any) -> Sequence[str]:
    """A list of texts."""
    found = listed(argument, values)
    for value in found:
        text(argument, value)
    return found


def _is_unicode(value: str) -> bool:
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


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


def rows_at(argument: str, rows: Any, count: int) -> Any:
    """Rows of an array, by one slot, a list, a slice or flags, as numpy takes them."""
    if isinstance(rows, slice):
        try:
            return slice(*rows.indices(count))
        except (TypeError, ValueError):
            raise ValueError(f"{argument} {shown(rows)}: a slice of whole numbers is needed") from None
    array = _plain(argument, rows)
    if array.dtype.kind == "b" and array.shape == (count,):
        return array
    return slots(argument, array.reshape(-1), "rows", count).reshape(array.shape)


class Room(NamedTuple):
    """How many things whole numbers of arrays can name: rows by family, materials, corners and edges of terrain."""

    rows: Mapping[Family, int]
    materials: int
    corners: int
    edges: int


def room_of(world: Any) -> Room:
    """The room of a world."""
    rows = {family: len(getattr(world, columns[0].name)) for family, columns in FAMILIES.items()}
    return Room(rows, len(world.material_names), len(world.terrain.vertex), len(world.terrain.edge_a))


def check_whole_numbers(argument: str, column: Column, values: NDArray[Any], room: Room) -> None:
    """Refuse slots that are not there, and marks that mean nothing, in an array of a column."""
    of, least = column.of, -1 if column.of in OR_NONE else 0
    if of is None or not values.size:
        return
    if isinstance(of, range):
        is_bad = (values < of.start) | (values >= of.stop)
        if is_bad.any():
            value = shown(values[is_bad].flat[0])
            raise ValueError(f"{argument} {value}: a whole number from {of.start} to {of.stop - 1} is needed")
        return
    if of == FEATURES:
        is_bad, words, count = ~_touchable(values, room), "such a thing to touch", 0
    else:
        words = of.value if isinstance(of, Family) else MATERIALS
        words, count = f"{words.partition(' ')[0]}s", room.rows[of] if isinstance(of, Family) else room.materials
        is_bad = (values < least) | (values >= count)
    if is_bad.any():
        raise no_slot(argument, values[is_bad].flat[0], words, count)


def _touchable(feature: NDArray[np.integer], room: Room) -> NDArray[np.bool_]:
    """Which features of contacts are there."""
    kind, number = feature % KINDS, feature // KINDS
    springs = room.rows[Family.SPRING]
    counts = np.full(len(feature), springs)
    for each, count in ((DISC, room.rows[Family.PARTICLE]), (TERRAIN, room.edges), (TIP, room.corners * TIP_SHIFT)):
        counts[kind == each] = count
    there: NDArray[np.bool_] = (number >= 0) & (number < counts) & ((kind != TIP) | (number % TIP_SHIFT < springs))
    return there


def check_driven(world: Any, driven: Actuators) -> None:
    """Refuse driven parts of a world whose slots are not there."""
    muscles, hydraulics, motors, parts = driven.muscles, driven.hydraulics, driven.motors, len(driven.names)
    for values, rows, count in (
        (muscles.spring, SPRINGS, world.spring_count),
        (hydraulics.spring, SPRINGS, world.spring_count),
        (motors.hub, PARTICLES, world.particle_count),
        (motors.rim, PARTICLES, world.particle_count),
        (hydraulics.part, PARTS, parts),
        (motors.part, PARTS, parts),
    ):
        slots("driven", values, rows, count)


def check_ends(a: NDArray[np.integer], b: NDArray[np.integer]) -> None:
    """Refuse springs from a particle to itself."""
    same = np.flatnonzero(a == b)
    if len(same):
        raise ValueError(f"particle_a, particle_b {a[same[0]]}: a spring joins two different particles")


def check_corners(prefix: str, kinds_firsts_sizes: Sequence[NDArray[Any]], corner_count: int) -> None:
    """Whether the corners of constraints, so many in all, lie one constraint after another; a bend has three.

    kinds_firsts_sizes: arrays (k,) of kinds, first corners and numbers of corners. prefix: of their names in messages.
    """
    kind, first, sizes = kinds_firsts_sizes
    ends = np.cumsum(sizes, dtype=np.int64)
    if np.any(sizes < 3) or (int(ends[-1]) if len(ends) else 0) != corner_count:
        raise ValueError(f"{prefix}_corners: do not add up to the corners that there are")
    if np.any(first != ends - sizes):
        raise ValueError(f"{prefix}_first: corners do not lie one {prefix.rpartition('.')[2]} after another")
    if not np.all((kind != BEND) | (sizes == 3)):
        raise ValueError(f"{prefix}_kind: a bend has three corners")


def active_particles(world: StateArrays, argument: str, values: Any) -> Slots:
    """Slots of particles that are in use (k,)."""
    found = slots(argument, values, PARTICLES, len(world.particle_active))
    unused = found[~world.particle_active[found]]
    if len(unused):
        raise IndexError(f"{argument} {unused[0]}: it is not in use")
    return found


def number(argument: str, value: Any, least: float = -ABSURD, most: float = ABSURD) -> float:
    """A finite number from least to most."""
    if isinstance(value, bool) or not isinstance(value, _NUMBERS):
        raise ValueError(f"{argument} {shown(value)}: a number is needed")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not least <= found <= most:
        raise ValueError(f"{argument} {shown(value)}: a number from {least:g} to {most:g} is needed")
    return found


def point(argument: str, value: Any) -> tuple[float, float]:
    """A pair of finite numbers."""
    if isinstance(value, str) or not isinstance(value, _LISTS) or getattr(value, "ndim", 1) != 1 or len(value) != 2:
        raise ValueError(f"{argument} {shown(value)}: a pair of numbers is needed")
    return number(argument, value[0]), number(argument, value[1])


def floats(
    argument: str, values: ArrayLike, shape: tuple[int, ...], least: float = -ABSURD, most: float = ABSURD
) -> Floats:
    """Finite numbers from least to most, spread over a shape."""
    array = _numbers(argument, values)
    is_bad = ~((array >= least) & (array <= most))
    if is_bad.any():
        value = shown(float(array[is_bad].flat[0]))
        raise ValueError(f"{argument} {value}: a number from {least:g} to {most:g} is needed")
    return _spread(argument, array.astype(np.float64), shape)


def floats_or(argument: str, values: ArrayLike, usual: Floats, least: float = -ABSURD) -> Floats:
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


def listed(argument: str, values: Any) -> Any:
    """A list or an array of one dimension."""
    is_list = isinstance(values, _LISTS) and not isinstance(values, str)
    if not is_list or np.ndim(_plain(argument, values)) != 1:
        raise ValueError(f"{argument} {shown(values)}: a list is needed")
    return values


def column_of(argument: str, name: Any) -> Column:
    """The column of an array of that name."""
    if not isinstance(name, str) or name not in BY_NAME:
        raise ValueError(f"{argument} {shown(name)}: there is no such array; there are {', '.join(BY_NAME)}")
    return BY_NAME[name]


def added_rows(world: Any, family: Any, count: Any, arrays: dict[str, ArrayLike]) -> dict[str, NDArray[Any]]:
    """Rows that a program appends to the arrays of a family, see `rows_of`; usual ones count too."""
    if not isinstance(family, Family) or family not in _ADDABLE:
        raise ValueError(f"family {shown(family)}: particles and springs are appended, others come with what they are")
    whole_from("count", count, 0, MOST_ADDED)
    usual = {column.name: column.usual for column in FAMILIES[family] if column.of or column.within}
    return rows_of(world, family, count, usual | arrays)


def rows_of(world: Any, family: Family, count: int, arrays: dict[str, ArrayLike]) -> dict[str, NDArray[Any]]:
    """Rows of a family's arrays for a world, by name, as their columns hold them; (count, ...) or one value for all."""
    columns = {column.name: column for column in FAMILIES[family]}
    strangers = [name for name in arrays if name not in columns]
    if strangers:
        raise ValueError(f"{family.value}s have no {', '.join(strangers)}; they have {', '.join(columns)}")
    room = room_of(world)
    rows = {
        name: values_of(name, columns[name], values, columns[name].usual_rows(count).shape, room)
        for name, values in arrays.items()
    }
    if family is Family.SPRING:
        check_ends(rows["particle_a"], rows["particle_b"])
    return rows


def values_of(argument: str, column: Column, values: ArrayLike, shape: tuple[int, ...], room: Room) -> NDArray[Any]:
    """Values of a column, spread over a shape."""
    kind = np.dtype(column.dtype).kind
    if kind == "f":
        within = column.within or FINITE
        # What a number is divided by is not so small that nothing finite comes of it.
        found = floats(argument, values, shape, 1.0 / within.high if within.is_above else within.low, within.high)
        if column.name == "inverse_mass" and np.any((found > 0.0) & (found < 1.0 / within.high)):
            raise ValueError(f"{argument}: 0 or a number of at least {1.0 / within.high:g} is needed")
        return found
    if kind == "b":
        return flags(argument, values, shape)
    array = _plain(argument, values)
    limits = np.iinfo(np.dtype(column.dtype))
    if array.dtype.kind not in "iu" or np.any((array < limits.min) | (array > limits.max)):
        raise ValueError(f"{argument} {shown(values)}: whole numbers are needed, from {limits.min} to {limits.max}")
    check_whole_numbers(argument, column, np.atleast_1d(array), room)
    return _spread(argument, array, shape)


def replaced(world: Any, name: str, rows: Any, values: NDArray[Any]) -> None:
    """Whether values can take the place of rows of an array, where others have to fit to it."""
    if name not in _TOGETHER:
        return
    prefix, names = _TOGETHER[name]
    arrays = [getattr(world, each).copy() for each in names]
    arrays[names.index(name)][rows] = values
    if prefix:
        check_corners(prefix, arrays, len(world.corner_particle))
    else:
        check_ends(*arrays)


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
