"""Pieces: what a cut leaves of a soft body. Each is a body of its own, with the outline of the triangles left to it.

A soft body is one that keeps the areas of triangles, or has a solid outline. The piece of its first particle keeps the
body's number as owner; any other has -1 - p, p = its own first particle. Where a body has a solid outline, that of a
piece runs along the springs that have a whole triangle on one side alone; an edge without one is a line. So nothing is
kept beside the state: what restores that joins the pieces again.
"""

from typing import NamedTuple

from sandbox.physics.arena import Arena, new_flags, new_slots
from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.collision.filter import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.components import join, root_of
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.state import State

TRIANGLE_CORNERS = 3
# A whole triangle of solid form lies to the left of a spring, to its right.
AT_LEFT, AT_RIGHT = 1, 2


class PieceScratch(NamedTuple):
    """Scratch: torn (n,) = the first particle of a body that lost a spring, -1: of none; label (n,): see components.py.

    has_triangles, has_solids (n,): by first particle of a torn body; beside (m,): AT_LEFT and AT_RIGHT, added up.
    """

    torn: Slots
    label: Slots
    has_triangles: Flags
    has_solids: Flags
    beside: Slots


@inner_kernel
def new_piece_scratch(state: State, arena: Arena) -> PieceScratch:
    """Scratch for `part`."""
    particles, springs = state.owner.shape[0], state.spring_active.shape[0]
    return PieceScratch(
        new_slots(arena, particles), new_slots(arena, particles), new_flags(arena, particles),
        new_flags(arena, particles), new_slots(arena, springs),
    )  # fmt: skip


@inner_kernel
def part(state: State, springs: Slots, start: Slots, listed: Slots, work: PieceScratch) -> None:
    """Make bodies of the pieces of soft bodies that have just lost these springs (k,).

    Springs of particle p, inactive ones too: listed[start[p]:start[p + 1]].
    """
    for p in range(work.torn.shape[0]):
        work.torn[p] = -1
    for k in range(springs.shape[0]):
        _mark_torn(state, state.particle_a[springs[k]], work.torn)
        _mark_torn(state, state.particle_b[springs[k]], work.torn)
    _find_soft(state, work)
    _find_sides(state, start, listed, work)
    _outline_pieces(state, work)
    _number_pieces(state, work)


@inner_kernel
def _mark_torn(state: State, end: int, torn: Slots) -> None:
    # Mark the particles of the body of one.
    if torn[end] >= 0:
        return
    first = -1
    for p in range(torn.shape[0]):
        if state.particle_active[p] and state.owner[p] == state.owner[end]:
            first = p if first < 0 else first
            torn[p] = first


@inner_kernel
def _find_soft(state: State, work: PieceScratch) -> None:
    # Which of the torn bodies have triangles that keep their areas, whole or not, and which have solid edges.
    for k in range(state.constraint_kind.shape[0]):
        first = work.torn[state.corner_particle[state.constraint_first[k]]]
        if first >= 0 and state.constraint_kind[k] == AREA and state.constraint_corners[k] == TRIANGLE_CORNERS:
            work.has_triangles[first] = True
    for s in range(state.edge.shape[0]):
        first = work.torn[state.particle_a[s]]
        if first >= 0 and (state.edge[s] == SOLID_LEFT or state.edge[s] == SOLID_RIGHT):
            work.has_solids[first] = True


@inner_kernel
def _find_sides(state: State, start: Slots, listed: Slots, work: PieceScratch) -> None:
    # On which sides of springs whole triangles lie.
    for k in range(state.constraint_kind.shape[0]):
        corner = state.constraint_first[k]
        if (
            state.constraint_active[k]
            and state.constraint_kind[k] == AREA
            and state.constraint_corners[k] == TRIANGLE_CORNERS
            and work.torn[state.corner_particle[corner]] >= 0
        ):
            is_left = state.constraint_rest[k, 1] > 0.0
            for c in range(TRIANGLE_CORNERS):
                p = state.corner_particle[corner + c]
                q = state.corner_particle[corner + (c + 1) % TRIANGLE_CORNERS]
                _add_side(p if is_left else q, q if is_left else p, state, start, listed, work.beside)


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


@inner_kernel
def _outline_pieces(state: State, work: PieceScratch) -> None:
    for s in range(state.edge.shape[0]):
        first = work.torn[state.particle_a[s]]
        if first < 0 or not state.spring_active[s] or not (work.has_triangles[first] and work.has_solids[first]):
            continue
        if work.beside[s] == AT_LEFT:
            state.edge[s] = SOLID_LEFT
        elif work.beside[s] == AT_RIGHT:
            state.edge[s] = SOLID_RIGHT
        elif work.beside[s] != 0:
            state.edge[s] = NO_EDGE
        elif state.edge[s] != NO_EDGE:
            state.edge[s] = LINE


@inner_kernel
def _number_pieces(state: State, work: PieceScratch) -> None:
    # Only what had one number falls into pieces; what else is tied to a body holds it together no more.
    label, torn = work.label, work.torn
    for p in range(label.shape[0]):
        label[p] = p
    for s in range(state.spring_active.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if state.spring_active[s] and state.material[s] != GRAB_MATERIAL and torn[a] >= 0 and torn[a] == torn[b]:
            join(label, a, b)
    for p in range(label.shape[0]):
        first = torn[p]
        if first >= 0 and (work.has_triangles[first] or work.has_solids[first]):
            root = root_of(label, p)
            if root != root_of(label, first):
                state.owner[p] = -1 - root
