"""Queries of a state: particles and springs near a point, springs that a stroke crosses, strain of springs."""

from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.constraints import AREA, CONSTRAINT_NAMES
from sandbox.physics.geometry.segment import distances_from_segments, doubled_areas, lengths
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.settings import NUMBER_NAMES
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.state import BY_STORED, FAMILIES, Family
from sandbox.physics.world import World

Point = tuple[float, float]

# A hand reaches so many times as far into a soft body as that goes, so that all of it bears some of the force. With 1
# a jelly that stands at nine tenths of its height is stretched to twice its length when it is thrown by a corner; with
# 1.5 the corner of a larger one swings ahead of the cursor. Much more holds a jelly as if it were stiff.
REACH = 2.0

# A mistuned Hooke spring blows up for the user to see: what overflows is far from everything, and no fault.
_far_away = np.errstate(over="ignore", invalid="ignore")


def _without_grabs(active: NDArray[np.bool_], first_grab: int) -> NDArray[np.bool_]:
    shown = active.copy()
    if first_grab >= 0:
        shown[first_grab : first_grab + GRAB_COUNT] = False
    return shown


def shown_particles(state: World | Snapshot) -> NDArray[np.bool_]:
    """Particles (n,) that a person sees: active and no grab's cursor."""
    return _without_grabs(state.particle_active, state.grab_particle)


def shown_springs(state: World | Snapshot) -> NDArray[np.bool_]:
    """Springs (m,) that a person sees: active and no grab's spring."""
    return _without_grabs(state.spring_active, state.grab_spring)


@_far_away
def nearest_particle(state: World | Snapshot, point: Point, within: float) -> int | None:
    """Slot of the shown particle whose disc is nearest to point [m], at most `within` [m] away; the lowest on a tie."""
    distance = lengths(state.position - np.asarray(point)) - state.radius
    return _nearest(distance, shown_particles(state), within)


def free_particle_at(state: World | Snapshot, point: Point, within: float) -> int | None:
    """Slot of the free particle that a press at point [m] takes: one at most `within` [m] away, else the nearest one of
    the body whose springs are around the point.
    """
    return _pressed(state, point, within, state.inverse_mass > 0.0)


def particle_at(state: World | Snapshot, point: Point, within: float) -> int | None:
    """Slot of the particle at point [m], pinned or free; else as `free_particle_at`."""
    return _pressed(state, point, within, np.ones(len(state.mass), np.bool_))


@_far_away
def _pressed(state: World | Snapshot, point: Point, within: float, may_be: NDArray[np.bool_]) -> int | None:
    pressed = nearest_particle(state, point, within)
    if pressed is not None and may_be[pressed]:
        return pressed
    taken = shown_particles(state) & may_be & np.isin(state.owner, bodies_around(state, point))
    return _nearest(lengths(state.position - np.asarray(point)), taken, np.inf) if taken.any() else None


def bodies_around(state: World | Snapshot, point: Point) -> NDArray[np.integer]:
    """Owners of the bodies that have springs to the left and right of a point [m], above and below."""
    shown = np.flatnonzero(state.spring_active & (state.material >= 0))
    a, b = state.position[state.particle_a[shown]], state.position[state.particle_b[shown]]
    owner = state.owner[state.particle_a[shown]]
    found = np.unique(owner)
    for u, v in ((0, 1), (1, 0)):
        crossing = np.flatnonzero((a[:, u] <= point[u]) != (b[:, u] <= point[u]))
        start, end = a[crossing], b[crossing]
        at = start[:, v] + (end[:, v] - start[:, v]) * ((point[u] - start[:, u]) / (end[:, u] - start[:, u]))
        for beyond in (at <= point[v], at >= point[v]):
            found = np.intersect1d(found, owner[crossing[beyond]])
    return found


def grip_radius(state: World | Snapshot, particle: int) -> float:
    """How far [m] a hand reaches into the body of a particle that it takes: 0 where it is not soft.

    A body that keeps areas is soft: it would tear where one particle bears all of a hand's force.
    """
    soft = np.zeros(len(state.mass), dtype=np.bool_)
    sizes = state.constraint_corners
    soft[state.corner_particle[np.repeat(state.constraint_active & (state.constraint_kind == AREA), sizes)]] = True
    of_body = state.particle_active & (state.owner == state.owner[particle])
    if not np.any(soft & of_body):
        return 0.0
    return REACH * float(np.max(lengths(state.origin[of_body] - state.origin[particle])))


@_far_away
def nearest_spring(state: World | Snapshot, point: Point, within: float) -> int | None:
    """Slot of the shown spring nearest to point [m], at most `within` [m] away; the lowest on a tie."""
    a, b = state.position[state.particle_a], state.position[state.particle_b]
    return _nearest(distances_from_segments(np.asarray(point), a, b), shown_springs(state), within)


def _nearest(distance: NDArray[np.float64], shown: NDArray[np.bool_], within: float) -> int | None:
    reachable = np.where(shown & np.isfinite(distance), distance, np.inf)
    if not len(reachable):
        return None
    slot = int(np.argmin(reachable))
    return slot if reachable[slot] <= within else None


@_far_away
def springs_crossing(state: World | Snapshot, start: Point, end: Point) -> Slots:
    """Slots of the shown springs that the segment from start to end [m] crosses or touches, ascending."""
    p, q = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    a, b = state.position[state.particle_a], state.position[state.particle_b]
    straddles = (doubled_areas(p, q, a) * doubled_areas(p, q, b) <= 0.0) & (
        doubled_areas(a, b, p) * doubled_areas(a, b, q) <= 0.0
    )
    # Collinear segments have all four areas 0: they meet only where their boxes do.
    boxes = np.all((np.minimum(a, b) <= np.maximum(p, q)) & (np.maximum(a, b) >= np.minimum(p, q)), axis=1)
    return np.flatnonzero(shown_springs(state) & straddles & boxes)


@_far_away
def shares_crossed(state: World | Snapshot, springs: Slots, start: Point, end: Point) -> Floats:
    """Where the line from start to end [m] crosses springs (k,), as a share (k,) of each from its first end.

    -1: nowhere. What lies on the line lies to the left of it, so that of two springs in a row the line crosses one.
    """
    p, q = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    one = doubled_areas(p, q, state.position[state.particle_a[springs]])
    other = doubled_areas(p, q, state.position[state.particle_b[springs]])
    return np.divide(one, one - other, out=np.full(len(springs), -1.0), where=(one >= 0.0) != (other >= 0.0))


@_far_away
def in_triangles(state: World | Snapshot) -> NDArray[np.bool_]:
    """Which springs (m,) act within a body that keeps areas of triangles, which a cut parts along its line."""
    chosen = state.constraint_active & (state.constraint_kind == AREA) & (state.constraint_corners == 3)
    owners = np.unique(state.owner[state.corner_particle[state.constraint_first[chosen]]])
    one, other = state.owner[state.particle_a], state.owner[state.particle_b]
    return shown_springs(state) & (one == other) & np.isin(one, owners)


@_far_away
def strain(state: World | Snapshot) -> Floats:
    """Signed strain (l - L) / L of every spring (m,): above 0 stretched; 0 where inactive or of rest length 0."""
    length = lengths(state.position[state.particle_b] - state.position[state.particle_a])
    counted = state.spring_active & (state.rest_length > 0.0)
    rest = state.rest_length
    return np.divide(length - rest, rest, out=np.zeros_like(length), where=counted)


def load_bearing(state: World | Snapshot) -> NDArray[np.bool_]:
    """Springs (m,) whose strain counts: active, of a rest length above 0, with a free end."""
    free = (state.inverse_mass[state.particle_a] > 0.0) | (state.inverse_mass[state.particle_b] > 0.0)
    return state.spring_active & (state.rest_length > 0.0) & free


def slot_name(world: World, array: str, slot: int) -> str:
    """The name, for a person, of the owner of a slot of a state array; the array goes by its name in files."""
    family = BY_STORED[array].family
    match family:
        case Family.PARTICLE:
            return world.particle_names[slot]
        case Family.SPRING:
            return world.spring_names[slot]
        case Family.CONSTRAINT:
            name, corner = CONSTRAINT_NAMES[int(world.constraint_kind[slot])]
            return f"{name} at {world.particle_names[world.corner_particle[world.constraint_first[slot] + corner]]}"
        case Family.ACTUATOR:
            return world.actuators.names[slot]
        case Family.CONTACT:
            return f"contact of {world.particle_names[world.contact_particle[slot]]}"
        case Family.CORNER:
            return f"corner at {world.particle_names[world.corner_particle[slot]]}"
        case Family.HAND:
            return f"hand {slot}"
        case Family.SETTING:
            return NUMBER_NAMES[slot]
        case Family.PROBE:
            probed = world.particle_names[world.ways.particle[slot]]
            return f'way of {probed} for rule "{world.row_names[family][slot]}"'
        case Family.STILL:
            return f'settling for rule "{world.row_names[family][slot]}"'
        case Family.RULE | Family.COUNTER | Family.KEY | Family.DEED:
            return f'{family.value.partition(" ")[0]} "{world.row_names[family][slot]}"'
        case _:
            assert_never(family)


def row_names(world: World, family: Family) -> list[str]:
    """The names of all rows of a family, by slot."""
    column = FAMILIES[family][0]
    return [slot_name(world, column.stored, slot) for slot in range(len(getattr(world, column.name)))]
