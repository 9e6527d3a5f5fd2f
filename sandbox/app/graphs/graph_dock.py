"""GraphDock: live graphs under the world: which are shown, their history, and what of them is kept in files."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.base.desktop import free_path, pictures_folder, plain_name, recordings_folder
from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import LINE, SURFACE
from sandbox.app.draw.picture import write_png
from sandbox.app.graphs.chart import Chart, GraphLine
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.level.format.writing import write_file
from sandbox.physics.analysis.applied_forces import motor_readings
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy, spring_lengths
from sandbox.physics.world import World

# The dock's share of the window's height, and the most of it; its bounds, and the row of buttons [layout units].
SHARE, MOST_SHARE = 0.30, 0.40
LOWEST, HIGHEST = 172.0, 270.0
ROW, GAP, EDGE, FILE_WIDTH, SPAN_WIDTH, TAB = 26.0, 6.0, 10.0, 46.0, 54.0, 70.0
ONE_WIDTH = 92.0
# Times [s] that can be seen at once.
SPANS = (10.0, 30.0, 60.0, 5.0)
# Particles that are followed at most.
MOST_PICKED = 4
# A picture that is kept is this many times as large.
PICTURE_SCALE = 2.0
SHOWN = "graphs"

# The runs that are measured, each with what stands before its names: one alone, nothing.
Runs = Sequence[tuple[str, Playback]]


class GraphDock:
    """The dock of a screen; runs: gives what is measured. While it is hidden nothing is measured or kept."""

    def __init__(self, app: Application, runs: Callable[[], Runs]) -> None:
        self._app, self._runs = app, runs
        kept = preference(SHOWN)
        self.is_shown = False
        self.shown = kept if kept in MEASURES else "energy"
        self.picked: list[int] = []
        self.span = SPANS[0]
        self._tracks: dict[str, Track] = {}
        self._of: tuple[object, ...] = ()
        self._before = -1
        self._place = self._back = pygame.Rect(0, 0, 1, 1)
        self._tabs: Choice | None = None
        self._one: Any = None

    def height(self, ui: Ui) -> float:
        """The room that it takes [layout units]."""
        tall = ui.units[1]
        return min(max(SHARE * tall, LOWEST), MOST_SHARE * tall, HIGHEST) if self.is_shown else 0.0

    # Building.

    def build(self, ui: Ui, width: float, bottom: float) -> None:
        """Lay it out again, width wide, above a lower edge [layout units]."""
        self._tabs, self._one, self._ui = None, None, ui
        if not self.is_shown:
            return
        height = self.height(ui)
        back = ui.panel(ui.rect(0, bottom - height, width, ROW + 2 * GAP))
        self._back = ui.rect(0, bottom - height, width, height)
        right = width - EDGE
        buttons = (
            ("×", ROW, lambda: self._app.act("graphs"), tip_of("graphs", "play")),
            ("PNG", FILE_WIDTH, self.save_picture, "Save the graph as a picture"),
            ("CSV", FILE_WIDTH, self.save_table, "Save the graph as a table"),
            (f"{self.span:g} s", SPAN_WIDTH, self._next_span, "Time span of the graph: 5, 10, 30 or 60 s"),
        )
        for text, wide, do, tip in buttons:
            right -= wide
            ui.button(ui.rect(right, GAP, wide, ROW), text, do, back, tip=tip, style="segment")
            right -= GAP
        options = [(name, measure.title, f"{measure.title} [{measure.unit}]") for name, measure in MEASURES.items()]
        if TAB * len(options) <= right - EDGE:
            self._tabs = ui.choice(ui.rect(EDGE, GAP, TAB * len(options), ROW), options, self.show, back)
            self._tabs.show(self.shown)
        else:
            # Where there is no room for all, one button asks.
            place = ui.rect(EDGE, GAP, min(ONE_WIDTH, right - EDGE), ROW)
            self._one = ui.button(place, MEASURES[self.shown].title, self._ask, back, tip="Another graph")
        top = bottom - height + ROW + 2 * GAP
        self._place = ui.rect(EDGE, top, width - 2 * EDGE, bottom - GAP - top)

    # Actions.

    def toggle(self) -> None:
        """Show the graphs, or hide them and forget what they had."""
        self.is_shown = not self.is_shown
        if not self.is_shown:
            self._tracks.clear()
        self._app.rebuild()

    def show(self, name: str) -> None:
        """Show a group of measures, one of MEASURES."""
        self.shown = name
        set_preference(SHOWN, name)
        if self._tabs is not None:
            self._tabs.show(name)
        elif self._one is not None:
            self._one.show_text(MEASURES[name].title)

    def _ask(self) -> None:
        """Ask which graph is shown."""
        choose(self._ui, "Graph", "", [(each.title, partial(self.show, name)) for name, each in MEASURES.items()])

    def pick(self, particle: int | None) -> None:
        """Follow a particle, or no longer; shows the graph of speeds where none of particles is seen."""
        if particle is None:
            self._app.say("Point at a particle first, or press N to move the cursor to one.", self._app.screen)
            return
        if particle in self.picked:
            self.picked.remove(particle)
        else:
            self.picked = [*self.picked, particle][-MOST_PICKED:]
        if self.shown not in ("speed", "place"):
            self.show("speed")
        for name in ("speed", "place"):
            self._tracks.pop(name, None)
        if not self.is_shown:
            self.toggle()

    def _next_span(self) -> None:
        self.span = SPANS[(SPANS.index(self.span) + 1) % len(SPANS)]
        self._app.rebuild()

    # A frame.

    def update(self, tick_time: float | None, frame_time: float | None) -> None:
        """Measure what the last ticks have come to; times [ms] of one of them, and of the frame before."""
        if not self.is_shown:
            return
        runs = self._runs()
        of = tuple(run.session for _, run in runs)
        if of != self._of:
            self._of, self._before = of, -1
            self._tracks.clear()
        tick = runs[0][1].session.tick
        went_on, self._before = tick > self._before, tick
        if not went_on:
            return
        for name, measure in MEASURES.items():
            track = self._tracks.setdefault(name, Track())
            track.forget_from(tick)
            values: dict[str, float] = {}
            for prefix, run in runs:
                read = measure.read(Moment(run.session.world, self.picked, tick_time, frame_time))
                kept = {key: value for key, value in read.items() if not prefix or key in (measure.main or read)}
                values |= {f"{prefix}{key}": value for key, value in kept.items()}
            track.add(tick, values)

    def _window(self) -> tuple[float, float]:
        """The time that is seen [s]."""
        session = self._runs()[0][1].session
        rate = session.world.settings.tick_rate
        last = max(self._tracks[self.shown].last_tick if self.shown in self._tracks else 0, 0) / rate
        end = max(last, self.span)
        if session.tick / rate < end - self.span:
            end = session.tick / rate + self.span / 2
        return end - self.span, end

    def lines(self) -> list[GraphLine]:
        """The lines that are seen."""
        track = self._tracks.get(self.shown)
        if track is None:
            return []
        rate = self._runs()[0][1].session.world.settings.tick_rate
        start, end = self._window()
        ticks, values = track.between(start * rate, end * rate)
        seconds = ticks / rate
        prefixes = [prefix for prefix, _ in self._runs()]
        if len(prefixes) == 1:
            return [GraphLine(name, seconds, values[name], number, number) for number, name in enumerate(values)]
        # What is the same of two runs has one colour, and the runs differ in dashes.
        found: list[GraphLine] = []
        tones: dict[str, int] = {}
        for name, each in values.items():
            style = next((number for number, prefix in enumerate(prefixes) if name.startswith(prefix)), 0)
            tone = tones.setdefault(name.removeprefix(prefixes[style]), len(tones))
            found.append(GraphLine(name, seconds, each, tone, style))
        return found

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the graphs, with the values at the mouse."""
        if not self.is_shown:
            return
        at = self._ui.pointer
        cursor = at[0] if self._place.collidepoint(at) and not self._ui.has_sheet else None
        pygame.draw.rect(surface, SURFACE, self._back)
        self._paint(surface, self._place, self._ui.scale, cursor)

    def _paint(self, surface: pygame.Surface, place: pygame.Rect, scale: float, cursor: float | None) -> None:
        measure, session = MEASURES[self.shown], self._runs()[0][1].session
        now = session.tick / session.world.settings.tick_rate
        is_past = self.shown in self._tracks and session.tick < self._tracks[self.shown].last_tick
        Chart(surface, place, scale).draw(
            self.lines(), self._window(), measure.unit, from_zero=measure.from_zero, cursor=cursor,
            now=now if is_past else None, hint=measure.hint,
        )  # fmt: skip

    # Files.

    def save_table(self) -> None:
        """Write the curves as a table, CSV."""
        lines, unit = self.lines(), MEASURES[self.shown].unit
        if not lines:
            self._app.say("There is nothing to save yet.", self._app.screen)
            return
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["tick", "time [s]", *(f"{line.name} [{unit}]" for line in lines)])
        rate = self._runs()[0][1].session.world.settings.tick_rate
        for row, seconds in enumerate(lines[0].seconds.tolist()):
            values = (float(line.values[row]) for line in lines)
            shown = ("" if not np.isfinite(value) else f"{value:.9g}" for value in values)
            writer.writerow([round(seconds * rate), f"{seconds:.6g}", *shown])
        self._keep(recordings_folder, ".csv", lambda path: write_file(path, text.getvalue().encode()))

    def save_picture(self) -> None:
        """Write the curves as a picture, PNG."""
        times = max(1.0, PICTURE_SCALE / self._ui.scale)
        size = round(self._place.width * times), round(self._place.height * times)
        picture = pygame.Surface(size, 0, 32)
        picture.fill(tuple(SURFACE))
        pygame.draw.rect(picture, LINE, picture.get_rect(), 1)
        inside = picture.get_rect().inflate(-16, -16)
        self._paint(picture, inside, self._ui.scale * times, None)
        self._keep(pictures_folder, ".png", lambda path: write_png(picture, path))

    def _keep(self, folder: Callable[[], Path], suffix: str, write: Callable[[Path], Any]) -> None:
        name = f"{plain_name(self._runs()[0][1].level.name)}-{self.shown}"
        try:
            path = free_path(folder(), name, suffix)
            write(path)
        except OSError as error:
            self._app.say(f"The file cannot be written: {error.strerror or error}.")
            return
        self._app.say(f"Saved as {path}")


# Of more motors those with the first names are shown.
MOST_MOTORS = 5


@dataclass(frozen=True)
class Moment:
    """The state to measure at the end of a frame: a world, the picked particles [slots], times [ms].

    tick_time: of one tick; frame_time: of the whole frame before; None where no tick was made.
    """

    world: World
    picked: Sequence[int] = ()
    tick_time: float | None = None
    frame_time: float | None = None


@dataclass(frozen=True)
class Measure:
    """A group of values of one unit: its title, a word of what to do while it is empty, and how they are read.

    main: those that are shown of each of two runs; none: all. from_zero: whether the scale begins at 0.
    """

    title: str
    unit: str
    read: Callable[[Moment], dict[str, float]]
    hint: str = ""
    main: tuple[str, ...] = ()
    from_zero: bool = False


def _energies(moment: Moment) -> dict[str, float]:
    world = moment.world
    motion, springs, gravity = kinetic_energy(world), spring_energy(world), gravity_energy(world)
    return {"total": motion + springs + gravity, "motion": motion, "springs": springs, "gravity": gravity}


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def _strains(moment: Moment) -> dict[str, float]:
    world = moment.world
    kept = world.spring_active & (world.rest_length > 0.0) & (world.material >= 0)
    strain = 100.0 * (spring_lengths(world)[kept] / world.rest_length[kept] - 1.0)
    if not len(strain):
        return {}
    return {"most stretched": float(strain.max()), "mean": float(strain.mean()), "most squeezed": float(strain.min())}


def _named(moment: Moment) -> list[tuple[str, int]]:
    """Names of the picked particles that still exist."""
    world = moment.world
    slots = [slot for slot in moment.picked if slot < world.particle_count and world.particle_active[slot]]
    return [(world.particle_names[slot], slot) for slot in slots]


@np.errstate(over="ignore", invalid="ignore")
def _speeds(moment: Moment) -> dict[str, float]:
    velocity = moment.world.velocity
    return {name: float(np.hypot(*velocity[slot])) for name, slot in _named(moment)}


def _places(moment: Moment) -> dict[str, float]:
    position = moment.world.position
    return {
        f"{name} {axis}": float(position[slot, k]) for name, slot in _named(moment) for k, axis in ((1, "y"), (0, "x"))
    }


def _torques(moment: Moment) -> dict[str, float]:
    readings = [reading for reading in motor_readings(moment.world) if reading.pushes]
    return {reading.name: reading.torque for reading in readings[:MOST_MOTORS]}


def _times(moment: Moment) -> dict[str, float]:
    found = {"one tick": moment.tick_time, "whole frame": moment.frame_time}
    return {name: value for name, value in found.items() if value is not None}


PICK = "Point at a particle and press O to follow it (four at most); press O again to stop."
MEASURES: dict[str, Measure] = {
    "energy": Measure("Energy", "J", _energies, "", ("total", "motion")),
    "strain": Measure("Strain", "%", _strains, "There is no spring here.", ("most stretched",)),
    "speed": Measure("Speed", "m/s", _speeds, PICK, from_zero=True),
    "place": Measure("Place", "m", _places, PICK),
    "torque": Measure("Torque", "N m", _torques, "This level has no motor that is running."),
    "time": Measure("Step time", "ms", _times, "The run has not started yet.", from_zero=True),
}  # fmt: skip


# Samples that are kept at least: two minutes of frames. Twice as many fit, so that few of them are ever moved.
KEPT = 7200
# Values side by side; more names than this, those that came first are forgotten.
MOST_NAMES = 12

Floats = NDArray[np.float64]


class Track:
    """Values by name at ticks that rise; where a name has none it is NaN."""

    def __init__(self, kept: int = KEPT) -> None:
        self._kept, self._count = kept, 0
        self._ticks = np.zeros(2 * kept, dtype=np.int64)
        self._values: dict[str, Floats] = {}

    @property
    def last_tick(self) -> int:
        """The last tick that there is a value of; -1: none."""
        return int(self._ticks[self._count - 1]) if self._count else -1

    def forget_from(self, tick: int) -> None:
        """Forget a tick and what follows: the run was changed there."""
        self._count = int(np.searchsorted(self._ticks[: self._count], tick))

    def add(self, tick: int, values: Mapping[str, float]) -> None:
        """Add the values of a tick after all others."""
        if self._count == 2 * self._kept:
            for array in (self._ticks, *self._values.values()):
                array[: self._kept] = array[self._kept :]
            self._count = self._kept
        for name in values:
            if name not in self._values:
                self._values[name] = np.full(2 * self._kept, np.nan)
        while len(self._values) > MOST_NAMES:
            del self._values[next(iter(self._values))]
        self._ticks[self._count] = tick
        for name, array in self._values.items():
            array[self._count] = values.get(name, np.nan)
        self._count += 1

    def between(self, first: float, last: float) -> tuple[NDArray[np.int64], dict[str, Floats]]:
        """Ticks (k,) from first to last, and the values (k,) of each name that has some there."""
        start, end = np.searchsorted(self._ticks[: self._count], (first, last + 1e-9))
        part = slice(int(start), int(end))
        values = {name: array[part] for name, array in self._values.items() if np.isfinite(array[part]).any()}
        return self._ticks[part], values
