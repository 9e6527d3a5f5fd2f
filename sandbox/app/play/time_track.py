"""TimeTrack: a line as long as the run is, with what happened on it, that the mouse goes back and forth on."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, SURFACE, TEXT, WARNING, mixed
from sandbox.app.run.travel import Mark, Travel
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pixel, Widget

# Layout units.
MARGIN, RAIL, KNOB = 10.0, 4.0, 6.5
# A mark answers to the mouse from this far [layout units].
NEAR = 5.0
# Ticks that the keyboard goes by with Shift.
LEAP = 60


class TimeTrack(Widget):
    """A rail from tick 0 to the last; go(tick) is called as the mouse drags on it, hold(held) as it takes and lets go.

    With Shift held a drag chooses the range. Shapes tell marks apart: lines are commands, triangles breaks, diamonds
    goals, flags bookmarks, forks branches.
    """

    is_focusable = True

    def __init__(
        self,
        ui: Ui,
        rect: pygame.Rect,
        travel: Travel,
        go: Callable[[int], object],
        hold: Callable[[bool], object],
        container: Any = None,
    ) -> None:
        super().__init__(ui, rect, container)
        self.travel, self._go, self._hold = travel, go, hold
        self.tick, self.length, self.reached = 0, 1, 0
        self.marks: list[Mark] = []
        # Where the mouse is over the track.
        self.pointed: int | None = None
        self._held = False
        self._span_from: int | None = None
        self._shown: tuple[object, ...] = ()

    def show_run(self, tick: int, length: int, reached: int, marks: list[Mark]) -> None:
        """Show where the run is, how long it is and how far it has been."""
        travel = self.travel
        fresh = (tick, length, reached, marks, travel.span, travel.looping, travel.target, self.pointed)
        if fresh != self._shown:
            self._shown = fresh
            self.tick, self.length, self.reached = tick, max(length, 1), reached
            # Bookmarks outlive a reset: the run comes to them.
            self.marks = [mark for mark in marks if mark.tick <= length]
            self.repaint()

    def pixel_of(self, tick: float) -> int:
        """Horizontal window position of a tick."""
        return self.rect.left + round(self._x_of(tick))

    def mark_near(self, tick: int) -> Mark | None:
        """The mark that lies nearest to where the mouse points, where one is near."""
        near = self.ui.px(NEAR)
        found = [(abs(self._x_of(mark.tick) - self._x_of(tick)), mark) for mark in self.marks]
        found = [entry for entry in found if entry[0] <= near]
        return min(found, key=lambda entry: entry[0])[1] if found else None

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Go where the mouse is while its button is held; with Shift choose a range."""
        tick = self._tick_at(at)
        if pygame.key.get_mods() & pygame.KMOD_SHIFT:
            self._span_from = tick
        else:
            self._held = True
            self._hold(True)
            mark = self.mark_near(tick)
            self._go(tick if mark is None else mark.tick)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Go to the tick under the mouse, or end the range there."""
        tick = self._tick_at(at)
        if self._held:
            self.pointed = tick
            self._go(tick)
        elif self._span_from is not None:
            self.travel.set_span(self._span_from, tick)

    def on_release(self, at: Pixel) -> None:
        """Let the knob go: the run stays at its tick."""
        if self._held:
            self._hold(False)
        self._held, self._span_from = False, None
        self.on_hover()

    def on_move(self, at: Pixel) -> None:
        """Take note of the tick under the mouse, of which the label tells."""
        self.pointed = self._tick_at(at)

    def on_hover(self) -> None:
        """Forget that tick once the mouse is elsewhere."""
        if not (self.hovered or self._held):
            self.pointed = None

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right go by a tick, with Shift by a second; Home and End to the ends."""
        step = LEAP if event.mod & pygame.KMOD_SHIFT else 1
        targets = {
            pygame.K_LEFT: self.tick - step,
            pygame.K_RIGHT: self.tick + step,
            pygame.K_HOME: 0,
            pygame.K_END: self.length,
        }
        if event.key not in targets:
            return False
        self._go(targets[event.key])
        return True

    def _x_of(self, tick: float) -> float:
        margin = self.ui.px(MARGIN)
        return margin + min(max(tick / self.length, 0.0), 1.0) * (self.rect.width - 2 * margin)

    def _tick_at(self, at: Pixel) -> int:
        margin = self.ui.px(MARGIN)
        share = (at[0] - self.rect.left - margin) / max(1, self.rect.width - 2 * margin)
        return round(min(max(share, 0.0), 1.0) * self.length)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The rail, the part of it that was reached, the range, the marks and the knob."""
        px, middle = self.ui.px, size[1] // 2
        surface = pygame.Surface(size, pygame.SRCALPHA)
        span = self.travel.span
        if span is not None and span[0] < self.length:
            left, right = (round(self._x_of(tick)) for tick in span)
            band = pygame.Rect(left, px(3), max(right - left, 2), size[1] - px(6))
            colour = ACCENT if self.travel.looping else MUTED
            pygame.draw.rect(surface, mixed(SURFACE, colour, 0.25), band, border_radius=px(3))
            pygame.draw.rect(surface, colour, band, 1, border_radius=px(3))
        self._rail(surface, self.length, LINE)
        self._rail(surface, self.reached, mixed(LINE, MUTED, 0.6))
        self._rail(surface, self.tick, ACCENT)
        for kind in ("command", "break", "goal", "branch", "bookmark"):
            for x in sorted({round(self._x_of(mark.tick)) for mark in self.marks if mark.kind == kind}):
                self._draw_mark(surface, kind, x, middle)
        if self.travel.target is not None:
            x = round(self._x_of(self.travel.target))
            pygame.draw.line(surface, ACCENT, (x, px(4)), (x, size[1] - px(5)), px(2))
        at = pygame.Vector2(self._x_of(self.tick), middle)
        pygame.draw.aacircle(surface, TEXT, at, px(KNOB))
        pygame.draw.aacircle(surface, ACCENT, at, px(KNOB) - px(2))
        return surface

    def _rail(self, surface: pygame.Surface, tick: int, colour: pygame.typing.ColorLike) -> None:
        px, left = self.ui.px, self._x_of(0)
        rail = pygame.Rect(left, surface.get_height() // 2 - px(RAIL) // 2, self._x_of(tick) - left, px(RAIL))
        pygame.draw.rect(surface, colour, rail, border_radius=px(RAIL) // 2)

    def _draw_mark(self, surface: pygame.Surface, kind: str, x: int, middle: int) -> None:
        px = self.ui.px
        if kind == "command":
            pygame.draw.line(surface, TEXT, (x, middle - px(9)), (x, middle - px(4)), px(1.5))
        elif kind == "break":
            top = middle + px(4)
            pygame.draw.polygon(surface, DANGER, [(x, top), (x - px(4), top + px(6)), (x + px(4), top + px(6))])
        elif kind == "goal":
            top, half = middle - px(14), px(4)
            pygame.draw.polygon(
                surface, ACCENT, [(x, top), (x + half, top + half), (x, top + 2 * half), (x - half, top + half)]
            )
        elif kind == "branch":
            pygame.draw.lines(surface, TEXT, False, [(x, middle), (x, middle + px(5)), (x + px(5), middle + px(10))])
            pygame.draw.line(surface, TEXT, (x, middle + px(5)), (x - px(4), middle + px(10)))
        else:
            top = middle - px(14)
            pygame.draw.line(surface, WARNING, (x, top), (x, middle - px(3)), px(1.5))
            pygame.draw.polygon(surface, WARNING, [(x, top), (x + px(8), top + px(3)), (x, top + px(6))])
