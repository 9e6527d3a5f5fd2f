"""WorldSettings: the few numbers of a world that are no arrays."""

from dataclasses import dataclass


@dataclass(frozen=True)
class WorldSettings:
    """What a tick needs besides arrays: gravity [m/s^2], tick rate [1/s], substeps and the settings of the solver."""

    gravity: tuple[float, float] = (0.0, -9.81)
    tick_rate: int = 60
    substeps: int = 1
    solver: str = "iterative"
    iterations: int = 10
    warm_start: float = 0.5
