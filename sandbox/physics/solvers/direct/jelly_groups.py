"""The jellies among the constraints of the direct solver's system, which shape matching draws to their forms."""

from typing import NamedTuple

import numpy as np

from sandbox.physics.collision.types import Flags
from sandbox.physics.constraints import AREA
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.solvers.direct.system import Constraints, ShapeMatchGroups
from sandbox.physics.state import Floats, Slots
from sandbox.physics.topology.sorting import place_among
from sandbox.physics.untangling.jellies import Jellies, group_triangles


class SystemTriangles(NamedTuple):
    """The constraints that are areas of three corners (t,), their rows (t, 3), and whether their forms run
    counter-clockwise."""

    constraint: Slots
    row: Slots
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
def choose_areas(given: PlacedConstraints, rest: Floats, found: SystemTriangles) -> int:
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


@kernel
def _choose_areas(given: PlacedConstraints, rest: Floats, found: SystemTriangles) -> int:
    return choose_areas(given, rest, found)


@inner_kernel
def fill_groups(
    given: PlacedConstraints, found: SystemTriangles, jellies: Jellies, corner_form: Floats, groups: ShapeMatchGroups
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


@kernel
def _fill_groups(
    given: PlacedConstraints, found: SystemTriangles, jellies: Jellies, corner_form: Floats, groups: ShapeMatchGroups
) -> None:
    fill_groups(given, found, jellies, corner_form, groups)


def group_constraints(
    constraints: Constraints, constraint_start: Slots, particles: int, rest: Floats, corner_form: Floats
) -> tuple[SystemTriangles, Jellies, ShapeMatchGroups]:
    """The triangles among constraints, their jellies and the groups that those are of a system of some particles.

    constraint_start (b+1,): first of each body. rest, corner_form: constraint_rest and corner_form of the world.
    """
    count = len(constraints.slot)
    given = PlacedConstraints(
        constraints.slot, constraints.kind, constraints.first, constraints.row, constraints.corner, constraints.wide,
        constraint_start,
    )  # fmt: skip
    room = SystemTriangles(np.zeros(count, np.int64), np.zeros((count, 3), np.int64), np.zeros(count, np.bool_))
    triangles = _choose_areas(given, rest, room)
    found = SystemTriangles(room.constraint[:triangles], room.row[:triangles], room.is_left[:triangles])
    jellies = group_triangles(found.row, found.is_left, particles)
    members, jelly_count = len(jellies.particle), len(jellies.first)
    inverted, drawn = np.zeros((2, jelly_count), np.bool_)
    groups = ShapeMatchGroups(
        of_body=np.zeros(len(constraint_start), np.int64), start=jellies.start, row=jellies.particle,
        form=np.zeros((members, 2)), sample=np.zeros(jelly_count, np.int64), group=np.zeros(count, np.int64),
        member=np.zeros((count, 3), np.int64), inner=jellies.inner, fan=jellies.fan, fan_start=jellies.fan_start,
        turns=np.zeros(members, np.int64), inverted=inverted, drawn=drawn,
    )  # fmt: skip
    _fill_groups(given, found, jellies, corner_form, groups)
    return found, jellies, groups
