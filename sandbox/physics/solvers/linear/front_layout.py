"""Where the numbers of fronts lie: those that stay, and those that wait for a parent."""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_float_rows, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import SlotRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.linear.dissection import DEEPEST, Dissection
from sandbox.physics.solvers.linear.fronts import PANEL, Fronts, Scratch
from sandbox.physics.solvers.linear.halves import find_fork
from sandbox.physics.topology.sorting import place_among

# Signed, for lengths.
PANEL_ROWS = int(PANEL)
# Places in `lengths`: of numbers, of what remains, of a row of the widest front.
NUMBERS, REMAINDER, WIDEST, LENGTHS = range(4)


class FrontPlaces(NamedTuple):
    """Where the fronts lie: see Fronts. By level: size of what the largest front leaves, and what lies before; before
    (f+1,) is scratch."""

    of_row: Annotated[Slots, "rows"]
    diagonal: Annotated[Slots, "rows"]
    row_width: Annotated[Slots, "rows"]
    width: Annotated[Slots, "fronts"]
    base: Annotated[Slots, "fronts"]
    remains: Annotated[Slots, "fronts"]
    fork: Annotated[SlotRows, "fronts, 2"]
    size: Annotated[Slots, f"{DEEPEST}"]
    beyond: Annotated[Slots, f"{DEEPEST}"]
    before: Annotated[Slots, "fronts + 1"]


@inner_kernel
def _lay_out_numbers(found: Dissection, places: FrontPlaces, lengths: Slots) -> None:
    for row in range(places.of_row.shape[0]):
        places.of_row[row] = places.diagonal[row] = places.row_width[row] = -1
    total = 0
    widest = 0
    for front in range(found.first.shape[0]):
        first = found.first[front]
        pivots = found.last[front] - first
        width = 2 * (pivots + found.border_start[front + 1] - found.border_start[front])
        places.width[front] = width
        places.base[front] = total
        for k in range(pivots):
            places.of_row[first + k] = front
            places.diagonal[first + k] = total + 2 * k * (width + 1)
            places.row_width[first + k] = width
        total += 2 * pivots * width
        widest = max(widest, width)
    lengths[NUMBERS] = total
    lengths[WIDEST] = widest


@inner_kernel
def _lay_out_remainders(found: Dissection, places: FrontPlaces, lengths: Slots) -> None:
    # Two fronts of a level wait at most, one per side; nothing lies below the widest front.
    for level in range(DEEPEST):
        places.size[level] = 0
    for front in range(found.first.shape[0]):
        border = 2 * (found.border_start[front + 1] - found.border_start[front])
        level = found.place[front, 0]
        places.size[level] = max(places.size[level], border * border)
    total = 0
    for level in range(DEEPEST):
        places.beyond[level] = lengths[WIDEST] + 2 * total
        total += places.size[level]
    for front in range(found.first.shape[0]):
        level = found.place[front, 0]
        places.remains[front] = places.beyond[level] + found.place[front, 1] * places.size[level]
    lengths[REMAINDER] = lengths[WIDEST] + 2 * total


@inner_kernel
def lay_out_fronts(
    first_front: Slots, bodies: int, found: Dissection, places: FrontPlaces, worth: int, lengths: Slots
) -> None:
    """Lay out the fronts of dissected bodies, and say in lengths (LENGTHS,) what they need.

    first_front (b+1,): of each body. worth: multiplications that the shorter half must have.
    """
    _lay_out_numbers(found, places, lengths)
    _lay_out_remainders(found, places, lengths)
    for front in range(found.first.shape[0]):
        places.fork[front, 0] = places.fork[front, 1] = 0
    for b in range(bodies):
        first = first_front[b]
        last = first_front[b + 1]
        if first < last:
            begin, end = find_fork(first, last, found, places.before, worth)
            places.fork[last - 1, 0] = begin
            places.fork[last - 1, 1] = end


class FrontBlocks(NamedTuple):
    """Where the blocks of large bodies lie: see Fronts."""

    of_row: Slots
    width: Slots
    base: Slots
    first: Slots
    last: Slots
    border_start: Slots
    border: Slots


@inner_kernel
def block_in_front(low: int, high: int, fronts: FrontBlocks) -> int:
    """Where the block between the rows low < high of a large body begins in the numbers of its fronts."""
    front = fronts.of_row[low]
    first = fronts.first[front]
    column = high - first
    if high >= fronts.last[front]:
        begin = fronts.border_start[front]
        at = place_among(high, fronts.border, begin, fronts.border_start[front + 1])
        column = fronts.last[front] - first + at - begin
    return fronts.base[front] + 2 * (low - first) * fronts.width[front] + 2 * column


@inner_kernel
def new_fronts(
    rows: int, first_front: Slots, bodies: int, found: Dissection, worth: int, arena: Arena
) -> Fronts:  # fmt: skip
    """The fronts of a matrix of so many rows, as they were found; first_front (b+1,): of each body.

    worth: multiplications that the shorter half must have.
    """
    fronts, lengths = found.first.shape[0], new_slots(arena, LENGTHS)
    places = new_tuple(FrontPlaces, arena, rows=rows, fronts=fronts)
    if not is_full(arena):
        lay_out_fronts(first_front, bodies, found, places, worth, lengths)
    widest = lengths[WIDEST]
    return Fronts(
        places.of_row, places.diagonal, places.row_width, found.first, found.last, found.child, found.border_start,
        found.border, found.to_parent, places.width, places.base, places.remains, new_floats(arena, lengths[NUMBERS]),
        new_floats(arena, lengths[REMAINDER]), new_floats(arena, 2 * rows), places.fork, Scratch(
            new_floats(arena, PANEL_ROWS * widest), new_floats(arena, PANEL_ROWS), new_floats(arena, widest),
        ),
        new_float_rows(arena, rows, 2),
    )  # fmt: skip
