"""PlayScreen: a run on the screen, with the bar of its tools at the top and the panel at the right."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import ClassVar

import pygame

from sandbox.app.base.loop import SPEEDS, Profile
from sandbox.app.base.shortcuts import Mode, tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import ROOM_FOR_NOTICES, Figures, NoticesPlace, Pixel, Pointer
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Colour
from sandbox.app.draw.overlays import names_for
from sandbox.app.draw.renderer import FULL, NO_EFFECTS
from sandbox.app.film.film import Film, FilmPair, last_ticks
from sandbox.app.graphs.graph_dock import GraphDock
from sandbox.app.panel.contacts import ContactSettings, ask_for_pace, restart_with_contacts
from sandbox.app.panel.panel import MORE, SECTIONS, Panel, PanelShape
from sandbox.app.panel.panel_rows import PANEL_WIDTH, ROOM_FOR_PANEL, SidePanel
from sandbox.app.parts.part_page import PartPage
from sandbox.app.play.allowed import Allowed
from sandbox.app.play.drive_keys import KEYS_HEIGHT, ROOM_BESIDE, DriveKeys, draw_key_caps
from sandbox.app.play.game import Game
from sandbox.app.play.hand_labels import draw_hint, draw_labels, keep_strength, kept_strength, next_strength
from sandbox.app.play.legend import Legend
from sandbox.app.play.problems import Problems
from sandbox.app.play.run_actions import EarlierRuns, ask_to_keep, level_name, toggle_melt
from sandbox.app.play.stage import HAND_TOOL, Stage
from sandbox.app.play.status import STATUS_HEIGHT, run_parts
from sandbox.app.play.thing_menu import cursor_actions, open_thing_menu
from sandbox.app.play.time_bar import TimeBar
from sandbox.app.play.toolbar import BAR_HEIGHT, NAMES, BarState, PartsPalette, Toolbar, state_of
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.level.document.model import Level
from sandbox.session.scene import SUFFIX, RunScene
from sandbox.session.tuning import TUNING
from sandbox.tools.play_tools import PLAY_TOOLS
from sandbox.tools.tool import PlayTool

# Where buttons are for what went wrong, below the bar [layout units].
FIXES_PLACE = (16.0, 12.0)
# The button that begins again, in the middle [layout units].
AGAIN_SIZE = (150.0, 40.0)
# Graphs and timeline have that much room beside a panel, or are as wide as the window [layout units].
ROOM_BESIDE_PANEL = 340.0
# Under what it is remembered how springs are set: "pad" or "sliders".
SPRINGS = "springs"
# And, with the name of a section of the panel behind it, whether that is open.
FOLD = "open_"


class PlayScreen:
    """Plays a level or a replay; source: the file of the level; of_document: the level is what the editor has open."""

    mode: Mode = "play"
    # How far the button that begins again is below the bar [layout units].
    again_top = 16.0
    # A world that is lower or narrower has notices over the status line [layout units].
    room_for_notices = ROOM_FOR_NOTICES
    # What is said as it opens.
    welcome: ClassVar[str] = ""
    # Whether playing the run again can be cancelled.
    can_cancel = True
    # Whether its run can be won and lost.
    is_game = True

    def __init__(
        self, app: Application, playback: Playback, source: Path | None = None, of_document: bool = False
    ) -> None:
        self._app = app
        self._ui = app.ui
        self.source, self.of_document = source, of_document
        # Whether the person wants the panel; None: it is shown where there is room.
        self._wants_panel: bool | None = None
        self._allowed = Allowed(self, playback.level)
        self.show_panel = self._allowed.has_panel and app.ui.units[0] >= ROOM_FOR_PANEL
        self.show_palette = False
        self.palette: PartsPalette | None = None
        self.part_page: PartPage | None = None
        self.panel: SidePanel | None = None
        self.stage = Stage(playback, (0, 0, *app.ui.size), app.ui.scale)
        self.time = TimeBar(app, lambda: self.playback)
        self.graphs = GraphDock(app, self._measured)
        self.stage.place(self.viewport, app.ui.scale)
        kept = preference(SPRINGS)
        self.shape = PanelShape(kept if kept in ("pad", "sliders") else None)
        for name in (MORE, *SECTIONS):
            is_open = preference(f"{FOLD}{name}")
            # What the level's text asks for is in sight, whatever was folded elsewhere.
            is_asked_for = name != MORE and SECTIONS[name].is_asked_for(playback.level.description)
            if isinstance(is_open, bool) and not is_asked_for:
                self.shape.open[name] = is_open
        self.stage.drag.strength = kept_strength(self.stage.drag.strength)
        self._keys = DriveKeys(playback)
        can_end = self.is_game and bool(playback.level.rules or playback.level.goal)
        self.problems = Problems(app, lambda: self.stage, self.say, not (can_end and playback.level.goal))
        self._legend = Legend()
        self.game = Game(app, self, lambda: self.stage, can_end)
        self.actions = self._actions()
        app.show_replay_progress(playback, self.can_cancel)
        before = app.scenes.begin(playback, source)
        # Of a pair one run alone could be brought back.
        self.earlier = EarlierRuns(before if self.can_cancel else None, self._show_run, self.say)
        # Where in My levels it is saved, and how it stood then.
        self.saved: tuple[Path, RunScene] | None = None
        if self.welcome:
            self.say(self.welcome)

    def say(self, text: str) -> None:
        """Show a line about the run, which ends with it."""
        self._app.say(text, self)

    @property
    def camera(self) -> Camera:
        """The camera of the world on the screen."""
        return self.stage.camera

    @property
    def playback(self) -> Playback:
        """The run."""
        return self.stage.playback

    @property
    def moves(self) -> bool:
        """Whether the run moves, which it does not while a page is open, or pictures of parts are to come."""
        is_filling = self.part_page is not None and self.part_page.moves
        return is_filling or self.game.moves or (self.playback.moves and not self._ui.is_covered and not self.rests)

    @property
    def runs(self) -> bool:
        """Whether time passes in the run."""
        return not (self.playback.clock.paused or self._ui.is_covered)

    @property
    def rests(self) -> bool:
        """Whether time passes in the run, and yet nothing in it moves, nobody drives it, and no graph goes on."""
        is_driven = any(is_held for _, is_held in self._keys.shown())
        goes_on = is_driven or self.graphs.is_shown or self.playback.has_pending or self.game.is_busy
        return self.runs and self.stage.rests and self.playback.travel.target is None and not goes_on

    @property
    def has_contacts(self) -> bool:
        """Whether things touch in the run."""
        return self.playback.level.has_contacts

    @property
    def viewport(self) -> tuple[int, int, int, int]:
        """The part of the window that shows the world, in pixels."""
        return self.area

    @property
    def area(self) -> tuple[int, int, int, int]:
        """The part of the window [pixels] beside bar, panel, timeline and status line."""
        ui, (width, height) = self._ui, self._ui.size
        top, bottom = ui.px(BAR_HEIGHT), ui.px(STATUS_HEIGHT)
        right = ui.px(PANEL_WIDTH) if self.show_panel else 0
        return 0, top, max(width - right, 1), max(height - top - bottom - ui.px(self._below), 1)

    @property
    def _below(self) -> float:
        """The height that graphs and timeline take [layout units]."""
        return self.time.height + self.graphs.height(self._ui)

    @property
    def notices_place(self) -> NoticesPlace | None:
        """Where notices begin, from the lower left corner, and how far right they may reach [layout units]."""
        if min(self.area[2], self.viewport[3]) < self._ui.px(self.room_for_notices):
            return None
        end = self.area[2] / self._ui.scale
        left = 16.0 if self.palette is None else self.palette.right + 10.0
        # Keys in the upper one of two worlds are in nobody's way.
        is_lowest, is_narrow = self.viewport[3] == self.area[3], self.viewport[2] < self._ui.px(ROOM_BESIDE)
        keys = KEYS_HEIGHT if is_lowest and is_narrow and self._keys.shown() else 0.0
        return left, self._below + keys, end

    def build(self, ui: Ui) -> None:
        """Lay the bar and the panel out again."""
        self._ui = ui
        wanted = ui.units[0] >= ROOM_FOR_PANEL if self._wants_panel is None else self._wants_panel
        self.show_panel = self._allowed.has_panel and wanted
        self._offered = {"keep": self.of_document, **self.game.offered}
        absent = self._allowed.absent | {action for action, is_offered in self._offered.items() if not is_offered}
        # The editor is a button away from what it has open.
        self.toolbar = Toolbar(ui, self._app.act, absent, {"share" if self.of_document else "edit"})
        self.stage.place(self.viewport, ui.scale)
        self.palette = None
        if self.show_palette:
            wide, tall = (side / ui.scale for side in self.area[2:])
            self.palette = PartsPalette(ui, self._app.act, BAR_HEIGHT, wide, tall, self._allowed.tools)
        left, below = FIXES_PLACE
        left = left if self.palette is None else self.palette.right + below
        self.problems.build(ui, left, BAR_HEIGHT + below)
        left = (self.viewport[0] + self.viewport[2] / 2) / ui.scale - AGAIN_SIZE[0] / 2
        place = ui.rect(left, BAR_HEIGHT + self.again_top + self.game.height, *AGAIN_SIZE)
        self.restart_button = ui.button(place, "Again", self._reset, style="primary", tip=tip_of("reset", "play"))
        self.restart_button.visible = False
        # Beside a panel in a narrow window they have no room: they lie below it.
        wide, below_panel = self.area[2] / ui.scale, 0.0
        if wide < ROOM_BESIDE_PANEL:
            wide, below_panel = ui.units[0], self._below
        self.graphs.build(ui, wide, ui.units[1] - STATUS_HEIGHT - self.time.height)
        self.time.build(ui, wide, ui.units[1] - STATUS_HEIGHT)
        self.stage.renderer.follow_theme()
        before, self.panel = self.panel, None
        if self.show_panel:
            height = ui.units[1] - BAR_HEIGHT - STATUS_HEIGHT - below_panel
            choices: dict[str, Callable[[str], None]] = {
                "hand": self.choose_strength, "view": self._app.act, "springs": self._set_by, "fold": self.fold,
                "rate": self._ask_rate, "melt": lambda _: self.toggle_melt(),
            }  # fmt: skip
            self.panel = self._make_panel(ui, choices, height)
            if before is not None and before.playback.level is self.playback.level:
                self.panel.choose_material(before.material)
        self.game.build(ui)

    def _make_panel(self, ui: Ui, choices: dict[str, Callable[[str], None]], height: float) -> SidePanel:
        return Panel(ui, self.playback, self.say, choices, BAR_HEIGHT, height, self.shape, self.set_contacts)

    def set_contacts(self, contacts: ContactSettings) -> None:
        """Begin the run again with these contacts."""
        restart_with_contacts(self._app, self.playback, contacts, self.of_document)

    def _set_by(self, way: str) -> None:
        """Show the pad or the sliders from now on, in later runs too."""
        self.shape.springs = way
        set_preference(SPRINGS, way)
        self._app.rebuild()

    def show_sweep(self, path: Path) -> None:
        """Show a table that `sandbox sweep` made of this level behind the pad. Raises SweepError and OSError."""
        world = self.playback.session.world
        names = list(world.material_names)
        material = self.shape.sweeps.load(path, self.playback.level, world.settings, names)
        self._wants_panel, self.shape.springs = True, "pad"
        self._app.rebuild()
        if self.panel is not None:
            self.panel.choose_material(None if material is None else names.index(material))

    def toggle_melt(self) -> None:
        """Solve springs one by one, which melts what is stiff, or all at once again."""
        self.say(toggle_melt(self.playback))

    def _ask_rate(self, typed: str) -> None:
        """Ask how to start over at another tick rate."""
        if self.of_document:
            self.say("This run belongs to the editor. Change its ticks a second there, on the page Level.")
        else:
            ask_for_pace(self._app, self.playback, int(typed))

    def fold(self, section: str) -> None:
        """Open a section of the panel, or fold it, here and in later runs."""
        if isinstance(self.panel, Panel):
            self.shape.open[section] = not self.panel.is_open(section)
            set_preference(f"{FOLD}{section}", self.shape.open[section])
            self._app.rebuild()

    # Actions.

    def _actions(self) -> dict[str, Callable[[], object]]:
        stage, files, allowed = self.stage, self._app.files, self._allowed
        tools = {tool.action: partial(self._take_up, tool) for tool in PLAY_TOOLS.values()}
        return {
            **{action: partial(allowed.if_any, action, take) for action, take in tools.items()},
            "palette": partial(allowed.if_any, "palette", self._toggle_palette),
            "catalogue": partial(allowed.if_any, "catalogue", self._open_catalogue),
            "let_go": self._let_go,
            **{name: partial(stage.toggle_view, name) for name in names_for(self.playback.level)},
            "hand": self._next_strength,
            "melt": self.toggle_melt,
            "follow": lambda: self.say(stage.follow_with_camera(next(reversed(self.graphs.picked), None))),
            "touching": lambda: self.set_contacts(ContactSettings.of(self.playback.level).other),
            **self.problems.actions,
            **self.game.actions,
            "undo": lambda: self.earlier.undo(self.playback),
            "redo": lambda: self.earlier.redo(self.playback),
            "pause": lambda: self.playback.toggle_pause(),
            "step": lambda: self.playback.clock.step_once(),
            "slow": lambda: self.playback.clock.next_speed(SPEEDS),
            **self.time.actions,
            "graphs": self.graphs.toggle,
            "pick": lambda: self.graphs.pick(self.stage.pointed),
            "reset": self._reset,
            "zoom_in": lambda: self._zoom(2),
            "zoom_out": lambda: self._zoom(-2),
            "fit": stage.fit,
            "record": files.toggle_recording,
            "save": files.save_scene,
            "save_recording": files.save_run,
            "press": self._press,
            **cursor_actions(lambda: self._ui, stage, self.open_menu, self.say),
            "panel": partial(allowed.if_any, "panel", self._toggle_panel),
            "gallery": self._app.open_gallery,
            "recordings": lambda: self._app.open_gallery("recordings"),
            "open": files.ask_to_open,
            "edit": self._edit,
            "keep": lambda: ask_to_keep(self._app),
        }

    def _edit(self) -> None:
        """Go back to the document that is played, or edit the level of the run."""
        documents = self._app.documents
        if self.of_document:
            documents.back()
        elif self.source is not None:
            documents.open(self.source)
        else:
            documents.edit_level(self.playback.level)

    def _toggle_palette(self) -> None:
        self.show_palette = not self.show_palette
        if self.stage.tool_name in NAMES:
            self.stage.choose_tool(HAND_TOOL)
        self._app.rebuild()

    def _take_up(self, tool: PlayTool) -> None:
        """Take up a tool; one that is in use already gives way to the hand."""
        is_on_strip = tool.name in NAMES
        if self.stage.tool_name == tool.name:
            self.stage.choose_tool(HAND_TOOL)
            return
        self.stage.choose_tool(tool.name)
        if is_on_strip and not self.show_palette:
            self.show_palette = True
            self._app.rebuild()
        if self.stage.tool.adds:
            self._say_what_touches()

    def _open_catalogue(self, offset: float = 0.0) -> None:
        """Choose a part of the catalogue to drop."""
        world = self.playback.session.world
        self.part_page = PartPage(self._ui, world, self._take_part, self._open_catalogue, offset, self.stage.part)

    def _take_part(self, part: Level, by_key: bool) -> None:
        """Take a part in hand; by a key: where the arrows move it."""
        self.stage.take_part(part)
        if by_key:
            self._ui.blur()
            self.stage.move_cursor(0, 0, 0)
        deeds = "a click drops it, a drag throws it, the wheel makes it larger"
        self.say(f"{part.name}: {deeds}. U has other parts, Escape ends it.")
        self._say_what_touches()

    def _say_what_touches(self) -> None:
        if not self.has_contacts:
            self.say("Things pass through each other in this level. Shift+T switches contacts on; the run starts over.")

    def _zoom(self, steps: int) -> None:
        if not self.stage.resize(steps):
            self.camera.zoom_at(self.stage.cursor, steps)

    def open_menu(self, pixel: Pixel) -> None:
        """Open the menu of the thing under the pointer."""
        open_thing_menu(self._ui, self.stage, pixel, self.say)

    @property
    def takes_rest(self) -> bool:
        """Whether the hand is in use: other tools begin something at once."""
        return self.stage.tool_name == HAND_TOOL

    def turn_wheel(self, pixel: Pixel, steps: float) -> None:
        """Resize the part that is about to be dropped, or zoom."""
        if not self.stage.resize(steps):
            self.camera.turn_wheel(pixel, steps)

    def choose_strength(self, name: str) -> None:
        """Set the hand's strength, gentle, normal or strong, from its next hold on, in later runs too."""
        self.stage.drag.strength = name
        keep_strength(name)
        if self.stage.drag.holds:
            self.say(f"The present hold keeps its strength; the next one is {name}.")

    def _next_strength(self) -> None:
        name, line = next_strength(self.stage.drag.strength)
        self.choose_strength(name)
        self.say(line)

    def _let_go(self) -> None:
        if not self.game.keep_watching():
            self.stage.let_go()

    def _press(self) -> None:
        if self.game.card is not None:
            self.game.card.press()
        elif self.stage.cursor is None or not self._allowed.refuses(self.camera.to_pixels(self.stage.cursor)):
            self.stage.press_cursor(pygame.key.get_mods())
            self._choose_clicked()

    def _reset(self) -> None:
        """Go back to the last checkpoint, or else to the beginning."""
        if self.game.go_back():
            self._keys = DriveKeys(self.playback, self._keys.is_on_pad)
        else:
            self.restart()

    def restart(self, as_it_was: bool = False) -> None:
        """Begin the run again; in a level with a goal what hands have tuned stays set, unless as_it_was."""
        self._app.end_messages(self)
        self._stop()
        earlier = self._app.scenes.set_aside(self.playback, self.source)
        self.saved = None
        self._begin_again(self.game.is_on and not as_it_was)
        self.earlier.begin_again(self.playback, earlier if self.can_cancel else None)
        self._follow_run()

    def _begin_again(self, keeps_tuning: bool) -> None:
        self.stage.replace_playback(self.playback.reset(TUNING if keeps_tuning else ()))

    def _show_run(self, playback: Playback) -> None:
        """Show another run of the same level."""
        self._stop()
        self.stage.replace_playback(playback)
        self._follow_run()

    def _follow_run(self) -> None:
        """Show the present run in problems, replay bar, kept runs and panel."""
        self.problems.begin()
        self.game.begin()
        self._app.show_replay_progress(self.playback, self.can_cancel)
        self._app.scenes.begin(self.playback, self.source)
        if self.panel is not None:
            self.panel.attach(self.playback)

    def _toggle_panel(self) -> None:
        self._wants_panel = not self.show_panel
        self._app.rebuild()

    def leave(self) -> None:
        """Keep how the run stands; end a recording that is being made, whose file is complete."""
        self._stop()
        self._app.scenes.set_aside(self.playback, self.source)

    def _stop(self) -> None:
        """End a recording that is being made, and what is measured for the pad."""
        self.shape.sweeps.stop()
        path = self.playback.stop_recording()
        if path is not None:
            self._app.say(f"Saved as {path}")

    def film(self, seconds: float) -> Film | FilmPair:
        """The chosen range of the run, or its last seconds [s], as it is seen now."""
        return self.stage.film(self.playback.travel.span or last_ticks(self.playback.session, seconds))

    # Pointer and keys.

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows the world."""
        return self.stage.contains(pixel)

    def point(self, kind: Pointer, pixel: Pixel, modifiers: int, clicks: int = 1) -> None:
        """Hand a pointer event to the tool; a press takes the keyboard cursor away."""
        if kind == "down":
            self.stage.cursor = None
            if self.game.open_at(pixel) or self._allowed.refuses(pixel):
                return
        self.stage.point(kind, pixel, modifiers)
        self._choose_clicked()

    def _choose_clicked(self) -> None:
        """Show in the panel the body that the hand has clicked."""
        clicked = self.stage.drag.take_click()
        if clicked is not None and isinstance(self.panel, Panel):
            self.panel.choose_particle(clicked)

    @property
    def keys(self) -> DriveKeys:
        """The keys of the run that is shown now."""
        if self._keys.playback is not self.playback:
            self._keys = DriveKeys(self.playback, self._keys.is_on_pad)
        return self._keys

    def press_key(self, key: int, modifiers: int) -> bool:
        """Drive the motor or hydraulic that the level gives this key."""
        return self.keys.press(key, modifiers)

    def release_key(self, key: int) -> None:
        """Stop driving."""
        self.keys.release(key)

    def press_arrow(self, dx: int, dy: int, modifiers: int) -> None:
        """Move the keyboard cursor; where the level has arrow keys of its own, Shift is what tells them apart."""
        if self._keys.has_arrows:
            modifiers &= ~pygame.KMOD_SHIFT
        self.stage.move_cursor(dx, dy, modifiers)

    # A frame.

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Let time pass, where no page is open."""
        before = self.playback.session.tick
        self.stage.update(frame_time if not self._ui.is_covered else 0.0, pointer, profile)
        self._app.scenes.follow(self.playback, self.source, frame_time)
        self._measure(self.playback.session.tick - before, profile)
        self._tell()
        self.game.update(frame_time, pointer)
        self.problems.update()
        if self._offered != {**self._offered, **self.game.offered}:
            self._app.rebuild()
        self._show_again()
        if self.panel is not None:
            self.panel.refresh()
            if isinstance(self.panel, Panel) and self.panel.lacks_rows:
                self._app.rebuild()
            self.panel.show_choices(self.stage.drag.strength, self.stage.renderer.overlays.shown)
        self.stage.lit = self.panel.pointed_springs() if isinstance(self.panel, Panel) else None
        self.time.show()
        if self.part_page is not None:
            self.part_page.update()
        if self.palette is not None:
            self.palette.show(self.stage.tool_name)
        self.toolbar.show(
            BarState(
                self.title(),
                self.stage.tool_name,
                self.playback.clock.paused,
                self.playback.clock.speed,
                self.playback.session.recording is not None,
                self.earlier.can_undo(self.playback),
                self.show_panel,
                self.show_palette,
                self._app.chosen["sound"] == "on",
                self.time.is_shown,
                self.graphs.is_shown,
                self.game.shows_ghost,
            )
        )

    def _measured(self) -> list[tuple[str, Playback]]:
        """The runs that graphs are of, each with what stands before its names."""
        return [("", self.playback)]

    def _measure(self, ticks: int, profile: Profile) -> None:
        times = profile.milliseconds
        frame = times["frame"][-1] if times["frame"] else None
        self.graphs.update(times["ticks"][-1] / ticks if ticks > 0 else None, frame)

    def _tell(self) -> None:
        """Show the messages of the run, each once."""
        for message in self.playback.messages:
            self.say(message)
        self.playback.messages.clear()

    def _show_again(self) -> None:
        self.restart_button.visible = self.problems.out_of_view.is_over

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw the world, what hands pull with, and the keys that the level has."""
        chosen = self._app.chosen
        self.stage.fixed_detail = {"on": FULL, "off": NO_EFFECTS}.get(chosen["effects"])
        self.stage.renderer.has_effects = chosen["motion"] == "full"
        self.stage.draw(surface, profile)
        surface.set_clip(self.viewport)
        self.problems.draw(surface)
        draw_key_caps(surface, self._ui, self._keys.shown(), self.viewport, self._keys.is_on_pad)
        draw_labels(surface, self._ui, self.camera, self.playback.current, self.stage.pulls())
        draw_hint(surface, self._ui, self.camera, self.stage.tool)
        self.game.draw(surface)
        renderer, solver = self.stage.renderer, self.playback.current.settings.solver
        self._legend.draw(surface, self._ui, renderer.overlays, renderer.theme, solver, self._legend_area)
        surface.set_clip(None)
        self.graphs.draw(surface)

    @property
    def _legend_area(self) -> pygame.Rect:
        """Where the legend has room [pixels]."""
        return pygame.Rect(self.viewport)

    def status(self, figures: Figures) -> list[tuple[str, Colour]]:
        """State and recording of the run, and for who has opened the whole panel tick and figures."""
        shown = figures if self.shape.open.get(MORE, False) else None
        return run_parts(self.playback, self._state(), self.stage.renderer.non_finite, shown)

    def _state(self) -> str:
        """The state of the run in a word, as status line and window title show it."""
        clock = self.playback.clock
        return "paused" if clock.paused else state_of(clock.speed)

    def title(self) -> str:
        """The name under which the run is saved, or else the level's."""
        name = level_name(self.playback.level.name)
        return name if self.saved is None else self.saved[0].name.removesuffix(SUFFIX)

    def states(self) -> list[str]:
        """State words for the window's title: tick, speed, hands, recording, replay, outcome."""
        words = [f"tick {self.playback.session.tick}", self._state()]
        if self.stage.drag.holds:
            words.append(f"holding {len(self.stage.drag.holds)}")
        words += [] if self.playback.session.recording is None else ["recording"]
        words += [] if self.playback.replay is None else [self.playback.outcome or "watching"]
        if (result := self.game.result) is not None:
            words.append("won" if result.is_won else "lost")
        return words
