"""The score of a run: chips at the top of the world, and the line of its goal."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, NOTICE, TEXT, WARNING, Colour, shown_theme
from sandbox.app.widgets.button import painted_icon, painted_stars
from sandbox.app.widgets.texts import line_height, shortened, wrapped
from sandbox.app.widgets.ui import Ui
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
# Icons of chips that tell how the run ended.
ENDS = ("won", "lost")
# A clock's chip stays as wide as for these digits.
WIDEST = "0"
OPACITY = 238
# What pictures of chips may take [bytes].
HELD = 2_000_000


class ScoreView:
    """Draws chips and goal; place, end: what chips, and that of the end, take of the window as drawn last [pixels]."""

    def __init__(self) -> None:
        self.place = self.end = pygame.Rect(0, 0, 0, 0)
        self._kept: RecentPictures[tuple[object, ...]] = RecentPictures(HELD)

    def draw(
        self, surface: pygame.Surface, ui: Ui, chips: list[Chip], goal: tuple[str, str], opacity: float,
        area: pygame.Rect,
    ) -> None:  # fmt: skip
        """Draw chips at the middle of the top of an area [pixels], and below them the goal at that opacity 0..1, with
        what is said of its solution.
        """
        y, middle, width = area.top + ui.px(TOP), area.centerx, max(area.width - 2 * ui.px(TOP), 1)
        self.place, last = pygame.Rect(middle, y, 0, 0), pygame.Rect(0, 0, 0, 0)
        for row in self._rows(ui, chips, width):
            x = middle - (sum(each.width for each in row) + ui.px(GAP) * (len(row) - 1)) // 2
            for picture in row:
                last = surface.blit(picture, (x, y))
                self.place.union_ip(last)
                x += picture.width + ui.px(GAP)
            y += ui.px(CHIP + ROW_GAP)
        self.end = last if chips and chips[-1].icon in ENDS else pygame.Rect(0, 0, 0, 0)
        if any(goal) and opacity > 0.0:
            picture = self._picture(ui, ("goal", goal, width), lambda: _painted_goal(ui, *goal, width))
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


def _painted_goal(ui: Ui, goal: str, solved: str, most: int) -> pygame.Surface:
    """The goal, and below it what is said of its solution, on a plate that is at most so wide [pixels]."""
    inset = ui.px(PADDING)
    width, lines = max(min(ui.px(GOAL_WIDTH), most) - 2 * inset, 1), list[pygame.Surface]()
    for text, font, colour in ((goal, ui.font(GOAL_SIZE, True), TEXT), (solved, ui.font(NAME_SIZE), MUTED)):
        lines += [font.render(line, True, colour) for line in wrapped(text, font, width, GOAL_LINES)] if text else []
    step, middle = line_height(ui.font(GOAL_SIZE, True)), max(line.width for line in lines) // 2 + inset
    height = step * len(lines) + 2 * ui.px(GOAL_INSET)
    plate = _plate(ui, 2 * middle, height)
    for number, line in enumerate(lines):
        plate.blit(line, line.get_rect(midtop=(middle, ui.px(GOAL_INSET) + number * step)))
    return plate
