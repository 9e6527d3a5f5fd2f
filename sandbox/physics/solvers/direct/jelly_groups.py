"""The jellies among the constraints of the direct solver's system, which shape matching draws to their forms."""

from typing import NamedTuple

from sandbox.physics.arena import Arena, is_full, new_flags, new_float_rows, new_slot_rows, new_slots
from sandbox.physics.arrays import Flags, FloatRows, SlotRows, Slots
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel, set_field
from sandbox.physics.solvers.direct.system import ShapeMatchGroups, System
from sandbox.physics.state import State
from sandbox.physics.topology.sorting import place_among
from sandbox.physics.untangling.jellies import Jellies, group_triangles
from sandbox.physics.untangling.triangle_clamp import lay_out_collides, lay_out_triangles


class SystemTriangles(NamedTuple):
    """The constraints that are areas of three corners (t,), their rows (t, 3), and whether their forms run
    counter-clockwise."""

    constraint: Slots
    row: SlotRows
    is_left: Flags


class PlacedConstraints(NamedTuple):
    """Constraints by body, see Constraints, and the first of each body."""

    slot: Slots
    kind: Slots
    first: Slots
    row: Slots
    corner: Slots
    wide: Slots
    constraint_start: Slots


@inner_kernel
def choose_areas(given: PlacedConstraints, rest: FloatRows, found: SystemTriangles) -> int:
    """Choose the triangles, rest (k, 2): see constraint_rest; how many there are."""
    count = 0
    for k in range(given.slot.shape[0]):
        if given.kind[k] == AREA and given.wide[k] < 0:
            found.constraint[count] = k
            found.is_left[count] = rest[given.slot[k], 1] > 0.0
            for c in range(3):
                found.row[count, c] = given.row[given.first[k] + c]
            count += 1
    return count


@inner_kernel
def fill_groups(
    given: PlacedConstraints, found: SystemTriangles, jellies: Jellies, corner_form: FloatRows, groups: ShapeMatchGroups
) -> None:
    """Fill in where the groups lie and what their forms are; corner_form [m] (q, 2): of a world's corners."""
    for k in range(groups.group.shape[0]):
        groups.group[k] = -1
        for c in range(3):
            groups.member[k, c] = -1
    for t in range(found.constraint.shape[0]):
        k = found.constraint[t]
        groups.group[k] = jellies.group[t]
        for c in range(3):
            groups.member[k, c] = jellies.member[t, c]
    # Constraints lie by body, and so do their groups, in the order of the first of each.
    for g in range(groups.sample.shape[0]):
        groups.sample[g] = found.constraint[jellies.first[g]]
    for b in range(groups.of_body.shape[0]):
        groups.of_body[b] = place_among(given.constraint_start[b], groups.sample, 0, groups.sample.shape[0])
    for i in range(groups.row.shape[0]):
        t = jellies.corner[i] // 3
        corner = given.corner[given.first[found.constraint[t]] + jellies.corner[i] % 3]
        for axis in range(2):
            groups.form[i, axis] = corner_form[corner, axis]


@inner_kernel
def lay_out_groups(state: State, constraint_start: Slots, arena: Arena, out: System) -> None:
    """Lay out the groups of a system's constraints, and its triangles; constraint_start (b+1,): first of each body."""
    made, count, rows = out.constraints, out.constraints.slot.shape[0], out.rows.particle.shape[0]
    given = PlacedConstraints(made.slot, made.kind, made.first, made.row, made.corner, made.wide, constraint_start)
    room = SystemTriangles(new_slots(arena, count), new_slot_rows(arena, count, 3), new_flags(arena, count))
    if is_full(arena):
        return
    areas = choose_areas(given, state.constraint_rest, room)
    found = SystemTriangles(room.constraint[:areas], room.row[:areas], room.is_left[:areas])
    jellies = group_triangles(found.row, found.is_left, state.owner.shape[0], arena)
    members, kinds = jellies.particle.shape[0], jellies.first.shape[0]
    groups = ShapeMatchGroups(
        new_slots(arena, constraint_start.shape[0]), jellies.start, jellies.particle,
        new_float_rows(arena, members, 2), new_slots(arena, kinds), new_slots(arena, count),
        new_slot_rows(arena, count, 3), jellies.inner, jellies.fan, jellies.fan_start, new_slots(arena, members),
        new_flags(arena, kinds), new_flags(arena, kinds),
    )  # fmt: skip
    set_field(out, "shape_match_groups", groups)
    lay_out_triangles(found.constraint, found.row, jellies, count, rows, arena, out.triangles)
    lay_out_collides(found.row, state, out.rows.particle, arena, out.triangles)
    if is_full(arena):
        return
    fill_groups(given, found, jellies, state.corner_form, groups)
    set_field(out.triangles, "rest", made.rest)
    set_field(out.triangles, "position", out.rows.position)
    set_field(out.triangles, "velocity", out.rows.v)
    set_field(out.triangles, "mass", out.rows.mass)
    set_field(out.triangles, "inverse_mass", out.rows.inverse_mass)
    set_field(out.triangles, "inverted", groups.inverted)
