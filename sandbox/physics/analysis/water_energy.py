"""Energy of the water that a world displaces [J], which is water lifted to the surface; no tick depends on it."""

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, Arena, begin, lay_out
from sandbox.physics.arrays import with_empty
from sandbox.physics.jit import Bundle, bundle, inner_kernel, kernel, unpack
from sandbox.physics.state import State, state_of
from sandbox.physics.water.displacers import Water, lay_out_water
from sandbox.physics.water.pools import BOTTOM, DENSITY, LEFT, RIGHT, TOP
from sandbox.physics.water.push import area_of, middle_of
from sandbox.physics.water.wet_parts import PI, disc_depth, mean_depth
from sandbox.physics.world import World


class WaterPlace(NamedTuple):
    """A world's state, and where what it displaces is put."""

    state: State
    water: Water


@kernel
def _derive_water(pointer: Bundle[WaterPlace], arena: Arena) -> None:
    place = unpack(pointer)
    begin(arena)
    lay_out_water(place.state, arena, place.water)


@inner_kernel
def _of_triangle(water: Water, k: int, i: int, state: State) -> float:
    pool, x = water.pool, state.position
    p, q, r = water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2]
    middle = (x[p, 0] + x[q, 0] + x[r, 0]) / 3.0
    if not (pool[k, LEFT] <= middle and middle <= pool[k, RIGHT]):
        return 0.0
    if not x[p, 1] + x[q, 1] + x[r, 1] >= 3.0 * pool[k, BOTTOM]:
        return 0.0
    top = pool[k, TOP]
    depth = mean_depth(top - x[p, 1], top - x[q, 1], top - x[r, 1])
    return depth * abs(state.constraint_rest[water.constraint[i], 0])


@inner_kernel
def _of_shell(water: Water, k: int, o: int, state: State) -> float:
    pool, y, total = water.pool, state.position, 0.0
    middle_x, middle_y = middle_of(water, o, y)
    if not (pool[k, LEFT] <= middle_x and middle_x <= pool[k, RIGHT] and pool[k, BOTTOM] <= middle_y):
        return 0.0
    for e in range(water.shell_start[o], water.shell_start[o + 1]):
        a, b, top = water.shell_a[e], water.shell_b[e], pool[k, TOP]
        total += water.shell_share[e] * mean_depth(top - middle_y, top - y[a, 1], top - y[b, 1])
    return area_of(water, o, state) * total


@inner_kernel
def _of_disc(water: Water, k: int, i: int, state: State) -> float:
    pool, p, area = water.pool, water.disc[i], water.disc_area[i]
    radius = math.sqrt(area / PI) if area > 0.0 else state.radius[p]
    x, y = state.position[p, 0], state.position[p, 1]
    if not (pool[k, LEFT] <= x and x <= pool[k, RIGHT] and pool[k, BOTTOM] <= y and radius > 0.0):
        return 0.0
    return disc_depth(pool[k, TOP] - y, radius)


@kernel
def _energy(pointer: Bundle[WaterPlace], g: float) -> float:
    place = unpack(pointer)
    state, water, total = place.state, place.water, 0.0
    for k in range(water.pool.shape[0]):
        volume = 0.0
        for i in range(water.triangle.shape[0]):
            volume += _of_triangle(water, k, i, state)
        for o in range(water.shell_start.shape[0] - 1):
            volume += _of_shell(water, k, o, state)
        for i in range(water.disc.shape[0]):
            volume += _of_disc(water, k, i, state)
        total += water.pool[k, DENSITY] * g * volume
    return total


def _place_of(world: World) -> Any:
    water = with_empty(Water, pool=world.water, hull=world.hulls)
    pointer = bundle(with_empty(WaterPlace, state=state_of(world), water=water))
    lay_out(_derive_water, pointer, np.zeros(FIRST_ARENA, np.int64))
    return pointer


def water_energy(world: World) -> float:
    """Energy [J] of the water that a world's bodies, hulls and discs have lifted to the surface; 0 without water."""
    if not len(world.water):
        return 0.0
    return float(_energy(world.derived(_place_of, of_hands=False), max(0.0, -world.settings.gravity[1])))
