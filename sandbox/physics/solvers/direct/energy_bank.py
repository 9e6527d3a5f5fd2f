"""One body in a step of the direct solver: what it begins with, its energies, and the energy bank of its losses."""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.constraint_terms import load_shapes, shape_potential
from sandbox.physics.solvers.direct.newton import copy
from sandbox.physics.solvers.direct.spring_terms import kinetic, load_springs, potential

# s += SLOW_SHARE (v' - s), per step. Higher leaves fast vibration undamped, lower damps slow turning.
SLOW_SHARE = 0.3
# The velocities foreseen before a first solve are v + CHANGE_AHEAD (v - s): of an even change, s lags behind by that of
# 1 / CHANGE_AHEAD steps. Without it, or with less, smooth turning takes two solves where one is enough.
CHANGE_AHEAD = SLOW_SHARE / (1.0 - SLOW_SHARE)
# A body's bank holds at most this share of its energy: where every spring has Cs <= Cd, and where one has not (its
# energy in this measure swings by up to 3 within a period). 0 would reject most steps at Cs = Cd = 1.
BANK_SHARE = 0.05
BOUNCY_BANK_SHARE = 3.0


@inner_kernel
def load_rows(position, velocity, mass, slow_velocity, before, h, free_count, rows):  # type: ignore[no-untyped-def]
    """Bring every row to the start of a step of h [s], with a first guess of its end in `trial`."""
    for r in range(rows.particle.shape[0]):
        p = rows.particle[r]
        rows.mass[r] = mass[p]
        rows.inertia[r] = mass[p]
        for axis in range(2):
            rows.position[r, axis] = position[p, axis]
            rows.moved[r, axis] = position[p, axis]
            rows.target[r, axis] = velocity[p, axis]
            rows.aim[r, axis] = velocity[p, axis]
            rows.start[r, axis] = before[p, axis]
            rows.slow[r, axis] = slow_velocity[p, axis]
        if r >= free_count:
            rows.moved[r, 0] += velocity[p, 0] * h
            rows.moved[r, 1] += velocity[p, 1] * h
        for axis in range(2):
            rows.trial[r, axis] = rows.start[r, axis]
            if r < free_count:
                rows.trial[r, axis] += CHANGE_AHEAD * (rows.start[r, axis] - rows.slow[r, axis])


@inner_kernel
def load_body(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, low, high, free, inverse_mass, rest_length, stiffness, damping, material,
    tension, rows, springs, shapes, least, most, parts, h, free_count,
):  # fmt: skip
    """Load a body's springs and elements: whether one is bouncy, whether measures are spread, their energy once moved.

    See `load_springs`.
    """
    body_mass = 0.0
    for r in range(first_row, last_row):
        body_mass += rows.mass[r]
    # Gravity moves a body without anchors as a whole: started there, it falls without rounding.
    if free:
        copy(first_row, last_row, rows.target, rows.trial)
    bouncy, spread, moved = load_springs(
        first, last, body_mass, inverse_mass, rest_length, stiffness, damping, material, tension, rows, springs,
        least, most, parts, h, free_count,
    )  # fmt: skip
    if high > low:
        more_bouncy, more_spread, more_moved = load_shapes(low, high, inverse_mass, rows, shapes, parts, h)
        bouncy = bouncy or more_bouncy
        spread = spread or more_spread
        moved += more_moved
    return bouncy, spread, moved


@inner_kernel
def body_potential(first, last, low, high, position, velocity, springs, shapes, rest_length, time, h):  # type: ignore[no-untyped-def]
    """Energy of one body's springs and elements at position + time velocity [J]."""
    return potential(
        first, last, position, velocity, springs, springs.measured, rest_length, time, h
    ) + shape_potential(low, high, position, velocity, shapes, shapes.measured, time, h)  # fmt: skip


@inner_kernel
def body_hidden(first, last, low, high, position, velocity, springs, shapes, rest_length, time, h):  # type: ignore[no-untyped-def]
    """What the most k adds to that energy [J]."""
    return potential(
        first, last, position, velocity, springs, springs.hidden, rest_length, time, h
    ) + shape_potential(low, high, position, velocity, shapes, shapes.hidden, time, h)  # fmt: skip


@inner_kernel
def body_energy(first_row, last_row, first, last, low, high, rows, springs, shapes, rest_length, h):  # type: ignore[no-untyped-def]
    """Energy of one body after the step [J]: kinetic at `trial`, and that of its springs and elements."""
    # H = KE(v') + PE(x + h v')
    return kinetic(first_row, last_row, rows.mass, rows.trial) + body_potential(
        first, last, low, high, rows.position, rows.trial, springs, shapes, rest_length, h, h
    )


@inner_kernel
def open_bank(  # type: ignore[no-untyped-def]
    first_row, last_row, first, last, low, high, rows, springs, shapes, bank, lowest, bouncy, spread, kinetic_after,
    moved, rest_length, rest_before, h,
):  # fmt: skip
    """What one body's bank holds before the step [J]; moved: energy of its springs once pins and drives have moved."""
    # It is begun anew where a particle says so (-1): after any change from outside.
    # A body that broke off begins with none: what is saved stays with the particle that was the lowest, once.
    begun = True
    for r in range(first_row, last_row):
        p = rows.particle[r]
        if bank[p] < 0.0:
            begun = False
        if p != lowest:
            bank[p] = 0.0
    held = bank[lowest] if begun else 0.0
    if spread:
        # Of the start, and of the work of hands and drives.
        hidden = body_hidden(first, last, low, high, rows.position, rows.start, springs, shapes, rest_before, 0.0, h)
        hidden_moved = body_hidden(first, last, low, high, rows.moved, rows.moved, springs, shapes, rest_length, 0.0, h)
        held += max(0.0, hidden_moved - hidden)
        if not begun:
            held += hidden
    if not bouncy:
        return held
    before = kinetic(first_row, last_row, rows.mass, rows.start)
    present = body_potential(first, last, low, high, rows.position, rows.start, springs, shapes, rest_before, 0.0, h)
    if not begun:
        held += BOUNCY_BANK_SHARE * (before + present)
    # Work done by forces, hands and drives since then counts as energy of the start.
    return max(0.0, held + BOUNCY_BANK_SHARE * (kinetic_after - before + moved - present))
