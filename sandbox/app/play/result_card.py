"""ResultCard: the card at the side that tells how a run ended, what the next star takes, and what one may do now."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import ACCENT, DANGER, MUTED, TEXT, Colour, mixed
from sandbox.app.play.score import time_text
from sandbox.app.widgets.button import painted_icon, painted_stars
from sandbox.app.widgets.dialogs import Choice
from sandbox.app.widgets.styles import PANELS, BoxLook, box
from sandbox.app.widgets.texts import line_height, shortened, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget, WindowLayout
from sandbox.session.outcome import Outcome

# Sizes in layout units.
_WIDTH, _MARGIN, _BUTTON, _BUTTON_GAP, _AROUND = 300.0, 16.0, 34.0, 7.0, 10.0
_EMBLEM, _EMBLEM_ICON, _STAR = 46.0, 26.0, 36.0
_WORDS_SIZE, _WORDS_LINES, _LINE_SIZE, _GAP = 17.0, 4, 13.5, 9.0
# A lower card does without its emblem, so that it hides less.
_LOW = 470.0
# Of a place, more of what moves may be behind it than in another by this many points before that one is taken.
_AS_FREE = 2
# The first star comes so long after the card [s], each other one so long after the one before, and grows for so long
# from this part of its size.
FIRST, EVERY, GROWING, SMALLEST = 0.35, 0.28, 0.2, 0.3


def star_times(stars: int) -> list[float]:
    """When stars come on a card [s]."""
    return [FIRST + EVERY * number for number in range(stars)]


@dataclass(frozen=True)
class Ending:
    """The text of a card: the outcome, the ticks in a second, the best time before [s], and whether this is better.

    best: None where the level was never won before. score: counters in words. next_star: what one more star takes.
    """

    outcome: Outcome
    rate: int
    best: float | None = None
    is_best: bool = False
    score: tuple[str, ...] = ()
    next_star: str = ""

    @property
    def words(self) -> str:
        """The words of the rule, or else plain ones."""
        return self.outcome.text or ("Won" if self.outcome.is_won else "Lost")

    @property
    def times(self) -> list[tuple[str, Colour]]:
        """The words about time, each part with its colour."""
        time = f"Time {time_text(self.outcome.tick / self.rate)}"
        if not self.outcome.is_won:
            return [(time, MUTED)]
        if self.is_best:
            return [(time, TEXT), ("Best so far", ACCENT)] if self.best is not None else [(time, TEXT)]
        return [(time, TEXT), (f"Best {time_text(self.best)}", MUTED)] if self.best is not None else [(time, TEXT)]

    @property
    def lines(self) -> list[list[tuple[str, Colour]]]:
        """The lines below the stars: times, counters, and what the next star takes."""
        found = [self.times]
        for line in self.score:
            found.append([(line, TEXT)])
        return [*found, [(self.next_star, ACCENT)]] if self.next_star else found


class ResultCard:
    """The card in an area [pixels]; choices: labels of buttons and what they do, the main one first.

    since: how long the card has been open [s], as it was before the window was laid out again. things: places (n, 2)
    of what is seen [pixels], of which the card hides as little as it can.
    """

    def __init__(
        self, ui: Ui, ending: Ending, choices: Sequence[Choice], area: pygame.Rect, since: float,
        things: NDArray[Any],
    ) -> None:  # fmt: skip
        self.ending, self.since = ending, since
        self._do = choices[0][1]
        inset, gap = ui.px(_MARGIN), ui.px(_BUTTON_GAP)
        width = min(ui.px(_WIDTH), area.width - 2 * ui.px(_AROUND))
        inside = width - 2 * inset
        has_emblem = area.height >= ui.px(_LOW)
        tall = sum(picture.height + below for picture, below in _pictures(ui, ending, inside, has_emblem))
        # The main button is as wide as the card, and others are two in a row.
        rows = [choices[:1], *(choices[first : first + 2] for first in range(1, len(choices), 2))]
        height = tall + len(rows) * (ui.px(_BUTTON) + gap) - gap + 2 * inset
        self.panel = ui.panel(_free_place(ui, area, (width, height), things), style="dialog")
        self.face = _Face(ui, pygame.Rect(inset, inset, inside, tall), ending, self.panel, has_emblem)
        self.buttons = {}
        for number, row in enumerate(rows):
            wide = (inside - gap * (len(row) - 1)) // len(row)
            y = inset + tall + number * (ui.px(_BUTTON) + gap)
            for column, (label, do) in enumerate(row):
                place = pygame.Rect(inset + column * (wide + gap), y, wide, ui.px(_BUTTON))
                self.buttons[label] = ui.button(place, label, do, self.panel, style="" if number else "primary")

    @property
    def moves(self) -> bool:
        """Whether stars are still to come."""
        return self.since < max(star_times(self.ending.outcome.stars), default=0.0) + GROWING

    def press(self) -> None:
        """Do what the main button does."""
        self._do()

    def update(self, frame_time: float, at_once: bool) -> None:
        """Let frame_time [s] pass; at_once: all stars are there from the first."""
        self.since = 1e9 if at_once else self.since + frame_time
        self.face.show(self.since)

    def remove(self) -> None:
        """Take the card away."""
        self.panel.remove()


def _free_place(ui: Ui, area: pygame.Rect, size: tuple[int, int], things: NDArray[Any]) -> pygame.Rect:
    """A place of a size in an area [pixels] at a side, or else above or below, with the least behind it."""
    inner = area.inflate(-2 * ui.px(_AROUND), -2 * ui.px(_AROUND))
    place = pygame.Rect((0, 0), size)
    sides = ["midright", "midleft"] if area.width >= 2 * size[0] else []
    found = []
    for side in [*sides, "topright", "topleft", "bottomright", "bottomleft"]:
        each = place.copy()
        setattr(each, side, getattr(inner, side))
        found.append(each.clamp(area))
    hidden = [int(((things >= each.topleft) & (things < each.bottomright)).all(axis=1).sum()) for each in found]
    return next(each for each, count in zip(found, hidden, strict=True) if count <= min(hidden) + _AS_FREE)


class _Face(Widget):
    """The part of a card above its buttons."""

    def __init__(self, ui: Ui, place: pygame.Rect, ending: Ending, panel: Widget, has_emblem: bool) -> None:
        super().__init__(ui, place, panel)
        self._ending, self._has_emblem = ending, has_emblem
        # How many stars have come, and how large the last one is.
        self._stars = (0, 1.0)

    def show(self, since: float) -> None:
        """Show the stars that have come so long [s] after the card opened."""
        come = [since - time for time in star_times(self._ending.outcome.stars) if time <= since]
        grown = min(come[-1] / GROWING, 1.0) if come else 1.0
        stars = len(come), round(SMALLEST + (1.0 - SMALLEST) * (1.0 - (1.0 - grown) ** 2), 2)
        if stars != self._stars:
            self._stars = stars
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Emblem, words, stars, time and score, each in the middle."""
        surface, y = pygame.Surface(size, pygame.SRCALPHA), 0
        for picture, below in _pictures(self.ui, self._ending, size[0], self._has_emblem, self._stars):
            surface.blit(picture, ((size[0] - picture.width) // 2, y))
            y += picture.height + below
        return surface


def _pictures(
    ui: WindowLayout, ending: Ending, width: int, has_emblem: bool, stars: tuple[int, float] = (0, 1.0)
) -> list[tuple[pygame.Surface, int]]:
    """The pictures of a face of that width, from the top, each with the gap below it [pixels]."""
    gap, bold, font, found = ui.px(_GAP), ui.font(_WORDS_SIZE, True), ui.font(_LINE_SIZE), []
    if has_emblem:
        found.append((_emblem(ui, ending.outcome.is_won), gap))
    lines = wrapped(ending.words, bold, width, _WORDS_LINES)
    found += [(bold.render(line, True, TEXT), 0) for line in lines[:-1]] + [(bold.render(lines[-1], True, TEXT), gap)]
    if ending.outcome.is_won:
        found.append((painted_stars(stars[0], ui.px(_STAR), stars[1]), gap))
    found += [(_beside(font, parts, width, 2 * gap), 0) for parts in ending.lines]
    return [*found[:-1], (found[-1][0], gap)]


def _emblem(ui: WindowLayout, is_won: bool) -> pygame.Surface:
    side, colour = ui.px(_EMBLEM), ACCENT if is_won else DANGER
    shade = mixed(PANELS["dialog"].back, colour, 0.22)
    picture = box((side, side), BoxLook(shade, shade, colour), side // 2, 1).copy()
    icon = painted_icon("won" if is_won else "lost", ui.px(_EMBLEM_ICON), colour)
    picture.blit(icon, icon.get_rect(center=(side // 2, side // 2)))
    return picture


def _beside(font: pygame.font.Font, parts: Iterable[tuple[str, Colour]], width: int, gap: int) -> pygame.Surface:
    """Words in a line of at most that width [pixels], with gaps between them."""
    pictures = [font.render(shortened(text, font, width), True, colour) for text, colour in parts]
    line = pygame.Surface(
        (sum(each.width for each in pictures) + gap * (len(pictures) - 1), line_height(font)), pygame.SRCALPHA
    )
    x = 0
    for picture in pictures:
        line.blit(picture, (x, 0))
        x += picture.width + gap
    return line
