"""Joints in the sweeps: their impulses are found together with those of contacts, each clamped.

Of those that `Joints` lists; what an impulse does to bodies and to other joints: see joint_answers.py.
"""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.equation import implicit_update
from sandbox.physics.jit import inner_kernel
from sandbox.physics.joints.joint_answers import Joints, couple_masses, own_response
from sandbox.physics.joints.rows import PAIR, SECOND_OF_TWO, JointRows, clamped, row_velocity, shortened


@inner_kernel
def _push(joints: Joints, k: int, impulse: float, delta_v: FloatRows) -> None:
    # What a row's impulse does to particles and to the velocities of rows that are coupled with it.
    actions, couplings = joints.actions, joints.couplings
    for action in range(actions.first[k], actions.first[k + 1]):
        q, answers = actions.on[action], actions.answers[action]
        for i in range(actions.start[q], actions.start[q + 1]):
            p, a = actions.particle[i], answers + i - actions.start[q]
            delta_v[p, 0] += joints.answer[a, 0] * impulse
            delta_v[p, 1] += joints.answer[a, 1] * impulse
    for c in range(couplings.first[k], couplings.first[k + 1]):
        joints.velocity[couplings.row[c]] += couplings.response[c] * impulse


@inner_kernel
def answer_of_two(joints: Joints, k: int, u: float, v: float) -> tuple[float, float]:
    """The impulses of two rows that are clamped together, from their velocities; clamped by nothing yet."""
    # (W + 1/K) dP = -(u - target + P/K)
    rows = joints.rows
    first, second = rows.impulse[k], rows.impulse[k + 1]
    couplings = joints.couplings
    a = own_response(joints, k) + rows.softness[k]
    b = couplings.response[couplings.own[k + 1] - 1]
    c = couplings.response[couplings.own[k] + 1]
    d = own_response(joints, k + 1) + rows.softness[k + 1]
    determinant = a * d - b * c
    if not determinant > 0.0:
        return first, second
    r = -(u - rows.target[k] + rows.softness[k] * first)
    s = -(v - rows.target[k + 1] + rows.softness[k + 1] * second)
    first += (d * r - b * s) / determinant
    second += (a * s - c * r) / determinant
    return first, second


@inner_kernel
def _of_two(joints: Joints, k: int, u: float, v: float) -> tuple[float, float]:
    first, second = answer_of_two(joints, k, u, v)
    share = shortened(first, second, joints.rows.limit[k])
    return first * share, second * share


@inner_kernel
def _alone(joints: Joints, k: int, u: float) -> float:
    rows = joints.rows
    new = implicit_update(rows.impulse[k], u - rows.target[k], own_response(joints, k), rows.softness[k])  # (25)
    return clamped(new, rows.limit[k])


@inner_kernel
def start_joints(joints: Joints, delta_v: FloatRows) -> None:
    """Apply the impulses that joints bring along."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        joints.search_direction[k] = 0.0
        if rows.impulse[k] != 0.0:
            _push(joints, k, rows.impulse[k], delta_v)


@inner_kernel
def sweep_joints(joints: Joints, delta_v: FloatRows) -> float:
    """One sweep over all joints, in order; the largest change of a row's velocity [m/s, where g has no unit]."""
    rows = joints.rows
    largest = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        joints.last_impulse[k] = rows.impulse[k]
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and own_response(joints, k) > 0.0):
            continue
        if rows.pair[k] == PAIR:
            first, second = _of_two(joints, k, joints.velocity[k], joints.velocity[k + 1])
            largest = max(largest, _set(joints, k + 1, second, delta_v))
        else:
            first = _alone(joints, k, joints.velocity[k])
        largest = max(largest, _set(joints, k, first, delta_v))
    return largest


@inner_kernel
def _set(joints: Joints, k: int, impulse: float, delta_v: FloatRows) -> float:
    # Give a row another impulse; by how much its own velocity changes.
    more = impulse - joints.rows.impulse[k]
    if more == 0.0:
        return 0.0
    joints.rows.impulse[k] = impulse
    _push(joints, k, more, delta_v)
    return abs(more) * own_response(joints, k)


@inner_kernel
def swept_by(joints: Joints) -> float:
    """The squared change of impulses in the last sweep, in the metric of the responses."""
    squared = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        more = joints.rows.impulse[k] - joints.last_impulse[k]
        squared += own_response(joints, k) * more * more
    return squared


@inner_kernel
def go_on_with_joints(joints: Joints, delta_v: FloatRows, ratio: float) -> None:
    """P += ratio p, clamped; p = ratio p + the change of the sweep: as contacts do."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        more = ratio * joints.search_direction[k]
        joints.search_direction[k] = more + (rows.impulse[k] - joints.last_impulse[k])
        joints.last_impulse[k] = rows.impulse[k] + more
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        if rows.pair[k] == SECOND_OF_TWO:
            continue
        if rows.pair[k] == PAIR:
            share = shortened(joints.last_impulse[k], joints.last_impulse[k + 1], rows.limit[k])
            _set(joints, k, joints.last_impulse[k] * share, delta_v)
            _set(joints, k + 1, joints.last_impulse[k + 1] * share, delta_v)
        else:
            _set(joints, k, clamped(joints.last_impulse[k], rows.limit[k]), delta_v)


@inner_kernel
def gather_push(joints: Joints) -> None:
    """Sum the impulses of the joints that are listed for each particle that they act on, into `push`."""
    rows = joints.rows
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        for e in range(rows.first[k], rows.first[k + 1]):
            joints.push[rows.particle[e], 0] = 0.0
            joints.push[rows.particle[e], 1] = 0.0
    for i in range(joints.listed.shape[0]):
        k = joints.listed[i]
        for e in range(rows.first[k], rows.first[k + 1]):
            p = rows.particle[e]
            joints.push[p, 0] += rows.gradient[e, 0] * rows.impulse[k]
            joints.push[p, 1] += rows.gradient[e, 1] * rows.impulse[k]


@inner_kernel
def give_impulse(rows: JointRows, k: int, impulse: float, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Apply an impulse of a row to particles that answer by their own mass."""
    for e in range(rows.first[k], rows.first[k + 1]):
        p = rows.particle[e]
        delta_v[p, 0] += rows.gradient[e, 0] * impulse * inverse_mass[p]
        delta_v[p, 1] += rows.gradient[e, 1] * impulse * inverse_mass[p]


@inner_kernel
def warm_start_joints(joints: Joints, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Apply the impulses that joints bring along, to particles that answer by their own mass."""
    couple_masses(joints, inverse_mass)
    for k in range(joints.rows.limit.shape[0]):
        if joints.rows.impulse[k] != 0.0:
            give_impulse(joints.rows, k, joints.rows.impulse[k], delta_v, inverse_mass)


@inner_kernel
def iterate_joint(joints: Joints, k: int, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """Bring a joint, or two that are clamped together, to its target; particles answer by their own mass."""
    rows = joints.rows
    if rows.pair[k] == SECOND_OF_TWO or not (rows.limit[k] > 0.0 and own_response(joints, k) > 0.0):
        return
    u = row_velocity(rows, k, velocity, delta_v)
    if rows.pair[k] == PAIR:
        first, second = _of_two(joints, k, u, row_velocity(rows, k + 1, velocity, delta_v))
        give_impulse(rows, k + 1, second - rows.impulse[k + 1], delta_v, inverse_mass)
        rows.impulse[k + 1] = second
    else:
        first = _alone(joints, k, u)
    give_impulse(rows, k, first - rows.impulse[k], delta_v, inverse_mass)
    rows.impulse[k] = first


@inner_kernel
def iterate_joints(joints: Joints, velocity: FloatRows, delta_v: FloatRows, inverse_mass: Floats) -> None:
    """One iteration over all joints of particles that answer by their own mass; clamped is the sum of its impulses."""
    for k in range(joints.rows.limit.shape[0]):
        iterate_joint(joints, k, velocity, delta_v, inverse_mass)
