"""Single pass: every spring and element evaluated once on the old velocities, the impulses summed (Nissen 2019).

Stable for Cs = Cd < 4 / (3 n_eff), see stability.py; never stiff.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.constraints import element_rate, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, reduced_mass, spring_impulse
from sandbox.physics.forces import Before
from sandbox.physics.jit import kernel
from sandbox.physics.world import Floats, World

# Cs and Cd of springs (m,) or elements (t,).
Pair = tuple[Floats, Floats]


@kernel
def _element_pass(  # type: ignore[no-untyped-def]
    position, velocity, inverse_mass, elements, stiffness, damping, h, place, slope, impulse
):
    # J = -(Cs C / h + Cd dC/dt) m, along the gradient at each corner
    for k in range(elements.kind.shape[0]):
        if not elements.active[k]:
            continue
        first = elements.first[k]
        last = first + elements.corners[k]
        look(first, last, position, elements.particle, place)
        error = evaluate(elements.kind[k], place, first, last, elements.rest, k, elements.weight, slope)
        mass, _ = explicit_mass(first, last, inverse_mass, elements.particle, elements.weight, slope)
        rate = element_rate(first, last, velocity, elements.particle, slope)
        j = spring_impulse(stiffness[k], damping[k], error, rate, mass, h)
        for c in range(first, last):
            impulse[elements.particle[c], 0] += j * slope[c, 0]
            impulse[elements.particle[c], 1] += j * slope[c, 1]


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


def apply_explicit(
    world: World, chosen: NDArray[np.bool_], springs: Pair, h: float, elements: Pair | None = None
) -> None:
    """Evaluate the chosen springs (m,) on the present velocities and apply their summed impulses.

    springs and, for all elements too, elements: their Cs and Cd.
    """
    impulse = np.zeros((world.particle_count, 2))
    if elements is not None and world.element_count:
        place, slope = np.zeros((2, len(world.corner_particle), 2))
        _element_pass(
            world.position, world.velocity, world.inverse_mass, world.elements, *elements, h, place, slope, impulse
        )  # fmt: skip
    _explicit_pass(
        world.position, world.velocity, world.inverse_mass, world.particle_a, world.particle_b, world.rest_length,
        *springs, world.law, world.hooke_stiffness, world.hooke_damping, chosen, h, impulse,
    )  # fmt: skip


def solve(world: World, springs: Pair, elements: Pair, h: float, before: Before) -> None:
    """Bring the velocities to the end of a step of h [s]; contacts are swept after springs and elements."""
    contacts = world.contacts
    if contacts is None:
        apply_explicit(world, world.spring_active, springs, h, elements)
        return
    from sandbox.physics.solvers.contact.gauss_seidel import load_biases, loose_blocks, new_push, sweep_masses

    push = new_push(len(contacts.particle))
    load_biases(contacts, push, h)
    apply_explicit(world, world.spring_active, springs, h, elements)
    sweep_masses(
        contacts, push, world.velocity, np.zeros((world.particle_count, 2)), world.inverse_mass,
        loose_blocks(world.particle_count), world.settings.iterations,
    )  # fmt: skip


def spring_constant(stiffness: Any, damping: Any, mass: Any, h: float) -> Any:
    """k [N/m] of a spring: Cs m_r / h^2."""
    return stiffness * mass / (h * h)
