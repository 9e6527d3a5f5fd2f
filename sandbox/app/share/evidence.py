"""Evidence: two runs where they part, as one picture over the other, and as a short GIF around that tick."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.picture import view_of, write_png
from sandbox.app.draw.renderer import Renderer
from sandbox.app.film.kinds import require
from sandbox.app.widgets.fonts import plain_font
from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot, take
from sandbox.session.compare.comparison import Comparison
from sandbox.session.compare.distance import metres, recorded_world
from sandbox.session.compare.divergence import differing_particle, number_text
from sandbox.session.player.page import states_of
from sandbox.session.session import Session

# Of one side of a picture, and of a GIF [pixels]; of the line of words over each.
PICTURE_SIZE, GIF_SIZE, CAPTION = (960, 480), (480, 240), 26
# What the GIF shows before and after the tick [s], and how many pictures a second.
AROUND, FPS = 0.75, 20.0
PAPER, INK, MARK = (24, 26, 32), (236, 238, 242), (255, 92, 92)
# Around what differs first [pixels]; it is drawn no farther out of the picture than this, or it would not be.
RING, FARTHEST = 14, 4_000


@dataclass(frozen=True)
class Shown:
    """A state of a level under a line of words; particle: the slot that a ring is drawn around, None: no ring."""

    words: str
    level: Level
    state: Snapshot
    particle: int | None = None


class _Row:
    """Draws one side, picture after picture."""

    def __init__(self, level: Level, box: Box, size: tuple[int, int]) -> None:
        self._camera = Camera(viewport=(0, 0, *size))
        self._camera.fit(box)
        self._renderer = Renderer(max(0.6, size[0] / 1280), level)
        self._surface = pygame.Surface(size, 0, 32)

    def draw(self, shown: Shown) -> pygame.Surface:
        state, surface = shown.state, self._surface
        self._renderer.draw(surface, self._camera, state, state, 1.0)
        if shown.particle is not None and shown.particle < len(state.position):
            at = self._camera.project(state.position[shown.particle][None])[0]
            if np.isfinite(at).all() and np.abs(at).max() < FARTHEST:
                pygame.draw.aacircle(surface, MARK, at.tolist(), RING, 3)
        return surface


class Stack:
    """Draws several states of the same place one under the other, each under its words; size: of each."""

    def __init__(self, first: Sequence[Shown], size: tuple[int, int]) -> None:
        pygame.font.init()
        views = np.array([view_of(each.level, each.state) for each in first])
        low, high = views[:, :2].min(axis=0).tolist(), views[:, 2:].max(axis=0).tolist()
        self._rows = [_Row(each.level, (low[0], low[1], high[0], high[1]), size) for each in first]
        self._size, self._font = size, plain_font(max(11, size[0] // 60), True)

    def draw(self, shown: Sequence[Shown]) -> pygame.Surface:
        """One picture of all tiles of the stack, a new surface."""
        width, height = self._size
        picture = pygame.Surface((width, (height + CAPTION) * len(shown)), 0, 32)
        picture.fill(PAPER)
        for number, (row, each) in enumerate(zip(self._rows, shown, strict=True)):
            top = number * (height + CAPTION)
            text = self._font.render(each.words, True, INK)
            picture.blit(text, (8, top + (CAPTION - text.get_height()) // 2))
            picture.blit(row.draw(each), (0, top + CAPTION))
        return picture


def write_picture(comparison: Comparison, path: Path) -> None:
    """Expected over actual at the tick of a divergence, into a PNG; of what is not known the stored states around it.

    Raises OSError.
    """
    sides = _sides(comparison)
    write_png(Stack(sides, PICTURE_SIZE).draw(sides), path)


def write_sides(sides: Sequence[Shown], path: Path) -> None:
    """Write states of several runs, one over the other, into a PNG. Raises OSError."""
    write_png(Stack(sides, PICTURE_SIZE).draw(sides), path)


def write_motion(comparison: Comparison, path: Path) -> None:
    """Write both runs around that tick into a GIF; both are advanced. Raises OSError, and Missing without Pillow."""
    require("gif")
    from sandbox.app.share.gif import GifWriter

    pictures = list(_pictures(comparison))
    with path.open("wb") as file:
        writer = GifWriter(file, pictures[0].get_size(), FPS, pictures[:: max(1, len(pictures) // 8)], len(pictures))
        for picture in pictures:
            writer.add(picture)
        writer.close()


def _sides(comparison: Comparison) -> list[Shown]:
    found, actual = comparison.divergence, comparison.actual
    if comparison.telling_slots is not None:
        return _farthest(comparison, comparison.telling_slots)
    now = _state_at(actual, found.tick)
    ring = differing_particle(found, now)
    expected = comparison.expected
    if expected is None:
        got = Shown(f"actual  tick {found.tick}, where {found.array} differs", actual.level, now, ring)
        return [*_stored(comparison, comparison.before, ring), got, *_stored(comparison, comparison.after, ring)]
    words = f"tick {found.tick}: {found.array}{found.place}" + (f" of {found.name}" if found.name else "")
    before = _state_at(expected, found.tick)
    return [
        Shown(f"expected  {words} = {number_text(found.expected)}", expected.level, before, ring),
        Shown(f"actual    {words} = {number_text(found.actual)}", actual.level, now, ring),
    ]


def _state_at(run: Session, tick: int) -> Snapshot:
    """The state of a run at a tick that it has reached, or the last before it."""
    state = run.snapshot()
    for world in states_of(run, tick, tick):
        state = take(world)
    return state


def _farthest(comparison: Comparison, slots: tuple[int, int]) -> list[Shown]:
    """Both runs at the tick at which a particle is farthest away."""
    tick, distance = comparison.telling_tick, comparison.distance
    assert distance is not None
    words = f"tick {tick}: {distance.particle}, {metres(distance.farthest)} apart"
    before = None
    if comparison.expected is not None:
        before = _state_at(comparison.expected, tick)
    elif (world := recorded_world(comparison.replay, tick)) is not None:
        before = take(world)
    now = _state_at(comparison.actual, tick)
    first = [] if before is None else [Shown(f"expected  {words}", comparison.replay.level, before, slots[0])]
    return [*first, Shown(f"actual    {words}", comparison.actual.level, now, slots[1])]


def _stored(comparison: Comparison, tick: int | None, ring: int | None) -> list[Shown]:
    """The stored state of a tick, where there is one that can be read."""
    if tick is None:
        return []
    replay = comparison.replay
    stored = replay.states[tick]
    try:
        # As it stands in the file, also where its hash belies it.
        state = stored.of(replay.level, tick)
    except ValueError:
        return []
    side = "before" if tick < comparison.divergence.tick else "after"
    return [Shown(f"recorded  the stored state {side}, tick {tick}", replay.level, state, ring)]


def _pictures(comparison: Comparison) -> Iterator[pygame.Surface]:
    """Pictures of both runs, or of the actual one alone, around the tick that tells most."""
    rate = comparison.actual.world.settings.tick_rate
    step, tick = max(1, round(rate / FPS)), comparison.telling_tick
    first, last = max(0, tick - round(AROUND * rate)), min(comparison.replay.ticks, tick + round(AROUND * rate))
    runs = [("expected", comparison.expected)] if comparison.expected else []
    runs.append(("actual", comparison.actual))
    states = [(side, run.level, dict(_states(run, first, last, step))) for side, run in runs if run is not None]
    ticks = [number for number in states[-1][2] if all(number in each for _, _, each in states)]
    stack: Stack | None = None
    for number in ticks:
        rings = _rings(comparison, states[-1][2][number]) if number >= tick else (None, None)
        shown = [
            Shown(f"{side}  tick {number}", level, each[number], ring)
            for (side, level, each), ring in zip(states, rings[-len(states) :], strict=True)
        ]
        stack = stack or Stack(shown, GIF_SIZE)
        yield stack.draw(shown)


def _rings(comparison: Comparison, state: Snapshot) -> tuple[int | None, int | None]:
    """The particles that rings are drawn around in both runs."""
    if comparison.telling_slots is not None:
        return comparison.telling_slots
    ring = differing_particle(comparison.divergence, state)
    return ring, ring


def _states(run: Session, first: int, last: int, step: int) -> Iterator[tuple[int, Snapshot]]:
    """States of a run every this many ticks, those before its present tick told again."""
    present = run.tick
    for world in states_of(run, first, last):
        if (world.tick - first) % step == 0 or world.tick == present:
            yield world.tick, take(world)
