"""Push: what water does to velocities in a step, before the springs act: lift, and drag that cannot overshoot.

Lift is the gradient of U of all that water cannot enter (below): calm water neither gives nor takes energy.

    triangle  density g A times the integral of each corner's shape function over what is wet; A = the area that its
              constraint wants, so that soft bodies are not crushed by the depth
    hull      as triangles from its middle to each edge, with the area that it is to have
    disc      density g times the area that is wet

Drag of a side of length L and normal n that moves at u through the water, and that of a disc:

    density (fast_drag / 4 |u n| (u n) n + slow_drag u) L        density (fast_drag |u| + 2 pi slow_drag) r u

It is a resistance D times u, implicit,

    (m + h D) v' = m v + h D flow

by particle, with the velocity before anything acts. So it is 0 for what rests, whatever holds that, and Archimedes is
right to rounding. Of what nothing holds, drag also takes its part of what forces add in the step, as of a rigid body:
else it would rise and sink too fast by the change of its velocity in a step.
"""

import math

from sandbox.physics.arrays import FloatRows, Floats, Slots
from sandbox.physics.collision.types import KeptContacts
from sandbox.physics.jit import inner_kernel, scalar_kernel
from sandbox.physics.marks import DISC, KINDS, TERRAIN, TIP_SHIFT
from sandbox.physics.settings import GRAVITY_X, GRAVITY_Y
from sandbox.physics.solvers.contact.free_constraints import small_steps
from sandbox.physics.state import State
from sandbox.physics.water.displacers import (
    BOTTOM,
    BXX,
    BXY,
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
    LEFT,
    LOADS,
    MASS,
    MRR,
    MX,
    MY,
    NET_X,
    NET_Y,
    PX,
    PY,
    RIGHT,
    RXX,
    RXY,
    RYY,
    SLOW,
    TOOK_X,
    TOOK_Y,
    TOP,
    TORQUE,
    TURN,
    Water,
)

# Places at which what passes the surface is looked at, in the time of a step. With one, energy changes by up to
# h^2 v^2 U'' / 12 whenever something passes; with n, by a part in n^2 of that.
PASSES = 4
# What is held and is lifted by more than this in a step [m/s] is a hundred times lighter than its water: what holds it
# may let it go in the next step, and it would be shot into the air. Less lets light boats sink deeper under loads.
HARDEST_LIFT = 15.0
# Below this share of its moment of inertia about its first particle, that about its centre is rounding.
LEAST_INERTIA = 1e-9
PI = 3.141592653589793
THIRD = 1.0 / 3.0


@inner_kernel
def push_by_water(
    water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats, kept: KeptContacts, count: int,
    touches: bool, h: float,
) -> None:  # fmt: skip
    """Change velocities as water does in a step of h [s].

    start [m/s] (n, 2): velocities before anything acted; label (n,): of bodies, see joints/hands.py; kept: the contacts
    of the last step, so many; touches: whether anything can touch.
    """
    # Gravity that points upwards makes no pressure. What nothing holds moves as in free_contacts.py.
    g, early = max(0.0, -numbers[GRAVITY_Y]), 0.5 * (h - h / small_steps(h)) if touches else 0.0
    _load(water, state, start, g, early)
    _sum_bodies(water, state, start, label, numbers)
    _find_held(water, state, label, kept, count)
    for k in range(water.pool.shape[0]):
        for i in range(water.triangle.shape[0]):
            _lift_passing(water, k, i, state, start, label, g, h)
    _sum_bodies(water, state, start, label, numbers)
    _push(water, state, start, label, h)
    _slow_bodies(water, state, label, h)


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
            r, x, y = state.radius[p], state.position[p, 0], state.position[p, 1]
            if pool[k, LEFT] <= x and x <= pool[k, RIGHT] and pool[k, BOTTOM] <= y and r > 0.0:
                share = disc_area_below(pool[k, TOP] - y, r) / (PI * r * r)
                resists = h * 4.0 * PI * r * pool[k, DENSITY] * pool[k, SLOW] * share * state.inverse_mass[p]
                state.spin[p] /= 1.0 + resists


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
def _is_in(water: Water, k: int, i: int, position: FloatRows) -> bool:
    # Whether the middle of a triangle is between the sides of a pool, and above its floor.
    pool, p, q, r = water.pool, water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2]
    x = (position[p, 0] + position[q, 0] + position[r, 0]) / 3.0
    y = (position[p, 1] + position[q, 1] + position[r, 1]) / 3.0
    return pool[k, LEFT] <= x and x <= pool[k, RIGHT] and pool[k, BOTTOM] <= y


@inner_kernel
def _lift_triangle(water: Water, k: int, i: int, state: State, g: float) -> None:
    y, load, top = state.position, water.load, water.pool[k, TOP]
    p, q, r = water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2]
    if not _is_in(water, k, i, y):
        return
    at_p, at_q, at_r = wet_shares(top - y[p, 1], top - y[q, 1], top - y[r, 1])
    if not at_p + at_q + at_r > 0.0:
        return
    weight = water.pool[k, DENSITY] * g * abs(state.constraint_rest[water.constraint[i], 0])
    load[p, FY] += weight * at_p
    load[q, FY] += weight * at_q
    load[r, FY] += weight * at_r
    water.wet[p] = water.wet[q] = water.wet[r] = True


@inner_kernel
def _rise(water: Water, label: Slots, p: int, position: FloatRows, start: FloatRows, h: float) -> float:
    # How far a particle goes up in a step, at its velocity in the middle between that before it and that after it.
    body, g = water.body, label[p]
    if g < 0 or not body[g, MASS] > 0.0 or body[g, HELD] > 0.0:
        return h * start[p, 1]
    change = h * (body[g, NET_Y] - body[g, BYY] * start[p, 1]) / (body[g, MASS] + h * body[g, BYY])
    arm = position[p, 0] - position[g, 0] - body[g, MX] / body[g, MASS]
    return h * (start[p, 1] + 0.5 * (change + h * body[g, TURN] * arm))


@inner_kernel
def _lift_passing(
    water: Water, k: int, i: int, state: State, start: FloatRows, label: Slots, g: float, h: float
) -> None:  # fmt: skip
    # What passes the surface is lifted by the mean of its shares from a step ago to a step ahead, of which those of now
    # count most: steps then meet all of its way through the surface, wherever they end.
    y, load, top = state.position, water.load, water.pool[k, TOP]
    p, q, r = water.triangle[i, 0], water.triangle[i, 1], water.triangle[i, 2]
    if not _is_in(water, k, i, y):
        return
    a, b, c = top - y[p, 1], top - y[q, 1], top - y[r, 1]
    da, db = _rise(water, label, p, y, start, h), _rise(water, label, q, y, start, h)
    dc = _rise(water, label, r, y, start, h)
    if min(a - abs(da), b - abs(db), c - abs(dc)) >= 0.0 or max(a + abs(da), b + abs(db), c + abs(dc)) <= 0.0:
        return
    at_p, at_q, at_r = wet_shares(a, b, c)
    weight = water.pool[k, DENSITY] * g * abs(state.constraint_rest[water.constraint[i], 0])
    more_p, more_q, more_r = -at_p, -at_q, -at_r
    for at in range(1 - PASSES, PASSES):
        s, share = at / PASSES, (PASSES - abs(at)) / (PASSES * PASSES)
        at_p, at_q, at_r = wet_shares(a - s * da, b - s * db, c - s * dc)
        more_p += share * at_p
        more_q += share * at_q
        more_r += share * at_r
    load[p, FY] += weight * more_p
    load[q, FY] += weight * more_q
    load[r, FY] += weight * more_r
    water.wet[p] = water.wet[q] = water.wet[r] = True


@inner_kernel
def middle_of(water: Water, o: int, position: FloatRows) -> tuple[float, float]:
    """The mean of the corners of hull o [m]."""
    first, last, x, y = water.shell_start[o], water.shell_start[o + 1], 0.0, 0.0
    for e in range(first, last):
        x += position[water.shell_a[e], 0]
        y += position[water.shell_a[e], 1]
    return x / (last - first), y / (last - first)


@inner_kernel
def area_of(water: Water, o: int, state: State) -> float:
    """Area [m^2] that hull o displaces when it is all wet."""
    k = water.shell_constraint[o]
    return abs(state.constraint_rest[k, 0]) if k >= 0 else water.shell_area[o]


@inner_kernel
def _lift_shell(water: Water, k: int, o: int, state: State, g: float) -> None:
    # Triangles from the middle to each edge; what lifts the middle lifts all corners alike.
    pool, y, load = water.pool, state.position, water.load
    middle_x, middle_y = middle_of(water, o, y)
    if not (pool[k, LEFT] <= middle_x and middle_x <= pool[k, RIGHT] and pool[k, BOTTOM] <= middle_y):
        return
    first, last, top = water.shell_start[o], water.shell_start[o + 1], pool[k, TOP]
    weight, at_middle, is_wet = pool[k, DENSITY] * g * area_of(water, o, state), 0.0, False
    for e in range(first, last):
        a, b = water.shell_a[e], water.shell_b[e]
        at_c, at_a, at_b = wet_shares(top - middle_y, top - y[a, 1], top - y[b, 1])
        part = weight * water.shell_share[e]
        load[a, FY] += part * at_a
        load[b, FY] += part * at_b
        at_middle += part * at_c
        is_wet = is_wet or at_c + at_a + at_b > 0.0
    if is_wet:
        for e in range(first, last):
            load[water.shell_a[e], FY] += at_middle / (last - first)
            water.wet[water.shell_a[e]] = True


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
def _push_disc(water: Water, k: int, i: int, state: State, start: FloatRows, g: float, ahead: float) -> None:
    # ahead [s]: the force is that of the place to which its velocity brings it until then. What nothing holds moves by
    # h v' + e (v - v') (free_contacts.py): with the force at x + e v that map keeps areas, so that heave neither grows
    # nor dies out.
    pool, p, radius = water.pool, water.disc[i], state.radius[water.disc[i]]
    if water.disc_area[i] > 0.0:
        radius = math.sqrt(water.disc_area[i] / PI)
    x, y = state.position[p, 0] + ahead * start[p, 0], state.position[p, 1] + ahead * start[p, 1]
    if not (pool[k, LEFT] <= x and x <= pool[k, RIGHT] and pool[k, BOTTOM] <= y and radius > 0.0):
        return
    area = disc_area_below(pool[k, TOP] - y, radius)
    if not area > 0.0:
        return
    water.load[p, FY] += pool[k, DENSITY] * g * area
    water.wet[p] = True
    if water.is_bare[i]:
        ux, uy = start[p, 0] - pool[k, FLOW_X], start[p, 1] - pool[k, FLOW_Y]
        speed = math.sqrt(ux * ux + uy * uy)
        share = area / (PI * radius * radius)
        resistance = pool[k, DENSITY] * share * radius * (2.0 * PI * pool[k, SLOW] + pool[k, FAST] * speed)
        _resist(water, k, p, resistance, 0.0, resistance)


@inner_kernel
def _load(water: Water, state: State, start: FloatRows, g: float, early: float) -> None:
    # What water does to each particle.
    for p in range(water.wet.shape[0]):
        water.wet[p] = False
        for column in range(LOADS):
            water.load[p, column] = 0.0
    for k in range(water.pool.shape[0]):
        for i in range(water.triangle.shape[0]):
            _lift_triangle(water, k, i, state, g)
        for o in range(water.shell_start.shape[0] - 1):
            _lift_shell(water, k, o, state, g)
        for i in range(water.edge.shape[0]):
            _drag_edge(water, k, i, state, start)
        for i in range(water.disc.shape[0]):
            _push_disc(water, k, i, state, start, g, early if water.is_loose[i] else 0.0)


@inner_kernel
def _push(water: Water, state: State, start: FloatRows, label: Slots, h: float) -> None:
    # v += -(m + h D)^-1 h D (start - flow) + h F / m
    load, body, velocity, mass = water.load, water.body, state.velocity, state.mass
    for p in range(load.shape[0]):
        if not water.wet[p] or not state.inverse_mass[p] > 0.0:
            continue
        xx, xy, yy = mass[p] + h * load[p, RXX], h * load[p, RXY], mass[p] + h * load[p, RYY]
        rx = load[p, DX] - load[p, RXX] * start[p, 0] - load[p, RXY] * start[p, 1]
        ry = load[p, DY] - load[p, RXY] * start[p, 0] - load[p, RYY] * start[p, 1]
        per = h / (xx * yy - xy * xy)
        dx, dy = per * (yy * rx - xy * ry), per * (xx * ry - xy * rx)
        velocity[p, 0] += dx + h * load[p, FX] / mass[p]
        velocity[p, 1] += dy + h * load[p, FY] / mass[p]
        # The same of the motion of the body as a whole. That of its parts beside each other is theirs alone.
        g = label[p]
        if g >= 0 and body[g, MASS] > 0.0:
            u, v = body[g, PX] / body[g, MASS], body[g, PY] / body[g, MASS]
            rx = load[p, DX] - load[p, RXX] * u - load[p, RXY] * v
            ry = load[p, DY] - load[p, RXY] * u - load[p, RYY] * v
            body[g, DRAG_X] += rx
            body[g, DRAG_Y] += ry
            body[g, TOOK_X] += mass[p] * per * (yy * rx - xy * ry)
            body[g, TOOK_Y] += mass[p] * per * (xx * ry - xy * rx)


@inner_kernel
def _hold(water: Water, label: Slots, p: int) -> None:
    if label[p] >= 0:
        water.body[label[p], HELD] = 1.0


@inner_kernel
def _find_held(water: Water, state: State, label: Slots, kept: KeptContacts, count: int) -> None:
    # What pins, hands or the contacts of the last step hold.
    for p in range(water.body.shape[0]):
        water.body[p, HELD] = 0.0
    for s in range(state.spring_active.shape[0]):
        if state.spring_active[s]:
            a, b = state.particle_a[s], state.particle_b[s]
            if not state.inverse_mass[a] > 0.0:
                _hold(water, label, b)
            if not state.inverse_mass[b] > 0.0:
                _hold(water, label, a)
    for c in range(count):
        if not (kept.impulse[c, 0] > 0.0 or kept.impact[c] > 0.0):
            continue
        number, kind = kept.feature[c] // KINDS, kept.feature[c] % KINDS
        _hold(water, label, kept.particle[c])
        if kind == DISC:
            _hold(water, label, number)
        elif kind != TERRAIN:
            _hold(water, label, state.particle_a[number % TIP_SHIFT])


@inner_kernel
def _sum_bodies(water: Water, state: State, start: FloatRows, label: Slots, numbers: Floats) -> None:
    load, body, mass = water.load, water.body, state.mass
    for p in range(body.shape[0]):
        for column in range(HELD):
            body[p, column] = 0.0
    for p in range(body.shape[0]):
        g = label[p]
        # A label is a particle of the body.
        if g < 0 or not state.particle_active[p] or not state.inverse_mass[p] > 0.0:
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
    for g in range(body.shape[0]):
        body[g, TURN] = 0.0
        m = body[g, MASS]
        if m > 0.0:
            inertia = body[g, MRR] - (body[g, MX] * body[g, MX] + body[g, MY] * body[g, MY]) / m
            torque = body[g, TORQUE] - (body[g, MX] * body[g, NET_Y] - body[g, MY] * body[g, NET_X]) / m
            if inertia > LEAST_INERTIA * body[g, MRR]:
                body[g, TURN] = torque / inertia


@inner_kernel
def _slow_bodies(water: Water, state: State, label: Slots, h: float) -> None:
    # What nothing holds moves as one, v += (m + h D)^-1 h (F - D (start - flow)) of all of it. Its particles get the
    # same change, so that no spring is strained. Of what is held that is done to what F adds beyond HARDEST_LIFT.
    body = water.body
    for g in range(body.shape[0]):
        m = body[g, MASS]
        body[g, CX], body[g, CY] = 0.0, 0.0
        if not (body[g, BXX] + body[g, BYY] > 0.0 and m > 0.0):
            continue
        share, ax, ay = 1.0, h * body[g, NET_X] / m, h * body[g, NET_Y] / m
        fx, fy, tx, ty = body[g, DRAG_X], body[g, DRAG_Y], body[g, TOOK_X] / m, body[g, TOOK_Y] / m
        if body[g, HELD] > 0.0:
            added = math.sqrt(ax * ax + ay * ay)
            share = 1.0 - HARDEST_LIFT / added if added > HARDEST_LIFT else 0.0
            fx, fy, tx, ty = 0.0, 0.0, 0.0, 0.0
        fx, fy = body[g, NET_X] + fx, body[g, NET_Y] + fy
        xx, xy, yy = m + h * body[g, BXX], h * body[g, BXY], m + h * body[g, BYY]
        per = h / (xx * yy - xy * xy)
        body[g, CX] = share * (per * (yy * fx - xy * fy) - ax - tx)
        body[g, CY] = share * (per * (xx * fy - xy * fx) - ay - ty)
    for p in range(body.shape[0]):
        if label[p] >= 0 and state.particle_active[p] and state.inverse_mass[p] > 0.0:
            state.velocity[p, 0] += body[label[p], CX]
            state.velocity[p, 1] += body[label[p], CY]


@scalar_kernel
def arc_cosine(x: float) -> float:
    """acos(x) to 2e-8, of sums, products and roots alone, so that it has the same bits everywhere."""
    # Abramowitz and Stegun 4.4.46.
    t = abs(x)
    if t >= 1.0:
        return 0.0 if x > 0.0 else PI
    s = 0.0066700901 - 0.0012624911 * t
    s = -0.0170881256 + s * t
    s = 0.0308918810 + s * t
    s = -0.0501743046 + s * t
    s = 0.0889789874 + s * t
    s = -0.2145988016 + s * t
    s = 1.5707963050 + s * t
    s *= math.sqrt(1.0 - t)
    return s if x >= 0.0 else PI - s


@scalar_kernel
def disc_area_below(depth: float, radius: float) -> float:
    """Area [m^2] of a disc below a surface that lies so far [m] above its centre."""
    if depth <= -radius:
        return 0.0
    if depth >= radius:
        return PI * radius * radius
    return radius * radius * arc_cosine(-depth / radius) + depth * math.sqrt(radius * radius - depth * depth)


@scalar_kernel
def disc_depth(depth: float, radius: float) -> float:
    """Integral of the depth over what is wet of a disc [m^3]; depth [m] of its centre."""
    if depth <= -radius:
        return 0.0
    if depth >= radius:
        return PI * radius * radius * depth
    # d A(d) + 2/3 (r^2 - d^2)^(3/2)
    inside = radius * radius - depth * depth
    return depth * disc_area_below(depth, radius) + 2.0 * THIRD * inside * math.sqrt(inside)


@inner_kernel
def clipped(x: float, dx: float, low: float, high: float, s0: float, s1: float) -> tuple[float, float]:
    """The part of s0..s1 in which low <= x + s dx <= high; empty where the second is not above the first."""
    if dx == 0.0:
        return (s0, s1) if low <= x and x <= high else (1.0, 0.0)
    to_low, to_high = (low - x) / dx, (high - x) / dx
    return max(s0, min(to_low, to_high)), min(s1, max(to_low, to_high))


@scalar_kernel
def wet_shares(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Of a triangle whose corners lie so deep [m]: the integral over what is wet of each corner's shape function, over
    the area; 1/3 each where all is wet.
    """
    if a > 0.0 and b > 0.0 and c > 0.0:
        return THIRD, THIRD, THIRD
    if a <= 0.0 and b <= 0.0 and c <= 0.0:
        return 0.0, 0.0, 0.0
    # One corner is alone on its side of the surface.
    if (a > 0.0) != (b > 0.0) and (a > 0.0) != (c > 0.0):
        x, y, z = _beside_alone(a, b, c)
        return x, y, z
    if (b > 0.0) != (a > 0.0) and (b > 0.0) != (c > 0.0):
        y, z, x = _beside_alone(b, c, a)
        return x, y, z
    z, x, y = _beside_alone(c, a, b)
    return x, y, z


@scalar_kernel
def _beside_alone(alone: float, one: float, other: float) -> tuple[float, float, float]:
    # It cuts off the part f = s t of the triangle, with shares (3 - s - t, s, t) f / 3.
    s, t = alone / (alone - one), alone / (alone - other)
    f = s * t * THIRD
    x, y, z = (3.0 - s - t) * f, s * f, t * f
    if alone > 0.0:
        return x, y, z
    return THIRD - x, THIRD - y, THIRD - z


@scalar_kernel
def mean_depth(a: float, b: float, c: float) -> float:
    """Integral of the depth over what is wet of a triangle whose corners lie so deep [m], over the area."""
    # The integral is homogeneous of degree 1 in the depths of the corners, whose shares are its gradient (Euler).
    x, y, z = wet_shares(a, b, c)
    return a * x + b * y + c * z
