"""FeelCurve: the curve of a thing that comes back, with a handle at its peak and one where it is still."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pygame

from sandbox.app.draw.colours import ACCENT, MENU, SURFACE, TEXT
from sandbox.app.graphs.chart import Axes, Chart, GraphLine
from sandbox.app.widgets.slider import FINE_KEY_STEP, KEY_STEP
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Draggable, Pixel
from sandbox.export.curves import points_of
from sandbox.export.feel import Feel, sentence
from sandbox.export.numbers import percent, short

# Sizes in layout units: of a handle, its arrow, and its words.
HANDLE, ARROW, WORDS, AWAY = 6.0, 5.0, 11.5, 14.0
# Tones and dashes of the lines: as it is now, what was found, and the single spring.
NOW, FOUND, SINGLE = (1, 0), (2, 0), (5, 2)
# How much more of the way and of the time is shown than the curve takes, for handles to be dragged there.
ABOVE, BEHIND, LEAST_ABOVE = 1.5, 1.7, 0.35
# Shortest span [s].
SHORTEST = 0.2
MOST_OVERSHOOT, LEAST_TICKS = 0.99, 3
# Size of a picture in a file [pixels], and pixels of a layout unit on it.
PICTURE, PICTURE_SCALE, PICTURE_TOP = (960, 520), 2.0, 30.0
UNIT = "%"


class CurveState(NamedTuple):
    """The cards of a thing as it is now and as it was found, and what is wanted of overshoot [1] and settling [s].

    None: there is none yet. tick: its length [s]. enabled: whether handles can be dragged.
    """

    now: Feel | None = None
    found: Feel | None = None
    wanted: tuple[float, float] | None = None
    tick: float = 1.0 / 60.0
    enabled: bool = False


def _lines_of(feel: Feel, name: str, style: tuple[int, int]) -> list[GraphLine]:
    """The curve of a card and its single spring as lines of a chart, in per cent of the way."""
    seconds = feel.released.tick * np.arange(len(feel.curve), dtype=np.float64)
    return [
        GraphLine(name, seconds, 100.0 * feel.curve, *style),
        GraphLine("one spring", seconds, 100.0 * feel.spring_curve, *SINGLE),
    ]


def _peak_of(feel: Feel) -> float:
    """When a curve is at its peak [s]; one without: halfway until it is still."""
    if feel.numbers.overshoot == 0.0:
        return 0.5 * feel.numbers.settling
    return feel.released.tick * float(np.argmax(feel.curve))


def curve_picture(feel: Feel) -> pygame.Surface:
    """The curve of a card as a picture for a file."""
    surface = pygame.Surface(PICTURE)
    surface.fill(tuple(SURFACE))
    top = round(PICTURE_TOP * PICTURE_SCALE)
    place = pygame.Rect(0, top, PICTURE[0] - top // 2, PICTURE[1] - top - top // 4)
    chart = Chart(surface, place, PICTURE_SCALE)
    chart.title(f"{feel.name}: {sentence(feel)}")
    chart.draw(_lines_of(feel, "measured", NOW), (0.0, _span(feel)), UNIT, from_zero=True)
    return surface


def _span(feel: Feel) -> float:
    return max(float(points_of(feel)[-1, 0]), SHORTEST)


class FeelCurve(Draggable):
    """The chart; changed(overshoot, settling) is called as a handle is dragged, done() as it is let go."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, changed: Callable[[float, float], None], done: Callable[[], None],
        container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.state = CurveState()
        self._changed, self._done = changed, done
        self._axes: Axes | None = None
        self._held = ""
        # What is shown of time and way, which stays while a handle is dragged.
        self._span, self._heights = (0.0, 1.0), (0.0, 140.0)

    def show_state(self, state: CurveState) -> None:
        """Show other lines, or what is wanted elsewhere."""
        if state != self.state:
            self.state = state
            if not self._held:
                self._fit()
            self.repaint()

    def _fit(self) -> None:
        overshoot, settling = self.state.wanted or (0.0, 0.0)
        curves = [feel.curve for feel in self.state[:2] if feel is not None]
        top = max([float(curve.max()) - 1.0 for curve in curves] + [overshoot])
        low = 100.0 * min([float(curve.min()) for curve in curves] + [0.0])
        self._span = 0.0, max(BEHIND * settling, SHORTEST)
        self._heights = low - 4.0, 100.0 + 100.0 * max(ABOVE * top, LEAST_ABOVE)

    def handles(self) -> dict[str, tuple[float, float]]:
        """Where the handles are [pixels from the widget's corner], by "peak" and "still"; none before a measure."""
        shown = self.state.found or self.state.now
        if self._axes is None or self.state.wanted is None or shown is None or not self.state.enabled:
            return {}
        overshoot, settling = self.state.wanted
        inside = self._axes.inside
        x = min(self._axes.x_of(_peak_of(shown)), inside.right - self.ui.px(3 * AWAY))
        still = min(self._axes.x_of(settling), inside.right - 1), self._axes.y_of(100.0)
        return {"peak": (x, self._axes.y_of(100.0 + 100.0 * overshoot)), "still": still}

    # Mouse and keys.

    def can_drag(self) -> bool:
        """Whether there are handles."""
        return bool(self.handles())

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Take the nearer handle."""
        x, y = at[0] - self.rect.left, at[1] - self.rect.top
        places = self.handles()
        if places:
            self._held = min(places, key=lambda name: np.hypot(places[name][0] - x, places[name][1] - y))
        return super().on_press(at, clicks)

    def on_drag(self, at: Pixel) -> None:
        """Want the overshoot at the height of the mouse, or the settling below it."""
        if self._axes is None or self.state.wanted is None:
            return
        overshoot, settling = self.state.wanted
        seconds, way = self._axes.at(at[0] - self.rect.left, at[1] - self.rect.top)
        if self._held == "peak":
            self._want(min(way, self._heights[1]) / 100.0 - 1.0, settling)
        else:
            self._want(overshoot, min(seconds, self._span[1]))

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._held = ""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Up and down move the peak, left and right where it is still, by a step; with Shift by a fine one."""
        ways = {pygame.K_UP: (1, 0), pygame.K_DOWN: (-1, 0), pygame.K_RIGHT: (0, 1), pygame.K_LEFT: (0, -1)}
        if event.key not in ways or self.state.wanted is None or not self.state.enabled:
            return False
        step = FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP
        (up, right), (overshoot, settling) = ways[event.key], self.state.wanted
        self._want(overshoot + up * step, settling + right * step * self._span[1])
        self._done()
        return True

    def _want(self, overshoot: float, settling: float) -> None:
        overshoot = min(max(overshoot, 0.0), MOST_OVERSHOOT)
        self._changed(round(overshoot, 3), round(max(settling, LEAST_TICKS * self.state.tick), 3))

    # Painting.

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The lines, and the handles with what is wanted beside them."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        surface.fill(tuple(MENU))
        chart = Chart(surface, surface.get_rect(), self.ui.scale)
        lines = [] if self.state.now is None else _lines_of(self.state.now, "now", NOW)
        if self.state.found is not None:
            lines = [*_lines_of(self.state.found, "found", FOUND), *lines[:1]]
        self._axes = chart.draw(lines, self._span, UNIT, heights=self._heights)
        if self.state.wanted is None:
            return surface
        overshoot, settling = self.state.wanted
        for name, place in self.handles().items():
            self._paint_handle(surface, place, name == "peak")
            text = percent(overshoot) if name == "peak" else f"{short(settling)} s"
            words = self.ui.font(WORDS, True).render(text, True, TEXT)
            beside = words.get_rect(midleft=(place[0] + self.ui.px(AWAY), place[1] - self.ui.px(AWAY)))
            surface.blit(words, beside.clamp(self._axes.inside))
        return surface

    def _paint_handle(self, surface: pygame.Surface, place: tuple[float, float], is_upright: bool) -> None:
        px = self.ui.px
        pygame.draw.aacircle(surface, SURFACE, place, px(HANDLE) + max(1, px(1.5)))
        pygame.draw.aacircle(surface, ACCENT, place, px(HANDLE))
        near, along, across = px(HANDLE + 3), px(HANDLE + 3 + ARROW), px(ARROW)
        for sign in (-1, 1):
            points = [(sign * along, 0), (sign * near, -across), (sign * near, across)]
            moved = [(y, x) if is_upright else (x, y) for x, y in points]
            pygame.draw.polygon(surface, ACCENT, [(place[0] + x, place[1] + y) for x, y in moved])
