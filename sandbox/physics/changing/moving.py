"""Moving and weighing: what hangs together goes somewhere else at once, or becomes heavier. Not part of a tick."""

from sandbox.physics.arrays import Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED, FARTHEST_PLACE, LEAST_MASS, MOST_MASS
from sandbox.physics.state import GoodValues, State


@inner_kernel
def move_listed(state: State, good: GoodValues, body: Slots, dx: float, dy: float, stands: bool) -> bool:
    """Move particles (k,) by a way [m]; stands: they are at rest there.

    False, and nothing is moved, where any would be beyond FARTHEST_PLACE.
    """
    for k in range(body.shape[0]):
        x, y = state.position[body[k], 0] + dx, state.position[body[k], 1] + dy
        if not (abs(x) <= FARTHEST_PLACE and abs(y) <= FARTHEST_PLACE):
            return False
    for k in range(body.shape[0]):
        p = body[k]
        for axis in range(2):
            state.position[p, axis] += dx if axis == 0 else dy
            good.position[p, axis] = state.position[p, axis]
            if stands:
                state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0
        state.energy_bank[p] = BANK_UNOPENED
    return True


@inner_kernel
def scale_mass(state: State, good: GoodValues, particle: int, factor: float) -> bool:
    """Make every particle of the body of a particle so many times as heavy, pinned ones too.

    False, and nothing is changed, where any would weigh less than LEAST_MASS or more than MOST_MASS.
    """
    owner = state.owner[particle]
    for p in range(state.owner.shape[0]):
        is_of_body = state.particle_active[p] and state.owner[p] == owner
        if is_of_body and not LEAST_MASS <= state.mass[p] * factor <= MOST_MASS:
            return False
    for p in range(state.owner.shape[0]):
        if state.particle_active[p] and state.owner[p] == owner:
            state.mass[p] = good.mass[p] = state.mass[p] * factor
            if state.inverse_mass[p] > 0.0:
                state.inverse_mass[p] = 1.0 / state.mass[p]
            state.energy_bank[p] = BANK_UNOPENED
    return True
