"""What touches in a step: found before a solver moves bodies, kept, and held out of terrain, after it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.contacts import find_contacts
from sandbox.physics.collision.outline import outline_of
from sandbox.physics.collision.terrain_clamp import stop_at_terrain
from sandbox.physics.collision.types import Contacts
from sandbox.physics.solvers.contact.free_contacts import settle_loose
from sandbox.physics.solvers.contact.islands import bound_contacts
from sandbox.physics.world import Floats, World


class Meeting(NamedTuple):
    """Contacts of a step; bound (k,): those that a solver solves with the bodies; ahead: see free_contacts.py."""

    contacts: Contacts
    bound: NDArray[np.bool_]
    ahead: Floats


def meet(world: World, start: Floats, h: float) -> Meeting:
    """Find the contacts of a step of h [s] and solve those of loose particles; the others are left to the solver.

    start [m/s] (n, 2): the velocities before gravity and all else from outside.
    """
    outline, ahead = outline_of(world), np.zeros((world.particle_count, 2))
    contacts = find_contacts(world, outline, start, h)
    held = np.diff(outline.near_start) > 0
    held[world.corner_particle] = True
    bound, cluster = bound_contacts(contacts, world.inverse_mass, held)
    if not bound.all():
        settle_loose(world, contacts, np.flatnonzero(~bound), cluster, start, h, ahead)
        world.contacts = Contacts._make(array[bound] for array in contacts)
    else:
        world.contacts = contacts
    return Meeting(contacts, bound, ahead)


def leave(world: World, meeting: Meeting, h: float) -> None:
    """Keep a step's contacts with their impulses, and stop what would cross terrain, before particles move."""
    contacts = meeting.contacts
    contacts.impulse[meeting.bound] = world.contacts.impulse
    world.contacts = contacts
    world.keep_contacts(contacts.particle.astype(np.int32), contacts.feature, contacts.impulse)
    stop_at_terrain(world, meeting.ahead, h)
    world.position += meeting.ahead
