"""What two runs of one level differ in, in figures, and the cards that say so over them."""

from collections.abc import Sequence

import numpy as np
import pygame

from sandbox.app.draw.colours import ACCENT, LINE, MUTED, SURFACE, TEXT, Colour
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.energy import spring_lengths
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot

# Frames between two looks; places nearer than this [m] are the same to the eye.
LOOK_EVERY = 6
SAME = 5e-4
# Sizes in layout units.
MARGIN, PADDING, TEXT_SIZE, SMALL_SIZE = 10.0, 8.0, 13.0, 11.5
OPACITY = 225


class Difference:
    """How far two runs are apart; text: in words."""

    def __init__(self) -> None:
        self.text = ""
        self._frames = 0

    def update(self, one: Snapshot, other: Snapshot) -> None:
        """Look at two states of the same level, now and then."""
        self._frames += 1
        if self._frames % LOOK_EVERY != 1:
            return
        self.text = "A and B differ in what they are made of"
        if len(one.mass) != len(other.mass):
            return
        both = shown_particles(one) & shown_particles(other)
        with np.errstate(over="ignore", invalid="ignore"):
            apart = np.where(both, np.hypot(*(one.position - other.position).T), 0.0)
        farthest = float(np.nanmax(apart, initial=0.0))
        if not np.isfinite(apart).all() or farthest > 1e4:
            self.text = "One of them has flown apart"
        elif farthest < SAME:
            self.text = "A and B are in the same place"
        else:
            self.text = f"Apart by up to {farthest:.3g} m"

    @staticmethod
    def figures(state: Snapshot) -> str:
        """What a run does, in figures."""
        moving = shown_particles(state) & (state.inverse_mass > 0.0)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            motion = 0.5 * float(np.sum(state.mass[moving] * np.sum(state.velocity[moving] ** 2, axis=1)))
            active = state.spring_active & (state.rest_length > 0.0) & (state.material >= 0)
            strain = np.abs(spring_lengths(state)[active] / state.rest_length[active] - 1.0)
        most = float(strain.max(initial=0.0))
        return f"motion {_told(motion, 'J')}   most strained {_told(100.0 * most, '%')}"


def _told(value: float, unit: str) -> str:
    """A figure that grows and shrinks, in few letters."""
    if not np.isfinite(value) or value > 1e7:
        return "beyond measure"
    digits = 0 if value >= 100.0 else 1 if value >= 10.0 else 2
    return f"{value:,.{digits}f} {unit}" if value >= 0.01 else f"0 {unit}"


def _card(surface: pygame.Surface, place: pygame.Rect, ui: Ui) -> None:
    card = pygame.Surface(place.size, pygame.SRCALPHA)
    pygame.draw.rect(card, (*SURFACE, OPACITY), card.get_rect(), border_radius=ui.px(8))
    pygame.draw.rect(card, (*LINE, 255), card.get_rect(), 1, border_radius=ui.px(8))
    surface.blit(card, place)


def draw_chip(surface: pygame.Surface, ui: Ui, area: pygame.Rect, name: str, lines: Sequence[str]) -> None:
    """A card at the top of an area [pixels] with a run's name and lines about it."""
    title = ui.font(17, True).render(name, True, ACCENT)
    fonts = [ui.font(TEXT_SIZE), *[ui.font(SMALL_SIZE)] * (len(lines) - 1)]
    inset, gap = ui.px(PADDING), ui.px(10)
    most = area.width - 2 * ui.px(MARGIN)
    room = max(most - 2 * inset - gap - title.get_width(), 1)
    texts: list[pygame.Surface] = []
    for colour, font, line in zip([TEXT] + [MUTED] * len(lines), fonts, lines, strict=False):
        for shown in [line] if font.size(line)[0] <= room else wrapped(line, font, room, 2):
            texts.append(font.render(shown, True, colour))
    width = min(most, title.get_width() + gap + max(text.get_width() for text in texts) + 2 * inset)
    height = sum(text.get_height() for text in texts) + 2 * ui.px(5)
    place = pygame.Rect(area.left + ui.px(MARGIN), area.top + ui.px(MARGIN), width, height)
    _card(surface, place, ui)
    surface.blit(title, title.get_rect(midleft=(place.left + inset, place.centery)))
    y = place.top + ui.px(5)
    for text in texts:
        surface.blit(text, (place.left + inset + title.get_width() + gap, y))
        y += text.get_height()
    surface.set_clip(None)


def draw_card_of_words(surface: pygame.Surface, ui: Ui, area: pygame.Rect, text: str) -> None:
    """A word in large letters in the middle of an area."""
    picture = ui.font(22, True).render(text, True, TEXT)
    place = picture.get_rect(center=area.center)
    _card(surface, place.inflate(ui.px(44), ui.px(28)), ui)
    surface.blit(picture, place)


def draw_pill(surface: pygame.Surface, ui: Ui, middle: tuple[int, int], text: str, colour: Colour) -> None:
    """A line on a card about a place [pixels]."""
    picture = ui.font(TEXT_SIZE).render(text, True, colour)
    place = picture.get_rect(center=middle)
    _card(surface, place.inflate(ui.px(22), ui.px(10)), ui)
    surface.blit(picture, place)
