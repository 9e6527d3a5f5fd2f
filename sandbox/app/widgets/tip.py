"""Tip: what is said of the widget that the mouse rests on."""

from typing import Any

import pygame

from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.plate import box
from sandbox.app.widgets.styles import TIP
from sandbox.app.widgets.texts import line_height, wrapped

# It comes after so long [s].
DELAY = 0.6
# Sizes in layout units: of the widest, of letters, of the room around them, of the corners, and away from its widget.
WIDEST, TEXT_SIZE, ACROSS, DOWN, CORNER, GAP = 260.0, 12.0, 9.0, 6.0, 6.0, 8.0
MOST_LINES = 30


class Tip:
    """The only tip of a window; place: where it is shown [pixels], None while it is not."""

    def __init__(self, ui: WindowLayout) -> None:
        self._ui = ui
        self._rested = 0.0
        self._shown: tuple[Any, str] | None = None
        self._picture: pygame.Surface | None = None
        self.place: pygame.Rect | None = None

    @property
    def text(self) -> str:
        """The text of the tip that is shown; "" while none is."""
        return "" if self.place is None or self._shown is None else self._shown[1]

    def hide(self, until_moved: bool = False) -> None:
        """Hide the tip, and wait anew; until_moved: until the mouse has come to another widget."""
        self._rested = -float("inf") if until_moved else 0.0
        self._shown = self.place = self._picture = None

    def pass_time(self, seconds: float) -> None:
        """Count for how long the mouse rests [s], and show the tip once that is long enough."""
        self._rested += seconds
        under = self._ui.under
        text = under.tip if under is not None and self._ui.held is None else ""
        if not text or self._rested < DELAY:
            self._shown = self.place = self._picture = None
        elif self._shown != (under, text):
            self._shown = under, text
            self._picture = self._painted(text)
            self.place = self._placed(self._picture.get_rect(), under)

    def _painted(self, text: str) -> pygame.Surface:
        ui, font = self._ui, self._ui.font(TEXT_SIZE)
        across, down, high = ui.px(ACROSS), ui.px(DOWN), line_height(font)
        room = min(ui.px(WIDEST), ui.size[0]) - 2 * across
        lines = [line for part in text.split("\n") for line in wrapped(part, font, room, MOST_LINES)]
        wide = max(font.size(line)[0] for line in lines)
        size = wide + 2 * across, high * len(lines) + 2 * down
        picture = box(size, TIP, ui.px(CORNER), max(ui.px(1), 1)).copy()
        for number, line in enumerate(lines):
            picture.blit(font.render(line, True, TIP.text), (across, down + number * high))
        return picture

    def _placed(self, place: pygame.Rect, owner: Any) -> pygame.Rect:
        """Beside the panel at a side of the window that holds its widget, not over the next one; else below it."""
        ui, gap, holder = self._ui, self._ui.px(GAP), owner
        window = pygame.Rect((0, 0), ui.size)
        while holder.parent is not None and holder.parent is not ui.root:
            holder = holder.parent
        if holder is not owner and 2 * holder.rect.width < window.width:
            beside = place.copy()
            beside.top = max(min(owner.rect.top, window.bottom - place.height), 0)
            if holder.rect.centerx > window.centerx:
                beside.right = holder.rect.left - gap
            else:
                beside.left = holder.rect.right + gap
            if window.contains(beside):
                return beside
        place.midtop = owner.seen.centerx, owner.seen.bottom + gap
        if place.bottom > window.bottom:
            place.bottom = owner.seen.top - gap
        return place.clamp(window)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the tip, while it is shown."""
        if self.place is not None and self._picture is not None:
            surface.blit(self._picture, self.place)
