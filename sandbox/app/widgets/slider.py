"""What is dragged to a value: a slider of a coefficient, a range of time, a dial of a strength and its way."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import pygame

from sandbox.app.base.sag_map import PLAIN, CoefficientScale
from sandbox.app.draw.colours import ACCENT, DECADE, DISABLED, FIELD, LINE, MUTED, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Draggable, Pixel, Widget

# Part of the scale that an arrow key or a notch of the wheel moves, and with Shift held.
KEY_STEP, FINE_KEY_STEP = 0.02, 0.004
# Painted this many times larger and scaled down: smooth edges.
OVERSAMPLING = 3
MARGIN = 9.0
# Shortest part that can be kept [s], and a step of the keyboard, with Ctrl a fine one.
SHORTEST = 0.5
_ENDS_STEP, _FINE_ENDS_STEP = 0.5, 0.1
_ENDS_MARGIN = 10.0
# Sizes of a dial in layout units: of the room around the circle, and of the knob.
_RIM_MARGIN, KNOB, HEAD = 3.0, 4.5, 6.0
# A drag so near [part of the radius] to a strength that is marked, and to a way along an axis, takes that.
NEAR = 0.09
# What an arrow key adds, and with Shift held, as parts of the whole.
_DIAL_STEP, _FINE_DIAL_STEP = 0.05, 0.005
Vector = tuple[float, float]


@dataclass(frozen=True)
class SliderState:
    """The values of a slider: the present one, its limit (None: none is proven), the level's own (None: there is none).

    is_mixed: the springs differ; enabled: there is anything to set.
    """

    value: float = 0.5
    limit: float | None = None
    own: float | None = None
    is_mixed: bool = False
    enabled: bool = True
    scale: CoefficientScale = PLAIN


class Slider(Draggable):
    """A slider; changed(value) is called as it moves and done() at the end of each drag or key press."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, changed: Callable[[float], None], done: Callable[[], None],
        container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.state = SliderState()
        self._changed, self._done = changed, done

    def show_state(self, state: SliderState) -> None:
        """Show another state."""
        if state != self.state:
            self.state = state
            self.repaint()

    def pixel_of(self, value: float) -> int:
        """Horizontal window position of a value."""
        margin = self.ui.px(MARGIN)
        return round(self.rect.left + margin + self.state.scale.place_of(value) * (self.rect.width - 2 * margin))

    def can_drag(self) -> bool:
        """Whether the slider can be dragged."""
        return self.state.enabled

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._done()

    def on_wheel(self, notches: float) -> bool:
        """Move by a fine step a notch, once the slider was clicked."""
        if not (self.in_hand and self.state.enabled):
            return False
        self._step(FINE_KEY_STEP * notches)
        return True

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right move by a step, with Shift by a fine one; Home and End go to the ends."""
        step = FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP
        moves = {
            pygame.K_LEFT: -step, pygame.K_RIGHT: step, pygame.K_DOWN: -step, pygame.K_UP: step,
            pygame.K_HOME: -1.0, pygame.K_END: 1.0,
        }  # fmt: skip
        if event.key not in moves or not self.state.enabled:
            return False
        self._step(moves[event.key])
        return True

    def _step(self, by: float) -> None:
        scale = self.state.scale
        self._changed(scale.value_at(min(max(scale.place_of(self.state.value) + by, 0.0), 1.0)))
        self._done()

    def on_drag(self, at: Pixel) -> None:
        """Set the value under the mouse."""
        margin = self.ui.px(MARGIN)
        place = (at[0] - self.rect.left - margin) / max(1, self.rect.width - 2 * margin)
        self._changed(self.state.scale.value_at(place))

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Track, values with numbers, the part beyond the limit in amber, marks and knob."""
        state, scale = self.state, self.ui.scale * OVERSAMPLING
        width, height = size[0] * OVERSAMPLING, size[1] * OVERSAMPLING
        surface = pygame.Surface((width, height), pygame.SRCALPHA)
        margin, middle = MARGIN * scale, height * 0.5
        length = width - 2 * margin
        thick = 4 * scale

        def bar(start: float, end: float, colour: Colour) -> None:
            place = pygame.Rect(margin + start * length, middle - thick / 2, max((end - start) * length, 1), thick)
            pygame.draw.rect(surface, colour, place, border_radius=round(thick / 2))

        def stroke(place: float, top: float, bottom: float, colour: Colour, wide: float) -> None:
            x = margin + place * length
            ends = (x, middle + top * scale), (x, middle + bottom * scale)
            pygame.draw.line(surface, colour, *ends, max(1, round(wide * scale)))

        accent = ACCENT if state.enabled else LINE
        for value in state.scale.numbers():
            stroke(state.scale.place_of(value), 7, 10, DECADE, 1.3)
        bar(0.0, 1.0, LINE)
        limited = state.limit is not None and state.limit < 1.0
        limit = state.scale.place_of(state.limit) if state.limit is not None else 1.0
        if limited:
            bar(limit, 1.0, mixed(LINE, WARNING, 0.45))
        here = state.scale.place_of(state.value)
        if not state.is_mixed:
            bar(0.0, here, accent)
            if limited and here > limit:
                bar(limit, here, WARNING)
        if limited:
            self._paint_mark(surface, margin + limit * length, middle, scale)
        if state.own is not None and state.enabled:
            stroke(state.scale.place_of(state.own), -9, 9, TEXT, 1.5)
        knob = (margin + here * length, middle)
        pygame.draw.circle(surface, TEXT if state.enabled else MUTED, knob, 7 * scale)
        inside = WARNING if limited and here > limit else accent
        pygame.draw.circle(surface, SURFACE if state.is_mixed else inside, knob, 4 * scale)
        return pygame.transform.smoothscale(surface, size)

    def _paint_mark(self, surface: pygame.Surface, x: float, middle: float, scale: float) -> None:
        tip, top = middle - 4 * scale, middle - 12 * scale
        pygame.draw.polygon(surface, WARNING, [(x - 4.5 * scale, top), (x + 4.5 * scale, top), (x, tip)])
        pygame.draw.line(surface, WARNING, (x, tip), (x, middle + 6 * scale), max(1, round(1.5 * scale)))


class RangeSlider(Widget):
    """Knobs at start and end [s] on a line from 0 to `length`; changed(start, end) is called as they move.

    moment: there is one knob, at the end.
    """

    is_focusable = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, length: float, changed: Callable[[float, float], None], container: Any = None
    ) -> None:
        super().__init__(ui, rect, container)
        self.length, self._changed = max(length, 1e-3), changed
        self.start, self.end, self.moment = 0.0, self.length, False
        self._held = "end"

    def show_range(self, start: float, end: float, moment: bool) -> None:
        """Show the range that is kept."""
        self.start, self.end, self.moment = start, end, moment
        self.repaint()

    def pixel_of(self, seconds: float) -> int:
        """Horizontal window position of a moment."""
        margin = self.ui.px(_ENDS_MARGIN)
        return round(self.rect.left + margin + seconds / self.length * (self.rect.width - 2 * margin))

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the nearer knob."""
        seconds = self._seconds_at(at)
        is_start = not self.moment and abs(seconds - self.start) < abs(seconds - self.end)
        self._held = "start" if is_start else "end"
        self._move(self._held, seconds)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Move the knob that was taken."""
        self._move(self._held, self._seconds_at(at))

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right move the start, with Shift the end; with Ctrl by less."""
        step = _FINE_ENDS_STEP if event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META) else _ENDS_STEP
        by = {pygame.K_LEFT: -step, pygame.K_RIGHT: step}.get(event.key)
        if by is None:
            return False
        knob = "end" if self.moment or event.mod & pygame.KMOD_SHIFT else "start"
        self._move(knob, (self.end if knob == "end" else self.start) + by)
        return True

    def _seconds_at(self, at: Pixel) -> float:
        margin = self.ui.px(_ENDS_MARGIN)
        return (at[0] - self.rect.left - margin) / max(1, self.rect.width - 2 * margin) * self.length

    def _move(self, knob: str, to: float) -> None:
        # A knob that is moved against the other stops before it.
        shortest = 0.0 if self.moment else min(SHORTEST, self.length)
        low, high = (0.0, self.end - shortest) if knob == "start" else (self.start + shortest, self.length)
        low = 0.0 if self.moment else low
        to = round(min(max(to, low), high), 2)
        start, end = (to, self.end) if knob == "start" else (self.start, to)
        self._changed(min(start, end), end)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """A track with the part that is kept, a mark for each second, and the knobs."""
        scale = self.ui.scale * OVERSAMPLING
        surface = pygame.Surface((size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), pygame.SRCALPHA)
        margin, middle = _ENDS_MARGIN * scale, surface.get_height() * 0.42
        length, thick = surface.get_width() - 2 * margin, 4 * scale

        def x_of(seconds: float) -> float:
            return margin + seconds / self.length * length

        def bar(start: float, end: float, colour: Colour) -> None:
            place = pygame.Rect(x_of(start), middle - thick / 2, max(x_of(end) - x_of(start), 1), thick)
            pygame.draw.rect(surface, colour, place, border_radius=round(thick / 2))

        second = self.length
        while second >= 0.0:
            x = x_of(second)
            pygame.draw.line(surface, DISABLED, (x, middle + 8 * scale), (x, middle + 12 * scale), round(1.5 * scale))
            second -= 1.0
        bar(0.0, self.length, LINE)
        if not self.moment:
            bar(self.start, self.end, ACCENT)
        for knob in (self.end,) if self.moment else (self.start, self.end):
            pygame.draw.circle(surface, TEXT, (x_of(knob), middle), 8 * scale)
            pygame.draw.circle(surface, ACCENT, (x_of(knob), middle), 5 * scale)
        return pygame.transform.smoothscale(surface, size)


class Dial(Draggable):
    """A dial up to a strength `full` at its rim; changed(x, y) is called as it moves, done() at the end of each drag.

    marks: strengths, each drawn as a ring, that a drag takes where it comes near one. What is stronger than `full` is
    shown at the rim.
    """

    def __init__(
        self, ui: Ui, rect: pygame.Rect, full: float, marks: Sequence[float], changed: Callable[[float, float], None],
        done: Callable[[], None], container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.value: Vector = (0.0, 0.0)
        self._full, self._marks = full, marks
        self._changed, self._done = changed, done

    def show_value(self, value: Vector) -> None:
        """Show another value."""
        if value != self.value:
            self.value = value
            self.repaint()

    @property
    def _radius(self) -> float:
        return min(self.rect.size) / 2 - self.ui.px(_RIM_MARGIN)

    def pixel_of(self, value: Vector) -> tuple[int, int]:
        """Where in the window the knob is for a value."""
        x, y = self._place_of(value)
        middle = self.rect.center
        return round(middle[0] + x * self._radius), round(middle[1] - y * self._radius)

    def _place_of(self, value: Vector) -> Vector:
        """Where the knob is for a value, in radii from the middle."""
        longest = max(math.hypot(*value), self._full)
        return value[0] / longest, value[1] / longest

    def on_drag(self, at: Pixel) -> None:
        """Set the value under the mouse, or a marked one near it."""
        x, y = ((at[0] - self.rect.centerx) / self._radius, (self.rect.centery - at[1]) / self._radius)
        x, y = (0.0 if abs(along) < NEAR else along for along in (x, y))
        pull = min(math.hypot(x, y), 1.0)
        strength = next((mark for mark in self._marks if abs(mark / self._full - pull) < NEAR), pull * self._full)
        length = math.hypot(x, y)
        self._set((x / length * strength, y / length * strength) if length else (0.0, 0.0))

    def _set(self, value: Vector) -> None:
        digits = 3 - math.floor(math.log10(self._full))
        x, y = (round(along, digits) + 0.0 for along in value)
        self._changed(x, y)

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows pull it their way by a step, with Shift by a fine one; Home sets it to nothing."""
        ways = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_DOWN: (0, -1), pygame.K_UP: (0, 1)}
        if event.key == pygame.K_HOME:
            self._set((0.0, 0.0))
        elif event.key in ways:
            step = self._full * (_FINE_DIAL_STEP if event.mod & pygame.KMOD_SHIFT else _DIAL_STEP)
            x, y = (along + way * step for along, way in zip(self.value, ways[event.key], strict=True))
            # It goes no further than the rim, unless it is there already.
            scale = min(1.0, max(self._full, math.hypot(*self.value)) / max(math.hypot(x, y), 1e-12))
            self._set((x * scale, y * scale))
        else:
            return False
        self._done()
        return True

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The circle, its rings, and an arrow from the middle to the knob."""
        scale = self.ui.scale * OVERSAMPLING
        surface = pygame.Surface((size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), pygame.SRCALPHA)
        middle, radius = surface.get_rect().center, self._radius * OVERSAMPLING
        pygame.draw.circle(surface, FIELD, middle, radius)
        thin = max(1, round(1.2 * scale))
        for mark in self._marks:
            if mark:
                pygame.draw.circle(surface, mixed(LINE, MUTED, 0.4), middle, radius * mark / self._full, thin)
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            inner, outer = ((middle[0] + dx * radius * part, middle[1] + dy * radius * part) for part in (0.88, 1.0))
            pygame.draw.line(surface, DECADE, inner, outer, thin)
        pygame.draw.circle(surface, mixed(LINE, MUTED, 0.4), middle, radius, thin)
        x, y = self._place_of(self.value)
        tip = middle[0] + x * radius, middle[1] - y * radius
        if x or y:
            pygame.draw.line(surface, ACCENT, middle, tip, round(2.2 * scale))
            pygame.draw.circle(surface, MUTED, middle, 1.8 * scale)
            self._paint_head(surface, tip, (x, -y), scale)
        else:
            pygame.draw.circle(surface, TEXT, middle, KNOB * scale)
            pygame.draw.circle(surface, SURFACE, middle, 0.55 * KNOB * scale)
        return pygame.transform.smoothscale(surface, size)

    def _paint_head(self, surface: pygame.Surface, tip: Vector, way: Vector, scale: float) -> None:
        turn, head = math.atan2(way[1], way[0]), HEAD * scale
        corners = [
            (tip[0] + head * math.cos(turn + by), tip[1] + head * math.sin(turn + by)) for by in (0.0, 2.3, -2.3)
        ]
        pygame.draw.polygon(surface, ACCENT, corners)
