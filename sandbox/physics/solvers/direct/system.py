"""The system of a world, which the direct solver solves: one bundle of arrays that every kernel takes.

Rows are particles, springs and constraints join them, bodies are the blocks of rows that nothing joins to others. Where
things lie is decided when topology or pins change (layout.py); all else is scratch of a step, no part of the state.
A kernel of one body is f(span, system, ...), with the body's Span of all three.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Floats, FloatTables, SlotRows, Slots
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.solvers.linear.fronts import Fronts
from sandbox.physics.solvers.linear.sparse_ldl import Matrix
from sandbox.physics.state import State
from sandbox.physics.untangling.triangle_clamp import AS_IT_WAS, ClampedTriangles, clamp_triangles

# Columns of `Bodies.spin`: the place [m] that a body turns about, the velocity [m/s] of that, inertia [kg m^2] and
# angular momentum [kg m^2/s] about it; whether its angle, not the sine of that, follows from those; the rates [1/s] at
# which chords lead inwards where the step begins, and where it ends; inertia and place there.
SPIN_X, SPIN_Y, SPIN_VX, SPIN_VY, INERTIA, MOMENTUM, BY_ARC, INWARD, END_INWARD, END_INERTIA, END_X, END_Y = range(12)
SPIN_NUMBERS = 12
# The ways through the test. The last one that a substep of a body alone or of an island needed is counted, which no
# tick reads. The first linear solve passed; one more did; the minimum of f did; what moves within was slowed down until
# it passed. Counted beside them: bodies that answered to contacts by the masses of their particles, see islands.py.
PASSED, SOLVED_ON, MINIMISED, SLOWED_DOWN, BY_MASS, WAYS = range(6)


class Bodies(NamedTuple):
    """First row, spring and constraint of each body and one past the last; from touched on scratch."""

    row_start: Annotated[Slots, "bodies + 1"]
    spring_start: Annotated[Slots, "bodies + 1"]
    constraint_start: Annotated[Slots, "bodies + 1"]
    lowest: Annotated[Slots, "bodies"]  # its free particle of lowest slot
    pivot: Annotated[Slots, "bodies"]  # row of the one pinned particle that holds it; -1: none does, -2: several do
    anchored: Annotated[Flags, "bodies"]
    touched: Annotated[Flags, "bodies"]  # by contacts
    work: Slots  # (b + 1,): see work_of_bodies
    underdamped: Annotated[Flags, "bodies"]  # some Cs is above its Cd
    inverted: Annotated[Flags, "bodies"]  # inverted, matched: see step_body.py
    matched: Annotated[Flags, "bodies"]
    energy0: Annotated[Floats, "bodies"]  # [J]: once forces, pins and drives have moved
    budget: Annotated[Floats, "bodies"]  # [J]: what its energy budget has
    unreturnable0: Annotated[Floats, "bodies"]  # [J]: what its springs count at the start and cannot give back
    way: Annotated[Slots, "bodies"]  # alone, through the test
    unreturnable: Annotated[Floats, "bodies"]  # [J]: likewise, at the end
    spared: Annotated[Floats, "bodies"]  # [kg m^2/s]: see rigid_turn.py
    spin: Annotated[FloatRows, f"bodies, {SPIN_NUMBERS}"]  # likewise


class Rows(NamedTuple):
    """One row for every particle that springs of the matrix touch: free ones in elimination order, then pinned ones."""

    particle: Annotated[Slots, "rows"]
    mass: Annotated[Floats, "rows"]  # [kg]
    inverse_mass: Annotated[Floats, "rows"]
    inertia: Annotated[Floats, "rows"]  # [kg]: mass, or what shape matching makes of it
    position: Annotated[FloatRows, "rows, 2"]  # [m]
    start: Annotated[FloatRows, "rows, 2"]  # [m/s], as all below but x_moved: before forces
    v_star: Annotated[FloatRows, "rows, 2"]  # v*, after forces
    v_star_matched: Annotated[FloatRows, "rows, 2"]  # v*, or what shape matching makes of it
    slow: Annotated[FloatRows, "rows, 2"]  # see network.py
    x_moved: Annotated[FloatRows, "rows, 2"]  # [m]: once pins have moved
    v: Annotated[FloatRows, "rows, 2"]  # v'
    v_best: Annotated[FloatRows, "rows, 2"]
    delta_v: Annotated[FloatRows, "rows, 2"]  # D
    saved_delta_v: Annotated[FloatRows, "rows, 2"]


class Springs(NamedTuple):
    """The springs of the matrix by body, and their scratch."""

    slot: Annotated[Slots, "springs"]
    row_a: Annotated[Slots, "springs"]  # row_a, row_b: ends
    row_b: Annotated[Slots, "springs"]
    block: Annotated[Slots, "springs"]  # that its ends share, -1: one end is pinned
    rest: Annotated[Floats, "springs"]  # [m]
    start_rest: Annotated[Floats, "springs"]  # [m]: rest length at the start of the step
    K: Annotated[Floats, "springs"]  # [kg]: K of the equation
    K_beta: Annotated[Floats, "springs"]  # [kg]: K beta
    transverse: Annotated[Floats, "springs"]  # [kg]: geometric stiffness h T / l
    k_h2: Annotated[Floats, "springs"]  # [kg]: k h^2 of its energy; with substeps by choice that of a tick in one step
    length: Annotated[Floats, "springs"]  # [m]
    error: Annotated[Floats, "springs"]  # [m]
    predicted: Annotated[Floats, "springs"]  # [m]
    impulse: Annotated[Floats, "springs"]  # [N s]
    tangential: Annotated[Floats, "springs"]  # [N s]
    tension: Annotated[Floats, "springs"]  # [N s]
    normal: Annotated[FloatRows, "springs, 2"]


class Constraints(NamedTuple):
    """The constraints of many corners of the matrix by body, t of them with q corners in all, and their scratch."""

    slot: Annotated[Slots, "constraints"]
    kind: Annotated[Slots, "constraints"]
    first: Annotated[Slots, "constraints + 1"]  # (t + 1,): where corners begin
    row: Annotated[Slots, "corners"]  # (q,)
    corner: Annotated[Slots, "corners"]  # (q,): slots
    block: Annotated[SlotRows, "constraints, 3"]  # of corners (0, 1), (1, 2), (2, 0) of a narrow one, -1: one is pinned
    wide: Annotated[Slots, "constraints"]  # (t,): number among the body's wide ones, -1: narrow
    rest: Annotated[FloatRows, "constraints, 2"]  # rest, weight: those of the step, copied
    weight: Annotated[Floats, "corners"]
    place: Annotated[FloatRows, "corners, 2"]  # as gradient and spare
    gradient: Annotated[FloatRows, "corners, 2"]
    spare: Annotated[FloatRows, "corners, 2"]
    stiffness: Annotated[Floats, "constraints"]  # stiffness, damping: as the solver caps them
    damping: Annotated[Floats, "constraints"]
    K: Annotated[Floats, "constraints"]
    K_beta: Annotated[Floats, "constraints"]
    K_with_floor: Annotated[Floats, "constraints"]  # [kg]: K with that of the floor where it is predicted to push
    floor: Annotated[Floats, "constraints"]  # [kg]: k h^2 of what holds a triangle from outside, 0: nothing
    k_h2: Annotated[Floats, "constraints"]
    error: Annotated[Floats, "constraints"]  # error, predicted: of C
    predicted: Annotated[Floats, "constraints"]
    impulse: Annotated[Floats, "constraints"]
    response: Annotated[FloatTables, "most_wide, answered, 2"]  # (w, n, 2): z of the wide ones
    scale: Annotated[Floats, "constraints"]  # 1 / (1 / K + g . z) of wide ones


class ShapeMatchGroups(NamedTuple):
    """The jellies of the matrix by body: g groups of triangles that share sides, of k particles in all."""

    of_body: Annotated[Slots, "bodies + 1"]  # (b + 1,): first group of each body
    start: Slots  # (g + 1,): first particle of each group
    row: Slots  # (k,)
    form: Annotated[FloatRows, "members, 2"]  # [m] (k, 2)
    sample: Annotated[Slots, "groups"]  # (g,): a constraint of each
    group: Annotated[Slots, "constraints"]  # (t,) of a constraint, -1: in none
    member: Annotated[SlotRows, "constraints, 3"]  # (t, 3): its corners among the k
    inner: Flags  # inner, fan, fan_start: see Jellies
    fan: SlotRows
    fan_start: Slots
    turns: Annotated[Slots, "members"]  # (k,): scratch, as the two below
    inverted: Annotated[Flags, "groups"]  # (g,)
    drawn: Annotated[Flags, "groups"]  # (g,): inverted or wound


class System(NamedTuple):
    """The bodies of the direct solver, and their matrix, in which the columns of large bodies are empty: see fronts.

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


@inner_kernel
def worth_of_sharing(count: int, bodies: Slots, work: Slots) -> int:
    """What a parallel loop over bodies[:count] could save: their work, but for the longest, which is shared itself.

    work (b,): of each body. bodies: empty: all.
    """
    total = longest = 0
    for k in range(count):
        one = work[bodies[k] if bodies.shape[0] > 0 else k]
        total += one
        longest = max(longest, one)
    return total - longest


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


@inner_kernel
def copy(span: Span, source: FloatRows, destination: FloatRows) -> None:
    """Copy the rows of a body from one array (n, 2) to another."""
    for r in range(span.first_row, span.last_row):
        destination[r, 0] = source[r, 0]
        destination[r, 1] = source[r, 1]


@inner_kernel
def clear(span: Span, vector: FloatRows) -> None:
    """Set the rows of a body of an array (n, 2) to 0."""
    for r in range(span.first_row, span.last_row):
        vector[r, 0] = vector[r, 1] = 0.0


@inner_kernel
def scale(span: Span, factor: float, vector: FloatRows) -> None:
    """Multiply the rows of a body of an array (n, 2)."""
    for r in range(span.first_row, span.last_row):
        vector[r, 0] *= factor
        vector[r, 1] *= factor


@inner_kernel
def kinetic(span: Span, mass: Floats, velocity: FloatRows) -> float:
    """Kinetic energy of one body [J]."""
    # 1/2 |v|^2_M
    total = 0.0
    for r in range(span.first_row, span.last_row):
        total += 0.5 * mass[r] * (velocity[r, 0] * velocity[r, 0] + velocity[r, 1] * velocity[r, 1])
    return total


@inner_kernel
def store(span: Span, system: System, state: State) -> None:
    """Give the particles of a body the velocities `v`, and its springs their tensions."""
    rows, springs = system.rows, system.springs
    for r in range(span.first_row, span.last_row):
        state.velocity[rows.particle[r], 0] = rows.v[r, 0]
        state.velocity[rows.particle[r], 1] = rows.v[r, 1]
    for k in range(span.first_spring, span.last_spring):
        state.tension[springs.slot[k]] = springs.tension[k]


@inner_kernel
def hold_triangles(span: Span, system: System, h: float) -> int:
    """Clamp `v` so that no triangle of a body turns over in a step of h [s]; what that took: see clamp_triangles."""
    if span.last_constraint == span.first_constraint:
        return AS_IT_WAS
    return clamp_triangles(
        span.first_constraint, span.last_constraint, span.first_row, span.last_row, system.triangles, h
    )  # fmt: skip
