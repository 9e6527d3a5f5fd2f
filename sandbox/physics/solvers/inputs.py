"""The input of a substep, as solvers take it."""

from typing import NamedTuple

from sandbox.physics.arrays import FloatRows, Floats


class Inputs(NamedTuple):
    """The input of a substep: Cs and Cd of springs (m,) and constraints (t,) in it, and its start.

    start [m/s] (n, 2), start_length [m] (m,): velocities and rest lengths before forces and drives. drag_factor: see
    `drag_factor_of`.
    """

    stiffness: Floats
    damping: Floats
    constraint_stiffness: Floats
    constraint_damping: Floats
    start: FloatRows
    start_length: Floats
    drag_factor: float
