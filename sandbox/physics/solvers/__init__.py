"""Solvers: schedules of the one equation, by the name that level files use."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sandbox.physics.arrays import Floats


@dataclass(frozen=True)
class Solver:
    """Properties of one solver; the tick has its branch.

    proven_limit: whether the limits of `stability` hold for it. bounded: whether it needs none, because it tests the
    energy of every step. joints_bear_load: whether what joints give, such as a motor's torque, carries wheels under a
    load. has_floors: whether it holds triangles from outside, with an energy of its own. highest: Cs and Cd of a tick
    are at most this where it has several substeps, as (1, 1) alone would stay so in each of them.
    """

    module: str
    proven_limit: bool
    bounded: bool
    joints_bear_load: bool = True
    has_floors: bool = False
    highest: float = 1.0

    @cached_property
    def spring_constant(self) -> "Callable[[Floats, Floats, Floats, float], Floats]":
        """spring_constant(stiffness, damping, reduced_mass [kg], h): k [N/m] of the energy k/2 x^2."""
        found: Any = import_module(f"{__name__}.{self.module}").spring_constant
        return found


# With 1, what a wheel's springs give way where it meets the ground throws it off again: in a fraction of a tick the
# velocity that takes an error back is as many times greater, and nothing damps it. Less lets light wheels sink under
# heavy loads in two substeps, more lets them hop in eight.
HIGHEST_ITERATED = 1.0 - 1e-5

SOLVERS = {
    "single_pass": Solver("single_pass", proven_limit=True, bounded=False, joints_bear_load=False),
    "iterative": Solver("iterative", proven_limit=False, bounded=False, highest=HIGHEST_ITERATED),
    "direct": Solver("direct.solve", proven_limit=False, bounded=True, has_floors=True),
}
