"""Single pass: every spring and constraint evaluated once on the old velocities, the impulses summed (Nissen 2019).

Stable for Cs = Cd < 4 / (3 n_eff), see stability.py; never stiff.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.types import Contacts
from sandbox.physics.constraints import ConstraintArrays, constraint_rate, evaluate, explicit_mass, look
from sandbox.physics.equation import direction, explicit_spring_constant, reduced_mass, spring_impulse
from sandbox.physics.jit import kernel
from sandbox.physics.substeps import Pair, Substep
from sandbox.physics.world import Floats, World


class Particles(NamedTuple):
    """What an explicit solver reads of particles (n,): position [m], velocity [m/s], inverse mass [1/kg]."""

    position: Floats
    velocity: Floats
    inverse_mass: Floats


class Ends(NamedTuple):
    """What an explicit solver reads of springs (m,): see StateArrays; stiffness and damping of the substep."""

    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    damping: Floats
    law: NDArray[np.int8]
    hooke_stiffness: Floats
    hooke_damping: Floats


def particles_of(world: World) -> Particles:
    """The particles of a world as they are now."""
    return Particles(world.position, world.velocity, world.inverse_mass)


def ends_of(world: World, springs: Pair) -> Ends:
    """The springs of a world as they are now, with their Cs and Cd in a substep."""
    return Ends(
        world.particle_a, world.particle_b, world.rest_length, *springs, world.law, world.hooke_stiffness,
        world.hooke_damping,
    )  # fmt: skip


@kernel
def _constraint_pass(
    particles: Particles, constraints: ConstraintArrays, stiffness: Floats, damping: Floats, h: float, place: Floats,
    slope: Floats, impulse: Floats,
) -> None:  # fmt: skip
    # J = -(Cs C / h + Cd dC/dt) m, along the gradient at each corner
    for k in range(constraints.kind.shape[0]):
        if not constraints.active[k]:
            continue
        first = constraints.first[k]
        last = first + constraints.corners[k]
        look(first, last, particles.position, constraints.particle, place)
        error = evaluate(constraints.kind[k], place, first, last, constraints.rest, k, constraints.weight, slope)
        mass, _ = explicit_mass(first, last, particles.inverse_mass, constraints.particle, constraints.weight, slope)
        rate = constraint_rate(first, last, particles.velocity, constraints.particle, slope)
        j = spring_impulse(stiffness[k], damping[k], error, rate, mass, h)
        for c in range(first, last):
            impulse[constraints.particle[c], 0] += j * slope[c, 0]
            impulse[constraints.particle[c], 1] += j * slope[c, 1]


@kernel
def _explicit_pass(particles: Particles, ends: Ends, chosen: NDArray[np.bool_], h: float, impulse: Floats) -> None:
    # Nissen: J = -(Cs x / h + Cd u) m_r.  Hooke: J = -(k x + c u) h.  Then v += J w.
    position, velocity, inverse_mass = particles.position, particles.velocity, particles.inverse_mass
    for s in range(chosen.shape[0]):
        if not chosen[s]:
            continue
        a = ends.particle_a[s]
        b = ends.particle_b[s]
        mass = reduced_mass(inverse_mass[a], inverse_mass[b])
        if mass == 0.0:
            continue
        du = velocity[b, 0] - velocity[a, 0]
        dv = velocity[b, 1] - velocity[a, 1]
        nx, ny, length = direction(position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], du, dv)
        x = length - ends.rest_length[s]
        u = nx * du + ny * dv
        if ends.law[s] == 0:
            j = spring_impulse(ends.stiffness[s], ends.damping[s], x, u, mass, h)
        else:
            j = -(ends.hooke_stiffness[s] * x + ends.hooke_damping[s] * u) * h
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
    world: World, chosen: NDArray[np.bool_], springs: Pair, h: float, constraints: Pair | None = None
) -> None:
    """Evaluate the chosen springs (m,) on the present velocities and apply their summed impulses.

    springs and, for all constraints too, constraints: their Cs and Cd.
    """
    impulse, particles = np.zeros((world.particle_count, 2)), particles_of(world)
    if constraints is not None and world.constraint_count:
        place, slope = np.zeros((2, len(world.corner_particle), 2))
        _constraint_pass(particles, world.constraints, *constraints, h, place, slope, impulse)
    _explicit_pass(particles, ends_of(world, springs), chosen, h, impulse)


spring_constant = explicit_spring_constant


def solve(world: World, substep: Substep, contacts: Contacts | None) -> None:
    """Bring the velocities to the end of a substep; contacts are swept after springs and constraints."""
    apply_explicit(world, world.spring_active, substep.springs, substep.h, substep.constraints)
    if contacts is not None:
        from sandbox.physics.solvers.contact.gauss_seidel import new_terms, no_blocks, sweep_masses

        sweep_masses(
            contacts, new_terms(len(contacts.particle)), world.velocity, np.zeros((world.particle_count, 2)),
            world.inverse_mass, no_blocks(world.particle_count), world.settings.iterations, substep.h,
        )  # fmt: skip
