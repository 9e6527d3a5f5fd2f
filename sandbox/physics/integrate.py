"""Velocities change positions: the last phase of a step."""

import math

from sandbox.physics.arrays import Flags, FloatRows
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State

# s += c,  c = SLOW_SHARE (v' - s);  r += SLOW_SHARE (c - r), per step.
SLOW_SHARE = 0.3
# One turn [rad].
FULL_TURN = 6.283185307179586


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
