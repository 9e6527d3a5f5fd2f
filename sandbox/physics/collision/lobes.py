"""Lobes: parts of a soft body that hang together by one particle alone. The smaller ones let go of it.

At such a particle, a hinge, the outline of the body passes twice, and what holds it together without that particle are
several parts. They would swing about it into each other. A spring that a hinge is tied by to a smaller lobe is cut with
those that were cut. What would keep no whole triangle then is no lobe, and stays.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.collision.sides import AT_LEFT, AT_RIGHT, TRIANGLE_CORNERS, is_whole_triangle
from sandbox.physics.components import join, root_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.state import State

# Sides with a triangle on one side alone that a fan of triangles around a particle has.
RIMS_OF_FAN = 2


class LobeScratch(NamedTuple):
    """Scratch: rims (n,) = sides at a particle with a triangle on one side alone; label (n,): see components.py.

    size, tied (n,): whole triangles of a part, and those of them that have the hinge as a corner, by the part's label.
    """

    rims: Annotated[Slots, "particles"]
    label: Annotated[Slots, "particles"]
    size: Annotated[Slots, "particles"]
    tied: Annotated[Slots, "particles"]


@inner_kernel
def let_go(state: State, torn: Slots, beside: Slots, gone: Flags, work: LobeScratch) -> bool:
    """Take out the springs by which the first hinge of torn bodies (n,) holds its smaller lobes; whether there is one.

    beside (m,): see `find_sides`; gone (m,): what was taken out is added.
    """
    for p in range(work.rims.shape[0]):
        work.rims[p] = 0
    for s in range(beside.shape[0]):
        if beside[s] in (AT_LEFT, AT_RIGHT) and _holds(state, s, torn):
            work.rims[state.particle_a[s]] += 1
            work.rims[state.particle_b[s]] += 1
    for p in range(work.rims.shape[0]):
        if work.rims[p] > RIMS_OF_FAN:
            _find_parts(state, p, torn, work)
            if _part_at(state, p, torn, gone, work):
                return True
    return False


@inner_kernel
def _holds(state: State, s: int, torn: Slots) -> bool:
    # Whether a spring acts inside of a torn body.
    first = torn[state.particle_a[s]]
    return (
        state.spring_active[s]
        and state.material[s] != GRAB_MATERIAL
        and first >= 0
        and torn[state.particle_b[s]] == first
    )


@inner_kernel
def _find_parts(state: State, hinge: int, torn: Slots, work: LobeScratch) -> None:
    # What is joined without a particle.
    label, size, tied = work.label, work.size, work.tied
    for p in range(label.shape[0]):
        label[p] = p
        size[p] = tied[p] = 0
    for s in range(state.spring_active.shape[0]):
        if hinge not in (state.particle_a[s], state.particle_b[s]) and _holds(state, s, torn):
            join(label, state.particle_a[s], state.particle_b[s])
    for k in range(state.constraint_kind.shape[0]):
        if is_whole_triangle(state, k):
            first, has_hinge, other = state.constraint_first[k], False, -1
            for c in range(first, first + TRIANGLE_CORNERS):
                has_hinge = has_hinge or state.corner_particle[c] == hinge
                other = other if state.corner_particle[c] == hinge else state.corner_particle[c]
            if torn[other] == torn[hinge]:
                size[root_of(label, other)] += 1
                tied[root_of(label, other)] += 1 if has_hinge else 0


@inner_kernel
def _part_at(state: State, hinge: int, torn: Slots, gone: Flags, work: LobeScratch) -> bool:
    # Take out the springs that tie a hinge to lobes other than the largest, of equal ones the first; whether there are.
    size, tied, largest = work.size, work.tied, -1
    for part in range(size.shape[0]):
        if tied[part] > 0 and (largest < 0 or size[part] > size[largest]):
            largest = part
    found = False
    for s in range(state.spring_active.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if hinge in (a, b) and _holds(state, s, torn):
            part = root_of(work.label, b if a == hinge else a)
            if part != largest and size[part] > tied[part] > 0:
                gone[s] = True
                state.spring_active[s] = False
                found = True
    return found
