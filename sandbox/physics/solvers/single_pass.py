"""Single pass: every spring evaluated once on the old velocities, the impulses summed (Nissen 2019).

Stable for Cs = Cd < 4 / (3 n_eff), see stability.py; never stiff.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.equation import direction, reduced_mass, spring_impulse
from sandbox.physics.forces import Before
from sandbox.physics.jit import kernel
from sandbox.physics.solvers.contact_sweep import load_biases, loose_blocks, new_push, sweep_masses
from sandbox.physics.world import Floats, World


@kernel
def _explicit_pass(  # type: ignore[no-untyped-def]
    position, velocity, inverse_mass, particle_a, particle_b, rest_length, stiffness, damping, law, hooke_stiffness,
    hooke_damping, chosen, h, impulse,
):  # fmt: skip
    # Nissen: J = -(Cs x / h + Cd u) m_r.  Hooke: J = -(k x + c u) h.  Then v += J w.
    for s in range(chosen.shape[0]):
        if not chosen[s]:
            continue
        a = particle_a[s]
        b = particle_b[s]
        mass = reduced_mass(inverse_mass[a], inverse_mass[b])
        if mass == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        x = length - rest_length[s]
        u = nx * du + ny * dv
        if law[s] == 0:
            j = spring_impulse(stiffness[s], damping[s], x, u, mass, h)
        else:
            j = -(hooke_stiffness[s] * x + hooke_damping[s] * u) * h
        impulse[a, 0] -= j * nx
        impulse[a, 1] -= j * ny
        impulse[b, 0] += j * nx
        impulse[b, 1] += j * ny
    # The guard keeps pinned particles where they are also when a mistuned Hooke spring pulls with inf: inf * 0 is NaN.
    for p in range(inverse_mass.shape[0]):
        if inverse_mass[p] > 0.0:
            velocity[p, 0] += impulse[p, 0] * inverse_mass[p]
            velocity[p, 1] += impulse[p, 1] * inverse_mass[p]


def apply_explicit(world: World, chosen: NDArray[np.bool_], stiffness: Floats, damping: Floats, h: float) -> None:
    """Evaluate the chosen springs (m,) on the present velocities and apply their summed impulses."""
    _explicit_pass(
        world.position, world.velocity, world.inverse_mass, world.particle_a, world.particle_b, world.rest_length,
        stiffness, damping, world.law, world.hooke_stiffness, world.hooke_damping, chosen, h,
        np.zeros((world.particle_count, 2)),
    )  # fmt: skip


def solve(world: World, stiffness: Floats, damping: Floats, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s]; contacts are swept after the springs."""
    contacts = world.contacts
    if contacts is None:
        apply_explicit(world, world.spring_active, stiffness, damping, h)
        return
    push = new_push(len(contacts.particle))
    load_biases(contacts, push, world.velocity, before.velocity, h)
    apply_explicit(world, world.spring_active, stiffness, damping, h)
    sweep_masses(
        contacts, push, world.velocity, np.zeros((world.particle_count, 2)), world.inverse_mass,
        loose_blocks(world.particle_count), world.settings.iterations,
    )  # fmt: skip


def spring_constant(stiffness: Any, damping: Any, mass: Any, h: float) -> Any:
    """k [N/m] of a spring: Cs m_r / h^2."""
    return stiffness * mass / (h * h)
