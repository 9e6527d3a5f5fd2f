"""The first step of what flies: half of what forces add to its velocity.

Symplectic Euler keeps velocities half a step behind positions: what falls freely is then where it should be, exactly,

    v' = v + g h,  x' = x + h v'   with   v(0) = v_0 - g h / 2   gives   x(n h) = x_0 + v_0 t + g t^2 / 2

and so in steps of any length. A velocity that somebody gives is that of the tick, and is brought there in the first
step, unless the body is held or touches something.
"""

import numpy as np

from sandbox.physics.components import label_bodies
from sandbox.physics.solvers.contact.small_steps import small_steps
from sandbox.physics.state import Floats, Slots
from sandbox.physics.world import World


def _labels(world: World) -> Slots:
    springs = np.flatnonzero(world.spring_active)
    sizes = world.constraint_corners.astype(np.int64)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    corner = np.flatnonzero(world.constraint_active[owner]) if len(sizes) else np.zeros(0, np.int64)
    first = world.constraint_first.astype(np.int64)[owner[corner]] if len(corner) else corner
    a = np.concatenate([world.particle_a[springs].astype(np.int64), world.corner_particle[first].astype(np.int64)])
    b = np.concatenate([world.particle_b[springs].astype(np.int64), world.corner_particle[corner].astype(np.int64)])
    label = np.arange(world.particle_count)
    label_bodies(a, b, label)
    return label


def begin_flight(world: World, touched: Slots, h: float) -> None:
    """Take back half of what gravity has added in a step of h [s] to what has not moved before and flies.

    touched: particles that contacts have pushed.
    """
    label = _labels(world)
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
