"""The slowest wobble of a form: one number, which says how its springs, areas and bends act together.

    S = sum over springs of m_r n n^T + sum over areas and bends of m g g^T, at rest;   S u = a M u

A form that is stiff without pins has three motions as a whole, of a = 0; the next eigenvalue is its lowest mode. It has
no unit: neither size, nor mass, nor Cs, Cd and h are in it.
"""

import hashlib
import math
from typing import NamedTuple

import numpy as np

from sandbox.physics.analysis.energy import measure_constraints, reduced_masses
from sandbox.physics.arrays import FloatRows, Floats, FloatTables, Slots
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.jit import kernel
from sandbox.physics.keeping.forms import StiffForm
from sandbox.physics.solvers.linear.matrix_layout import find_blocks, matrix_of_graph
from sandbox.physics.solvers.linear.sparse_ldl import Matrix, back_substitute, factorise
from sandbox.physics.world import World

# S + SHIFT M is factored, as S itself has no inverse. A higher one slows the iteration down in slender forms, whose
# lowest modes are as small; a lower one loses digits.
SHIFT = 1e-7
# Iterations end where the eigenvalue changes by less than this share, at the latest after ROUNDS. Modes that lie a
# per cent apart change it by a millionth while the wrong one goes.
CONVERGED = 1e-9
ROUNDS = 200
# A form whose lowest mode is below this is not stiff: it moves without any spring being stretched, to first order.
NOT_STIFF = 1e-9
# Forms whose eigenvalue is kept; those of a level, edited one by one, need no more.
KEPT = 256

_kept: dict[bytes, float] = {}


class ConstraintRows(NamedTuple):
    """Springs, areas and bends alike: first (k+1,) = where corners begin, mass (k,); node (q,), gradient (q, 2)."""

    first: Slots
    node: Slots
    gradient: FloatRows
    mass: Floats


@kernel
def _iterate_inversely(
    matrix: Matrix, rows: ConstraintRows, mass: Floats, rigid: FloatTables, vector: FloatRows, right_side: FloatRows,
    rounds: int, converged: float,
) -> float:  # fmt: skip
    # x -> (S + SHIFT M)^-1 M x without its motions as a whole; the Rayleigh quotient x S x / x M x of the last x.
    count = mass.shape[0]
    factorise(0, count, matrix)
    quotient = 0.0
    for _ in range(rounds):
        for k in range(rigid.shape[0]):
            along = 0.0
            whole = 0.0
            for i in range(count):
                along += mass[i] * (rigid[k, i, 0] * vector[i, 0] + rigid[k, i, 1] * vector[i, 1])
                whole += mass[i] * (rigid[k, i, 0] * rigid[k, i, 0] + rigid[k, i, 1] * rigid[k, i, 1])
            share = along / whole if whole > 0.0 else 0.0
            for i in range(count):
                vector[i, 0] -= share * rigid[k, i, 0]
                vector[i, 1] -= share * rigid[k, i, 1]
        square = 0.0
        for i in range(count):
            square += mass[i] * (vector[i, 0] * vector[i, 0] + vector[i, 1] * vector[i, 1])
        if not square > 0.0:
            return 0.0
        size = 1.0 / math.sqrt(square)
        for i in range(count):
            vector[i, 0] *= size
            vector[i, 1] *= size
            right_side[i, 0] = mass[i] * vector[i, 0]
            right_side[i, 1] = mass[i] * vector[i, 1]
        last_quotient = quotient
        quotient = 0.0
        for k in range(rows.mass.shape[0]):
            rate = 0.0
            for c in range(rows.first[k], rows.first[k + 1]):
                i = rows.node[c]
                rate += rows.gradient[c, 0] * vector[i, 0] + rows.gradient[c, 1] * vector[i, 1]
            quotient += rows.mass[k] * rate * rate  # (20)
        if abs(quotient - last_quotient) <= converged * quotient:
            break
        back_substitute(0, count, matrix, right_side)
        for i in range(count):
            vector[i, 0] = right_side[i, 0]
            vector[i, 1] = right_side[i, 1]
    return quotient


def find_lowest_mode(form: StiffForm) -> float:
    """The lowest mode of a form; 0 where it is not stiff without pins.

    By inverse iteration, in + - * / and square roots of a fixed order: part of what makes a run repeatable.
    """
    digest = hashlib.blake2b(digest_size=16)
    for array in (form.points, form.mass, form.pairs, form.areas, form.bends):
        digest.update(f"{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
    key = digest.digest()
    if key not in _kept:
        while len(_kept) >= KEPT:
            del _kept[next(iter(_kept))]
        _kept[key] = _find(form)
    return _kept[key]


def _find(form: StiffForm) -> float:
    points, mass, count = form.points, form.mass, len(form.points)
    rows = rows_of(form)
    # Each pair of corners of a row, once: the one and the other, first by the corners' places in their row.
    sizes = np.diff(rows.first)
    one, other, owner = [], [], []
    for size in np.unique(sizes).tolist():
        chosen = np.flatnonzero(sizes == size)
        for i in range(size):
            for j in range(i + 1):
                one.append(rows.first[chosen] + i)
                other.append(rows.first[chosen] + j)
                owner.append(chosen)
    joined = _CornerPairs(*(np.concatenate([np.zeros(0, np.int64), *part]) for part in (one, other, owner)))
    apart = np.flatnonzero(rows.node[joined.one] != rows.node[joined.other])
    matrix, order, rank = matrix_of_graph(count, rows.node[joined.one[apart]], rows.node[joined.other[apart]])
    _assemble(matrix, rows, joined, mass, rank)
    vector, rigid = _start(points[order], mass[order])
    rows = rows._replace(node=rank[rows.node])
    found = _iterate_inversely(
        matrix, rows, mass[order], rigid, vector, np.zeros((count, 2)), ROUNDS, CONVERGED
    )  # fmt: skip
    return found if found >= NOT_STIFF else 0.0


class _CornerPairs(NamedTuple):
    """Pairs of corners of one row: their places among all corners, and the row."""

    one: Slots
    other: Slots
    owner: Slots


def rows_of(form: StiffForm) -> ConstraintRows:
    """What holds the particles of a form, at their places."""
    world, pairs = World(), form.pairs
    world.add_particles([str(k) for k in range(len(form.points))], form.points, mass=form.mass)
    world.add_springs([str(k) for k in range(len(pairs))], pairs[:, 0], pairs[:, 1])
    for kind, corners in ((AREA, form.areas), (BEND, form.bends)):
        if len(corners):
            world.add_constraints(kind, corners)
    apart = world.position[pairs[:, 1]] - world.position[pairs[:, 0]]
    length = lengths(apart)
    # A spring of no length holds nothing.
    normal = np.divide(apart, length[:, None], out=np.zeros_like(apart), where=length[:, None] > 0.0)
    _, of_constraints, slope = measure_constraints(world)
    sizes = np.concatenate([np.full(len(pairs), 2), world.constraint_corners.astype(np.int64)])
    return ConstraintRows(
        np.append(0, np.cumsum(sizes)),
        np.concatenate([pairs.reshape(-1), world.corner_particle]).astype(np.int64),
        np.concatenate([np.stack([-normal, normal], axis=1).reshape(-1, 2), slope]),
        np.concatenate([reduced_masses(world), of_constraints]),
    )


def _assemble(matrix: Matrix, rows: ConstraintRows, joined: _CornerPairs, mass: Floats, rank: Slots) -> None:
    """Write S + SHIFT M into the matrix."""
    a, b = rank[rows.node[joined.one]], rank[rows.node[joined.other]]
    # The row of the block is the later of the two.
    later, earlier = np.where(a >= b, joined.one, joined.other), np.where(a >= b, joined.other, joined.one)
    g, weighted = rows.gradient[later], rows.mass[joined.owner, None] * rows.gradient[earlier]
    xx, xy, yx, yy = (
        g[:, 0] * weighted[:, 0],
        g[:, 0] * weighted[:, 1],
        g[:, 1] * weighted[:, 0],
        g[:, 1] * weighted[:, 1],
    )
    own = np.flatnonzero(a == b)
    matrix.diagonal[rank] = SHIFT * mass[:, None] * np.array([1.0, 0.0, 1.0])
    np.add.at(matrix.diagonal, a[own], np.stack([xx, xy, yy], axis=1)[own])
    shared = np.flatnonzero(a != b)
    block = np.zeros(len(shared), np.int64)
    find_blocks(a[shared], b[shared], matrix.column_start, matrix.row, block)
    np.add.at(matrix.lower, block, np.stack([xx, xy, yx, yy], axis=1)[shared])


def _start(points: Floats, mass: Floats) -> tuple[Floats, Floats]:
    """A vector (n, 2) that no mode is orthogonal to, and the motions of the whole (3, n, 2)."""
    total, sum_x, sum_y = (np.cumsum(values)[-1] for values in (mass, mass * points[:, 0], mass * points[:, 1]))
    x, y = points[:, 0] - sum_x / total, points[:, 1] - sum_y / total
    largest = max(float(np.abs(x).max()), float(np.abs(y).max()))
    if largest > 0.0:
        x, y = x / largest, y / largest
    zero, one = np.zeros_like(x), np.ones_like(x)
    rigid = np.stack([np.stack(motion, axis=1) for motion in ((one, zero), (zero, one), (-y, x))])
    # Fields of every symmetry that bodies have, and something of everything else.
    uneven = (np.arange(len(x)) * 7 % 13 - 6) / 60.0
    across = x + 0.3 * y + x * x + 0.8 * x * y + 0.6 * y * y + uneven
    up = 0.5 * x - 0.7 * y + 0.9 * x * x + 0.7 * x * y + 0.5 * y * y - uneven[::-1]
    return np.stack([across, up], axis=1), np.ascontiguousarray(rigid)
