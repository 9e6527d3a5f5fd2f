"""Pools, and displacers: what of a world water cannot enter, as its topology decides it.

Bodies with triangles displace those. A hull, the outline of a wheel or of a ring that keeps its area, displaces what it
encloses while none of its springs is cut. All other particles, those of ropes and loose ones, are discs. What was cut
goes on displacing: the corners of a triangle that is no more are discs, each with a third of its area.
"""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.constraints import AREA, TRIANGLE
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL, LINE, NO_EDGE
from sandbox.physics.state import State

# Columns of a pool: left, bottom, right, top [m]; density [kg/m^2]; fast drag, of the square of the speed; slow drag
# [m/s], of the speed; flow [m/s] (2).
LEFT, BOTTOM, RIGHT, TOP, DENSITY, FAST, SLOW, FLOW_X, FLOW_Y, POOL_NUMBERS = range(10)
# Columns of a hull's spring: number of the hull, the spring, and whether what the hull encloses lies on the left of
# its way from the second end to the first.
HULL, SPRING, TURNED, HULL_NUMBERS = range(4)
NO_POOLS: FloatRows = np.zeros((0, POOL_NUMBERS))
NO_HULLS: SlotRows = np.zeros((0, HULL_NUMBERS), np.int64)
# Columns of `load` of a particle: force [N] (2), resistance [kg/s] xx, xy, yy, and that times the flow [N] (2); its own
# mass and inverse mass where water comes along in a step; its velocity [m/s] (2) after the springs.
FX, FY, RXX, RXY, RYY, DX, DY, OWN_MASS, OWN_INVERSE, U, V, LOADS = range(12)
# Columns of `body`, at the label of a body: mass [kg], momentum [kg m/s] (2), force and weight [N] (2); resistance
# [kg/s] xx, xy, yy; about its first particle the sums of m r [kg m] (2), of m r^2 [kg m^2], and the torque [N m]; the
# drag of its motion as a whole [N] (2), and what that takes from the particles [kg m/s] (2); what holds it. What drag
# changes of its velocity [m/s] (2); what lift alone does [m/s], and its angular momentum [kg m^2/s], and which share of
# lift acts where it is. How forces raise it [m/s] and turn it [rad/s] in a step where it would go on as it does; the
# part of that with which its way is looked at, the largest known to be too little, the smallest to be too much, with
# what each is off by; (omega h / 2)^2 of a swing. After the springs [J]: what lift has given too much, and in the end
# what all else has; the energy of its motion; what U has gained; what is allowed; and the work of lift.
MASS, PX, PY, NET_X, NET_Y, BXX, BXY, BYY, MX, MY, MRR, TORQUE, DRAG_X, DRAG_Y, TOOK_X, TOOK_Y = range(16)
HELD, CX, CY, LIFT, LIFT_TURN, SHARE, RISE, TURN, PART, LOW, LOW_MISS, HIGH, HIGH_MISS, SWING = range(16, 30)
EXCESS, MOVES, UNDER, ALLOWED, WORK, SUMS = range(30, 36)
# What holds a body.
BY_CONTACTS, BY_PINS = 1.0, 2.0


class Pool(NamedTuple):
    """Water in a box: left, bottom, right, top [m], of a density [kg/m^2], whose surface is the top.

    fast_drag: a coefficient C; slow_drag [m/s]; flow [m/s]. See push.py.
    """

    box: tuple[float, float, float, float]
    density: float
    fast_drag: float
    slow_drag: float
    flow: tuple[float, float]


class Water(NamedTuple):
    """Pools and hulls of a world, what it displaces, and scratch of a step."""

    pool: FloatRows
    hull: SlotRows
    triangle: Annotated[SlotRows, "constraints, 3"]  # (t, 3): particles
    constraint: Annotated[Slots, "constraints"]  # (t,): the constraint of each, which says how large it is to be
    shell_start: Annotated[Slots, "rows + 1"]  # edges of whole hull o: shell_start[o]:shell_start[o + 1]
    shell_a: Annotated[Slots, "rows"]  # what is enclosed lies on the left of the way from a to b
    shell_b: Annotated[Slots, "rows"]
    shell_share: Annotated[Floats, "rows"]  # by edge: part of what the hull enclosed at first, between edge and middle
    shell_area: Annotated[Floats, "rows"]  # [m^2] (o,): what it enclosed then
    shell_constraint: Annotated[Slots, "rows"]  # (o,): the constraint that says how large it is to be; -1: none
    edge: Annotated[Slots, "springs"]  # springs that are dragged
    sides: Annotated[Floats, "springs"]  # how many sides of each are wet: 2 of a line
    disc: Annotated[Slots, "particles"]
    disc_area: Annotated[Floats, "particles"]  # [m^2]; 0: it has its own radius
    is_bare: Annotated[Flags, "particles"]  # whether a disc is dragged as such, as no edge of it is
    is_joined: Annotated[Flags, "particles"]  # (n,): whether springs or constraints join a particle to anything
    load: Annotated[FloatRows, f"particles, {LOADS}"]  # (n, LOADS)
    body: Annotated[FloatRows, f"particles, {SUMS}"]  # (n, SUMS)
    wet: Annotated[Flags, "particles"]  # (n,)
    due: Annotated[Flags, "particles"]  # (n,): whose lift is looked for
    lifted: Annotated[Floats, "particles"]  # [J] (n,): energy of what is lifted, at one particle of each
    before: Annotated[FloatRows, "particles, 2"]  # [m] (n, 2): where the way of a step begins, as in lift.py, and ends
    after: Annotated[FloatRows, "particles, 2"]
    corner: Annotated[FloatRows, "3, 3"]  # (3, 3): see lift.py


class WaterScratch(NamedTuple):
    """Scratch: by particle: area [m^2] of lost triangles, whether it is in a triangle, has an edge; by owner, see _key:
    whether a whole hull encloses it; by hull: whether it is whole; by spring: whether it is of a whole hull."""

    lost: Annotated[Floats, "particles"]
    in_triangle: Annotated[Flags, "particles"]
    has_edge: Annotated[Flags, "particles"]
    enclosed: Annotated[Flags, "2 * particles"]
    is_whole: Annotated[Flags, "hulls"]
    is_hull: Annotated[Flags, "springs"]


def pools_of(pools: Sequence[Pool]) -> FloatRows:
    """Pools in the array of kernels (w, POOL_NUMBERS)."""
    rows = [(*pool.box, pool.density, pool.fast_drag, pool.slow_drag, *pool.flow) for pool in pools]
    # Adding 0.0 turns -0.0 into 0.0.
    return np.array(rows, np.float64).reshape(-1, POOL_NUMBERS) + 0.0


@inner_kernel
def new_water(state: State, given: Water, arena: Arena) -> Water:
    """Given pools and hulls with what a world displaces at its present topology; nothing of that without a pool."""
    if given.pool.shape[0] == 0:
        return given
    particles, springs, constraints = state.owner.shape[0], state.spring_active.shape[0], state.constraint_kind.shape[0]
    rows = given.hull.shape[0]
    water = new_tuple(
        Water, arena, pool=given.pool, hull=given.hull, particles=particles, springs=springs, constraints=constraints,
        rows=rows,
    )  # fmt: skip
    scratch = mark(arena)
    hulls = water.hull[rows - 1, HULL] + 1 if rows > 0 else 0
    work = new_tuple(WaterScratch, arena, particles=particles, springs=springs, hulls=hulls)
    if is_full(arena):
        return water
    triangles = _list_triangles(state, water, work)
    _find_whole_hulls(state, water.hull, work)
    hulls, edges = _list_shells(state, water, work)
    dragged = _list_edges(state, water, work)
    discs = _list_discs(state, water, work)
    give_back(arena, scratch)
    return Water(
        water.pool, water.hull, water.triangle[:triangles], water.constraint[:triangles],
        water.shell_start[: hulls + 1], water.shell_a[:edges], water.shell_b[:edges], water.shell_share[:edges],
        water.shell_area[:hulls], water.shell_constraint[:hulls], water.edge[:dragged], water.sides[:dragged],
        water.disc[:discs], water.disc_area[:discs], water.is_bare[:discs], water.is_joined, water.load, water.body,
        water.wet, water.due, water.lifted, water.before, water.after, water.corner,
    )  # fmt: skip


@inner_kernel
def _key(state: State, p: int) -> int:
    # Owners are numbers of bodies, or minus 1 minus a particle.
    owner = state.owner[p]
    return owner if owner >= 0 else state.owner.shape[0] - 1 - owner


@inner_kernel
def _list_triangles(state: State, water: Water, work: WaterScratch) -> int:
    count = 0
    for k in range(state.constraint_kind.shape[0]):
        first = state.constraint_first[k]
        for c in range(first, first + state.constraint_corners[k]):
            if state.constraint_active[k]:
                water.is_joined[state.corner_particle[c]] = True
        if state.constraint_kind[k] != AREA or state.constraint_corners[k] != TRIANGLE:
            continue
        p, q, r = state.corner_particle[first], state.corner_particle[first + 1], state.corner_particle[first + 2]
        if state.constraint_active[k]:
            water.triangle[count, 0], water.triangle[count, 1], water.triangle[count, 2] = p, q, r
            water.constraint[count] = k
            count += 1
        third = abs(state.constraint_rest[k, 1]) / 3.0
        for c in range(first, first + TRIANGLE):
            work.in_triangle[state.corner_particle[c]] = True
            if not state.constraint_active[k]:
                work.lost[state.corner_particle[c]] += third
    return count


@inner_kernel
def _find_whole_hulls(state: State, hull: SlotRows, work: WaterScratch) -> None:
    for row in range(hull.shape[0]):
        work.is_whole[hull[row, HULL]] = True
    for row in range(hull.shape[0]):
        if not state.spring_active[hull[row, SPRING]]:
            work.is_whole[hull[row, HULL]] = False
    for row in range(hull.shape[0]):
        s = hull[row, SPRING]
        if work.is_whole[hull[row, HULL]]:
            work.is_hull[s] = True
            # Where a weld makes one particle of two, one end belongs to another body.
            key = _key(state, state.particle_a[s])
            if key == _key(state, state.particle_b[s]):
                work.enclosed[key] = True


@inner_kernel
def _list_shells(state: State, water: Water, work: WaterScratch) -> tuple[int, int]:
    # How many whole hulls there are, and how many edges they have.
    hull, shells, count = water.hull, 0, 0
    for row in range(hull.shape[0]):
        if not work.is_whole[hull[row, HULL]]:
            continue
        if row == 0 or hull[row, HULL] != hull[row - 1, HULL]:
            water.shell_start[shells] = count
            shells += 1
        s, turned = hull[row, SPRING], hull[row, TURNED] != 0
        water.shell_a[count] = state.particle_b[s] if turned else state.particle_a[s]
        water.shell_b[count] = state.particle_a[s] if turned else state.particle_b[s]
        count += 1
    water.shell_start[shells] = count
    for o in range(shells):
        _measure_shell(state, water, o)
    return shells, count


@inner_kernel
def _measure_shell(state: State, water: Water, o: int) -> None:
    # A hull as triangles from its middle to each edge; those of a hollow count negative.
    first, last, origin = water.shell_start[o], water.shell_start[o + 1], state.origin
    x, y, area = 0.0, 0.0, 0.0
    for e in range(first, last):
        x += origin[water.shell_a[e], 0] / (last - first)
        y += origin[water.shell_a[e], 1] / (last - first)
    for e in range(first, last):
        a, b = water.shell_a[e], water.shell_b[e]
        part = (origin[a, 0] - x) * (origin[b, 1] - y) - (origin[b, 0] - x) * (origin[a, 1] - y)
        water.shell_share[e] = 0.5 * part
        area += 0.5 * part
    for e in range(first, last):
        water.shell_share[e] = water.shell_share[e] / area if area > 0.0 else 0.0
    water.shell_area[o] = max(area, 0.0)
    water.shell_constraint[o] = -1
    for k in range(state.constraint_kind.shape[0]):
        is_area = state.constraint_kind[k] == AREA and state.constraint_active[k]
        begins = is_area and state.corner_particle[state.constraint_first[k]] == water.shell_a[first]
        if begins and state.constraint_corners[k] == last - first:
            water.shell_constraint[o] = k


@inner_kernel
def _list_edges(state: State, water: Water, work: WaterScratch) -> int:
    # How many springs are dragged. What a hull encloses is dry.
    count = 0
    for s in range(state.spring_active.shape[0]):
        if not state.spring_active[s] or state.material[s] == GRAB_MATERIAL:
            continue
        a, b = state.particle_a[s], state.particle_b[s]
        water.is_joined[a] = water.is_joined[b] = True
        if state.edge[s] == NO_EDGE:
            continue
        is_outside = work.is_hull[s] or state.edge[s] != LINE
        if not is_outside and work.enclosed[_key(state, a)] and work.enclosed[_key(state, b)]:
            continue
        water.edge[count] = s
        water.sides[count] = 1.0 if is_outside else 2.0
        work.has_edge[a] = work.has_edge[b] = True
        count += 1
    return count


@inner_kernel
def _list_discs(state: State, water: Water, work: WaterScratch) -> int:
    count = 0
    for p in range(state.owner.shape[0]):
        if not state.particle_active[p] or not state.inverse_mass[p] > 0.0:
            continue
        is_full = work.in_triangle[p] or work.enclosed[_key(state, p)]
        if not work.lost[p] > 0.0 and is_full:
            continue
        water.disc[count] = p
        water.disc_area[count] = work.lost[p]
        water.is_bare[count] = not work.has_edge[p]
        count += 1
    return count
