"""Pieces: what a cut leaves of a soft body. Each is a body of its own, with the outline of the triangles left to it.

A soft body is one that keeps the areas of triangles, or has a solid outline. The piece of its first particle keeps the
body's number as owner; any other has -1 - p, p = its own first particle. Where a body has a solid outline, that of a
piece runs along the springs that have a whole triangle on one side alone; an edge without one is a line. Of a cell of a
grid that lost a corner, the triangle of its other corners keeps its area from then on, though it was halved the other
way. All of this is state, and nothing is kept beside it: what restores that joins the pieces again.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.collision.filter import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.collision.lobes import LobeScratch, let_go
from sandbox.physics.collision.sides import (
    AT_LEFT,
    AT_RIGHT,
    TRIANGLE_CORNERS,
    acts_between,
    end_constraints,
    find_sides,
    is_triangle,
)
from sandbox.physics.components import join, root_of
from sandbox.physics.constraints import AREA, measure_rest
from sandbox.physics.geometry.segment import doubled_area_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.state import GoodValues, State


class PieceScratch(NamedTuple):
    """Scratch: torn (n,) = the first particle of a body that lost a spring, -1: of none; label (n,): see components.py.

    has_triangles, has_solids (n,): by first particle of a torn body; beside (m,): AT_LEFT and AT_RIGHT, added up.
    """

    torn: Annotated[Slots, "particles"]
    label: Annotated[Slots, "particles"]
    has_triangles: Annotated[Flags, "particles"]
    has_solids: Annotated[Flags, "particles"]
    beside: Annotated[Slots, "springs"]
    lobes: LobeScratch


@inner_kernel
def part(
    state: State, good: GoodValues, springs: Slots, start: Slots, listed: Slots, gone: Flags, work: PieceScratch
) -> None:  # fmt: skip
    """Make bodies of the pieces of soft bodies that have lost springs: those at which these springs (k,) are or were.

    Springs of particle p, inactive ones too: listed[start[p]:start[p + 1]]. gone (m,): what was taken out, to which the
    springs are added that hold a lobe.
    """
    for p in range(work.torn.shape[0]):
        work.torn[p] = -1
    for k in range(springs.shape[0]):
        _mark_torn(state, state.particle_a[springs[k]], work.torn)
        _mark_torn(state, state.particle_b[springs[k]], work.torn)
    _find_soft(state, work)
    _find_whole(state, good, start, listed, work)
    while let_go(state, work.torn, work.beside, gone, work.lobes):
        end_constraints(state, start, listed, gone)
        _find_whole(state, good, start, listed, work)
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
        if first >= 0 and is_triangle(state, k):
            work.has_triangles[first] = True
    for s in range(state.edge.shape[0]):
        first = work.torn[state.particle_a[s]]
        if first >= 0 and (state.edge[s] == SOLID_LEFT or state.edge[s] == SOLID_RIGHT):
            work.has_solids[first] = True


@inner_kernel
def _find_whole(state: State, good: GoodValues, start: Slots, listed: Slots, work: PieceScratch) -> None:
    # Which triangles are whole, and on which sides of springs they lie.
    for k in range(state.constraint_kind.shape[0] - 1):
        if _is_ended_triangle(state, k, work.torn) and _is_ended_triangle(state, k + 1, work.torn):
            _halve_other_way(state, good, k, start, listed)
    find_sides(state, work.torn, start, listed, work.beside)


@inner_kernel
def _is_ended_triangle(state: State, k: int, torn: Slots) -> bool:
    return (
        not state.constraint_active[k]
        and is_triangle(state, k)
        and torn[state.corner_particle[state.constraint_first[k]]] >= 0
    )


@inner_kernel
def _corner_beyond(state: State, k: int, other: int) -> int:
    # The corner of triangle k that is none of another one's, which shares the other two; -1: it does not.
    beyond, count = -1, 0
    for c in range(state.constraint_first[k], state.constraint_first[k] + TRIANGLE_CORNERS):
        is_shared = False
        for d in range(state.constraint_first[other], state.constraint_first[other] + TRIANGLE_CORNERS):
            is_shared = is_shared or state.corner_particle[c] == state.corner_particle[d]
        if not is_shared:
            beyond = c
            count += 1
    return beyond if count == 1 else -1


@inner_kernel
def _halve_other_way(state: State, good: GoodValues, k: int, start: Slots, listed: Slots) -> None:
    # Two triangles with a common side, b x y and d y x, become b x d and b d y, and what of those is whole acts.
    beyond, other = _corner_beyond(state, k, k + 1), _corner_beyond(state, k + 1, k)
    if beyond < 0 or other < 0:
        return
    first = state.constraint_first[k]
    after = first + (beyond - first + 1) % TRIANGLE_CORNERS
    last = first + (beyond - first + 2) % TRIANGLE_CORNERS
    particle, form, area = state.corner_particle, state.corner_form, state.constraint_rest[k, 1]
    b, x, y, d = particle[beyond], particle[after], particle[last], particle[other]
    one, two = doubled_area_of(beyond, after, other, form), doubled_area_of(beyond, other, last, form)
    is_one = acts_between(state, b, x, start, listed) and acts_between(state, x, d, start, listed)
    is_two = acts_between(state, d, y, start, listed) and acts_between(state, y, b, start, listed)
    if not (one * area > 0.0 and two * area > 0.0 and (is_one or is_two)):
        return
    if not acts_between(state, b, d, start, listed):
        return
    bx, by, xx, xy = form[beyond, 0], form[beyond, 1], form[after, 0], form[after, 1]
    yx, yy, dx, dy = form[last, 0], form[last, 1], form[other, 0], form[other, 1]
    for t in range(2):
        at, inflation = state.constraint_first[k + t], state.constraint_rest[k + t, 0] / state.constraint_rest[k + t, 1]
        _place_corner(state, good, at, b, bx, by)
        _place_corner(state, good, at + 1, x if t == 0 else d, xx if t == 0 else dx, xy if t == 0 else dy)
        _place_corner(state, good, at + 2, d if t == 0 else y, dx if t == 0 else yx, dy if t == 0 else yy)
        _keep_area(state, good, k + t, inflation)
        state.constraint_active[k + t] = is_one if t == 0 else is_two


@inner_kernel
def _place_corner(state: State, good: GoodValues, corner: int, particle: int, x: float, y: float) -> None:
    state.corner_particle[corner] = particle
    state.corner_form[corner, 0] = good.corner_form[corner, 0] = x
    state.corner_form[corner, 1] = good.corner_form[corner, 1] = y


@inner_kernel
def _keep_area(state: State, good: GoodValues, k: int, inflation: float) -> None:
    # What a triangle keeps from now on, as its form has it.
    first = state.constraint_first[k]
    measure_rest(
        AREA, state.corner_form, first, first + TRIANGLE_CORNERS, state.constraint_rest, k, state.corner_weight
    )
    state.constraint_rest[k, 0] *= inflation
    for axis in range(2):
        good.constraint_rest[k, axis] = state.constraint_rest[k, axis]
    for c in range(first, first + TRIANGLE_CORNERS):
        good.corner_weight[c] = state.corner_weight[c]


@inner_kernel
def _outline_pieces(state: State, work: PieceScratch) -> None:
    for s in range(state.edge.shape[0]):
        first = work.torn[state.particle_a[s]]
        if first < 0 or work.torn[state.particle_b[s]] != first or not state.spring_active[s]:
            continue
        if not (work.has_triangles[first] and work.has_solids[first]):
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
