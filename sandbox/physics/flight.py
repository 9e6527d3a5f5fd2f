"""The first step of what flies: half of what forces add to its velocity.

Symplectic Euler keeps velocities half a step behind positions: what falls freely is then where it should be, exactly,

    v' = v + g h,  x' = x + h v'   with   v(0) = v_0 - g h / 2   gives   x(n h) = x_0 + v_0 t + g t^2 / 2

and so in steps of any length. A velocity that somebody gives is that of the tick, and is brought there in the first
step, unless the body is held or touches something.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.components import find_joined
from sandbox.physics.jit import inner_kernel
from sandbox.physics.settings import DRAG, GRAVITY_X
from sandbox.physics.state import State


class Flight(NamedTuple):
    """Scratch, by particle: label = the lowest one that it is joined to; by label: whether it stays, its free members,
    their mass [kg] and that times their gravity scale.
    """

    label: Annotated[Slots, "particles"]
    stays: Annotated[Flags, "particles"]
    members: Annotated[Slots, "particles"]
    mass: Annotated[Floats, "particles"]
    pulled: Annotated[Floats, "particles"]


@inner_kernel
def label_all_joined(state: State, flight: Flight) -> None:
    """Label every particle with the lowest one that springs and constraints join it to; nothing stays yet."""
    for p in range(flight.stays.shape[0]):
        flight.stays[p] = True
    # All of them join.
    find_joined(state, state.spring_active, flight.stays, flight.label)
    for p in range(flight.stays.shape[0]):
        flight.stays[p] = False
        flight.members[p] = 0
        flight.mass[p] = 0.0
        flight.pulled[p] = 0.0


@inner_kernel
def begin_flight(state: State, numbers: Floats, flight: Flight, alone: float, h: float) -> None:
    """Take back half of the velocity that gravity added in a first step of h [s] to what is free and does not stay.

    Bodies are labelled, and those that contacts pushed are marked. alone [s]: the small steps in which a particle falls
    that nothing is joined to.
    """
    label = flight.label
    for p in range(label.shape[0]):
        if state.particle_active[p] and not (state.inverse_mass[p] > 0.0 and state.unmoved[p]):
            flight.stays[label[p]] = True
    for p in range(label.shape[0]):
        g = label[p]
        if state.particle_active[p] and state.inverse_mass[p] > 0.0 and not flight.stays[g]:
            flight.members[g] += 1
            flight.mass[g] += state.mass[p]
            flight.pulled[g] += state.mass[p] * state.gravity_scale[p]
    for p in range(label.shape[0]):
        g = label[p]
        if state.particle_active[p] and state.inverse_mass[p] > 0.0 and not flight.stays[g]:
            fall = alone if flight.members[g] == 1 else h
            scale = flight.pulled[g] / flight.mass[g] / (1.0 + numbers[DRAG] * h)
            for axis in range(2):
                kick = 0.5 * fall * scale * numbers[GRAVITY_X + axis]
                state.velocity[p, axis] -= kick
                state.slow_velocity[p, axis] -= kick
        state.unmoved[p] = False
