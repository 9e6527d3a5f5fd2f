"""ScrollArea: widgets on a page that is higher than its place, moved by wheel, scroll bar, keys and Tab."""

from collections.abc import Callable

import pygame

from sandbox.app.draw.colours import ACCENT, LINE
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pixel, Widget

# Sizes in layout units: width of a scroll bar, its shortest thumb, way of a notch of the wheel and of an arrow key.
BAR_WIDTH = 10.0
SHORTEST_THUMB = 26.0
WHEEL_STEP = 64.0
KEY_STEP = 40.0
# What has the keyboard is kept this far from the edges.
REVEAL_GAP = 12.0


class ScrollBar(Widget):
    """A bar at the right of something high; scrolled(offset) [pixels] is called when the person moves it."""

    is_focusable = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, scrolled: Callable[[float], None], parent: Widget | None = None
    ) -> None:
        super().__init__(ui, rect, parent)
        self.offset, self.height, self.page = 0.0, 1, 1
        self._scrolled = scrolled
        self._grip: float | None = None

    def show_place(self, offset: float, height: int, page: int) -> None:
        """Show which part of the whole height is seen; all of it: no bar."""
        if (offset, height, page) != (self.offset, self.height, self.page):
            self.offset, self.height, self.page = offset, height, page
            self.repaint()
        # Without anything to scroll, Tab passes it by.
        self.is_enabled = self.needed

    @property
    def needed(self) -> bool:
        """Whether the content is higher than its view."""
        return self.height > self.page

    def _thumb(self) -> tuple[float, float]:
        """Top and height of the thumb [pixels]."""
        tall = self.rect.height
        size = min(max(tall * self.page / max(self.height, 1), self.ui.px(SHORTEST_THUMB)), tall)
        return (tall - size) * self.offset / max(self.height - self.page, 1), size

    def paint(self, size: tuple[int, int]) -> pygame.Surface | None:
        """The thumb alone, where the content is higher than its view."""
        if not self.needed:
            return None
        surface = pygame.Surface(size, pygame.SRCALPHA)
        (top, height), wide = self._thumb(), self.ui.px(5)
        place = pygame.Rect(size[0] - wide - self.ui.px(1), round(top), wide, round(height))
        pygame.draw.rect(surface, ACCENT if self._grip is not None else LINE, place, border_radius=wide // 2)
        return surface

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the thumb; a press beside it moves by a page."""
        if not self.needed:
            return False
        top, height = self._thumb()
        y = at[1] - self.rect.top
        if top <= y <= top + height:
            self._grip = y - top
            self.repaint()
        else:
            self._scrolled(self.offset + (self.page if y > top else -self.page))
        return True

    def on_drag(self, at: Pixel) -> None:
        """Scroll by the thumb."""
        if self._grip is not None:
            travel = max(self.rect.height - self._thumb()[1], 1.0)
            self._scrolled((at[1] - self.rect.top - self._grip) / travel * (self.height - self.page))

    def on_release(self, at: Pixel) -> None:
        """Release the thumb."""
        self._grip = None
        self.repaint()

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


class _View(Widget):
    """The visible part; the wheel over it scrolls, and it follows the keyboard."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, scroll_by: Callable[[float], None], show_widget: Callable[[Widget], None],
        parent: Widget | None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, parent)
        self._scroll_by, self._show_widget = scroll_by, show_widget

    def reveal(self, widget: Widget) -> None:
        """Scroll to a widget inside."""
        self._show_widget(widget)

    def on_wheel(self, notches: float) -> bool:
        """Scroll by notches of the wheel."""
        self._scroll_by(notches)
        return True


class ScrollArea:
    """A place [pixels] in which `content`, which holds widgets, moves up and down."""

    def __init__(self, ui: Ui, place: pygame.Rect, parent: Widget | None = None) -> None:
        self._ui = ui
        wide = ui.px(BAR_WIDTH)
        bar_place = pygame.Rect(place.right - wide, place.top, wide, place.height)
        self.bar = ScrollBar(ui, bar_place, self.scroll_to, parent)
        view = pygame.Rect(place.topleft, (place.width - wide, place.height))
        self.view = _View(ui, view, self.scroll_by, self.show_widget, parent)
        self.content = Widget(ui, pygame.Rect((0, 0), self.view.rect.size), self.view)
        self.offset = 0.0
        self._height = place.height

    def set_height(self, height: int) -> None:
        """Say how high the content is [pixels]."""
        self._height = height
        self.content.resize((self.view.rect.width, max(height, self.view.rect.height)))
        self.scroll_to(self.offset)

    def scroll_to(self, offset: float) -> None:
        """Show the content from an offset [pixels] below its top, as far as there is one."""
        self.offset = min(max(offset, 0.0), max(0.0, float(self._height - self.view.rect.height)))
        self.content.move_to((0, -round(self.offset)))
        self.bar.show_place(self.offset, self._height, self.view.rect.height)

    @property
    def is_at_end(self) -> bool:
        """Whether the area is scrolled to its end."""
        return self._height > self.view.rect.height and self.offset >= self._height - self.view.rect.height - 1

    def scroll_by(self, notches: float) -> None:
        """Scroll by notches of the wheel."""
        self.scroll_to(self.offset - notches * self._ui.px(WHEEL_STEP))

    def show_widget(self, widget: Widget) -> None:
        """Scroll to a widget inside."""
        gap = self._ui.px(REVEAL_GAP)
        top, bottom = (edge - self.content.rect.top for edge in (widget.rect.top, widget.rect.bottom))
        if top - gap < self.offset:
            self.scroll_to(top - gap)
        elif bottom + gap > self.offset + self.view.rect.height:
            self.scroll_to(bottom + gap - self.view.rect.height)

    def remove(self) -> None:
        """Remove the area with its content."""
        self.bar.remove()
        self.view.remove()
