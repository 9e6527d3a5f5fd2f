"""ScoreView: draws the chips of a score, and the line of the goal below them."""

from collections.abc import Callable

import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import LINE, MUTED, NOTICE, TEXT, shown_theme
from sandbox.app.play.goals.score import Chip
from sandbox.app.widgets.button import painted_icon, painted_stars
from sandbox.app.widgets.texts import line_height, shortened, wrapped
from sandbox.app.widgets.ui import Ui

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
        self, surface: pygame.Surface, ui: Ui, chips: list[Chip], goal: str, share: float, room: pygame.Rect
    ) -> None:
        """Draw chips at the middle of the top of a room [pixels], and below them the goal as strongly as share 0..1."""
        y, middle, width = room.top + ui.px(TOP), room.centerx, max(room.width - 2 * ui.px(TOP), 1)
        self.place = pygame.Rect(middle, y, 0, 0)
        for row in self._rows(ui, chips, width):
            x = middle - (sum(each.width for each in row) + ui.px(GAP) * (len(row) - 1)) // 2
            for picture in row:
                self.place.union_ip(surface.blit(picture, (x, y)))
                x += picture.width + ui.px(GAP)
            y += ui.px(CHIP + ROW_GAP)
        if goal and share > 0.0:
            picture = self._picture(ui, ("goal", goal, width), lambda: _painted_goal(ui, goal, width))
            picture.set_alpha(round(255 * min(share, 1.0)))
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
    room = min(ui.px(GOAL_WIDTH), most) - 2 * inset
    lines = [font.render(line, True, TEXT) for line in wrapped(goal, font, max(room, 1), GOAL_LINES)]
    step, middle = line_height(font), max(line.width for line in lines) // 2 + inset
    height = step * len(lines) + 2 * ui.px(GOAL_INSET)
    plate = _plate(ui, 2 * middle, height)
    for number, line in enumerate(lines):
        plate.blit(line, line.get_rect(midtop=(middle, ui.px(GOAL_INSET) + number * step)))
    return plate
