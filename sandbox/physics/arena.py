"""Arenas: memory in which kernels lay out arrays whose lengths they find themselves.

An arena is an array of words, the first of which says how many of them are in use. Whoever runs out of room leaves that
larger than the arena, and what it got may not be touched: ask `is_full` after laying out arrays and before using them.
Arrays begin at 0, as those of numpy's zeros; so must an arena when it is new.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.physics.arrays import Flags, FloatRows, Floats, FloatTables, Int32s, SlotRows, Slots
from sandbox.physics.jit import (
    ArenaLayout,
    flags_in,
    float_rows_in,
    float_tables_in,
    floats_in,
    hold,
    inlined_kernel,
    inner_kernel,
    int32s_in,
    slot_rows_in,
    slots_in,
)

Arena = Slots

# What a kernel gives in place of a result where its arena is full, and nothing else was changed.
NO_ARENA = -1

FLAGS_IN_WORD, INT32S_IN_WORD = 8, 2
# Words that one begins with, of which nothing is known.
FIRST_ARENA = 1 << 12
# How much larger than it had to be an arena becomes that was too small.
MORE = 2


@inner_kernel
def give_back(arena: Arena, to: int) -> None:
    """Free the arrays that were laid out in an arena since a mark."""
    # What lies beyond is 0 at all times, so that nothing is to be done where an array begins.
    for at in range(to, min(arena[0], arena.shape[0])):
        arena[at] = 0
    arena[0] = to


@inner_kernel
def begin(arena: Arena) -> None:
    """Give back all that was laid out."""
    give_back(arena, 1)


@inner_kernel
def is_full(arena: Arena) -> bool:
    """Whether something did not find room."""
    return arena[0] > arena.shape[0]


@inner_kernel
def mark(arena: Arena) -> int:
    """The place of the next array, a mark for `give_back`."""
    return arena[0]


@inner_kernel
def _take(arena: Arena, words: int) -> int:
    first = arena[0]
    arena[0] = first + words
    return first if first + words <= arena.shape[0] else 1


@inlined_kernel
def new_slots(arena: Arena, rows: int) -> Slots:
    """Integers (rows,)."""
    return slots_in(arena, _take(arena, rows), rows)


@inlined_kernel
def new_slot_rows(arena: Arena, rows: int, width: int) -> SlotRows:
    """Integers (rows, width)."""
    return slot_rows_in(arena, _take(arena, rows * width), rows, width)


@inlined_kernel
def new_floats(arena: Arena, rows: int) -> Floats:
    """Numbers (rows,)."""
    return floats_in(arena, _take(arena, rows), rows)


@inlined_kernel
def new_float_rows(arena: Arena, rows: int, width: int) -> FloatRows:
    """Numbers (rows, width)."""
    return float_rows_in(arena, _take(arena, rows * width), rows, width)


@inlined_kernel
def new_float_tables(arena: Arena, tables: int, rows: int, width: int) -> FloatTables:
    """Numbers (tables, rows, width)."""
    return float_tables_in(arena, _take(arena, tables * rows * width), tables, rows, width)


@inlined_kernel
def new_flags(arena: Arena, rows: int) -> Flags:
    """Flags (rows,)."""
    return flags_in(arena, _take(arena, (rows + FLAGS_IN_WORD - 1) // FLAGS_IN_WORD), rows)


@inlined_kernel
def new_int32s(arena: Arena, rows: int) -> Int32s:
    """Integers of 32 bits (rows,)."""
    return int32s_in(arena, _take(arena, (rows + INT32S_IN_WORD - 1) // INT32S_IN_WORD), rows)


# Named tuples, of whose arrays the lengths stand beside the fields.
new_tuple = ArenaLayout(new_slots, new_slot_rows, new_floats, new_float_rows, new_float_tables, new_flags, new_int32s)


def lay_out(entry: Callable[..., Any], pointer: Any, arena: Arena, *arguments: Any) -> Arena:
    """Run a kernel entry(pointer, arena, ...) that lays out arrays for a bundle; the arena, or a longer one."""
    hold(pointer, arena)
    entry(pointer, arena, *arguments)
    while arena[0] > len(arena):
        arena = np.zeros(MORE * int(arena[0]), np.int64)
        hold(pointer, arena)
        entry(pointer, arena, *arguments)
    return arena


def answer_of(entry: Callable[..., Any], words: int, *arguments: Any) -> tuple[Any, Arena]:
    """The answer of a kernel entry(arena, ...) once it finds room, and its arena, which has so many words at first."""
    arena = np.zeros(words, np.int64)
    answer = entry(arena, *arguments)
    while arena[0] > len(arena):
        arena = np.zeros(MORE * int(arena[0]), np.int64)
        answer = entry(arena, *arguments)
    return answer, arena
