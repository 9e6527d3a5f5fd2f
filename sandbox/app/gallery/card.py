"""Card: one thing that the gallery opens: its picture, or the level as it plays; its name, and all of its text."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pygame

from sandbox.app.base.loop import TickClock
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import ACCENT, BACKGROUND, DANGER, LINE, MUTED, SURFACE, TEXT, Colour
from sandbox.app.draw.picture import crop_of
from sandbox.app.draw.picture_cache import LINE_SCALE, PARTICLES, SECONDS, SIZE
from sandbox.app.draw.renderer import Renderer
from sandbox.app.widgets.button import painted_stars
from sandbox.app.widgets.styles import put_rim
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pressable
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import read_level
from sandbox.session.session import Session

# Sizes in layout units.
PICTURE_RATIO = 9 / 16
TEXT_HEIGHT = 70.0
CORNER = 10.0
PADDING = 13.0
NAME_SIZE, LINE_SIZE = 14.0, 11.5
NAME_HEIGHT, LINE_HEIGHT = 23.0, 16.0
STAR_SIZE = 14.0
# Lines below the name while nobody points at it, and at most.
SHORT_LINES, MOST_LINES = 2, 14


class Card(Pressable):
    """One thing to open; line: what to do with it, text: all that is said of it, tags: what else it is found by.

    is_small: a row with the picture at its left and the name beside it. badge: a word over the picture. won: the stars
    and the time of the best run, over it too. solved: what is said of its solution.
    """

    is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, name: str, text: str, action: Callable[[], object], container: Any,
        *, is_small: bool = False,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.name, self.text, self.action, self.is_small = name, text, action, is_small
        self.line = self.badge = self.solved = ""
        self.won: tuple[int, str] | None = None
        self.tags: tuple[str, ...] = ()
        self.picture: pygame.Surface | None = None
        self.broken = False

    @property
    def picture_size(self) -> tuple[int, int]:
        """Size of the place for a picture [pixels]."""
        width, height = self.rect.size
        if self.is_small:
            return round((height - 2) / PICTURE_RATIO), height - 2
        return width - 2, height - self.ui.px(TEXT_HEIGHT) - 1

    def show_picture(self, picture: pygame.Surface) -> None:
        """Show a picture of the size that there is for it."""
        self.picture = picture
        self.repaint()

    def show_texts(self, name: str, text: str, tags: tuple[str, ...]) -> None:
        """Show another name and text."""
        self.name, self.text, self.tags = name, text, tags
        self.repaint()

    def show_won(self, stars: int, time: str) -> None:
        """Show how well the level was won."""
        self.won = stars, time
        self.repaint()

    def show_fault(self, fault: str) -> None:
        """Show why the file cannot be opened."""
        self.line, self.text, self.broken = "", fault, True
        self.repaint()

    @property
    def is_pointed_at(self) -> bool:
        """Whether the mouse is over the card, or the keyboard works on it."""
        return self.hovered or self.focused

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The card's picture."""
        return self._painted(size, self._lines(size[0], self.is_small))

    def paint_open(self) -> pygame.Surface:
        """The card with all of its text, as high as that is."""
        width, height = self.rect.size
        lines = self._all_lines(width)
        needed = self.picture_size[1] + self.ui.px(NAME_HEIGHT + 20) + len(lines) * self.ui.px(LINE_HEIGHT)
        return self._painted((width, max(height, needed)), lines)

    def _painted(self, size: tuple[int, int], lines: list[tuple[str, Colour]]) -> pygame.Surface:
        ui, corner = self.ui, self.ui.px(CORNER)
        card = pygame.Surface(size, pygame.SRCALPHA)
        pygame.draw.rect(card, SURFACE, card.get_rect(), border_radius=corner)
        if self.is_small:
            self._paint_row(card)
        else:
            self._paint_whole(card, lines)
        rim, width = (ACCENT, 2.0) if self.is_pointed_at else (LINE, 1.2)
        put_rim(card, rim, max(1, ui.px(width)), corner)
        return card

    def _paint_row(self, card: pygame.Surface) -> None:
        ui, (width, height) = self.ui, self.picture_size
        self._paint_picture(card, pygame.Rect(1, 1, width, height))
        font, left = ui.font(13, True), width + ui.px(PADDING)
        lines = wrapped(self.name, font, card.get_width() - left - ui.px(8), 2)
        y = (card.get_height() - len(lines) * font.get_linesize()) // 2
        for line in lines:
            card.blit(font.render(line, True, TEXT), (left, y))
            y += font.get_linesize()

    def _paint_whole(self, card: pygame.Surface, lines: list[tuple[str, Colour]]) -> None:
        ui, width = self.ui, card.get_width()
        picture = pygame.Rect(1, 1, *self.picture_size)
        self._paint_picture(card, picture)
        top = picture.bottom
        if self.badge:
            self._paint_badge(card)
        if self.won is not None:
            self._paint_won(card, picture, *self.won)
        pygame.draw.line(card, LINE, (1, top), (width - 2, top))
        y, left = top + ui.px(8), ui.px(PADDING)
        bold, plain = ui.font(NAME_SIZE, True), ui.font(LINE_SIZE)
        card.blit(bold.render(wrapped(self.name, bold, width - 2 * left, 1)[0], True, TEXT), (left, y))
        y += ui.px(NAME_HEIGHT)
        for text, colour in lines:
            card.blit(plain.render(text, True, colour), (left, y))
            y += ui.px(LINE_HEIGHT)

    def _lines(self, width: int, is_row: bool) -> list[tuple[str, Colour]]:
        """The lines below the name, with their colours."""
        inside = width - 2 * self.ui.px(PADDING)
        colour = DANGER if self.broken else MUTED
        lines = wrapped(self.line or self.text, self.ui.font(LINE_SIZE), inside, 1 if is_row else SHORT_LINES)
        return [(line, colour) for line in lines]

    def _all_lines(self, width: int) -> list[tuple[str, Colour]]:
        """All lines below the name, for a card with room for them."""
        inside, font = width - 2 * self.ui.px(PADDING), self.ui.font(LINE_SIZE)
        texts = (
            (self.line, TEXT), (self.text, DANGER if self.broken else MUTED), (self.solved, TEXT),
            (", ".join(self.tags), ACCENT),
        )  # fmt: skip
        return [(line, colour) for text, colour in texts if text for line in wrapped(text, font, inside, MOST_LINES)]

    def _paint_picture(self, card: pygame.Surface, place: pygame.Rect) -> None:
        pygame.draw.rect(card, BACKGROUND, place)
        if self.picture is not None:
            card.blit(self.picture, self.picture.get_rect(center=place.center))

    def _paint_badge(self, card: pygame.Surface) -> None:
        ui = self.ui
        text = ui.font(12, True).render(self.badge, True, BACKGROUND)
        place = text.get_rect(topleft=(ui.px(20), ui.px(13))).inflate(ui.px(18), ui.px(8))
        pygame.draw.rect(card, ACCENT, place, border_radius=place.height // 2)
        card.blit(text, text.get_rect(center=place.center))

    def _paint_won(self, card: pygame.Surface, picture: pygame.Rect, stars: int, time: str) -> None:
        """Stars and time on a plate in the lower right corner of the picture."""
        ui = self.ui
        row, text = painted_stars(stars, ui.px(STAR_SIZE)), ui.font(12, True).render(time, True, TEXT)
        inset, gap, edge = ui.px(9), ui.px(7), ui.px(8)
        plate = pygame.Surface((row.width + gap + text.width + 2 * inset, ui.px(25)), pygame.SRCALPHA)
        pygame.draw.rect(plate, (*SURFACE, 235), plate.get_rect(), border_radius=plate.height // 2)
        plate.blit(row, (inset, (plate.height - row.height) // 2))
        plate.blit(text, (inset + row.width + gap, (plate.height - text.height) // 2))
        card.blit(plate, plate.get_rect(bottomright=(picture.right - edge, picture.bottom - edge)))

    def press(self) -> None:
        """Open the card's level or recording."""
        self.action()


def draw_shadow(surface: pygame.Surface, place: pygame.Rect, ui: Ui) -> None:
    """Draw a soft shadow behind a card that lies over the others."""
    for step in range(6, 0, -1):
        around = place.move(0, ui.px(4)).inflate(ui.px(3 * step), ui.px(3 * step))
        shade = pygame.Surface(around.size, pygame.SRCALPHA)
        pygame.draw.rect(shade, (0, 0, 0, 16), shade.get_rect(), border_radius=ui.px(CORNER + 1.5 * step))
        surface.blit(shade, around)


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
        """Whether the preview plays, or is about to: not where the level cannot be played in a card."""
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
