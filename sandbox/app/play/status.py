"""StatusLine: what is on the screen in figures, and notices that come and go."""

import math
from collections import deque
from dataclasses import dataclass

import pygame

from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, NOTICE, SURFACE, TEXT, WARNING, Colour
from sandbox.app.screen import Figures
from sandbox.app.widgets.painted import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.physics.joints.readings import MotorReading

# Sizes in layout units.
STATUS_HEIGHT = 30.0
NOTICE_SECONDS = 6.0
SECONDS_A_LETTER = 0.06
NOTICES = 4
# It fades in its last moments, and a frame is never so late [s] that it has gone before.
FADING, SOON = 0.4, 0.6
# Motors that are named one by one; of more the line says how many are at their limit.
NAMED_MOTORS = 2


@dataclass
class Notice:
    """A line for the person, that goes after some seconds."""

    text: str
    left: float = NOTICE_SECONDS


class StatusLine:
    """The line at the bottom, and the notices above it."""

    def __init__(self, ui: Ui, notices: deque[Notice]) -> None:
        self.ui = ui
        self.notices = notices
        self._texts: dict[tuple[str, Colour], pygame.Surface] = {}

    def say(self, text: str) -> None:
        """Show a line for some seconds."""
        for notice in self.notices:
            if notice.text == text:
                notice.left = NOTICE_SECONDS
                return
        self.notices.append(Notice(text, max(NOTICE_SECONDS, len(text) * SECONDS_A_LETTER)))

    def take_back(self, text: str) -> None:
        """Show a line no longer."""
        for notice in list(self.notices):
            if notice.text == text:
                self.notices.remove(notice)

    @property
    def moves(self) -> bool:
        """Whether a notice fades, or is about to."""
        return any(notice.left < SOON for notice in self.notices)

    def update(self, frame_time: float) -> None:
        """Let notices age by frame_time [s]."""
        for notice in list(self.notices):
            notice.left -= frame_time
            if notice.left <= 0.0:
                self.notices.remove(notice)

    def draw(
        self,
        surface: pygame.Surface,
        parts: list[tuple[str, Colour]],
        right: float,
        notices_place: tuple[float, float, float] | None,
    ) -> None:
        """Draw parts of text from the left up to `right`, notices from the left, above, and up to; in layout units."""
        ui = self.ui
        height = ui.px(STATUS_HEIGHT)
        top = surface.get_height() - height
        pygame.draw.rect(surface, SURFACE, (0, top, surface.get_width(), height))
        parts_end = ui.px(right)
        x = ui.px(16)
        for text, colour in parts:
            picture = self._text(text, colour)
            if x + picture.get_width() > parts_end:
                break
            surface.blit(picture, (x, top + (height - picture.get_height()) // 2))
            x += picture.get_width() + ui.px(18)
        if notices_place is not None:
            left, above, end = notices_place
            self._draw_notices_above(surface, top - ui.px(above), left, ui.px(end))

    def draw_notices(self, surface: pygame.Surface, left: float) -> None:
        """Draw the notices alone, over a page that covers the line."""
        self._draw_notices_above(surface, surface.get_height(), left, surface.get_width())

    def _draw_notices_above(self, surface: pygame.Surface, bottom: int, left: float, end: int) -> None:
        ui = self.ui
        y = bottom - ui.px(12)
        widest = min(ui.px(520), end - ui.px(left + 46))
        for notice in reversed(self.notices):
            lines = [self._text(line, TEXT) for line in wrapped(notice.text, ui.font(13), widest, 6)]
            height = sum(line.get_height() for line in lines) + ui.px(16)
            width = max(line.get_width() for line in lines) + ui.px(30)
            y -= height
            card = pygame.Surface((width, height), pygame.SRCALPHA)
            pygame.draw.rect(card, (*NOTICE, 240), card.get_rect(), border_radius=ui.px(8))
            pygame.draw.rect(card, LINE, card.get_rect(), 1, border_radius=ui.px(8))
            pygame.draw.rect(card, ACCENT, (ui.px(8), ui.px(9), ui.px(3), height - ui.px(18)), border_radius=ui.px(2))
            line_y = ui.px(8)
            for line in lines:
                card.blit(line, (ui.px(19), line_y))
                line_y += line.get_height()
            card.set_alpha(round(255 * min(1.0, notice.left / FADING)))
            surface.blit(card, (ui.px(left), y))
            y -= ui.px(8)

    def _text(self, text: str, colour: Colour) -> pygame.Surface:
        key = (text, colour)
        if key not in self._texts:
            if len(self._texts) > 400:
                self._texts.clear()
            self._texts[key] = self.ui.font(13 if colour == TEXT else 12).render(text, True, colour)
        return self._texts[key]


def _card(surface: pygame.Surface, ui: Ui, text: str, inset: float) -> pygame.Rect:
    card = pygame.Rect(0, 0, ui.px(380), ui.px(96))
    card.center = (surface.get_width() // 2, surface.get_height() // 2)
    pygame.draw.rect(surface, NOTICE, card, border_radius=ui.px(12))
    pygame.draw.rect(surface, LINE, card, 1, border_radius=ui.px(12))
    surface.blit(ui.font(15, True).render(text, True, TEXT), (card.left + ui.px(inset), card.top + ui.px(24)))
    return card


def draw_spinner(surface: pygame.Surface, ui: Ui, seconds: float, text: str, detail: str) -> None:
    """A card in the middle of the window with a turning ring, while something takes its time."""
    card = _card(surface, ui, text, 84)
    middle = pygame.Vector2(card.left + ui.px(46), card.centery)
    for dot in range(10):
        turn = math.tau * dot / 10
        age = (dot / 10 - seconds * 0.9) % 1.0
        colour = [round(a + (z - a) * age) for a, z in zip(LINE, ACCENT, strict=True)]
        at = middle + pygame.Vector2(math.cos(turn), math.sin(turn)) * ui.px(16)
        pygame.draw.aacircle(surface, colour, at, ui.px(3))
    surface.blit(ui.font(12).render(detail, True, MUTED), (card.left + ui.px(84), card.top + ui.px(50)))


def draw_bar(surface: pygame.Surface, ui: Ui, share: float, text: str) -> None:
    """A card in the middle of the window with a bar that is filled to a share (0..1)."""
    card = _card(surface, ui, text, 28)
    bar = pygame.Rect(card.left + ui.px(28), card.top + ui.px(58), card.width - ui.px(56), ui.px(6))
    pygame.draw.rect(surface, LINE, bar, border_radius=ui.px(3))
    bar.width = round(bar.width * min(max(share, 0.0), 1.0))
    pygame.draw.rect(surface, ACCENT, bar, border_radius=ui.px(3))


def counted_parts(particles: int, springs: int) -> list[tuple[str, Colour]]:
    """How many particles and springs there are."""
    counts = {"particle": particles, "spring": springs}
    return [(f"{count:,} {thing}{'' if count == 1 else 's'}", MUTED) for thing, count in counts.items()]


def status_parts(
    particles: int, springs: int, figures: Figures, non_finite: int, behind: bool
) -> list[tuple[str, Colour]]:
    """The figures of the status line, warnings first in warning colours."""
    parts: list[tuple[str, Colour]] = []
    if non_finite:
        verb = "particle is" if non_finite == 1 else "particles are"
        parts.append((f"{non_finite:,} {verb} no longer finite and not drawn: undo or reset", DANGER))
    if behind:
        parts.append(("slower than real time", WARNING))
    parts += [
        *counted_parts(particles, springs),
        (f"{figures.ticks:.0f} ticks/s", MUTED),
        (f"{figures.frames:.0f} frames/s", MUTED),
        (f"{figures.work:.1f} ms of work a frame", MUTED),
    ]
    return parts


def motor_parts(readings: list[MotorReading], carries: bool) -> list[tuple[str, Colour]]:
    """What motors give, in figures; carries: whether the solver can carry wheels at all."""
    if not readings:
        return []
    parts: list[tuple[str, Colour]] = []
    if not carries:
        parts.append(("a single pass cannot carry wheels under a load: take another solver", WARNING))
    if len(readings) > NAMED_MOTORS:
        full = sum(reading.at_limit for reading in readings)
        told = f"{full} at their limit" if full else "none at its limit"
        return [*parts, (f"{len(readings)} motors, {told}", WARNING if full else MUTED)]
    for reading in readings:
        if reading.pushes:
            text = f"motor {reading.name}: {abs(reading.torque):.3g} of {reading.limit:.3g} N m"
            parts.append((text, WARNING if reading.at_limit else MUTED))
        else:
            parts.append((f"motor {reading.name}: it pushes against nothing", WARNING))
    return parts
