"""ResultCard: how a run ended, over the world that stands still: emblem, words, stars, time, and what to do next."""

from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.app.draw.colours import ACCENT, DANGER, MUTED, TEXT, Colour, mixed
from sandbox.app.play.goals.score import told_time
from sandbox.app.widgets.button import painted_icon, painted_stars
from sandbox.app.widgets.dialogs import Choice
from sandbox.app.widgets.styles import PANELS, BoxLook, box
from sandbox.app.widgets.texts import line_height, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.session.outcome import Outcome

# Sizes in layout units.
WIDTH, MARGIN, BUTTON, BUTTON_GAP, AROUND = 410.0, 22.0, 36.0, 8.0, 8.0
EMBLEM, ICON, STAR = 64.0, 34.0, 46.0
TEXT_SIZE, TEXT_LINES, TIME_SIZE, GAP = 19.0, 4, 14.0, 12.0
# How far up a card stands: the part of the room that is above it.
ABOVE = 0.36
# The first star comes so long after the card [s], each other one so long after the one before, and grows for so long
# from this part of its size.
FIRST, EVERY, GROWING, SMALLEST = 0.35, 0.28, 0.2, 0.3


def star_times(stars: int) -> list[float]:
    """When stars come on a card [s]."""
    return [FIRST + EVERY * number for number in range(stars)]


@dataclass(frozen=True)
class Ending:
    """What a card tells: the outcome, the ticks in a second, the best time before [s], and whether this one is better.

    best: None where the level was never won before.
    """

    outcome: Outcome
    rate: int
    best: float | None = None
    is_best: bool = False

    @property
    def words(self) -> str:
        """The words of the rule, or else plain ones."""
        return self.outcome.text or ("Won" if self.outcome.is_won else "Lost")

    @property
    def times(self) -> list[tuple[str, Colour]]:
        """What is said of time, each part with its colour."""
        time = f"Time {told_time(self.outcome.tick / self.rate)}"
        if not self.outcome.is_won:
            return [(time, MUTED)]
        if self.is_best:
            return [(time, TEXT), ("Best so far", ACCENT)] if self.best is not None else [(time, TEXT)]
        return [(time, TEXT), (f"Best {told_time(self.best)}", MUTED)] if self.best is not None else [(time, TEXT)]


class ResultCard:
    """The card in a room [pixels]; choices: labels of buttons and what they do, the main one first.

    since: how long the card has been open [s], as it was before the window was laid out again.
    """

    def __init__(
        self, ui: Ui, ending: Ending, choices: Sequence[Choice], room: pygame.Rect,
        since: float,
    ) -> None:  # fmt: skip
        self.ending, self.since = ending, since
        self._do = choices[0][1]
        inset = ui.px(MARGIN)
        width = min(ui.px(WIDTH), room.width - 2 * ui.px(AROUND))
        tall = _height_of(ui, ending, width - 2 * inset)
        height = tall + ui.px(BUTTON) + ui.px(GAP) + 2 * inset
        left = room.centerx - width // 2
        top = room.top + max(round((room.height - height) * ABOVE), ui.px(AROUND))
        self.panel = ui.panel(pygame.Rect(left, top, width, height), style="dialog")
        self.face = _Face(ui, pygame.Rect(inset, inset, width - 2 * inset, tall), ending, self.panel)
        wide = (width - 2 * inset - ui.px(BUTTON_GAP) * (len(choices) - 1)) // len(choices)
        self.buttons = {}
        for number, (label, do) in enumerate(choices):
            place = pygame.Rect(inset + number * (wide + ui.px(BUTTON_GAP)), height - inset - ui.px(BUTTON), wide,
                                ui.px(BUTTON))  # fmt: skip
            style = "" if number else "primary"
            self.buttons[label] = ui.button(place, label, do, self.panel, style=style)

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


def _lines_of(ui: Ui, ending: Ending, width: int) -> list[str]:
    return wrapped(ending.words, ui.font(TEXT_SIZE, True), width, TEXT_LINES)


def _height_of(ui: Ui, ending: Ending, width: int) -> int:
    """How high a face is that is so wide [pixels]."""
    gap, words = ui.px(GAP), len(_lines_of(ui, ending, width)) * line_height(ui.font(TEXT_SIZE, True))
    stars = ui.px(STAR) + gap if ending.outcome.is_won else 0
    return ui.px(EMBLEM) + gap + words + gap + stars + line_height(ui.font(TIME_SIZE)) + gap


class _Face(Widget):
    """What a card shows above its buttons."""

    def __init__(self, ui: Ui, place: pygame.Rect, ending: Ending, panel: Widget) -> None:
        super().__init__(ui, place, panel)
        self._ui, self._ending = ui, ending
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
        """Emblem, words, stars and time, each in the middle."""
        ui, outcome = self.ui, self._ending.outcome
        surface, middle, gap = pygame.Surface(size, pygame.SRCALPHA), size[0] // 2, ui.px(GAP)
        side = ui.px(EMBLEM)
        colour = ACCENT if outcome.is_won else DANGER
        shade = mixed(PANELS["dialog"].back, colour, 0.22)
        surface.blit(box((side, side), BoxLook(shade, shade, colour), side // 2, 1), (middle - side // 2, 0))
        emblem = painted_icon("won" if outcome.is_won else "lost", ui.px(ICON), colour)
        surface.blit(emblem, emblem.get_rect(center=(middle, side // 2)))
        y, bold = side + gap, ui.font(TEXT_SIZE, True)
        for line in _lines_of(self._ui, self._ending, size[0]):
            text = bold.render(line, True, TEXT)
            surface.blit(text, text.get_rect(midtop=(middle, y)))
            y += line_height(bold)
        y += gap
        if outcome.is_won:
            number, grown = self._stars
            stars = painted_stars(number, ui.px(STAR), grown)
            surface.blit(stars, stars.get_rect(midtop=(middle, y)))
            y += ui.px(STAR) + gap
        plain, parts = ui.font(TIME_SIZE), self._ending.times
        pictures = [plain.render(text, True, colour) for text, colour in parts]
        x = middle - (sum(each.width for each in pictures) + 2 * gap * (len(pictures) - 1)) // 2
        for picture in pictures:
            surface.blit(picture, (x, y))
            x += picture.width + 2 * gap
        return surface
