"""Multifrontal factorisation: L D L^T of a large body's matrix, scalar by scalar, in the order of elimination.py.

A front holds the upper triangle, by rows, of what its particles and their border have become when they are eliminated:
its own rows stay in `numbers`, the others wait in `remainder` for its parent. Rows are long, so that the inner loops,
which run along them, use the full width of the machine; each number is still the same sum in the same order.
What a front leaves of a right side waits likewise in `carry`: sums follow the tree of fronts alone. So subtrees can be
worked on at once: a body has stages of tasks, at first subtrees, then the fronts above those, level by level. Source:
Duff and Reid 1983; George 1973.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, is_full, new_float_rows, new_floats, new_slots, new_tuple
from sandbox.physics.arrays import FloatRows, Floats, SlotRows, Slots
from sandbox.physics.jit import inner_kernel, parallel
from sandbox.physics.solvers.linear.elimination import DEEPEST, Dissection
from sandbox.physics.solvers.linear.sparse_ldl import inverse_pivot
from sandbox.physics.topology.sorting import place_among

# Subtrees of a body at most, and multiplications that one must have to be divided further.
MOST_SUBTREES = 16
WORTH_DIVIDING = 400_000
# Places in `lengths`: of numbers, of what remains, of a row of the widest front, tasks, stages, and lanes of scratch.
NUMBERS, REMAINDER, WIDEST, TASKS, STAGES, LANES, LENGTHS = range(7)
# Scalars eliminated at once: a row that waits is read and written once for all of them.
PANEL = 8
# Signed, for lengths.
PANEL_ROWS = int(PANEL)


class FrontPlaces(NamedTuple):
    """Where the fronts lie, and their tasks: see Fronts; from size on scratch, by level, front and subtree."""

    of_row: Annotated[Slots, "rows"]
    diagonal: Annotated[Slots, "rows"]
    row_width: Annotated[Slots, "rows"]
    width: Annotated[Slots, "fronts"]
    base: Annotated[Slots, "fronts"]
    remains: Annotated[Slots, "fronts"]
    stages: Annotated[SlotRows, "fronts, 2"]
    stage: Annotated[Slots, "fronts + 1"]
    lane: Annotated[Slots, "fronts"]
    stage_work: Annotated[SlotRows, "fronts, 2"]
    task: Annotated[SlotRows, "fronts, 2"]
    size: Annotated[Slots, f"{DEEPEST}"]
    level_place: Annotated[Slots, f"{DEEPEST}"]
    lowest: Annotated[Slots, "fronts"]  # front of a subtree
    before: Annotated[Slots, "fronts + 1"]  # multiplications of all fronts before
    height: Annotated[Slots, "fronts"]  # above subtrees; -1: within one
    root: Annotated[Slots, f"{MOST_SUBTREES}"]


class Scratch(NamedTuple):
    """Scratch for work on a front; of all fronts, a lane of it for each of the tasks that are worked on at once."""

    panel: Floats
    inverse: Floats
    vector: Floats


class Fronts(NamedTuple):
    """The fronts of all large bodies, children before parents; of first to to_parent see Dissection."""

    of_row: Slots  # (n,): the front that eliminates a row, -1: of a small body
    diagonal: Slots  # (n,): its place in numbers
    row_width: Slots  # (n,): the width of its front
    first: Slots
    last: Slots
    child: SlotRows
    border_start: Slots
    border: Slots
    to_parent: Slots
    width: Slots  # (f,): scalars in a row of the front
    base: Slots  # (f,): its place in numbers
    remains: Slots  # (f,): its place in remainder
    numbers: Floats
    remainder: Floats
    inverses: Floats  # (2 n,): 1 / d
    carry: FloatRows  # what a front leaves for each of its border rows of a right side
    stages: SlotRows  # (f, 2): at the last front of a body, its first stage and one past its last
    stage: Slots  # (s + 1,): first task of a stage
    lane: Slots  # (s,): of its first task; the next tasks have the next ones
    stage_work: SlotRows  # (s, 2): multiplications, of a factorisation and of a right side
    task: SlotRows  # (t, 2): first front and one past the last
    scratch: Scratch


@inner_kernel
def new_fronts(
    rows: int, first_front: Slots, bodies: int, found: Dissection, worth: int, arena: Arena
) -> Fronts:  # fmt: skip
    """The fronts of a matrix of so many rows, as they were found; first_front (b+1,): of each body.

    worth: multiplications that a subtree must have to be divided.
    """
    fronts, lengths = found.first.shape[0], new_slots(arena, LENGTHS)
    places = new_tuple(FrontPlaces, arena, rows=rows, fronts=fronts)
    if not is_full(arena):
        _lay_out_fronts(found, places, lengths)
        for b in range(bodies):
            if first_front[b] < first_front[b + 1]:
                _lay_out_tasks(first_front[b], first_front[b + 1], found, places, worth, lengths)
    stages, tasks, lanes, widest = lengths[STAGES], lengths[TASKS], lengths[LANES], lengths[WIDEST]
    return Fronts(
        places.of_row, places.diagonal, places.row_width, found.first, found.last, found.child, found.border_start,
        found.border, found.to_parent, places.width, places.base, places.remains, new_floats(arena, lengths[NUMBERS]),
        new_floats(arena, lengths[REMAINDER]), new_floats(arena, 2 * rows),
        new_float_rows(arena, found.border.shape[0], 2), places.stages, places.stage[: stages + 1],
        places.lane[:stages], places.stage_work[:stages], places.task[:tasks], Scratch(
            new_floats(arena, lanes * PANEL_ROWS * widest), new_floats(arena, lanes * PANEL_ROWS),
            new_floats(arena, lanes * widest),
        ),
    )  # fmt: skip


@inner_kernel
def _lay_out_fronts(found: Dissection, places: FrontPlaces, lengths: Slots) -> None:
    # Where the numbers of fronts lie, and what they need, into lengths (LENGTHS,).
    for row in range(places.of_row.shape[0]):
        places.of_row[row] = places.diagonal[row] = places.row_width[row] = -1
    total = widest = 0
    places.before[0] = 0
    for front in range(found.first.shape[0]):
        first = found.first[front]
        pivots = found.last[front] - first
        border = 2 * (found.border_start[front + 1] - found.border_start[front])
        width = 2 * pivots + border
        places.width[front] = width
        places.base[front] = total
        for k in range(pivots):
            places.of_row[first + k] = front
            places.diagonal[first + k] = total + 2 * k * (width + 1)
            places.row_width[first + k] = width
        total += 2 * pivots * width
        widest = max(widest, width)
        # n pivots of a front of width w and border b: a sixth of w^3 - b^3 multiplications
        places.before[front + 1] = places.before[front] + (width * width * width - border * border * border) // 6
        left, right = found.child[front, 0], found.child[front, 1]
        places.lowest[front] = places.lowest[left if left >= 0 else right] if max(left, right) >= 0 else front
    lengths[NUMBERS] = total
    lengths[WIDEST] = lengths[REMAINDER] = widest
    lengths[TASKS] = lengths[STAGES] = lengths[LANES] = 0
    places.stage[0] = 0


@inner_kernel
def _lay_out_tasks(
    first_front: int, last_front: int, found: Dissection, places: FrontPlaces, worth: int, lengths: Slots
) -> None:  # fmt: skip
    # The subtrees of one body as tasks, then what lies above them by height.
    subtrees = divide(first_front, last_front, found.child, places, worth)
    tallest = 0
    for front in range(first_front, last_front):
        if places.height[front] > 0:
            for side in range(2):
                child = found.child[front, side]
                if child >= 0:
                    places.height[front] = max(places.height[front], places.height[child] + 1)
            tallest = max(tallest, places.height[front])
    stage, task = lengths[STAGES], lengths[TASKS]
    places.stages[last_front - 1, 0] = stage
    for height in range(tallest + 1):
        places.stage_work[stage, 0] = places.stage_work[stage, 1] = 0
        for front in range(first_front, last_front):
            if places.height[front] == height:
                first = places.lowest[front] if height == 0 else front
                places.task[task, 0] = first
                places.task[task, 1] = front + 1
                task += 1
                places.stage_work[stage, 0] += places.before[front + 1] - places.before[first]
                for part in range(first, front + 1):
                    places.stage_work[stage, 1] += 2 * (found.last[part] - found.first[part]) * places.width[part]
                lengths[REMAINDER] = _lay_out_remainders(first, front + 1, found, places, lengths[REMAINDER])
        places.lane[stage] = lengths[LANES]
        stage += 1
        places.stage[stage] = task
    places.stages[last_front - 1, 1] = stage
    lengths[STAGES] = stage
    lengths[TASKS] = task
    lengths[LANES] += subtrees


@inner_kernel
def divide(first_front: int, last_front: int, child: SlotRows, places: FrontPlaces, worth: int) -> int:
    """Divide a body into subtrees, into `height`: of their roots 0, of what lies above 1; how many there are.

    The one of most multiplications first, as long as it has `worth` of them.
    """
    for front in range(first_front, last_front):
        places.height[front] = -1
    places.root[0] = last_front - 1
    count = 1
    while count < MOST_SUBTREES:
        most, chosen = worth, -1
        for k in range(count):
            root = places.root[k]
            work = places.before[root + 1] - places.before[places.lowest[root]]
            if work > most and max(child[root, 0], child[root, 1]) >= 0:
                most, chosen = work, k
        if chosen < 0:
            break
        root = places.root[chosen]
        places.height[root] = 1
        left, right = child[root, 0], child[root, 1]
        places.root[chosen] = left if left >= 0 else right
        if min(left, right) >= 0:
            places.root[count] = right
            count += 1
    for k in range(count):
        places.height[places.root[k]] = 0
    return count


@inner_kernel
def _lay_out_remainders(first: int, last: int, found: Dissection, places: FrontPlaces, total: int) -> int:
    # Where in `remainder`, from total on, what the fronts of one task leave waits; where that ends. What the last one
    # leaves waits for another task; of the others two of a level wait at most, one per side.
    for level in range(DEEPEST):
        places.size[level] = 0
    for front in range(first, last - 1):
        border = 2 * (found.border_start[front + 1] - found.border_start[front])
        level = found.place[front, 0]
        places.size[level] = max(places.size[level], border * border)
    border = 2 * (found.border_start[last] - found.border_start[last - 1])
    places.remains[last - 1] = total
    total += border * border
    for level in range(DEEPEST):
        places.level_place[level] = total
        total += 2 * places.size[level]
    for front in range(first, last - 1):
        level = found.place[front, 0]
        places.remains[front] = places.level_place[level] + found.place[front, 1] * places.size[level]
    return total


@inner_kernel
def block_in_front(low: int, high: int, fronts: Fronts) -> int:
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
def clear_fronts(first_row: int, last_row: int, mass: Floats, fronts: Fronts) -> None:
    """Fill the matrix of one body with its masses [kg], and 0 elsewhere."""
    first_front = fronts.of_row[first_row]
    last = fronts.of_row[last_row - 1]
    rows = 2 * (fronts.last[last] - fronts.first[last])
    for at in range(fronts.base[first_front], fronts.base[last] + rows * fronts.width[last]):
        fronts.numbers[at] = 0.0
    for row in range(first_row, last_row):
        at = fronts.diagonal[row]
        fronts.numbers[at] = mass[row]
        fronts.numbers[at + fronts.row_width[row] + 1] = mass[row]


@inner_kernel
def add_block(numbers: Floats, at: int, width: int, sign: float, xx: float, xy: float, yy: float) -> None:
    """Add a symmetric block, times a sign, to the one that begins at `at` in rows of `width`."""
    numbers[at] += sign * xx
    numbers[at + 1] += sign * xy
    numbers[at + width] += sign * xy
    numbers[at + width + 1] += sign * yy


@inner_kernel
def subtract_pair(
    target: Floats, row: int, source: Floats, upper: int, lower: int, a: float, b: float, begin: int, end: int
) -> None:
    """target[row + j] -= a source[upper + j] + b source[lower + j] for begin <= j < end."""
    for j in range(begin, end):
        target[row + j] -= a * source[upper + j] + b * source[lower + j]


@inner_kernel
def solve_fronts(factored: bool, last_row: int, fronts: Fronts, change: FloatRows) -> None:
    """Solve for the rows of a body, up to last_row, of change (n, 2) in place; factors its fronts, unless they are."""
    body = fronts.of_row[last_row - 1]
    first, last = fronts.stages[body, 0], fronts.stages[body, 1]
    for stage in range(first, last):
        tasks = fronts.stage[stage + 1] - fronts.stage[stage]
        for k in parallel(tasks, fronts.stage_work[stage, 1 if factored else 0]):
            _eliminate(factored, stage, k, fronts, change)
    for stage in range(last - 1, first - 1, -1):
        tasks = fronts.stage[stage + 1] - fronts.stage[stage]
        for k in parallel(tasks, fronts.stage_work[stage, 1]):
            _substitute(stage, k, fronts, change)


@inner_kernel
def _eliminate(factored: bool, stage: int, k: int, fronts: Fronts, change: FloatRows) -> None:
    # The fronts of one task of a stage: they begin to solve for their rows of change.
    task, scratch = fronts.stage[stage] + k, _scratch_of(stage, k, fronts)
    for front in range(fronts.task[task, 0], fronts.task[task, 1]):
        if not factored:
            _factorise(front, scratch, fronts)
        _eliminate_rows(front, scratch.vector, fronts, change)


@inner_kernel
def _scratch_of(stage: int, k: int, fronts: Fronts) -> Scratch:
    # The scratch of one task of a stage.
    panel, inverse, vector = fronts.scratch.panel, fronts.scratch.inverse, fronts.scratch.vector
    lane, widest = fronts.lane[stage] + k, vector.shape[0] * PANEL // inverse.shape[0]
    return Scratch(
        panel[lane * PANEL * widest : (lane + 1) * PANEL * widest], inverse[lane * PANEL : (lane + 1) * PANEL],
        vector[lane * widest : (lane + 1) * widest],
    )  # fmt: skip


@inner_kernel
def _eliminate_rows(front: int, vector: Floats, fronts: Fronts, change: FloatRows) -> None:
    # Of change, by a factored front; what is left of its border waits in `carry`.
    numbers, inverses, carry = fronts.numbers, fronts.inverses, fronts.carry
    width, first_inverse = fronts.width[front], 2 * fronts.first[front]
    k = 0
    for row in range(fronts.first[front], fronts.last[front]):
        vector[k] = change[row, 0]
        vector[k + 1] = change[row, 1]
        k += 2
    for j in range(k, width):
        vector[j] = 0.0
    for side in range(2):
        below = fronts.child[front, side]
        if below >= 0:
            for at in range(fronts.border_start[below], fronts.border_start[below + 1]):
                j = 2 * fronts.to_parent[at]
                vector[j] += carry[at, 0]
                vector[j + 1] += carry[at, 1]
    for p in range(0, 2 * (fronts.last[front] - fronts.first[front]), 2):
        row = fronts.base[front] + p * width
        x = vector[p] * inverses[first_inverse + p]
        vector[p + 1] -= x * numbers[row + p + 1]
        y = vector[p + 1] * inverses[first_inverse + p + 1]
        subtract_pair(vector, 0, numbers, row, row + width, x, y, p + 2, width)
    k = 0
    for row in range(fronts.first[front], fronts.last[front]):
        change[row, 0] = vector[k]
        change[row, 1] = vector[k + 1]
        k += 2
    for at in range(fronts.border_start[front], fronts.border_start[front + 1]):
        carry[at, 0] = vector[k]
        carry[at, 1] = vector[k + 1]
        k += 2


@inner_kernel
def _factorise(front: int, scratch: Scratch, fronts: Fronts) -> None:
    # Factor one front in place.
    panel, inverse, numbers, remainder = scratch.panel, scratch.inverse, fronts.numbers, fronts.remainder
    stride, pivots = scratch.vector.shape[0], 2 * (fronts.last[front] - fronts.first[front])
    width, base, place = fronts.width[front], fronts.base[front], fronts.remains[front]
    border = width - pivots
    for at in range(place, place + border * border):
        remainder[at] = 0.0
    for side in range(2):
        below = fronts.child[front, side]
        if below >= 0:
            _add_child(
                numbers, base, remainder, place, pivots, width, fronts.remains[below], fronts.to_parent,
                fronts.border_start[below], fronts.border_start[below + 1],
            )  # fmt: skip
    first_inverse = 2 * fronts.first[front]
    for begin in range(0, pivots, PANEL):
        end = min(begin + PANEL, pivots)
        _eliminate_panel(numbers, base, width, begin, end, panel, stride, inverse)
        for p in range(begin, end):
            fronts.inverses[first_inverse + p] = inverse[p - begin]
        for i in range(end, pivots, 2):
            row = base + i * width
            _subtract_panel(numbers, row, row + width, panel, stride, inverse, i, width)
        for i in range(pivots, width, 2):
            # Columns of the remainder count from the first border row; no place in it is below the widest front.
            row = place + (i - pivots) * border - pivots
            _subtract_panel(remainder, row, row + border, panel, stride, inverse, i, width)


@inner_kernel
def _add_child(
    numbers: Floats, base: int, remainder: Floats, place: int, pivots: int, width: int, child_place: int, places: Slots,
    begin: int, end: int,
) -> None:  # fmt: skip
    # What waits of a child, into the rows of its parent.
    border = width - pivots
    child_border = 2 * (end - begin)
    for p in range(begin, end):
        i = 2 * places[p]
        source = child_place + 2 * (p - begin) * child_border
        if i < pivots:
            for q in range(p, end):
                at = base + i * width + 2 * places[q]
                back = source + 2 * (q - begin)
                numbers[at] += remainder[back]
                numbers[at + 1] += remainder[back + 1]
                numbers[at + width] += remainder[back + child_border]
                numbers[at + width + 1] += remainder[back + child_border + 1]
        else:
            for q in range(p, end):
                at = place + (i - pivots) * border + (2 * places[q] - pivots)
                back = source + 2 * (q - begin)
                remainder[at] += remainder[back]
                remainder[at + 1] += remainder[back + 1]
                remainder[at + border] += remainder[back + child_border]
                remainder[at + border + 1] += remainder[back + child_border + 1]


@inner_kernel
def _eliminate_panel(
    numbers: Floats, base: int, width: int, begin: int, end: int, panel: Floats, stride: int, inverse: Floats
) -> None:
    # Rows begin..end of a front become those of its factor, times their pivot; the panel is a copy of them, filled up
    # with rows that do nothing.
    for p in range(begin, end, 2):
        row = base + p * width
        lower = row + width
        q = p - begin
        xx = numbers[row + p]
        inverse_x = inverse_pivot(xx, xx)
        before = numbers[lower + p + 1]
        slant = numbers[row + p + 1] * inverse_x
        for j in range(p + 1, width):
            numbers[lower + j] -= slant * numbers[row + j]
        inverse_y = inverse_pivot(numbers[lower + p + 1], before)
        inverse[q] = inverse_x
        inverse[q + 1] = inverse_y
        for i in range(p + 2, end):
            a = numbers[row + i] * inverse_x
            b = numbers[lower + i] * inverse_y
            subtract_pair(numbers, base + i * width, numbers, row, lower, a, b, i, width)
    for q in range(PANEL):
        if begin + q < end:
            row = base + (begin + q) * width
            for j in range(begin, width):
                panel[q * stride + j] = numbers[row + j]
        else:
            inverse[q] = 0.0
            for j in range(begin, width):
                panel[q * stride + j] = 0.0


@inner_kernel
def _subtract_panel(
    target: Floats, row: int, next_row: int, panel: Floats, stride: int, inverse: Floats, i: int, width: int
) -> None:
    # Rows i and i + 1 of a front, which lie at row and next_row of target, less what eight pivots make of them.
    p1 = stride
    p2 = p1 + stride
    p3 = p2 + stride
    p4 = p3 + stride
    p5 = p4 + stride
    p6 = p5 + stride
    p7 = p6 + stride
    k = i + 1
    a0 = panel[i] * inverse[0]
    a1 = panel[p1 + i] * inverse[1]
    a2 = panel[p2 + i] * inverse[2]
    a3 = panel[p3 + i] * inverse[3]
    a4 = panel[p4 + i] * inverse[4]
    a5 = panel[p5 + i] * inverse[5]
    a6 = panel[p6 + i] * inverse[6]
    a7 = panel[p7 + i] * inverse[7]
    b0 = panel[k] * inverse[0]
    b1 = panel[p1 + k] * inverse[1]
    b2 = panel[p2 + k] * inverse[2]
    b3 = panel[p3 + k] * inverse[3]
    b4 = panel[p4 + k] * inverse[4]
    b5 = panel[p5 + k] * inverse[5]
    b6 = panel[p6 + k] * inverse[6]
    b7 = panel[p7 + k] * inverse[7]
    for j in range(i, width):
        c0 = panel[j]
        c1 = panel[p1 + j]
        c2 = panel[p2 + j]
        c3 = panel[p3 + j]
        c4 = panel[p4 + j]
        c5 = panel[p5 + j]
        c6 = panel[p6 + j]
        c7 = panel[p7 + j]
        target[row + j] -= a0 * c0 + a1 * c1 + a2 * c2 + a3 * c3 + a4 * c4 + a5 * c5 + a6 * c6 + a7 * c7
        target[next_row + j] -= b0 * c0 + b1 * c1 + b2 * c2 + b3 * c3 + b4 * c4 + b5 * c5 + b6 * c6 + b7 * c7


@inner_kernel
def _substitute(stage: int, number: int, fronts: Fronts, change: FloatRows) -> None:
    # The fronts of one task of a stage: they finish solving for their rows of change.
    task, vector = fronts.stage[stage] + number, _scratch_of(stage, number, fronts).vector
    numbers, inverses = fronts.numbers, fronts.inverses
    for front in range(fronts.task[task, 1] - 1, fronts.task[task, 0] - 1, -1):
        k = 0
        for row in range(fronts.first[front], fronts.last[front]):
            vector[k] = change[row, 0]
            vector[k + 1] = change[row, 1]
            k += 2
        for at in range(fronts.border_start[front], fronts.border_start[front + 1]):
            row = fronts.border[at]
            vector[k] = change[row, 0]
            vector[k + 1] = change[row, 1]
            k += 2
        # Two rows at once, in four sums each: the order of a sum is part of the result.
        width, first_inverse = fronts.width[front], 2 * fronts.first[front]
        for p in range(2 * (fronts.last[front] - fronts.first[front]) - 2, -1, -2):
            row = fronts.base[front] + p * width
            lower = row + width
            x0 = x1 = x2 = x3 = 0.0
            y0 = y1 = y2 = y3 = 0.0
            whole = (width - p - 2) // 4 * 4 + p + 2
            for j in range(p + 2, whole, 4):
                v0 = vector[j]
                v1 = vector[j + 1]
                v2 = vector[j + 2]
                v3 = vector[j + 3]
                x0 += numbers[row + j] * v0
                x1 += numbers[row + j + 1] * v1
                x2 += numbers[row + j + 2] * v2
                x3 += numbers[row + j + 3] * v3
                y0 += numbers[lower + j] * v0
                y1 += numbers[lower + j + 1] * v1
                y2 += numbers[lower + j + 2] * v2
                y3 += numbers[lower + j + 3] * v3
            for j in range(whole, width):
                x0 += numbers[row + j] * vector[j]
                y0 += numbers[lower + j] * vector[j]
            y = (vector[p + 1] - ((y0 + y1) + (y2 + y3))) * inverses[first_inverse + p + 1]
            vector[p + 1] = y
            x = vector[p] - ((x0 + x1) + (x2 + x3)) - numbers[row + p + 1] * y
            vector[p] = x * inverses[first_inverse + p]
        k = 0
        for row in range(fronts.first[front], fronts.last[front]):
            change[row, 0] = vector[k]
            change[row, 1] = vector[k + 1]
            k += 2
