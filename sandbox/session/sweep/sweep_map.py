"""What a map of a sweep shows: Cs across, Cd up, one panel for each point of all else, and its proven limits."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.level.build.build_world import build_world
from sandbox.physics.coefficient_zones import CoefficientZones, coefficient_zones
from sandbox.physics.world import Floats
from sandbox.session.sweep.grid import CD, CS, SweepGrid, Value, case_level
from sandbox.session.sweep.table import Rows

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
    names = list(grid.columns)
    axes = [np.argsort(np.array(grid.columns[name], dtype=np.float64)) for name in (CD, CS)]
    figures = np.full((grid.runs, len(grid.figures)), math.nan)
    for number, row in rows.items():
        figures[number] = [math.nan if value is None else value for value in row]
    table = figures.reshape(*map(len, grid.columns.values()), -1)
    places = {name: {value: k for k, value in enumerate(grid.columns[name])} for name in others}
    for case in itertools.product(*(grid.columns[name] for name in others)):
        chosen = dict(zip(others, case, strict=True))
        at = tuple(slice(None) if name in (CS, CD) else places[name][chosen[name]] for name in names)
        part = table[at] if names.index(CD) < names.index(CS) else table[at].swapaxes(0, 1)
        part = part[np.ix_(*axes)]
        values = {name: part[:, :, k] for k, name in enumerate(grid.figures)}
        yield SweepPanel(_title(chosen), values, _zones(grid, others, case))


def _zones(grid: SweepGrid, others: list[str], case: tuple[Value, ...]) -> CoefficientZones | None:
    world = build_world(case_level(grid.level, others, case))
    material = None if grid.material is None else list(world.material_names).index(grid.material)
    ends = edges(np.sort(np.array(grid.columns[CS], dtype=np.float64)))
    low, high = max(float(ends[0]), 1e-6), min(float(ends[-1]), 1.0)
    both = np.concatenate([np.linspace(low, high, LIMIT_POINTS), np.geomspace(low, high, LIMIT_POINTS)])
    return coefficient_zones(world, material, np.unique(both)) if high > low else None


def _title(chosen: dict[str, Value]) -> str:
    words = []
    for name, value in chosen.items():
        field = name.removeprefix("settings.").removeprefix("bodies.")
        words.append(str(value).replace("_", " ") if field == "solver" else f"{field.replace('_', ' ')} {value}")
    return ", ".join(words)
