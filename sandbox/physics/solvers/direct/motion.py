"""Velocities of one body's rows: copied, scaled, their energy, and what triangles leave of them."""

from sandbox.physics.arrays import FloatRows, Floats
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.system import Span, System
from sandbox.physics.untangling.triangle_clamp import AS_IT_WAS, clamp_triangles


@inner_kernel
def copy(span: Span, source: FloatRows, destination: FloatRows) -> None:
    """Copy the rows of a body from one array (n, 2) to another."""
    for r in range(span.first_row, span.last_row):
        destination[r, 0] = source[r, 0]
        destination[r, 1] = source[r, 1]


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
def hold_triangles(span: Span, system: System, h: float) -> int:
    """Clamp `v` so that no triangle of a body turns over in a step of h [s]; what that took: see clamp_triangles."""
    if span.last_constraint == span.first_constraint:
        return AS_IT_WAS
    return clamp_triangles(
        span.first_constraint, span.last_constraint, span.first_row, span.last_row, system.triangles, h
    )  # fmt: skip
