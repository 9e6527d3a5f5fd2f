"""Directions of springs are taken ahead, by the fast part of velocities: slow motion then keeps its energy.

    s += c,  c = SLOW_SHARE (v' - s);   r += SLOW_SHARE (c - r)                   per step (integrate.py)
    directions at  x + h FAST [(2 - SLOW_SHARE) SLOW_SHARE (v' - s) - (1 - SLOW_SHARE) r]  =  x + h AHEAD (v' - slow)

A transverse mode that turns by theta a step would lose some theta^3 of its energy a radian with s alone, and theta^5
with both.
"""

from sandbox.physics.integrate import SLOW_SHARE
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.direct.system import Rows, Span
from sandbox.physics.state import State

# Below 0.9 it is unstable at the taut end; higher damps swings more.
FAST = 1.2
AHEAD = FAST * SLOW_SHARE * (2.0 - SLOW_SHARE)
CHANGE_BEHIND = (1.0 - SLOW_SHARE) / (SLOW_SHARE * (2.0 - SLOW_SHARE))


@inner_kernel
def find_slow(span: Span, rows: Rows, state: State) -> None:
    """Find what directions ahead leave out of the velocities of one body's rows."""
    for r in range(span.first_row, span.last_row):
        p = rows.particle[r]
        for axis in range(2):
            rows.slow[r, axis] = state.slow_velocity[p, axis] + CHANGE_BEHIND * state.slow_change[p, axis]
