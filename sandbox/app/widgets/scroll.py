"""ScrollArea: widgets on a page that is higher than its place, moved by wheel, scroll bar, keys and Tab."""

from collections.abc import Callable
from typing import Any

import pygame
from pygame_gui.core import UIContainer, UIElement

from sandbox.app.draw.colours import ACCENT, LINE
from sandbox.app.widgets.painted import Painted
from sandbox.app.widgets.ui import Ui

# Sizes in layout units: width of a scroll bar, its shortest thumb, way of a notch of the wheel and of an arrow key.
BAR_WIDTH = 10.0
SHORTEST_THUMB = 26.0
WHEEL_STEP = 64.0
KEY_STEP = 40.0
# What has the keyboard is kept this far from the edges.
REVEAL_GAP = 12.0


class ScrollBar(Painted):
    """A bar at the right of something high; scrolled(offset) [pixels] is called when the person moves it."""

    def __init__(self, ui: Ui, rect: pygame.Rect, scrolled: Callable[[float], None], container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.offset, self.height, self.page = 0.0, 1, 1
        self._scrolled = scrolled
        self._grip: float | None = None
        ui.add(self)
        self.repaint()

    def show_place(self, offset: float, height: int, page: int) -> None:
        """Show which part of the whole height is seen; all of it: no bar."""
        if (offset, height, page) != (self.offset, self.height, self.page):
            self.offset, self.height, self.page = offset, height, page
            self.repaint()
        # Without anything to scroll, Tab passes it by.
        self.is_enabled = self.needed

    @property
    def needed(self) -> bool:
        """Whether there is more than is seen."""
        return self.height > self.page

    def _thumb(self) -> tuple[float, float]:
        """Top and height of the thumb [pixels]."""
        tall = self.rect.height
        size = min(max(tall * self.page / max(self.height, 1), self.ui.px(SHORTEST_THUMB)), tall)
        return (tall - size) * self.offset / max(self.height - self.page, 1), size

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The thumb alone."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        if self.needed:
            top, height = self._thumb()
            wide = self.ui.px(5)
            place = pygame.Rect(size[0] - wide - self.ui.px(1), round(top), wide, round(height))
            pygame.draw.rect(surface, ACCENT if self._grip is not None else LINE, place, border_radius=wide // 2)
        return surface

    def process_event(self, event: pygame.event.Event) -> bool:
        """Follow the mouse; a press beside the thumb moves by a page."""
        if self.needed and self.is_press(event):
            y = self.ui.manager.calculate_scaled_mouse_position(event.pos)[1]
            top, height = self._thumb()
            at = y - self.rect.top
            if top <= at <= top + height:
                self._grip = at - top
                self.repaint()
            else:
                self._scrolled(self.offset + (self.page if at > top else -self.page))
            return True
        if event.type == pygame.MOUSEMOTION and self._grip is not None:
            y = self.ui.manager.calculate_scaled_mouse_position(event.pos)[1]
            room = self.rect.height - self._thumb()[1]
            self._scrolled((y - self.rect.top - self._grip) / max(room, 1.0) * (self.height - self.page))
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self._grip is not None:
            self._grip = None
            self.repaint()
            return True
        return False

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows by a step, Page keys by a page, Home and End to the ends."""
        target = scrolled_by(event.key, self.offset, self.ui.px(KEY_STEP), self.page, self.height)
        if target is None:
            return False
        self._scrolled(target)
        return True


def scrolled_by(key: int, offset: float, step: float, page: float, height: float) -> float | None:
    """Where a key scrolls to from an offset; None for a key that does not scroll."""
    return {
        pygame.K_UP: offset - step,
        pygame.K_DOWN: offset + step,
        pygame.K_PAGEUP: offset - page,
        pygame.K_PAGEDOWN: offset + page,
        pygame.K_HOME: 0.0,
        pygame.K_END: height,
    }.get(key)


class _View(UIContainer):
    """The visible part; the wheel over it scrolls, and it follows the keyboard."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, wheel: Callable[[float], None], follow: Callable[[], None], container: Any
    ) -> None:
        super().__init__(rect, ui.manager, container=container)
        self._wheel, self._follow = wheel, follow
        self._ui = ui

    def update(self, time_delta: float) -> None:
        """Follow the keyboard."""
        super().update(time_delta)
        self._follow()

    def process_event(self, event: pygame.event.Event) -> bool:
        """Scroll by the wheel."""
        if event.type == pygame.MOUSEWHEEL and self.hover_point(*self._ui.manager.get_mouse_position()):
            self._wheel(event.precise_y or event.y)
            return True
        return bool(super().process_event(event))


class ScrollArea:
    """A place [pixels] in which `content`, a container of widgets, moves up and down."""

    def __init__(self, ui: Ui, place: pygame.Rect, container: Any = None) -> None:
        self._ui = ui
        wide = ui.px(BAR_WIDTH)
        self._revealed: UIElement | None = None
        self.view = _View(ui, pygame.Rect(place.topleft, (place.width - wide, place.height)), self.turn,
                          self.follow_focus, container)  # fmt: skip
        self.content = UIContainer(pygame.Rect((0, 0), self.view.rect.size), ui.manager, container=self.view)
        bar_place = pygame.Rect(place.right - wide, place.top, wide, place.height)
        self.bar = ScrollBar(ui, bar_place, self.scroll_to, container)
        self.offset = 0.0
        self._height = place.height

    def set_height(self, height: int) -> None:
        """Say how high the content is [pixels]."""
        self._height = height
        self.content.set_dimensions((self.view.rect.width, max(height, self.view.rect.height)))
        self.scroll_to(self.offset)

    def scroll_to(self, offset: float) -> None:
        """Show the content from an offset [pixels] below its top, as far as there is one."""
        self.offset = min(max(offset, 0.0), max(0.0, float(self._height - self.view.rect.height)))
        if self.content.relative_rect.top != -round(self.offset):
            self.content.set_relative_position((0, -round(self.offset)))
        self.bar.show_place(self.offset, self._height, self.view.rect.height)

    @property
    def is_at_end(self) -> bool:
        """Whether it has been scrolled as far down as it goes."""
        return self._height > self.view.rect.height and self.offset >= self._height - self.view.rect.height - 1

    def turn(self, notches: float) -> None:
        """Move by notches of the wheel."""
        self.scroll_to(self.offset - notches * self._ui.px(WHEEL_STEP))

    def follow_focus(self) -> None:
        """Bring what has the keyboard into sight, once after each change of it."""
        focus = self._ui.focus
        if focus is self._revealed:
            return
        self._revealed = focus
        if focus is None or focus.ui_container is not self.content:
            return
        gap, place = self._ui.px(REVEAL_GAP), focus.relative_rect
        if place.top - gap < self.offset:
            self.scroll_to(place.top - gap)
        elif place.bottom + gap > self.offset + self.view.rect.height:
            self.scroll_to(place.bottom + gap - self.view.rect.height)

    def kill(self) -> None:
        """Take it away, with what was made in it by the widgets' own means."""
        self._ui.remove(self.bar)
        self.view.kill()
