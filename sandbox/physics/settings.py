"""WorldSettings: the few numbers of a world that are no arrays."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

# Substeps that every tick chooses for itself, see substeps.py.
AUTO: Literal["auto"] = "auto"
Substeps = int | Literal["auto"]
# Powers of two, which the exact map of coefficients needs, or auto.
SubstepChoice = Literal[1, 2, 4, 8, 16, 32, 64, "auto"]
SUBSTEPS: tuple[int, ...] = tuple(each for each in get_args(SubstepChoice) if each != AUTO)
# The names of `SOLVERS`, which needs the world and so cannot be asked here.
SolverName = Literal["single_pass", "iterative", "direct"]
SOLVER_NAMES: tuple[str, ...] = get_args(SolverName)
# The solver of a world or a level that names none.
DEFAULT_SOLVER = "direct"

# Settings as kernels read them: places among the numbers and among the choices; SOLVER by its place in SOLVER_NAMES.
GRAVITY_X, GRAVITY_Y, WIND_X, WIND_Y, DRAG, WARM_START = range(6)
NUMBER_COUNT = 6
NUMBER_NAMES = ("gravity x", "gravity y", "wind x", "wind y", "drag", "warm start")
SOLVER, TICK_RATE, SUBSTEP_COUNT, IS_AUTO, ITERATIONS = range(5)
SINGLE_PASS, ITERATIVE, DIRECT = range(3)


@dataclass(frozen=True)
class WorldSettings:
    """The settings of a tick: gravity [m/s^2], tick rate [1/s], substeps, solver, wind [m/s], drag [1/s].

    Drag is the rate at which every free particle takes on the wind's velocity, for all masses. Raises ValueError, one
    line, for a value without meaning.
    """

    gravity: tuple[float, float] = (0.0, -9.81)
    tick_rate: int = 60
    substeps: Substeps = 1
    solver: str = DEFAULT_SOLVER
    iterations: int = 10
    warm_start: float = 0.5
    wind: tuple[float, float] = (0.0, 0.0)
    drag: float = 0.0

    def __post_init__(self) -> None:
        if self.solver not in SOLVER_NAMES:
            raise ValueError(f"there is no solver {self.solver!r}; there are {', '.join(SOLVER_NAMES)}")
        if self.substeps != AUTO and not (_is_whole(self.substeps) and self.substeps in SUBSTEPS):
            raise ValueError(f'substeps is a power of two from 1 to {SUBSTEPS[-1]} or "{AUTO}", not {self.substeps!r}')
        for name in ("tick_rate", "iterations"):
            value = getattr(self, name)
            if not (_is_whole(value) and value >= 1):
                raise ValueError(f"{name} is a whole number of at least 1, not {value!r}")
        for name in ("gravity", "wind"):
            value = getattr(self, name)
            if not (isinstance(value, tuple) and len(value) == 2 and all(map(_is_finite, value))):
                raise ValueError(f"{name} is a pair of finite numbers, not {value!r}")
        if not (_is_finite(self.warm_start) and 0.0 <= self.warm_start <= 1.0):
            raise ValueError(f"warm_start is a number from 0 to 1, not {self.warm_start!r}")
        if not (_is_finite(self.drag) and self.drag >= 0.0):
            raise ValueError(f"drag is a finite number of at least 0, not {self.drag!r}")

    @property
    def numbers(self) -> tuple[float, ...]:
        """The settings that are numbers, in the order of the kernels' array."""
        return (*self.gravity, *self.wind, self.drag, self.warm_start)

    @classmethod
    def of(cls, numbers: Sequence[float], choices: Sequence[int]) -> "WorldSettings":
        """The settings from the arrays of kernels."""
        x, y, wind_x, wind_y, drag, warm_start = numbers
        solver, tick_rate, substeps, is_auto, iterations = choices
        return cls(
            (x, y), tick_rate, AUTO if is_auto else substeps, SOLVER_NAMES[solver], iterations, warm_start,
            (wind_x, wind_y), drag,
        )  # fmt: skip

    @property
    def choices(self) -> tuple[int, int, int, int, int]:
        """The settings that are whole numbers, as kernels read them; SUBSTEP_COUNT 0: each tick chooses."""
        auto = self.substeps == AUTO
        substeps = 0 if auto else int(self.substeps)
        return SOLVER_NAMES.index(self.solver), self.tick_rate, substeps, int(auto), self.iterations

    @property
    def fewest_substeps(self) -> int:
        """Substeps that every tick takes at least; what limits, energies and stored impulses are stated for."""
        return 1 if self.substeps == AUTO else self.substeps


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_finite(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
