"""A map of a sweep: Cs across, Cd up, one panel for each point of all else, and its proven limits."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sandbox.level.assembly.build_world import build_world
from sandbox.physics.analysis.stability import CoefficientZones, coefficient_zones
from sandbox.physics.arrays import Floats
from sandbox.session.sweep.grid import CD, CS, Rows, SweepGrid, Value, case_level

# Maps in one picture; more could not be read.
MOST_MAPS = 80
# Values of Cs at which limits are worked out.
LIMIT_POINTS = 81


@dataclass(frozen=True)
class SweepPanel:
    """One panel: title and, by measure, values (cd, cs), NaN where there is none; zones: None where none apply."""

    title: str
    values: dict[str, Floats]
    zones: CoefficientZones | None


def panel_count(grid: SweepGrid) -> int:
    """How many panels a grid has."""
    return grid.runs // (len(grid.columns[CS]) * len(grid.columns[CD]))


def is_logarithmic(values: Floats) -> bool:
    """Whether values (k,) have equal ratios and not equal steps, as ":log" makes them."""
    if len(values) < 3 or values.min() <= 0.0:
        return False
    ratios = np.diff(np.log(values))
    return bool(np.allclose(ratios, ratios[0], rtol=1e-3)) and not np.allclose(np.diff(values), values[1] - values[0])


def edges(values: Floats) -> Floats:
    """The edges (k + 1,) of the cells around rising values (k,)."""
    if is_logarithmic(values):
        return np.asarray(np.exp(edges(np.log(values))))
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[1.5 * values[0] - 0.5 * values[1]], middle, [1.5 * values[-1] - 0.5 * values[-2]]])


def sweep_panels(grid: SweepGrid, rows: Rows) -> Iterator[SweepPanel]:
    """The panels of a grid that has Cs and Cd, in order; rows may lack some runs."""
    others = [name for name in grid.columns if name not in (CS, CD)]
    for case in itertools.product(*(grid.columns[name] for name in others)):
        chosen = dict(zip(others, case, strict=True))
        yield SweepPanel(_title(chosen), panel_values(grid, rows, chosen)[1], _zones(grid, others, case))


def panel_values(
    grid: SweepGrid, rows: Rows, chosen: Mapping[str, object]
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Rising values of Cs and of Cd, and by measure values (cd, cs) where all else has chosen values.

    NaN where there is none, of every measure where rows lack a run.
    """
    axes = {name: np.sort(np.array(grid.columns[name], dtype=np.float64)) for name in (CS, CD)}
    values = {name: np.full((len(axes[CD]), len(axes[CS])), math.nan) for name in grid.figures}
    names = list(grid.columns)
    for number, row in rows.items():
        point = dict(zip(names, grid.cases[number], strict=True))
        if all(point[name] == value for name, value in chosen.items()):
            at = tuple(int(np.searchsorted(axes[name], point[name])) for name in (CD, CS))
            for name, value in zip(grid.figures, row, strict=True):
                values[name][at] = math.nan if value is None else value
    return axes, values


def _zones(grid: SweepGrid, others: list[str], case: tuple[Value, ...]) -> CoefficientZones | None:
    world = build_world(case_level(grid.level, others, case))
    material = None if grid.material is None else list(world.material_names).index(grid.material)
    ends = edges(np.sort(np.array(grid.columns[CS], dtype=np.float64)))
    low, high = max(float(ends[0]), 1e-6), min(float(ends[-1]), 1.0)
    both = np.concatenate([np.linspace(low, high, LIMIT_POINTS), np.geomspace(low, high, LIMIT_POINTS)])
    return coefficient_zones(world, material, np.unique(both)) if high > low else None


def _title(chosen: Mapping[str, Value]) -> str:
    words = []
    for name, value in chosen.items():
        field = name.removeprefix("settings.").removeprefix("bodies.")
        words.append(str(value).replace("_", " ") if field == "solver" else f"{field.replace('_', ' ')} {value}")
    return ", ".join(words)
