"""Pieces: what a cut leaves of a soft body. Each is a body of its own, with the outline of the triangles left to it.

A soft body is one that keeps the areas of triangles, or has a solid outline. The piece of its first particle keeps the
body's number as owner; any other has -1 - p, p = its own first particle. Where a body has a solid outline, that of a
piece runs along the springs that have a whole triangle on one side alone; an edge without one is a line. Of a cell of a
grid that lost a corner, the triangle of its other corners keeps its area from then on, though it was halved the other
way. All of this is state, and nothing is kept beside it: what restores that joins the pieces again.

At an articulation point (a cut vertex) the outline of a body passes twice, and what holds it together without that
particle are several parts. They would swing about it into each other, so the smaller ones let go of it: the springs
that tie it to them are cut with those that were cut. What would keep no whole triangle then is no such part, and stays.

The sides of a constraint are springs that act between two corners. What loses one ends; triangles lie at the others.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.components import join, root_of
from sandbox.physics.constraints import AREA, measure_constraint
from sandbox.physics.geometry.segment import doubled_area_of
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL, LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.state import GoodValues, State

# Sides with a triangle on one side alone that a fan of triangles around a particle has.
RIMS_OF_FAN = 2
TRIANGLE_CORNERS = 3
# A whole triangle of solid form lies to the left of a spring, to its right.
AT_LEFT, AT_RIGHT = 1, 2


class ArticulationScratch(NamedTuple):
    """Scratch: rims (n,) = sides at a particle with a triangle on one side alone; label (n,): see components.py.

    size, tied (n,): whole triangles of a part, and those of them with the point as a corner, by the part's label.
    """

    rims: Annotated[Slots, "particles"]
    label: Annotated[Slots, "particles"]
    size: Annotated[Slots, "particles"]
    tied: Annotated[Slots, "particles"]


class PieceScratch(NamedTuple):
    """Scratch: torn (n,) = the first particle of a body that lost a spring, -1: of none; label (n,): see components.py.

    has_triangles, has_solids (n,): by first particle of a torn body; beside (m,): AT_LEFT and AT_RIGHT, added up.
    """

    torn: Annotated[Slots, "particles"]
    label: Annotated[Slots, "particles"]
    has_triangles: Annotated[Flags, "particles"]
    has_solids: Annotated[Flags, "particles"]
    beside: Annotated[Slots, "springs"]
    articulation: ArticulationScratch


@inner_kernel
def part(
    state: State, good: GoodValues, springs: Slots, start: Slots, listed: Slots, gone: Flags, work: PieceScratch
) -> None:  # fmt: skip
    """Make bodies of the pieces of soft bodies that have lost springs: those at which these springs (k,) are or were.

    Springs of particle p, inactive ones too: listed[start[p]:start[p + 1]]. gone (m,): what was taken out, to which the
    springs are added that hold the smaller parts at an articulation point.
    """
    for p in range(work.torn.shape[0]):
        work.torn[p] = -1
    for k in range(springs.shape[0]):
        mark_torn(state, state.particle_a[springs[k]], work.torn)
        mark_torn(state, state.particle_b[springs[k]], work.torn)
    _find_soft(state, work)
    _find_whole(state, good, start, listed, work)
    while _cut_articulation(state, work.torn, work.beside, gone, work.articulation):
        end_constraints(state, start, listed, gone)
        _find_whole(state, good, start, listed, work)
    _outline_pieces(state, work)
    _number_pieces(state, work)


@inner_kernel
def mark_torn(state: State, end: int, torn: Slots) -> None:
    """Mark the particles of the body of one by the first of them (n,), where they are not marked yet."""
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
        if first >= 0 and _is_triangle(state, k):
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
    _find_sides(state, work.torn, start, listed, work.beside)


@inner_kernel
def _is_ended_triangle(state: State, k: int, torn: Slots) -> bool:
    return (
        not state.constraint_active[k]
        and _is_triangle(state, k)
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
    is_one = _acts_between(state, b, x, start, listed) and _acts_between(state, x, d, start, listed)
    is_two = _acts_between(state, d, y, start, listed) and _acts_between(state, y, b, start, listed)
    if not (one * area > 0.0 and two * area > 0.0 and (is_one or is_two)):
        return
    if not _acts_between(state, b, d, start, listed):
        return
    bx, by, xx, xy = form[beyond, 0], form[beyond, 1], form[after, 0], form[after, 1]
    yx, yy, dx, dy = form[last, 0], form[last, 1], form[other, 0], form[other, 1]
    for t in range(2):
        at, inflation = state.constraint_first[k + t], state.constraint_rest[k + t, 0] / state.constraint_rest[k + t, 1]
        _place_corner(state, good, at, b, bx, by)
        _place_corner(state, good, at + 1, x if t == 0 else d, xx if t == 0 else dx, xy if t == 0 else dy)
        _place_corner(state, good, at + 2, d if t == 0 else y, dx if t == 0 else yx, dy if t == 0 else yy)
        # What a triangle keeps from now on, as its form has it.
        measure_constraint(state, good, k + t, inflation)
        state.constraint_active[k + t] = is_one if t == 0 else is_two


@inner_kernel
def _place_corner(state: State, good: GoodValues, corner: int, particle: int, x: float, y: float) -> None:
    state.corner_particle[corner] = particle
    state.corner_form[corner, 0] = good.corner_form[corner, 0] = x
    state.corner_form[corner, 1] = good.corner_form[corner, 1] = y


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


@inner_kernel
def _cut_articulation(state: State, torn: Slots, beside: Slots, gone: Flags, work: ArticulationScratch) -> bool:
    """Take out the springs by which the first articulation point of torn bodies holds its smaller parts; whether any.

    torn (n,), beside (m,): see `_find_sides`; gone (m,): what was taken out is added.
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
def _find_parts(state: State, point: int, torn: Slots, work: ArticulationScratch) -> None:
    # What is joined without a particle.
    label, size, tied = work.label, work.size, work.tied
    for p in range(label.shape[0]):
        label[p] = p
        size[p] = tied[p] = 0
    for s in range(state.spring_active.shape[0]):
        if point not in (state.particle_a[s], state.particle_b[s]) and _holds(state, s, torn):
            join(label, state.particle_a[s], state.particle_b[s])
    for k in range(state.constraint_kind.shape[0]):
        if is_whole_triangle(state, k):
            first, has_point, other = state.constraint_first[k], False, -1
            for c in range(first, first + TRIANGLE_CORNERS):
                has_point = has_point or state.corner_particle[c] == point
                other = other if state.corner_particle[c] == point else state.corner_particle[c]
            if torn[other] == torn[point]:
                size[root_of(label, other)] += 1
                tied[root_of(label, other)] += 1 if has_point else 0


@inner_kernel
def _part_at(state: State, point: int, torn: Slots, gone: Flags, work: ArticulationScratch) -> bool:
    # Take out the springs that tie a point to parts other than the largest, of equal ones the first; whether there are.
    size, tied, largest = work.size, work.tied, -1
    for part in range(size.shape[0]):
        if tied[part] > 0 and (largest < 0 or size[part] > size[largest]):
            largest = part
    found = False
    for s in range(state.spring_active.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if point in (a, b) and _holds(state, s, torn):
            part = root_of(work.label, b if a == point else a)
            if part != largest and size[part] > tied[part] > 0:
                gone[s] = True
                state.spring_active[s] = False
                found = True
    return found


@inner_kernel
def _is_triangle(state: State, k: int) -> bool:
    """Whether a constraint is the area of a triangle, whole or ended."""
    return state.constraint_kind[k] == AREA and state.constraint_corners[k] == TRIANGLE_CORNERS


@inner_kernel
def is_whole_triangle(state: State, k: int) -> bool:
    """Whether a constraint is the area of a triangle, and acts."""
    return state.constraint_active[k] and _is_triangle(state, k)


@inner_kernel
def _acts_between(state: State, p: int, q: int, start: Slots, listed: Slots) -> bool:
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
def _find_sides(state: State, torn: Slots, start: Slots, listed: Slots, beside: Slots) -> None:
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
