"""Slider: a coefficient on a scale up to 1, with the mark up to which it is proven stable, and its level's own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pygame

from sandbox.app.base.coefficient_scale import PLAIN, CoefficientScale
from sandbox.app.draw.colours import ACCENT, DECADE, LINE, MUTED, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Draggable, Pixel

# Part of the scale that an arrow key or a notch of the wheel moves, and with Shift held.
KEY_STEP, FINE_KEY_STEP = 0.02, 0.004
# Painted this many times larger and scaled down: smooth edges.
OVERSAMPLING = 3
MARGIN = 9.0


@dataclass(frozen=True)
class SliderState:
    """What a slider shows: a value, its limit (None: none is proven), the level's own value (None: there is none).

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
        """Whether there is anything to set."""
        return self.state.enabled

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._done()

    def on_wheel(self, notches: float) -> bool:
        """After a click on it, move by a fine step a notch."""
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
