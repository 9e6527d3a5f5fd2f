"""Solvers: schedules of the one equation, with one signature, by the name that level files use.

A solver, and what it does about contacts, is imported when it is first used: a name needs none of them, a run one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from sandbox.physics.forces import Before
    from sandbox.physics.solvers.single_pass import Pair
    from sandbox.physics.world import Floats, World


class Schedule(NamedTuple):
    """What a solver does.

    solve(world, springs, elements, h, before): brings world.velocity from after the forces to the end of a step of
    h [s], with Cs and Cd (m,) of the springs and (t,) of the elements in that step; before: what the step began with.
    spring_constant(stiffness, damping, reduced_mass [kg], h): k [N/m] of the energy k/2 x^2.
    """

    solve: "Callable[[World, Pair, Pair, float, Before], None]"
    spring_constant: "Callable[[Floats, Floats, Floats, float], Floats]"


@dataclass(frozen=True)
class Solver:
    """One solver; load: imports its schedule.

    proven_limit: whether the limits of `stability` hold for it. bounded: whether it needs none, because it tests the
    energy of every step.
    """

    load: Callable[[], Schedule]
    proven_limit: bool
    bounded: bool

    @cached_property
    def schedule(self) -> Schedule:
        """What it does, imported once."""
        return self.load()


def _single_pass() -> Schedule:
    from sandbox.physics.solvers import single_pass

    return Schedule(single_pass.solve, single_pass.spring_constant)


def _iterative() -> Schedule:
    from sandbox.physics.solvers import iterative, single_pass

    return Schedule(iterative.solve, single_pass.spring_constant)


def _direct() -> Schedule:
    from sandbox.physics.solvers.direct.solve import solve, spring_constant

    def solve_or_push(world: "World", springs: "Pair", elements: "Pair", h: float, before: "Before") -> None:
        if world.contacts is None:
            solve(world, springs, elements, h, before)
            return
        from sandbox.physics.solvers.direct import contact_solve

        contact_solve.solve(world, springs, elements, h, before)

    return Schedule(solve_or_push, spring_constant)


SOLVERS = {
    "single_pass": Solver(_single_pass, proven_limit=True, bounded=False),
    "iterative": Solver(_iterative, proven_limit=False, bounded=False),
    "direct": Solver(_direct, proven_limit=False, bounded=True),
}
