"""A clean cut: what keeps the areas of triangles is parted along the points at which springs are cut.

The triangles about them are divided (meshing/splitting.py), and what follows from that is written into the state: new
particles, springs and areas in rows behind all others, particles that moved onto the line with their places at rest,
and lengths and areas at rest of all that they are a part of. What was strained stays so. New particles get their masses
from the ends of the springs that they lie on, and velocities so that momentum stays, and its moment.
"""

import math
from typing import Annotated, NamedTuple

from sandbox.physics.arena import NO_ARENA, Arena, is_full, new_tuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Slots
from sandbox.physics.collision.pieces import TRIANGLE_CORNERS, is_whole_triangle, mark_torn
from sandbox.physics.commands.kept_motion import motion_of, settle_motion
from sandbox.physics.constraints import AREA, measure_constraint
from sandbox.physics.geometry.segment import polygon_area
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_MATERIAL, MOST_PARTICLES, MOST_SPRINGS, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.meshing.splitting import (
    TRIANGLES,
    VERTICES,
    SplitMesh,
    add_triangle,
    add_vertex,
    collapse_short,
    open_line,
    set_back,
    smooth_line,
)
from sandbox.physics.state import GoodValues, State
from sandbox.physics.topology.sorting import list_ends

# What a cut asks for behind the places at which springs are cut, and is given then: rows of particles, springs,
# constraints and corners.
ASKED = 4
ROWS_MISSING, TOO_MANY = 1, 2
# Where the outline is cut nearer to a particle than this share of a spring, it is cut there; where anything else is cut
# as near to the outline, it is cut as far from it, so that no piece is of no size.
NEAR_BORDER = 0.06
# Nearest to a particle that anything is cut, as a share of a spring.
NEAREST = 1e-6
# The edges of the pieces lie back from the line by the radius of what touches, so that they do no more than touch; at
# most by this [spacings].
MOST_BACK = 0.1
# What a particle gives away of its mass at most, to new ones that lie on its springs.
GIVEN = 0.5


class LineScratch(NamedTuple):
    """Scratch of a cut along a line: where springs are cut, -1: nowhere; their triangles, and what is near."""

    share: Annotated[Floats, "springs"]
    middle: Annotated[Slots, "springs"]  # 1 + the vertex on a spring
    start: Annotated[Slots, "particles + 1"]
    listed: Annotated[Slots, "2 * springs"]
    torn: Annotated[Slots, "particles"]
    vertex: Annotated[Slots, "particles"]  # 1 + the vertex of a particle
    form: Annotated[FloatRows, "particles, 2"]
    has_form: Annotated[Flags, "particles"]
    is_near: Annotated[Flags, "particles"]
    is_border: Annotated[Flags, "particles"]
    moved_to: Annotated[Slots, "particles"]  # 1 + the vertex at which a particle is from now on
    velocity: Annotated[FloatRows, "particles, 2"]  # as before
    origin: Annotated[FloatRows, "particles, 2"]
    halves: Annotated[Slots, "particles"]  # new particles on springs of a particle
    mass: Annotated[Floats, "particles"]
    spring: Annotated[Slots, "constraints"]  # 1 + a spring that is cut, of a triangle
    is_written: Annotated[Flags, "constraints"]
    factor: Annotated[Floats, "constraints"]  # area wanted, as a multiple of the form's
    factor_now: Annotated[Floats, "constraints"]


@inner_kernel
def cut_along(state: State, good: GoodValues, springs: Slots, numbers: Floats, arena: Arena) -> int:
    """Part what keeps areas along the shares at which springs (k,) are cut: 0, NO_ARENA, ROWS_MISSING or TOO_MANY.

    numbers (k + ASKED,): shares, then 0, or the rows that are new and not in use, which are the last of their families;
    where there are too few, those that are needed, and nothing is changed.
    """
    work = new_tuple(
        LineScratch, arena, particles=state.owner.shape[0], springs=state.law.shape[0],
        constraints=state.constraint_kind.shape[0],
    )  # fmt: skip
    if is_full(arena):
        return NO_ARENA
    divided, near = _find_near(state, springs, numbers, work)
    if divided == 0:
        return 0
    mesh = new_tuple(SplitMesh, arena, vertices=3 * near + 2 * springs.shape[0], triangles=near + 3 * divided)
    if is_full(arena):
        return NO_ARENA
    _divide(state, work, mesh)
    spacing = _spacing_of(state, work)
    smooth_line(mesh, spacing)
    open_line(mesh)
    collapse_short(mesh, spacing)
    set_back(mesh, min(_radius_of(state, work), MOST_BACK * spacing))
    asked, missing = numbers[springs.shape[0] :], 0.0
    particles, links, areas = _count_rows(state, work, mesh)
    for k in range(ASKED):
        needed = 1.0 * (particles if k == 0 else (links if k == 1 else (areas if k == 2 else TRIANGLE_CORNERS * areas)))
        missing = max(missing, needed - asked[k])
        asked[k] = needed
    if missing > 0.0:
        fits = state.owner.shape[0] + particles <= MOST_PARTICLES and state.law.shape[0] + links <= MOST_SPRINGS
        return ROWS_MISSING if fits else TOO_MANY
    _write(state, good, work, mesh, particles, links, areas)
    return 0


@inner_kernel
def _find_near(state: State, springs: Slots, numbers: Floats, work: LineScratch) -> tuple[int, int]:
    # Find the triangles that are divided, and those about them; how many of each.
    count = state.law.shape[0]
    list_ends(state.particle_a, state.particle_b, count, state.owner.shape[0], work.start, work.listed)
    for s in range(count):
        work.share[s] = -1.0
    for p in range(state.owner.shape[0]):
        work.torn[p] = -1
    _place_cuts(state, springs, numbers, work)
    divided, near = 0, 0
    for k in range(state.constraint_kind.shape[0]):
        first = state.constraint_first[k]
        for c in range(3 if is_whole_triangle(state, k) else 0):
            p, q = state.corner_particle[first + c], state.corner_particle[first + (c + 1) % 3]
            s = _spring_between(state, work, p, q, True)
            work.spring[k] = s + 1 if s >= 0 else work.spring[k]
        if work.spring[k] > 0:
            divided += 1
            mark_torn(state, state.corner_particle[first], work.torn)
            for c in range(first, first + 3):
                work.is_near[state.corner_particle[c]] = True
    for k in range(state.constraint_kind.shape[0]):
        if is_whole_triangle(state, k) and work.torn[state.corner_particle[state.constraint_first[k]]] >= 0:
            near += int(_is_near(state, work, k))
            for c in range(state.constraint_first[k], state.constraint_first[k] + TRIANGLE_CORNERS):
                p = state.corner_particle[c]
                work.has_form[p] = True
                for axis in range(2):
                    work.form[p, axis] = state.corner_form[c, axis]
    return divided, near


@inner_kernel
def _place_cuts(state: State, springs: Slots, numbers: Floats, work: LineScratch) -> None:
    # Where each spring is cut, at a particle of the outline or far enough from it.
    for s in range(state.edge.shape[0]):
        if state.spring_active[s] and _is_border(state, s):
            work.is_border[state.particle_a[s]] = work.is_border[state.particle_b[s]] = True
    for k in range(springs.shape[0]):
        s = springs[k]
        work.share[s] = numbers[k]
        if _is_border(state, s) and not NEAR_BORDER <= numbers[k] <= 1.0 - NEAR_BORDER:
            work.halves[state.particle_a[s] if numbers[k] < 0.5 else state.particle_b[s]] += 1
    for k in range(springs.shape[0]):
        s = springs[k]
        end = state.particle_a[s] if work.share[s] < 0.5 else state.particle_b[s]
        if _is_border(state, s) and work.halves[end] == 1 and not NEAR_BORDER <= work.share[s] <= 1.0 - NEAR_BORDER:
            work.share[s] = 0.0 if work.share[s] < 0.5 else 1.0
        else:
            near = NEAR_BORDER if work.is_border[end] else NEAREST
            work.share[s] = min(max(work.share[s], near), 1.0 - near)
    for p in range(work.halves.shape[0]):
        work.halves[p] = 0


@inner_kernel
def _is_border(state: State, s: int) -> bool:
    return state.edge[s] == SOLID_LEFT or state.edge[s] == SOLID_RIGHT


@inner_kernel
def _spring_between(state: State, work: LineScratch, p: int, q: int, is_cut: bool) -> int:
    # The spring that is cut between two particles, or acts on there; -1: none.
    for at in range(work.start[p], work.start[p + 1]):
        s = work.listed[at]
        is_such = state.spring_active[s] and (work.share[s] >= 0.0) == is_cut
        if is_such and q in (state.particle_a[s], state.particle_b[s]):
            return s
    return -1


@inner_kernel
def _is_near(state: State, work: LineScratch, k: int) -> bool:
    first, is_near = state.constraint_first[k], False
    for c in range(first, first + TRIANGLE_CORNERS):
        is_near = is_near or work.is_near[state.corner_particle[c]]
    return is_near


@inner_kernel
def _spacing_of(state: State, work: LineScratch) -> float:
    # The side [m] of a square as large as two of the triangles that are divided.
    total, count = 0.0, 0
    for k in range(state.constraint_kind.shape[0]):
        if work.spring[k] > 0:
            total += abs(state.constraint_rest[k, 1])
            count += 1
    return math.sqrt(2.0 * total / max(count, 1))


@inner_kernel
def _radius_of(state: State, work: LineScratch) -> float:
    # The radius [m] by which what is divided touches others, where it does.
    radius = 0.0
    for p in range(state.owner.shape[0]):
        if work.is_near[p] and state.collides[p] != 0:
            radius = max(radius, state.radius[p])
    return radius


@inner_kernel
def _divide(state: State, work: LineScratch, mesh: SplitMesh) -> None:
    # Fill in the mesh about the line.
    for k in range(state.constraint_kind.shape[0]):
        if not is_whole_triangle(state, k) or not _is_near(state, work, k):
            continue
        first = state.constraint_first[k]
        if work.torn[state.corner_particle[first]] < 0:
            continue
        # Counter-clockwise at rest.
        turned = polygon_area(state.corner_form, first, first + TRIANGLE_CORNERS) < 0.0
        a, b, c = first, first + (2 if turned else 1), first + (1 if turned else 2)
        a, b, c = state.corner_particle[a], state.corner_particle[b], state.corner_particle[c]
        p, q, r = _middle(state, work, mesh, a, b), _middle(state, work, mesh, b, c), _middle(state, work, mesh, c, a)
        a, b, c = _own(state, work, mesh, a), _own(state, work, mesh, b), _own(state, work, mesh, c)
        add_triangle(mesh, a, b, c, p, q, r, k)


@inner_kernel
def _own(state: State, work: LineScratch, mesh: SplitMesh, p: int) -> int:
    # The vertex of a particle.
    if work.vertex[p] == 0:
        v = add_vertex(mesh, p, p, p, 0.0, -1, not work.is_near[p] or _is_fixed(state, work, p))
        work.vertex[p] = v + 1
        for axis in range(2):
            mesh.at[v, axis], mesh.form[v, axis] = state.position[p, axis], work.form[p, axis]
    return work.vertex[p] - 1


@inner_kernel
def _is_fixed(state: State, work: LineScratch, p: int) -> bool:
    # Whether something else holds a particle where it is: a pin, a hand, another body.
    if state.inverse_mass[p] == 0.0:
        return True
    for at in range(work.start[p], work.start[p + 1]):
        s = work.listed[at]
        a, b = state.particle_a[s], state.particle_b[s]
        if state.spring_active[s] and (state.material[s] == GRAB_MATERIAL or state.owner[a] != state.owner[b]):
            return True
    return False


@inner_kernel
def _middle(state: State, work: LineScratch, mesh: SplitMesh, p: int, q: int) -> int:
    # The vertex where the spring between two particles is cut; -1: it is not.
    s = _spring_between(state, work, p, q, True)
    if s < 0:
        return -1
    if work.middle[s] == 0:
        a, b, share = state.particle_a[s], state.particle_b[s], work.share[s]
        v = add_vertex(mesh, -1, a, b, share, s, False)
        work.middle[s] = v + 1
        for axis in range(2):
            mesh.at[v, axis] = _between(state.position, a, b, share, axis)
            mesh.form[v, axis] = _between(work.form, a, b, share, axis)
    return work.middle[s] - 1


@inner_kernel
def _between(place: FloatRows, a: int, b: int, share: float, axis: int) -> float:
    return (1.0 - share) * place[a, axis] + share * place[b, axis]


@inner_kernel
def _is_first_side(mesh: SplitMesh, t: int, k: int) -> bool:
    # Whether a side of a part of a triangle is not one of a part before.
    v, w = mesh.corner[t, k], mesh.corner[t, (k + 1) % 3]
    for other in range(t):
        if mesh.is_there[other] and mesh.is_part[other]:
            for c in range(3):
                a, b = mesh.corner[other, c], mesh.corner[other, (c + 1) % 3]
                if (a == v and b == w) or (a == w and b == v):
                    return False
    return True


@inner_kernel
def _needs_spring(state: State, work: LineScratch, mesh: SplitMesh, t: int, k: int, new: int) -> bool:
    # Whether a side of a part is a spring that is not there. new: the first of new particles.
    if not _is_first_side(mesh, t, k):
        return False
    p, q = mesh.row[mesh.corner[t, k]], mesh.row[mesh.corner[t, (k + 1) % 3]]
    return not (0 <= p < new and 0 <= q < new and _spring_between(state, work, p, q, False) >= 0)


@inner_kernel
def _count_rows(state: State, work: LineScratch, mesh: SplitMesh) -> tuple[int, int, int]:
    # How many rows of particles, springs and areas are new.
    particles, links, areas = 0, 0, 0
    for t in range(mesh.counts[TRIANGLES]):
        if not (mesh.is_there[t] and mesh.is_part[t]):
            continue
        areas += int(work.is_written[mesh.source[t]])
        work.is_written[mesh.source[t]] = True
        for k in range(3):
            v = mesh.corner[t, k]
            particles += int(mesh.row[v] < 0 and mesh.mark[v] == 0)
            mesh.mark[v] = 1
            links += int(_needs_spring(state, work, mesh, t, k, state.owner.shape[0]))
    for k in range(work.is_written.shape[0]):
        work.is_written[k] = False
    return particles, links, areas


@inner_kernel
def _write(
    state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh, particles: int, links: int, areas: int
) -> None:  # fmt: skip
    new = state.owner.shape[0] - particles
    for p in range(state.owner.shape[0]):
        work.mass[p] = state.mass[p]
        for axis in range(2):
            work.velocity[p, axis], work.origin[p, axis] = state.velocity[p, axis], state.origin[p, axis]
    motion = motion_of(state, work.torn)
    _give_rows(work, mesh, new)
    _write_springs(state, good, work, mesh, state.law.shape[0] - links, new)
    _stretch_springs(state, good, work, mesh, state.law.shape[0] - links)
    _write_particles(state, good, work, mesh, new)
    _write_areas(state, good, work, mesh, areas)
    _stretch_constraints(state, good, work, mesh)
    settle_motion(state, good, work.torn, motion)


@inner_kernel
def _give_rows(work: LineScratch, mesh: SplitMesh, new: int) -> None:
    # Give new vertices their particles, and find those that moved.
    row = new
    for t in range(mesh.counts[TRIANGLES]):
        for k in range(3 if mesh.is_there[t] else 0):
            v = mesh.corner[t, k]
            if mesh.row[v] < 0:
                mesh.row[v] = row
                work.torn[row] = work.torn[mesh.one[v]]
                work.halves[mesh.one[v]] += 1
                work.halves[mesh.other[v]] += 1
                row += 1
            elif mesh.row[v] < new and mesh.spring[v] >= 0:
                work.moved_to[mesh.row[v]] = v + 1


@inner_kernel
def _form_length(a: int, b: int, form: FloatRows) -> float:
    x, y = form[b, 0] - form[a, 0], form[b, 1] - form[a, 1]
    return math.sqrt(x * x + y * y)


@inner_kernel
def _write_springs(state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh, row: int, new: int) -> None:
    # Springs along the sides of parts where none is, each like one that is cut there.
    first = row
    for t in range(mesh.counts[TRIANGLES]):
        for k in range(3 if mesh.is_there[t] and mesh.is_part[t] else 0):
            if not _needs_spring(state, work, mesh, t, k, new):
                continue
            v, w = mesh.corner[t, k], mesh.corner[t, (k + 1) % 3]
            s = mesh.spring[v] if mesh.spring[v] >= 0 else mesh.spring[w]
            s = s if s >= 0 else work.spring[mesh.source[t]] - 1
            a, b = state.particle_a[s], state.particle_b[s]
            length, before = _form_length(v, w, mesh.form), _form_length(a, b, work.form)
            factor = length / before if before > 0.0 else 1.0
            state.particle_a[row], state.particle_b[row] = mesh.row[v], mesh.row[w]
            state.rest_length[row] = good.rest_length[row] = factor * state.rest_length[s]
            state.natural_length[row] = factor * state.natural_length[s]
            # What goes on as the border that it was.
            if mesh.row[v] in (a, b) or mesh.row[w] in (a, b):
                state.belt[row] = state.belt[s] if state.edge[s] != NO_EDGE else 0.0
            _copy_spring(state, good, s, row)
            row += 1
    # What was looked for above is what acted before.
    for s in range(first, row):
        state.spring_active[s] = True


@inner_kernel
def _copy_spring(state: State, good: GoodValues, s: int, row: int) -> None:
    state.stiffness[row] = good.stiffness[row] = state.stiffness[s]
    state.damping[row] = good.damping[row] = state.damping[s]
    state.hooke_stiffness[row] = good.hooke_stiffness[row] = state.hooke_stiffness[s]
    state.hooke_damping[row] = good.hooke_damping[row] = state.hooke_damping[s]
    state.lowest_mode[row] = good.lowest_mode[row] = state.lowest_mode[s]
    state.stiffness_now[row], state.damping_now[row] = state.stiffness_now[s], state.damping_now[s]
    state.lowest_mode_now[row], state.ramp_ticks[row] = state.lowest_mode_now[s], state.ramp_ticks[s]
    state.law[row], state.material[row] = state.law[s], state.material[s]
    state.spring_untouchable[row] = state.spring_untouchable[s]
    state.edge[row] = NO_EDGE
    state.is_split[row] = True


@inner_kernel
def _place_of(p: int, work: LineScratch, mesh: SplitMesh, axis: int) -> float:
    # Where a particle of the mesh is at rest from now on.
    return mesh.form[work.moved_to[p] - 1, axis] if work.moved_to[p] > 0 else work.form[p, axis]


@inner_kernel
def _stretch_springs(state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh, count: int) -> None:
    # Lengths at rest of springs whose ends have moved.
    for s in range(count):
        a, b = state.particle_a[s], state.particle_b[s]
        if not state.spring_active[s] or work.share[s] >= 0.0 or state.material[s] == GRAB_MATERIAL:
            continue
        if work.moved_to[a] == 0 and work.moved_to[b] == 0:
            continue
        before, x, y = 0.0, 0.0, 0.0
        if work.has_form[a] and work.has_form[b]:
            before = _form_length(a, b, work.form)
            x = _place_of(b, work, mesh, 0) - _place_of(a, work, mesh, 0)
            y = _place_of(b, work, mesh, 1) - _place_of(a, work, mesh, 1)
        else:
            # What has no form is as it is now.
            before = _form_length(a, b, state.position)
            at_a, at_b, place = work.moved_to[a] - 1, work.moved_to[b] - 1, state.position
            x = (mesh.at[at_b, 0] if at_b >= 0 else place[b, 0]) - (mesh.at[at_a, 0] if at_a >= 0 else place[a, 0])
            y = (mesh.at[at_b, 1] if at_b >= 0 else place[b, 1]) - (mesh.at[at_a, 1] if at_a >= 0 else place[a, 1])
        if before > 0.0:
            factor = math.sqrt(x * x + y * y) / before
            state.rest_length[s] *= factor
            state.natural_length[s] *= factor
            good.rest_length[s] = state.rest_length[s]


@inner_kernel
def _write_particles(state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh, new: int) -> None:
    for v in range(mesh.counts[VERTICES]):
        p, a, b, share = mesh.row[v], mesh.one[v], mesh.other[v], mesh.share[v]
        if p >= new:
            _copy_particle(state, good, a if share < 0.5 else b, p)
            given = GIVEN * min(work.mass[a] / work.halves[a], work.mass[b] / work.halves[b])
            state.mass[p], state.inverse_mass[p] = given, 1.0 / given
            state.mass[a] -= (1.0 - share) * given
            state.mass[b] -= share * given
        elif p < 0 or work.moved_to[p] != v + 1:
            continue
        for axis in range(2):
            state.position[p, axis] = good.position[p, axis] = mesh.at[v, axis] + 0.0
            state.origin[p, axis] = _between(work.origin, a, b, share, axis)
            velocity = _between(work.velocity, a, b, share, axis)
            state.slow_velocity[p, axis] += velocity - state.velocity[p, axis]
            state.velocity[p, axis] = velocity
    for p in range(state.owner.shape[0]):
        if work.halves[p] > 0 and state.inverse_mass[p] > 0.0:
            state.inverse_mass[p] = 1.0 / state.mass[p]
        good.mass[p] = state.mass[p]


@inner_kernel
def _copy_particle(state: State, good: GoodValues, p: int, row: int) -> None:
    # All but its place, motion and mass.
    state.radius[row] = good.radius[row] = state.radius[p]
    state.gravity_scale[row] = good.gravity_scale[row] = state.gravity_scale[p]
    state.friction[row] = good.friction[row] = state.friction[p]
    state.restitution[row] = good.restitution[row] = state.restitution[p]
    state.rolling[row] = good.rolling[row] = state.rolling[p]
    state.rolls[row], state.unmoved[row] = state.rolls[p], state.unmoved[p]
    state.owner[row], state.group[row], state.collides[row] = state.owner[p], state.group[p], state.collides[p]
    state.untouchable[row], state.particle_active[row] = state.untouchable[p], True
    state.split_from[row] = state.split_from[p] if state.split_from[p] >= 0 else p


@inner_kernel
def _write_areas(state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh, count: int) -> None:
    # Of a triangle that is divided one part takes its row, others get new ones.
    rest, now = state.constraint_rest, state.constraint_area_now
    row, corner = rest.shape[0] - count, state.corner_particle.shape[0] - TRIANGLE_CORNERS * count
    for k in range(row):
        if work.spring[k] > 0:
            work.factor[k], work.factor_now[k] = rest[k, 0] / rest[k, 1], now[k] / rest[k, 1]
            state.constraint_active[k] = False
    for t in range(mesh.counts[TRIANGLES]):
        if not (mesh.is_there[t] and mesh.is_part[t]):
            continue
        source = mesh.source[t]
        k = source
        if work.is_written[source]:
            k = row
            row += 1
            state.constraint_first[k] = corner
            corner += TRIANGLE_CORNERS
            _copy_constraint(state, good, source, k)
        work.is_written[source], state.constraint_active[k] = True, True
        first = state.constraint_first[k]
        for c in range(TRIANGLE_CORNERS):
            state.corner_particle[first + c] = mesh.row[mesh.corner[t, c]]
            for axis in range(2):
                place = mesh.form[mesh.corner[t, c], axis]
                state.corner_form[first + c, axis] = good.corner_form[first + c, axis] = place
        measure_constraint(state, good, k, work.factor[source])
        now[k] = work.factor_now[source] * rest[k, 1]
    for k in range(rest.shape[0] - count):
        # What is left of no triangle has none of its corners.
        if work.spring[k] > 0 and not work.is_written[k]:
            for c in range(state.constraint_first[k] + 1, state.constraint_first[k] + TRIANGLE_CORNERS):
                state.corner_particle[c] = state.corner_particle[state.constraint_first[k]]


@inner_kernel
def _copy_constraint(state: State, good: GoodValues, source: int, k: int) -> None:
    state.constraint_kind[k], state.constraint_corners[k] = AREA, TRIANGLE_CORNERS
    state.constraint_material[k] = state.constraint_material[source]
    state.constraint_stiffness[k] = good.constraint_stiffness[k] = state.constraint_stiffness[source]
    state.constraint_damping[k] = good.constraint_damping[k] = state.constraint_damping[source]
    state.constraint_lowest_mode[k] = good.constraint_lowest_mode[k] = state.constraint_lowest_mode[source]
    state.constraint_stiffness_now[k] = state.constraint_stiffness_now[source]
    state.constraint_damping_now[k] = state.constraint_damping_now[source]
    state.constraint_lowest_mode_now[k] = state.constraint_lowest_mode_now[source]
    state.constraint_ramp_ticks[k] = state.constraint_ramp_ticks[source]
    state.constraint_area_ticks[k] = state.constraint_area_ticks[source]


@inner_kernel
def _stretch_constraints(state: State, good: GoodValues, work: LineScratch, mesh: SplitMesh) -> None:
    # What is not divided and has corners that moved.
    for k in range(work.spring.shape[0]):
        first, is_moved = state.constraint_first[k], False
        if work.spring[k] > 0 or not state.constraint_active[k]:
            continue
        for c in range(first, first + state.constraint_corners[k]):
            p = state.corner_particle[c]
            if work.moved_to[p] > 0 and not work.is_written[k]:
                is_moved = True
                for axis in range(2):
                    state.corner_form[c, axis] = good.corner_form[c, axis] = _place_of(p, work, mesh, axis)
        if is_moved:
            before, rest = state.constraint_rest[k, 1], state.constraint_rest
            is_area = state.constraint_kind[k] == AREA and before != 0.0
            measure_constraint(state, good, k, rest[k, 0] / before if is_area else 1.0)
            if is_area:
                state.constraint_area_now[k] *= rest[k, 1] / before
