"""The contacts of a world's last step, for tests."""

from sandbox.physics.arrays import empty
from sandbox.physics.collision.types import Contacts
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.pipeline.collide import CONTACTS, Collisions
from sandbox.physics.world import World

NO_CONTACTS = empty(Contacts)


def collisions_of(world: World) -> Collisions:
    """The collisions in the block of a world."""
    return block_of(world).arrays.collisions


def last_contacts(world: World) -> Contacts:
    """A copy of the contacts of the world's last step; none where topology has changed since."""
    if not world.has_contacts:
        return NO_CONTACTS
    collisions = collisions_of(world)
    return Contacts._make([array[: collisions.counts[CONTACTS]].copy() for array in collisions.contacts])
