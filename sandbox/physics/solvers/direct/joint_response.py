"""Joints of bodies that are solved directly: how bodies answer to them, what they do to a body's spin and energy."""

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_answers import Joints
from sandbox.physics.solvers.direct.factor import respond
from sandbox.physics.solvers.direct.islands import BodyIslands
from sandbox.physics.solvers.direct.system import Rows, Span, System


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
        for r in range(span.first_row, span.last_row):
            vector[r, 0] = 0.0
            vector[r, 1] = 0.0
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
def release_joints(joints: Joints) -> None:
    """Set the impulses of the joints of an island that fails to 0."""
    for i in range(joints.listed.shape[0]):
        joints.rows.impulse[joints.listed[i]] = 0.0


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
