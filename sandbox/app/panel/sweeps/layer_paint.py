"""Painting of a sweep's layer: its cells, the limits over them, and the scale of its colours."""

from collections.abc import Iterable

import numpy as np
import pygame

from sandbox.app.base.sag_map import CoefficientScale
from sandbox.app.draw.colours import DECADE, MUTED, TEXT
from sandbox.app.panel.sweeps.sweep_layer import BLOWN, SweepLayer
from sandbox.app.widgets.widget import WindowLayout
from sandbox.physics.analysis.stability import CoefficientZones

# Limits are seen on every colour: a light line in a dark one.
LIGHT, DARK = (255, 255, 255), (16, 20, 28)
# Sizes in layout units.
HATCH, NUMBER_SIZE, BAR_HEIGHT, SWATCH = 6.0, 10.5, 7.0, 9.0

Point = tuple[float, float]


def paint_cells(
    surface: pygame.Surface, inside: pygame.Rect, layer: SweepLayer, scale: CoefficientScale, ui: WindowLayout
) -> None:
    """Fill a map both of whose axes are of a scale."""
    pixels = layer.pixels(scale.values(inside.width), scale.values(inside.height)[::-1], _hatch(inside.size, ui))
    surface.blit(pygame.surfarray.make_surface(pixels), inside)


def _hatch(size: tuple[int, int], ui: WindowLayout) -> np.ndarray:
    x, y = np.ogrid[: size[0], : size[1]]
    step, stroke = max(4, ui.px(HATCH)), max(1, ui.px(1))
    return np.asarray(((x + y) % step < stroke) | ((x - y) % step < stroke))


def limits_of(zones: CoefficientZones) -> list[list[tuple[float, float]]]:
    """Lines through Cs and Cd on which 1/(n+1) and what is proven end; the last point is at the bottom, Cd 0."""
    found = []
    for highest in (zones.article, zones.proven if zones.holds else None):
        if highest is None or not np.any(highest > 0.0):
            continue
        inside = highest > 0.0
        line = [(float(cs), float(cd)) for cs, cd in zip(zones.stiffness[inside], highest[inside], strict=True)]
        found.append(line if inside.all() else [*line, (line[-1][0], 0.0)])
    return found


def paint_line(surface: pygame.Surface, points: list[Point], width: int) -> None:
    """A light line in a dark one."""
    if len(points) > 1:
        pygame.draw.lines(surface, DARK, False, points, 3 * width)
        pygame.draw.lines(surface, LIGHT, False, points, width)


def paint_scale(surface: pygame.Surface, layer: SweepLayer, place: pygame.Rect, ui: WindowLayout) -> None:
    """The colours of a measure with their numbers, and what patterns mean, in a place of two lines."""
    font, px, measure = ui.font(NUMBER_SIZE), ui.px, layer.measure
    bar = pygame.Rect(place.left, place.top, place.width, px(BAR_HEIGHT))
    low, high, is_wide = layer.scale
    ends = np.geomspace(low, high, bar.width) if is_wide else np.linspace(low, high, bar.width)
    if measure.is_flag:
        ends = np.where(np.arange(bar.width) < bar.width // 2, 0.0, 1.0)
    strip = np.repeat(layer.colours(ends)[:, None, :], bar.height, axis=1)
    surface.blit(pygame.surfarray.make_surface(strip), bar)
    pygame.draw.rect(surface, DECADE, bar, 1)
    words = measure.words if measure.is_flag else (f"{low:.3g}", f"{high:.3g}{layer.unit}")
    first, last = (font.render(word, True, TEXT) for word in words)
    y = bar.bottom + px(2)
    surface.blit(first, (bar.left, y))
    surface.blit(last, last.get_rect(topright=(bar.right, y)))
    room = pygame.Rect(
        bar.left + first.get_width(), y, bar.width - first.get_width() - last.get_width(), last.get_height()
    )
    _paint_swatches(surface, list(_swatches(layer)), room, layer, ui)


def _swatches(layer: SweepLayer) -> Iterable[tuple[str, bool]]:
    """Words for colours that are not on the scale, and whether they are hatched."""
    if layer.measure.is_flag:
        return
    if layer.has_missing:
        yield layer.measure.missing, False
    if layer.has_blown:
        yield "blew up", True


def _paint_swatches(
    surface: pygame.Surface, swatches: list[tuple[str, bool]], room: pygame.Rect, layer: SweepLayer, ui: WindowLayout
) -> None:
    font, size = ui.font(NUMBER_SIZE), ui.px(SWATCH)
    texts = [(font.render(word, True, MUTED), hatched) for word, hatched in swatches]
    gap = ui.px(3)
    width = sum(size + gap + text.get_width() for text, _ in texts) + gap * (len(texts) - 1)
    x = room.centerx - width // 2
    for text, hatched in texts:
        box = pygame.Rect(x, room.centery - size // 2, size, size)
        pygame.draw.rect(surface, layer.missing_colour, box)
        if hatched:
            pygame.draw.line(surface, BLOWN, box.topleft, box.bottomright)
            pygame.draw.line(surface, BLOWN, box.topright, box.bottomleft)
        pygame.draw.rect(surface, DECADE, box, 1)
        surface.blit(text, (box.right + gap, room.top))
        x = box.right + text.get_width() + 2 * gap
