"""PadSweeps: what sweeps of the level on the screen say of every Cs and Cd, found in the background and kept."""

import contextlib
import json
import os
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import platformdirs
import pygame

from sandbox.app.base.sag_map import PLAIN
from sandbox.app.panel.coefficient_pad import CoefficientPad
from sandbox.app.panel.sweeps.sweep_layer import SweepLayer, measure_of
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.level.document.model import CHANGEABLE_SETTINGS, Level
from sandbox.level.format.level_error import LevelError
from sandbox.physics.settings import WorldSettings
from sandbox.processors import cores
from sandbox.session.level_edits import with_settings
from sandbox.session.sweep.background import BackgroundSweep
from sandbox.session.sweep.grid import CD, CS, Journal, Rows, SweepError, SweepGrid, read_table
from sandbox.session.sweep.sweep_map import panel_values

# Values on each axis of the pad, and how long each run is [s].
SIDE, SECONDS = 13, 10.0
# Processes of the machine that are counted on, but for that of the window.
MOST_PROCESSES = 4
# Sweeps that are kept, those used last.
KEPT = 60
SOLVER, SUBSTEPS = "settings.solver", "settings.substeps"
THEORY = "Theory"
# Size of a menu's text, and what the menu has beside it [layout units].
MENU_TEXT, MENU_EDGES = 13.0, 40.0


class _Found(NamedTuple):
    """A sweep, the file that it was opened from, its journal where it is not whole, and its rows."""

    file: Path | None
    grid: SweepGrid
    journal: Journal | None
    rows: Rows


class PadSweeps:
    """Sweeps of the level that runs, for one measure that is shown (None: none is)."""

    def __init__(self) -> None:
        self.measure: str | None = None
        self.layer: SweepLayer | None = None
        self.error: str | None = None
        self._file: Path | None = None
        self._of: tuple[Level, WorldSettings, str | None] | None = None
        self._grid: SweepGrid | None = None
        self._journal: Journal | None = None
        self._rows: Rows = {}
        self._work: BackgroundSweep | None = None
        self._thread = ThreadPoolExecutor(1)
        self._finding: Future[_Found] | None = None

    @property
    def progress(self) -> tuple[int, int]:
        """How many runs are known, and how many there are."""
        return len(self._rows), 0 if self._grid is None else self._grid.runs

    def show(self, measure: str | None) -> None:
        """Show a measure; None: nothing, and no more runs are made."""
        self.measure, self.error = measure, None
        if measure is None:
            self.stop()
        self._paint()

    def load(self, path: Path, level: Level, settings: WorldSettings, materials: Sequence[str]) -> str | None:
        """Show a table that `sandbox sweep` made of the level; the material that it is of.

        Raises SweepError where it is of another level or no map of these settings, and OSError.
        """
        present = _present(level, settings)
        grid, _ = read_table(path, present, (None, *materials))
        _place_in(grid, settings)
        self._file, self._of = path, None
        if self.measure not in grid.figures:
            self.show(grid.figures[0])
        return grid.material

    def follow(self, level: Level, settings: WorldSettings, material: str | None) -> None:
        """Show sweeps of a level with its settings as they are now, and of a material's springs (None = all)."""
        if self.measure is None:
            return
        if self._of is not None and self._of[0] is level and self._of[1:] == (settings, material):
            return
        self.stop()
        self._of, self.error = (level, settings, material), None
        self._journal, self._grid, self._rows = None, None, {}
        # Files may take their time.
        self._finding = self._thread.submit(_find, self._file, level, settings, material)
        self._paint()

    def update(self) -> bool:
        """Take in new results; whether there are any."""
        if self._finding is not None and self._finding.done():
            self._begin(self._finding)
            self._finding = None
            self._paint()
            return True
        if self._work is None or self._journal is None:
            return False
        found = self._work.new_rows()
        with contextlib.suppress(OSError):
            for number, row in found:
                self._journal.add(number, row)
        before, self.error = self.error, self._work.error or self.error
        if self._work.is_done:
            self._work.stop()
            self._work = None
            self._thread.submit(self._journal.finish)
        if found:
            self._paint()
        return bool(found) or before != self.error

    def stop(self) -> None:
        """Stop the child processes; results stay."""
        if self._work is not None:
            self._work.stop()
        self._work = self._finding = self._of = None

    def _begin(self, finding: "Future[_Found]") -> None:
        """Show the results so far, and let child processes find the rest."""
        try:
            found = finding.result()
            self._file, self._grid, self._journal, self._rows = found
            if found.journal is not None:
                numbers = [number for number in coarse_first(SIDE) if number not in found.rows]
                self._work = BackgroundSweep(found.grid, numbers, max(1, min(cores(), MOST_PROCESSES) - 1))
        except (SweepError, LevelError, OSError) as error:
            self.error = str(error)

    def _paint(self) -> None:
        self.layer = None
        grid = self._grid
        if self.measure is None or grid is None or self._of is None:
            return
        figure = self.measure if self.measure in grid.figures else grid.figures[0]
        axes, values = panel_values(grid, self._rows, _place_in(grid, self._of[1]))
        self.layer = SweepLayer(figure, axes[CS], axes[CD], values)


def _find(file: Path | None, level: Level, settings: WorldSettings, material: str | None) -> _Found:
    """The sweep in a file that was opened, else one that is kept, else one that is to be made."""
    level = _present(level, settings)
    if file is not None:
        with contextlib.suppress(SweepError, OSError, UnicodeDecodeError):
            grid, rows = read_table(file, level, (material,))
            _place_in(grid, settings)
            return _Found(file, grid, None, rows)
    values = tuple(float(f"{each:.9g}") for each in PLAIN.values(SIDE))
    grid = SweepGrid(level, {CS: values, CD: values}, round(SECONDS * level.settings.tick_rate), material)
    table = _kept_table(grid)
    with contextlib.suppress(SweepError, OSError, UnicodeDecodeError):
        found = read_table(table, level, (material,))
        os.utime(table)
        return _Found(None, found[0], None, found[1])
    journal = Journal(table, grid)
    return _Found(None, grid, journal, journal.rows)


def coarse_first(side: int) -> list[int]:
    """Numbers of the points of a square grid, in an order in which every part of it is soon known roughly."""
    steps = [4, 2, 1]
    rank: dict[int, int] = {}
    for step in steps:
        for number in range(side * side):
            if number // side % step == 0 and number % side % step == 0:
                rank.setdefault(number, len(rank))
    return list(rank)


def measures_of(level: Level) -> dict[str, str]:
    """The measures of a level's sweeps that a pad can show: names of figures by what a person reads."""
    figures = SweepGrid(level, {CS: (1.0,)}, 1).figures
    return {measure_of(figure).title.partition(" [")[0].capitalize(): figure for figure in figures}


def _present(level: Level, settings: WorldSettings) -> Level:
    """The level with the settings that a person may have changed."""
    now = {name: getattr(settings, name) for name in CHANGEABLE_SETTINGS}
    if all(getattr(level.settings, name) == value for name, value in now.items()):
        return level
    return with_settings(level, json.loads(json.dumps(now)), "the level with these settings")


def _place_in(grid: SweepGrid, settings: WorldSettings) -> dict[str, object]:
    """Which panel of a grid is of these settings. Raises SweepError."""
    now = {SOLVER: settings.solver, SUBSTEPS: settings.substeps}
    others = [name for name in grid.columns if name not in (CS, CD)]
    if not {CS, CD} <= set(grid.columns) or not set(others) <= set(now):
        raise SweepError("the pad shows sweeps over Cs and Cd, and solvers and substeps")
    for name in others:
        if now[name] not in grid.columns[name]:
            raise SweepError(f"the sweep has no runs with {name.removeprefix('settings.')} {now[name]}")
    return {name: now[name] for name in others}


def _kept_table(grid: SweepGrid) -> Path:
    """Where the table of a grid is kept in the user's cache, from which those go that were not used for longest."""
    folder = Path(platformdirs.user_cache_dir("spring-sandbox", appauthor=False)) / "sweeps"
    folder.mkdir(parents=True, exist_ok=True)
    kept = sorted(folder.glob("*.csv*"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in kept[KEPT:]:
        path.unlink(missing_ok=True)
    return folder / f"{grid.digest}.csv"


class PadMaps:
    """Keeps a pad at what is chosen; sweeps: outlives it when the panel is laid out again."""

    def __init__(self, ui: Ui, place: pygame.Rect, playback: Playback, sweeps: PadSweeps, container: Any) -> None:
        self._ui, self.sweeps = ui, sweeps
        self._figures: dict[str, str | None] = {THEORY: None}
        width = place.width - ui.px(MENU_EDGES)
        for name, figure in measures_of(playback.level).items():
            # Names of checks may be of any length; two that begin alike are told apart by their numbers.
            (shown,) = wrapped(name, ui.font(MENU_TEXT), width, 1)
            number = len(self._figures)
            self._figures[shown if shown not in self._figures else f"{number} {shown}"] = figure
        self.menu = WordPicker(ui, place, list(self._figures), self._chosen, self._choose, container)

    @property
    def _chosen(self) -> str:
        return next((name for name, figure in self._figures.items() if figure == self.sweeps.measure), THEORY)

    def _choose(self, name: str) -> None:
        self.sweeps.show(self._figures[name])

    @property
    def note(self) -> str:
        """How far the runs are."""
        known, runs = self.sweeps.progress
        if self.sweeps.error is not None:
            return self.sweeps.error
        return "" if known == runs else f"{known} of {runs} runs"

    def refresh(self, playback: Playback, material: int | None, pad: CoefficientPad) -> None:
        """Take up what is new, for the springs of a material (None = all) as a run has its settings now."""
        world = playback.session.world
        name = None if material is None else list(world.material_names)[material]
        self.sweeps.follow(playback.level, world.settings, name)
        self.sweeps.update()
        self.menu.show_chosen(self._chosen)
        showing = self.sweeps.measure is not None
        pad.show_layer(self.sweeps.layer if showing else None, self.note if showing else "")
