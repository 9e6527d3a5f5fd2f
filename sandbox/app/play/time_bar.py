"""TimeBar: going through time: a bar under the world with the run's length, and what keys do on it."""

from collections.abc import Callable
from functools import partial
from typing import Any

from sandbox.app.base.loop import BACKWARD_SPEEDS, FAST_SPEEDS
from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.play.time_track import TimeTrack
from sandbox.app.run.playback import Playback
from sandbox.app.run.travel import Mark
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.session.log import Branch

# Layout units.
HEIGHT, BUTTON, GAP, ICON, EDGE = 44.0, 30.0, 4.0, 16.0, 10.0
CLOCK_WIDTH, CLOCK_TEXT = 118.0, 12.0
# A shorter track has no clock beside it.
LEAST_TRACK = 80.0
# Under what it is remembered whether the bar is wanted.
WANTED = "timeline"
# Buttons at the left and at the right of the track: action and picture.
LEFT = (("previous_mark", "previous_mark"), ("back", "back"), ("backwards", "backwards"), ("next_mark", "next_mark"))
RIGHT = (("bookmark", "bookmark"), ("loop", "loop"), ("branches", "branch"))


class TimeBar:
    """The bar of a run and its actions; playback: gives the run that is on the screen."""

    def __init__(self, app: Application, playback: Callable[[], Playback]) -> None:
        self._app, self._playback = app, playback
        self.is_shown = playback().watching or preference(WANTED) is True
        self.track: TimeTrack | None = None
        self._was_paused = False
        self._marks: tuple[object, list[Mark]] = (None, [])
        self.actions: dict[str, Callable[[], object]] = {
            "timeline": self._toggle,
            "back": lambda: self._step(-1),
            "backwards": lambda: self._next_speed(BACKWARD_SPEEDS),
            "fast": lambda: self._next_speed(FAST_SPEEDS),
            "next_mark": partial(self._jump, 1),
            "previous_mark": partial(self._jump, -1),
            "bookmark": self._bookmark,
            "loop_start": partial(self._set_end, 0),
            "loop_end": partial(self._set_end, 1),
            "loop": self._loop,
            "branches": self._choose_branch,
        }

    @property
    def height(self) -> float:
        """The room that it takes [layout units]."""
        return HEIGHT if self.is_shown else 0.0

    def build(self, ui: Ui, width: float, bottom: float) -> None:
        """Lay it out again, width wide, above a lower edge [layout units]."""
        self.track = None
        if not self.is_shown:
            return
        back = ui.panel(ui.rect(0, bottom - HEIGHT, width, HEIGHT))
        self.buttons: dict[str, Any] = {}
        self._ui, x = ui, EDGE
        for action, picture in LEFT:
            self._add(action, picture, x, back)
            x += BUTTON + GAP
        right = width - EDGE - len(RIGHT) * (BUTTON + GAP) + GAP
        for number, (action, picture) in enumerate(RIGHT):
            self._add(action, picture, right + number * (BUTTON + GAP), back)
        self._clock = None
        if right - CLOCK_WIDTH - x >= LEAST_TRACK:
            right -= CLOCK_WIDTH + GAP
            self._clock = ui.label(ui.rect(right, 0, CLOCK_WIDTH, HEIGHT), "", back)
        place = ui.rect(x, 4, max(right - x - GAP, 1.0), HEIGHT - 8)
        self.track = TimeTrack(ui, place, self._playback().travel, self._playback().seek, self._hold, back)
        self.show()

    def _add(self, action: str, picture: str, x: float, back: Any) -> None:
        ui = self._ui
        place = ui.rect(x, (HEIGHT - BUTTON) / 2, BUTTON, BUTTON)
        do, tip = partial(self._app.act, action), tip_of(action, "play")
        self.buttons[action] = ui.button(place, "", do, back, icon=picture, icon_size=ICON, tip=tip, style="quiet")

    def show(self) -> None:
        """Show where the run is."""
        track, playback = self.track, self._playback()
        if track is None:
            return
        if track.travel is not playback.travel:
            self._app.rebuild()
            return
        session, travel = playback.session, playback.travel
        kept = session.history.tick_events
        events = len(kept), next(reversed(kept), None)
        state = (playback.revision, len(session.gestures), events, tuple(travel.bookmarks), session.branches)
        if self._marks[0] != state:
            self._marks = state, travel.marks()
        track.show_run(session.tick, playback.length, session.last_tick, self._marks[1])
        rate = session.world.settings.tick_rate
        pointed = track.pointed
        mark = None if pointed is None else track.mark_near(pointed)
        if mark is not None:
            text = f"{mark.tick / rate:.1f} s {mark.label}"
        elif pointed is not None:
            text = f"{pointed / rate:.2f} s"
        else:
            text = f"{session.tick / rate:.1f} of {playback.length / rate:.1f} s"
        if self._clock is not None:
            font, widest = self._ui.font(CLOCK_TEXT), self._ui.px(CLOCK_WIDTH)
            self._clock.show_text(wrapped(text, font, widest, 1)[0])
        self.buttons["backwards"].is_selected = playback.clock.speed < 0.0
        self.buttons["loop"].is_selected = travel.looping

    # Actions.

    def _toggle(self) -> None:
        self.is_shown = not self.is_shown
        set_preference(WANTED, self.is_shown or None)
        self._app.rebuild()

    def _reveal(self) -> None:
        """Show the bar, as who goes back in time wants to see where he is."""
        if not self.is_shown:
            self.is_shown = True
            self._app.rebuild()

    def _hold(self, held: bool) -> None:
        """Pause the run while the mouse holds the knob."""
        clock = self._playback().clock
        if held:
            self._was_paused = clock.paused
        clock.paused = held or self._was_paused

    def _step(self, by: int) -> None:
        playback = self._playback()
        playback.clock.paused = True
        self._reveal()
        playback.seek(playback.session.tick + by)

    def _next_speed(self, speeds: tuple[float, ...]) -> None:
        self._playback().clock.next_speed(speeds)
        if speeds is BACKWARD_SPEEDS:
            self._reveal()

    def _jump(self, by: int) -> None:
        playback = self._playback()
        playback.clock.paused = True
        self._reveal()
        mark = playback.travel.mark_beside(playback.session.tick, by)
        if mark is None or mark.tick > playback.length:
            self._app.say(
                "There is no mark after this." if by > 0 else "There is no mark before this.", self._app.screen
            )
        else:
            playback.seek(mark.tick)

    def _bookmark(self) -> None:
        playback = self._playback()
        self._reveal()
        tick = playback.session.tick
        marked = playback.travel.toggle_bookmark(tick)
        self._app.say(
            f"Bookmark at tick {tick:,}." if marked else f"No bookmark at tick {tick:,} any more.", self._app.screen
        )

    def _set_end(self, end: int) -> None:
        playback = self._playback()
        self._reveal()
        tick = playback.session.tick
        span = list(playback.travel.span or (0, playback.length))
        span[end] = tick
        playback.travel.set_span(*span)

    def _loop(self) -> None:
        playback = self._playback()
        travel = playback.travel
        self._reveal()
        if travel.span is None:
            rate = playback.session.world.settings.tick_rate
            travel.set_span(max(0, playback.session.tick - round(3.0 * rate)), playback.session.tick)
        travel.looping = not travel.looping
        if travel.looping and travel.span is not None:
            playback.clock.paused = False
            playback.seek(travel.span[0])

    def _choose_branch(self) -> None:
        """Offer what followed before the run was changed in the past."""
        playback = self._playback()
        branches = playback.session.branches
        if not branches:
            self._app.say(
                "There is no earlier version yet. Go back in time and change something: the old run is kept.",
                self._app.screen,
            )
            return
        rate = playback.session.world.settings.tick_rate
        choices = [(_told(branch, rate), partial(playback.return_to, branch)) for branch in reversed(branches)]
        choose(self._app.ui, "Earlier versions of this run", "", choices)


def _told(branch: Branch, rate: float) -> str:
    gestures = len({entry.gesture for entry in branch.history if entry.tick >= branch.tick})
    done = {0: "nothing changed by hand", 1: "1 change by hand"}.get(gestures, f"{gestures} changes by hand")
    return f"From {branch.tick / rate:.1f} s to {branch.last_tick / rate:.1f} s: {done}"
