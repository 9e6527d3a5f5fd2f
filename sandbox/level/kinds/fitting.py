"""Fitted meshes: particles at equal distances on an outline, even triangles inside, and empty holes."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from sandbox.level.format.limits import POLYGON_WORK_LIMIT, SPACING_RANGE
from sandbox.level.kinds.geometry import Pairs, Points, spokes
from sandbox.level.kinds.polygon import Corners, rows_of
from sandbox.physics.arena import answer_of
from sandbox.physics.meshing import fitting

Loop = tuple[tuple[float, float], ...]
# Corners [m] in order, or the radius [m] of a circle about [0, 0].
Outline = Loop | float

# A disc of this many rings is beyond every limit.
RING_LIMIT = 1e4


class FittedMesh(NamedTuple):
    """Places [m] (n, 2), those on borders first; triangles (t, 3), counter-clockwise, and their sides (m, 2)."""

    places: Points
    triangles: Pairs
    pairs: Pairs


class TooCoarse(ValueError):
    """The spacing is too large for an outline: sides would touch, or triangles would be slivers."""


def disc_rings(radius: Any, spacing: float) -> int:
    """Number of rings of particles of a disc, around its centre."""
    return max(1, round(min(radius / spacing, RING_LIMIT)))


def disc_counts(rings: int) -> tuple[int, int]:
    """Particles and springs of a disc of that many rings."""
    return 1 + 3 * rings * (rings + 1), 3 * rings * (3 * rings + 1)


def corners_of(outline: Outline, spacing: float) -> Loop:
    """Corners [m] of an outline; for a circle, the corners of its mesh."""
    if isinstance(outline, tuple):
        return outline
    return tuple((x, y) for x, y in (outline * spokes(0.0, 6 * disc_rings(outline, spacing))).tolist())


def disc_mesh(radius: float, rings: int) -> FittedMesh:
    """The mesh of a disc: ring k around the centre has 6 k particles; from the border inwards."""
    firsts = [disc_counts(rings)[0] - disc_counts(ring)[0] for ring in range(rings + 1)]
    places = [radius * (ring / rings) * spokes(0.0, 6 * ring) for ring in range(rings, 0, -1)]
    triangles = []
    for ring in range(rings, 0, -1):
        outer, inner = firsts[ring], firsts[ring - 1]
        for sector in range(6):
            for step in range(ring):
                a = outer + sector * ring + step
                b = outer + (sector * ring + step + 1) % (6 * ring)
                within = max(6 * (ring - 1), 1)
                c = inner + (sector * (ring - 1) + step) % within
                triangles.append((a, b, c))
                if step < ring - 1:
                    triangles.append((b, inner + (sector * (ring - 1) + step + 1) % within, c))
    made = np.array(triangles, dtype=np.int64)
    return FittedMesh(np.concatenate([*places, np.zeros((1, 2))]), made, _sides_of(made))


def _sides_of(triangles: Pairs) -> Pairs:
    """Pairs (m, 2) of corners of triangles, each once, the lower first, in order."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


@lru_cache(maxsize=32)
def fitted_mesh(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> FittedMesh:
    """The mesh of a simple outline [m] with separate holes inside it. Raises TooCoarse."""
    if not isinstance(outline, tuple) and not holes:
        return disc_mesh(outline, disc_rings(outline, spacing))
    loops = rows_of([corners_of(outline, spacing), *holes])
    # The corners of a circle are particles already.
    is_sampled = isinstance(outline, tuple)
    code, arena = answer_of(fitting.mesh_loops, fitting.USUAL_ARENA, *loops, spacing, is_sampled)
    if code != fitting.FITS:
        raise TooCoarse
    found = fitting.found_in(arena)
    return FittedMesh(found.places, found.triangles, found.pairs)


def fitting_spacing(
    outline: Outline,
    holes: tuple[Loop, ...],
    spacing: float,
    most: float = POLYGON_WORK_LIMIT / fitting.PARTICLE_WORK,
) -> float | None:
    """The spacing [m], or the first smaller one that fits; None if that takes more than `most` particles."""
    for tries in range(fitting.TRIES):
        finer = fitting.finer_spacing(spacing, tries)
        if fitted_work(outline, holes, finer) > most * fitting.PARTICLE_WORK or finer < SPACING_RANGE[0]:
            return None
        try:
            fitted_mesh(outline, holes, finer)
        except TooCoarse:
            continue
        return finer
    return None


def fitted_work(outline: Outline, holes: tuple[Loop, ...], spacing: float) -> int:
    """An estimate of the work for the mesh of an outline [m] with holes, in the unit of the limit of polygons."""
    loops: list[Corners] = [corners_of(outline, spacing), *holes]
    return int(fitting.mesh_work(*rows_of(loops), spacing))
