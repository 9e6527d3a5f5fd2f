"""The first step of what flies: half of what forces add to its velocity.

Symplectic Euler keeps velocities half a step behind positions: what falls freely is then where it should be, exactly,

    v' = v + g h,  x' = x + h v'   with   v(0) = v_0 - g h / 2   gives   x(n h) = x_0 + v_0 t + g t^2 / 2

and so in steps of any length. A velocity that somebody gives is that of the tick, and is brought there in the first
step, unless the body is held or touches something.
"""

import numpy as np

from sandbox.physics.components import label_joined
from sandbox.physics.solvers.contact.small_steps import small_steps
from sandbox.physics.state import Floats, Slots
from sandbox.physics.world import World


def begin_flight(world: World, touched: Slots, h: float) -> None:
    """Take back half of the velocity that gravity added in a first step of h [s] to free particles that no contact
    pushed.

    touched: particles that contacts have pushed.
    """
    label = label_joined(world, world.spring_active, np.ones(world.particle_count, dtype=np.bool_))
    free = world.inverse_mass > 0.0
    stays = np.zeros(world.particle_count, dtype=np.bool_)
    stays[label[~free & world.particle_active]] = True
    stays[label[touched]] = True
    stays[label[~world.unmoved & world.particle_active]] = True
    flies = np.flatnonzero(free & world.particle_active & ~stays[label])
    if len(flies):
        count = np.bincount(label[flies], minlength=world.particle_count)
        mass = np.bincount(label[flies], world.mass[flies], world.particle_count)
        pulled = np.bincount(label[flies], world.mass[flies] * world.gravity_scale[flies], world.particle_count)
        alone = count[label[flies]] == 1
        fall: Floats = np.full(len(flies), h)
        if world.has_contacts:
            fall[alone] = h / small_steps(h)
        scale = (pulled / np.where(mass > 0.0, mass, 1.0))[label[flies]] / (1.0 + world.settings.drag * h)
        for axis in range(2):
            kick = 0.5 * fall * scale * world.settings.gravity[axis]
            world.velocity[flies, axis] -= kick
            world.slow_velocity[flies, axis] -= kick
    world.unmoved[:] = False
