"""Removing: particles are taken out of a world with everything that holds them; their slots stay."""

import numpy as np

from sandbox.physics.arrays import Slots
from sandbox.physics.keeping.arguments import active_particles
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.world import World


def remove_particles(world: World, particles: Slots) -> None:
    """Take particles out, and every spring and constraint at them; hands that hold one let go.

    Raises IndexError for a particle that is not there or not in use, and ValueError.
    """
    particles = active_particles(world, "particles", particles)
    gone = np.zeros(world.particle_count, dtype=np.bool_)
    gone[particles] = True
    for hand in range(GRAB_COUNT):
        if world.is_held(hand) and gone[world.particle_b[world.grab_spring + hand]]:
            world.release(hand)
    springs = np.flatnonzero(world.spring_active & (gone[world.particle_a] | gone[world.particle_b]))
    if len(springs):
        world.cut(springs.tolist())
    owner = np.repeat(np.arange(world.constraint_count), world.constraint_corners)
    lost = np.unique(owner[gone[world.corner_particle]])
    if world.constraint_active[lost].any():
        corners = world.corner_particle[np.isin(owner, lost)].astype(np.int64)
        world.change("constraint_active", False, lost)
        world.disturb(corners)
    world.change("particle_active", False, particles)
    world.change("collides", 0, particles)
    for name in ("velocity", "slow_velocity", "spin"):
        world.change(name, 0.0, particles)
