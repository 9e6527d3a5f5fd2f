"""The system of a world, which the direct solver solves: one bundle of arrays that every kernel takes.

Rows are particles, springs and constraints join them, bodies are the blocks of rows that nothing joins to others. Where
things lie is decided when topology or pins change (layout.py); all else is scratch of a step, no part of the state.
A kernel of one body is f(span, system, ...), with the body's Span of all three.
"""

from typing import NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, FloatTables, SlotRows, Slots
from sandbox.physics.jit import inlined_kernel
from sandbox.physics.solvers.linear.fronts import Fronts
from sandbox.physics.solvers.linear.sparse_ldl import Matrix
from sandbox.physics.untangling.triangle_clamp import ClampedTriangles

# Columns of `Bodies.spin`: the place [m] that a body turns about, the velocity [m/s] of that, inertia [kg m^2] and
# angular momentum [kg m^2/s] about it; whether its angle, not the sine of that, follows from those; the rates [1/s] at
# which chords lead inwards where the step begins, and where it ends; inertia and place there. STAR_MOMENTUM: angular
# momentum of v*, where the body gives way (giving_way.py).
SPIN_X, SPIN_Y, SPIN_VX, SPIN_VY, INERTIA, MOMENTUM, BY_ARC, INWARD, END_INWARD, END_INERTIA, END_X, END_Y = range(12)
STAR_MOMENTUM, SPIN_NUMBERS = 12, 13


class Bodies(NamedTuple):
    """First row, spring and constraint of each body and one past the last; free particle of lowest slot; if anchored.

    pivot: the row of the one pinned particle that holds it; -1: none does, -2: several do.

    The rest is scratch: touched by contacts; underdamped: some Cs is above its Cd; inverted, matched: see
    shape_matching.py; energy0 [J]: once forces, pins and drives have moved; bank [J]: what its energy bank has;
    spared [kg m^2/s], spin (b, SPIN_NUMBERS): see rigid_turn.py.
    """

    row_start: Slots
    spring_start: Slots
    constraint_start: Slots
    lowest: Slots
    pivot: Slots
    anchored: Flags
    touched: Flags
    underdamped: Flags
    inverted: Flags
    matched: Flags
    energy0: Floats
    bank: Floats
    spared: Floats
    spin: FloatRows


class Rows(NamedTuple):
    """One row for every particle that springs of the matrix touch: free ones in elimination order, then pinned ones.

    position [m]; x_moved [m]: once pins have moved; velocities [m/s]: start, v_star = v* after forces, v_star_matched =
    v* or what shape matching makes of it, slow, v = v', v_best, delta_v = D, saved_delta_v. inertia [kg] = mass, or
    what shape matching makes of it.
    """

    particle: Slots
    mass: Floats
    inverse_mass: Floats
    inertia: Floats
    position: FloatRows
    start: FloatRows
    v_star: FloatRows
    v_star_matched: FloatRows
    slow: FloatRows
    x_moved: FloatRows
    v: FloatRows
    v_best: FloatRows
    delta_v: FloatRows
    saved_delta_v: FloatRows


class Springs(NamedTuple):
    """The springs of the matrix by body: ends as rows, the block they share (-1: one end is pinned), and scratch.

    rest, start_rest [m]: rest length, and at the start of the step; K, K_beta [kg]: K and K beta of the equation,
    transverse [kg] = the geometric stiffness h T / l; k_h2 [kg]: k h^2 of their energy, that of a tick in one step
    where ticks choose their substeps; length, error, predicted [m]; normal; impulse, tangential, tension [N s].
    """

    slot: Slots
    row_a: Slots
    row_b: Slots
    block: Slots
    rest: Floats
    start_rest: Floats
    K: Floats
    K_beta: Floats
    transverse: Floats
    k_h2: Floats
    length: Floats
    error: Floats
    predicted: Floats
    impulse: Floats
    tangential: Floats
    tension: Floats
    normal: FloatRows


class Constraints(NamedTuple):
    """The constraints of many corners of the matrix by body: t of them, q corners.

    first (t+1,): where corners begin; row (q,); corner (q,): slots; block (t, 3): where the pairs of a narrow one's
    corners (0, 1), (1, 2), (2, 0) lie, -1: one is pinned; wide (t,): number among the body's wide ones, -1: narrow.
    rest and weight are those of the step, copied; stiffness, damping too, as the solver caps them. response (w, n, 2)
    and scale (w,): z and 1 / (1 / K + g . z) of the wide ones. All else is scratch, as that of springs: error and
    predicted of C; gradient, spare, place (q, 2); floor [kg] = k h^2 of what holds a triangle from outside, 0: nothing,
    K_with_floor [kg]: K with that of the floor where it is foreseen to push.
    """

    slot: Slots
    kind: Slots
    first: Slots
    row: Slots
    corner: Slots
    block: SlotRows
    wide: Slots
    rest: FloatRows
    weight: Floats
    place: FloatRows
    gradient: FloatRows
    spare: FloatRows
    stiffness: Floats
    damping: Floats
    K: Floats
    K_beta: Floats
    K_with_floor: Floats
    floor: Floats
    k_h2: Floats
    error: Floats
    predicted: Floats
    impulse: Floats
    response: FloatTables
    scale: Floats


class ShapeMatchGroups(NamedTuple):
    """The jellies of the matrix by body: g groups of triangles that share sides, of k particles in all.

    of_body (b+1,): first group of each body; start (g+1,): first particle of each; row (k,), form [m] (k, 2); sample
    (g,): a constraint of each. Of constraints (t,): group, -1: in none, and member (t, 3) = their corners among the k.
    inner (k,), fan (f, 4), fan_start (g+1,): see Jellies. Scratch: turns (k,); inverted (g,); drawn (g,): or wound.
    """

    of_body: Slots
    start: Slots
    row: Slots
    form: FloatRows
    sample: Slots
    group: Slots
    member: SlotRows
    inner: Flags
    fan: SlotRows
    fan_start: Slots
    turns: Slots
    inverted: Flags
    drawn: Flags


class System(NamedTuple):
    """All of it. matrix: the columns of large bodies are empty, those are in the fronts.

    triangles: the narrow areas among the constraints, by their numbers, over the rows and their `v`.
    """

    bodies: Bodies
    rows: Rows
    springs: Springs
    constraints: Constraints
    matrix: Matrix
    fronts: Fronts
    shape_match_groups: ShapeMatchGroups
    triangles: ClampedTriangles


class Span(NamedTuple):
    """The rows, springs and constraints of one body: the first of each, and one past the last."""

    first_row: int
    last_row: int
    first_spring: int
    last_spring: int
    first_constraint: int
    last_constraint: int


@inlined_kernel
def span_of(system: System, body: int) -> Span:
    """The span of a body."""
    bodies = system.bodies
    return Span(
        bodies.row_start[body],
        bodies.row_start[body + 1],
        bodies.spring_start[body],
        bodies.spring_start[body + 1],
        bodies.constraint_start[body],
        bodies.constraint_start[body + 1],
    )
