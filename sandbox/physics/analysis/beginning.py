"""What the beginning of a run shows: what overlaps, and what floats in the water that it lies in or above."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.energy import discs_in_water, water_energy
from sandbox.physics.arrays import Slots
from sandbox.physics.components import label_bodies
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.collide import CONTACTS, OVERLAPPING
from sandbox.physics.water.displacers import BOTTOM, LEFT, RIGHT, TOP
from sandbox.physics.world import World

# What overlaps by less than this share of a radius rests on each other.
RESTING = 0.2
# Lift is the loss of energy over twice this way [m]: longer, and the surface is blurred; shorter, and it is rounding.
WAY = 1e-4
# Halvings of the range in which a draught is looked for.
HALVINGS = 30


@dataclass(frozen=True)
class Overlap:
    """Two things that overlap, by a particle of each; depth [m], infinite where their outlines cross."""

    one: int
    other: int
    depth: float


@dataclass(frozen=True)
class Draught:
    """How something lies in a pool, by its number: so deep [m], None = it sinks; share of its weight that is borne."""

    pool: int
    depth: float | None
    borne: float


def parts_of(world: World) -> Slots:
    """The lowest slot of the part that each particle (n,) belongs to: what springs join, pinned or not."""
    label = np.arange(world.particle_count, dtype=np.int64)
    active = world.spring_active
    label_bodies(world.particle_a[active].astype(np.int64), world.particle_b[active].astype(np.int64), label)
    return label


def overlaps(world: World) -> list[Overlap]:
    """What overlapped something that it is not joined to in the last tick, each pair once, the deepest first."""
    part, owner = parts_of(world), world.owner
    collisions = block_of(world).arrays.collisions
    contacts, count = collisions.contacts, int(collisions.counts[CONTACTS])
    a, b, share = contacts.end_a[:count], contacts.end_b[:count], contacts.share[:count]
    # What is held where it is cannot come apart.
    held = world.inverse_mass == 0.0
    on_a, on_b = (share == 1.0) | held[a], (b < 0) | (share == 0.0) | held[b]
    rows = np.flatnonzero((a >= 0) & ~(held[contacts.particle[:count]] & on_a & on_b))
    rows = rows[np.argsort(contacts.gap[rows], kind="stable")]
    outline, pairs = collisions.outline, collisions.overlaps.shape[: collisions.counts[OVERLAPPING]]
    crossing = outline.member[outline.member_start[pairs]].reshape(-1, 2)
    touching = np.stack([contacts.particle[rows], contacts.end_a[rows]], axis=1)
    depths = np.concatenate([np.full(len(crossing), np.inf), -contacts.gap[rows]])
    found: dict[tuple[int, ...], Overlap] = {}
    for (one, other), depth in zip(np.concatenate([crossing, touching]).tolist(), depths.tolist(), strict=True):
        resting = RESTING * min(world.radius[one], world.radius[other])
        pair = tuple(sorted((int(owner[one]), int(owner[other]))))
        if depth > resting and part[one] != part[other] and pair[0] != pair[1]:
            found.setdefault(pair, Overlap(one, other, depth))
    return list(found.values())


def overlap_text(world: World, found: list[Overlap]) -> str:
    """A sentence on things that overlap, the deepest first."""
    one, other = (world.particle_names[slot].partition(".")[0] for slot in (found[0].one, found[0].other))
    depths = [each.depth for each in found if each.depth < np.inf]
    deep = f"by {'up to ' if len(found) > 1 else ''}{max(depths):.2g} m" if depths else ""
    crossing = len(found) - len(depths)
    if crossing:
        deep = f"{deep}, {crossing} so far that their outlines cross" if deep else "so far that their outlines cross"
    who = f'"{one}" and "{other}" overlap' if len(found) == 1 else f"{len(found)} pairs of bodies overlap"
    names = "" if len(found) == 1 else f" ({one}, {other})"
    return f"{who} at the start, {deep}{names}: they come apart as the run begins"


def lift_of(world: World, slots: Slots, rise: float = 0.0) -> float:
    """The force [N] by which water lifts particles of a world, by their slots, if they are raised so far [m]."""
    before, energy = world.position[slots, 1].copy(), []
    try:
        for way in (-WAY, WAY):
            world.position[slots, 1] = before + (rise + way)
            energy.append(water_energy(world))
    finally:
        world.position[slots, 1] = before
    return (energy[0] - energy[1]) / (2.0 * WAY)


def draught_of(world: World, slots: Slots) -> Draught | None:
    """How a part, by its slots, lies in the highest pool that it is in or above, as it stands; None: in none."""
    g, mass = -world.settings.gravity[1], world.mass[slots]
    weight = g * float(np.sum(mass * world.gravity_scale[slots]))
    x, y = np.sum(mass[:, None] * world.position[slots], axis=0) / np.sum(mass)
    pools = world.water
    over = np.flatnonzero((pools[:, LEFT] < x) & (x < pools[:, RIGHT]) & (y > pools[:, BOTTOM]))
    if g <= 0.0 or weight <= 0.0 or not len(over) or not np.all(world.inverse_mass[slots] > 0.0):
        return None
    pool = int(over[np.argmax(pools[over, TOP])])
    reach = np.where(np.isin(slots, discs_in_water(world)), world.radius[slots], 0.0)
    low, high = float(np.min(world.position[slots, 1] - reach)), float(np.max(world.position[slots, 1] + reach))
    top = float(pools[pool, TOP])
    least, most = 0.0, min(high - low, top - float(pools[pool, BOTTOM]))
    borne = lift_of(world, slots, top - most - low) / weight
    if borne < 1.0:
        return Draught(pool, None, borne)
    for _ in range(HALVINGS):
        middle = 0.5 * (least + most)
        least, most = (least, middle) if lift_of(world, slots, top - middle - low) >= weight else (middle, most)
    return Draught(pool, most, borne)


def sinking(world: World) -> Iterator[tuple[Slots, Draught] | None]:
    """The slots of parts that sink in a pool which they are in, or above with no terrain between; None: a pause."""
    part = parts_of(world)
    order = np.argsort(part, kind="stable")
    for slots in np.split(order, np.flatnonzero(np.diff(part[order])) + 1) if len(world.water) else ():
        found = draught_of(world, slots)
        if found is not None and found.depth is None and not _is_on_ground(world, slots, found.pool):
            yield slots, found
        yield None


def _is_on_ground(world: World, slots: Slots, pool: int) -> bool:
    """Whether terrain lies between a part and the surface of a pool below it."""
    (x, low), terrain = (world.position[slots, 0].mean(), world.position[slots, 1].min()), world.terrain
    a, b = terrain.vertex[terrain.edge_a], terrain.vertex[terrain.edge_b]
    over = (a[:, 0] <= x) != (b[:, 0] <= x)
    a, b = a[over], b[over]
    y = a[:, 1] + (x - a[:, 0]) * (b[:, 1] - a[:, 1]) / (b[:, 0] - a[:, 0])
    return bool(np.any((y <= low) & (y >= world.water[pool, TOP])))


def sinking_text(world: World, slots: Slots, found: Draught, pool: str) -> str:
    """A sentence on a part that sinks in the pool of that name."""
    name = world.particle_names[slots[0]].partition(".")[0]
    more = " and what it is joined to" if len(np.unique(world.owner[slots])) > 1 else ""
    return f'"{name}"{more} would sink in "{pool}": its water bears {found.borne:.0%} of the weight'
