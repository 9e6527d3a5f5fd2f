"""Push: what water does to velocities in a step, before springs act: lift (lift.py), and drag that cannot overshoot.

Drag of a side of length L and normal n that moves at u through the water, and that of a disc:

    density (fast_drag / 4 |u n| (u n) n + slow_drag u) L        density (fast_drag |u| + 2 pi slow_drag) r u

It is a resistance D times u, implicit,

    (m + h D) v' = m v + h (F + D flow)

Of what nothing holds that is done by particle with the velocity before anything acts, and then to its motion as a
whole, with all that forces add in the step: else it would rise and sink too fast by the change of its velocity in a
step. What pins, hands or contacts hold is solved with the water that comes along as a part of its mass, m + h d, d =
the larger of the two resistances of D. So it bears h D (flow - v) where it rests, all of it, and is let go with no more
than its share.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.collision.types import KeptContacts
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import DISC, KINDS, TERRAIN, TIP_SHIFT
from sandbox.physics.settings import GRAVITY_X, GRAVITY_Y
from sandbox.physics.state import State
from sandbox.physics.water.displacers import (
    BOTTOM,
    BXX,
    BXY,
    BY_CONTACTS,
    BY_PINS,
    BYY,
    CX,
    CY,
    DENSITY,
    DRAG_X,
    DRAG_Y,
    DX,
    DY,
    FAST,
    FLOW_X,
    FLOW_Y,
    FX,
    FY,
    HELD,
    HIGH,
    HIGH_MISS,
    LEFT,
    LIFT,
    LIFT_TURN,
    LOADS,
    LOW,
    LOW_MISS,
    MASS,
    MRR,
    MX,
    MY,
    NET_X,
    NET_Y,
    OWN_INVERSE,
    OWN_MASS,
    PART,
    PX,
    PY,
    RIGHT,
    RISE,
    RXX,
    RXY,
    RYY,
    SHARE,
    SLOW,
    SWING,
    TOOK_X,
    TOOK_Y,
    TOP,
    TORQUE,
    TURN,
    Water,
)
from sandbox.physics.water.lift import disc_within, lift_due, radius_of
from sandbox.physics.water.shapes import PI, clipped, disc_area_below

# Looks at the lift of a body at most, until it is near [1] to what its way makes it; one is enough where forces change
# its velocity by less than this [m/s] in a step.
MOST_LOOKS = 40
NEAR = 1e-6
# (omega h / 2)^2 up to which what swings straight does so with the right period, below which speed [m/s], as it costs
# energy where a flat side goes through the surface, and what counts as straight [1].
WIDEST_SWING = 0.25
GENTLE = 0.25
STRAIGHT = 1e-3
SLOWEST = 1e-6
# Lift makes no part of a body faster beside its motion as a whole than this [m/s] in a step. In water that is hundreds
# of times denser no spring would hold it. Less spreads lift over bodies that bend.
HARDEST_LIFT = 4.0
# Below this share of its moment of inertia about its first particle, that about its centre is rounding.
LEAST_INERTIA = 1e-9


@inner_kernel
def push_by_water(
    water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats, kept: KeptContacts, count: int,
    early: float, weighs_springs: bool, h: float,
) -> None:  # fmt: skip
    """Change velocities as water does in a step of h [s], and the mass of what is held until `end_push`.

    start [m/s] (n, 2): velocities before anything acted; label (n,): of bodies, see joints/hands.py; kept: the contacts
    of the last step, so many; early [s]: what nothing joins goes ahead of h v' by early (v - v'); weighs_springs: how
    stiff a spring is follows from inverse masses, and what it pulls is weighed by masses.
    """
    # Gravity that points upwards makes no pressure.
    g = max(0.0, -numbers[GRAVITY_Y])
    _find_held(water, state, label, kept, count)
    _load_drag(water, state, start, early)
    _load_lift(water, state, start, label, numbers, g, early, h)
    _lift_bodies(water, state, label, h)
    _push(water, state, start, label, weighs_springs, h)
    _slow_bodies(water, state, label, h)


@inner_kernel
def give_mass_back(water: Water, state: State) -> None:
    """Give particles the mass that they had before water came along."""
    for p in range(water.load.shape[0]):
        if water.load[p, OWN_MASS] > 0.0:
            state.mass[p] = water.load[p, OWN_MASS]
            state.inverse_mass[p] = water.load[p, OWN_INVERSE]
            water.load[p, OWN_MASS] = 0.0


@inner_kernel
def slow_spins(water: Water, state: State, h: float) -> None:
    """Slow the turning of discs in water down, in a step of h [s]; after push_by_water, which finds those."""
    # The rim of a disc is a side that moves along itself: 2 pi r density slow_drag (r omega) r, and I = m r^2 / 2.
    pool = water.pool
    for k in range(pool.shape[0]):
        for i in range(water.disc.shape[0]):
            p = water.disc[i]
            if state.spin[p] == 0.0 or not water.wet[p]:
                continue
            r = state.radius[p]
            share = _wet_share(water, k, state.position[p, 0], state.position[p, 1], r)
            resists = h * 4.0 * PI * r * pool[k, DENSITY] * pool[k, SLOW] * share / state.mass[p]
            state.spin[p] /= 1.0 + resists


@inner_kernel
def _wet_share(water: Water, k: int, x: float, y: float, radius: float) -> float:
    # The part of a disc that is in a pool.
    within = disc_within(water, k, x, radius)
    if not within > 0.0 or y >= water.pool[k, TOP] + radius:
        return 0.0
    wet = disc_area_below(water.pool[k, TOP] - y, radius) - disc_area_below(water.pool[k, BOTTOM] - y, radius)
    return within * wet / (PI * radius * radius)


@inner_kernel
def _resist(water: Water, k: int, p: int, xx: float, xy: float, yy: float) -> None:
    load, u, v = water.load, water.pool[k, FLOW_X], water.pool[k, FLOW_Y]
    load[p, RXX] += xx
    load[p, RXY] += xy
    load[p, RYY] += yy
    load[p, DX] += xx * u + xy * v
    load[p, DY] += xy * u + yy * v
    water.wet[p] = True


@inner_kernel
def _drag_edge(water: Water, k: int, i: int, state: State, start: FloatRows) -> None:
    # The resistance of what is wet of it is shared by its ends as its length is.
    pool, x, s = water.pool, state.position, water.edge[i]
    a, b = state.particle_a[s], state.particle_b[s]
    dx, dy = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1]
    # The part of the way from a to b that lies in the pool; empty where the second is not above the first.
    s0, s1 = clipped(x[a, 0], dx, pool[k, LEFT], pool[k, RIGHT], 0.0, 1.0)
    s0, s1 = clipped(x[a, 1], dy, pool[k, BOTTOM], pool[k, TOP], s0, s1)
    length = math.sqrt(dx * dx + dy * dy)
    if not (s0 < s1 and length > 0.0):
        return
    nx, ny = dy / length, -dx / length
    ux = 0.5 * (start[a, 0] + start[b, 0]) - pool[k, FLOW_X]
    uy = 0.5 * (start[a, 1] + start[b, 1]) - pool[k, FLOW_Y]
    mass = pool[k, DENSITY] * length * water.sides[i]
    slow, fast = mass * pool[k, SLOW], 0.25 * mass * pool[k, FAST] * abs(ux * nx + uy * ny)
    xx, xy, yy = slow + fast * nx * nx, fast * nx * ny, slow + fast * ny * ny
    at_b = 0.5 * (s1 * s1 - s0 * s0)
    at_a = (s1 - s0) - at_b
    _resist(water, k, a, at_a * xx, at_a * xy, at_a * yy)
    _resist(water, k, b, at_b * xx, at_b * xy, at_b * yy)


@inner_kernel
def _drag_disc(water: Water, k: int, i: int, state: State, start: FloatRows, early: float) -> None:
    pool, p, radius = water.pool, water.disc[i], radius_of(water, i, state)
    ahead = 0.0 if water.is_joined[p] else early
    x, y = state.position[p, 0] + ahead * start[p, 0], state.position[p, 1] + ahead * start[p, 1]
    share = _wet_share(water, k, x, y, radius)
    if share > 0.0:
        ux, uy = start[p, 0] - pool[k, FLOW_X], start[p, 1] - pool[k, FLOW_Y]
        speed = math.sqrt(ux * ux + uy * uy)
        resistance = pool[k, DENSITY] * share * radius * (2.0 * PI * pool[k, SLOW] + pool[k, FAST] * speed)
        _resist(water, k, p, resistance, 0.0, resistance)


@inner_kernel
def _load_drag(water: Water, state: State, start: FloatRows, early: float) -> None:
    # What resists each particle; nothing else acts yet.
    for p in range(water.wet.shape[0]):
        water.wet[p] = False
        for column in range(LOADS):
            water.load[p, column] = 0.0
    for k in range(water.pool.shape[0]):
        for i in range(water.edge.shape[0]):
            _drag_edge(water, k, i, state, start)
        for i in range(water.disc.shape[0]):
            if water.is_bare[i]:
                _drag_disc(water, k, i, state, start, early)


@inner_kernel
def _set_ways(water: Water, state: State, start: FloatRows, label: Slots, early: float, h: float) -> None:
    # The ways of all that is due, as lift.py has them. What is loose has gone ahead of h v' by early (v - v').
    body = water.body
    for p in range(label.shape[0]):
        if not water.due[p]:
            continue
        g = label[p]
        for axis in range(2):
            water.before[p, axis] = state.position[p, axis] - 0.5 * h * start[p, axis]
            water.after[p, axis] = state.position[p, axis] + 0.5 * h * start[p, axis]
        if body[g, PART] > 0.0:
            arm = state.position[p, 0] - state.position[g, 0] - body[g, MX] / body[g, MASS]
            water.after[p, 1] += 0.5 * h * body[g, PART] * (body[g, RISE] + body[g, TURN] * arm)
    for i in range(water.disc.shape[0]):
        p = water.disc[i]
        if water.due[p] and not water.is_joined[p]:
            for axis in range(2):
                water.before[p, axis] += early * start[p, axis]
                water.after[p, axis] += early * start[p, axis]


@inner_kernel
def _load_lift(
    water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats, g: float, early: float, h: float
) -> None:  # fmt: skip
    # Lift, with ways whose ends are where it takes what nothing holds: of what forces add where it moves on as it does,
    # the part that they do add at the end of a way with that part (regula falsi, with Illinois).
    body = water.body
    for p in range(label.shape[0]):
        water.due[p] = True
        body[p, PART] = 0.0
    for look in range(MOST_LOOKS):
        _set_ways(water, state, start, label, early, h)
        lift_due(water, state, g)
        _sum_bodies(water, state, start, label, numbers)
        found = False
        for p in range(body.shape[0]):
            if label[p] == p and water.due[p]:
                water.due[p] = body[p, MASS] > 0.0 and _look_again(water, p, look == 0, h)
                found = found or water.due[p]
        if not found:
            return
        for p in range(label.shape[0]):
            water.due[p] = water.due[label[p]]


@inner_kernel
def _look_again(water: Water, p: int, is_first: bool, h: float) -> bool:
    # Whether the lift of a body is to be looked at with another part, PART.
    body = water.body
    m = body[p, MASS]
    inertia = body[p, MRR] - (body[p, MX] * body[p, MX] + body[p, MY] * body[p, MY]) / m
    torque = body[p, TORQUE] - (body[p, MX] * body[p, NET_Y] - body[p, MY] * body[p, NET_X]) / m
    rise = h * (body[p, NET_Y] - body[p, BYY] * body[p, PY] / m) / (m + h * body[p, BYY])
    turn = h * torque / inertia if inertia > LEAST_INERTIA * body[p, MRR] else 0.0
    if is_first:
        body[p, RISE], body[p, TURN], body[p, PART] = rise, turn, 1.0
        body[p, LOW], body[p, LOW_MISS], body[p, HIGH], body[p, HIGH_MISS] = 0.0, 1.0, 1.0, 0.0
        body[p, SWING] = 0.0
        return not body[p, HELD] > 0.0 and m * rise * rise + inertia * turn * turn > m * SLOWEST * SLOWEST
    # Where lift goes with the way, another part has the right period: omega h / 2 is what its sine is, not its tangent.
    whole = m * body[p, RISE] * body[p, RISE] + inertia * body[p, TURN] * body[p, TURN]
    part = body[p, PART]
    miss = (m * body[p, RISE] * rise + inertia * body[p, TURN] * turn) / whole - part
    if body[p, SWING] > 0.0 and abs(miss + part - 1.0 + body[p, SWING] * part) <= STRAIGHT * body[p, SWING]:
        return False
    is_gentle = body[p, HIGH_MISS] == 0.0 and abs(body[p, PY] / m) + abs(body[p, RISE]) < GENTLE
    body[p, SWING] = -miss if is_gentle and -miss > NEAR and -miss < WIDEST_SWING else 0.0
    if miss > 0.0:
        body[p, HIGH_MISS] *= 0.5 if body[p, LOW] > 0.0 else 1.0
        body[p, LOW], body[p, LOW_MISS] = part, miss
    else:
        body[p, LOW_MISS] *= 0.5 if body[p, HIGH] < 1.0 else 1.0
        body[p, HIGH], body[p, HIGH_MISS] = part, miss
    if abs(miss) <= NEAR or not body[p, LOW_MISS] > body[p, HIGH_MISS] or body[p, LOW] >= 1.0:
        return False
    ahead = body[p, LOW_MISS] / (body[p, LOW_MISS] - body[p, HIGH_MISS])
    body[p, PART] = body[p, LOW] + ahead * (body[p, HIGH] - body[p, LOW])
    if body[p, SWING] > 0.0:
        body[p, PART] = 1.0 / (3.0 + body[p, SWING])
    return True


@inner_kernel
def _lift_bodies(water: Water, state: State, label: Slots, h: float) -> None:
    # v += h F / m. Where a body would be torn by that it moves as one, but for HARDEST_LIFT.
    body, load = water.body, water.load
    for g in range(body.shape[0]):
        body[g, LIFT], body[g, LIFT_TURN], body[g, SHARE] = 0.0, 0.0, 1.0
    for p in range(label.shape[0]):
        g = label[p]
        if load[p, FY] != 0.0 and body[g, MASS] > 0.0:
            arm = state.position[p, 0] - state.position[g, 0] - body[g, MX] / body[g, MASS]
            body[g, LIFT] += h * load[p, FY] / body[g, MASS]
            body[g, LIFT_TURN] += h * load[p, FY] * arm
    for p in range(label.shape[0]):
        g = label[p]
        if not state.inverse_mass[p] > 0.0 or not body[g, MASS] > 0.0:
            continue
        x, y = _swept(water, state, label, p)
        x, y = 0.0 - x, h * load[p, FY] / state.mass[p] - y
        hard = math.sqrt(x * x + y * y)
        if hard > HARDEST_LIFT:
            body[g, SHARE] = min(body[g, SHARE], HARDEST_LIFT / hard)
    for p in range(label.shape[0]):
        g = label[p]
        if not state.inverse_mass[p] > 0.0 or not state.particle_active[p] or not body[g, MASS] > 0.0:
            continue
        x, y = _swept(water, state, label, p)
        state.velocity[p, 0] += (1.0 - body[g, SHARE]) * x
        state.velocity[p, 1] += body[g, SHARE] * h * load[p, FY] / state.mass[p] + (1.0 - body[g, SHARE]) * y


@inner_kernel
def _swept(water: Water, state: State, label: Slots, p: int) -> tuple[float, float]:
    # What lift changes a particle's velocity by where its body moves as one.
    body, g = water.body, label[p]
    m = body[g, MASS]
    inertia = body[g, MRR] - (body[g, MX] * body[g, MX] + body[g, MY] * body[g, MY]) / m
    turn = body[g, LIFT_TURN] / inertia if inertia > LEAST_INERTIA * body[g, MRR] else 0.0
    x = state.position[p, 0] - state.position[g, 0] - body[g, MX] / m
    y = state.position[p, 1] - state.position[g, 1] - body[g, MY] / m
    return -turn * y, body[g, LIFT] + turn * x


@inner_kernel
def _push(water: Water, state: State, start: FloatRows, label: Slots, weighs_springs: bool, h: float) -> None:
    # What nothing holds: v += -(m + h D)^-1 h D (start - flow)
    load, body, velocity, mass = water.load, water.body, state.velocity, state.mass
    for p in range(load.shape[0]):
        if not water.wet[p] or not state.inverse_mass[p] > 0.0:
            continue
        g = label[p]
        rx = load[p, DX] - load[p, RXX] * start[p, 0] - load[p, RXY] * start[p, 1]
        ry = load[p, DY] - load[p, RXY] * start[p, 0] - load[p, RYY] * start[p, 1]
        if body[g, HELD] > 0.0:
            _come_along(water, state, start, p, rx, ry, weighs_springs, h)
            continue
        xx, xy, yy = mass[p] + h * load[p, RXX], h * load[p, RXY], mass[p] + h * load[p, RYY]
        per = h / (xx * yy - xy * xy)
        dx, dy = per * (yy * rx - xy * ry), per * (xx * ry - xy * rx)
        velocity[p, 0] += dx
        velocity[p, 1] += dy
        # The same of the motion of the body as a whole. That of its parts beside each other is theirs alone.
        u, v = body[g, PX] / body[g, MASS], body[g, PY] / body[g, MASS]
        body[g, DRAG_X] += load[p, DX] - load[p, RXX] * u - load[p, RXY] * v
        body[g, DRAG_Y] += load[p, DY] - load[p, RXY] * u - load[p, RYY] * v
        body[g, TOOK_X] += mass[p] * dx
        body[g, TOOK_Y] += mass[p] * dy


@inner_kernel
def _come_along(
    water: Water, state: State, start: FloatRows, p: int, rx: float, ry: float, weighs_springs: bool, h: float
) -> None:  # fmt: skip
    # (m + h d) (v' - start) = h (F + r) and what else acted; r: drag at the start of the step.
    load, velocity, m = water.load, state.velocity, state.mass[p]
    half, across = 0.5 * (load[p, RXX] - load[p, RYY]), load[p, RXY]
    d = 0.5 * (load[p, RXX] + load[p, RYY]) + math.sqrt(half * half + across * across)
    mass = m + h * d
    velocity[p, 0] = start[p, 0] + (m * (velocity[p, 0] - start[p, 0]) + h * rx) / mass
    velocity[p, 1] = start[p, 1] + (m * (velocity[p, 1] - start[p, 1]) + h * ry) / mass
    load[p, OWN_MASS], load[p, OWN_INVERSE] = m, state.inverse_mass[p]
    state.mass[p] = mass
    if not (weighs_springs and water.is_joined[p]):
        state.inverse_mass[p] = 1.0 / mass


@inner_kernel
def _find_held(water: Water, state: State, label: Slots, kept: KeptContacts, count: int) -> None:
    # What pins, hands or the contacts of the last step hold.
    body = water.body
    for p in range(body.shape[0]):
        body[p, HELD] = 0.0
    for c in range(count):
        if not (kept.impulse[c, 0] > 0.0 or kept.impact[c] > 0.0):
            continue
        number, kind = kept.feature[c] // KINDS, kept.feature[c] % KINDS
        body[label[kept.particle[c]], HELD] = BY_CONTACTS
        if kind == DISC:
            body[label[number], HELD] = BY_CONTACTS
        elif kind != TERRAIN:
            body[label[state.particle_a[number % TIP_SHIFT]], HELD] = BY_CONTACTS
    for s in range(state.spring_active.shape[0]):
        if state.spring_active[s]:
            a, b = state.particle_a[s], state.particle_b[s]
            if not state.inverse_mass[a] > 0.0:
                body[label[b], HELD] = BY_PINS
            if not state.inverse_mass[b] > 0.0:
                body[label[a], HELD] = BY_PINS


@inner_kernel
def _sum_bodies(water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats) -> None:
    load, body, mass = water.load, water.body, state.mass
    for p in range(body.shape[0]):
        if water.due[p]:
            for column in range(HELD):
                body[p, column] = 0.0
    for p in range(body.shape[0]):
        g = label[p]
        # A label is a particle of the body.
        if not water.due[g] or not state.particle_active[p] or not state.inverse_mass[p] > 0.0:
            continue
        weight = mass[p] * state.gravity_scale[p]
        body[g, MASS] += mass[p]
        body[g, PX] += mass[p] * start[p, 0]
        body[g, PY] += mass[p] * start[p, 1]
        body[g, NET_X] += load[p, FX] + weight * numbers[GRAVITY_X]
        body[g, NET_Y] += load[p, FY] + weight * numbers[GRAVITY_Y]
        body[g, BXX] += load[p, RXX]
        body[g, BXY] += load[p, RXY]
        body[g, BYY] += load[p, RYY]
        rx, ry = state.position[p, 0] - state.position[g, 0], state.position[p, 1] - state.position[g, 1]
        body[g, MX] += mass[p] * rx
        body[g, MY] += mass[p] * ry
        body[g, MRR] += mass[p] * (rx * rx + ry * ry)
        body[g, TORQUE] += rx * (load[p, FY] + weight * numbers[GRAVITY_Y])
        body[g, TORQUE] -= ry * (load[p, FX] + weight * numbers[GRAVITY_X])


@inner_kernel
def _slow_bodies(water: Water, state: State, label: Slots, h: float) -> None:
    # What nothing holds moves as one, v += (m + h D)^-1 h (F - D (start - flow)) of all of it. Its particles get the
    # same change, so that no spring is strained.
    body = water.body
    for g in range(body.shape[0]):
        m = body[g, MASS]
        body[g, CX], body[g, CY] = 0.0, 0.0
        if not (body[g, BXX] + body[g, BYY] > 0.0 and m > 0.0) or body[g, HELD] > 0.0:
            continue
        fx, fy = body[g, NET_X] + body[g, DRAG_X], body[g, NET_Y] + body[g, DRAG_Y]
        xx, xy, yy = m + h * body[g, BXX], h * body[g, BXY], m + h * body[g, BYY]
        per = h / (xx * yy - xy * xy)
        body[g, CX] = per * (yy * fx - xy * fy) - (h * body[g, NET_X] + body[g, TOOK_X]) / m
        body[g, CY] = per * (xx * fy - xy * fx) - (h * body[g, NET_Y] + body[g, TOOK_Y]) / m
    for p in range(body.shape[0]):
        if state.particle_active[p] and state.inverse_mass[p] > 0.0:
            state.velocity[p, 0] += body[label[p], CX]
            state.velocity[p, 1] += body[label[p], CY]
