"""Memory of the exact active set of contacts (active_solve.py), and L D L^T of its matrix within an envelope."""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.collision.types import ENDS
from sandbox.physics.jit import inner_kernel

# What one matrix may cost, for which there has to be room: the sum of the squares of the lengths of its rows.
MOST_PRODUCTS = 4e6
# A pivot below this share of its diagonal is none: that row follows from those before it.
SMALLEST_PIVOT = 1e-12


class ActiveSet(NamedTuple):
    """Scratch of the exact solve of one island's contacts that carry and stick.

    Nodes are the blocks of the Delassus operator, then particles. A place is ENDS contact + end.
    """

    head: Annotated[Slots, "2 * touched"]  # by node: place of its first contact, -1: none
    following: Annotated[Slots, f"{ENDS} * contacts"]  # by place: the next one of the node
    rank: Annotated[Slots, "2 * touched"]  # by node: in a walk
    queue: Annotated[Slots, "2 * touched"]  # nodes by rank
    slow: Annotated[Flags, "contacts"]  # by contact: all that it touches is slow, and firm
    order: Annotated[Slots, "contacts"]  # slow contacts along the walk
    row: Annotated[Slots, "2 * contacts"]  # row of a contact's normal and tangent, -1: at its bound
    state: Annotated[SlotRows, "contacts, 2"]  # see active_rows.py
    u: Annotated[FloatRows, "contacts, 2"]  # [m/s]
    bound: Annotated[Floats, "contacts"]  # [N s]: friction that a contact goes to
    centre: Annotated[Floats, "contacts"]  # [N s]: friction from which sticking is soft
    best: Annotated[FloatRows, "contacts, 2"]  # [N s]: the impulses that miss least
    of_row: Annotated[Slots, "2 * contacts"]  # by row: 2 contact + axis
    start: Annotated[Slots, "2 * contacts + 1"]  # by row: where it begins in matrix
    first: Annotated[Slots, "2 * contacts"]  # by row: its first column
    pivot: Annotated[Floats, "2 * contacts"]
    rhs: Annotated[Floats, "2 * contacts"]
    matrix: Annotated[Floats, "room"]  # [1/kg]
    answer: Annotated[FloatRows, "touched, 2"]  # [m/s] by particle: velocities by a unit impulse, else 0
    turned: Annotated[Floats, "touched"]  # [m/s] by particle: the same of surfaces


@inner_kernel
def new_active_set(count: int, particles: int, arena: Arena) -> ActiveSet:
    """Room for so many contacts of so many particles."""
    rows = 2 * count
    touched = particles if count > 0 else 0
    # (sum of lengths)^2 <= rows times the sum of their squares.
    room = rows + int(math.sqrt(MOST_PRODUCTS * rows)) + 1 if count > 0 else 0
    return new_tuple(ActiveSet, arena, contacts=count, touched=touched, room=room)


@inner_kernel
def factor_envelope(rows: int, at: ActiveSet) -> None:
    """L D L^T in place: row i of L from first[i] on, D apart."""
    m, first, start, pivot = at.matrix, at.first, at.start, at.pivot
    for i in range(rows):
        si = start[i] - first[i]
        for j in range(first[i], i):
            sj = start[j] - first[j]
            k = max(first[i], first[j])
            # Four sums, which do not wait for each other.
            a = m[si + j]
            b = 0.0
            c = 0.0
            d = 0.0
            while k + 4 <= j:
                a -= m[si + k] * m[sj + k]
                b -= m[si + k + 1] * m[sj + k + 1]
                c -= m[si + k + 2] * m[sj + k + 2]
                d -= m[si + k + 3] * m[sj + k + 3]
                k += 4
            while k < j:
                a -= m[si + k] * m[sj + k]
                k += 1
            # L_ij D_j for now.
            m[si + j] = (a + b) + (c + d)
        whole = m[si + i]
        left = whole
        for j in range(first[i], i):
            held = m[si + j]
            m[si + j] = held / pivot[j] if pivot[j] > 0.0 else 0.0
            left -= held * m[si + j]
        pivot[i] = left if left > SMALLEST_PIVOT * whole else 0.0


@inner_kernel
def solve_envelope(rows: int, at: ActiveSet) -> None:
    """Solve for the right side, in place."""
    m, first, start, pivot, x = at.matrix, at.first, at.start, at.pivot, at.rhs
    for i in range(rows):
        s = start[i] - first[i]
        for j in range(first[i], i):
            x[i] -= m[s + j] * x[j]
    for i in range(rows):
        x[i] = x[i] / pivot[i] if pivot[i] > 0.0 else 0.0
    for i in range(rows - 1, -1, -1):
        s = start[i] - first[i]
        for j in range(first[i], i):
            x[j] -= m[s + j] * x[i]
