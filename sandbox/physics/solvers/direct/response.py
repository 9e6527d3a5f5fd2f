"""Response: the Delassus operator W = P A^-1 P^T [1/kg] of factored bodies, in blocks.

It says how particles P that contacts touch answer to impulses; and so for joints, which act on many particles at once.
"""

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.geometry.rigid import RigidMotion
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_rows import Joints
from sandbox.physics.solvers.contact.gauss_seidel import Delassus
from sandbox.physics.solvers.direct.islands import BodyIslands
from sandbox.physics.solvers.direct.network import respond
from sandbox.physics.solvers.direct.rigid_turn import add_torque
from sandbox.physics.solvers.direct.system import Constraints, Rows, Span, System, clear
from sandbox.physics.solvers.linear.fronts import subtract_pair


@inner_kernel
def load_block(
    k: int, span: Span, system: System, delassus: Delassus, columns: Floats, row: Slots, vector: FloatRows
) -> None:  # fmt: skip
    """The block k of a body, whose points are in the order of their rows; row (n,): of each particle.

    columns: scratch.
    """
    matrix, numbers = system.matrix, delassus.numbers
    first, base = delassus.start[k], delassus.base[k]
    points = delassus.start[k + 1] - first
    if system.fronts.of_row[span.first_row] >= 0:
        _load_column_wise(k, span, system, delassus, row, vector)
        return
    width = 2 * points
    for at in range((span.last_row - span.first_row) * 2 * width):
        columns[at] = 0.0
    for i in range(points):
        at = (row[delassus.point[first + i]] - span.first_row) * 2 * width + 2 * i
        columns[at] = 1.0
        columns[at + width + 1] = 1.0
    # Y = L^-1 P^T, two rows of it for each row of the body; a column begins at its own point.
    begun = 0
    for j in range(span.first_row, span.last_row):
        while begun < points and row[delassus.point[first + begun]] <= j:
            begun += 1
        if begun == 0:
            continue
        end = 2 * begun
        upper = (j - span.first_row) * 2 * width
        lower = upper + width
        subtract_pair(columns, lower, columns, upper, upper, matrix.diagonal[j, 1], 0.0, 0, end)
        for at in range(matrix.column_start[j], matrix.column_start[j + 1]):
            target = (matrix.row[at] - span.first_row) * 2 * width
            below = matrix.lower
            subtract_pair(columns, target, columns, upper, lower, below[at, 0], below[at, 1], 0, end)
            subtract_pair(columns, target + width, columns, upper, lower, below[at, 2], below[at, 3], 0, end)
    # W = Y^T D^-1 Y: its lower half, then the upper.
    for at in range(base, base + width * width):
        numbers[at] = 0.0
    begun = 0
    for j in range(span.first_row, span.last_row):
        while begun < points and row[delassus.point[first + begun]] <= j:
            begun += 1
        upper = (j - span.first_row) * 2 * width
        lower = upper + width
        for i in range(2 * begun):
            a = -columns[upper + i] * matrix.diagonal[j, 0]
            b = -columns[lower + i] * matrix.diagonal[j, 2]
            subtract_pair(numbers, base + i * width, columns, upper, lower, a, b, 0, i + 1)
    for i in range(width):
        for j in range(i):
            numbers[base + j * width + i] = numbers[base + i * width + j]
    _take_out_wide(k, span, system.constraints, delassus, row)


@inner_kernel
def _load_column_wise(k: int, span: Span, system: System, delassus: Delassus, row: Slots, vector: FloatRows) -> None:
    # A large body has its factor in fronts: one solution for each column.
    base = delassus.base[k]
    first = delassus.start[k]
    points = delassus.start[k + 1] - first
    for i in range(points):
        for axis in range(2):
            clear(span, vector)
            vector[row[delassus.point[first + i]], axis] = 1.0
            respond(span, system, vector)
            for j in range(points):
                at = base + (2 * j) * 2 * points + 2 * i + axis
                r = row[delassus.point[first + j]]
                delassus.numbers[at] = vector[r, 0]
                delassus.numbers[at + 2 * points] = vector[r, 1]


@inner_kernel
def _take_out_wide(k: int, span: Span, constraints: Constraints, delassus: Delassus, row: Slots) -> None:
    # W -= scale (P z) (P z)^T for each wide constraint, as network.py has it of A^-1.
    base = delassus.base[k]
    first = delassus.start[k]
    points = delassus.start[k + 1] - first
    for constraint in range(span.first_constraint, span.last_constraint):
        number = constraints.wide[constraint]
        if number < 0:
            continue
        for i in range(2 * points):
            here = constraints.response[number, row[delassus.point[first + i // 2]], i % 2]
            taken = constraints.scale[constraint] * here
            for j in range(2 * points):
                z = constraints.response[number, row[delassus.point[first + j // 2]], j % 2]
                delassus.numbers[base + i * 2 * points + j] -= taken * z


@inner_kernel
def hold_block(
    k: int, span: Span, system: System, spin: RigidMotion, delassus: Delassus, row: Slots, vector: FloatRows
) -> None:  # fmt: skip
    """Change the block of a body so that its answers keep the spin that impulses give it.

    Directions ahead turn what is pressed, so that A^-1 gives another; contacts would not hold once that is put right.
    """
    # W' = (1 - e e^T M / I) W (1 - M e e^T / I) + e e^T / I,  e the velocities of a turn at rate 1;  z = A^-1 M e  (34)
    rows, numbers = system.rows, delassus.numbers
    first, base = delassus.start[k], delassus.base[k]
    points = delassus.start[k + 1] - first
    clear(span, vector)
    add_torque(span, rows, spin, spin.inertia, vector)
    respond(span, system, vector)
    gain = 0.0
    for r in range(span.first_row, span.last_row):
        dx = rows.position[r, 0] - spin.x
        dy = rows.position[r, 1] - spin.y
        gain += rows.mass[r] * (dx * vector[r, 1] - dy * vector[r, 0])
    both = (1.0 + gain / spin.inertia) / spin.inertia
    for i in range(2 * points):
        here = row[delassus.point[first + i // 2]]
        e = rows.position[here, 0] - spin.x if i % 2 == 1 else spin.y - rows.position[here, 1]
        z = vector[here, i % 2] / spin.inertia
        for j in range(2 * points):
            there = row[delassus.point[first + j // 2]]
            f = rows.position[there, 0] - spin.x if j % 2 == 1 else spin.y - rows.position[there, 1]
            numbers[base + 2 * points * i + j] += both * e * f - z * f - e * vector[there, j % 2] / spin.inertia


@inner_kernel
def open_joints(joints: Joints, row: Slots, inverse_mass: Floats) -> None:
    """The answers of particles that are in no body, which are their own mass's; row (n,): of each particle."""
    rows, actions = joints.rows, joints.actions
    for e in range(rows.particle.shape[0]):
        p = rows.particle[e]
        if row[p] < 0:
            a = actions.answers[actions.entry[e]]
            joints.answer[a, 0] = rows.gradient[e, 0] * inverse_mass[p]
            joints.answer[a, 1] = rows.gradient[e, 1] * inverse_mass[p]


@inner_kernel
def load_answers(span: Span, system: System, joints: Joints, row: Slots, vector: FloatRows) -> None:
    """Z = A^-1 g of a body that has been factored, for every joint that acts on it; row (n,): of each particle."""
    rows, actions = joints.rows, joints.actions
    q = actions.node[system.rows.particle[span.first_row]]
    for i in range(actions.at_first[q], actions.at_first[q + 1]):
        action = actions.at[i]
        k = actions.row[action]
        if not rows.limit[k] > 0.0:
            continue
        clear(span, vector)
        for e in range(rows.first[k], rows.first[k + 1]):
            if actions.entry[e] == action:
                vector[row[rows.particle[e]], 0] = rows.gradient[e, 0]
                vector[row[rows.particle[e]], 1] = rows.gradient[e, 1]
        respond(span, system, vector)
        for r in range(span.first_row, span.last_row):
            a = actions.answers[action] + r - span.first_row
            joints.answer[a, 0] = vector[r, 0]
            joints.answer[a, 1] = vector[r, 1]


@inner_kernel
def load_velocities(islands: BodyIslands, joints: Joints) -> None:
    """The velocities of an island's joints without them and without contacts."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        u = 0.0
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            r = islands.row[p]
            if r >= 0:
                u += rows.gradient[e, 0] * islands.v_free[r, 0] + rows.gradient[e, 1] * islands.v_free[r, 1]
            else:
                u += rows.gradient[e, 0] * islands.v0[p, 0] + rows.gradient[e, 1] * islands.v0[p, 1]
        joints.velocity[k] = u


@inner_kernel
def work_of_joints(span: Span, rows: Rows, push: FloatRows) -> float:
    """The work of joints on one body [J]: that of their impulses at the mean of the velocities before and after."""
    # At v' alone, what just begins to move would fail the test by a hair and stick.
    total = 0.0
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        total += push[p, 0] * (rows.start[r, 0] + rows.v[r, 0])
        total += push[p, 1] * (rows.start[r, 1] + rows.v[r, 1])
    return 0.5 * total
