"""TimeBar: going through time: a bar under the world with the run's length, and what keys do on it."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.loop import BACKWARD_SPEEDS, FAST_SPEEDS
from sandbox.app.base.shortcuts import tip_of
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import ACCENT, DANGER, LINE, MUTED, SURFACE, TEXT, WARNING, mixed
from sandbox.app.run.playback import Playback
from sandbox.app.run.travel import Mark, Travel
from sandbox.app.widgets.dialogs import choose
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pixel, Widget
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.session.log import Branch

# Layout units.
HEIGHT, BUTTON, GAP, ICON, EDGE = 44.0, 30.0, 4.0, 16.0, 10.0
CLOCK_WIDTH, CLOCK_TEXT = 118.0, 12.0
# A shorter track has no clock beside it.
LEAST_TRACK = 80.0
# Under what it is remembered whether the bar is wanted.
SHOWN = "timeline"
# Buttons at the left and at the right of the track: action and picture.
LEFT = (("previous_mark", "previous_mark"), ("back", "back"), ("backwards", "backwards"), ("next_mark", "next_mark"))
RIGHT = (("bookmark", "bookmark"), ("loop", "loop"), ("branches", "branch"))


class TimeBar:
    """The bar of a run and its actions; playback: gives the run that is on the screen."""

    def __init__(self, app: Application, playback: Callable[[], Playback]) -> None:
        self._app, self._playback = app, playback
        self.is_shown = playback().watching or preference(SHOWN) is True
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
        """Height of the bar [layout units]."""
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
        set_preference(SHOWN, self.is_shown or None)
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
        """Open the menu of branches: runs that were left when the past was changed."""
        playback = self._playback()
        branches = playback.session.branches
        if not branches:
            self._app.say(
                "There is no earlier version yet. Go back in time and change something: the old run is kept.",
                self._app.screen,
            )
            return
        rate = playback.session.world.settings.tick_rate
        choices = [(_branch_text(branch, rate), partial(playback.return_to, branch)) for branch in reversed(branches)]
        choose(self._app.ui, "Earlier versions of this run", "", choices)


def _branch_text(branch: Branch, rate: float) -> str:
    gestures = len({entry.gesture for entry in branch.history if entry.tick >= branch.tick})
    done = {0: "nothing changed by hand", 1: "1 change by hand"}.get(gestures, f"{gestures} changes by hand")
    return f"From {branch.tick / rate:.1f} s to {branch.last_tick / rate:.1f} s: {done}"


# Layout units.
MARGIN, RAIL, KNOB = 10.0, 4.0, 6.5
# A mark answers to the mouse from this far [layout units].
NEAR = 5.0
# Ticks that the keyboard goes by with Shift.
LEAP = 60


class TimeTrack(Widget):
    """A rail from tick 0 to the last; go(tick) is called as the mouse drags on it, hold(held) as it takes and lets go.

    With Shift held a drag chooses the range. Shapes tell marks apart: lines are commands, triangles breaks, diamonds
    goals, flags bookmarks, forks branches.
    """

    is_focusable = True

    def __init__(
        self,
        ui: Ui,
        rect: pygame.Rect,
        travel: Travel,
        go: Callable[[int], object],
        hold: Callable[[bool], object],
        container: Any = None,
    ) -> None:
        super().__init__(ui, rect, container)
        self.travel, self._go, self._hold = travel, go, hold
        self.tick, self.length, self.reached = 0, 1, 0
        self.marks: list[Mark] = []
        # Where the mouse is over the track.
        self.pointed: int | None = None
        self._held = False
        self._span_from: int | None = None
        self._shown: tuple[object, ...] = ()

    def show_run(self, tick: int, length: int, reached: int, marks: list[Mark]) -> None:
        """Show where the run is, how long it is and how far it has been."""
        travel = self.travel
        fresh = (tick, length, reached, marks, travel.span, travel.looping, travel.target, self.pointed)
        if fresh != self._shown:
            self._shown = fresh
            self.tick, self.length, self.reached = tick, max(length, 1), reached
            # Bookmarks outlive a reset: the run comes to them.
            self.marks = [mark for mark in marks if mark.tick <= length]
            self.repaint()

    def pixel_of(self, tick: float) -> int:
        """Horizontal window position of a tick."""
        return self.rect.left + round(self._x_of(tick))

    def mark_near(self, tick: int) -> Mark | None:
        """The mark that lies nearest to where the mouse points, where one is near."""
        near = self.ui.px(NEAR)
        found = [(abs(self._x_of(mark.tick) - self._x_of(tick)), mark) for mark in self.marks]
        found = [entry for entry in found if entry[0] <= near]
        return min(found, key=lambda entry: entry[0])[1] if found else None

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Go where the mouse is while its button is held; with Shift choose a range."""
        tick = self._tick_at(at)
        if pygame.key.get_mods() & pygame.KMOD_SHIFT:
            self._span_from = tick
        else:
            self._held = True
            self._hold(True)
            mark = self.mark_near(tick)
            self._go(tick if mark is None else mark.tick)
        return True

    def on_drag(self, at: Pixel) -> None:
        """Go to the tick under the mouse, or end the range there."""
        tick = self._tick_at(at)
        if self._held:
            self.pointed = tick
            self._go(tick)
        elif self._span_from is not None:
            self.travel.set_span(self._span_from, tick)

    def on_release(self, at: Pixel) -> None:
        """Release the knob: the run stays at its tick."""
        if self._held:
            self._hold(False)
        self._held, self._span_from = False, None
        self.on_hover()

    def on_move(self, at: Pixel) -> None:
        """Note the tick under the mouse, which the label shows."""
        self.pointed = self._tick_at(at)

    def on_hover(self) -> None:
        """Forget that tick once the mouse is elsewhere."""
        if not (self.hovered or self._held):
            self.pointed = None

    def press_key(self, event: pygame.event.Event) -> bool:
        """Left and right go by a tick, with Shift by a second; Home and End to the ends."""
        step = LEAP if event.mod & pygame.KMOD_SHIFT else 1
        targets = {
            pygame.K_LEFT: self.tick - step,
            pygame.K_RIGHT: self.tick + step,
            pygame.K_HOME: 0,
            pygame.K_END: self.length,
        }
        if event.key not in targets:
            return False
        self._go(targets[event.key])
        return True

    def _x_of(self, tick: float) -> float:
        margin = self.ui.px(MARGIN)
        return margin + min(max(tick / self.length, 0.0), 1.0) * (self.rect.width - 2 * margin)

    def _tick_at(self, at: Pixel) -> int:
        margin = self.ui.px(MARGIN)
        fraction = (at[0] - self.rect.left - margin) / max(1, self.rect.width - 2 * margin)
        return round(min(max(fraction, 0.0), 1.0) * self.length)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The rail, the part of it that was reached, the range, the marks and the knob."""
        px, middle = self.ui.px, size[1] // 2
        surface = pygame.Surface(size, pygame.SRCALPHA)
        span = self.travel.span
        if span is not None and span[0] < self.length:
            left, right = (round(self._x_of(tick)) for tick in span)
            band = pygame.Rect(left, px(3), max(right - left, 2), size[1] - px(6))
            colour = ACCENT if self.travel.looping else MUTED
            pygame.draw.rect(surface, mixed(SURFACE, colour, 0.25), band, border_radius=px(3))
            pygame.draw.rect(surface, colour, band, 1, border_radius=px(3))
        self._rail(surface, self.length, LINE)
        self._rail(surface, self.reached, mixed(LINE, MUTED, 0.6))
        self._rail(surface, self.tick, ACCENT)
        for kind in ("command", "break", "goal", "branch", "bookmark"):
            for x in sorted({round(self._x_of(mark.tick)) for mark in self.marks if mark.kind == kind}):
                self._draw_mark(surface, kind, x, middle)
        if self.travel.target is not None:
            x = round(self._x_of(self.travel.target))
            pygame.draw.line(surface, ACCENT, (x, px(4)), (x, size[1] - px(5)), px(2))
        at = pygame.Vector2(self._x_of(self.tick), middle)
        pygame.draw.aacircle(surface, TEXT, at, px(KNOB))
        pygame.draw.aacircle(surface, ACCENT, at, px(KNOB) - px(2))
        return surface

    def _rail(self, surface: pygame.Surface, tick: int, colour: pygame.typing.ColorLike) -> None:
        px, left = self.ui.px, self._x_of(0)
        rail = pygame.Rect(left, surface.get_height() // 2 - px(RAIL) // 2, self._x_of(tick) - left, px(RAIL))
        pygame.draw.rect(surface, colour, rail, border_radius=px(RAIL) // 2)

    def _draw_mark(self, surface: pygame.Surface, kind: str, x: int, middle: int) -> None:
        px = self.ui.px
        if kind == "command":
            pygame.draw.line(surface, TEXT, (x, middle - px(9)), (x, middle - px(4)), px(1.5))
        elif kind == "break":
            top = middle + px(4)
            pygame.draw.polygon(surface, DANGER, [(x, top), (x - px(4), top + px(6)), (x + px(4), top + px(6))])
        elif kind == "goal":
            top, half = middle - px(14), px(4)
            pygame.draw.polygon(
                surface, ACCENT, [(x, top), (x + half, top + half), (x, top + 2 * half), (x - half, top + half)]
            )
        elif kind == "branch":
            pygame.draw.lines(surface, TEXT, False, [(x, middle), (x, middle + px(5)), (x + px(5), middle + px(10))])
            pygame.draw.line(surface, TEXT, (x, middle + px(5)), (x - px(4), middle + px(10)))
        else:
            top = middle - px(14)
            pygame.draw.line(surface, WARNING, (x, top), (x, middle - px(3)), px(1.5))
            pygame.draw.polygon(surface, WARNING, [(x, top), (x + px(8), top + px(3)), (x, top + px(6))])
