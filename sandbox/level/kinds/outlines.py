"""Outlines: which springs of a body others meet as its edges."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.kinds.bodies import AnyBody, BoxShape, JellyDef
from sandbox.level.kinds.shapes import Pairs, box_grid, jelly_cells
from sandbox.physics.collision.outline import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT


def edges(body: AnyBody, pairs: Pairs) -> NDArray[np.int8]:
    """Kind of edge (m,) of each of a body's springs, given as pairs (m, 2) of its particles.

    A jelly is solid: its edges are the sides of the squares and triangles of its grid that belong to one of them
    alone. Every spring of another body is a line with two sides.
    """
    if not isinstance(body, JellyDef):
        return np.full(len(pairs), LINE, dtype=np.int8)
    numbers = _numbers(body)
    sides, inner = _sides(numbers)
    count = int(numbers.max(initial=0)) + 1
    there, back = pairs[:, 0] * count + pairs[:, 1], pairs[:, 1] * count + pairs[:, 0]
    left, right = np.isin(there, sides), np.isin(back, sides)
    hidden = np.isin(there, inner) | np.isin(back, inner) | (left & right)
    kind = np.where(left, SOLID_LEFT, np.where(right, SOLID_RIGHT, LINE))
    return np.where(hidden, NO_EDGE, kind).astype(np.int8)


def _numbers(body: JellyDef) -> Pairs:
    """Particles of a jelly on its grid (rows, columns), -1 where there is none."""
    if isinstance(body.shape, BoxShape):
        columns, rows = box_grid(body)
        return np.arange(columns * rows).reshape(rows, columns)
    cells = jelly_cells(body)
    numbers = np.full(cells.shape, -1, dtype=np.int64)
    numbers[cells] = np.arange(np.count_nonzero(cells))
    return numbers


def _sides(numbers: Pairs) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Keys a n + b of the sides a to b of squares and triangles, counter-clockwise, and of whole squares' diagonals."""
    count = int(numbers.max(initial=0)) + 1
    # Corners counter-clockwise from the bottom left.
    corners = np.stack([numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]], axis=-1).reshape(-1, 4)
    present = corners >= 0
    full = corners[present.all(axis=1)]
    sides = [full[:, [k, (k + 1) % 4]] for k in range(4)]
    for missing in range(4):
        three = corners[(present.sum(axis=1) == 3) & ~present[:, missing]]
        around = [(missing + k) % 4 for k in (1, 2, 3)]
        sides += [three[:, [around[k], around[(k + 1) % 3]]] for k in range(3)]
    directed = np.concatenate(sides)
    inner = np.concatenate([full[:, [0, 2]], full[:, [1, 3]]])
    return directed[:, 0] * count + directed[:, 1], inner[:, 0] * count + inner[:, 1]
