"""A page of HTML that plays one run, or two side by side, all by itself: one file, no network."""

import base64
import html
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.export.policy import policy
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.level.format.look import PALETTE
from sandbox.level.format.writing import write_file
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.constraints import AREA
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.compare.comparison import Comparison
from sandbox.session.compare.divergence import Divergence, differing_particle
from sandbox.session.event_log import TouchWatch, event_log_of, shortened
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session

TEMPLATE = Path(__file__).with_name("player.html")


# What the positions of all pictures of a page may take [bytes]: fewer pictures are kept of what is longer.
MOST_BYTES = 6_000_000
# Places in a picture, from one edge of what is shown to the other; twice as much lies around it.
STEPS = 20_000
# The last number stands for a particle that is nowhere.
NOWHERE = 65_535
# Around a level that does not say what its camera shows, as a part of its size.
MARGIN = 0.25

State = World | Snapshot


class PlaybackData:
    """Gathers the pictures of one side of a page; the page reads `data`.

    box [m]: the shown part of the world. name: of the side.
    """

    def __init__(self, name: str, level: Level, box: NDArray[np.float64]) -> None:
        self.ticks: list[int] = []
        self._name, self._level, self._box = name, level, box
        self._frames: list[bytes] = []
        self._forms: list[dict[str, Any]] = []
        self._form_key: tuple[bytes, ...] = ()
        self._terrain: list[Any] = []

    def add(self, state: State) -> None:
        """Add a picture."""
        particles, springs = shown_particles(state), shown_springs(state)
        areas = state.constraint_active & (state.constraint_kind == AREA)
        key = (particles.tobytes(), springs.tobytes(), areas.tobytes(), (state.inverse_mass == 0.0).tobytes())
        if key != self._form_key:
            self._form_key = key
            self._forms.append({"from": len(self.ticks), **self._form(state, particles, springs, areas)})
        if not self.ticks:
            self._terrain = _terrain(state)
        self.ticks.append(state.tick)
        self._frames.append(self._places(state.position).tobytes())

    def data(self) -> dict[str, Any]:
        """The side, ready for JSON."""
        frames = base64.b64encode(b"".join(self._frames)).decode()
        sizes = [len(frame) // 4 for frame in self._frames]
        return {"name": self._name, "forms": self._forms, "sizes": sizes, "frames": frames, "terrain": self._terrain}

    def _places(self, position: NDArray[np.float64]) -> NDArray[np.uint16]:
        """Positions as whole numbers of steps, from a box three times as wide and high as what is shown."""
        left, bottom, right, top = self._box.tolist()
        span = max(right - left, top - bottom)
        with np.errstate(over="ignore", invalid="ignore"):
            places = np.round((position - (left - span, bottom - span)) * (STEPS / span))
            gone = ~(np.isfinite(places) & (places >= 0) & (places < NOWHERE)).all(axis=1)
        places[gone] = NOWHERE
        return places.astype("<u2")

    def _form(
        self, state: State, particles: NDArray[np.bool_], springs: NDArray[np.bool_], areas: NDArray[np.bool_]
    ) -> dict[str, Any]:
        """The shapes that are drawn until something joins, parts or is pinned: discs, lines and faces, with colours."""
        owners = self._owners(len(state.mass))
        slots, lines = np.flatnonzero(particles), np.flatnonzero(springs)
        first, count = state.constraint_first, state.constraint_corners
        faces = [state.corner_particle[first[k] : first[k] + count[k]].tolist() for k in np.flatnonzero(areas)]
        ends = np.stack([state.particle_a[lines], state.particle_b[lines]], axis=1)
        held = state.inverse_mass[slots] == 0.0
        bare = ~np.isin(slots, ends)
        return {
            "discs": [[int(slot), round(float(state.radius[slot]), 5), int(owners[slot]), int(pinned), int(alone)]
                      for slot, pinned, alone in zip(slots, held, bare, strict=True) if pinned or alone],
            "lines": [[int(a), int(b), int(owners[a])] for a, b in ends],
            "faces": [[int(owners[corners[0]]), *corners] for corners in faces],
        }  # fmt: skip

    def _owners(self, count: int) -> NDArray[np.int64]:
        """The number of a colour for every particle: bodies and loose particles have them in turn."""
        from sandbox.level.plan.plan import Plan, kept_plan

        layout = (kept_plan(self._level) or Plan(self._level)).layout
        owners = np.arange(count, dtype=np.int64) + len(layout.owners)
        for number, owner in enumerate(layout.owners.values()):
            owners[owner.first : owner.first + owner.size] = number
        return owners % len(PALETTE)


@dataclass(frozen=True)
class EventLine:
    """An event of a tick, in a line; side: the run in which alone it happened, None: in each."""

    tick: int
    text: str
    side: int | None = None


@dataclass(frozen=True)
class PlayerPage:
    """The content of a page. box [m]; rate: ticks a second; marks: ticks with a word to each; difference: the first
    tick that differs, and the particle; lines: the text about it; happened: what happened when, each goes to its tick.
    """

    title: str
    box: NDArray[np.float64]
    rate: int
    sides: Sequence[PlaybackData]
    marks: Sequence[tuple[int, str]] = ()
    difference: tuple[int, int | None] | None = None
    lines: Sequence[str] = field(default=())
    happened: Sequence[EventLine] = field(default=())

    def text(self) -> str:
        """The page. Both sides have the ticks that both have."""
        ticks = [tick for tick in self.sides[0].ticks if all(tick in set(side.ticks) for side in self.sides)]
        data: dict[str, Any] = {
            "rate": self.rate,
            "box": [float(value) for value in self.box],
            "steps": STEPS,
            "ticks": ticks,
            "sides": [{**side.data(), "at": _places(side.ticks, ticks)} for side in self.sides],
            "marks": [[tick, words] for tick, words in self.marks],
            "first": None if self.difference is None else self.difference[0],
            "ring": None if self.difference is None else self.difference[1],
            "lines": list(self.lines),
            "happened": [[line.tick, line.text, line.side] for line in self.happened],
            "colours": [f"#{colour:06x}" for colour in PALETTE.values()],
        }
        # "<" could end the script that holds the data.
        packed = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        text = TEMPLATE.read_text(encoding="utf-8")
        text = text.replace("@POLICY@", policy(text, img="data:"))
        before, after = text.replace("@TITLE@", html.escape(self.title)).rsplit("@DATA@", 1)
        return before + packed + after

    def write(self, path: Path) -> None:
        """Write the page, whole or not at all. Raises OSError."""
        try:
            write_file(path, self.text().encode())
        except OSError as error:
            raise OSError(error.errno or 0, error.strerror or str(error), str(path)) from None


def _places(ticks: Sequence[int], chosen: Sequence[int]) -> list[int]:
    places = {tick: place for place, tick in enumerate(ticks)}
    return [places[tick] for tick in chosen]


def shown_box(level: Level, state: State) -> NDArray[np.float64]:
    """The part of a level that a page shows [m]: its view, or all of it with some room around."""
    if level.view is not None:
        return np.array(level.view, dtype=np.float64)
    points = np.concatenate([state.position[shown_particles(state)], state.terrain.vertex, np.zeros((0, 2))])
    if not len(points):
        points = np.array([[-1.0, -1.0], [1.0, 1.0]])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = MARGIN * max(1.0, float((high - low).max()))
    return np.concatenate([low - margin, high + margin])


def steps_between(ticks: int, particles: int, sides: int) -> int:
    """How many ticks lie between two pictures, so that a page does not get too large."""
    return max(1, -(-ticks * particles * sides * 4 // MOST_BYTES))


def states_of(run: Session, first: int, last: int) -> Iterator[LevelWorld]:
    """States of a run at every tick of first..last, those before its present tick told again; it is advanced.

    The world itself is given, where it has to be looked at before the next. Ends early where a command fails.
    """
    present = run.tick
    beginning = max(first, run.keyframes(0, present)[0].tick)
    past = run.retold(beginning)
    for tick in range(beginning, last + 1):
        current = past if tick < present else run
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                while current.tick < tick:
                    current.advance()
        except CommandError:
            return
        yield current.world


def gathered(side: PlaybackData, states: Iterable[State], step: int, also: int | None = None) -> PlaybackData:
    """The side with every step-th tick of these states, and with one more tick that must not be missed."""
    for state in states:
        if state.tick % step == 0 or state.tick == also:
            side.add(state)
    return side


def _terrain(state: State) -> list[Any]:
    """Edges of the terrain, and of what is solid the corners: [solid, x, y, x, y, ...]."""
    terrain = state.terrain
    pieces = []
    for number in np.unique(terrain.chain):
        edges = np.flatnonzero(terrain.chain == number)
        corners = [*terrain.edge_a[edges].tolist(), int(terrain.edge_b[edges[-1]])]
        places = [round(value, 4) for corner in corners for value in terrain.vertex[corner].tolist()]
        pieces.append([int(terrain.solid[edges[0]]), *places])
    return pieces


# What looks on while states are gathered: gives on what it is given.
Watched = Callable[[Iterable[LevelWorld]], Iterable[LevelWorld]]
Played = tuple[NDArray[np.float64], int, list[PlaybackData]]


def played(
    names: Sequence[str],
    runs: Sequence[Session],
    ticks: int,
    also: int | None = None,
    watched: Watched = iter,
    watches: Sequence[TouchWatch] = (),
) -> Played:
    """The box, the tick rate and the sides of runs that have not begun, or are where they part; they are advanced.

    also: a tick that is not left out. watches: one for each run, that is told of its ticks.
    """
    level = runs[0].level
    box = shown_box(level, runs[0].keyframes(0, runs[0].tick)[0])
    step = steps_between(ticks, runs[0].world.particle_count, len(runs))
    states = [states_of(run, 0, ticks) for run in runs]
    if watches:
        states = [watch.following(each) for watch, each in zip(watches, states, strict=True)]
    sides = [
        gathered(PlaybackData(name, run.level, box), watched(each), step, also)
        for name, run, each in zip(names, runs, states, strict=True)
    ]
    return box, level.settings.tick_rate, sides


def first_difference_shown(divergence: Divergence | None, run: Session) -> tuple[int, int | None] | None:
    """The tick that a page goes to, and the particle that it rings there."""
    return None if divergence is None else (divergence.tick, differing_particle(divergence, run.snapshot()))


def command_marks(replay: Replay | None) -> list[tuple[int, str]]:
    """The first command of each gesture."""
    gestures: dict[int, tuple[int, str]] = {}
    for line in replay.script if replay else ():
        gestures.setdefault(line.gesture, (line.tick, str(line.record.get("type"))))
    return list(gestures.values())


def watches_of(runs: Sequence[Session]) -> list[TouchWatch]:
    """A watch of touches for each run."""
    return [TouchWatch(run.level.zones) for run in runs]


def event_lines(runs: Sequence[Session], watches: Sequence[TouchWatch]) -> list[EventLine]:
    """The events of a run, or of two: one in the same tick of both is said once, all others of their side."""
    rate = runs[0].level.settings.tick_rate
    sides = []
    for run, watch in zip(runs, watches, strict=True):
        found, dropped = shortened(event_log_of(run, watch))
        sides.append([(each.tick, each.line(rate).strip()) for each in found])
        if dropped:
            sides[-1].append((run.tick, f"{dropped} more lines of who touched whom: `sandbox info --all` lists them"))
    common = set.intersection(*map(set, sides))
    lines = {line: EventLine(*line, None if line in common else side) for side, of in enumerate(sides) for line in of}
    return sorted(lines.values(), key=lambda line: line.tick)


def report_page(found: Comparison, watched: Watched = iter) -> PlayerPage:
    """The page of a divergence; the run that diverged is advanced to its end."""
    replay, tick = found.replay, found.telling_tick
    runs, names = [Session(replay.level, script=replay.script), found.actual], ["expected", "actual"]
    first = first_difference_shown(found.divergence, found.actual)
    if found.telling_slots is not None:
        first = tick, found.telling_slots[1]
    if found.expected is None:
        names[0] = "as this version steps it; the recorded states are not known"
    watches = watches_of(runs)
    return PlayerPage(
        f"{replay.source}: diverged at tick {found.divergence.tick}",
        *played(names, runs, replay.ticks, tick, watched, watches), marks=command_marks(replay), difference=first,
        lines=found.lines(), happened=event_lines(runs, watches),
    )  # fmt: skip
