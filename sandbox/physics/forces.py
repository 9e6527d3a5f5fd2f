"""Gravity and air, which act on particles before the springs do. To the springs they are work from outside."""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.jit import inner_kernel
from sandbox.physics.settings import DRAG, GRAVITY_X, GRAVITY_Y, WIND_X, WIND_Y
from sandbox.physics.state import State


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
