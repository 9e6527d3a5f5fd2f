"""StatusLine: what is on the screen in figures, notices that come and go, and a bar while a run is played again."""

import time
from collections import deque
from dataclasses import dataclass

import pygame

from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import Figures, NoticesPlace, Pixel
from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, NOTICE, SURFACE, TEXT, WARNING, Colour, mixed
from sandbox.app.panel.readings import number
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.applied_forces import MotorReading, motor_readings
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.solvers import SOLVERS
from sandbox.session.transaction import Interrupted

# Sizes in layout units.
STATUS_HEIGHT = 30.0
NOTICE_SECONDS = 6.0
SECONDS_A_LETTER = 0.06
NOTICES = 4
# Where notices over the status line are from the edges [layout units].
LOW_EDGE, LOW_BOTTOM, LOW_INSET = 10.0, 4.0, 5.0
# A part of the line that has less room is left out, not shortened [layout units].
LEAST_PART = 60.0
# It fades in its last moments, and a frame is never so late [s] that it has gone before.
FADING, SOON = 0.4, 0.6
# Motors that are named one by one; of more the line says how many are at their limit.
NAMED_MOTORS = 2
NO_LOADS = "the single pass cannot carry loaded wheels: choose another solver"


@dataclass
class Notice:
    """A line for the person, that goes after some seconds; of_page: it was said while a page lay over the screen.

    screen: what it was said on, and ends with.
    """

    text: str
    left: float = NOTICE_SECONDS
    of_page: bool = False
    screen: object = None


class StatusLine:
    """The status line at the bottom of the window, and the notices above it."""

    def __init__(self, ui: Ui, notices: deque[Notice]) -> None:
        self.ui = ui
        self.notices = notices
        # Whether the newest notice alone is shown; then the others wait.
        self._one_by_one = False
        self._texts: dict[tuple[str, Colour], pygame.Surface] = {}

    def say(self, text: str, screen: object = None) -> None:
        """Show a line for some seconds, as long as a screen lasts (None: whatever is on it)."""
        said = Notice(text, max(NOTICE_SECONDS, len(text) * SECONDS_A_LETTER), self.ui.has_sheet, screen)
        for place, notice in enumerate(self.notices):
            if notice.text == text:
                self.notices[place] = said
                return
        self.notices.append(said)

    def end_with(self, screen: object) -> None:
        """Remove the notices of a screen that is closed."""
        for notice in list(self.notices):
            if notice.screen is screen:
                self.notices.remove(notice)

    def take_back(self, text: str) -> None:
        """Show a line no longer."""
        for notice in list(self.notices):
            if notice.text == text:
                self.notices.remove(notice)

    @property
    def moves(self) -> bool:
        """Whether a notice fades, or is about to."""
        return any(notice.left < SOON for notice in self._ageing)

    @property
    def _ageing(self) -> list[Notice]:
        return list(self.notices)[-1 if self._one_by_one else 0 :]

    def update(self, frame_time: float) -> None:
        """Age the notices by frame_time [s]."""
        for notice in self._ageing:
            notice.left -= frame_time
            if notice.left <= 0.0:
                self.notices.remove(notice)

    def draw(self, surface: pygame.Surface, parts: list[tuple[str, Colour]]) -> None:
        """Draw parts of text from the left; of those that have no room figures are left out, words shortened."""
        ui = self.ui
        height, end = ui.px(STATUS_HEIGHT), surface.get_width() - ui.px(8)
        top = surface.get_height() - height
        pygame.draw.rect(surface, SURFACE, (0, top, surface.get_width(), height))
        x = ui.px(16)
        for text, colour in parts:
            picture = self._text(text, colour)
            if x + picture.get_width() > end:
                if colour == MUTED or end - x < ui.px(LEAST_PART):
                    break
                shortened = wrapped(text, self._font(colour), end - x, 1)[0]
                picture = self._text(shortened, colour)
            surface.blit(picture, (x, top + (height - picture.get_height()) // 2), (0, 0, end - x, height))
            x += picture.get_width() + ui.px(18)

    def draw_notices(self, surface: pygame.Surface, place: NoticesPlace | None, *, over_page: bool | None) -> None:
        """Draw notices above a place [layout units]: left edge, how far above the status line, right end.

        place: None = the newest alone, over the status line. over_page: those said while a page was open, or those said
        before; None = all.
        """
        shown = [notice for notice in self.notices if over_page is None or notice.of_page == over_page]
        self._one_by_one = place is None and over_page is None
        ui, bottom = self.ui, surface.get_height()
        if place is None:
            edge = ui.px(LOW_EDGE)
            for notice in shown[-1:]:
                card = self._card(notice, surface.get_width() - 2 * edge, surface.get_width() - 2 * edge, LOW_INSET)
                surface.blit(card, (edge, bottom - card.get_height() - ui.px(LOW_BOTTOM)))
            return
        left, above, end = place
        y = bottom - ui.px(STATUS_HEIGHT + above + 12)
        for notice in reversed(shown):
            card = self._card(notice, 0, min(ui.px(550), ui.px(end - left - 16)), 8.0)
            y -= card.get_height()
            surface.blit(card, (ui.px(left), y))
            y -= ui.px(8)

    def _card(self, notice: Notice, least: int, most: int, inset: float) -> pygame.Surface:
        """A notice on a card at least and at most so wide [pixels]; inset [layout units]: above and below its text."""
        ui = self.ui
        lines = [self._text(line, TEXT) for line in wrapped(notice.text, self._font(TEXT), most - ui.px(30), 6)]
        height = sum(line.get_height() for line in lines) + ui.px(2 * inset)
        width = max(least, max(line.get_width() for line in lines) + ui.px(30))
        card = pygame.Surface((width, height), pygame.SRCALPHA)
        # Over the world something of it shows; over the status line nothing of that.
        pygame.draw.rect(card, (*NOTICE, 255 if least else 240), card.get_rect(), border_radius=ui.px(8))
        pygame.draw.rect(card, LINE, card.get_rect(), 1, border_radius=ui.px(8))
        stripe = (ui.px(8), ui.px(inset + 1), ui.px(3), height - ui.px(2 * inset + 2))
        pygame.draw.rect(card, ACCENT, stripe, border_radius=ui.px(2))
        y = ui.px(inset)
        for line in lines:
            card.blit(line, (ui.px(19), y))
            y += line.get_height()
        card.set_alpha(round(255 * min(1.0, notice.left / FADING)))
        return card

    def _font(self, colour: Colour) -> pygame.font.Font:
        return self.ui.font(13 if colour == TEXT else 12)

    def _text(self, text: str, colour: Colour) -> pygame.Surface:
        key = (text, colour)
        if key not in self._texts:
            if len(self._texts) > 400:
                self._texts.clear()
            self._texts[key] = self._font(colour).render(text, True, colour)
        return self._texts[key]


def run_parts(playback: Playback, state: str, non_finite: int, figures: Figures | None) -> list[tuple[str, Colour]]:
    """Parts of the status line about a run: its state in a word, its recording, what goes wrong.

    non_finite: how many particles are nowhere. figures: those of the loop, told with tick, motors and counts; None =
    none of that is.
    """
    parts: list[tuple[str, Colour]] = [(state, ACCENT if not playback.clock.paused else WARNING)]
    if playback.session.recording is not None:
        parts.append((f"recording {playback.session.recording.name}", DANGER))
    if playback.replay is not None:
        parts.append((playback.outcome or f"recording, {playback.replay.ticks:,} ticks", TEXT))
    world, current = playback.session.world, playback.current
    readings = motor_readings(world)
    if readings and not SOLVERS[world.settings.solver].joints_bear_load:
        parts.append((NO_LOADS, WARNING))
    parts += warnings(non_finite, playback.behind)
    if figures is None:
        return parts
    counts = int(shown_particles(current).sum()), int(shown_springs(current).sum())
    parts.append((f"tick {playback.session.tick:,}", MUTED))
    return [*parts, *motor_parts(readings), *counted_parts(*counts), *rate_parts(figures)]


def motor_parts(readings: list[MotorReading]) -> list[tuple[str, Colour]]:
    """Parts of the status line with the torque that motors give."""
    if len(readings) > NAMED_MOTORS:
        full = sum(reading.at_limit for reading in readings)
        limited = f"{full} at their limit" if full else "none at its limit"
        return [(f"{len(readings)} motors, {limited}", WARNING if full else MUTED)]
    parts: list[tuple[str, Colour]] = []
    for reading in readings:
        if reading.pushes:
            text = f"motor {reading.name}: {number(abs(reading.torque))} of {number(reading.limit)} N m"
            parts.append((text, WARNING if reading.at_limit else MUTED))
        else:
            parts.append((f"motor {reading.name}: it turns freely", WARNING))
    return parts


def warnings(non_finite: int, behind: bool) -> list[tuple[str, Colour]]:
    """Parts of the status line that warn of a run; non_finite: how many particles are nowhere."""
    parts: list[tuple[str, Colour]] = []
    if non_finite:
        verb = "particle is" if non_finite == 1 else "particles are"
        parts.append((f"{non_finite:,} {verb} left the world and are not drawn: undo or reset", DANGER))
    if behind:
        parts.append(("slower than real time", WARNING))
    return parts


def rate_parts(figures: Figures) -> list[tuple[str, Colour]]:
    """Parts of the status line with ticks and frames a second, and the work of each [ms]."""
    return [
        (f"{figures.ticks:.0f} ticks/s", MUTED),
        (f"{figures.frames:.0f} frames/s", MUTED),
        (f"{figures.work:.1f} ms of work a frame", MUTED),
    ]


def counted_parts(particles: int, springs: int) -> list[tuple[str, Colour]]:
    """Parts of the status line with the counts of particles and springs."""
    counts = {"particle": particles, "spring": springs}
    return [(f"{count:,} {thing}{'' if count == 1 else 's'}", MUTED) for thing, count in counts.items()]


# What takes no longer than this [s] shows nothing; then the bar is drawn this often [s].
_PATIENCE = 0.3
_DRAWN_EVERY = 0.05
# A pause between two reports longer than this [s] is the beginning of something new.
_NEW_AFTER = 1.0
# What is begun while the bar is seen is meant for what it hides, and not for a dialog that comes after it.
_BEGUN = (pygame.KEYDOWN, pygame.TEXTINPUT, pygame.MOUSEBUTTONDOWN, pygame.MOUSEWHEEL)
_ENDING = (pygame.QUIT, pygame.WINDOWCLOSE)
_PLAYING_AGAIN = "Playing the run again"


class RunProgress:
    """Called with what is done and all there is, while a session steps again or other work holds the window."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._started = self._last = self._drawn = 0.0
        self._done = 0.0
        self._is_seen = False
        # Where the button is that cancels it [pixels].
        self._button = pygame.Rect(0, 0, 0, 0)

    def show(self, done: float, total: float, can_cancel: bool, text: str = _PLAYING_AGAIN) -> None:
        """Draw the bar, where it has taken long enough to wonder. Raises Interrupted where the person cancels it."""
        now = time.perf_counter()
        if done < self._done or now - self._last > _NEW_AFTER:
            self._started = now
        self._last, self._done = now, done
        if now - self._started < _PATIENCE or now - self._drawn < _DRAWN_EVERY:
            return
        pygame.event.pump()
        if can_cancel and self._is_cancelled():
            self._last = 0.0
            raise Interrupted
        self._drawn, self._is_seen = now, True
        display, fraction = self._app.display, done / max(total, 1)
        if can_cancel:
            self._button = draw_work(display.surface, self._app.ui, fraction, text, self._pixel(pygame.mouse.get_pos()))
        else:
            draw_bar(display.surface, self._app.ui, fraction, text)
        display.flip()

    def _is_cancelled(self) -> bool:
        """Whether Escape or the button was pressed since the bar is seen, or the window is to be closed."""
        begun = pygame.event.get(_BEGUN) if self._is_seen else []
        return any(self._cancels(event) for event in begun) or pygame.event.peek(_ENDING)

    def _cancels(self, event: pygame.event.Event) -> bool:
        if event.type == pygame.KEYDOWN:
            return bool(event.key == pygame.K_ESCAPE)
        return event.type == pygame.MOUSEBUTTONDOWN and self._button.collidepoint(self._pixel(event.pos))

    def _pixel(self, position: tuple[int, int]) -> tuple[float, float]:
        ratio = self._app.display.pixel_ratio
        return position[0] * ratio[0], position[1] * ratio[1]

    def end(self) -> None:
        """Forget keys and presses of a frame that showed the bar."""
        if self._is_seen:
            self._is_seen = False
            pygame.event.clear(_BEGUN)


def draw_work(surface: pygame.Surface, ui: Ui, fraction: float, text: str, pointer: Pixel) -> pygame.Rect:
    """A bar that a button cancels; where that is. pointer: where the mouse is [pixels]."""
    card = draw_bar(surface, ui, fraction, text, 142)
    middle = card.bottom - ui.px(40)
    hint = ui.font(12).render("Escape cancels.", True, MUTED)
    surface.blit(hint, hint.get_rect(midleft=(card.left + ui.px(28), middle)))
    button = pygame.Rect(0, 0, ui.px(96), ui.px(32))
    button.midright = (card.right - ui.px(28), middle)
    pygame.draw.rect(surface, mixed(NOTICE, TEXT, 0.18 if button.collidepoint(pointer) else 0.07), button, 0, ui.px(6))
    pygame.draw.rect(surface, LINE, button, 1, ui.px(6))
    word = ui.font(13).render("Cancel", True, TEXT)
    surface.blit(word, word.get_rect(center=button.center))
    return button


def draw_bar(surface: pygame.Surface, ui: Ui, fraction: float, text: str, height: float = 96) -> pygame.Rect:
    """A card in the middle of the window with a bar that is filled to a share (0..1); where the card is."""
    card = _card(surface, ui, text, 28, height)
    bar = pygame.Rect(card.left + ui.px(28), card.top + ui.px(58), card.width - ui.px(56), ui.px(6))
    pygame.draw.rect(surface, LINE, bar, border_radius=ui.px(3))
    bar.width = round(bar.width * min(max(fraction, 0.0), 1.0))
    pygame.draw.rect(surface, ACCENT, bar, border_radius=ui.px(3))
    return card


def _card(surface: pygame.Surface, ui: Ui, text: str, inset: float, height: float = 96) -> pygame.Rect:
    card = pygame.Rect(0, 0, ui.px(380), ui.px(height))
    card.center = (surface.get_width() // 2, surface.get_height() // 2)
    pygame.draw.rect(surface, NOTICE, card, border_radius=ui.px(12))
    pygame.draw.rect(surface, LINE, card, 1, border_radius=ui.px(12))
    surface.blit(ui.font(15, True).render(text, True, TEXT), (card.left + ui.px(inset), card.top + ui.px(24)))
    return card
