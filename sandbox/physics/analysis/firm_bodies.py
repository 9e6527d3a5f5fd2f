"""Pieces of bodies whose firmness can be set: each as a body with a form and a name of its own."""

import numpy as np

from sandbox.physics.arrays import Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.keeping.forms import FirmBody, StiffForm
from sandbox.physics.world import World


def firm_bodies(world: World) -> tuple[FirmBody, ...]:
    """The bodies of `World.forms` as they are now: of one that was cut its pieces, "cube, 1 of 2".

    The largest piece takes the place of its body, the others come after all bodies, so that a cut moves no place of
    what it does not touch. Pieces that keep no area, crumbs and threads, are none.
    """
    found: tuple[FirmBody, ...] = world.derived(_find_bodies, of_hands=False)
    return found


def _find_bodies(world: World) -> tuple[FirmBody, ...]:
    pieces = [pieces_of(world, body) for body in world.forms]
    return (*(each[0] for each in pieces), *(piece for each in pieces for piece in each[1:]))


def pieces_of(world: World, body: FirmBody) -> tuple[FirmBody, ...]:
    """The pieces of a body, or itself where no spring of it was cut."""
    if world.spring_active[body.springs].all():
        return (body,)
    slots = _slots_of(world, body)
    is_kept = world.constraint_active[body.constraints] & (world.constraint_kind[body.constraints] == AREA)
    corner = world.corner_particle[world.constraint_first[body.constraints[is_kept]]]
    owner = world.owner[slots]
    order = sorted(np.unique(world.owner[corner]).tolist(), key=lambda each: (-np.count_nonzero(owner == each), each))
    if len(order) < 2:
        return (body,)
    return tuple(
        _piece(world, body, np.flatnonzero(owner == each), slots, f"{body.name}, {number} of {len(order)}")
        for number, each in enumerate(order, 1)
    )


def _slots_of(world: World, body: FirmBody) -> Slots:
    """The slot of each point of a body's form."""
    slots = np.zeros(len(body.shape.points), dtype=np.int64)
    slots[body.shape.pairs[:, 0]] = world.particle_a[body.springs]
    slots[body.shape.pairs[:, 1]] = world.particle_b[body.springs]
    return slots


def _piece(world: World, body: FirmBody, chosen: Slots, slots: Slots, name: str) -> FirmBody:
    """The part of a body that these points of its form are."""
    number = np.full(world.particle_count, -1)
    number[slots[chosen]] = np.arange(len(chosen))
    ends = np.stack([number[world.particle_a[body.springs]], number[world.particle_b[body.springs]]], axis=1)
    kept = world.spring_active[body.springs] & (ends >= 0).all(axis=1)
    corners = number[world.corner_particle[world.constraint_first[body.constraints][:, None] + np.arange(3)]]
    there = world.constraint_active[body.constraints] & (corners >= 0).all(axis=1)
    is_area = world.constraint_kind[body.constraints] == AREA
    shape = body.shape
    form = StiffForm(
        shape.points[chosen], shape.mass[chosen], ends[kept], corners[there & is_area], corners[there & ~is_area]
    )
    return FirmBody(name, form, body.springs[kept], body.constraints[there])
