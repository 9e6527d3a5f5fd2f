"""The fronts of a large body in two halves, whose right sides do not share a sum until both are done.

The second half is one subtree, the first all that comes before it; neither reads what the other writes, and what lies
above both is done after them. Where they part follows from the level alone.
"""

from sandbox.physics.arrays import FloatRows, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.linear.dissection import Dissection
from sandbox.physics.solvers.linear.fronts import Fronts, eliminate_rows, factorise_fronts, substitute_fronts

# Multiplications that the shorter half of a body's factorisation must have: lattices from 48x48 on have halves. They
# are part of a tick's last bits.
WORTH_HALVING = 3_000_000
# What is done to fronts before their rows are substituted.
FACTOR, ELIMINATE = 0, 1


@inner_kernel
def find_fork(begin: int, end: int, fronts: Dissection, before: Slots, worth: int) -> tuple[int, int]:
    """The fronts between which the second half of a body lies, so that the shorter half is longest; equal: nowhere.

    begin, end: its fronts; before (f+1,): scratch; worth: multiplications that the shorter half must have.
    """
    total = 0
    for front in range(begin, end):
        border = 2 * (fronts.border_start[front + 1] - fronts.border_start[front])
        width = 2 * (fronts.last[front] - fronts.first[front]) + border
        before[front] = total
        # n pivots of a front of width w and border b: a sixth of w^3 - b^3 multiplications
        total += (width * width * width - border * border * border) // 6
    before[end] = total
    best = -1
    most = 0
    for front in range(begin, end):
        left = fronts.child[front, 0]
        right = fronts.child[front, 1]
        if left >= 0 and right >= 0:
            first, last = before[left + 1], before[right + 1]
            shorter = min(first, last - first)
            if shorter > most or best < 0:
                best = front
                most = shorter
    if best < 0 or most < worth:
        return begin, begin
    return fronts.child[best, 0] + 1, fronts.child[best, 1] + 1


@inner_kernel
def _eliminate(wanted: int, first_front: int, last_front: int, fronts: Fronts, change: FloatRows) -> None:
    if wanted == ELIMINATE:
        eliminate_rows(first_front, last_front, fronts, change)
    else:
        factorise_fronts(first_front, last_front, fronts, change)


@inner_kernel
def solve_fronts(factored: bool, first_row: int, last_row: int, fronts: Fronts, change: FloatRows) -> None:
    """Solve for the rows of one body of change (n, 2), in place; its fronts are factored first, unless they are."""
    first_front = fronts.of_row[first_row]
    body = fronts.of_row[last_row - 1]
    wanted = ELIMINATE if factored else FACTOR
    begin, above = fronts.fork[body, 0], fronts.fork[body, 1]
    if begin < above:
        _eliminate(wanted, first_front, begin, fronts, change)
        for row in range(fronts.first[above], last_row):
            for axis in range(2):
                fronts.first_half_rhs[row, axis] = change[row, axis]
                change[row, axis] = 0.0
        _eliminate(wanted, begin, above, fronts, change)
        for row in range(fronts.first[above], last_row):
            for axis in range(2):
                change[row, axis] += fronts.first_half_rhs[row, axis]
        _eliminate(wanted, above, body + 1, fronts, change)
    else:
        _eliminate(wanted, first_front, body + 1, fronts, change)
    substitute_fronts(first_front, body + 1, fronts, change)
