"""Solvers: schedules of the one equation, with one signature, by the name that level files use."""

from collections.abc import Callable
from dataclasses import dataclass

from sandbox.physics.forces import Before
from sandbox.physics.solvers import iterative, single_pass
from sandbox.physics.solvers.direct import contact_solve, solve
from sandbox.physics.solvers.single_pass import Pair
from sandbox.physics.world import Floats, World


@dataclass(frozen=True)
class Solver:
    """One schedule of the equation.

    solve(world, springs, elements, h, before): brings world.velocity from after the forces to the end of a step of
    h [s], with Cs and Cd (m,) of the springs and (t,) of the elements in that step; before: what the step began with.
    spring_constant(stiffness, damping, reduced_mass [kg], h): k [N/m] of the energy k/2 x^2. proven_limit: whether the
    limits of `stability` hold for it. bounded: whether it needs none, because it tests the energy of every step.
    """

    solve: Callable[[World, Pair, Pair, float, Before], None]
    spring_constant: Callable[[Floats, Floats, Floats, float], Floats]
    proven_limit: bool
    bounded: bool


SOLVERS = {
    "single_pass": Solver(single_pass.solve, single_pass.spring_constant, proven_limit=True, bounded=False),
    "iterative": Solver(iterative.solve, single_pass.spring_constant, proven_limit=False, bounded=False),
    "direct": Solver(contact_solve.solve, solve.spring_constant, proven_limit=False, bounded=True),
}
