"""The score of a run: chips at the top of the world, the line of its goal, and the card that tells how it ended."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, NOTICE, TEXT, WARNING, Colour, mixed, shown_theme
from sandbox.app.widgets.button import painted_icon, painted_stars
from sandbox.app.widgets.dialogs import Choice
from sandbox.app.widgets.styles import PANELS, BoxLook, box
from sandbox.app.widgets.texts import line_height, shortened, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.level.document.model import Level
from sandbox.level.rules.player_limits import left_of
from sandbox.level.rules.rule import has_clock
from sandbox.physics.snapshot import Snapshot
from sandbox.session.outcome import Outcome

# Time left from which on a clock that counts down warns [s].
SHORT_TIME = 10.0


@dataclass(frozen=True)
class Chip:
    """A chip of the score: an icon, a name, a value; stars: how many are lit, None = there are none on it."""

    icon: str = ""
    name: str = ""
    value: str = ""
    colour: Colour = TEXT
    stars: int | None = None


def time_text(seconds: float, decimals: int = 2) -> str:
    """A time of a run: "12.35 s", or from a minute on "1:02.35"; a hundredth that is not over does not count."""
    parts = math.floor(seconds * 10**decimals + 1e-6)
    whole, rest = divmod(parts, 10**decimals)
    if whole < 60:
        return f"{whole}.{rest:0{decimals}} s"
    return f"{whole // 60}:{whole % 60:02}.{rest:0{decimals}}"


def time_limit(level: Level) -> float | None:
    """The time [s] at which a level is lost, whatever else happens; None: there is none."""
    limits = [
        rule.when.time + rule.for_seconds
        for rule in level.rules
        if rule.when.time is not None and any(action.fail is not None for action in rule.then)
    ]
    return min(limits, default=None)


def chips_of(level: Level, state: Snapshot, result: Outcome | None) -> list[Chip]:
    """Chips for a state of a level, with its result."""
    chips = [Chip("goal", colour=ACCENT)] if level.goal else []
    if has_clock(level.rules):
        chips.append(_clock(level, state.tick if result is None else result.tick))
    values = zip(level.counters, state.counter.tolist(), strict=False)
    chips += [Chip(name=counter.text, value=f"{value + 0.0:.6g}") for counter, value in values if counter.text]
    chips += [
        Chip(name=f"{name} left", value=f"{state.counter[row]:.0f} of {most}")
        for row, name, most in left_of(level.hands, len(state.counter))
    ]
    if result is not None and result.is_won:
        chips.append(Chip("won", colour=ACCENT, stars=result.stars))
    elif result is not None:
        chips.append(Chip("lost", value="Lost", colour=DANGER))
    return chips


def _clock(level: Level, tick: int) -> Chip:
    seconds, limit = tick / level.settings.tick_rate, time_limit(level)
    if limit is None:
        return Chip("clock", value=time_text(seconds, 1))
    remaining = max(limit - seconds, 0.0)
    return Chip("clock", value=time_text(remaining, 1), colour=WARNING if remaining <= SHORT_TIME else TEXT)


# Sizes in layout units: of the chips and of what is in them, and of the line of the goal.
TOP, CHIP, PADDING, GAP, ROW_GAP = 10.0, 30.0, 11.0, 6.0, 6.0
VALUE_SIZE, NAME_SIZE, ICON, STAR, INSIDE = 15.0, 12.5, 15.0, 16.0, 7.0
GOAL_SIZE, GOAL_WIDTH, GOAL_LINES, GOAL_INSET = 14.0, 560.0, 2, 7.0
# A clock's chip stays as wide as for these digits.
WIDEST = "0"
OPACITY = 238
# What pictures of chips may take [bytes].
HELD = 2_000_000


class ScoreView:
    """Draws chips and goal; place: what the chips take of the window as they were drawn last [pixels]."""

    def __init__(self) -> None:
        self.place = pygame.Rect(0, 0, 0, 0)
        self._kept: RecentPictures[tuple[object, ...]] = RecentPictures(HELD)

    def draw(
        self, surface: pygame.Surface, ui: Ui, chips: list[Chip], goal: str, opacity: float, area: pygame.Rect
    ) -> None:
        """Draw chips at the middle of the top of an area [pixels], and below them the goal at that opacity 0..1."""
        y, middle, width = area.top + ui.px(TOP), area.centerx, max(area.width - 2 * ui.px(TOP), 1)
        self.place = pygame.Rect(middle, y, 0, 0)
        for row in self._rows(ui, chips, width):
            x = middle - (sum(each.width for each in row) + ui.px(GAP) * (len(row) - 1)) // 2
            for picture in row:
                self.place.union_ip(surface.blit(picture, (x, y)))
                x += picture.width + ui.px(GAP)
            y += ui.px(CHIP + ROW_GAP)
        if goal and opacity > 0.0:
            picture = self._picture(ui, ("goal", goal, width), lambda: _painted_goal(ui, goal, width))
            picture.set_alpha(round(255 * min(opacity, 1.0)))
            surface.blit(picture, picture.get_rect(midtop=(middle, y)))

    def _rows(self, ui: Ui, chips: list[Chip], width: int) -> list[list[pygame.Surface]]:
        """Pictures of chips, as many in a row as have room."""
        rows: list[list[pygame.Surface]] = []
        taken = width
        for chip in chips:
            picture = self._picture(ui, (chip, width), lambda chip=chip: _painted_chip(ui, chip, width))  # type: ignore[misc]
            if taken + picture.width > width:
                rows.append([])
                taken = 0
            rows[-1].append(picture)
            taken += picture.width + ui.px(GAP)
        return rows

    def _picture(self, ui: Ui, key: tuple[object, ...], paint: Callable[[], pygame.Surface]) -> pygame.Surface:
        whole = *key, ui.scale, shown_theme()
        picture = self._kept.find(whole)
        if picture is None:
            picture = paint()
            self._kept.keep(whole, picture)
        return picture


def _plate(ui: Ui, width: int, height: int) -> pygame.Surface:
    plate = pygame.Surface((width, height), pygame.SRCALPHA)
    radius = min(ui.px(CHIP / 2), height // 2)
    pygame.draw.rect(plate, (*NOTICE, OPACITY), plate.get_rect(), border_radius=radius)
    pygame.draw.rect(plate, LINE, plate.get_rect(), max(1, ui.px(1)), border_radius=radius)
    return plate


def _painted_chip(ui: Ui, chip: Chip, most: int) -> pygame.Surface:
    """A chip with its parts from the left, at most so wide [pixels]."""
    bold, plain, parts = ui.font(VALUE_SIZE, True), ui.font(NAME_SIZE), []
    if chip.icon:
        parts.append(painted_icon(chip.icon, ui.px(ICON), chip.colour))
    if chip.name:
        parts.append(plain.render(shortened(chip.name, plain, most // 2), True, MUTED))
    if chip.value:
        parts.append(bold.render(shortened(chip.value, bold, most // 2), True, chip.colour))
    if chip.stars is not None:
        parts.append(painted_stars(chip.stars, ui.px(STAR)))
    between, inset = ui.px(INSIDE), ui.px(PADDING)
    width = sum(part.width for part in parts) + between * (len(parts) - 1) + 2 * inset
    if chip.icon == "clock":
        # Digits are not all as wide as each other, and a chip that trembles is hard to read.
        digits = "".join(WIDEST if each.isdigit() else each for each in chip.value)
        width += max(bold.size(digits)[0] - bold.size(chip.value)[0], 0)
    height = ui.px(CHIP)
    plate, x = _plate(ui, max(width, height), height), inset
    for part in parts:
        plate.blit(part, (x, (height - part.height) // 2))
        x += part.width + between
    return plate


def _painted_goal(ui: Ui, goal: str, most: int) -> pygame.Surface:
    """The goal on a plate that is at most so wide [pixels]."""
    font, inset = ui.font(GOAL_SIZE, True), ui.px(PADDING)
    width = min(ui.px(GOAL_WIDTH), most) - 2 * inset
    lines = [font.render(line, True, TEXT) for line in wrapped(goal, font, max(width, 1), GOAL_LINES)]
    step, middle = line_height(font), max(line.width for line in lines) // 2 + inset
    height = step * len(lines) + 2 * ui.px(GOAL_INSET)
    plate = _plate(ui, 2 * middle, height)
    for number, line in enumerate(lines):
        plate.blit(line, line.get_rect(midtop=(middle, ui.px(GOAL_INSET) + number * step)))
    return plate


# Sizes in layout units.
_CARD_WIDTH, _CARD_MARGIN, _BUTTON, _BUTTON_GAP, _AROUND = 410.0, 22.0, 36.0, 8.0, 8.0
_EMBLEM, _EMBLEM_ICON, _LARGE_STAR = 64.0, 34.0, 46.0
_WORDS_SIZE, _WORDS_LINES, _TIME_SIZE, _CARD_GAP = 19.0, 4, 14.0, 12.0
# How far up a card stands: the part of the area that is above it.
ABOVE = 0.36
# The first star comes so long after the card [s], each other one so long after the one before, and grows for so long
# from this part of its size.
FIRST, EVERY, GROWING, SMALLEST = 0.35, 0.28, 0.2, 0.3


def star_times(stars: int) -> list[float]:
    """When stars come on a card [s]."""
    return [FIRST + EVERY * number for number in range(stars)]


@dataclass(frozen=True)
class Ending:
    """The text of a card: the outcome, the ticks in a second, the best time before [s], and whether this is better.

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
        """The words about time, each part with its colour."""
        time = f"Time {time_text(self.outcome.tick / self.rate)}"
        if not self.outcome.is_won:
            return [(time, MUTED)]
        if self.is_best:
            return [(time, TEXT), ("Best so far", ACCENT)] if self.best is not None else [(time, TEXT)]
        return [(time, TEXT), (f"Best {time_text(self.best)}", MUTED)] if self.best is not None else [(time, TEXT)]


class ResultCard:
    """The card in an area [pixels]; choices: labels of buttons and what they do, the main one first.

    since: how long the card has been open [s], as it was before the window was laid out again.
    """

    def __init__(
        self, ui: Ui, ending: Ending, choices: Sequence[Choice], area: pygame.Rect,
        since: float,
    ) -> None:  # fmt: skip
        self.ending, self.since = ending, since
        self._do = choices[0][1]
        inset = ui.px(_CARD_MARGIN)
        width = min(ui.px(_CARD_WIDTH), area.width - 2 * ui.px(_AROUND))
        tall = _height_of(ui, ending, width - 2 * inset)
        height = tall + ui.px(_BUTTON) + ui.px(_CARD_GAP) + 2 * inset
        left = area.centerx - width // 2
        top = area.top + max(round((area.height - height) * ABOVE), ui.px(_AROUND))
        self.panel = ui.panel(pygame.Rect(left, top, width, height), style="dialog")
        self.face = _Face(ui, pygame.Rect(inset, inset, width - 2 * inset, tall), ending, self.panel)
        wide = (width - 2 * inset - ui.px(_BUTTON_GAP) * (len(choices) - 1)) // len(choices)
        self.buttons = {}
        for number, (label, do) in enumerate(choices):
            place = pygame.Rect(inset + number * (wide + ui.px(_BUTTON_GAP)), height - inset - ui.px(_BUTTON), wide,
                                ui.px(_BUTTON))  # fmt: skip
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
    return wrapped(ending.words, ui.font(_WORDS_SIZE, True), width, _WORDS_LINES)


def _height_of(ui: Ui, ending: Ending, width: int) -> int:
    """Height of a face of that width [pixels]."""
    gap, words = ui.px(_CARD_GAP), len(_lines_of(ui, ending, width)) * line_height(ui.font(_WORDS_SIZE, True))
    stars = ui.px(_LARGE_STAR) + gap if ending.outcome.is_won else 0
    return ui.px(_EMBLEM) + gap + words + gap + stars + line_height(ui.font(_TIME_SIZE)) + gap


class _Face(Widget):
    """The part of a card above its buttons."""

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
        surface, middle, gap = pygame.Surface(size, pygame.SRCALPHA), size[0] // 2, ui.px(_CARD_GAP)
        side = ui.px(_EMBLEM)
        colour = ACCENT if outcome.is_won else DANGER
        shade = mixed(PANELS["dialog"].back, colour, 0.22)
        surface.blit(box((side, side), BoxLook(shade, shade, colour), side // 2, 1), (middle - side // 2, 0))
        emblem = painted_icon("won" if outcome.is_won else "lost", ui.px(_EMBLEM_ICON), colour)
        surface.blit(emblem, emblem.get_rect(center=(middle, side // 2)))
        y, bold = side + gap, ui.font(_WORDS_SIZE, True)
        for line in _lines_of(self._ui, self._ending, size[0]):
            text = bold.render(line, True, TEXT)
            surface.blit(text, text.get_rect(midtop=(middle, y)))
            y += line_height(bold)
        y += gap
        if outcome.is_won:
            number, grown = self._stars
            stars = painted_stars(number, ui.px(_LARGE_STAR), grown)
            surface.blit(stars, stars.get_rect(midtop=(middle, y)))
            y += ui.px(_LARGE_STAR) + gap
        plain, parts = ui.font(_TIME_SIZE), self._ending.times
        pictures = [plain.render(text, True, colour) for text, colour in parts]
        x = middle - (sum(each.width for each in pictures) + 2 * gap * (len(pictures) - 1)) // 2
        for picture in pictures:
            surface.blit(picture, (x, y))
            x += picture.width + 2 * gap
        return surface
