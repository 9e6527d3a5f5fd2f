"""Where velocities take particles: the last part of a step."""

from sandbox.physics.collision.types import Flags
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.state import Floats


@inner_kernel
def advance(position: Floats, velocity: Floats, active: Flags, h: float) -> None:
    """Symplectic Euler over h [s]: x += v h with the NEW velocity; the equation is derived for it."""
    for p in range(active.shape[0]):
        if active[p]:
            position[p, 0] += velocity[p, 0] * h
            position[p, 1] += velocity[p, 1] * h


@kernel
def integrate(position: Floats, velocity: Floats, active: Flags, h: float) -> None:
    """Advance all particles by h [s]."""
    advance(position, velocity, active, h)
