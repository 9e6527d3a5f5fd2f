"""The fronts of a large body in two halves, which one thread works through, or two: the same bits either way.

The second half is one subtree, the first all that comes before it; neither reads what the other writes, and what lies
above both is done after them. Where they part follows from the level alone. A helping thread waits for the second half
to be offered; whoever takes the offer works it through, and on a busy machine that may be the one who made it.
"""

import os
import weakref
from collections.abc import Callable
from threading import Thread
from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel, precompile, waiting_kernel
from sandbox.physics.solvers.linear.dissection import Dissection
from sandbox.physics.solvers.linear.fronts import Fronts, Scratch, eliminate_rows, factorise_fronts, substitute_fronts
from sandbox.physics.solvers.linear.locks import Lock, give, has_locks, take

# Multiplications that a second thread must take off a body's factorisation: each word to it takes some 0.02 ms, and on
# a busy machine a half that it has begun may be waited for. Lattices from 48x48 on have halves. The halves are part of
# a tick's last bits. Lower, small bodies stutter on a busy machine; higher, those of 48x48 take a third longer.
WORTH_HALVING = 3_000_000
# Places in Fronts.call: two locks, what is wanted, and for which body.
OFFERED, DONE, WANTED, BODY, CALL_LENGTH = 0, 1, 2, 3, 4
NOTHING, FACTOR, ELIMINATE, SUBSTITUTE = 0, 1, 2, 3


@inner_kernel
def find_fork(begin: int, end: int, fronts: Dissection, before: Slots, worth: int) -> tuple[int, int]:
    """The fronts between which the second half of a body lies, as it has the least to do in turn; equal: nowhere.

    begin, end: its fronts; before (f+1,): scratch; worth: multiplications that are to be spared at least.
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
    least = total
    for front in range(begin, end):
        left = fronts.child[front, 0]
        right = fronts.child[front, 1]
        if left >= 0 and right >= 0:
            first, last = before[left + 1], before[right + 1]
            in_turn = max(first, last - first) + total - last
            if in_turn < least or best < 0:
                best = front
                least = in_turn
    if best < 0 or total - least < worth:
        return begin, begin
    return fronts.child[best, 0] + 1, fronts.child[best, 1] + 1


@inner_kernel
def _work(wanted: int, first_front: int, last_front: int, fronts: Fronts, scratch: Scratch, change: FloatRows) -> None:
    if wanted == SUBSTITUTE:
        substitute_fronts(first_front, last_front, fronts, scratch, change)
    elif wanted == FACTOR:
        factorise_fronts(first_front, last_front, fronts, scratch, change)
    else:
        eliminate_rows(first_front, last_front, fronts, scratch, change)


@inner_kernel
def _work_aside(wanted: int, body: int, fronts: Fronts, change: FloatRows) -> None:
    # The second half of a body, given by its last front. What it makes of rows above both halves is kept apart.
    first_front = fronts.fork[body, 0]
    last_front = fronts.fork[body, 1]
    first_row = fronts.first[first_front]
    last_row = fronts.last[last_front - 1]
    above = wanted == SUBSTITUTE
    for row in range(first_row, fronts.last[body]):
        inside = row < last_row or above
        fronts.apart[row, 0] = change[row, 0] if inside else 0.0
        fronts.apart[row, 1] = change[row, 1] if inside else 0.0
    _work(wanted, first_front, last_front, fronts, fronts.aside, fronts.apart)
    for row in range(first_row, last_row):
        change[row, 0] = fronts.apart[row, 0]
        change[row, 1] = fronts.apart[row, 1]


@inner_kernel
def _work_both(wanted: int, first_front: int, body: int, fronts: Fronts, change: FloatRows) -> None:
    call = fronts.call
    helped = call[DONE] != 0
    if helped:
        call[WANTED] = wanted
        call[BODY] = body
        give(call[OFFERED])
    _work(wanted, first_front, fronts.fork[body, 0], fronts, fronts.here, change)
    if helped and not take(call[OFFERED], 0):
        take(call[DONE], 1)
    else:
        _work_aside(wanted, body, fronts, change)


@inner_kernel
def solve_fronts(factored: bool, first_row: int, last_row: int, fronts: Fronts, change: FloatRows) -> None:
    """Solve for the rows of one body of change (n, 2), in place; its fronts are factored first, unless they are."""
    first_front = fronts.of_row[first_row]
    body = fronts.of_row[last_row - 1]
    wanted = ELIMINATE if factored else FACTOR
    halved = fronts.fork[body, 0] < fronts.fork[body, 1]
    above = fronts.fork[body, 1] if halved else first_front
    if halved:
        _work_both(wanted, first_front, body, fronts, change)
        for row in range(fronts.first[above], last_row):
            change[row, 0] += fronts.apart[row, 0]
            change[row, 1] += fronts.apart[row, 1]
    _work(wanted, above, body + 1, fronts, fronts.here, change)
    _work(SUBSTITUTE, above, body + 1, fronts, fronts.here, change)
    if halved:
        _work_both(SUBSTITUTE, first_front, body, fronts, change)


@waiting_kernel
def _help(fronts: Fronts, change: FloatRows) -> None:
    call = fronts.call
    while True:
        take(call[OFFERED], 1)
        if call[WANTED] == NOTHING:
            return
        _work_aside(call[WANTED], call[BODY], fronts, change)
        give(call[DONE])


def _dismiss(call: Slots, offered: Lock, done: Lock) -> None:
    call[WANTED] = NOTHING
    offered.give()


class Helper(NamedTuple):
    """A thread that takes second halves, and what dismisses it."""

    thread: Thread
    dismissal: Callable[[], object]

    def dismiss(self) -> None:
        """Let the thread end, which then reads nothing any more."""
        self.dismissal()
        self.thread.join()


def start_helper(owner: object, fronts: Fronts, change: Floats) -> Helper | None:
    """Start a thread that takes second halves of what kernels do with fronts and change (n, 2).

    It ends with `owner`, which must hold both while kernels use them. None where a thread would be of no use, or has
    nowhere to run; nothing else depends on it, and a process forked from this one does without.
    """
    if not has_locks() or not fronts.fork.any() or _processor_count() < 2:
        return None
    offered, done = Lock(), Lock()
    fronts.call[:] = offered.handle, done.handle, NOTHING, 0
    # The thread holds the locks too: they must not go before it ends.
    thread = Thread(target=lambda *_: _help(fronts, change), args=(offered, done), daemon=True)
    thread.start()
    return Helper(thread, weakref.finalize(owner, _dismiss, fronts.call, offered, done))


def _processor_count() -> int:
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1


def precompile_help(fronts: Fronts, change: Floats) -> None:
    """Compile the kernels that a second thread runs."""
    precompile(_help, fronts, change)
