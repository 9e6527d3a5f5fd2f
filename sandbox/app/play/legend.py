"""Legend: a card in a corner of the world that says what overlays show, and by which scale."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.app.draw.colours import Colour, Theme, packed
from sandbox.app.draw.lines import Canvas
from sandbox.app.draw.overlays import (
    ARROW,
    BAR,
    DOT,
    FULL_STRAIN,
    POINT,
    SLIGHT_STRAIN,
    ZONES,
    Overlays,
    stability_tones,
    strain_tones,
)
from sandbox.app.play.hand_labels import newtons
from sandbox.app.widgets.fonts import plain_font
from sandbox.app.widgets.texts import line_height, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.physics.solvers import SOLVERS

# Sizes in layout units: of the card and its rows, and of what stands beside their words.
MARGIN, PADDING, ROW, SAMPLE, TEXT_SIZE, CORNER = 12.0, 10.0, 19.0, 60.0, 12.0, 8.0
RAMP = 7.0
OPACITY = 225
# How much of a world's width and height it takes, where it can be made as small as this for that.
SHARE, SMALLEST = (0.5, 0.6), 0.8
# Lines that words wrap to.
MOST_LINES = 4

Draw = Callable[["_Sample"], None]


@dataclass(frozen=True)
class _Sample:
    """The place of a sample: left edge, middle, width [pixels]; px: pixels of layout units."""

    canvas: Canvas
    x: float
    y: float
    width: float
    scale: float
    theme: Theme

    def line(self, x0: float, y0: float, x1: float, y1: float, colour: Colour, width: float) -> None:
        """Draw a line between places in layout units from the left edge and the middle."""
        k = self.scale
        ends = [[self.x + x0 * k, self.y + y0 * k, self.x + x1 * k, self.y + y1 * k]]
        self.canvas.lines(np.array(ends), np.array([packed(colour)]), width * k)

    def disc(self, x: float, radius: float, colour: Colour) -> None:
        """Draw a disc in the middle."""
        at = np.array([[self.x + x * self.scale, self.y]])
        self.canvas.discs(at, np.array([radius * self.scale]), np.array([packed(colour)]))

    def ramp(self, tones: np.ndarray) -> None:
        """Colours (width,) from left to right."""
        height = RAMP * self.scale
        x = self.x + np.arange(len(tones)) + 0.5
        ends = np.stack([x, np.full_like(x, self.y - height / 2), x, np.full_like(x, self.y + height / 2)], axis=1)
        self.canvas.lines(ends, tones.astype(np.int64), 1.2)


class Legend:
    """Draws the card; it is painted again where what it says has changed."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._card: pygame.Surface | None = None

    def draw(
        self, surface: pygame.Surface, ui: Ui, overlays: Overlays, theme: Theme, solver: str, area: pygame.Rect
    ) -> None:
        """Draw it in the upper right corner of an area [pixels], if anything is shown."""
        rows = rows_of(overlays, solver)
        area = area.inflate(-2 * ui.px(MARGIN), -2 * ui.px(MARGIN))
        if not rows or area.width < ui.px(SAMPLE) or area.height < ui.px(ROW):
            return
        key = (tuple(text for text, _ in rows), theme.name, ui.scale, area.size)
        if key != self._key or self._card is None:
            self._key, self._card = key, _fitted(ui.scale, rows, theme, area.size)
        surface.blit(self._card, self._card.get_rect(topright=area.topright))


def _fitted(scale: float, rows: list[tuple[str, Draw]], theme: Theme, area: tuple[int, int]) -> pygame.Surface:
    """The card, smaller where it would take much of an area [pixels].

    Words that have no room on a line there wrap; rows that have none are left out, and counted.
    """
    card = _painted(scale, rows, theme)
    shrink = min(part * most / is_ for part, most, is_ in zip(SHARE, area, card.get_size(), strict=True))
    if shrink < 1.0:
        scale *= max(shrink, SMALLEST)
        card = _painted(scale, rows, theme, area[0])
    kept = len(rows)
    while card.get_height() > area[1] and kept > 0:
        kept -= 1
        card = _painted(scale, [*rows[:kept], (f"and {len(rows) - kept} more", _nothing)], theme, area[0])
    return card


def _painted(scale: float, rows: list[tuple[str, Draw]], theme: Theme, most: int = 10_000) -> pygame.Surface:
    """The card with all rows, at most `most` wide [pixels]."""
    font, line, gap = plain_font(round(TEXT_SIZE * scale), False), round(ROW * scale), round(4.0 * scale)
    inset, sample, step = round(PADDING * scale), round(SAMPLE * scale), line_height(font)
    widest = max(most - sample - 3 * inset, 1)
    texts = [
        [font.render(each, True, theme.text) for each in wrapped(text, font, widest, MOST_LINES)] for text, _ in rows
    ]
    highs = [line + (len(lines) - 1) * step for lines in texts]
    wide = min(max(text.get_width() for lines in texts for text in lines), widest) + sample + 3 * inset
    size = wide, sum(highs) + 2 * inset - gap
    card = pygame.Surface(size, 0, 32)
    card.fill(theme.card)
    canvas, y = Canvas(card), inset
    for lines, high, (_, draw) in zip(texts, highs, rows, strict=True):
        draw(_Sample(canvas, inset, y + (high - gap) / 2, sample, scale, theme))
        for number, text in enumerate(lines):
            middle = y + (line - gap) / 2 + number * step
            card.blit(text, (sample + 2 * inset, round(middle - text.get_height() / 2)))
        y += high
    result = pygame.Surface(size, pygame.SRCALPHA)
    corner = round(CORNER * scale)
    pygame.draw.rect(result, (255, 255, 255, OPACITY), result.get_rect(), border_radius=corner)
    result.blit(card, (0, 0), special_flags=pygame.BLEND_RGB_MULT)
    pygame.draw.rect(result, theme.line, result.get_rect(), 1, border_radius=corner)
    return result


def rows_of(overlays: Overlays, solver: str) -> list[tuple[str, Draw]]:
    """The legend's rows: words for everything that is shown, and how to draw its sample."""
    rows: list[tuple[str, Draw]] = []
    shown = overlays.shown
    if "lattice" in shown:
        rows += [
            ("strain: squeezed, at rest, stretched", _strain),
            ("yielded (bent for good)", _yielded),
            ("broke here", _broke),
        ]
    if "particles" in shown:
        rows += [("particle, with its radius", _particle), ("held", _held)]
    if "contacts" in shown:
        rows.append(("contact and its normal; hollow: it does not push", _contact))
    if "forces" in shown:
        if overlays.contact.value:
            rows.append((f"contact pushes with {newtons(overlays.contact.value)}", _force))
        if overlays.spring.value:
            rows.append((f"spring pulls with {newtons(overlays.spring.value)}; hollow: it pushes", _bars))
    if "velocities" in shown:
        rows.append((f"moves at {overlays.velocity.value:g} m/s", _velocity))
    if ZONES in shown:
        rows.append(("zone, with its name", _zone))
    if "stability" in shown:
        kind = SOLVERS[solver]
        if kind.bounded:
            rows += [("stable: energy never grows", _calm), ("stable: Cs above Cd, at most four times", _near)]
        else:
            of = "proven limit" if kind.proven_limit else "limit of a single pass, no proof for this solver"
            rows += [(f"share of the {of}", _stability), ("beyond it", _past)]
    return rows


def _nothing(sample: _Sample) -> None:
    """Words alone."""


def _strain(sample: _Sample) -> None:
    place = np.linspace(-1.0, 1.0, round(sample.width))
    full = np.log1p(FULL_STRAIN / SLIGHT_STRAIN)
    strain = np.sign(place) * np.expm1(np.abs(place) * full) * SLIGHT_STRAIN
    sample.ramp(strain_tones(strain, sample.theme.strain))


def _yielded(sample: _Sample) -> None:
    for k in range(3):
        sample.line(4 + 20 * k, 0, 14 + 20 * k, 0, sample.theme.strain[2], 3.0)


def _broke(sample: _Sample) -> None:
    for side in (-1.0, 1.0):
        sample.line(26, -4 * side, 34, 4 * side, sample.theme.past, 2.0)


def _particle(sample: _Sample) -> None:
    sample.disc(30, 8.0, sample.theme.line)
    sample.disc(30, DOT, sample.theme.text)


def _held(sample: _Sample) -> None:
    sample.line(25, 0, 35, 0, sample.theme.accent, 1.4)
    sample.line(30, -5, 30, 5, sample.theme.accent, 1.4)
    sample.disc(30, 1.5 * DOT, sample.theme.accent)


def _contact(sample: _Sample) -> None:
    for x in (16, 40):
        sample.line(x, 4, x, -9, sample.theme.contact, 1.6)
        at = sample.y
        centre = np.array([[sample.x + x * sample.scale, at + 4 * sample.scale]])
        sample.canvas.discs(centre, np.array([POINT * sample.scale]), np.array([packed(sample.theme.contact)]))
        if x > 16:
            hole = np.array([packed(sample.theme.card)])
            sample.canvas.discs(centre, np.array([0.55 * POINT * sample.scale]), hole)


def _arrow(sample: _Sample, colour: Colour, closed: bool) -> None:
    tail, tip = 10.0, 10.0 + ARROW
    sample.line(tail, 0, tip, 0, colour, 1.9)
    for side in (-3.2, 3.2):
        sample.line(tip - 6.5, side, tip, 0, colour, 1.9)
    if closed:
        sample.line(tip - 6.5, -3.2, tip - 6.5, 3.2, colour, 1.9)


def _force(sample: _Sample) -> None:
    _arrow(sample, sample.theme.force, True)


def _velocity(sample: _Sample) -> None:
    _arrow(sample, sample.theme.velocity, False)


def _bars(sample: _Sample) -> None:
    sample.line(8, 0, 24, 0, sample.theme.strain[2], BAR)
    sample.line(38, 0, 54, 0, sample.theme.strain[0], BAR)
    sample.line(38, 0, 54, 0, sample.theme.card, 0.45 * BAR)


def _zone(sample: _Sample) -> None:
    for k in range(4):
        sample.line(6 + 13 * k, 0, 14 + 13 * k, 0, sample.theme.accent, 1.8)


def _stability(sample: _Sample) -> None:
    sample.ramp(stability_tones(np.linspace(0.0, 1.0, round(sample.width)), sample.theme))


def _past(sample: _Sample) -> None:
    for k in range(3):
        sample.line(4 + 20 * k, 0, 14 + 20 * k, 0, sample.theme.past, 4.0)


def _calm(sample: _Sample) -> None:
    sample.line(4, 0, 54, 0, sample.theme.strain[1], 1.6)


def _near(sample: _Sample) -> None:
    sample.line(4, 0, 54, 0, sample.theme.strain[2], 4.0)
