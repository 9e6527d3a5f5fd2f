"""Chart: lines over time with axes, their names at their ends, and the values at a cursor."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import DECADE, FIELD, LINE, MATERIAL_COLOURS, MUTED, NOTICE, TEXT, Colour, packed
from sandbox.app.draw.lines import Canvas
from sandbox.app.widgets.fonts import plain_font

# Sizes in layout units: letters, what stands at the left and below, samples of lines, and how thick lines are.
TEXT_SIZE, LEFT, BOTTOM, TOP, SAMPLE, WIDTH = 11.0, 54.0, 18.0, 6.0, 18.0, 1.8
# Room for the names at the right, as a share of the width at most.
NAMES_SHARE = 0.3
# Lines of a grid: no nearer to each other than this.
GRID_X, GRID_Y = 84.0, 26.0
# Dashes of a line, on and off [layout units]; a whole line first. Neighbours differ in these as in colour.
DASHES = ((1.0, 0.0), (9.0, 4.0), (3.0, 3.0), (14.0, 3.0), (6.0, 8.0), (2.0, 5.0))

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GraphLine:
    """A line: its name, places in time [s] and values (k,), and the numbers of its colour and its dashes."""

    name: str
    seconds: Floats
    values: Floats
    tone: int
    style: int

    @property
    def colour(self) -> Colour:
        """Its colour in the theme that is shown."""
        return MATERIAL_COLOURS[self.tone % len(MATERIAL_COLOURS)]

    @property
    def dashes(self) -> tuple[float, float]:
        """Its dashes, on and off [layout units]."""
        return DASHES[self.style % len(DASHES)]


class Axes(NamedTuple):
    """Where a chart has drawn: inside [pixels], over a span of time [s], from the lowest value to the highest."""

    inside: pygame.Rect
    span: tuple[float, float]
    heights: tuple[float, float]

    def x_of(self, seconds: Any) -> Any:
        """Where a time is [pixels]; or times, as an array."""
        start, end = self.span
        return self.inside.left + (seconds - start) / (end - start) * (self.inside.width - 1)

    def y_of(self, value: Any) -> Any:
        """Where a value is [pixels]; or values, as an array."""
        low, high = self.heights
        return self.inside.bottom - 1 - (value - low) / (high - low) * (self.inside.height - 1)

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Time [s] and value at a pixel."""
        (start, end), (low, high), inside = self.span, self.heights, self.inside
        seconds = start + (x - inside.left) / (inside.width - 1) * (end - start)
        return seconds, low + (inside.bottom - 1 - y) / (inside.height - 1) * (high - low)


def nice_step(span: float, most: float) -> float:
    """The smallest of 1, 2 and 5 times a power of ten that divides a span into at most this many parts."""
    least = span / max(most, 1.0)
    if not (np.isfinite(least) and least > 1e-300):
        return 1.0
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least * (1.0 - 1e-9)))


def number_text(value: float, step: float) -> str:
    """A number of a scale with the digits that its step has."""
    if abs(value) >= 1e6 or step < 1e-4:
        return f"{value:.3g}"
    digits = max(0, int(-np.floor(np.log10(step) + 1e-9)))
    return f"{value + 0.0:,.{digits}f}"


class Chart:
    """Draws lines into a place [pixels] of a surface; scale: pixels of a layout unit."""

    def __init__(self, surface: pygame.Surface, place: pygame.Rect, scale: float) -> None:
        self._surface, self._place, self._scale = surface, place, scale
        self._font = plain_font(self._px(TEXT_SIZE), False)
        self._bold = plain_font(self._px(TEXT_SIZE), True)

    def _px(self, units: float) -> int:
        return round(units * self._scale)

    def title(self, text: str) -> None:
        """Write a line above the chart."""
        picture = self._bold.render(text, True, TEXT)
        left, top = self._place.left + self._px(LEFT), self._place.top - self._px(TOP)
        self._surface.blit(picture, picture.get_rect(bottomleft=(left, top)))

    def draw(
        self, lines: Sequence[GraphLine], span: tuple[float, float], unit: str, *, from_zero: bool = False,
        cursor: float | None = None, now: float | None = None, hint: str = "",
        heights: tuple[float, float] | None = None,
    ) -> Axes:  # fmt: skip
        """Draw lines over a span of time [s]; cursor: pixel from the left whose values are shown; now: a mark [s].

        hint: what is said where there is no line. heights: the lowest value and the highest; None: those of the lines.
        """
        names = max((self._bold.size(line.name)[0] for line in lines), default=0) + self._px(SAMPLE + 14)
        names = min(names, round(NAMES_SHARE * self._place.width)) if lines else self._px(8)
        inside = pygame.Rect(
            self._place.left + self._px(LEFT), self._place.top + self._px(TOP),
            max(20, self._place.width - self._px(LEFT) - names), max(20, self._place.height - self._px(TOP + BOTTOM)),
        )  # fmt: skip
        pygame.draw.rect(self._surface, FIELD, inside, border_radius=self._px(4))
        axes = Axes(inside, span, heights or _range(lines, from_zero))
        self._draw_grid(axes, unit)
        if not lines:
            text = self._font.render(hint, True, MUTED)
            self._surface.blit(text, text.get_rect(center=inside.center).clamp(inside))
            return axes
        clip = self._surface.get_clip()
        self._surface.set_clip(inside.clip(clip))
        for line in reversed(lines):
            self._draw_line(line, axes)
        self._surface.set_clip(clip)
        if now is not None and span[0] <= now <= span[1]:
            x = axes.x_of(now)
            pygame.draw.line(self._surface, TEXT, (x, inside.top), (x, inside.bottom - 1))
        self._draw_names(lines, axes)
        if cursor is not None and inside.left <= cursor < inside.right:
            self._draw_cursor(lines, axes, cursor, unit)
        return axes

    def _draw_grid(self, axes: Axes, unit: str) -> None:
        inside, (start, end), (low, high) = axes
        step = nice_step(high - low, inside.height / self._px(GRID_Y))
        for value in np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step:
            y = axes.y_of(value)
            colour = DECADE if abs(value) < 1e-9 * step else LINE
            pygame.draw.line(self._surface, colour, (inside.left, y), (inside.right - 1, y))
            text = self._font.render(number_text(float(value), step), True, MUTED)
            place = text.get_rect(midright=(inside.left - self._px(5), y))
            self._surface.blit(text, place.clamp(self._place))
        title = self._bold.render(unit, True, TEXT)
        self._surface.blit(title, title.get_rect(bottomleft=(self._place.left + self._px(4), self._place.bottom)))
        step = nice_step(end - start, inside.width / self._px(GRID_X))
        for value in np.arange(np.ceil(start / step), np.floor(end / step) + 1) * step:
            x = axes.x_of(value)
            pygame.draw.line(self._surface, LINE, (x, inside.top), (x, inside.bottom - 1))
            text = self._font.render(f"{number_text(float(value), step)} s", True, MUTED)
            place = text.get_rect(midtop=(x, inside.bottom + self._px(1)))
            if place.left > inside.left - self._px(20) and place.right < self._place.right:
                self._surface.blit(text, place)

    def _draw_line(self, line: GraphLine, axes: Axes) -> None:
        inside, good = axes.inside, np.isfinite(line.values)
        x, y = axes.x_of(line.seconds), axes.y_of(line.values)
        y = np.clip(np.where(good, y, 0.0), inside.top - inside.height, inside.bottom + inside.height)
        x, y, good = _thinned(x, y, good, 2 * inside.width)
        joined = good[:-1] & good[1:]
        on, off = (self._scale * part for part in line.dashes)
        ends = np.stack([x[:-1], y[:-1], x[1:], y[1:]], axis=1)[joined]
        if off > 0.0:
            ends = _dashed(ends, on, off)
        if len(ends):
            colours = np.full(len(ends), packed(line.colour), dtype=np.int64)
            Canvas(self._surface).lines(ends, colours, WIDTH * self._scale)

    def _draw_names(self, lines: Sequence[GraphLine], axes: Axes) -> None:
        """Draw the name of each line at the right, at the height of its end, or as near as the others leave it."""
        inside, _, heights = axes
        tall = self._bold.get_linesize()
        ends = []
        for line in lines:
            good = np.flatnonzero(np.isfinite(line.values))
            value = float(line.values[good[-1]]) if len(good) else heights[0]
            ends.append((axes.y_of(min(max(value, heights[0]), heights[1])), line))
        ends.sort(key=lambda end: end[0])
        tops = _apart([y - tall / 2 for y, _ in ends], tall, self._place.top, inside.bottom)
        x = inside.right + self._px(5)
        for top, (_, line) in zip(tops, ends, strict=True):
            middle = top + tall / 2
            self._draw_sample(line, x, middle)
            text = self._bold.render(line.name, True, line.colour)
            width = max(1, self._place.right - x - self._px(SAMPLE + 5))
            self._surface.blit(text, (x + self._px(SAMPLE + 4), round(top)), (0, 0, width, text.get_height()))

    def _draw_sample(self, line: GraphLine, x: float, y: float) -> None:
        """Draw a piece of a line as a sample of its colour and dashes."""
        on, off = line.dashes
        start = 0.0
        while start < SAMPLE:
            end = min(start + on, SAMPLE) if off > 0.0 else SAMPLE
            ends = np.array([[x + start * self._scale, y, x + end * self._scale, y]])
            Canvas(self._surface).lines(ends, np.array([packed(line.colour)]), (WIDTH + 0.4) * self._scale)
            start = end + off if off > 0.0 else SAMPLE

    def _draw_cursor(self, lines: Sequence[GraphLine], axes: Axes, cursor: float, unit: str) -> None:
        """Draw a line at the cursor, a dot on every line there, and the values on a card."""
        inside, (seconds, _) = axes.inside, axes.at(cursor, 0.0)
        times = np.concatenate([line.seconds for line in lines])
        at = float(times[np.argmin(np.abs(times - seconds))])
        x = axes.x_of(at)
        pygame.draw.line(self._surface, TEXT, (x, inside.top), (x, inside.bottom - 1))
        rows: list[tuple[GraphLine, float]] = []
        for line in lines:
            value = float(line.values[int(np.argmin(np.abs(line.seconds - at)))])
            if np.isfinite(value):
                rows.append((line, value))
                y = axes.y_of(value)
                if inside.top <= y <= inside.bottom:
                    pygame.draw.aacircle(self._surface, FIELD, (x, y), self._px(4))
                    pygame.draw.aacircle(self._surface, line.colour, (x, y), self._px(3))
        texts: list[tuple[GraphLine | None, pygame.Surface]] = [(None, self._bold.render(f"{at:.2f} s", True, TEXT))]
        texts += [(line, self._font.render(f"{line.name}  {value:.4g} {unit}", True, TEXT)) for line, value in rows]
        wide = max(text.get_width() for _, text in texts) + self._px(SAMPLE + 20)
        tall = self._font.get_linesize()
        card = pygame.Rect(0, 0, wide, tall * len(texts) + self._px(10))
        card.midleft = (round(x) + self._px(10), inside.centery)
        if card.right > self._place.right:
            card.right = round(x) - self._px(10)
        card.clamp_ip(self._place)
        pygame.draw.rect(self._surface, NOTICE, card, border_radius=self._px(6))
        pygame.draw.rect(self._surface, LINE, card, 1, border_radius=self._px(6))
        for row, (of, text) in enumerate(texts):
            y = card.top + self._px(5) + row * tall
            if of is not None:
                self._draw_sample(of, card.left + self._px(7), y + tall / 2)
            left = card.left + self._px(7 if of is None else SAMPLE + 12)
            self._surface.blit(text, (left, y))


def _dashed(ends: Floats, on: float, off: float) -> Floats:
    """The dashes, of these lengths [pixels], of segments (m, 4) along them; long segments are cut."""
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    pieces = np.maximum(1, np.ceil(lengths / min(on, off)).astype(np.int64))
    owner = np.repeat(np.arange(len(ends)), pieces)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    start, part = place / pieces[owner], 1.0 / pieces[owner]
    along = (np.cumsum(lengths) - lengths)[owner] + (start + 0.5 * part) * lengths[owner]
    way = ends[owner, 2:] - ends[owner, :2]
    first = ends[owner, :2] + start[:, None] * way
    cut = np.concatenate([first, first + part[:, None] * way], axis=1)
    return np.asarray(cut[np.mod(along, on + off) < on])


def _range(lines: Sequence[GraphLine], from_zero: bool) -> tuple[float, float]:
    """The values from the lowest to the highest, with some room."""
    parts = [line.values[np.isfinite(line.values) & (np.abs(line.values) < 1e30)] for line in lines]
    values = np.concatenate(parts) if parts else np.zeros(0)
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    low = min(low, 0.0) if from_zero else low
    margin = 0.06 * (high - low)
    if margin <= 1e-9 * max(abs(low), abs(high)):
        margin = max(0.05 * abs(high), 1e-9)
    return (low if from_zero and low == 0.0 else low - margin), high + margin


def _thinned(x: Floats, y: Floats, good: NDArray[np.bool_], most: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """At most about this many points: of neighbours the lowest and the highest, so that no peak is lost."""
    if len(x) <= most:
        return x, y, good
    size = 2 * -(-len(x) // most)
    whole = len(x) // size * size
    blocks = np.where(good, y, np.nan)[:whole].reshape(-1, size)
    kept = ~np.isnan(blocks).all(axis=1)
    filled = np.where(np.isnan(blocks), np.inf, blocks), np.where(np.isnan(blocks), -np.inf, blocks)
    picked = np.sort(np.stack([filled[0].argmin(axis=1), filled[1].argmax(axis=1)], axis=1), axis=1)
    places = (picked + np.arange(len(blocks))[:, None] * size)[kept].ravel()
    places = np.concatenate([places, np.arange(whole, len(x))])
    return x[places], y[places], good[places]


def _apart(tops: list[float], tall: float, first: float, last: float) -> list[float]:
    """Places from the top down, moved so that none covers another, within bounds where there is room."""
    placed: list[float] = []
    for top in tops:
        placed.append(max(top, first, placed[-1] + tall if placed else first))
    limit = last
    for k in range(len(placed) - 1, -1, -1):
        limit -= tall
        placed[k] = max(min(placed[k], limit), first)
        limit = placed[k]
    return placed
