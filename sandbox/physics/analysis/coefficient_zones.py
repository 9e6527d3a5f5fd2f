"""Zones of Cs and Cd: what theory says of every pair of them, for the springs of a world, its solver and substeps."""

from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.stability import BOUND, largest_eigenvalue, most_springs, stability_limit
from sandbox.physics.arrays import Floats
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import turned
from sandbox.physics.world import World

# Steps of the bisection that finds where a zone ends: to 1e-6 of the range.
BISECTIONS = 20
# Of worlds of more springs the explosion is not estimated: the eigenvalue takes too long for a window.
MOST_ESTIMATED = 6000


@dataclass(frozen=True)
class CoefficientZones:
    """Zones of Cs and Cd per tick; see `coefficient_zones`.

    stiffness (k,): values of Cs. For each, as the highest Cd (k,) inside, -1 where none is: `article`, both at most
    1/(n+1) in every substep, with n = most_springs; `proven`, what is proven stable; `estimated`, what the largest
    eigenvalue says. None where a zone does not apply. bounded: whether the solver bounds the energy whatever Cs and Cd
    are; holds: whether the zones hold for the solver, and are not only those that a single pass would have.
    """

    stiffness: Floats
    article: Floats | None
    proven: Floats | None
    estimated: Floats | None
    most_springs: int
    bounded: bool
    holds: bool


def coefficient_zones(world: World, material: int | None, stiffness: Floats) -> CoefficientZones:
    """The zones of a material's springs (None = all) at given values of Cs (k,), all else as it is now.

    What is `estimated` takes the other materials to have the same Cs and Cd.
    """
    kind, most = SOLVERS[world.settings.solver], most_springs(world, material)
    if kind.bounded or most == 0:
        return CoefficientZones(stiffness, None, None, None, most, kind.bounded, True)
    count, article = world.settings.fewest_substeps, 1.0 / (most + 1.0)
    limit, lam = stability_limit(world, material), 0.0
    if world.spring_count <= MOST_ESTIMATED:
        lam = largest_eigenvalue(world)

    def highest(largest_stiffness: float, largest_damping: float, demand: float) -> Floats:
        return _highest_damping(stiffness, count, largest_stiffness, largest_damping, demand)

    estimated = highest(np.inf, 2.0 / lam, BOUND / lam) if lam > 0.0 else None
    return CoefficientZones(
        stiffness, highest(article, article, np.inf), highest(np.inf, np.inf, limit), estimated, most, False,
        kind.proven_limit,
    )  # fmt: skip


def _highest_damping(
    stiffness: Floats, substeps: int, largest_stiffness: float, largest_damping: float, demand: float
) -> Floats:
    """The highest Cd (k,) per tick at which Cs, Cd and Cs + 2 Cd of a substep are within bounds; -1 where none is."""

    def is_inside(damping: Floats) -> np.ndarray:
        # Cs and Cd of a substep grow with both of those of a tick, so bisection finds the edge.
        each, damp = turned(stiffness, damping, np.zeros(len(stiffness)), substeps)
        return (each <= largest_stiffness) & (damp <= largest_damping) & (each + 2.0 * damp < demand)

    low, high = np.zeros(len(stiffness)), np.ones(len(stiffness))
    nothing, everything = ~is_inside(low), is_inside(high)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        inside = is_inside(middle)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.where(nothing, -1.0, np.where(everything, 1.0, low))
