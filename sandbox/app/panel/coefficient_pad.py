"""CoefficientPad: Cs across and Cd up, on a map of what theory says of every pair of them, and of what one sees."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.base.sag_map import PLAIN, WORD_SHARE, CoefficientScale, SagMap
from sandbox.app.draw.colours import ACCENT, DANGER, DECADE, FIELD, MUTED, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.panel.sweeps.sweep_layer import SweepLayer, limits_of, paint_cells, paint_line, paint_scale
from sandbox.app.widgets.slider import FINE_KEY_STEP, KEY_STEP
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Draggable, Pixel
from sandbox.physics.analysis.stability import CoefficientZones
from sandbox.physics.arrays import Floats
from sandbox.physics.softness.body_motion import BodyMotion, swings_back

# Sizes in layout units: what stands around the map, and of what is on it.
LEFT, RIGHT, TOP, BOTTOM = 38.0, 8.0, 18.0, 34.0
NUMBER_SIZE, WORD_SIZE, LABEL_SIZE = 10.5, 13.0, 10.5
KNOB, OWN = 7.0, 4.0
HATCH = 7.0
UP_NAME, ACROSS_NAME = "Cd  damping", "Cs  stiffness"
# Numbers of an axis are at least so far apart.
NUMBER_GAP = 6.0
# Values of Cs that zones are worked out for.
STIFFNESSES = CoefficientScale(1e-5, 0.003).values(81)

Mask = NDArray[np.bool_]


class PadState(NamedTuple):
    """The state of the pad: Cs and Cd, whether springs differ in them, and whether there are any.

    own: what the level itself has; scale: of both axes; body: that of which words are, subject: what of it sags, and
    word: what it is called as it is, "" where that is not known.
    """

    stiffness: float
    damping: float
    is_mixed: bool
    enabled: bool
    own: tuple[float, float] | None = None
    scale: CoefficientScale = PLAIN
    body: BodyMotion | None = None
    subject: str = ""
    word: str = ""


class CoefficientPad(Draggable):
    """The pad; changed(Cs, Cd) is called as it is dragged, done() at the end of each drag or key press.

    is_plain: it shows how far a body sags, and nothing of how that swings.
    """

    def __init__(
        self, ui: Ui, rect: pygame.Rect, changed: Callable[[float, float], None], done: Callable[[], None],
        container: Any = None, is_plain: bool = False,
    ) -> None:  # fmt: skip
        super().__init__(ui, rect, container)
        self._is_plain = is_plain
        self.state = PadState(0.1, 0.1, False, True)
        self.zones: CoefficientZones | None = None
        self._changed, self._done, self._name = changed, done, ""
        self._map: pygame.Surface | None = None
        # What words are written on that, where it shows how far a body sags.
        self._sags: SagMap | None = None
        # Where another run's springs are, and what it is called.
        self._ghost: tuple[str, tuple[float, float]] | None = None
        # What a sweep has measured, shown in place of the zones, how far it is, and where the mouse asks for a number.
        self._sweep: SweepLayer | None = None
        self._note = ""
        self._pointed: tuple[float, float] | None = None

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
        if zones is not self.zones or (state.scale, state.body, state.enabled) != (
            self.state.scale, self.state.body, self.state.enabled,
        ):  # fmt: skip
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
            inside.left + self.state.scale.place_of(stiffness) * (inside.width - 1),
            inside.bottom - 1 - self.state.scale.place_of(damping) * (inside.height - 1),
        )

    # Mouse and keys.

    def can_drag(self) -> bool:
        """Whether the pad can be dragged."""
        return self.state.enabled

    def on_release(self, at: Pixel) -> None:
        """Call done(): the drag has ended."""
        self._done()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Arrows move by a step, with Shift by a fine one; Home and End go to the softest and the most rigid."""
        step = FINE_KEY_STEP if event.mod & pygame.KMOD_SHIFT else KEY_STEP
        moves = {
            pygame.K_LEFT: (-step, 0.0), pygame.K_RIGHT: (step, 0.0), pygame.K_DOWN: (0.0, -step),
            pygame.K_UP: (0.0, step), pygame.K_HOME: (-1.0, 0.0), pygame.K_END: (1.0, 0.0),
        }  # fmt: skip
        if event.key not in moves or not self.state.enabled:
            return False
        self._step(*moves[event.key])
        return True

    def on_wheel(self, notches: float) -> bool:
        """After a click on it, move Cs by a fine step a notch; with Shift, Cd."""
        if not (self.in_hand and self.state.enabled):
            return False
        by = FINE_KEY_STEP * notches
        self._step(*((0.0, by) if pygame.key.get_mods() & pygame.KMOD_SHIFT else (by, 0.0)))
        return True

    def _step(self, across: float, up: float) -> None:
        def moved(value: float, by: float) -> float:
            # What is not moved keeps all its digits.
            scale = self.state.scale
            return value if by == 0.0 else scale.value_at(min(max(scale.place_of(value) + by, 0.0), 1.0))

        self._changed(moved(self.state.stiffness, across), moved(self.state.damping, up))
        self._done()

    def on_move(self, at: Pixel) -> None:
        """Show the measured values at the Cs and Cd under the mouse."""
        self._show_pointed(self._pair_at(at))

    def on_hover(self) -> None:
        """Hide those values while the mouse is elsewhere."""
        if not self.hovered:
            self._show_pointed(None)

    def _show_pointed(self, pointed: tuple[float, float] | None) -> None:
        if self._sweep is not None and pointed != self._pointed:
            self._pointed = pointed
            self.repaint()

    def on_drag(self, at: Pixel) -> None:
        """Set the Cs and Cd under the mouse."""
        self._changed(*self._pair_at(at))

    def _pair_at(self, at: Pixel) -> tuple[float, float]:
        """The Cs and the Cd at a place in the window."""
        (x, y), inside = at, self._inside
        across = (x - self.rect.left - inside.left) / max(1, inside.width - 1)
        up = (inside.bottom - 1 - (y - self.rect.top)) / max(1, inside.height - 1)
        return self.state.scale.value_at(across), self.state.scale.value_at(up)

    # Painting.

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Paint the map, and the knob with lines to both axes."""
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
        if self.state.own is not None:
            there = self._at(*self.state.own)
            pygame.draw.aacircle(surface, SURFACE, there, px(OWN) + max(1, px(1.5)))
            pygame.draw.aacircle(surface, TEXT, there, px(OWN), max(1, px(1.5)))
        x, y = self._at(self.state.stiffness, self.state.damping)
        guide = mixed(FIELD, TEXT, 0.45)
        pygame.draw.line(surface, guide, (inside.left, y), (x, y))
        pygame.draw.line(surface, guide, (x, inside.bottom - 1), (x, y))
        pygame.draw.aacircle(surface, SURFACE, (x, y), px(KNOB) + max(1, px(1.5)))
        pygame.draw.aacircle(surface, TEXT, (x, y), px(KNOB))
        pygame.draw.aacircle(surface, SURFACE if self.state.is_mixed else self._knob_colour(), (x, y), px(KNOB - 3))
        name = ", ".join(filter(None, (self._name, self.state.word)))
        taken = self._paint_name(surface, name, (x, y), TEXT)
        self._paint_sag_words(
            surface, taken.union(pygame.Rect(0, 0, 2 * px(KNOB), 2 * px(KNOB)).move_to(center=(x, y)))
        )
        return surface

    def _paint_name(self, surface: pygame.Surface, name: str, at: tuple[float, float], colour: Colour) -> pygame.Rect:
        """Write a name above a place, below it where there is no room; returns where it stands."""
        picture = self.ui.font(WORD_SIZE, True).render(name, True, colour)
        place = picture.get_rect(midbottom=(at[0], at[1] - self.ui.px(KNOB + 2)))
        if place.top < self._inside.top:
            place.midtop = (round(at[0]), round(at[1] + self.ui.px(KNOB + 2)))
        return surface.blit(picture, place.clamp(self._inside))

    def _knob_colour(self) -> Colour:
        """The colour of the zone that the knob is in."""
        zones = self.zones
        if zones is None or zones.proven is None or not zones.holds:
            return ACCENT
        column = int(np.argmin(np.abs(np.log(zones.stiffness) - np.log(max(self.state.stiffness, zones.stiffness[0])))))
        if zones.estimated is not None and self.state.damping > zones.estimated[column]:
            return DANGER
        return ACCENT if self.state.damping < zones.proven[column] else WARNING

    def _painted_map(self, size: tuple[int, int]) -> pygame.Surface:
        surface = pygame.Surface(size, pygame.SRCALPHA)
        inside, self._sags = self._inside, None
        if self._sweep is not None:
            self._paint_layer(surface, inside, self._sweep)
            pygame.draw.rect(surface, DECADE, inside, 1)
            return surface
        self._paint_zones(surface, inside)
        self._paint_axes(surface, inside)
        self._paint_body(surface, inside)
        self._paint_article(surface, inside)
        pygame.draw.rect(surface, DECADE, inside, 1)
        self._paint_words(surface, inside)
        return surface

    def _paint_layer(self, surface: pygame.Surface, inside: pygame.Rect, layer: SweepLayer) -> None:
        """Paint what a sweep has measured, its scale, and the lines up to which a single pass is proven stable."""
        px = self.ui.px
        paint_cells(surface, inside, layer, self.state.scale, self.ui)
        surface.set_clip(inside)
        for line in limits_of(self.zones) if self.zones is not None else []:
            paint_line(surface, [self._at(cs, cd) for cs, cd in line], max(1, px(1)))
        surface.set_clip(None)
        self._paint_axes(surface, inside)
        place = pygame.Rect(inside.left, inside.bottom + px(18), inside.width, px(BOTTOM - 18))
        paint_scale(surface, layer, place, self.ui)

    def _paint_reading(self, surface: pygame.Surface) -> None:
        """Write the number under the mouse; else how far the runs are, and the number of the knob."""
        texts = [self._note]
        if self._sweep is not None and self._pointed is not None:
            cs, cd = self._pointed
            texts = [f"Cs {cs:.2g}, Cd {cd:.2g}: {self._sweep.text_at(cs, cd)}"]
        elif self._sweep is not None:
            texts.append(self._sweep.text_at(self.state.stiffness, self.state.damping))
        elif self.state.subject and self.state.enabled:
            texts = [self._note or f"sag of {self.state.subject}"]
        font, inside = self.ui.font(NUMBER_SIZE), self._inside
        widest = inside.width - self.ui.font(NUMBER_SIZE, True).size(UP_NAME)[0] - self.ui.px(6)
        picture = font.render(wrapped(", ".join(filter(None, texts)), font, widest, 1)[0], True, TEXT)
        surface.blit(picture, picture.get_rect(topright=(inside.right, 0)))

    def _paint_zones(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Fill each zone in its tone; what is not proven is hatched as well, since colour alone tells nobody enough."""
        stiffness, damping = self._grid(inside)
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
            self._fill(pixels, stiffness > damping, MUTED, 0.08, rising, 0.16)
        elif zones.proven is not None:
            beyond = damping > self._edge(zones.proven, stiffness)
            if zones.holds:
                self._fill(pixels, beyond, WARNING, 0.16, rising, 0.34)
            else:
                pixels[:] = mixed(FIELD, MUTED, 0.06)
            if zones.estimated is not None and zones.holds:
                self._fill(
                    pixels, damping > self._edge(zones.estimated, stiffness), DANGER, 0.28, rising | falling, 0.5
                )
        surface.blit(pygame.surfarray.make_surface(pixels), inside)

    @staticmethod
    def _fill(pixels: np.ndarray, where: Mask, colour: Colour, share: float, hatch: Mask, hatched: float) -> None:
        pixels[where] = mixed(FIELD, colour, share)
        pixels[where & hatch] = mixed(FIELD, colour, hatched)

    def _edge(self, highest: Floats, stiffness: Floats) -> Floats:
        """The highest Cd of a zone at each Cs; 0 where nothing is inside."""
        assert self.zones is not None
        return np.interp(np.log(stiffness), np.log(self.zones.stiffness), np.maximum(highest, 0.0))

    def _grid(self, inside: pygame.Rect) -> tuple[Floats, Floats]:
        """Cs and Cd of every pixel of the map (w, h)."""
        scale = self.state.scale
        across, up = scale.values(inside.width), scale.values(inside.height)[::-1]
        stiffness, damping = np.meshgrid(across, up, indexing="ij")
        return stiffness, damping

    def _paint_axes(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Paint lines at round values, numbers beside them where there is room, and the names of both axes."""
        font, px = self.ui.font(NUMBER_SIZE), self.ui.px
        gap, right, top = px(NUMBER_GAP), -inside.width, surface.get_height()
        grid = pygame.Surface(inside.size, pygame.SRCALPHA)
        for value in self.state.scale.numbers():
            x, y = self._at(value, value)
            pygame.draw.line(grid, (*DECADE, 90), (x - inside.left, 0), (x - inside.left, inside.height))
            pygame.draw.line(grid, (*DECADE, 90), (0, y - inside.top), (inside.width, y - inside.top))
            number = font.render(f"{value:g}", True, MUTED)
            place = number.get_rect(midtop=(x, inside.bottom + px(2))).clamp(surface.get_rect())
            is_last = value == 1.0
            if place.left >= right + gap and (is_last or place.right + gap < inside.right - px(4)):
                surface.blit(number, place)
                right = place.right
            place = number.get_rect(midright=(inside.left - px(4), y)).clamp(surface.get_rect())
            if place.bottom <= top and (is_last or place.top > inside.top + px(7)):
                surface.blit(number, place)
                top = place.top
        surface.blit(grid, inside)
        bold = self.ui.font(NUMBER_SIZE, True)
        surface.blit(bold.render(UP_NAME, True, TEXT), (inside.left, 0))
        name = bold.render(ACROSS_NAME, True, TEXT)
        surface.blit(name, name.get_rect(topright=(inside.right, inside.bottom + px(17))))

    def _paint_body(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Paint how far the body sags, as lines with words between them, and where its wobble begins to swing."""
        body = self.state.body
        pixels = pygame.Surface(inside.size, pygame.SRCALPHA)
        if body is not None and body.tells_sag:
            self._sags = SagMap.of(body, self.state.scale)
            self._paint_sags(pixels, self._sags)
        if self._is_plain:
            surface.blit(pixels, inside)
            return
        stiffness, damping = self._grid(inside)
        if body is None:
            swings: Mask = swings_back(stiffness, damping)
        else:
            pair = body.of_substep(stiffness.reshape(-1), damping.reshape(-1))
            swings = swings_back(*body.whole(*pair)).reshape(stiffness.shape)
        x, y = np.nonzero(_border(swings))
        dashed = (x + y) // max(2, self.ui.px(4)) % 2 == 0
        alpha = pygame.surfarray.pixels_alpha(pixels)
        alpha[x[dashed], y[dashed]] = 255
        del alpha
        colours = pygame.surfarray.pixels3d(pixels)
        colours[x[dashed], y[dashed]] = TEXT
        del colours
        surface.blit(pixels, inside)
        if self.state.enabled:
            for words, mask in (("swings", swings), ("creeps back", ~swings)):
                self._paint_in(surface, inside, mask, words, self.ui.font(LABEL_SIZE), MUTED, 0.72)

    def _paint_sags(self, pixels: pygame.Surface, sags: SagMap) -> None:
        width, height = pixels.get_size()
        number = sags.number(width, height)[:, ::-1]
        border = np.zeros(number.shape, np.bool_)
        for k in range(int(number.max()) + 1):
            border |= _border(number == k)
        alpha = pygame.surfarray.pixels_alpha(pixels)
        alpha[border] = 110
        del alpha
        colours = pygame.surfarray.pixels3d(pixels)
        colours[border] = ACCENT
        del colours

    def _paint_sag_words(self, surface: pygame.Surface, taken: pygame.Rect) -> None:
        """Write the words between the lines of the body's sags, but for one that would lie where the knob is taken."""
        inside = self._inside
        for word, (across, up) in self._sags.places.items() if self._sags is not None else ():
            picture = self.ui.font(WORD_SIZE).render(word, True, MUTED)
            place = picture.get_rect(center=(inside.left + across * inside.width, inside.bottom - up * inside.height))
            place.clamp_ip(inside.inflate(-4, -2))
            if not place.colliderect(taken):
                surface.blit(picture, place)

    def _paint_in(
        self, surface: pygame.Surface, inside: pygame.Rect, mask: Mask, words: str, font: pygame.font.Font,
        colour: Colour, down: float,
    ) -> None:  # fmt: skip
        """Write words in the part of the map that a mask (w, h) says, about so far down; nothing where it is small."""
        if mask.mean() < WORD_SHARE:
            return
        picture = font.render(words, True, colour)
        rows = np.flatnonzero(mask.sum(axis=0) >= min(picture.get_width(), mask.sum(axis=0).max()))
        row = int(rows[np.argmin(np.abs(rows - down * inside.height))])
        across = np.flatnonzero(mask[:, row])
        at = inside.left + int(np.median(across)), inside.top + row
        surface.blit(picture, picture.get_rect(center=at).clamp(inside.inflate(-4, -2)))

    def _paint_article(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Paint the line where 1/(n+1) ends."""
        zones = self.zones
        if zones is None or zones.article is None or not self.state.enabled:
            return
        surface.set_clip(inside)
        inside_it = zones.article > 0.0
        edge = [
            self._at(float(cs), float(cd))
            for cs, cd in zip(zones.stiffness[inside_it], zones.article[inside_it], strict=True)
        ]
        if edge:
            edge.append((edge[-1][0], inside.bottom))
            pygame.draw.aalines(surface, ACCENT, False, edge)
        surface.set_clip(None)

    def _paint_words(self, surface: pygame.Surface, inside: pygame.Rect) -> None:
        """Paint the words on the map, which say what is proven where."""
        label = self.ui.font(LABEL_SIZE)
        if self.zones is None or not self.state.enabled:
            return
        for text, colour, across, down in _zone_labels(self.zones, self.state.scale):
            picture = label.render(text, True, colour)
            at = inside.left + across * inside.width, inside.top + down * inside.height
            surface.blit(picture, picture.get_rect(center=at).clamp(inside.inflate(-4, -2)))


def _border(mask: Mask) -> Mask:
    # Pixels inside a mask (w, h) that touch one outside it.
    found = np.zeros(mask.shape, np.bool_)
    found[1:] |= mask[1:] & ~mask[:-1]
    found[:, 1:] |= mask[:, 1:] & ~mask[:, :-1]
    found[:, :-1] |= mask[:, :-1] & ~mask[:, 1:]
    return found


def _zone_labels(zones: CoefficientZones, scale: CoefficientScale) -> list[tuple[str, Colour, float, float]]:
    """The words on the zones, with colour, and place in shares of the map's width and height from its upper left."""
    if zones.bounded:
        return [("may bounce higher, never explodes", MUTED, 0.66, 0.95)]
    if zones.proven is None or zones.article is None:
        return []
    found: list[tuple[str, Colour, float, float]] = []
    reach = float(zones.article.max())
    if reach > scale.lowest:
        of = f"1/(n+1), n = {zones.most_springs}" if zones.holds else "1/(n+1) of a single pass"
        found.append((of, ACCENT, scale.place_of(reach) - 0.2, 0.84))
    if not zones.holds:
        return [*found, ("not proven here", MUTED, 0.32, 0.94)]
    found.append(("proven stable", MUTED, 0.22, 0.94))
    if zones.estimated is not None and zones.estimated[0] < 0.95:
        found.append(("explodes", DANGER, 0.5, 0.5 * (1.0 - scale.place_of(float(zones.estimated[0])))))
    return found
