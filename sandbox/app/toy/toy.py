"""Toy: a level in a small window of its own that feels how it is moved, and sleeps while nothing moves."""

import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import pygame

from sandbox.app.base.loop import LONGEST_FRAME, Profile
from sandbox.app.draw.colours import MUTED, show_theme
from sandbox.app.play.drive_keys import DriveKeys
from sandbox.app.play.stage import Stage
from sandbox.app.run.playback import Playback
from sandbox.app.settings.chosen import Chosen, theme_of
from sandbox.app.sound.sounds import Sounds
from sandbox.app.toy.toy_window import ToyWindow
from sandbox.app.widgets.fonts import plain_font
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import free_particle_at, shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Shake

# Frames a second: while somebody plays or something moves fast, and while it comes to rest. Looks for events while it
# sleeps: more cost a share of the processor, fewer wake it late.
PLAYED_RATE, CALM_RATE, NAPS = 60, 30, 12
# Free room between what the level shows and the edge of the window [layout units].
MARGIN = 3.0
# The button that closes it: how far from the corner, its radius, the arms of its cross [layout units].
CLOSE_AT, CLOSE_RADIUS, CLOSE_ARM = 16.0, 10.0, 3.6
# How far an arrow key moves the frame [m], and how long words are shown [s].
NUDGE, READABLE = 0.35, 6.0
ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, 1), pygame.K_DOWN: (0, -1)}
HINT = "Drag the window to shake it"
# A particle is taken hold of that is no farther from the pointer than this [layout units]; elsewhere is the window.
REACH = 16.0


class ToyChoices:
    """Settings of the toy: its sound is its own, and off at first."""

    def __init__(self, chosen: Chosen, sound: Any) -> None:
        self._chosen = chosen
        self.sound = "on" if sound == "on" else "off"

    def __getitem__(self, name: str) -> Any:
        return self.sound if name == "sound" else self._chosen[name]


class Toy:
    """A level in the window; `frame` is one turn of the loop; record: a file that the run is recorded to."""

    def __init__(self, window: ToyWindow, level: Level, chosen: Chosen, record: Path | None = None) -> None:
        self.window, self.chosen = window, chosen
        show_theme(theme_of(chosen["theme"]))
        self.playback = Playback(level)
        if record is not None:
            self.playback.session.record_to(record)
        self.motion = FrameMotion()
        self.sleep_timer = SleepTimer()
        self.choices = ToyChoices(chosen, window.desk.kept.get("sound"))
        self.sounds = Sounds(self.choices, time.perf_counter)
        self.profile = Profile()
        self.running, self.asleep, self.hovered = True, False, False
        # Where in the window the pointer took it, and where in it the pointer is now, while it is moved.
        self._taken_at: tuple[int, int] | None = None
        self._pointed_at: tuple[int, int] | None = None
        self._pressed = False
        self._gesture: int | None = None
        self._words, self._words_left = window.refusal or HINT, READABLE
        self._make_stage()

    def _make_stage(self) -> None:
        width, height = self.window.size
        self._keys = DriveKeys(self.playback)
        self.stage = Stage(self.playback, (0, 0, width, height), self.window.scale)
        # The edge of the window is the edge of what is seen: no margin but this.
        left, bottom, right, top = self.stage.first_box
        rims = 2.0 * MARGIN * self.window.scale
        self.camera.zoom = min((width - rims) / max(right - left, 1e-9), (height - rims) / max(top - bottom, 1e-9))

    @property
    def camera(self) -> Any:
        """The camera of the toy's world."""
        return self.stage.camera

    # The loop.

    def run(self, seconds: float | None = None) -> None:
        """Run until the window is closed, or for this many seconds."""
        started = before = time.perf_counter()
        clock = pygame.time.Clock()
        while self.running and (seconds is None or before - started < seconds):
            now = time.perf_counter()
            self.frame(now - before)
            before = now
            if self.asleep:
                time.sleep(1.0 / NAPS)
            else:
                clock.tick(PLAYED_RATE if self._is_played else CALM_RATE)

    @property
    def _is_played(self) -> bool:
        return self._pressed or not self.motion.rests or self.sleep_timer.moves_fast

    def frame(self, seconds: float) -> None:
        """One frame: events, ticks, a picture; asleep: events alone."""
        events = pygame.event.get()
        for event in events:
            self._handle(event)
        self._follow_pointer()
        moved = self.motion.see(self.window.place, self.camera.zoom)
        # A window that is shown for the first time sends events as well: only what a person does wakes it.
        held = any(is_held for _, is_held in self._keys.shown())
        if moved or held or self._pressed or any(event.type in WAKING for event in events):
            self.sleep_timer.disturb()
        if self.sleep_timer.is_due and self.motion.rests:
            if not self.asleep:
                self._fall_asleep()
            return
        self.asleep = self.stage.renderer.asleep = False
        if self.window.refresh():
            self._make_stage()
        self._pass_time(seconds)
        self._draw()

    def _pass_time(self, seconds: float) -> None:
        self._tick(seconds)
        rested = self.stage.rest_timer.lasted
        self.sleep_timer.follow(self.playback.current, self.camera.zoom, seconds, self.hovered, rested)
        # A toy has no line of words: what broke can be seen.
        self.playback.messages.clear()
        self.sounds.update(self, True)
        self._words_left -= seconds

    def _tick(self, seconds: float) -> None:
        """Make the ticks of a frame, with a shake before each in which the window accelerates."""
        clock, rate = self.playback.clock, self.playback.session.world.settings.tick_rate
        due = int((clock.accumulator + min(seconds, LONGEST_FRAME)) * rate)
        for _ in range(due - 1):
            self._shake(rate)
            self.playback.advance(1.0 / rate)
        if due:
            self._shake(rate)
        passed = max(due - 1, 0) / rate
        self.stage.update(min(seconds, LONGEST_FRAME) - passed, None, self.profile, passed)

    def _shake(self, tick_rate: float) -> None:
        if self.motion.rests:
            self._gesture = None
            return
        acceleration = self.motion.accelerate(tick_rate)
        world = self.playback.session.world
        if acceleration != (0.0, 0.0) and (shown_particles(world) & (world.inverse_mass > 0.0)).any():
            self._gesture = self._gesture or self.playback.session.new_gesture()
            self.playback.submit(Shake(acceleration), self._gesture)

    def _fall_asleep(self) -> None:
        """Close the eyes, show that once, and forget what led here: a toy may stand for weeks."""
        self.asleep = self.stage.renderer.asleep = True
        self.stage.renderer.pointer = None
        self._words_left = 0.0
        self._draw()
        self.sounds.update(None, False)
        if self.playback.session.recording is None and not self.stage.drag.holds:
            self._show(Playback(self.playback.level, start=self.playback.session.snapshot()))
        self.window.keep(sound=self.choices.sound)

    def close(self) -> None:
        """Close the window; a recording gets its last line, and the place is remembered."""
        self.playback.stop_recording()
        self.sounds.close()
        self.window.keep(sound=self.choices.sound)
        self.window.close()

    # What a person does.

    def _handle(self, event: pygame.event.Event) -> None:
        if event.type in (pygame.QUIT, pygame.WINDOWCLOSE):
            self.running = False
        elif event.type == pygame.AUDIODEVICEREMOVED:
            self.sounds.look_again()
        elif event.type == pygame.WINDOWENTER:
            self.hovered = True
        elif event.type == pygame.WINDOWLEAVE:
            self.hovered = False
        elif event.type == pygame.KEYDOWN:
            self._press_key(event)
        elif event.type == pygame.KEYUP:
            self._keys.release(event.key)
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button in (1, 2, 3):
            self._press(event)
        elif event.type == pygame.MOUSEMOTION:
            self._move(event)
        elif event.type == pygame.MOUSEBUTTONUP and event.button in (1, 2, 3):
            self._release(event)

    def _press_key(self, event: pygame.event.Event) -> None:
        with_ctrl = bool(event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META))
        if event.key == pygame.K_ESCAPE or (with_ctrl and event.key in (pygame.K_q, pygame.K_w)):
            self.running = False
        elif self._keys.press(event.key, event.mod):
            return
        elif event.key in ARROWS:
            dx, dy = ARROWS[event.key]
            self._nudge(dx, dy)
        elif event.key == pygame.K_m:
            self.choices.sound = "off" if self.choices.sound == "on" else "on"
            self._say(f"Sound {self.choices.sound}")
        elif event.key == pygame.K_r:
            self._begin_again()
        elif with_ctrl and event.key == pygame.K_z:
            self.playback.submit_undo()
        elif with_ctrl and event.key == pygame.K_y:
            self.playback.submit_redo()

    def _nudge(self, dx: int, dy: int) -> None:
        """Move the window by a key, where it can be, and the frame in any case."""
        if self.window.floats:
            x, y = self.window.place
            step = round(NUDGE * self.camera.zoom)
            self.window.move_to((x + dx * step, y - dy * step))
        else:
            self.motion.nudge(dx * NUDGE, dy * NUDGE)

    def _begin_again(self) -> None:
        if self.playback.session.recording is None:
            self._show(self.playback.reset())

    def _show(self, playback: Playback) -> None:
        """Go on with another run of the level."""
        self.playback = playback
        self._keys = DriveKeys(playback)
        self.stage.replace_playback(playback)

    def _say(self, words: str) -> None:
        self._words, self._words_left = words, READABLE / 2

    def _pixel(self, position: tuple[int, int]) -> tuple[float, float]:
        ratio = self.window.pixel_ratio
        return position[0] * ratio[0], position[1] * ratio[1]

    def _press(self, event: pygame.event.Event) -> None:
        pixel = self._pixel(event.pos)
        if event.button == 1 and math.dist(pixel, self._close_button) <= 1.3 * CLOSE_RADIUS * self.window.scale:
            self.running = False
        elif event.button == 1 and not pygame.key.get_mods() & pygame.KMOD_ALT and self._can_hold(pixel):
            self._pressed = True
            self.stage.point("down", pixel, pygame.key.get_mods() & ~pygame.KMOD_SHIFT)
        elif self.window.floats:
            self._taken_at = self._pointed_at = event.pos

    def _can_hold(self, pixel: tuple[float, float]) -> bool:
        within = REACH * self.window.scale / self.camera.zoom
        return free_particle_at(self.playback.current, self.camera.to_world(pixel), within) is not None

    def _move(self, event: pygame.event.Event) -> None:
        self.hovered = True
        pixel = self._pixel(event.pos)
        self.stage.renderer.pointer = pixel
        if self._taken_at is not None:
            self._pointed_at = event.pos
        elif self._pressed:
            self.stage.point("move", pixel, 0)

    def _follow_pointer(self) -> None:
        """Bring the window to where the pointer that took it is now."""
        at, taken = self._pointed_at, self._taken_at
        if at is None or taken is None or at == taken:
            return
        x, y = self.window.place
        self.window.move_to((x + at[0] - taken[0], y + at[1] - taken[1]))
        # What was reported until now was reported in the window as it stood.
        self._pointed_at = taken
        pygame.event.clear(pygame.MOUSEMOTION)

    def _release(self, event: pygame.event.Event) -> None:
        if self._taken_at is not None:
            self._taken_at = None
            self.window.keep(sound=self.choices.sound)
        elif self._pressed and event.button == 1:
            self._pressed = False
            self.stage.point("up", self._pixel(event.pos), 0)

    # Drawing.

    @property
    def _close_button(self) -> tuple[float, float]:
        scale = self.window.scale
        return self.window.size[0] - CLOSE_AT * scale, CLOSE_AT * scale

    def _draw(self) -> None:
        surface, scale, theme = self.window.surface, self.window.scale, self.stage.renderer.theme
        if not self.hovered:
            self.stage.renderer.pointer = None
        self.stage.renderer.has_effects = self.chosen["motion"] == "full"
        self.stage.draw(surface, self.profile)
        pygame.draw.rect(surface, theme.line, surface.get_rect(), max(1, round(scale)))
        if self.hovered and not self.asleep:
            x, y = self._close_button
            pygame.draw.aacircle(surface, theme.card, (x, y), CLOSE_RADIUS * scale)
            arm = CLOSE_ARM * scale
            for side in (-1, 1):
                start, end = (x - arm, y - side * arm), (x + arm, y + side * arm)
                pygame.draw.line(surface, theme.text, start, end, max(2, round(1.6 * scale)))
        if self._words and self._words_left > 0.0:
            self._draw_words(self._words)
        self.window.flip()

    def _draw_words(self, words: str) -> None:
        surface, scale = self.window.surface, self.window.scale
        width = surface.get_width() - round(24 * scale)
        picture = plain_font(round(12 * scale), False).render(words, True, MUTED, None, width)
        place = picture.get_rect(midtop=(surface.get_width() // 2, round(10 * scale)))
        surface.blit(picture, place)


WAKING = (
    pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP, pygame.KEYDOWN, pygame.WINDOWENTER,
    pygame.WINDOWRESIZED, pygame.MOUSEWHEEL,
)  # fmt: skip


# Time [s] within which the frame follows its window: a mouse jumps, what is held by a box must not.
FOLLOWS = 0.05
# The frame is no faster [m/s], accelerates no harder [m/s^2], and is never farther behind [m].
FASTEST, HARDEST, FARTHEST = 14.0, 400.0, 1.2
# Slower [m/s] and nearer [m] than this it stands.
STANDS, IS_THERE = 0.02, 0.002

Vector = tuple[float, float]


class FrameMotion:
    """A frame that follows its window; velocity [m/s], behind [m]: how far it has to go still."""

    def __init__(self) -> None:
        self.velocity: Vector = (0.0, 0.0)
        self.behind: Vector = (0.0, 0.0)
        self._place: tuple[int, int] | None = None

    @property
    def rests(self) -> bool:
        """Whether the frame stands where its window is."""
        return self.velocity == (0.0, 0.0) and self.behind == (0.0, 0.0)

    def see(self, place: tuple[int, int], zoom: float) -> bool:
        """Take in where the window is now [pixels], a metre being `zoom` pixels; whether it has moved."""
        before, self._place = self._place or place, place
        dx, dy = (place[0] - before[0]) / zoom, (before[1] - place[1]) / zoom
        x, y = self.behind[0] + dx, self.behind[1] + dy
        far = math.hypot(x, y)
        scale = 1.0 if far <= FARTHEST else FARTHEST / far
        self.behind = (x * scale, y * scale)
        return place != before

    def forget(self, place: tuple[int, int]) -> None:
        """Forget the window's motion: it appears here, nobody has moved it."""
        self._place = place

    def nudge(self, dx: float, dy: float) -> None:
        """Move the frame by (dx, dy) [m] as if its window had moved."""
        self.behind = (self.behind[0] + dx, self.behind[1] + dy)

    def accelerate(self, tick_rate: float) -> Vector:
        """The acceleration [m/s^2] of the coming tick of 1 / tick_rate s.

        The frame goes where its window is, as fast as v = behind / FOLLOWS, but for the limits. Whatever it does, it
        comes to rest again, so that all accelerations together are none.
        """
        h = 1.0 / tick_rate
        (x, y), (vx, vy) = self.behind, self.velocity
        wanted_x, wanted_y = x / FOLLOWS, y / FOLLOWS
        if math.hypot(x, y) < IS_THERE and math.hypot(vx, vy) < STANDS:
            wanted_x = wanted_y = 0.0
        speed = math.hypot(wanted_x, wanted_y)
        if speed > FASTEST:
            wanted_x, wanted_y = wanted_x * FASTEST / speed, wanted_y * FASTEST / speed
        ax, ay = (wanted_x - vx) / h, (wanted_y - vy) / h
        strength = math.hypot(ax, ay)
        if strength > HARDEST:
            ax, ay = ax * HARDEST / strength, ay * HARDEST / strength
            vx, vy = vx + ax * h, vy + ay * h
        else:
            vx, vy = wanted_x, wanted_y
        self.velocity = (vx, vy)
        self.behind = (0.0, 0.0) if (vx, vy) == (0.0, 0.0) else (x - vx * h, y - vy * h)
        return ax, ay


# It sleeps after so long [s] at rest, with the pointer over it after so long without a deed.
DROWSY, WATCHED = 2.0, 12.0
# Faster than this [pixels/s] half the frames would be seen to be missing.
FAST = 40.0


class SleepTimer:
    """When a toy falls asleep: is_due; moves_fast: something is fast enough for every frame to count."""

    def __init__(self) -> None:
        self.moves_fast = True
        self._rested = self._idle = 0.0
        self._hovered = False

    @property
    def is_due(self) -> bool:
        """Whether nothing moves, and nobody has done anything for a while."""
        return self._rested >= DROWSY and self._idle >= (WATCHED if self._hovered else DROWSY)

    def disturb(self) -> None:
        """Note that a person has done something."""
        self._idle = 0.0

    def follow(self, now: Snapshot, zoom: float, seconds: float, hovered: bool, rested: float) -> None:
        """Take in the state after `seconds`, a metre being `zoom` pixels; all has been at rest for `rested` [s]."""
        self._hovered, self._rested = hovered, rested
        self._idle += seconds
        free = shown_particles(now) & (now.inverse_mass > 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            fastest = np.abs(now.velocity[free]).max(initial=0.0)
        self.moves_fast = bool(fastest * zoom > FAST)
