"""How steps of the direct solver passed its energy test, and were cut short, to be shown; no tick depends on it."""

from dataclasses import dataclass

from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.solvers.direct.energy_bank import BY_MASS
from sandbox.physics.world import World


@dataclass(frozen=True)
class EnergyTests:
    """How often each way through the energy test was the last that a step of a body or of an island needed.

    passed: the first solve; solved_on: a further one; gave_way: one for a lower target; minimised: one in which
    contacts only hold, or the minimum of f; slowed_down: velocities were reduced.
    """

    passed: int
    solved_on: int
    gave_way: int
    minimised: int
    slowed_down: int

    def __str__(self) -> str:
        return (
            f"{self.passed:,} passed, {self.solved_on:,} solved on, {self.gave_way:,} gave way, "
            f"{self.minimised:,} minimised, {self.slowed_down:,} slowed down"
        )


def energy_tests(world: World) -> EnergyTests:
    """The counts of a world since they were forgotten; all 0 in solvers without the test."""
    return EnergyTests(*block_of(world).given.workspace.ways[:BY_MASS].tolist())


def steps_by_mass(world: World) -> int:
    """How often a body had no time for its exact answer to contacts, and took that of its particles' masses."""
    return int(block_of(world).given.workspace.ways[BY_MASS])


def forget_energy_tests(world: World) -> None:
    """Set the counts of energy tests to 0."""
    block_of(world).given.workspace.ways[:] = 0
