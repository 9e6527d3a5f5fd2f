"""SweepGrid: a level and the points of settings at which a sweep runs it."""

import hashlib
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import level_data, parse_level
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.level_edits import SILENT, with_value

# Columns that are Cs and Cd; all others are fields of the level.
CS, CD = "cs", "cd"
# What is measured of a run, before its checks.
FIGURES = ("settle_time", "max_strain", "energy_drift", "broken_springs", "blew_up")

Value = float | int | str


class SweepError(ValueError):
    """A sweep that cannot be run; one line."""


@dataclass(frozen=True)
class SweepRequest:
    """The sweep as a process gets it: the level as text, names of columns, ticks of a run.

    material: its springs have the Cs and Cd; None = all springs.
    """

    text: str
    columns: tuple[str, ...]
    ticks: int
    material: str | None
    physics_version: int = PHYSICS_VERSION

    @property
    def level(self) -> Level:
        """The level that is swept."""
        return _level(self.text)


@dataclass(frozen=True)
class SweepGrid:
    """A level and the values of every column, of which the last changes fastest; ticks of each run.

    material: name of that whose springs have the Cs and Cd of the grid; None = all springs.
    Raises SweepError where two points would be the same.
    """

    level: Level
    columns: Mapping[str, tuple[Value, ...]]
    ticks: int
    material: str | None = None
    request: SweepRequest = field(init=False, compare=False)

    def __post_init__(self) -> None:
        for name, values in self.columns.items():
            if len(set(values)) < len(values):
                raise SweepError(f"{name}: a value is given twice")
        text = json.dumps(level_data(self.level))
        object.__setattr__(self, "request", SweepRequest(text, tuple(self.columns), self.ticks, self.material))

    @property
    def runs(self) -> int:
        """How many points there are."""
        return math.prod(map(len, self.columns.values()))

    @cached_property
    def cases(self) -> list[tuple[Value, ...]]:
        """The points, in order."""
        return list(itertools.product(*self.columns.values()))

    @property
    def figures(self) -> list[str]:
        """Names of what each run is measured by."""
        return [*FIGURES, *(f"check: {check.name}" for check in self.level.checks)]

    @property
    def header(self) -> list[str]:
        """Names of the columns of the table."""
        return [*self.columns, *self.figures, "seconds", "level"]

    @property
    def seconds(self) -> float:
        """How long each run is [s]."""
        return self.ticks / self.level.settings.tick_rate

    @cached_property
    def digest(self) -> str:
        """A digest of a level without the swept fields and without looks."""
        level = case_level(self.level, tuple(self.columns), [values[0] for values in self.columns.values()])
        shown = set(SILENT) - {"checks"}
        data = {name: value for name, value in level_data(level).items() if name not in shown}
        text = json.dumps([data, self.material, PHYSICS_VERSION], sort_keys=True)
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


@lru_cache(maxsize=4)
def _level(text: str) -> Level:
    return parse_level(text.encode(), "the swept level")


def case_level(level: Level, columns: Sequence[str], case: Sequence[Value]) -> Level:
    """The level of one point, but for Cs and Cd. Raises SweepError for a value that it cannot have."""
    try:
        for name, value in zip(columns, case, strict=True):
            if name not in (CS, CD):
                level = with_value(level, name, value)
    except LevelError as error:
        raise SweepError(f"{name} = {value}: {error.faults[0]}") from None
    return level
