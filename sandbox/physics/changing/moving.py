"""Moving and weighing: what hangs together goes somewhere else at once, or becomes heavier. Not part of a tick."""

from sandbox.physics.arena import Arena, begin, is_full, new_slots
from sandbox.physics.arrays import Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import BANK_UNOPENED, FARTHEST_PLACE, LEAST_MASS, MOST_MASS
from sandbox.physics.state import GoodValues, State


@inner_kernel
def _label_what_hangs(state: State, label: Slots) -> None:
    # Label every particle (n,) with the lowest one that springs join it to, also by way of pinned ones.
    for p in range(label.shape[0]):
        label[p] = p
    for s in range(state.law.shape[0]):
        if state.spring_active[s] and state.material[s] >= 0:
            join(label, state.particle_a[s], state.particle_b[s])
    for p in range(label.shape[0]):
        label[p] = root_of(label, p)


@inner_kernel
def label_what_hangs(state: State, arena: Arena) -> Slots:
    """The lowest particle that springs join each one to (n,), also by way of pinned ones, in an arena that is begun
    again; ask `is_full` before it is used.
    """
    begin(arena)
    label = new_slots(arena, state.owner.shape[0])
    if not is_full(arena):
        _label_what_hangs(state, label)
    return label


@inner_kernel
def move_labelled(
    state: State, good: GoodValues, label: Slots, particle: int, dx: float, dy: float, stands: bool
) -> bool:
    """Move all that has the label of a particle by a way [m]; stands: it is at rest there.

    False, and nothing is moved, where any would be beyond FARTHEST_PLACE.
    """
    for p in range(label.shape[0]):
        if label[p] == label[particle] and state.particle_active[p]:
            x, y = state.position[p, 0] + dx, state.position[p, 1] + dy
            if not (abs(x) <= FARTHEST_PLACE and abs(y) <= FARTHEST_PLACE):
                return False
    for p in range(label.shape[0]):
        if label[p] == label[particle] and state.particle_active[p]:
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
