"""Velocities of one body's rows: copied, scaled, their energy, the spin that a free body keeps, and its triangles."""

from sandbox.physics.collision.triangle_clamp import AS_IT_WAS, clamp_triangles
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.system import Rows, Span, System
from sandbox.physics.world import Floats


@inner_kernel
def copy(span: Span, source: Floats, destination: Floats) -> None:
    """Copy the rows of a body from one array (n, 2) to another."""
    for r in range(span.first_row, span.last_row):
        destination[r, 0] = source[r, 0]
        destination[r, 1] = source[r, 1]


@inner_kernel
def scale(span: Span, factor: float, vector: Floats) -> None:
    """Multiply the rows of a body of an array (n, 2)."""
    for r in range(span.first_row, span.last_row):
        vector[r, 0] *= factor
        vector[r, 1] *= factor


@inner_kernel
def kinetic(span: Span, mass: Floats, velocity: Floats) -> float:
    """Kinetic energy of one body [J]."""
    # 1/2 |v|^2_M
    total = 0.0
    for r in range(span.first_row, span.last_row):
        total += 0.5 * mass[r] * (velocity[r, 0] * velocity[r, 0] + velocity[r, 1] * velocity[r, 1])
    return total


@inner_kernel
def hold_spin(span: Span, rows: Rows) -> None:
    """Take from `trial` the angular momentum that a free body would gain: nothing outside turns it.

    Directions taken ahead turn a body that is violently out of shape. What is taken is a turn as a whole.
    """
    # v' -= turn x r,  turn = (L' - L) / I about the centre of mass
    mass = x = y = before = after = inertia = u = v = p = q = 0.0
    for r in range(span.first_row, span.last_row):
        m = rows.mass[r]
        mass += m
        x += m * rows.position[r, 0]
        y += m * rows.position[r, 1]
        u += m * rows.target[r, 0]
        v += m * rows.target[r, 1]
        p += m * rows.trial[r, 0]
        q += m * rows.trial[r, 1]
    x /= mass
    y /= mass
    for r in range(span.first_row, span.last_row):
        m = rows.mass[r]
        dx = rows.position[r, 0] - x
        dy = rows.position[r, 1] - y
        inertia += m * (dx * dx + dy * dy)
        before += m * (dx * (rows.target[r, 1] - v / mass) - dy * (rows.target[r, 0] - u / mass))
        after += m * (dx * (rows.trial[r, 1] - q / mass) - dy * (rows.trial[r, 0] - p / mass))
    kept = min(max(after, min(0.0, before)), max(0.0, before))
    if kept == after or not inertia > 0.0:
        return
    turn = (kept - after) / inertia
    for r in range(span.first_row, span.last_row):
        rows.trial[r, 0] -= turn * (rows.position[r, 1] - y)
        rows.trial[r, 1] += turn * (rows.position[r, 0] - x)


@inner_kernel
def hold_triangles(span: Span, system: System, h: float) -> int:
    """Let `trial` turn over no triangle of a body in a step of h [s]; what that took: see clamp_triangles."""
    if span.last_constraint == span.first_constraint:
        return AS_IT_WAS
    return clamp_triangles(
        span.first_constraint, span.last_constraint, span.first_row, span.last_row, system.triangles, h
    )  # fmt: skip
