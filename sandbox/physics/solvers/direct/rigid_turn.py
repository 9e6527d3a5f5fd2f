"""The turn of a body as a whole: nothing inside it changes that.

A rigid body that turns by omega goes in a step along chords, v = V + (R - 1) r / h, where R turns by h omega. Stored
velocities are those at the end of a step, omega x r. So each step begins by leading them from its start to its chords
and ends by leading them from these to its end:

    begin_turn   v += (1 - cos) r / h       once the body is opened, before it is solved
    hold_spin    v' += turn x r'            after each solution: L' = L + what acts from outside
    end_turns    v' -= (1 - cos) r' / h     once positions have moved

None of the three changes the angular momentum L about the centre of mass, or about the one pin that a body turns about.
"""

import math

from sandbox.physics.arrays import FloatRows
from sandbox.physics.geometry.rigid import (
    RigidMotion,
    WeightedSums,
    centre_of,
    momentum_about,
    rotated,
    turn_rate,
    velocity_at,
    with_point,
    with_turn,
)
from sandbox.physics.jit import inlined_kernel, inner_kernel
from sandbox.physics.solvers.direct.network import find_slow
from sandbox.physics.solvers.direct.system import (
    BY_ARC,
    END_INERTIA,
    END_INWARD,
    END_X,
    END_Y,
    INERTIA,
    INWARD,
    MOMENTUM,
    SPIN_VX,
    SPIN_VY,
    SPIN_X,
    SPIN_Y,
    Rows,
    Span,
    System,
    kinetic,
    span_of,
)
from sandbox.physics.state import State

# Below this angle [rad] in a step the turn of a body is not foreseen, so that what falls without turning falls without
# rounding.
SMALLEST_TURN = 1e-6
# No step turns a body farther than by this angle [rad]. Beyond a right angle springs would turn over.
LARGEST_ANGLE = 1.3
LARGEST_SINE = 0.96
# In place of `arc`: what has no form, since springs of rest length 0 alone join it, of little damping. Its particles go
# on ellipses, which arcs would make circles; what damping has brought on circles keeps to those by arcs.
FORMLESS = -1.0
# So many times Cd is the Cs of springs of little damping, at least.
LITTLE_DAMPED = 2.0
# What has turned so far in a step that r . r' is less than this share of r . r is turned about where the step begins.
LEAST_TURN_COSINE = 0.2


@inner_kernel
def begin_turn(body: int, span: Span, system: System, state: State, arc: float, h: float) -> None:
    """Bring a body's velocities, which are those at the end of a step, to the chords on which it goes in one.

    What is foreseen turns on with it, and so does the slow part of its velocities. What a chord is shorter than its arc
    is taken off its angular momentum meanwhile, in `bodies.spared`. arc: see `turned`.
    """
    # v += (1 - cos) r / h - (L - I sin / h) / I x r:  of what turns as a whole, v' = (R - 1) r / h is a chord
    rows, bodies = system.rows, system.bodies
    bodies.spared[body] = 0.0
    momentum0 = _find_spin(body, span, system)
    springs = system.springs
    found = span.last_constraint == span.first_constraint
    for k in range(span.first_spring, span.last_spring):
        found = found and springs.rest[k] == 0.0 and springs.K_beta[k] > LITTLE_DAMPED * springs.K[k]
    arc = FORMLESS if found else arc
    bodies.spin[body, BY_ARC] = arc
    spin = spin_of_body(body, system)
    rate = _inward(momentum0, spin.inertia, arc, h)
    bodies.spin[body, INWARD] = rate
    for k in range(END_INWARD, END_Y + 1):
        bodies.spin[body, k] = 0.0
    sine, cosine = turned(spin.momentum, spin.inertia, arc, h)
    if rate != 0.0 or abs(sine) > SMALLEST_TURN:
        bodies.spared[body] = spin.momentum - spin.inertia * sine / h
        bodies.spin[body, MOMENTUM] = spin.momentum - bodies.spared[body]
        turn = -bodies.spared[body] / spin.inertia
        # The slow part of a body's velocities, beside that of the whole, and of their change turns as the body does.
        slow, slow_change = state.slow_velocity, state.slow_change
        sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
        for r in range(span.first_row, span.last_row):
            p = rows.particle[r]
            sums = with_point(sums, rows.mass[r], 0.0, 0.0, slow[p, 0], slow[p, 1])
        centre = centre_of(sums)
        for r in range(span.first_row, span.last_row):
            p = rows.particle[r]
            x, y = rotated(cosine, sine, slow[p, 0] - centre.u, slow[p, 1] - centre.v)
            slow[p, 0] = centre.u + x
            slow[p, 1] = centre.v + y
            slow_change[p, 0], slow_change[p, 1] = rotated(cosine, sine, slow_change[p, 0], slow_change[p, 1])
        for r in range(span.first_row, span.last_row):
            dx = rows.position[r, 0] - spin.x
            dy = rows.position[r, 1] - spin.y
            x = rate * dx - turn * dy
            y = rate * dy + turn * dx
            _add(rows.start, r, x, y)
            _add(rows.v_star, r, x, y)
            _add(rows.v_star_matched, r, x, y)
            x, y = rotated(cosine, sine, x + (rows.v[r, 0] - spin.u), y + (rows.v[r, 1] - spin.v))
            rows.v[r, 0] = spin.u + x
            rows.v[r, 1] = spin.v + y
    find_slow(span, rows, state)


@inner_kernel
def _find_spin(body: int, span: Span, system: System) -> float:
    # How a body turns by v* about its centre of mass, or about the one pin that holds it; L before forces.
    rows, spin = system.rows, system.bodies.spin
    pivot = system.bodies.pivot[body]
    for k in range(SPIN_X, MOMENTUM + 1):
        spin[body, k] = 0.0
    if pivot >= 0:
        motion = RigidMotion(rows.position[pivot, 0], rows.position[pivot, 1], 0.0, 0.0, 0.0, 0.0)
        if rows.v_star[pivot, 0] != 0.0 or rows.v_star[pivot, 1] != 0.0:
            return 0.0
    elif pivot == -1:
        sums = WeightedSums(0.0, 0.0, 0.0, 0.0, 0.0)
        for r in range(span.first_row, span.last_row):
            sums = with_point(
                sums, rows.mass[r], rows.position[r, 0], rows.position[r, 1], rows.v_star[r, 0], rows.v_star[r, 1]
            )
        motion = centre_of(sums)
    else:
        return 0.0
    momentum0 = 0.0
    for r in range(span.first_row, span.last_row):
        m, x, y = rows.mass[r], rows.position[r, 0], rows.position[r, 1]
        momentum0 += momentum_about(motion, m, x, y, rows.start[r, 0], rows.start[r, 1])
        motion = with_turn(motion, m, x, y, rows.v_star[r, 0], rows.v_star[r, 1])
    spin[body, SPIN_X] = motion.x
    spin[body, SPIN_Y] = motion.y
    spin[body, SPIN_VX] = motion.u
    spin[body, SPIN_VY] = motion.v
    spin[body, INERTIA] = motion.inertia
    spin[body, MOMENTUM] = motion.momentum
    return momentum0


@inner_kernel
def _inward(momentum: float, inertia: float, arc: float, h: float) -> float:
    # At what rate [1/s] the chords of what turns lead out of the circle where they begin, and back where they end.
    sine, cosine = turned(momentum, inertia, arc, h)
    if not abs(sine) > SMALLEST_TURN:
        return 0.0
    # (1 - cos) / h
    return sine * sine / ((1.0 + cosine) * h)


@inner_kernel
def turned(momentum: float, inertia: float, arc: float, h: float) -> tuple[float, float]:
    """Sine and cosine of the angle by which a rigid body of this angular momentum turns in a step of h [s].

    arc: 1: that angle is h L / I; 0: its sine is, so that what moves on chords has the angular momentum of what turns,
    as contacts and joints need it. It is at most LARGEST_ANGLE. FORMLESS: it does not turn.
    """
    if arc == FORMLESS:
        return 0.0, 1.0
    angle = h * momentum / inertia if inertia > 0.0 else 0.0
    if arc > 0.0:
        sine = sine_of(min(max(angle, -LARGEST_ANGLE), LARGEST_ANGLE))
    else:
        sine = min(max(angle, -LARGEST_SINE), LARGEST_SINE)
    return sine, math.sqrt(1.0 - sine * sine)


@inner_kernel
def sine_of(angle: float) -> float:
    """sin of an angle [rad] of at most LARGEST_ANGLE, of + and * alone."""
    x = angle * angle
    total = 0.0
    for k in range(11, 0, -1):
        total = -x / (2.0 * k * (2.0 * k + 1.0)) * (1.0 + total)
    return angle * (1.0 + total)


@inlined_kernel
def _add(vector: FloatRows, r: int, x: float, y: float) -> None:
    vector[r, 0] += x
    vector[r, 1] += y


@inner_kernel
def hold_spin(span: Span, rows: Rows, spin: RigidMotion, pivots: bool, aims: bool, momentum: float, h: float) -> None:
    """Turn where `v` leads to, as a whole, until it has this angular momentum: nothing within a body turns it.

    Directions taken ahead do, as does the minimum of f. pivots: it turns about a pin. aims: the next linear solve
    starts from there, and is to stay there.
    """
    # v' += turn x r',  r' = r + h (v' - V'),  turn = (L - L') / sum m r . r'.  To first order no length of the end of
    # the step changes; turned about where it begins, what has turned far would be stretched.
    if not spin.inertia > 0.0:
        return
    missing = momentum
    across = spin.inertia
    total = u = v = 0.0
    for r in range(span.first_row, span.last_row):
        m = rows.mass[r]
        dx = rows.position[r, 0] - spin.x
        dy = rows.position[r, 1] - spin.y
        vx = rows.v[r, 0] - spin.u
        vy = rows.v[r, 1] - spin.v
        missing -= m * (dx * vy - dy * vx)
        across += h * m * (dx * vx + dy * vy)
        total += m
        u += m * vx
        v += m * vy
    if missing == 0.0:
        return
    ahead = h
    if pivots:
        u = 0.0
        v = 0.0
    else:
        u /= total
        v /= total
    if not across > LEAST_TURN_COSINE * spin.inertia:
        across = spin.inertia
        ahead = 0.0
    turn = missing / across
    for r in range(span.first_row, span.last_row):
        dx = rows.position[r, 0] - spin.x + ahead * (rows.v[r, 0] - spin.u - u)
        dy = rows.position[r, 1] - spin.y + ahead * (rows.v[r, 1] - spin.v - v)
        rows.v[r, 0] -= turn * dy
        rows.v[r, 1] += turn * dx
        if aims:
            rows.v_star_matched[r, 0] -= turn * dy
            rows.v_star_matched[r, 1] += turn * dx


@inner_kernel
def end_turns(system: System, state: State, h: float) -> None:
    """Bring the velocities of all bodies from the chords of a step of h [s] to its end, once positions have moved."""
    rows, bodies = system.rows, system.bodies
    for body in range(bodies.lowest.shape[0]):
        span = span_of(system, body)
        pivot, spared = bodies.pivot[body], bodies.spared[body]
        if not bodies.spin[body, INERTIA] > 0.0:
            continue
        # Sums about a place nearby, so that nothing cancels.
        p = rows.particle[span.first_row if pivot < 0 else pivot]
        cx = state.position[p, 0]
        cy = state.position[p, 1]
        total = x = y = u = v = inertia = momentum = 0.0
        for r in range(span.first_row, span.last_row):
            p = rows.particle[r]
            m = rows.mass[r]
            dx = state.position[p, 0] - cx
            dy = state.position[p, 1] - cy
            mx = m * state.velocity[p, 0]
            my = m * state.velocity[p, 1]
            total += m
            x += m * dx
            y += m * dy
            u += mx
            v += my
            inertia += m * (dx * dx + dy * dy)
            momentum += dx * my - dy * mx
        if pivot < 0:
            inertia -= (x * x + y * y) / total
            momentum -= (x * v - y * u) / total
            cx += x / total
            cy += y / total
        if not inertia > 0.0:
            continue
        rate = _inward(momentum + spared, inertia, system.bodies.spin[body, BY_ARC], h)
        turn = spared / inertia
        if rate != 0.0 or turn != 0.0:
            for r in range(span.first_row, span.last_row):
                p = rows.particle[r]
                dx = state.position[p, 0] - cx
                dy = state.position[p, 1] - cy
                state.velocity[p, 0] -= rate * dx + turn * dy
                state.velocity[p, 1] -= rate * dy - turn * dx


@inner_kernel
def kinetic_at_end(body: int, span: Span, system: System, h: float) -> float:
    """Kinetic energy of a body [J] by `v`, as it is at the end of the step."""
    rows = system.rows
    pivot, spared = system.bodies.pivot[body], system.bodies.spared[body]
    spin = spin_of_body(body, system)
    if not spin.inertia > 0.0:
        return kinetic(span, rows.mass, rows.v)
    doubled = total = u = v = inertia = momentum = outward = 0.0
    for r in range(span.first_row, span.last_row):
        m = rows.mass[r]
        vx = rows.v[r, 0]
        vy = rows.v[r, 1]
        dx = rows.position[r, 0] - spin.x + h * vx
        dy = rows.position[r, 1] - spin.y + h * vy
        doubled += m * (vx * vx + vy * vy)
        inertia += m * (dx * dx + dy * dy)
        momentum += m * (dx * vy - dy * vx)
        outward += m * (dx * vx + dy * vy)
        total += m
        u += m * vx
        v += m * vy
    if pivot < 0:
        # About the centre of mass as it then is, which has gone on by h V.
        common = (u * u + v * v) / total
        inertia -= h * h * common
        outward -= h * common
    if not inertia > 0.0:
        return 0.5 * doubled
    rate = _inward(momentum + spared, inertia, system.bodies.spin[body, BY_ARC], h)
    system.bodies.spin[body, END_INWARD] = rate
    system.bodies.spin[body, END_INERTIA] = inertia
    system.bodies.spin[body, END_X] = spin.x
    system.bodies.spin[body, END_Y] = spin.y
    if pivot < 0:
        system.bodies.spin[body, END_X] += h * u / total
        system.bodies.spin[body, END_Y] += h * v / total
    doubled += spared * (2.0 * momentum + spared) / inertia
    return 0.5 * doubled - rate * outward + 0.5 * rate * rate * inertia


@inner_kernel
def spin_of_body(body: int, system: System) -> RigidMotion:
    """How a body turns by v*, on chords; inertia is 0 where pins hold it, and not one alone, about which it turns."""
    numbers = system.bodies.spin
    return RigidMotion(
        numbers[body, SPIN_X],
        numbers[body, SPIN_Y],
        numbers[body, SPIN_VX],
        numbers[body, SPIN_VY],
        numbers[body, INERTIA],
        numbers[body, MOMENTUM],
    )


@inner_kernel
def torque_of(span: Span, rows: Rows, spin: RigidMotion, impulse: FloatRows) -> float:
    """The angular momentum [kg m^2/s] that impulses on a body's rows give it about the place that it turns about."""
    total = 0.0
    for r in range(span.first_row, span.last_row):
        total += (rows.position[r, 0] - spin.x) * impulse[r, 1] - (rows.position[r, 1] - spin.y) * impulse[r, 0]
    return total


@inner_kernel
def turn_to(span: Span, rows: Rows, spin: RigidMotion, momentum: float, vector: FloatRows) -> None:
    """Turn velocities (n, 2) [m/s] until they have this angular momentum; for what is slow."""
    missing = momentum
    for r in range(span.first_row, span.last_row):
        dx = rows.position[r, 0] - spin.x
        dy = rows.position[r, 1] - spin.y
        missing -= rows.mass[r] * (dx * vector[r, 1] - dy * vector[r, 0])
    turn = missing / spin.inertia
    for r in range(span.first_row, span.last_row):
        vector[r, 0] -= turn * (rows.position[r, 1] - spin.y)
        vector[r, 1] += turn * (rows.position[r, 0] - spin.x)


@inner_kernel
def add_torque(span: Span, rows: Rows, spin: RigidMotion, torque: float, vector: FloatRows) -> None:
    """Add the impulses (n, 2) [N s] to which what is rigid answers by turning alone."""
    rate = torque / spin.inertia
    for r in range(span.first_row, span.last_row):
        vector[r, 0] -= rows.mass[r] * rate * (rows.position[r, 1] - spin.y)
        vector[r, 1] += rows.mass[r] * rate * (rows.position[r, 0] - spin.x)


@inlined_kernel
def chord_at(motion: RigidMotion, x: float, y: float, h: float) -> tuple[float, float]:
    """The velocity [m/s] at (x, y) at which a step of h [s] turns a rigid body and keeps its lengths."""
    # V + (R - 1) r / h, whose angular momentum is I sin / h
    sine = min(max(h * turn_rate(motion), -1.0), 1.0)
    cosine = math.sqrt(1.0 - sine * sine)
    dx, dy = x - motion.x, y - motion.y
    return motion.u + ((cosine - 1.0) * dx - sine * dy) / h, motion.v + (sine * dx + (cosine - 1.0) * dy) / h


@inner_kernel
def kinetic_beside(span: Span, rows: Rows, motion: RigidMotion) -> float:
    """Kinetic energy [J] of what `v` moves beside a rigid motion."""
    total = 0.0
    for r in range(span.first_row, span.last_row):
        u, v = velocity_at(motion, rows.position[r, 0], rows.position[r, 1])
        u, v = rows.v[r, 0] - u, rows.v[r, 1] - v
        total += 0.5 * rows.mass[r] * (u * u + v * v)
    return total


@inner_kernel
def slow_beside(span: Span, rows: Rows, motion: RigidMotion, ratio: float, h: float) -> None:
    """Scale what `v` moves beside a rigid motion."""
    for r in range(span.first_row, span.last_row):
        u, v = chord_at(motion, rows.position[r, 0], rows.position[r, 1], h)
        rows.v[r, 0] = u + ratio * (rows.v[r, 0] - u)
        rows.v[r, 1] = v + ratio * (rows.v[r, 1] - v)
