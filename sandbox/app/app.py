"""App: the window, its loop, and what each action does."""

import threading
import time
from collections import deque
from collections.abc import Callable

import pygame

from sandbox.app.colours import ACCENT, BACKGROUND, DANGER, MUTED, TEXT, WARNING, Colour
from sandbox.app.dialogs import show_lines
from sandbox.app.display import SCALE_RANGE, Display
from sandbox.app.files import FileActions
from sandbox.app.gallery import Gallery
from sandbox.app.help import show_help
from sandbox.app.input import Input
from sandbox.app.lines import warm_up_lines
from sandbox.app.loop import SPEEDS
from sandbox.app.panel import PANEL_WIDTH, Panel
from sandbox.app.playback import Playback
from sandbox.app.profile import Profile
from sandbox.app.progress import Progress
from sandbox.app.stage import Stage
from sandbox.app.status import NOTICES, STATUS_HEIGHT, Notice, StatusLine, draw_spinner, status_parts
from sandbox.app.toolbar import BAR_HEIGHT, BarState, Toolbar
from sandbox.app.widgets import Ui
from sandbox.level.model import Level
from sandbox.physics.query import shown_particles, shown_springs
from sandbox.physics.step import warm_up
from sandbox.session.replay import Replay

FRAME_RATE = 60
# How often the status figures and the window title change [s].
FIGURES_EVERY = 0.5


class App:
    """The app in its window; `frame` is one turn of the loop."""

    def __init__(self, display: Display, level: Level | None = None, replay: Replay | None = None) -> None:
        self.display = display
        self.scale = display.scale
        self.profile = Profile()
        self._notices: deque[Notice] = deque(maxlen=NOTICES)
        self._description = ""
        self.running = True
        self.ready = False
        self.show_panel = True
        self.stage: Stage | None = None
        self.panel: Panel | None = None
        self.gallery: Gallery | None = None
        self.input = Input(self)
        self.files = FileActions(self)
        self._progress = Progress(self)
        self.actions = self._actions()
        self._figures = (0.0, 0.0)
        self._counted = [0.0, 0, 0, 0.0]
        self._seconds = 0.0
        self._build_ui()
        self.warming = threading.Thread(target=_warm_up_kernels, daemon=True)
        self.warming.start()
        if replay is not None:
            self.start(Playback(replay.level, replay))
        elif level is not None:
            self.start(Playback(level))
        else:
            self.open_gallery()

    # What is on the screen.

    def _build_ui(self) -> None:
        self.ui = Ui(self.display.size, self.scale, self.display.pixel_ratio)
        self.status = StatusLine(self.ui, self._notices)
        self.toolbar = Toolbar(self.ui, self.act)
        before, self.panel = self.panel, None
        if self.stage is None:
            return
        self.stage.place(self.viewport, self.scale)
        if self.show_panel:
            height = self.ui.units[1] - BAR_HEIGHT - STATUS_HEIGHT
            self.panel = Panel(self.ui, self.stage.playback, self.say, BAR_HEIGHT, height)
            if before is not None and before.playback is self.stage.playback:
                self.panel.choose_material(before.material)

    @property
    def viewport(self) -> tuple[int, int, int, int]:
        """The part of the window that shows the world, in pixels."""
        width, height = self.display.size
        top, bottom = self.ui.px(BAR_HEIGHT), self.ui.px(STATUS_HEIGHT)
        right = self.ui.px(PANEL_WIDTH) if self.show_panel else 0
        return 0, top, max(width - right, 1), max(height - top - bottom, 1)

    def rebuild(self) -> None:
        """Lay everything out anew, after the window or the scale changed."""
        gallery_was_open = self.gallery is not None
        self.gallery = None
        self._build_ui()
        if gallery_was_open:
            self.open_gallery()

    def say(self, text: str) -> None:
        """Show a line to the person for some seconds."""
        self.status.say(text)

    def show_faults(self, title: str, faults: list[str]) -> None:
        """Show lines in a box; the app goes on with what it had."""
        show_lines(self.ui, title, faults)

    def start(self, playback: Playback) -> None:
        """Show another run from its beginning."""
        self.close_gallery()
        self.files.leave_recording()
        self.stage = Stage(playback, self.viewport, self.scale)
        self.follow(playback)
        self.rebuild()
        self._describe("" if playback.replay else playback.level.description)

    def _describe(self, description: str) -> None:
        """Say what a level is about, in place of what the one before it was."""
        self.status.take_back(self._description)
        self._description = description
        if description:
            self.say(description)

    def follow(self, playback: Playback) -> None:
        """Show how far a run is that has to be played again, for an undo or a recording, where that takes long."""
        playback.session.progress = self._progress.show

    def open_gallery(self, section: str = "levels") -> None:
        """Choose a level or a recording."""
        self.close_gallery()
        self._describe("")
        self.gallery = Gallery(self.ui, self.files, section, self.close_gallery)

    def close_gallery(self) -> None:
        """Back to the run, where there is one."""
        if self.gallery is not None:
            self.gallery.close()
            self.gallery = None

    # Actions.

    def _actions(self) -> dict[str, Callable[[], None]]:
        run: dict[str, Callable[[Stage], None]] = {
            "tool_drag": lambda stage: stage.choose_tool("drag"),
            "tool_pin": lambda stage: stage.choose_tool("pin"),
            "tool_cut": lambda stage: stage.choose_tool("cut"),
            "let_go": lambda stage: stage.let_go(),
            "undo": lambda stage: stage.playback.submit_undo(),
            "redo": lambda stage: stage.playback.submit_redo(),
            "pause": self._toggle_pause,
            "step": lambda stage: stage.playback.clock.step_once(),
            "slow": self._slower,
            "reset": self._reset,
            "zoom_in": lambda stage: stage.zoom(2),
            "zoom_out": lambda stage: stage.zoom(-2),
            "fit": lambda stage: stage.fit(),
            "record": lambda stage: self.files.toggle_recording(),
            "save": lambda stage: self.files.save_run(),
            "press": lambda stage: stage.press_cursor(pygame.key.get_mods()),
            "next_particle": lambda stage: stage.visit_particle(1),
            "previous_particle": lambda stage: stage.visit_particle(-1),
        }
        actions = {name: (lambda do=do: do(self.stage) if self.stage is not None else None) for name, do in run.items()}
        return actions | {
            "fullscreen": self.display.toggle_fullscreen,
            "panel": self._toggle_panel,
            "larger": lambda: self._rescale(1.125),
            "smaller": lambda: self._rescale(1 / 1.125),
            "gallery": self.open_gallery,
            "recordings": lambda: self.open_gallery("recordings"),
            "open": self.files.ask_to_open,
            "help": lambda: show_help(self.ui),
            "quit": self.quit,
        }

    def act(self, action: str) -> None:
        """Do what a key or button asks for."""
        self.actions[action]()

    def quit(self) -> None:
        """Leave after this frame."""
        self.running = False

    def _toggle_pause(self, stage: Stage) -> None:
        stage.playback.toggle_pause()

    def _slower(self, stage: Stage) -> None:
        clock = stage.playback.clock
        clock.speed = SPEEDS[(SPEEDS.index(clock.speed) + 1) % len(SPEEDS)]

    def _reset(self, stage: Stage) -> None:
        self.files.leave_recording()
        stage.replace_playback(stage.playback.reset())
        self.follow(stage.playback)
        if self.panel is not None:
            self.panel.playback = stage.playback

    def _toggle_panel(self) -> None:
        self.show_panel = not self.show_panel
        self.rebuild()

    def _rescale(self, factor: float) -> None:
        self.scale = min(max(self.scale * factor, SCALE_RANGE[0]), SCALE_RANGE[1])
        self.rebuild()

    # The loop.

    def frame(self, frame_time: float) -> None:
        """One turn: events, ticks, drawing; frame_time [s] since the last one."""
        started = time.perf_counter()
        self._seconds += frame_time
        with self.profile.part("events"):
            self.input.process(pygame.event.get())
            if self.display.refresh():
                self.rebuild()
        self.ready = self.ready or not self.warming.is_alive()
        if self.stage is not None:
            pointer = self.input.pointer_over_world()
            self.stage.update(frame_time if self.ready and not self.ui.has_sheet else 0.0, pointer, self.profile)
            self.stage.renderer.compiled = self.ready
            for message in self.stage.playback.messages:
                self.say(message)
            self.stage.playback.messages.clear()
        with self.profile.part("ui"):
            self._update_widgets(frame_time)
        self._draw()
        with self.profile.part("flip"):
            self.display.flip()
        spent = time.perf_counter() - started
        self.profile.milliseconds["frame"].append(1e3 * spent)
        self._count(frame_time, spent)

    def _update_widgets(self, frame_time: float) -> None:
        self.status.update(frame_time)
        if self.gallery is not None:
            self.gallery.update(self.ready)
        if self.stage is not None:
            playback = self.stage.playback
            if self.panel is not None and self.ready:
                self.panel.refresh()
            self.toolbar.show(
                BarState(
                    playback.level.name,
                    self.stage.tool_name,
                    playback.clock.paused,
                    playback.clock.speed,
                    playback.session.recording is not None,
                    playback.session.can_undo,
                    playback.session.can_redo,
                    self.show_panel,
                )
            )
        self.ui.update(frame_time)

    def _draw(self) -> None:
        surface = self.display.surface
        if self.stage is None:
            surface.fill(BACKGROUND)
        else:
            self.stage.draw(surface, self.profile)
        with self.profile.part("ui"):
            if self.stage is not None:
                left = None if self.ui.has_sheet else 16.0
                self.status.draw(surface, self._status_parts(self.stage), self.ui.units[0], left)
            self.ui.draw(surface)
            if (self.stage is None or self.ui.has_sheet) and not self.ui.shows_page:
                self.status.draw_notices(surface, 16.0)
            if not self.ready:
                detail = "Only the first start takes some seconds."
                draw_spinner(surface, self.ui, self._seconds, "Preparing the physics", detail)

    def _status_parts(self, stage: Stage) -> list[tuple[str, Colour]]:
        playback, current = stage.playback, stage.playback.current
        parts: list[tuple[str, Colour]] = [(self.state(), ACCENT if not playback.clock.paused else WARNING)]
        if playback.session.recording is not None:
            parts.append((f"recording {playback.session.recording.name}", DANGER))
        if playback.replay is not None:
            parts.append((playback.verdict or f"replay, {playback.replay.ticks:,} ticks", TEXT))
        parts.append((f"tick {playback.session.tick:,}", MUTED))
        counts = int(shown_particles(current).sum()), int(shown_springs(current).sum())
        return parts + status_parts(*counts, *self._figures, stage.renderer.non_finite, playback.behind)

    def state(self) -> str:
        """The state of the run in a word, as status line and window title show it."""
        if self.stage is None:
            return "levels"
        clock = self.stage.playback.clock
        if clock.paused:
            return "paused"
        return "playing" if clock.speed == 1.0 else f"slow motion 1/{round(1 / clock.speed)}"

    def _count(self, frame_time: float, spent: float) -> None:
        counted = self._counted
        counted[0] += frame_time
        counted[1] += 1
        counted[3] += spent
        if counted[0] < FIGURES_EVERY:
            return
        tick = self.stage.playback.session.tick if self.stage is not None else 0
        ticks = max(0.0, tick - counted[2])
        self._figures = (ticks / counted[0], 1e3 * counted[3] / counted[1])
        self._counted = [0.0, 0, tick, 0.0]
        self.display.window.title = self.title()

    def title(self) -> str:
        """The window's title: level, tick and state, so that other programs can follow what happens."""
        if self.stage is None or self.gallery is not None:
            return "Levels - Spring Sandbox"
        playback = self.stage.playback
        words = [playback.level.name, f"tick {playback.session.tick}", self.state()]
        if self.stage.drag.holds:
            words.append(f"holding {len(self.stage.drag.holds)}")
        if playback.session.recording is not None:
            words.append("recording")
        if playback.replay is not None:
            words.append(playback.verdict or "watching")
        if self.ui.has_sheet:
            words.append("dialog")
        return " - ".join([*words, "Spring Sandbox"])


def _warm_up_kernels() -> None:
    warm_up()
    warm_up_lines()


def run_app(
    level: Level | None = None,
    *,
    replay: Replay | None = None,
    profile: bool = False,
    seconds: float | None = None,
    scale: float | None = None,
) -> int:
    """Open the window and run until it is closed, or for so many seconds; returns the exit code.

    profile: print where a frame's time goes, at the end. scale: size of the widgets; None = the display's.
    """
    app = App(Display(scale), level, replay)
    clock = pygame.time.Clock()
    started = before = time.perf_counter()
    try:
        while app.running and (seconds is None or before - started < seconds):
            now = time.perf_counter()
            app.frame(now - before)
            before = now
            clock.tick(FRAME_RATE)
    finally:
        # Whatever ended the loop, a recording gets its last line.
        app.files.leave_recording()
        app.display.close()
    if profile:
        print(app.profile.table(time.perf_counter() - started))
    return 0
