"""Preview: a level that plays in its card while somebody points at it."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.base.loop import TickClock
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.picture import crop_of
from sandbox.app.draw.picture_cache import LINE_SCALE, PARTICLES, SECONDS, SIZE
from sandbox.app.draw.renderer import Renderer
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import read_level
from sandbox.session.session import Session

# It begins after the mouse has rested on a card for so long [s]; then it starts over every so often [s].
REST, LOOP = 0.15, 8.0
# Wall time [s] of a frame that its ticks may take; where they would take more, it plays slower than it is.
BUDGET = 0.012


class Preview:
    """Plays the level of a file into a picture of size [pixels].

    It begins where the still picture ends, so that this seems to come alive.
    """

    def __init__(self, path: Path, size: tuple[int, int]) -> None:
        self._path, self._size = path, size
        self._clock = TickClock()
        self._rested = self._played = 0.0
        self._steps = self._prepare()
        self._session: Session | None = None
        self._has_ended = False
        self.picture: pygame.Surface | None = None

    @property
    def moves(self) -> bool:
        """Whether it plays, or is about to: not where the level cannot be played in a card."""
        return not self._has_ended

    def update(self, frame_time: float) -> bool:
        """Let frame_time [s] pass; True where there is another picture."""
        self._rested += frame_time
        if self._rested < REST:
            return False
        end = time.perf_counter() + BUDGET
        while self._session is None:
            went_on = next(self._steps, None)
            self._has_ended = went_on is None and self._session is None
            if not went_on or time.perf_counter() > end:
                return False
        self._advance(self._session, frame_time)
        return True

    def _prepare(self) -> Iterator[bool]:
        try:
            level = read_level(self._path)
        except LevelError:
            return
        yield True
        session = Session(level)
        if len(session.world.mass) > PARTICLES:
            return
        for _ in range(round(SECONDS * level.settings.tick_rate)):
            yield True
            _tick(session)
        self._camera = Camera(viewport=(0, 0, *self._size))
        self._camera.fit(crop_of(level, session.snapshot()))
        self._renderer = Renderer(LINE_SCALE * self._size[0] / SIZE[0], level)
        self._previous = self._current = session.snapshot()
        self._session = session

    def _advance(self, session: Session, frame_time: float) -> None:
        rate = session.world.settings.tick_rate
        end = time.perf_counter() + BUDGET
        for _ in range(self._clock.ticks(frame_time, rate)):
            _tick(session)
            self._previous, self._current = self._current, session.snapshot()
            if time.perf_counter() > end:
                break
        # A new surface each time: the card may still show the last one.
        self.picture = pygame.Surface(self._size, 0, 32)
        self._renderer.draw(self.picture, self._camera, self._previous, self._current, self._clock.alpha(rate))
        self._played += frame_time
        if self._played > LOOP:
            self._played, self._session, self._steps = 0.0, None, self._prepare()


def _tick(session: Session) -> None:
    with np.errstate(over="ignore", invalid="ignore"):
        session.advance()
