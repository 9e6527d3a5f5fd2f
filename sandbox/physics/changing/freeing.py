"""Freeing: puts a body that is stuck in others, or in itself, into the nearest free place.

For bodies that do not come apart by themselves (untangling/parting.py). Not part of a tick: a person asks for it.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.collision.outline import Outline
from sandbox.physics.components import body_of
from sandbox.physics.geometry.polygon import signed_area, winding_number
from sandbox.physics.geometry.rigid import fitted
from sandbox.physics.geometry.segment import distances_from_segments, segments_cross
from sandbox.physics.marks import BANK_UNOPENED
from sandbox.physics.pipeline.block_owner import block_of, outline_of
from sandbox.physics.world import World

# Places are tried on rings, each so many radii of a particle farther away, in so many directions.
RING, DIRECTIONS = 2.0, 24
RINGS = 400
# How far what is free is from all else, in units of what touches: a little more than nothing, so that rounding does not
# decide.
CLEAR = 1.01
# Particles or edges of a body that are compared at once with all that is near: arrays of this many rows.
BATCH = 64


class NothingFree(Exception):
    """There is no free place near by."""


def overlapping(world: World) -> list[tuple[int, int]]:
    """The pairs of bodies that lay in each other in the last step, by a particle of each; twice the same: in itself.

    Lines that cross lines do not count.
    """
    if not world.has_contacts:
        return []
    collisions = block_of(world).arrays.collisions
    outline, colliders = collisions.outline, collisions.colliders
    shapes = colliders.parted[: colliders.parted_count[0], :2]
    first = outline.member[outline.member_start[:-1]]
    is_solid = outline.solid_of >= 0
    return [(int(first[s]), int(first[t])) for s, t in shapes.tolist() if is_solid[s] or is_solid[t]]


def free_body(world: World, particle: int) -> None:
    """Move the body of a particle to the nearest place where it touches nothing, at rest and in its own form.

    One solid body gets the form that it was made in; several bodies that hang together keep their present shape. Raises
    NothingFree, and as `body_of` does.
    """
    body = body_of(world, particle)
    places = world.position[body] + 0.0
    if _is_one_solid(world, body):
        places = fitted(world.origin[body], places)
    surroundings = _Surroundings(world, body)
    for way in _ways(RING * max(float(world.radius[body].max()), 1e-3)):
        if surroundings.are_clear_of(places + way):
            world.change("position", places + way, body)
            world.change("velocity", 0.0, body)
            world.slow_velocity[body] = 0.0
            world.energy_bank[body] = BANK_UNOPENED
            return
    raise NothingFree


def _is_one_solid(world: World, body: Slots) -> bool:
    outline = outline_of(world)
    shape = outline.shape[body]
    return len(set(world.owner[body].tolist())) == 1 and shape[0] >= 0 and bool(outline.solid_of[shape[0]] >= 0)


def _ways(ring: float) -> list[Floats]:
    """Ways [m] to try, the shortest first."""
    ways = [np.zeros(2)]
    # Rounded, so that no library's sine decides where a body goes.
    turns = [(round(math.cos(math.tau * k / DIRECTIONS), 9), round(math.sin(math.tau * k / DIRECTIONS), 9))
             for k in range(DIRECTIONS)]  # fmt: skip
    for far in range(1, RINGS + 1):
        ways += [np.array(turn) * (ring * far) for turn in turns]
    return ways


class _Surroundings:
    """What a body may touch: the other particles and edges, and terrain."""

    def __init__(self, world: World, body: Slots) -> None:
        outline = outline_of(world)
        own = np.zeros(len(outline.owner), dtype=np.bool_)
        own[body] = True
        count, edges = world.particle_count, outline.dynamic[0]
        vertices = np.concatenate([world.position, world.terrain.vertex])
        radius = np.append(world.radius, np.zeros(len(world.terrain.vertex)))
        mine = own[outline.edge_a[:edges]] & own[outline.edge_b[:edges]]
        other = np.append(~mine, np.ones(len(outline.edge_a) - edges, dtype=np.bool_))
        self.outline = outline
        self.row = np.full(len(outline.owner), -1)
        self.row[body] = np.arange(len(body))
        self.own_a, self.own_b = (self.row[ends[:edges][mine]] for ends in (outline.edge_a, outline.edge_b))
        a, b = outline.edge_a[other], outline.edge_b[other]
        self.start, self.end, self.reach = vertices[a], vertices[b], radius[a]
        touching = world.particle_active & (world.collides != 0) & ~own[:count]
        self.discs, self.disc_reach = world.position[touching], world.radius[touching]
        self.radius = world.radius[body]
        self.solids = [_solid(outline, vertices, k) for k in range(len(outline.solid)) if not _is_own(outline, k, own)]
        self.own_solids = [k for k in range(int(outline.dynamic[1])) if _is_own(outline, k, own)]

    def are_clear_of(self, places: Floats) -> bool:
        """Whether a body at these places [m] touches nothing, and nothing is inside of it or round it."""
        # Of places beyond walls there are most, and they are found at once.
        if any(winding_number(places[0], a, b) != outside for a, b, outside in self.solids):
            return False
        low, high = places.min(axis=0) - 2.0 * self.radius.max(), places.max(axis=0) + 2.0 * self.radius.max()
        near = np.all((np.maximum(self.start, self.end) >= low - self.reach[:, None])
                      & (np.minimum(self.start, self.end) <= high + self.reach[:, None]), axis=1)  # fmt: skip
        start, end, reach = self.start[near], self.end[near], self.reach[near]
        around = np.all((self.discs >= low - self.disc_reach[:, None])
                        & (self.discs <= high + self.disc_reach[:, None]), axis=1)  # fmt: skip
        discs, disc_reach = self.discs[around], self.disc_reach[around]
        for some in _batches(len(places)):
            place, radius = places[some, None], self.radius[some, None]
            if np.any(distances_from_segments(place, start, end) < CLEAR * (radius + reach)):
                return False
            if np.any(distances_from_segments(place, discs, discs) < CLEAR * (radius + disc_reach)):
                return False
        own = float(self.radius.max())
        for some in _batches(len(self.own_a)):
            a, b = places[self.own_a[some], None], places[self.own_b[some], None]
            if np.any(segments_cross(a, b, start, end)):
                return False
            if np.any(distances_from_segments(discs, a, b) < CLEAR * (own + disc_reach)):
                return False
        loops = [_own_loop(self.outline, k, self.row, places) for k in self.own_solids]
        return not any(winding_number(disc, a, b) != 0 for disc in discs for a, b in loops)


def _batches(count: int) -> Iterator[slice]:
    """Slices of so many, each of few enough for an array of what each has to do with all that is near."""
    return (slice(first, first + BATCH) for first in range(0, count, BATCH))


def _is_own(outline: Outline, k: int, own: NDArray[np.bool_]) -> bool:
    return bool(own[outline.edge_a[outline.solid[k, 0]]])


def _solid(outline: Outline, vertices: Floats, k: int) -> tuple[Floats, Floats, int]:
    """The edges of a solid, and how often they run round what is outside of it."""
    edges = _sides(outline, k)
    a, b = vertices[outline.edge_a[edges]], vertices[outline.edge_b[edges]]
    # A hollow chain runs the other way round, and its outside is inside of it.
    return a, b, 0 if signed_area(a, b) >= 0.0 else -1


def _sides(outline: Outline, k: int) -> Slots:
    edges = np.arange(*outline.solid[k])
    return edges[outline.side[edges] != 0]


def _own_loop(outline: Outline, k: int, row: Slots, places: Floats) -> tuple[Floats, Floats]:
    edges = _sides(outline, k)
    return places[row[outline.edge_a[edges]]], places[row[outline.edge_b[edges]]]
