"""Joints of bodies that are solved directly: how bodies answer to them, what they do to a body's spin and energy."""

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_sweep import Joints, couple_joints
from sandbox.physics.solvers.direct.factor import respond
from sandbox.physics.solvers.direct.islands import IslandWorkspace
from sandbox.physics.solvers.direct.system import Rows, Span, System


@inner_kernel
def open_joints(workspace: IslandWorkspace, inverse_mass: Floats) -> None:
    """The answers of particles that are in no body, which are their own mass's."""
    joints, rows = workspace.delassus.joints, workspace.delassus.joints.rows
    for k in range(rows.limit.shape[0]):
        a = joints.answer_first[k + 1]
        for e in range(rows.first[k + 1] - 1, rows.first[k] - 1, -1):
            p = rows.particle[e]
            if workspace.islands.row[p] < 0:
                a -= 1
                joints.answer[a, 0] = rows.gradient[e, 0] * inverse_mass[p]
                joints.answer[a, 1] = rows.gradient[e, 1] * inverse_mass[p]


@inner_kernel
def load_answers(body: int, span: Span, system: System, joints: Joints, row: Slots, vector: Floats) -> None:
    """Z = A^-1 g of a body that has been factored, for every joint that acts on it; row (n,): of each particle."""
    rows = joints.rows
    for k in range(rows.limit.shape[0]):
        if not rows.limit[k] > 0.0:
            continue
        for b in range(joints.body_first[k], joints.body_first[k + 1]):
            if joints.body[b] != body:
                continue
            for r in range(span.first_row, span.last_row):
                vector[r, 0] = 0.0
                vector[r, 1] = 0.0
            for e in range(rows.first[k], rows.first[k + 1]):
                r = row[rows.particle[e]]
                if span.first_row <= r < span.last_row:
                    vector[r, 0] = rows.gradient[e, 0]
                    vector[r, 1] = rows.gradient[e, 1]
            respond(span, system, vector)
            for r in range(span.first_row, span.last_row):
                a = joints.body_answer[b] + r - span.first_row
                joints.answer[a, 0] = vector[r, 0]
                joints.answer[a, 1] = vector[r, 1]


@inner_kernel
def prepare_joints(workspace: IslandWorkspace) -> None:
    """Responses of joints, and their velocities without them and without contacts."""
    islands, joints, rows = workspace.islands, workspace.delassus.joints, workspace.delassus.joints.rows
    couple_joints(joints)
    for k in range(rows.limit.shape[0]):
        u = 0.0
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            r = islands.row[p]
            if r >= 0:
                u += rows.gradient[e, 0] * islands.unpushed[r, 0] + rows.gradient[e, 1] * islands.unpushed[r, 1]
            else:
                u += rows.gradient[e, 0] * islands.given[p, 0] + rows.gradient[e, 1] * islands.given[p, 1]
        joints.velocity[k] = u


@inner_kernel
def island_of_joint(k: int, workspace: IslandWorkspace) -> int:
    """The island that a joint acts in."""
    islands, joints = workspace.islands, workspace.delassus.joints
    if joints.body_first[k] < joints.body_first[k + 1]:
        return islands.island[islands.number[joints.body[joints.body_first[k]]]]
    return islands.island[islands.member[joints.rows.particle[joints.rows.first[k]]]]


@inner_kernel
def fails_driven(workspace: IslandWorkspace) -> bool:
    """Whether an island fails the energy test in which a joint acts."""
    limit = workspace.delassus.joints.rows.limit
    found = False
    for k in range(limit.shape[0]):
        found = found or (limit[k] > 0.0 and workspace.islands.fails[island_of_joint(k, workspace)])
    return found


@inner_kernel
def release_joints(workspace: IslandWorkspace) -> None:
    """Let joints of islands that fail begin with no impulse."""
    rows = workspace.delassus.joints.rows
    for k in range(rows.limit.shape[0]):
        if rows.limit[k] > 0.0 and workspace.islands.fails[island_of_joint(k, workspace)]:
            rows.impulse[k] = 0.0


@inner_kernel
def work_of_joints(span: Span, rows: Rows, push: Floats) -> float:
    """The work of joints on one body [J]: that of their impulses at the mean of the velocities before and after."""
    # At v' alone, what just begins to move would fail the test by a hair and stick.
    total = 0.0
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        total += push[p, 0] * (rows.start[r, 0] + rows.v[r, 0])
        total += push[p, 1] * (rows.start[r, 1] + rows.v[r, 1])
    return 0.5 * total
