"""From forces to velocities, and from velocities to positions: the first and the last phase of a step.

Gravity and air act on particles before the springs do. To the springs they are work from outside.

The first step of what flies adds half of what forces add to its velocity. Symplectic Euler keeps velocities half a step
behind positions: what falls freely is then where it should be, exactly,

    v' = v + g h,  x' = x + h v'   with   v(0) = v_0 - g h / 2   gives   x(n h) = x_0 + v_0 t + g t^2 / 2

and so in steps of any length. A velocity that somebody gives is that of the tick, and is brought there in the first
step, unless the body is held or touches something.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.components import find_joined
from sandbox.physics.jit import inner_kernel
from sandbox.physics.settings import DRAG, GRAVITY_X, GRAVITY_Y, WIND_X, WIND_Y
from sandbox.physics.state import State

# s += c,  c = SLOW_SHARE (v' - s);  r += SLOW_SHARE (c - r), per step.
SLOW_SHARE = 0.3
# One turn [rad].
FULL_TURN = 6.283185307179586


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
def integrate_velocities(state: State, numbers: Floats, start: FloatRows, h: float) -> None:
    """Bring velocities of free particles from the start of a step of h [s] to where springs begin.

    v += g h, times their gravity scale; then, with the air, v' = v + h drag (wind - v'), implicit:
    v += (1 - 1 / (1 + drag h)) (wind - v), which never overshoots.

    numbers: those of the settings. start [m/s] (n, 2): keeps the velocities before.
    """
    velocity = state.velocity
    gravity_x = numbers[GRAVITY_X]
    gravity_y = numbers[GRAVITY_Y]
    wind_x = numbers[WIND_X]
    wind_y = numbers[WIND_Y]
    drag = numbers[DRAG]
    share = drag * h / (1.0 + drag * h)
    for p in range(state.inverse_mass.shape[0]):
        start[p, 0] = velocity[p, 0]
        start[p, 1] = velocity[p, 1]
        if state.particle_active[p] and state.inverse_mass[p] > 0.0:
            velocity[p, 0] += gravity_x * state.gravity_scale[p] * h
            velocity[p, 1] += gravity_y * state.gravity_scale[p] * h
            if drag > 0.0:
                velocity[p, 0] += share * (wind_x - velocity[p, 0])
                velocity[p, 1] += share * (wind_y - velocity[p, 1])


@inner_kernel
def integrate_positions(state: State, h: float) -> None:
    """Advance all particles by h [s]. Symplectic Euler: x += v h with the NEW velocity; the equation is derived for it.

    Discs turn, with angles [rad] kept between -pi and pi.
    """
    position, velocity, angle, spin = state.position, state.velocity, state.angle, state.spin
    for p in range(spin.shape[0]):
        if state.particle_active[p]:
            position[p, 0] += velocity[p, 0] * h
            position[p, 1] += velocity[p, 1] * h
    for p in range(spin.shape[0]):
        if spin[p] != 0.0:
            angle[p] += h * spin[p]
            if abs(angle[p]) > 0.5 * FULL_TURN:
                angle[p] -= FULL_TURN * math.floor(angle[p] / FULL_TURN + 0.5)


@inner_kernel
def follow(velocity: FloatRows, slow_velocity: FloatRows, slow_change: FloatRows, active: Flags) -> None:
    """Update the running means of velocities, and of their change in a step."""
    for p in range(active.shape[0]):
        if active[p]:
            for axis in range(2):
                change = SLOW_SHARE * (velocity[p, axis] - slow_velocity[p, axis])  # (11)
                slow_velocity[p, axis] += change
                slow_change[p, axis] += SLOW_SHARE * (change - slow_change[p, axis])


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
        flight.mass[p] = flight.pulled[p] = 0.0


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
