"""The triangle clamp, the last phase of a step: after any solver, no triangle of an area turns over in the step.

A jelly of which no triangle is turned over at the start of a step has none at the end, at any Cs and Cd, in every
solver. Nor do those about a particle of its outline close round that and go on (jellies.py): the gap that they leave,
between the one before and the next one on the outline, is a triangle too, and as long as it is narrow it may not turn
over either. What would turn over moves more as one: its rigid motion is left of it, which keeps momentum and angular
momentum and has the least kinetic energy of all motions that do. Only what terrain or a pin holds stops instead. Let go
are jellies that are inverted already (jellies.py), until they have found back, and triangles of a pin that is moved.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import Arena, give_back, is_full, mark, new_flags, new_slots, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, SlotRows, Slots
from sandbox.physics.collision.tunnelling import stop_at_terrain, stopped
from sandbox.physics.components import root_of, united
from sandbox.physics.geometry.rigid import RigidMotion, WeightedSums, centre_of, velocity_at, with_point, with_turn
from sandbox.physics.geometry.segment import doubled_area_of
from sandbox.physics.jit import inlined_kernel, inner_kernel, set_field
from sandbox.physics.marks import TERRAIN_GROUP
from sandbox.physics.state import State
from sandbox.physics.terrain import Terrain
from sandbox.physics.topology.sorting import list_by_key
from sandbox.physics.untangling.jellies import Inversions, Triangles, find_inverted, new_inversions, triangles_of

# A step leaves a triangle at least this share of the area wanted, or of the area that it has, if that is less. Higher
# stiffens what is merely squeezed, lower lets triangles be pressed flat in fewer steps.
LEAST_AREA = 0.05
LEAST_AREA_KEPT = 0.5
# Below this share of the area wanted a triangle keeps what it has, but for rounding: halved in each step under a load,
# its area would be rounding within a second, and then its sign is luck.
FLATTEST = 0.01
FLAT_SHARE = 1.0 - 1e-6
# Sweeps over all triangles in a round, and rounds with terrain between them; each sweep asks for this much less. What
# still falls below LAST_SHARE of what was asked for is joined.
SWEEPS = 20
ROUNDS = 3
RELAXED = 0.01
LAST_SHARE = 0.0625
# Halvings of a triangle's own motion before there is none.
HALVINGS = 10
# What a clamp did: nothing, slow triangles down in themselves, join some so that they move as one.
AS_IT_WAS, SLOWED, JOINED = range(3)
# Columns of `sums`: mass [kg], centre [m], velocity [m/s], moment of inertia [kg m^2] and spin [kg m^2/s] of what moves
# as one; how many particles it has.
MASS, X, Y, U, V, INERTIA, SPIN, COUNT = range(8)


class ClampedTriangles(NamedTuple):
    """Triangles of areas and the rows that they join, particles of a world or rows of a system."""

    corner: Annotated[SlotRows, "triangles, 3"]  # (k, 3): rows, of gaps too, each after a triangle beside it
    gap: Annotated[Flags, "triangles"]  # (k,): which are gaps
    group: Annotated[Slots, "triangles"]  # (k,): the jelly
    constraint: Annotated[Slots, "triangles"]  # (k,): of the triangle
    start: Annotated[Slots, "rests + 1"]  # triangles of constraint t: corner[start[t]:start[t + 1]]
    rest: FloatRows  # [m^2] (t, 2): area wanted and of the form
    position: FloatRows  # [m] by row (n,), as all down to collides
    velocity: FloatRows  # [m/s]: is clamped
    mass: Floats  # [kg]
    inverse_mass: Floats  # [1/kg]
    collides: Annotated[Slots, "rows"]  # of corners, 0 of all others
    inverted: Flags  # by jelly: let go
    label: Annotated[Slots, "rows"]  # scratch, as the two below: what a row moves as one with
    fixed: Annotated[Flags, "rows"]  # what cannot move
    sums: Annotated[FloatRows, f"rows, {COUNT} + 1"]
    terrain: Terrain


class WorldTriangles(NamedTuple):
    """The triangles of a world, over its particles: as they are clamped, and their jellies; marked (n,): scratch."""

    clamped: ClampedTriangles
    of_world: Triangles
    found: Inversions
    marked: Flags


@inner_kernel
def clamp_world(triangles: WorldTriangles, matches: bool, h: float) -> None:
    """Clamp the velocities of a world so that they turn no triangle over in h [s]; terrain's clamp was before.

    matches: whether the solver draws inverted jellies to their form, and has held triangles already.
    """
    clamped = triangles.clamped
    count = clamped.group.shape[0]
    for g in range(clamped.inverted.shape[0]):
        clamped.inverted[g] = False
    # A solver that has done this itself may have gone as far as to the last share.
    if _any_missing(0, count, clamped, LAST_SHARE if matches else 1.0, h):
        # Which jellies are inverted; where nothing matches their shape, what is merely wound twice stays as it is.
        found = triangles.found
        find_inverted(clamped.position, clamped.rest, triangles.of_world, found, triangles.marked)
        if not matches:
            for g in range(found.is_inverted.shape[0]):
                found.is_inverted[g] = False
            for k in range(clamped.group.shape[0]):
                t = clamped.constraint[k]
                inside = not clamped.gap[k] and clamped.rest[t, 0] * clamped.rest[t, 1] > 0.0
                if inside and not _area_now(k, clamped) > 0.0:
                    found.is_inverted[clamped.group[k]] = True
        clamp_triangles(0, clamped.rest.shape[0], 0, clamped.position.shape[0], clamped, h)


@inner_kernel
def _any_missing(first: int, last: int, triangles: ClampedTriangles, ratio: float, h: float) -> bool:
    found = False
    for k in range(first, last):
        if _missing(k, triangles, ratio, h) > 0.0:
            found = True
            break
    return found


@inner_kernel
def _missing(k: int, triangles: ClampedTriangles, ratio: float, h: float) -> float:
    # The area that a triangle is to be left, where it will not be; 0: it will, or has been let go.
    if triangles.inverted[triangles.group[k]]:
        return 0.0
    least = _least_area(k, triangles, ratio)
    missing = least > 0.0 and _area_left(k, triangles, h) < least
    # A gap may open beyond a straight line, where its area is below 0 too.
    if not missing or (triangles.gap[k] and _opens(k, triangles, h)):
        return 0.0
    return least


@inner_kernel
def _least_area(k: int, triangles: ClampedTriangles, ratio: float) -> float:
    # What the area is to be at the end of the step, or that share of it; 0: it may be anything.
    now = _area_now(k, triangles)
    t = triangles.constraint[k]
    rest = abs(triangles.rest[t, 0])
    if not (now > 0.0 and triangles.rest[t, 0] * triangles.rest[t, 1] > 0.0):
        return 0.0
    for i in range(3):
        p = triangles.corner[k, i]
        if triangles.inverse_mass[p] == 0.0 and (triangles.velocity[p, 0] != 0.0 or triangles.velocity[p, 1] != 0.0):
            return 0.0
    if now < FLATTEST * rest:
        return FLAT_SHARE * now
    return ratio * min(LEAST_AREA * rest, LEAST_AREA_KEPT * now)


@inlined_kernel
def _area_now(k: int, triangles: ClampedTriangles) -> float:
    # The area at the start of the step, turned positive as the one wanted is.
    corner = triangles.corner
    area = 0.5 * doubled_area_of(corner[k, 0], corner[k, 1], corner[k, 2], triangles.position)
    return area if triangles.rest[triangles.constraint[k], 0] > 0.0 else -area


@inlined_kernel
def _area_left(k: int, triangles: ClampedTriangles, h: float) -> float:
    # The area at x + h v, likewise.
    x = triangles.position
    v = triangles.velocity
    a = triangles.corner[k, 0]
    b = triangles.corner[k, 1]
    c = triangles.corner[k, 2]
    bx = x[b, 0] - x[a, 0] + h * (v[b, 0] - v[a, 0])
    by = x[b, 1] - x[a, 1] + h * (v[b, 1] - v[a, 1])
    cx = x[c, 0] - x[a, 0] + h * (v[c, 0] - v[a, 0])
    cy = x[c, 1] - x[a, 1] + h * (v[c, 1] - v[a, 1])
    area = 0.5 * (bx * cy - by * cx)
    return area if triangles.rest[triangles.constraint[k], 0] > 0.0 else -area


@inner_kernel
def _opens(k: int, triangles: ClampedTriangles, h: float) -> bool:
    # Whether a gap that loses its area on the way to x + h v becomes a straight line there, and is not closed.
    x, v = triangles.position, triangles.velocity
    a = triangles.corner[k, 0]
    b = triangles.corner[k, 1]
    c = triangles.corner[k, 2]
    bx, by, cx, cy = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[c, 0] - x[a, 0], x[c, 1] - x[a, 1]
    ux, uy, wx, wy = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[c, 0] - v[a, 0], v[c, 1] - v[a, 1]
    # The first time at which now + p t + q t^2 is 0, if it comes.
    now = bx * cy - by * cx
    sign = 1.0 if now > 0.0 else -1.0
    p = sign * (bx * wy - by * wx + ux * cy - uy * cx)
    q = sign * (ux * wy - uy * wx)
    square = p * p - 4.0 * sign * now * q
    root = math.sqrt(square) - p if square > 0.0 else 0.0
    t = min(h, 2.0 * sign * now / root) if root > 0.0 else h
    return (bx + t * ux) * (cx + t * wx) + (by + t * uy) * (cy + t * wy) <= 0.0


@inner_kernel
def clamp_triangles(begin: int, end: int, low: int, high: int, triangles: ClampedTriangles, h: float) -> int:
    """Clamp velocities so that no triangle of constraints begin..end turns over in h [s]: AS_IT_WAS, SLOWED or JOINED.

    low, high: the rows that triangles join lie there, but for pinned ones. Where anything is changed, none of them
    crosses terrain.
    """
    first = triangles.start[begin]
    last = triangles.start[end]
    if not _any_missing(first, last, triangles, 1.0, h):
        return AS_IT_WAS
    return _hold_areas(first, last, low, high, triangles, h)


@inner_kernel
def _hold_areas(
    first: int, last: int, low: int, high: int, triangles: ClampedTriangles, h: float
) -> int:  # fmt: skip
    _sweep(first, last, triangles, 0, h)
    _stop_at_terrain(low, high, triangles, h)
    for round_ in range(1, ROUNDS):
        if not _sweep(first, last, triangles, SWEEPS * round_, h):
            return SLOWED
        _stop_at_terrain(low, high, triangles, h)
    # Each time round more is joined or held, so this ends; what moves as one, or not at all, neither turns a triangle
    # over nor crosses terrain.
    # Nothing moves as one with anything else.
    for r in range(low, high):
        triangles.label[r] = r
        triangles.fixed[r] = triangles.inverse_mass[r] == 0.0
    done = SLOWED
    while _join(first, last, triangles, h):
        done = JOINED
        _move_as_one(low, high, triangles)
        while _hold_at_terrain(low, high, triangles, h):
            _move_as_one(low, high, triangles)
    return done


@inner_kernel
def _sweep(first: int, last: int, triangles: ClampedTriangles, begun: int, h: float) -> bool:
    # Sweeps over triangles, of which `begun` were made before, until none is too small; whether any was.
    found = False
    for sweep in range(begun, begun + SWEEPS):
        again = False
        for k in range(first, last):
            least = _missing(k, triangles, 1.0 - RELAXED * sweep, h)
            if least > 0.0:
                if not (triangles.gap[k] and _hold_open(k, triangles, least, h)):
                    _draw_together(k, triangles, least, h)
                again = True
        if not again:
            break
        found = True
    return found


@inner_kernel
def _hold_open(k: int, triangles: ClampedTriangles, least: float, h: float) -> bool:
    # Take from the corners of a gap, along the gradient of its area, what closes it, so that they may slide past each
    # other; whether that does, and adds no energy. Drawn together, an edge that lies along another could not shorten.
    x, v, w = triangles.position, triangles.velocity, triangles.inverse_mass
    a = triangles.corner[k, 0]
    b = triangles.corner[k, 1]
    c = triangles.corner[k, 2]
    sign = 1.0 if triangles.rest[triangles.constraint[k], 0] > 0.0 else -1.0
    gax, gay = sign * (x[b, 1] - x[c, 1]), sign * (x[c, 0] - x[b, 0])
    gbx, gby = sign * (x[c, 1] - x[a, 1]), sign * (x[a, 0] - x[c, 0])
    gcx, gcy = sign * (x[a, 1] - x[b, 1]), sign * (x[b, 0] - x[a, 0])
    # v + t w g leaves the area that is left now, and p t + q t^2.
    bx, by = x[b, 0] - x[a, 0] + h * (v[b, 0] - v[a, 0]), x[b, 1] - x[a, 1] + h * (v[b, 1] - v[a, 1])
    cx, cy = x[c, 0] - x[a, 0] + h * (v[c, 0] - v[a, 0]), x[c, 1] - x[a, 1] + h * (v[c, 1] - v[a, 1])
    dbx, dby = h * (w[b] * gbx - w[a] * gax), h * (w[b] * gby - w[a] * gay)
    dcx, dcy = h * (w[c] * gcx - w[a] * gax), h * (w[c] * gcy - w[a] * gay)
    p = 0.5 * sign * (bx * dcy - by * dcx + dbx * cy - dby * cx)
    q = 0.5 * sign * (dbx * dcy - dby * dcx)
    missing = least - _area_left(k, triangles, h)
    square = p * p + 4.0 * q * missing
    if not (p > 0.0 and square >= 0.0):
        return False
    t = 2.0 * missing / (p + math.sqrt(square))
    along = gax * v[a, 0] + gay * v[a, 1] if w[a] > 0.0 else 0.0
    along += gbx * v[b, 0] + gby * v[b, 1] if w[b] > 0.0 else 0.0
    along += gcx * v[c, 0] + gcy * v[c, 1] if w[c] > 0.0 else 0.0
    weight = w[a] * (gax * gax + gay * gay) + w[b] * (gbx * gbx + gby * gby) + w[c] * (gcx * gcx + gcy * gcy)
    if not along + 0.5 * t * weight <= 0.0:
        return False
    v[a, 0] += t * w[a] * gax
    v[a, 1] += t * w[a] * gay
    v[b, 0] += t * w[b] * gbx
    v[b, 1] += t * w[b] * gby
    v[c, 0] += t * w[c] * gcx
    v[c, 1] += t * w[c] * gcy
    return True


@inner_kernel
def _draw_together(k: int, triangles: ClampedTriangles, least: float, h: float) -> None:
    # v = rigid + s (v - rigid) at each corner, s halved until the area is large enough; with s = 0 it is, as a rigid
    # motion makes the area (1 + (turn h)^2) times as large.
    position, velocity = triangles.position, triangles.velocity
    motion = _rigid_motion(k, triangles)
    for halving in range(HALVINGS + 1):
        ratio = 0.5 if halving < HALVINGS else 0.0
        for i in range(3):
            p = triangles.corner[k, i]
            if triangles.inverse_mass[p] > 0.0:
                u, v = velocity_at(motion, position[p, 0], position[p, 1])
                velocity[p, 0] = u + ratio * (velocity[p, 0] - u)
                velocity[p, 1] = v + ratio * (velocity[p, 1] - v)
        if _area_left(k, triangles, h) >= least:
            break


@inner_kernel
def _rigid_motion(k: int, triangles: ClampedTriangles) -> RigidMotion:
    # That of a triangle as a whole; with a pin it turns about that, with two not.
    position, velocity, mass = triangles.position, triangles.velocity, triangles.mass
    sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
    pins = 0
    for i in range(3):
        p = triangles.corner[k, i]
        if triangles.inverse_mass[p] == 0.0:
            pins += 1
            if pins > 1:
                return RigidMotion(sums.x, sums.y, 0.0, 0.0, 0.0, 0.0)
            sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
        elif pins == 1:
            continue
        sums = with_point(sums, mass[p], position[p, 0], position[p, 1], velocity[p, 0], velocity[p, 1])
    motion = centre_of(sums)
    for i in range(3):
        p = triangles.corner[k, i]
        if triangles.inverse_mass[p] > 0.0:
            motion = with_turn(motion, mass[p], position[p, 0], position[p, 1], velocity[p, 0], velocity[p, 1])
    return motion


@inner_kernel
def _stop_at_terrain(low: int, high: int, triangles: ClampedTriangles, h: float) -> None:
    # What would cross terrain now goes as far as it may.
    for r in range(low, high):
        if triangles.inverse_mass[r] > 0.0 and triangles.collides[r] & TERRAIN_GROUP != 0:
            stop_at_terrain(r, triangles.position, triangles.velocity, triangles.terrain, h)


@inner_kernel
def _join(first: int, last: int, triangles: ClampedTriangles, h: float) -> bool:
    # Let the corners of what is still too small move as one; whether any is.
    found = False
    for k in range(first, last):
        if _missing(k, triangles, LAST_SHARE, h) > 0.0 and _unite(k, triangles):
            found = True
    return found


@inner_kernel
def _unite(k: int, triangles: ClampedTriangles) -> bool:
    # Let the corners of a triangle move as one, and not at all where one is pinned; whether they did.
    label, fixed = triangles.label, triangles.fixed
    found, held, joined = False, False, -1
    for i in range(3):
        p = triangles.corner[k, i]
        if triangles.inverse_mass[p] == 0.0:
            held = True
            continue
        other = root_of(label, p)
        if joined >= 0 and other != joined:
            either = fixed[joined] or fixed[other]
            other = united(label, joined, other)
            fixed[other] = either
            found = True
        joined = other
    if held and joined >= 0 and not fixed[joined]:
        fixed[joined] = True
        found = True
    return found


@inner_kernel
def _move_as_one(low: int, high: int, triangles: ClampedTriangles) -> None:
    # Bring what is joined to its rigid motion, and what is held to rest.
    position, velocity, mass, sums = triangles.position, triangles.velocity, triangles.mass, triangles.sums
    for r in range(low, high):
        for column in range(sums.shape[1]):
            sums[r, column] = 0.0
    for r in range(low, high):
        g = root_of(triangles.label, r)
        m = mass[r]
        sums[g, MASS] += m
        sums[g, X] += m * position[r, 0]
        sums[g, Y] += m * position[r, 1]
        sums[g, U] += m * velocity[r, 0]
        sums[g, V] += m * velocity[r, 1]
        sums[g, COUNT] += 1.0
    for r in range(low, high):
        g = root_of(triangles.label, r)
        dx = position[r, 0] - sums[g, X] / sums[g, MASS]
        dy = position[r, 1] - sums[g, Y] / sums[g, MASS]
        du = velocity[r, 0] - sums[g, U] / sums[g, MASS]
        dv = velocity[r, 1] - sums[g, V] / sums[g, MASS]
        sums[g, INERTIA] += mass[r] * (dx * dx + dy * dy)
        sums[g, SPIN] += mass[r] * (dx * dv - dy * du)
    for r in range(low, high):
        g = root_of(triangles.label, r)
        if triangles.inverse_mass[r] == 0.0:
            continue
        if triangles.fixed[g]:
            velocity[r, 0] = 0.0
            velocity[r, 1] = 0.0
        elif sums[g, COUNT] > 1.0:
            turn = sums[g, SPIN] / sums[g, INERTIA] if sums[g, INERTIA] > 0.0 else 0.0
            velocity[r, 0] = sums[g, U] / sums[g, MASS] - turn * (position[r, 1] - sums[g, Y] / sums[g, MASS])
            velocity[r, 1] = sums[g, V] / sums[g, MASS] + turn * (position[r, 0] - sums[g, X] / sums[g, MASS])


@inner_kernel
def _hold_at_terrain(low: int, high: int, triangles: ClampedTriangles, h: float) -> bool:
    # Let what is joined be held where a particle of it would cross terrain; whether any is. What is alone was stopped
    # there before.
    position, velocity, terrain = triangles.position, triangles.velocity, triangles.terrain
    found = False
    for r in range(low, high):
        g = root_of(triangles.label, r)
        if triangles.fixed[g] or triangles.sums[g, COUNT] == 1.0:
            continue
        if triangles.collides[r] & TERRAIN_GROUP != 0:
            stops, _, _ = stopped(position[r, 0], position[r, 1], h * velocity[r, 0], h * velocity[r, 1], terrain)
            if stops > 0:
                triangles.fixed[g] = True
                found = True
    return found


@inner_kernel
def lay_out_world_triangles(state: State, arena: Arena, out: WorldTriangles) -> None:
    """Lay out the triangles of a world, as its topology is now."""
    particles = state.owner.shape[0]
    set_field(out, "of_world", triangles_of(state, arena))
    if is_full(arena):
        return
    found = out.of_world
    set_field(out, "found", new_inversions(found.jellies, arena))
    set_field(out, "marked", new_flags(arena, particles))
    clamped = new_tuple(
        ClampedTriangles, arena, rest=state.constraint_rest, position=state.position, velocity=state.velocity,
        mass=state.mass, inverse_mass=state.inverse_mass, inverted=out.found.is_inverted, terrain=state.terrain,
        triangles=count_with_gaps(found), rests=state.constraint_rest.shape[0], rows=particles,
    )  # fmt: skip
    set_field(out, "clamped", clamped)
    every = new_slots(arena, particles)
    if is_full(arena):
        return
    for p in range(particles):
        every[p] = p
    fill_triangles(found, state, every, arena, clamped)


@inner_kernel
def count_with_gaps(found: Triangles) -> int:
    """How many triangles are clamped: those of areas, and gaps."""
    return found.corners.shape[0] + found.jellies.gap.shape[0]


@inner_kernel
def fill_triangles(found: Triangles, state: State, particle: Slots, arena: Arena, made: ClampedTriangles) -> None:
    """Fill in triangles, of constraints ascending, each followed by the gaps beside it; particle (n,): of each row."""
    jellies, corners, scratch = found.jellies, found.corners, mark(arena)
    count, gaps = corners.shape[0], jellies.gap.shape[0]
    beside, listed, first = new_slots(arena, gaps), new_slots(arena, gaps), new_slots(arena, count + 1)
    if is_full(arena):
        return
    for k in range(gaps):
        beside[k] = jellies.gap[k, 0]
    list_by_key(beside, gaps, count, first, listed)
    k = 0
    for t in range(count):
        for at in range(first[t] - 1, first[t + 1]):
            is_gap = at >= first[t]
            for c in range(3):
                made.corner[k, c] = jellies.gap[listed[at], 1 + c] if is_gap else corners[t, c]
            made.gap[k] = is_gap
            made.group[k] = jellies.group[t]
            made.constraint[k] = found.constraint[t]
            made.start[found.constraint[t] + 1] = k + 1
            k += 1
        for c in range(3):
            made.collides[corners[t, c]] = state.collides[particle[corners[t, c]]]
    for t in range(made.start.shape[0] - 1):
        made.start[t + 1] = max(made.start[t + 1], made.start[t])
    give_back(arena, scratch)
