"""SweepLayer: what sweeps measured over Cs and Cd, as colours on the pad, with its scale and its lines."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pygame

from sandbox.app.base.sag_map import CoefficientScale
from sandbox.app.draw.colours import DECADE, FIELD, MUTED, TEXT, Colour, mixed
from sandbox.app.widgets.widget import WindowLayout
from sandbox.physics.analysis.stability import CoefficientZones
from sandbox.physics.arrays import Floats
from sandbox.session.sweep.sweep_map import edges

# Two values further apart than this are seen on a logarithmic scale alone; what is that much smaller than the largest
# counts as nothing.
WIDE, NOTHING = 50.0, 1e-6
# Colours from little to much, alike to every kind of colour vision (cividis, Nunez and others 2018).
STOPS = np.array([(253, 231, 55), (213, 191, 88), (167, 156, 117), (124, 123, 120), (85, 91, 109), (38, 61, 110),
                  (0, 32, 77)], dtype=np.float64)  # fmt: skip
FAILS, HOLDS = (230, 159, 0), (86, 180, 233)
BLOWN = (176, 58, 0)
# Limits are seen on every colour: a light line in a dark one.
LIGHT, DARK = (255, 255, 255), (16, 20, 28)
# Sizes in layout units.
HATCH, NUMBER_SIZE, BAR_HEIGHT, SWATCH = 6.0, 10.5, 7.0, 9.0
Point = tuple[float, float]


class SweepMeasure(NamedTuple):
    """title: with its unit; missing: what a run without a value has done; is_flag: whether it is only 0 or 1."""

    title: str
    missing: str = "no number"
    is_flag: bool = False
    # What 0 and 1 are called.
    words: tuple[str, str] = ("no", "yes")


MEASURES = {
    "settle_time": SweepMeasure("settles after [s]", "never settles"),
    "max_strain": SweepMeasure("largest strain"),
    "energy_drift": SweepMeasure("energy gained [J]"),
    "broken_springs": SweepMeasure("broken springs"),
    "blew_up": SweepMeasure("blew up", is_flag=True),
}


def measure_of(figure: str) -> SweepMeasure:
    """A measure by the name that it has in the table; all that are not listed are checks."""
    return MEASURES.get(figure) or SweepMeasure(figure.removeprefix("check: "), "", True, ("fails", "holds"))


def shown_values(figure: str, values: Mapping[str, Floats]) -> Floats:
    """The values that a map shows of each measure: NaN where a run blew up, which says all of it."""
    if measure_of(figure).is_flag:
        return values[figure]
    return np.where(values["blew_up"] > 0.0, np.nan, values[figure])


def scale_of(values: Floats) -> tuple[float, float, bool]:
    """The lowest and the highest value of a scale for finite ones among values, and whether it is logarithmic."""
    known = values[np.isfinite(values)]
    if not len(known) or known.max() <= 0.0:
        return 0.0, 1.0, False
    highest = float(known.max())
    positive = known[known > NOTHING * highest]
    lowest = float(positive.min())
    if highest > WIDE * lowest:
        return lowest, highest, True
    lowest = min(float(known.min()), highest)
    return (lowest, highest, False) if highest - lowest > NOTHING * highest else (min(lowest, 0.0), highest, False)


@dataclass(frozen=True)
class SweepLayer:
    """A measure by its name in the table, Cs (m,) and Cd (n,) of its cells, and the values (n, m) of all measures.

    NaN in `blew_up`: that run is not known yet.
    """

    figure: str
    stiffness: Floats
    damping: Floats
    values: Mapping[str, Floats]
    scale: tuple[float, float, bool] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "scale", scale_of(shown_values(self.figure, self.values)))

    @property
    def measure(self) -> SweepMeasure:
        """The measure that is shown."""
        return measure_of(self.figure)

    @property
    def has_blown(self) -> bool:
        """Whether any run blew up."""
        return bool(np.any(self.values["blew_up"] > 0.0))

    @property
    def has_missing(self) -> bool:
        """Whether any run that did not blow up has no value."""
        shown = shown_values(self.figure, self.values)
        return bool(np.any(np.isnan(shown) & (self.values["blew_up"] == 0.0)))

    def pixels(self, stiffness: Floats, damping: Floats, hatch: np.ndarray) -> np.ndarray:
        """Colours (w, h, 3) at Cs (w,) and Cd (h,); hatch (w, h): where a pattern has its lines."""
        across, up = _cells(self.stiffness, stiffness), _cells(self.damping, damping)
        at = np.ix_(up, across)
        values, blown = self.values[self.figure][at].T, self.values["blew_up"][at].T
        found = np.empty((*values.shape, 3), dtype=np.uint8)
        found[:] = mixed(FIELD, MUTED, 0.3)
        known = np.isfinite(values)
        found[known] = self.colours(values[known])
        is_blown = blown > 0.0
        if not self.measure.is_flag:
            found[is_blown] = mixed(FIELD, BLOWN, 0.45)
        found[is_blown & hatch] = BLOWN
        found[np.isnan(blown) | (across < 0)[:, None] | (up < 0)[None, :]] = FIELD
        return found

    def colours(self, values: Floats) -> np.ndarray:
        """Colours (k, 3) of values (k,)."""
        if self.figure == "blew_up":
            return np.where(values[:, None] > 0.0, BLOWN, mixed(FIELD, MUTED, 0.3)).astype(np.uint8)
        if self.measure.is_flag:
            return np.where(values[:, None] > 0.0, HOLDS, FAILS).astype(np.uint8)
        low, high, is_wide = self.scale
        place = (values - low) / (high - low)
        if is_wide:
            place = np.log(np.maximum(values, low) / low) / np.log(high / low)
        stops = np.linspace(0.0, 1.0, len(STOPS))
        return np.stack([np.interp(place, stops, STOPS[:, k]) for k in range(3)], axis=1).astype(np.uint8)

    def text_at(self, stiffness: float, damping: float) -> str:
        """The results in the cell of a Cs and Cd, in a few words."""
        across, up = (int(_cells(axis, np.array([value]))[0]) for axis, value in
                      ((self.stiffness, stiffness), (self.damping, damping)))  # fmt: skip
        if across < 0 or up < 0:
            return "outside the sweep"
        value, blown = float(self.values[self.figure][up, across]), float(self.values["blew_up"][up, across])
        if np.isnan(blown):
            return "not run yet"
        if blown > 0.0:
            return "blew up"
        if np.isnan(value):
            return self.measure.missing
        if self.measure.is_flag:
            return self.measure.words[int(value)]
        return f"{value:.3g}{self.unit}"

    @property
    def unit(self) -> str:
        """The unit of the values, after a space."""
        _, bracket, unit = self.measure.title.partition(" [")
        return f" {unit.rstrip(']')}" if bracket else ""

    @property
    def missing_colour(self) -> Colour:
        """The colour of runs without a value."""
        return mixed(FIELD, MUTED, 0.3)


def _cells(axis: Floats, values: Floats) -> np.ndarray:
    """Numbers (k,) of the cells of an axis that values (k,) lie in; -1: in none."""
    between = edges(axis)
    found = np.searchsorted(between, values, side="right") - 1
    return np.where((values < between[0]) | (values > between[-1]), -1, np.minimum(found, len(axis) - 1))


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
    """Draw a light line in a dark one."""
    if len(points) > 1:
        pygame.draw.lines(surface, DARK, False, points, 3 * width)
        pygame.draw.lines(surface, LIGHT, False, points, width)


def paint_scale(surface: pygame.Surface, layer: SweepLayer, place: pygame.Rect, ui: WindowLayout) -> None:
    """Draw the colours of a measure with their numbers, and the meaning of patterns, in a place of two lines."""
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
    area = pygame.Rect(
        bar.left + first.get_width(), y, bar.width - first.get_width() - last.get_width(), last.get_height()
    )
    _paint_swatches(surface, list(_swatches(layer)), area, layer, ui)


def _swatches(layer: SweepLayer) -> Iterable[tuple[str, bool]]:
    """Words for colours that are not on the scale, and whether they are hatched."""
    if layer.measure.is_flag:
        return
    if layer.has_missing:
        yield layer.measure.missing, False
    if layer.has_blown:
        yield "blew up", True


def _paint_swatches(
    surface: pygame.Surface, swatches: list[tuple[str, bool]], area: pygame.Rect, layer: SweepLayer, ui: WindowLayout
) -> None:
    font, size = ui.font(NUMBER_SIZE), ui.px(SWATCH)
    texts = [(font.render(word, True, MUTED), hatched) for word, hatched in swatches]
    gap = ui.px(3)
    width = sum(size + gap + text.get_width() for text, _ in texts) + gap * (len(texts) - 1)
    x = area.centerx - width // 2
    for text, hatched in texts:
        box = pygame.Rect(x, area.centery - size // 2, size, size)
        pygame.draw.rect(surface, layer.missing_colour, box)
        if hatched:
            pygame.draw.line(surface, BLOWN, box.topleft, box.bottomright)
            pygame.draw.line(surface, BLOWN, box.topright, box.bottomleft)
        pygame.draw.rect(surface, DECADE, box, 1)
        surface.blit(text, (box.right + gap, area.top))
        x = box.right + text.get_width() + 2 * gap
