"""WorldSettings: the few numbers of a world that are no arrays."""

from dataclasses import dataclass
from typing import Literal

# Substeps that every tick chooses for itself, see substeps.py.
AUTO: Literal["auto"] = "auto"
Substeps = int | Literal["auto"]


@dataclass(frozen=True)
class WorldSettings:
    """What a tick needs besides arrays: gravity [m/s^2], tick rate [1/s], substeps, solver, wind [m/s], drag [1/s].

    Drag is the rate at which every free particle takes on the wind's velocity, whatever its mass.
    """

    gravity: tuple[float, float] = (0.0, -9.81)
    tick_rate: int = 60
    substeps: Substeps = 1
    solver: str = "iterative"
    iterations: int = 10
    warm_start: float = 0.5
    wind: tuple[float, float] = (0.0, 0.0)
    drag: float = 0.0

    @property
    def fewest_substeps(self) -> int:
        """Substeps that every tick takes at least; what limits, energies and stored impulses are stated for."""
        return 1 if self.substeps == AUTO else self.substeps
