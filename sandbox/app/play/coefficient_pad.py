"""CoefficientPad: Cs across and Cd up, both logarithmic, on a map of what theory says of every pair of them."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import ACCENT, DANGER, DECADE, FIELD, MUTED, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.sweeps.layer_paint import limits_of, paint_cells, paint_line, paint_scale
from sandbox.app.sweeps.sweep_layer import SweepLayer
from sandbox.app.widgets.painted import Draggable, wrapped
from sandbox.app.widgets.sliders import FINE_KEY_STEP, HIGHEST, KEY_STEP, LOWEST, fraction_of, value_at
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.coefficient_zones import CoefficientZones

# Sizes in layout units: what stands around the map, and of what is on it.
LEFT, RIGHT, TOP, BOTTOM = 38.0, 8.0, 18.0, 40.0
NUMBER_SIZE, WORD_SIZE, LABEL_SIZE = 10.5, 12.5, 10.5
KNOB = 7.0
HATCH = 7.0
UP_NAME = "Cd  damping"
DECADES = tuple(range(int(LOWEST), int(HIGHEST) + 1))
# What values of Cs are called, from the lowest on (Nissen 2019, re-introducing coefficients).
STIFFNESS_WORDS = (("soft", 1e-5, 1e-3), ("firm", 1e-3, 1e-2), ("rigid", 1e-2, 1.0))
# Values of Cs that zones are worked out for.
COLUMNS = 61
STIFFNESSES = 10.0 ** np.linspace(LOWEST, HIGHEST, COLUMNS)

Mask = NDArray[np.bool_]


class PadState(NamedTuple):
    """What the pad shows: Cs and Cd, whether springs differ in them, and whether there are any."""

    stiffness: float
    damping: float
    is_mixed: bool
    enabled: bool


def critical_stiffness(damping: np.ndarray) -> np.ndarray:
    """The Cs (k,) at which one spring of each Cd (k,) has damping ratio 1: with more it swings."""
    # Equal roots: (2 - Cs - Cd)^2 = 4 (1 - Cd).
    return np.asarray((1.0 - np.sqrt(1.0 - damping)) ** 2)


class CoefficientPad(Draggable):
    """The pad; changed(Cs, Cd) is called as it is dragged, done() at the end of each drag or key press."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, changed: Callable[[float, float], None], done: Callable[[], None],
        container: Any = None,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self.state = PadState(0.1, 0.1, False, True)
        self.zones: CoefficientZones | None = None
        self._changed, self._done, self._name = changed, done, ""
        self._map: pygame.Surface | None = None
        # Where another run's springs are, and what it is called.
        self._ghost: tuple[str, tuple[float, float]] | None = None
        # What a sweep has measured, shown in place of the zones, how far it is, and where the mouse asks for a number.
        self._sweep: SweepLayer | None = None
        self._note = ""
        self._pointed: tuple[float, float] | None = None
        ui.add(self)
        self.repaint()

    def show_layer(self, layer: SweepLayer | None, note: str) -> None:
        """Show what a sweep has measured (None: what theory says), and a note about it."""
        if layer is not self._sweep:
            self._sweep, self._map = layer, None
        elif note == self._note:
            return
        self._note = note
        self.repaint()

    def show_state(self, state: PadState, zones: CoefficientZones | None) -> None:
        """Show values on zones (None: nothing is known of them)."""
        if zones is not self.zones:
            self.zones, self._map = zones, None
        elif state == self.state:
            return
        self.state = state
        self.repaint()

    def show_ghost(self, own: str, name: str, pair: tuple[float, float] | None) -> None:
        """Show where another run's springs are as well (None: nowhere), and what both are called."""
        ghost = None if pair is None else (name, pair)
        if (ghost, own) != (self._ghost, self._name):
            self._ghost, self._name = ghost, own
            self.repaint()

    @property
    def _inside(self) -> pygame.Rect:
        """The map, in pixels from the widget's corner."""
        px, (width, height) = self.ui.px, self.rect.size
        return pygame.Rect(px(LEFT), px(TOP), width - px(LEFT + RIGHT), height - px(TOP + BOTTOM))

    def pixel_of(self, stiffness: float, damping: float) -> tuple[int, int]:
        """Where in the window a pair is."""
        x, y = self._at(stiffness, damping)
        return round(self.rect.left + x), round(self.rect.top + y)

    def _at(self, stiffness: float, damping: float) -> tuple[float, float]:
        inside = self._inside
        return (
            inside.left + fraction_of(stiffness) * (inside.width - 1),
            inside.bottom - 1 - fraction_of(damping) * (inside.height - 1),
        )

    # Mouse and keys.

    def can_drag(self) -> bool:
        """Whether there is anything to set."""
        return self.state.enabled

    def end_drag(self) -> None:
        """What is set counts."""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows move by a step, with Shift by a fine one; Home and End go to the softest and the most rigid."""
        step = FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP
        across, up = fraction_of(self.state.stiffness), fraction_of(self.state.damping)
        moves = {
            pygame.K_LEFT: (across - step, up),
            pygame.K_RIGHT: (across + step, up),
            pygame.K_DOWN: (across, up - step),
            pygame.K_UP: (across, up + step),
            pygame.K_HOME: (0.0, up),
            pygame.K_END: (1.0, up),
        }
        if event.key not in moves or not self.state.enabled:
            return False
        new = moves[event.key]
        # What is not moved keeps all its digits.
        self._changed(
            self.state.stiffness if new[0] == across else value_at(new[0]),
            self.state.damping if new[1] == up else value_at(new[1]),
        )
        self._done()
        return True

    def process_event(self, event: pygame.event.Event) -> bool:
        """Follow the mouse, and tell the number under it."""
        if event.type == pygame.MOUSEMOTION and self._sweep is not None:
            pointed = self._pair_at(event.pos) if self.hover_point(*event.pos) else None
            if pointed != self._pointed:
                self._pointed = pointed
                self.repaint()
        return super().process_event(event)

    def follow(self, pos: tuple[int, int]) -> None:
        """Set what lies under the mouse."""
        self._changed(*self._pair_at(pos))

    def _pair_at(self, pos: tuple[int, int]) -> tuple[float, float]:
        """The Cs and the Cd at a place in the window."""
        x, y = self.ui.manager.calculate_scaled_mouse_position(pos)
        inside = self._inside
        across = (x - self.rect.left - inside.left) / max(1, inside.width - 1)
        up = (inside.bottom - 1 - (y - self.rect.top)) / max(1, inside.height - 1)
        return value_at(across), value_at(up)

    # Painting.

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The map, and the knob with lines to both axes."""
        if self._map is None or self._map.get_size() != size:
            self._map = self._painted_map(size)
        surface = self._map.copy()
        self._paint_reading(surface)
        if not self.state.enabled:
            return surface
        inside, px = self._inside, self.ui.px
        if self._ghost is not None:
            there = self._at(*self._ghost[1])
            pygame.draw.aacircle(surface, SURFACE, there, px(KNOB) + max(1, px(1.5)))
            pygame.draw.aacircle(surface, MUTED, there, px(KNOB), max(2, px(2)))
            self._paint_name(surface, self._ghost[0], there, MUTED)
        x, y = self._at(self.state.stiffness, self.state.damping)
        guide = mixed(FIELD, TEXT, 0.45)
        pygame.draw.line(surface, guide, (inside.left, y), (x, y))
        pygame.draw.line(surface, guide, (x, inside.bottom - 1), (x, y))
        pygame.draw.aacircle(surface, SURFACE, (x, y), px(KNOB) + max(1, px(1.5)))
        pygame.draw.aacircle(surface, TEXT, (x, y), px(KNOB))
        pygame.draw.aacircle(surface, SURFACE if self.state.is_mixed else self._knob_colour(), (x, y), px(KNOB - 3))
        if self._name:
            self._paint_name(surface, self._name, (x, y), TEXT)
        return surface

    def _paint_name(self, surface: pygame.Surface, name: str, at: tuple[float, float], colour: Colour) -> None:
        picture = self.ui.font(WORD_SIZE, True).render(name, True, colour)
        place = picture.get_rect(midbottom=(at[0], at[1] - self.ui.px(KNOB + 2)))
        if place.top < self._inside.top:
            place.midtop = (round(at[0]), round(at[1] + self.ui.px(KNOB + 2)))
        surface.blit(picture, place.clamp(self._inside))

    def _knob_colour(self) -> Colour:
        """Of the zone that the knob stands in."""
        zones = self.zones
        if zones is None or zones.proven is None or not zones.holds:
            return ACCENT
        column = int(np.argmin(np.abs(np.log(zones.stiffness) - np.log(max(self.state.stiffness, 10.0**LOWEST)))))
        if zones.estimated is not None and self.state.damping > zones.estimated[column]:
            return DANGER
        return ACCENT if self.state.damping < zones.proven[column] else WARNING

    def _painted_map(self, size: tuple[int, int]) -> pygame.Surface:
        surface = pygame.Surface(size, pygame.SRCALPHA)
        inside = self._inside
        if self._sweep is not None:
            self._paint_layer(surface, inside, self._sweep)
            pygame.draw.rect(surface, DECADE, inside, 1)
            return surface
        self._paint_zones(surface, inside)
        self._paint_axes(surface, inside)
        self._paint_stiffness_words(surface, inside)
        self._paint_critical(surface, inside)
        pygame.draw.rect(surface, DECADE, inside, 1)
        self._paint_words(surface, inside)
        return surface

    def _paint_layer(self, surface: pygame.Surface, inside: pygame.Rect, layer: SweepLayer) -> None:
        """What a sweep has measured, with its scale and with the lines up to which a single pass is proven stable."""
        px = self.ui.px
        paint_cells(surface, inside, layer, (LOWEST, HIGHEST), self.ui)
        surface.set_clip(inside)
        for line in limits_of(self.zones) if self.zones is not None else []:
            paint_line(surface, [self._at(cs, cd) for cs, cd in line], max(1, px(1)))
        surface.set_clip(None)
        self._paint_axes(surface, inside)
        self._paint_stiffness_name(surface, inside)
        place = pygame.Rect(inside.left, inside.bottom + px(18), inside.width, px(BOTTOM - 18))
        paint_scale(surface, layer, place, self.ui)

    def _paint_reading(self, surface: pygame.Surface) -> None:
        """The number under the mouse; else how far the runs are, and the number of the knob."""
        texts = [self._note]
        if self._sweep is not None and self._pointed is not None:
            cs, cd = self._pointed
            texts = [f"Cs {cs:.2g}, Cd {cd:.2g}: {self._sweep.text_at(cs, cd)}"]
        elif self._sweep is not None:
            texts.append(self._sweep.text_at(self.state.stiffness, self.state.damping))
        font, inside = self.ui.font(NUMBER_SIZE), self._inside
        widest = inside.width - self.ui.font(NUMBER_SIZE, True).size(UP_NAME)[0] - self.ui.px(6)
        picture = font.render(wrapped(", ".join(filter(None, texts)), font, widest, 1)[0], True, TEXT)
        surface.blit(picture, picture.get_rect(topright=(inside.right, 0)))

    def _paint_zones(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Fill each zone in its tone; what is not proven is hatched as well, since colour alone tells nobody enough."""
        across = np.linspace(LOWEST, HIGHEST, inside.width)
        up = np.linspace(HIGHEST, LOWEST, inside.height)
        damping, stiffness = 10.0 ** up[None, :], 10.0 ** across[:, None]
        pixels = np.empty((inside.width, inside.height, 3), dtype=np.uint8)
        pixels[:] = mixed(FIELD, ACCENT, 0.10)
        x, y = np.ogrid[: inside.width, : inside.height]
        step = max(4, self.ui.px(HATCH))
        stroke = max(1, self.ui.px(1))
        rising, falling = (x + y) % step < stroke, (x - y) % step < stroke
        zones = self.zones
        if zones is None or not self.state.enabled:
            pixels[:] = FIELD
        elif zones.bounded:
            self._fill(pixels, np.broadcast_to(stiffness > damping, pixels.shape[:2]), MUTED, 0.08, rising, 0.16)
        elif zones.proven is not None:
            beyond = damping > self._edge(zones.proven, across)
            if zones.holds:
                self._fill(pixels, beyond, WARNING, 0.16, rising, 0.34)
            else:
                pixels[:] = mixed(FIELD, MUTED, 0.06)
            if zones.estimated is not None and zones.holds:
                self._fill(pixels, damping > self._edge(zones.estimated, across), DANGER, 0.28, rising | falling, 0.5)
        surface.blit(pygame.surfarray.make_surface(pixels), inside)

    @staticmethod
    def _fill(pixels: np.ndarray, where: Mask, colour: Colour, share: float, hatch: Mask, hatched: float) -> None:
        pixels[where] = mixed(FIELD, colour, share)
        pixels[where & hatch] = mixed(FIELD, colour, hatched)

    def _edge(self, highest: np.ndarray, across: np.ndarray) -> np.ndarray:
        """The highest Cd of a zone (w, 1) at places across [exponents]; below the map where nothing is inside."""
        known = np.where(highest > 0.0, np.log10(np.maximum(highest, 1e-9)), LOWEST - 1.0)
        return np.asarray(10.0 ** np.interp(across, np.linspace(LOWEST, HIGHEST, len(known)), known)[:, None])

    def _paint_axes(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Lines at the decades, numbers beside them, and what lies across and up."""
        font, px = self.ui.font(NUMBER_SIZE), self.ui.px
        for exponent in DECADES:
            x, y = self._at(10.0**exponent, 10.0**exponent)
            text = f"{10.0**exponent:g}" if exponent >= -3 else f"1e{exponent}"
            if LOWEST < exponent < HIGHEST:
                grid = pygame.Surface(inside.size, pygame.SRCALPHA)
                pygame.draw.line(grid, (*DECADE, 90), (x - inside.left, 0), (x - inside.left, inside.height))
                pygame.draw.line(grid, (*DECADE, 90), (0, y - inside.top), (inside.width, y - inside.top))
                surface.blit(grid, inside)
            number = font.render(text, True, MUTED)
            place = number.get_rect(midtop=(x, inside.bottom + px(2)))
            surface.blit(number, place.clamp(surface.get_rect()))
            place = number.get_rect(midright=(inside.left - px(4), y))
            surface.blit(number, place.clamp(surface.get_rect()))
        name = self.ui.font(NUMBER_SIZE, True).render(UP_NAME, True, TEXT)
        surface.blit(name, (inside.left, 0))

    def _paint_stiffness_words(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """What values of Cs are called, each over its part of the axis."""
        font, px = self.ui.font(WORD_SIZE), self.ui.px
        y = inside.bottom + px(18)
        self._paint_stiffness_name(surface, inside)
        for word, low, high in STIFFNESS_WORDS:
            start, end = self._at(low, 1.0)[0], self._at(high, 1.0)[0]
            pygame.draw.line(surface, DECADE, (start + px(2), y), (end - px(2), y), max(1, px(1.5)))
            text = font.render(word, True, TEXT)
            surface.blit(text, text.get_rect(midtop=((start + end) / 2, y + px(2))))

    def _paint_stiffness_name(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        px, name = self.ui.px, self.ui.font(NUMBER_SIZE, True).render("Cs", True, TEXT)
        surface.blit(name, name.get_rect(topright=(inside.left - px(4), inside.bottom + px(19))))

    def _paint_critical(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Where one spring neither swings nor creeps, and what lies on either side; where 1/(n+1) ends."""
        px = self.ui.px
        surface.set_clip(inside)
        damping = 10.0 ** np.linspace(LOWEST, -1e-9, 80)
        critical = critical_stiffness(damping)
        seen = critical >= 10.0**LOWEST
        line = [self._at(float(cs), float(cd)) for cs, cd in zip(critical[seen], damping[seen], strict=True)]
        _dashes(surface, TEXT, line, px(5))
        zones = self.zones
        if zones is not None and zones.article is not None and self.state.enabled:
            inside_it = zones.article > 0.0
            corner = zones.stiffness[inside_it]
            edge = [self._at(float(cs), float(cd)) for cs, cd in zip(corner, zones.article[inside_it], strict=True)]
            if edge:
                edge.append((edge[-1][0], inside.bottom))
                pygame.draw.aalines(surface, ACCENT, False, edge)
        surface.set_clip(None)

    def _paint_words(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Words on the map: how a spring moves there, and what is proven of it."""
        word, label = self.ui.font(WORD_SIZE), self.ui.font(LABEL_SIZE)
        zones = self.zones
        texts: list[tuple[pygame.font.Font, str, Colour, float, float]] = [
            (word, "calm", TEXT, 0.2, 0.16), (word, "wobbly", TEXT, 0.72, 0.56),
        ]  # fmt: skip
        if zones is not None and self.state.enabled:
            texts += [(label, *each) for each in _zone_labels(zones)]
        for font, text, colour, across, down in texts:
            picture = font.render(text, True, colour)
            at = inside.left + across * inside.width, inside.top + down * inside.height
            place = picture.get_rect(center=at).clamp(inside.inflate(-4, -2))
            surface.blit(picture, place)


def _zone_labels(zones: CoefficientZones) -> list[tuple[str, Colour, float, float]]:
    """What is written on the zones, in a colour, at shares of the map's width and height from its upper left corner."""
    if zones.bounded:
        return [("energy never grows", MUTED, 0.27, 0.58), ("energy up to 4 times", MUTED, 0.7, 0.92)]
    if zones.proven is None or zones.article is None:
        return []
    found: list[tuple[str, Colour, float, float]] = []
    reach = float(zones.article.max())
    if reach > 0.0:
        of = f"1/(n+1), n = {zones.most_springs}" if zones.holds else "1/(n+1) of a single pass"
        found.append((of, ACCENT, fraction_of(reach) - 0.2, 0.84))
    if not zones.holds:
        return [*found, ("nothing is proven here", MUTED, 0.32, 0.94)]
    found.append(("proven stable", MUTED, 0.22, 0.94))
    if zones.estimated is not None and zones.estimated[0] < 0.75:
        found.append(("explodes", DANGER, 0.5, 0.5 * (1.0 - fraction_of(float(zones.estimated[0])))))
    return found


def _dashes(surface: pygame.Surface, colour: Colour, line: list[tuple[float, float]], dash: int) -> None:
    """A line through points in dashes [pixels]."""
    points = np.array(line)
    if len(points) < 2:
        return
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    for start in np.arange(0.0, along[-1], 2 * dash):
        first, last = ([float(np.interp(s, along, points[:, k])) for k in (0, 1)] for s in (start, start + dash))
        pygame.draw.aaline(surface, colour, first, last)
