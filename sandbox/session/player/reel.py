"""Reel: the pictures of a run as data, which a page can play by itself."""

import base64
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.level.format.look import PALETTE
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.constraints import AREA
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.session import Session

# What the positions of all pictures of a page may take [bytes]: fewer pictures are kept of what is longer.
MOST_BYTES = 6_000_000
# Places in a picture, from one edge of what is shown to the other; twice as much lies around it.
STEPS = 20_000
# The last number stands for a particle that is nowhere.
NOWHERE = 65_535
# Around a level that does not say what its camera shows, as a part of its size.
MARGIN = 0.25

State = World | Snapshot


class Reel:
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
        """What is drawn while nothing joins, parts or is pinned: discs, lines and faces, each with a colour."""
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


def shown_box(level: Level, state: State) -> NDArray[np.float64]:
    """The part of a level that a page shows [m]: its view, or all of it with some room around."""
    if level.view is not None:
        return np.array(level.view, dtype=np.float64)
    points = np.concatenate([state.position[shown_particles(state)], state.terrain.vertex, np.zeros((0, 2))])
    if not len(points):
        points = np.array([[-1.0, -1.0], [1.0, 1.0]])
    low, high = points.min(axis=0), points.max(axis=0)
    room = MARGIN * max(1.0, float((high - low).max()))
    return np.concatenate([low - room, high + room])


def steps_between(ticks: int, particles: int, sides: int) -> int:
    """How many ticks lie between two pictures, so that a page does not get too large."""
    return max(1, -(-ticks * particles * sides * 4 // MOST_BYTES))


def told_states(run: Session, first: int, last: int) -> Iterator[LevelWorld]:
    """States of a run at every tick of first..last, those before its present tick told again; it is advanced.

    The world itself is given, where it has to be looked at before the next. Ends early where a command fails.
    """
    present = run.tick
    beginning = max(first, run.keyframes(0, present)[0].tick)
    past = run.retold(beginning)
    for tick in range(beginning, last + 1):
        told = past if tick < present else run
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                while told.tick < tick:
                    told.advance()
        except CommandError:
            return
        yield told.world


def gathered(reel: Reel, states: Iterable[State], step: int, also: int | None = None) -> Reel:
    """A reel with every so manieth tick of these states, and with one more tick that must not be missed."""
    for state in states:
        if state.tick % step == 0 or state.tick == also:
            reel.add(state)
    return reel


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
