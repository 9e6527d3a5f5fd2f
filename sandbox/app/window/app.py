"""App: the window, its loop, its pages, and the screen that fills it."""

import gc
import time
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.base.display import SCALE_RANGE, Display, StartRequest, fitting_layout, keep_window
from sandbox.app.base.idle import IDLE_RATE, RESTING_RATE, IdleCollector, IdleTimer, wait_for_event
from sandbox.app.base.loop import FRAME_RATE, Profile
from sandbox.app.base.shortcuts import Mode, hint, use_keys
from sandbox.app.compare.compare_screen import CompareScreen
from sandbox.app.compare.hooke_lesson import HookeLesson
from sandbox.app.compare.second_run import TwinPlayback
from sandbox.app.contracts.screen import Figures, Screen
from sandbox.app.draw.colours import BACKGROUND, show_theme
from sandbox.app.edit.documents import DocumentActions
from sandbox.app.edit.tour import Guide
from sandbox.app.gallery.gallery import Gallery
from sandbox.app.gallery.sections import FIRST
from sandbox.app.play.melt_lesson import MeltLesson
from sandbox.app.play.play_screen import PlayScreen
from sandbox.app.play.status import NOTICES, STATUS_HEIGHT, Notice, RunProgress, StatusLine
from sandbox.app.run.keeping import BestKeeping, SceneKeeping
from sandbox.app.run.playback import Playback
from sandbox.app.settings.chosen import Chosen, theme_of
from sandbox.app.settings.settings_sheet import SettingsSheet
from sandbox.app.share.page import LinkCopying, SharePage
from sandbox.app.share.sharing import Sharing
from sandbox.app.sound.sounds import Sounds
from sandbox.app.toy.toy_start import ToyStarter
from sandbox.app.widgets.dialogs import show_lines
from sandbox.app.widgets.ui import Ui
from sandbox.app.window.failure import FrameGuard
from sandbox.app.window.files import FileActions
from sandbox.app.window.help import show_help
from sandbox.app.window.input import Input
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.reading.files import load_level, read_level
from sandbox.physics.jit import use_threads, usual_threads

# How often the status figures and the window title change [s].
FIGURES_EVERY = 0.5
# Settings that all widgets are laid out again for.
LAID_OUT = ("theme", "scale", "keys")


class App:
    """The app in its window; `frame` is one turn of the loop; `screen` is what the window shows under its pages."""

    def __init__(self, display: Display, profile: Profile | None = None, chosen: Chosen | None = None) -> None:
        self.display = display
        self.chosen = chosen or Chosen()
        self.chosen.changed = self._obey
        self.chosen.automatic["scale"] = display.scale
        self._take_up()
        self.profile = profile or Profile()
        self._collector = IdleCollector()
        self.idle = IdleTimer()
        self._notices: deque[Notice] = deque(maxlen=NOTICES)
        self._description = ""
        self.running = True
        # Whether the window's title says what happens, too.
        self.says_states = False
        # Where the pages of the gallery were left, by mode and page.
        self._gallery_places: dict[tuple[Mode, str], tuple[str, float]] = {}
        self.screen: Screen | None = None
        # What was on it when a frame ended last.
        self._seen: Screen | None = None
        self.input = Input(self)
        self.scenes = SceneKeeping()
        self.best = BestKeeping()
        self.files = FileActions(self)
        self.documents = DocumentActions(self)
        self.guide = Guide(self, self.documents)
        self.sharing = Sharing(self)
        self.link_copying = LinkCopying(self)
        self.share_page = SharePage(self, self.sharing, self.link_copying.begin)
        self.sounds = Sounds(self.chosen, time.perf_counter)
        self._progress = RunProgress(self)
        self._toys = ToyStarter()
        self._own_actions = self._actions()
        self._figures = Figures()
        self._counted = [0.0, 0, 0, 0.0]
        self._seconds = 0.0
        self._build_ui()
        for fault in self.chosen.faults:
            self.say(fault)

    # What is on the screen.

    def open(self, request: StartRequest) -> None:
        """Open the level, recording or editor that the program was started for."""
        if request.replay is not None:
            self.start(Playback(request.replay.level, request.replay))
        elif request.level is not None:
            self.start(Playback(request.level), request.source)
        elif request.edit is not None:
            self.documents.begin(request.edit)
        else:
            self.open_gallery()
            if request.scene is not None:
                self.files.open_scene(request.scene)

    @property
    def play(self) -> PlayScreen | None:
        """The run that is on the screen, if it is one."""
        return self.screen if isinstance(self.screen, PlayScreen) else None

    @property
    def mode(self) -> Mode:
        """The mode whose shortcuts hold now."""
        return "play" if self.screen is None else self.screen.mode

    def _build_ui(self) -> None:
        self.gallery: Gallery | None = None
        size, scale = fitting_layout(self.display.size, self.scale)
        self.ui = Ui(size, scale, self.display.pixel_ratio)
        self.status = StatusLine(self.ui, self._notices)
        if self.screen is not None:
            self.screen.build(self.ui)
        self.guide.build()

    def rebuild(self) -> None:
        """Lay everything out again, after the window or the scale changed."""
        before = self.ui
        self._build_ui()
        self.ui.adopt_sheets(before)
        self._collector.expect_old_garbage()

    def say(self, text: str, screen: Screen | None = None) -> None:
        """Show a line to the person for some seconds; screen: what it is about, and ends with."""
        self.status.say(text, screen)

    def take_back(self, text: str) -> None:
        """Remove a line that no longer holds."""
        self.status.take_back(text)

    def end_messages(self, screen: Screen) -> None:
        """Remove all lines about a screen."""
        self.status.end_with(screen)

    def offer_tour(self) -> None:
        """Offer the tour of the editor to who has not seen it."""
        self.guide.offer()

    def show_faults(self, title: str, faults: list[str]) -> None:
        """Show lines in a box; the app goes on with what it had."""
        show_lines(self.ui, title, faults)

    def show_screen(self, screen: Screen) -> None:
        """Fill the window with another screen."""
        self.close_gallery()
        self._describe("")
        if self.screen is not None and self.screen is not screen:
            self.end_messages(self.screen)
            self.screen.leave()
        self.screen = screen
        before = self.ui
        self._build_ui()
        self.ui.adopt_sheets(before, questions_alone=True)
        self._collector.expect_old_garbage()

    def start(self, playback: Playback, source: Path | None = None) -> None:
        """Show another run from its beginning; source: the file of its level."""
        self.show_screen(PlayScreen(self, playback, source))
        shown = playback.replay is None and self.chosen["hints"] == "show"
        self._describe(hint(playback.level.description) if shown else "")

    def start_document(self, playback: Playback) -> PlayScreen:
        """Show a run of the level that the editor has open."""
        screen = PlayScreen(self, playback, of_document=True)
        self.show_screen(screen)
        return screen

    def _describe(self, description: str) -> None:
        """Say what a level is about, in place of what the one before it was."""
        self.status.take_back(self._description)
        self._description = description
        if description:
            self.say(description)

    def _show_hint(self) -> None:
        """Show the description of the run's level once more."""
        if self.play is not None:
            self._describe(hint(self.play.playback.level.description) or "This level has no description.")

    def show_replay_progress(self, playback: Playback, can_cancel: bool = True) -> None:
        """Show a bar while a run is played again, for an undo or a recording, where that takes long."""
        playback.session.progress = partial(self._progress.show, can_cancel=can_cancel)

    def show_progress(self, done: float, text: str) -> None:
        """Show how much of what the window waits for is done, 0..1. Raises Interrupted where the person cancels it."""
        self._progress.show(done, 1.0, can_cancel=True, text=text)

    def open_gallery(self, section: str = "levels", query: str = "") -> None:
        """Choose a level or a recording; query: what is searched."""
        self.close_gallery()
        self._describe("")
        if self.screen is not None:
            self.end_messages(self.screen)
        place = self._gallery_places.get((self.mode, section), ("", 0.0))
        self.gallery = Gallery(self.ui, self, section, self.close_gallery, query, place)

    def close_gallery(self) -> None:
        """Go back to the screen, where there is one."""
        if self.gallery is not None:
            self._gallery_places[self.mode, self.gallery.section] = self.gallery.place
            self.gallery.close()
            self.gallery = None
            # Its cards hold tens of megabytes of pictures.
            self._collector.expect_old_garbage()

    # Actions.

    def _actions(self) -> dict[str, Callable[[], object]]:
        return {
            "fullscreen": self.display.toggle_fullscreen,
            "larger": lambda: self._rescale(1.125),
            "smaller": lambda: self._rescale(1 / 1.125),
            "usual_size": lambda: self.chosen.choose("scale", None),
            "settings": self._open_settings,
            "help": lambda: show_help(self.ui, self.mode, self.guide.begin),
            "tour": self.guide.begin,
            "quit": self.quit,
        }

    def _play_actions(self) -> dict[str, Callable[[], object]]:
        return {
            "hint": self._show_hint,
            "share": self.share_page.open,
            "copy_link": self.link_copying.begin,
            "compare": self._compare,
            "sound": self._toggle_sound,
            "toy": self._start_toy,
        }

    def _first_actions(self) -> dict[str, Callable[[], object]]:
        """Actions that are possible before there is a screen."""
        return {"open": self.files.ask_to_open, "recordings": lambda: self.open_gallery("recordings")}

    def start_lesson(self) -> None:
        """Begin the lesson on Hooke's spring and the article's."""
        self.show_screen(HookeLesson(self))

    def start_melt(self) -> None:
        """Begin the lesson on springs that are solved one by one."""
        self.show_screen(MeltLesson(self, Playback(load_level(FIRST))))

    def start_pair(self, path: Path) -> None:
        """Play the level of a file twice side by side, with the pad in the panel."""
        try:
            level = read_level(path)
        except LevelError as error:
            self.show_faults(f"{one_line(path.name)} cannot be opened", error.faults)
            return
        screen = CompareScreen(self, TwinPlayback(level), TwinPlayback(level), None)
        screen.shape.springs = "pad"
        self.show_screen(screen)

    def _compare(self) -> None:
        """Play the level of the run twice side by side, with two settings; or back to once."""
        play = self.play
        if play is None:
            return
        level, source = play.playback.level, play.source
        if isinstance(play, CompareScreen):
            self.start(play.single or Playback(level), source)
        elif play.of_document:
            self.say("This run belongs to the editor. Save the level and open its file to compare two settings.")
        else:
            pair = CompareScreen(self, TwinPlayback(level), TwinPlayback(level), source)
            pair.single = play.playback
            self.show_screen(pair)

    @property
    def actions(self) -> dict[str, Callable[[], object]]:
        """Actions that are possible now, by the names of the table of shortcuts."""
        of_play = self._play_actions() if self.mode == "play" else {}
        return self._own_actions | of_play | (self._first_actions() if self.screen is None else self.screen.actions)

    def act(self, action: str) -> None:
        """Carry out the action of a key or button, where the screen knows it."""
        do = self.actions.get(action)
        if do is not None:
            do()

    def quit(self) -> None:
        """Leave after this frame, once it is clear what becomes of what is not saved, or not written yet."""
        self.documents.if_saved(lambda: self.sharing.if_written(self._stop))

    def _stop(self) -> None:
        self.documents.give_up()
        self.running = False

    def close(self) -> None:
        """Close the window; whatever ended the loop, a recording gets its last line."""
        if self.screen is not None:
            self.screen.leave()
        self.best.close()
        self.sounds.close()
        self.sharing.close()
        self.documents.close()
        self.scenes.shelf.close()
        self.display.close()
        self._collector.close()

    def _rescale(self, factor: float) -> None:
        self.chosen.choose("scale", min(max(self.ui.scale * factor, SCALE_RANGE[0]), SCALE_RANGE[1]))

    # What the person has chosen.

    def _take_up(self) -> None:
        """Apply all settings as they are."""
        self.scale = self.chosen["scale"] or self.chosen.automatic["scale"]
        show_theme(theme_of(self.chosen["theme"]))
        threads = self.chosen["threads"]
        use_threads(usual_threads() if threads == "auto" else int(threads))
        for keys in use_keys(self.chosen.keys):
            self.chosen.faults.append(f"preferences.json: keys: there is no key {keys!r:.40}.")

    def _obey(self, name: str) -> None:
        """Apply a setting that the person has changed."""
        self._take_up()
        if name == "sound" and not self.sounds.device.is_open:
            self.sounds.look_again()
        if name in LAID_OUT:
            self.rebuild()

    def _toggle_sound(self) -> None:
        is_on = self.chosen["sound"] == "on"
        self.chosen.choose("sound", "off" if is_on else "on")

    def _start_toy(self) -> None:
        if self.play is not None:
            self.say(self._toys.start(self.play.playback.level))

    def _open_settings(self) -> None:
        SettingsSheet(self.ui, self.chosen)

    # The loop.

    def frame(self, frame_time: float) -> None:
        """One frame: events, ticks, drawing; frame_time [s] since the last one."""
        started = time.perf_counter()
        self._seconds += frame_time
        with self.profile.part("events"):
            events = pygame.event.get()
            self._collector.update(frame_time, bool(events))
            self.input.process(events)
            if self.display.refresh():
                self.rebuild()
        if self.screen is not None:
            self.screen.update(frame_time, self.input.pointer_over_world(), self.profile)
            self._sound()
        with self.profile.part("ui"):
            self.status.update(frame_time)
            self.documents.update()
            self.best.update()
            if fault := self.scenes.fault():
                self.say(fault)
            if self.gallery is not None:
                self.gallery.update(frame_time)
            self.guide.update(frame_time)
            self.sharing.update(frame_time)
            self.link_copying.update()
            self.share_page.update()
            self.ui.update(frame_time)
        if not self.display.hidden:
            self._draw()
            with self.profile.part("flip"):
                self.display.flip()
        self._progress.end()
        self._seen = self.screen
        self.idle.follow(frame_time, bool(events) or any(pygame.mouse.get_pressed()) or self.moves)
        spent = time.perf_counter() - started
        self.profile.end_frame(spent)
        self._count(frame_time, spent)

    @property
    def moves(self) -> bool:
        """Whether something in the window changes by itself, or works in its frames at what it will show."""
        parts = (
            self.screen,
            self.gallery,
            self.status,
            self.guide,
            self.sharing,
            self.link_copying,
            self.best,
            self.ui,
        )
        return any(part is not None and part.moves for part in parts)

    @property
    def idle_rate(self) -> int:
        """Frames [1/s] that are enough while nothing in the window moves."""
        return RESTING_RATE if self.play is not None and self.play.runs else IDLE_RATE

    def _sound(self) -> None:
        play, covered = self.play, self.ui.is_covered or self.gallery is not None or self.display.hidden
        clock = None if play is None else play.playback.clock
        is_heard = clock is not None and not covered and not clock.paused and clock.speed > 0.0
        with self.profile.part("sound"):
            self.sounds.update(play, is_heard)

    @property
    def _tick(self) -> int:
        return self.play.playback.session.tick if self.play is not None else 0

    def _draw(self) -> None:
        surface = self.display.surface
        if self.screen is None:
            surface.fill(BACKGROUND)
        else:
            self.screen.draw(surface, self.profile)
        with self.profile.part("ui"):
            if self.screen is not None:
                parts = self.sharing.status() + self.link_copying.status() + self.screen.status(self._figures)
                self.status.draw(surface, parts)
                if self.gallery is None:
                    is_under = False if self.ui.has_sheet else None
                    self.status.draw_notices(surface, self.screen.notices_place, over_page=is_under)
            self.ui.draw(surface)
            if self.gallery is not None:
                self.gallery.draw(surface)
            self.guide.draw(surface)
            if (self.screen is None or self.ui.has_sheet) and not self.ui.shows_page:
                # What was said before lies under the page; a gallery covers all.
                place = 16.0, -STATUS_HEIGHT, self.ui.units[0]
                self.status.draw_notices(surface, place, over_page=True if self.gallery is None else None)

    def _count(self, frame_time: float, spent: float) -> None:
        counted = self._counted
        counted[0] += frame_time
        counted[1] += 1
        counted[3] += spent
        if counted[0] < FIGURES_EVERY:
            return
        tick = self._tick
        ticks = max(0.0, tick - counted[2])
        self._figures = Figures(ticks / counted[0], counted[1] / counted[0], 1e3 * counted[3] / counted[1])
        self._counted = [0.0, 0, tick, 0.0]
        self.display.window.title = self.title()

    def title(self) -> str:
        """The window's title; with the states of the run where it says them, for programs that follow what happens."""
        if self.screen is None or self.gallery is not None:
            return f"{'Levels' if self.gallery is None else self.gallery.title} - Spring Sandbox"
        words = [self.screen.title()]
        if self.says_states:
            words += [*self.screen.states(), *(["dialog"] if self.ui.has_sheet else [])]
        return " - ".join([*words, "Spring Sandbox"])


def run_app(
    display: Display,
    request: StartRequest,
    profile: Profile,
    seconds: float | None,
    overrides: Mapping[str, Any],
    show_progress: Callable[[], object] = lambda: None,
    says_states: bool = False,
) -> None:
    """Show what is requested in the window and run until it is closed, or for this many seconds.

    overrides: see `Chosen`. show_progress: called now and then until there is something to show. says_states: the
    window's title says what happens.
    """
    # What is imported stays: whoever looks for garbage passes it over, which takes a tenth of a second less.
    gc.freeze()
    display.settle()
    app = App(display, profile, Chosen(**overrides))
    app.says_states = says_states
    show_progress()
    app.guide.may_offer = True
    app.input.gamepads.begin()
    app.open(request)
    app.documents.offer_recovery()
    show_progress()
    if app.play is not None:
        app.play.stage.renderer.expect(app.play.stage.camera)
        show_progress()
    clock, guard = pygame.time.Clock(), FrameGuard(app)
    started = before = time.perf_counter()
    try:
        while app.running and (seconds is None or before - started < seconds):
            now = time.perf_counter()
            try:
                app.frame(now - before)
            except Exception as error:
                guard.take(error)
            before = now
            profile.shown()
            profile.reached("the first page")
            if app.play is not None and app.play.playback.session.tick:
                profile.reached("the first tick")
            if not app.idle.has_come:
                clock.tick(FRAME_RATE)
                continue
            if wait_for_event(1.0 / app.idle_rate):
                # Time that passed asleep is not made up for by what the event sets going.
                before = max(before, time.perf_counter() - 1.0 / FRAME_RATE)
            profile.rested()
    finally:
        keep_window(display.kept)
        # Whatever ended the loop, a recording gets its last line.
        app.close()
