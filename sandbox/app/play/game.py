"""Game: the goal of a level while it is played: score, endings, checkpoints, the best run and its ghost."""

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.base.shortcuts import shortcuts, spoken
from sandbox.app.contracts.application import Application, Playing
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Theme
from sandbox.app.draw.overlays import ZONES, name_place
from sandbox.app.play.result_card import Ending, ResultCard, star_times
from sandbox.app.play.score import CHIP, TOP, ScoreView, chips_of
from sandbox.app.play.stage import Stage
from sandbox.app.run.playback import Playback
from sandbox.app.share.page import so_far
from sandbox.app.sound.waves import STAR_RISE, STAR_STEP
from sandbox.app.widgets.dialogs import Choice
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.best_runs import Result, best_recording, best_result
from sandbox.level.document.model import ZoneDef
from sandbox.level.format.slices import work_for
from sandbox.level.reading.files import file_of, shipped_folder
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import CommandError
from sandbox.session.outcome import Outcome, last_checkpoint, outcome, star_words
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session
from sandbox.session.solution import known_solution
from sandbox.session.tuning import tuning_of

# How long the goal is shown at the start [s], and in how much of that it fades.
GOAL_SECONDS, FADING = 6.0, 0.5
# A restart so soon after one from a checkpoint [s] goes to the beginning.
TWICE = 1.5
# Of a card that comes back all is there from the first [s].
LONG_AGO = 1e9
CHECKPOINT = "Checkpoint. {} comes back to here."
BACK_AT_CHECKPOINT = "Back at the checkpoint. {} once more goes to the beginning."
NO_ZONES = "This level has no zones."
NOT_ENDED = "This run has not ended yet."
NO_SOLUTION = "There is no solution beside this level."
NO_GHOST = "There is no best run yet: win this level first, then its ghost can run along."


class Game:
    """The rules of a level on a stage; is_on: whether the run is one to be won or lost, and not one of a pair."""

    def __init__(self, app: Application, screen: Playing, stage: Callable[[], Stage], is_on: bool) -> None:
        self._app, self._screen, self._stage = app, screen, stage
        level = stage().playback.level
        self._has_rules = bool(level.rules)
        self.is_on = is_on
        self.score = ScoreView()
        self.card: ResultCard | None = None
        self._ending: Ending | None = None
        # The tick at whose end the run was won or lost and paused, while it still stands because of that.
        self._ended_at: int | None = None
        self._since = self._goal_left = 0.0
        self._goal_fades = self._is_recording = False
        self._went_back: tuple[Playback, int] | None = None
        self._ghost: GhostRun | None = None
        self.has_ghost = self._wants_ghost = False
        # The solution beside the level's file and its win in words, once it is read, a slice a frame.
        self._solution: tuple[Replay, str] | None = None
        self._reading = self._read_solution()
        self.begin()
        self.actions: dict[str, Callable[[], object]] = {
            "restart": screen.restart, "as_it_was": lambda: screen.restart(as_it_was=True), "card": self.show_card,
            "solution": self._watch_solution,
            "ghost": self._toggle_ghost, ZONES: self._toggle_zones,
        }  # fmt: skip

    @property
    def _playback(self) -> Playback:
        return self._stage().playback

    def begin(self) -> None:
        """Start the game of the run that is on the stage now."""
        self.close()
        if self._ended_at is not None:
            # It was its end that let the run before pause.
            self._playback.clock.paused, self._ended_at = False, None
        self._playback.pauses_at_end = self.is_on
        self._goal_left = GOAL_SECONDS
        self._went_back = self._ending = self._ghost = None
        self._stage().earlier = None
        self._find_ghost()

    def run_along(self, replay: Replay) -> None:
        """Let the ghost of another run go along."""
        self._ghost = GhostRun(replay)

    def _find_ghost(self) -> None:
        """Look for the best run of the level, and let its ghost go along where it is wanted."""
        self.has_ghost = self._keeps_best and best_recording(self._playback.level) is not None
        if self.has_ghost and self._wants_ghost:
            self._load_ghost()

    @property
    def _keeps_best(self) -> bool:
        """Whether the best run of the level is kept: not of what is being edited, which is another one every time."""
        return self.is_on and self._has_rules and not self._screen.of_document

    @property
    def offered(self) -> dict[str, bool]:
        """Whether there is something for actions of a game to do."""
        has_solution = self._solution is not None
        return {"ghost": self.has_ghost, "card": self.is_on, "as_it_was": self.is_on, "solution": has_solution}

    @property
    def _file(self) -> Path | None:
        """The file of the level: one's own, that which the editor has open, or a shipped one; None: there is none."""
        screen, name, editor = self._screen, file_of(self._playback.level), self._app.documents.editor
        if screen.of_document:
            return editor.level_file.path if editor is not None else None
        return screen.source or (shipped_folder("levels") / name if name else None)

    def _read_solution(self) -> Iterator[None]:
        """Read the solution beside the level's file, a slice at a time."""
        path = self._file
        if self.is_on and path is not None:
            self._solution = yield from known_solution(self._playback.level, path)

    @property
    def solved(self) -> str:
        """The win of the solution in words; "" while none is known."""
        return "" if self._solution is None else self._solution[1]

    def _watch_solution(self) -> None:
        """Watch the solution, where there is one."""
        if self._solution is None:
            self._screen.say(NO_SOLUTION)
            return
        run, _ = self._solution
        if self._screen.of_document:
            self._app.documents.play(watched=run)
        else:
            self._app.start(Playback(run.level, run), self._screen.source)

    def _keep_solution(self) -> None:
        """Keep the run so far as the solution of the level's file."""
        run, path = so_far(self._playback.session), self._file
        if self._screen.of_document:
            self._app.documents.keep_solution(run)
        elif path is not None:
            self._app.best.keep_solution(path, run, self._app.say)

    @property
    def shows_ghost(self) -> bool:
        """Whether the ghost of the best run goes along."""
        return self._ghost is not None

    @property
    def moves(self) -> bool:
        """Whether anything of the game's display changes by itself."""
        return self._goal_fades or (self.card is not None and self.card.moves)

    @property
    def is_busy(self) -> bool:
        """Whether something that is seen of it goes on while nothing in the run moves."""
        return self._ghost is not None and not self._playback.clock.paused

    @property
    def result(self) -> Outcome | None:
        """The outcome of the run in the state on the screen."""
        return outcome(self._playback.level, self._playback.current) if self._has_rules else None

    # Restarting.

    def go_back(self) -> bool:
        """Go back to the last checkpoint of the run, if there is one to go back to; whether there is."""
        playback = self._playback
        if not self.is_on or playback.watching or playback.session.recording is not None:
            return False
        playback.apply_pending()
        tick = last_checkpoint(playback.level, playback.session.world)
        if tick is None or self._is_second(playback, tick):
            return False
        # Where the way there is cancelled, the run stays where it is.
        if playback.begin_again_from(tick):
            self._let_go_on()
            self._went_back = playback, tick
            self._screen.say(BACK_AT_CHECKPOINT.format(_restart_key()))
        return True

    def _is_second(self, playback: Playback, tick: int) -> bool:
        """Whether the run has just gone back to a checkpoint of that tick."""
        soon = TWICE * playback.session.world.settings.tick_rate
        return self._went_back == (playback, tick) and playback.session.tick - tick <= soon

    def _let_go_on(self) -> None:
        self.close()
        self._playback.clock.paused = False

    # The card.

    def close(self) -> bool:
        """Remove the card; whether there was one."""
        if self.card is None:
            return False
        self.card.remove()
        self.card = None
        return True

    def show_card(self) -> None:
        """Show the card of a run that has ended once more, and let it stand still meanwhile."""
        result = self.result if self.is_on else None
        if result is None:
            self._screen.say(NOT_ENDED)
        elif self.card is None:
            if self._ending is None or self._ending.outcome != result:
                self._ending = self._ending_of(result)
            self._playback.clock.paused, self._since = True, LONG_AGO
            self._open_card(self._ending)

    def open_at(self, pixel: Pixel) -> bool:
        """Show the card where a pixel is on the chip that tells how the run ended; whether it is."""
        is_there = self.score.end.collidepoint(pixel)
        if is_there:
            self.show_card()
        return is_there

    def keep_watching(self) -> bool:
        """Close the card and let the run go on; whether there was a card."""
        if self.card is None:
            return False
        self._let_go_on()
        return True

    def build(self, ui: Ui) -> None:
        """Lay out the open card again."""
        self._ui = ui
        if self.card is not None and self._ending is not None:
            self._since = self.card.since
            self._open_card(self._ending)

    def _open_card(self, ending: Ending) -> None:
        self._ending = ending
        current, camera = self._playback.current, self._stage().camera
        things = camera.project(current.position[shown_particles(current)])
        self.card = ResultCard(self._ui, ending, self._choices(ending), self._area, self._since, things)

    def _choices(self, ending: Ending) -> list[Choice]:
        """The buttons of a card: at first what most people want next."""
        screen, session, is_won = self._screen, self._playback.session, ending.outcome.is_won
        choices: list[Choice] = [("Again", screen.restart)]
        if not is_won and last_checkpoint(self._playback.level, self._playback.current) is not None:
            choices = [("Checkpoint", self.go_back), ("Beginning", screen.restart)]
        following = None
        if is_won and not screen.of_document:
            following = self._app.files.next_level(self._playback.level, screen.source)
        if following is not None:
            path, is_shipped = following
            choices.insert(0, ("Next level", lambda: self._app.files.open_level(path, is_shipped)))
        if tuning_of(session):
            choices.append(("As it was", self.actions["as_it_was"]))
        if is_won and not screen.of_document:
            choices.append(("Send this", self._app.link_copying.begin))
        if is_won and (screen.of_document or screen.source is not None):
            choices.append(("Keep as solution", self._keep_solution))
        if self.has_ghost or self._is_recording:
            choices.append(("Race your best", self._race))
        return [*choices, ("Keep watching", self.keep_watching)]

    def _race(self) -> None:
        """Begin again, with the ghost of the best run."""
        self._wants_ghost = True
        self._screen.restart()

    def _ending_of(self, result: Outcome, before: Result | None = None, is_best: bool = False) -> Ending:
        """The card's text; before: the best result until then, which else is the one that is kept."""
        level = self._playback.level
        best = best_result(level) if before is None and not is_best and self._keeps_best else before
        shown = [each for each in chips_of(level, self._playback.current, None) if each.name]
        score = tuple(f"{each.name} {each.value}" for each in shown)
        words = star_words(level, result.rule)
        return Ending(
            result, level.settings.tick_rate, None if best is None else best.seconds, is_best, score,
            "".join(words[result.stars - 1 : result.stars]) if result.is_won else "",
        )  # fmt: skip

    def _end(self, result: Outcome) -> None:
        """Announce how the run ended, and keep it if it is the best one."""
        playback, before, is_best = self._playback, None, False
        if result.is_won and self._keeps_best:
            before, rate = best_result(playback.level), playback.level.settings.tick_rate
            try:
                is_best = self._is_recording = self._app.best.note(playback, Result(result.stars, result.tick, rate))
            except OSError as error:
                self._screen.say(f"The best result cannot be kept: {error.strerror or error}.")
        self._since, self._ended_at = 0.0, result.tick
        self._open_card(self._ending_of(result, before, is_best))
        self._app.sounds.signal("won" if result.is_won else "lost")
        for number, after in enumerate(star_times(result.stars)):
            self._app.sounds.signal("star", STAR_STEP + STAR_RISE * number, after)

    def _toggle_zones(self) -> None:
        if self._playback.level.zones:
            self._stage().toggle_view(ZONES)
        else:
            self._screen.say(NO_ZONES)

    # The ghost.

    def _toggle_ghost(self) -> None:
        self._wants_ghost = self._ghost is None
        if not self._wants_ghost:
            self._ghost = self._stage().earlier = None
            return
        self._find_ghost()
        if not self.has_ghost:
            self._screen.say(NO_GHOST)

    def _load_ghost(self) -> None:
        path = best_recording(self._playback.level)
        if path is None:
            return
        try:
            self._ghost = GhostRun(read_replay(path))
        except ReplayError as error:
            self._screen.say(f"The best run cannot be shown: {error.faults[0]}")

    # A frame.

    def update(self, frame_time: float, pointer: Pixel | None) -> None:
        """Take in what the ticks of a frame of frame_time [s] brought; pointer: where the mouse is over the world."""
        playback = self._playback
        self._tell_fired(playback)
        if not playback.clock.paused:
            self._ended_at = None
            self.close()
        elif self.card is not None and self._ending is not None:
            if self.result == self._ending.outcome:
                self.card.update(frame_time, self._app.chosen["motion"] == "less")
            else:
                # What was undone did not happen, and the run goes on; who goes through time stays where he is.
                playback.clock.paused = self._ended_at != playback.session.tick
                self.close()
        work_for(self._reading, _READING)
        self._follow_goal(frame_time, pointer)
        if self._is_recording and not self._app.best.moves:
            self._is_recording = False
            self._find_ghost()
        if self._ghost is not None:
            self._ghost.follow(playback.session.tick)
            self._stage().earlier = self._ghost.state

    def _tell_fired(self, playback: Playback) -> None:
        actions, ended = playback.fired.take()
        for action in actions:
            if action.say is not None:
                self._screen.say(action.say)
            if action.sound is not None:
                self._app.sounds.signal(action.sound)
            if action.checkpoint and not playback.watching:
                self._screen.say(CHECKPOINT.format(_restart_key()))
        result = self.result if ended else None
        if result is not None and self.is_on and not playback.watching:
            self._end(result)

    def _follow_goal(self, frame_time: float, pointer: Pixel | None) -> None:
        before, is_asked = (
            self._goal_left,
            self._playback.clock.paused or (pointer is not None and self.score.place.collidepoint(pointer)),
        )
        if not (self._playback.level.goal or self.solved):
            self._goal_left = 0.0
        elif is_asked and self.card is None:
            self._goal_left = max(self._goal_left, FADING)
        else:
            self._goal_left = max(self._goal_left - frame_time, 0.0)
        self._goal_fades = self._goal_left != before

    @property
    def _area(self) -> pygame.Rect:
        return pygame.Rect(self._stage().camera.viewport)

    @property
    def height(self) -> float:
        """The room that a row of chips takes at the top of the world [layout units]."""
        return TOP + CHIP if self.is_on else 0.0

    def draw(self, surface: pygame.Surface) -> None:
        """Draw score and goal, and the names of zones that are shown."""
        stage = self._stage()
        if ZONES in stage.renderer.overlays.shown:
            draw_zone_names(surface, self._ui, stage.camera, stage.playback.level.zones, stage.renderer.theme)
        if not self.is_on:
            return
        playback = self._playback
        chips = chips_of(playback.level, playback.current, self.result)
        goal = (playback.level.goal, self.solved) if self.card is None else ("", "")
        self.score.draw(surface, self._ui, chips, goal, self._goal_left / FADING, self._area)


def _restart_key() -> str:
    """The keys that go back to a checkpoint, as a part of a sentence."""
    return spoken(next(entry.keys for entry in shortcuts("play") if entry.action == "reset"))


# Wall time [s] of a frame in which a solution is read.
_READING = 0.004
# Wall time [s] that its ticks may take in a frame; where that is too little it is not seen until it has caught up.
_GHOST_BUDGET = 0.006


class GhostRun:
    """Plays another run beside this one; state: at the same tick, None while it is not there yet."""

    def __init__(self, replay: Replay) -> None:
        self._session = Session(replay.level, script=replay.script)
        self._last = replay.ticks
        self._is_broken = False
        self.state: Snapshot | None = self._session.snapshot()

    def follow(self, tick: int) -> None:
        """Go to a tick, or as near as a frame has time for; beyond its end it stands as it ended."""
        session, tick = self._session, min(tick, self._last)
        if self._is_broken or (self.state is not None and self.state.tick == tick):
            return
        end = time.perf_counter() + _GHOST_BUDGET
        with np.errstate(over="ignore", invalid="ignore"):
            if tick <= session.last_tick and not session.tick <= tick <= session.tick + 1:
                session.seek(tick)
            try:
                while session.tick < tick and time.perf_counter() < end:
                    session.advance()
            except CommandError:
                self._is_broken = True
        session.take_messages()
        self.state = session.snapshot() if session.tick == tick and not self._is_broken else None


# Sizes in layout units: of the text, of what surrounds it, and how far it is above its zone.
_NAME_SIZE, _NAME_AROUND, _NAME_ABOVE = 12.0, 4.0, 3.0
_NAME_OPACITY = 200


def draw_zone_names(surface: pygame.Surface, ui: Ui, camera: Camera, zones: Sequence[ZoneDef], theme: Theme) -> None:
    """Write the name of each zone where it begins to be above it, inside the view."""
    font, view = ui.font(_NAME_SIZE, True), pygame.Rect(camera.viewport)
    for zone in zones:
        text = font.render(zone.id, True, theme.accent)
        plate = pygame.Surface(
            (text.width + 2 * ui.px(_NAME_AROUND), text.height + ui.px(_NAME_AROUND)), pygame.SRCALPHA
        )
        pygame.draw.rect(plate, (*theme.card, _NAME_OPACITY), plate.get_rect(), border_radius=ui.px(4))
        plate.blit(text, text.get_rect(center=plate.get_rect().center))
        x, y = camera.to_pixels(name_place(zone))
        if not view.inflate(view.size).collidepoint(x, y):
            continue
        place = plate.get_rect(midbottom=(round(x), round(y) - ui.px(_NAME_ABOVE)))
        surface.blit(plate, place.clamp(view) if place.colliderect(view) else place)
