"""CompareScreen: one level played twice side by side, A and B, with settings of their own and the same hands."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import ClassVar

import numpy as np
import pygame

from sandbox.app.base.loop import Profile
from sandbox.app.compare.second_run import TwinPlayback, coefficients_of
from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import Pixel, Pointer
from sandbox.app.draw.colours import ACCENT, LINE, MUTED, SURFACE, TEXT, Colour
from sandbox.app.film.film import Film, FilmPair, last_ticks
from sandbox.app.panel.contacts import ContactSettings
from sandbox.app.panel.engineers_rows import SOLVER_LABELS
from sandbox.app.panel.panel import Panel
from sandbox.app.panel.panel_rows import SidePanel
from sandbox.app.play.play_screen import PlayScreen
from sandbox.app.play.stage import Stage
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.energy import spring_lengths
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.compare.distance import distances

SIDES = ("A", "B")
# Layout units: halves that are narrower or lower have no figures over them; how far down the line about both is.
ROOM_FOR_FIGURES, PILL_TOP = (190.0, 260.0), 76.0
# Halves that are lower would be seen behind notices [layout units].
ROOM_FOR_NOTICES = 400.0
# How far down the legend has room: below what stands over the halves, and below that line where it is between them.
BELOW_CAPTION, BELOW_PILL = 44.0, 84.0
# How far the caption of a lower half is moved down for that line.
BELOW_LINE = 8.0
WELCOME = "The same level twice. Choose A or B in the panel and set its springs; what your hand does is done to both."
# Frames between two looks; places nearer than this [m] are the same to the eye, and farther are none.
LOOK_EVERY = 6
SAME, FLOWN_APART = 5e-4, 1e4
# Sizes in layout units.
MARGIN, PADDING, TEXT_SIZE, SMALL_SIZE = 10.0, 8.0, 13.0, 11.5
OPACITY = 225


class CompareScreen(PlayScreen):
    """Two runs on the screen: A, on which all actions of a single run work, and B beside or below it."""

    welcome: ClassVar[str] = WELCOME
    # Below what stands over the halves.
    again_top = 104.0
    room_for_notices = ROOM_FOR_NOTICES
    # One of them would be undone, and the other not.
    can_cancel = False
    # What one of them wins the other may lose.
    is_game = False

    def __init__(self, app: Application, playback: TwinPlayback, other: TwinPlayback, source: Path | None) -> None:
        playback.pair(other)
        self.beside: Stage | None = None
        # The run of one that was left for the pair, and that is gone back to.
        self.single: Playback | None = None
        self.side = SIDES[0]
        super().__init__(app, playback, source)
        self.beside = Stage(other, self.other_viewport, app.ui.scale)
        self.difference = Difference()
        self._join_stages()
        # The beginning is the same in both: they show the same part of it.
        self.stage.place(self.viewport, app.ui.scale)
        app.show_replay_progress(other, self.can_cancel)

    @property
    def other(self) -> TwinPlayback:
        """The run of B."""
        assert self.beside is not None
        playback = self.beside.playback
        assert isinstance(playback, TwinPlayback)
        return playback

    def _join_stages(self) -> None:
        """Share tools and views between both stages."""
        assert self.beside is not None
        self.beside.share_tools(self.stage)

    def _actions(self) -> dict[str, Callable[[], object]]:
        of_one, files = super()._actions(), self._app.files
        keepers = {"record": files.toggle_recording, "save_recording": files.save_run, "save": files.save_scene}
        return {**of_one, **{name: partial(self._keep_one, do) for name, do in keepers.items()}}

    def _keep_one(self, do: Callable[[], object]) -> None:
        self.say(f"A recording, and what is saved, is of one run: it holds {SIDES[0]} alone.")
        do()

    # Where the halves are.

    @property
    def _is_wide(self) -> bool:
        return self.area[2] >= self.area[3]

    @property
    def viewport(self) -> tuple[int, int, int, int]:
        """The part of the window that shows A, in pixels."""
        left, top, width, height = self.area
        return (left, top, max(width // 2, 1), height) if self._is_wide else (left, top, width, max(height // 2, 1))

    @property
    def other_viewport(self) -> tuple[int, int, int, int]:
        """The part of the window that shows B, of the same size."""
        left, top, width, height = self.viewport
        return (left + width, top, width, height) if self._is_wide else (left, top + height, width, height)

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows one of the worlds."""
        return super().contains(pixel) or pygame.Rect(self.other_viewport).collidepoint(pixel)

    def _in_first(self, pixel: Pixel) -> Pixel:
        """Where in A the same place is as at a pixel of either half."""
        if super().contains(pixel) or not pygame.Rect(self.other_viewport).collidepoint(pixel):
            return pixel
        (left, top, _, _), (other_left, other_top, _, _) = self.viewport, self.other_viewport
        return pixel[0] - other_left + left, pixel[1] - other_top + top

    # Building.

    def build(self, ui: Ui) -> None:
        """Lay the bar, the panel and both halves out again."""
        super().build(ui)
        if self.beside is not None:
            self.beside.place(self.other_viewport, ui.scale)
            self.beside.renderer.follow_theme()

    def _make_panel(self, ui: Ui, choices: dict[str, Callable[[str], None]], height: float) -> SidePanel:
        self.shape.side = self.side
        playback = self.playback if self.side == SIDES[0] or self.beside is None else self.other
        return Panel(
            ui,
            playback,
            self.say,
            {**choices, "side": self.choose_side},
            BAR_HEIGHT,
            height,
            self.shape,
            self.set_contacts,
        )

    def set_contacts(self, contacts: ContactSettings) -> None:
        """Change nothing, and say why: A and B are runs of one level."""
        self.say("A and B are of one level. Leave the comparison (F9) to change how things touch.")

    def _ask_rate(self, typed: str) -> None:
        self.say(f"A and B go by one clock. Leave the comparison (F9) to play at {typed} ticks a second.")

    def choose_side(self, side: str) -> None:
        """Show and set in the panel the springs and solver of that run."""
        self.side = side
        self._app.rebuild()

    def _next_runs(self) -> tuple[TwinPlayback, TwinPlayback]:
        """Fresh sessions of both runs."""
        assert isinstance(self.playback, TwinPlayback)
        return self.playback.reset(), self.other.reset()

    def _begin_again(self, keeps_tuning: bool) -> None:
        assert self.beside is not None
        one, other = self._next_runs()
        one.pair(other)
        self.stage.replace_playback(one)
        self.beside.replace_playback(other)
        self._join_stages()
        self.difference = Difference()
        self._app.show_replay_progress(other, self.can_cancel)

    def restart(self, as_it_was: bool = False) -> None:
        """Begin both runs again."""
        super().restart(as_it_was)
        if self.panel is not None and self.side == SIDES[1]:
            self.panel.attach(self.other)

    def film(self, seconds: float) -> FilmPair:
        """Film of both runs, with their settings as captions."""
        assert self.beside is not None
        words = [f"{side}   {text}" for side, text in zip(SIDES, self._settings_words(), strict=True)]
        span = self.playback.travel.span or last_ticks(self.playback.session, seconds)
        box, stages = self.stage.fitted_box, (self.stage, self.beside)
        films = [Film(each.playback.session, each.camera, each.renderer, span, box) for each in stages]
        return FilmPair(films, words, self._is_wide)

    # Pointer: a press picks from the half that it is in, and what it does is done to both.

    def point(self, kind: Pointer, pixel: Pixel, modifiers: int, clicks: int = 1) -> None:
        """Hand a pointer event to the tool."""
        if kind == "down":
            self.stage.cursor = None
            self._picked_beside = not super().contains(pixel)
        among = self.other.current if self._picked_beside else None
        if self._picked_beside and self.other.has_pending:
            self.other.apply_pending()
            among = self.other.current
        (left, top, _, _), (other_left, other_top, _, _) = self.viewport, self.other_viewport
        shift = (other_left - left, other_top - top) if self._picked_beside else (0, 0)
        self.stage.point(kind, (pixel[0] - shift[0], pixel[1] - shift[1]), modifiers, among=among)

    _picked_beside = False

    def open_menu(self, pixel: Pixel) -> None:
        """Open nothing: of a pair, what is done to one would not be done to the other."""

    def turn_wheel(self, pixel: Pixel, steps: float) -> None:
        """Resize the part that is about to be dropped, or zoom both views."""
        super().turn_wheel(self._in_first(pixel), steps)

    # A frame.

    @property
    def rests(self) -> bool:
        """Whether time passes, and yet nothing moves in either."""
        return super().rests and self.beside is not None and self.beside.rests

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Advance both runs by the same time."""
        assert self.beside is not None
        super().update(frame_time, None if pointer is None else self._in_first(pointer), profile)
        with profile.part("ticks"):
            self.other.follow(self.playback.session.tick)
        self.beside.rest_timer.follow(self.other.current, self.camera.zoom, frame_time)
        super()._measure(self._ticks_made, profile)
        self.difference.update(self.playback.current, self.other.current)
        self._show_ghost()

    def _show_ghost(self) -> None:
        """Mark on the pad the Cs and Cd of the other side's springs."""
        panel = self.panel
        if panel is not None and panel.pad is not None:
            there = self.other if self.side == SIDES[0] else self.playback
            name = SIDES[1] if self.side == SIDES[0] else SIDES[0]
            panel.pad.show_ghost(self.side, name, coefficients_of(there.session.world, panel.material))

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw both runs, the settings of each, and how far apart they are."""
        assert self.beside is not None
        super().draw(surface, profile)
        mine, its = self.stage, self.beside
        its.camera.centre, its.camera.zoom = mine.camera.centre, mine.camera.zoom
        its.cursor = mine.cursor
        its.renderer.compiled, its.renderer.detail = mine.renderer.compiled, mine.renderer.detail
        its.renderer.has_effects = mine.renderer.has_effects
        its.draw(surface, profile)
        top_of_first = self.viewport[1]
        left, top, width, height = self.other_viewport
        end = (left, top + height) if self._is_wide else (left + width, top)
        pygame.draw.line(surface, LINE, (left, top), end, max(2, self._ui.px(2)))
        for side, viewport, lines in zip(SIDES, (self.viewport, self.other_viewport), self.captions(), strict=True):
            is_small = any(long < self._ui.px(most) for long, most in zip(viewport[2:], ROOM_FOR_FIGURES, strict=True))
            # The line about both lies on the upper edge of the lower half.
            below = self._ui.px(BELOW_LINE) if viewport[1] != top_of_first else 0
            place = pygame.Rect(viewport[0], viewport[1] + below, viewport[2], viewport[3] - below)
            draw_chip(surface, self._ui, place, side, lines[:1] if is_small else lines)
        if self.difference.text:
            draw_pill(surface, self._ui, self._pill_place, self.difference.text, TEXT)

    @property
    def _pill_place(self) -> tuple[int, int]:
        """The middle [pixels] of the line of text about both runs: it lies on the border between the halves."""
        left, top, width, height = self.area
        across = left + width // 2
        return across, top + (self._ui.px(PILL_TOP) if self._is_wide else height // 2)

    @property
    def _legend_area(self) -> pygame.Rect:
        """The place for the legend [pixels], below the captions, which are as wide as the halves."""
        area, above = super()._legend_area, self._ui.px(BELOW_PILL if self._is_wide else BELOW_CAPTION)
        return pygame.Rect(area.left, area.top + above, area.width, max(area.height - above, 0))

    def _measured(self) -> list[tuple[str, Playback]]:
        if self.beside is None:
            return super()._measured()
        return [("A ", self.playback), ("B ", self.other)]

    def _measure(self, ticks: int, profile: Profile) -> None:
        """Note how many ticks A made; `update` measures once B is at the same tick."""
        self._ticks_made = ticks

    _ticks_made = 0

    def captions(self) -> tuple[list[str], list[str]]:
        """The caption of each half: its settings, and how its run goes."""
        return self._caption(self.playback), self._caption(self.other)

    def _caption(self, playback: TwinPlayback | object) -> list[str]:
        assert isinstance(playback, TwinPlayback)
        world = playback.session.world
        settings, pair = world.settings, coefficients_of(world, None if self.panel is None else self.panel.material)
        springs = "several springs" if pair is None else f"Cs {pair[0]:.3g}  Cd {pair[1]:.3g}"
        solver = SOLVER_LABELS[settings.solver]
        parts = "" if settings.substeps == 1 else f", {settings.substeps} substeps"
        return [f"{springs}   {solver}{parts}", self.difference.figures(playback.current)]

    def _settings_words(self) -> list[str]:
        """The settings of both runs, a line each, which holds for all that was seen."""
        return [lines[0] for lines in self.captions()]

    def title(self) -> str:
        """Title of the window."""
        return f"{super().title()}, two settings"


class Difference:
    """Distance of two runs; text: in words."""

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
        farthest = float(distances(one, other).max(initial=0.0))
        if farthest > FLOWN_APART:
            self.text = "One of them has flown apart"
        elif farthest < SAME:
            self.text = "A and B are in the same place"
        else:
            self.text = f"Apart by up to {farthest:.3g} m"

    @staticmethod
    def figures(state: Snapshot) -> str:
        """Energy and strain of a run's state, in words."""
        moving = shown_particles(state) & (state.inverse_mass > 0.0)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            motion = 0.5 * float(np.sum(state.mass[moving] * np.sum(state.velocity[moving] ** 2, axis=1)))
            active = state.spring_active & (state.rest_length > 0.0) & (state.material >= 0)
            strain = np.abs(spring_lengths(state)[active] / state.rest_length[active] - 1.0)
        most = float(strain.max(initial=0.0))
        return f"motion {_with_unit(motion, 'J')}   most strained {_with_unit(100.0 * most, '%')}"


def _with_unit(value: float, unit: str) -> str:
    """A value with its unit, in few letters."""
    if not np.isfinite(value) or value > 1e7:
        return "beyond measure"
    digits = 0 if value >= 100.0 else 1 if value >= 10.0 else 2
    return f"{value:,.{digits}f} {unit}" if value >= 0.01 else f"0 {unit}"


def draw_chip(surface: pygame.Surface, ui: Ui, area: pygame.Rect, name: str, lines: Sequence[str]) -> None:
    """Draw a card at the top of an area [pixels] with a run's name and lines about it."""
    title = ui.font(17, True).render(name, True, ACCENT)
    fonts = [ui.font(TEXT_SIZE), *[ui.font(SMALL_SIZE)] * (len(lines) - 1)]
    inset, gap = ui.px(PADDING), ui.px(10)
    most = area.width - 2 * ui.px(MARGIN)
    text_width = max(most - 2 * inset - gap - title.get_width(), 1)
    texts: list[pygame.Surface] = []
    for colour, font, line in zip([TEXT] + [MUTED] * len(lines), fonts, lines, strict=False):
        for shown in [line] if font.size(line)[0] <= text_width else wrapped(line, font, text_width, 2):
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
    """Draw a word in large letters in the middle of an area."""
    picture = ui.font(22, True).render(text, True, TEXT)
    place = picture.get_rect(center=area.center)
    _card(surface, place.inflate(ui.px(44), ui.px(28)), ui)
    surface.blit(picture, place)


def draw_pill(surface: pygame.Surface, ui: Ui, middle: tuple[int, int], text: str, colour: Colour) -> None:
    """Draw a line of text on a card about a place [pixels]."""
    picture = ui.font(TEXT_SIZE).render(text, True, colour)
    place = picture.get_rect(center=middle)
    _card(surface, place.inflate(ui.px(22), ui.px(10)), ui)
    surface.blit(picture, place)


def _card(surface: pygame.Surface, place: pygame.Rect, ui: Ui) -> None:
    card = pygame.Surface(place.size, pygame.SRCALPHA)
    pygame.draw.rect(card, (*SURFACE, OPACITY), card.get_rect(), border_radius=ui.px(8))
    pygame.draw.rect(card, (*LINE, 255), card.get_rect(), 1, border_radius=ui.px(8))
    surface.blit(card, place)
