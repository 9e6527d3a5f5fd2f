"""Sides of constraints: springs that act between two corners. What loses one ends; triangles lie at the others."""

from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State

TRIANGLE_CORNERS = 3
# A whole triangle of solid form lies to the left of a spring, to its right.
AT_LEFT, AT_RIGHT = 1, 2


@inner_kernel
def is_triangle(state: State, k: int) -> bool:
    """Whether a constraint is the area of a triangle, whole or ended."""
    return state.constraint_kind[k] == AREA and state.constraint_corners[k] == TRIANGLE_CORNERS


@inner_kernel
def is_whole_triangle(state: State, k: int) -> bool:
    """Whether a constraint is the area of a triangle, and acts."""
    return state.constraint_active[k] and is_triangle(state, k)


@inner_kernel
def acts_between(state: State, p: int, q: int, start: Slots, listed: Slots) -> bool:
    """Whether a spring acts between two particles; those of p: listed[start[p]:start[p + 1]]."""
    for at in range(start[p], start[p + 1]):
        s = listed[at]
        if state.spring_active[s] and q in (state.particle_a[s], state.particle_b[s]):
            return True
    return False


@inner_kernel
def end_constraints(state: State, start: Slots, listed: Slots, gone: Flags) -> None:
    """Deactivate the constraints that have lost a side: a spring of it is gone (m,), and no other acts there."""
    for k in range(state.constraint_kind.shape[0]):
        first, last = state.constraint_first[k], state.constraint_first[k] + state.constraint_corners[k]
        # A bend's two outer corners are no side of it.
        begins = last - 1 if state.constraint_kind[k] == AREA else first
        for corner in range(first if state.constraint_kind[k] == AREA else first + 1, last):
            p, q = state.corner_particle[begins], state.corner_particle[corner]
            if _side_is_lost(p, q, state, start, listed, gone):
                state.constraint_active[k] = False
            begins = corner


@inner_kernel
def _side_is_lost(p: int, q: int, state: State, start: Slots, listed: Slots, gone: Flags) -> bool:
    # Whether a spring that is taken out joined two particles, and none that acts does.
    lost = False
    for at in range(start[p], start[p + 1]):
        s = listed[at]
        if (state.particle_a[s] == p and state.particle_b[s] == q) or (
            state.particle_a[s] == q and state.particle_b[s] == p
        ):
            if state.spring_active[s]:
                return False
            lost = lost or gone[s]
    return lost


@inner_kernel
def find_sides(state: State, torn: Slots, start: Slots, listed: Slots, beside: Slots) -> None:
    """Find on which sides of springs (m,) whole triangles lie: AT_LEFT, AT_RIGHT, added up, of torn bodies (n,)."""
    for s in range(beside.shape[0]):
        beside[s] = 0
    for k in range(state.constraint_kind.shape[0]):
        corner = state.constraint_first[k]
        if is_whole_triangle(state, k) and torn[state.corner_particle[corner]] >= 0:
            is_left = state.constraint_rest[k, 1] > 0.0
            for c in range(TRIANGLE_CORNERS):
                p = state.corner_particle[corner + c]
                q = state.corner_particle[corner + (c + 1) % TRIANGLE_CORNERS]
                _add_side(p if is_left else q, q if is_left else p, state, start, listed, beside)


@inner_kernel
def _add_side(p: int, q: int, state: State, start: Slots, listed: Slots, beside: Slots) -> None:
    # A triangle lies to the left of the way from p to q: tell the first spring that acts along it.
    for at in range(start[p], start[p + 1]):
        s = listed[at]
        if state.spring_active[s]:
            if state.particle_a[s] == p and state.particle_b[s] == q:
                beside[s] |= AT_LEFT
                return
            if state.particle_a[s] == q and state.particle_b[s] == p:
                beside[s] |= AT_RIGHT
                return
