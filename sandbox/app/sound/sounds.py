"""Sounds: what is heard of the run on the screen, by the mixer of the system; where there is none, all is silent."""

import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.run.playback import Playback
from sandbox.app.sound.sound_events import SoundEvents, Sounding
from sandbox.app.sound.voices import MOTOR_FADE, VOICES, Cue, Voices
from sandbox.app.sound.waves import RATE, Bank, Note, Sample

# What is outside the view is quieter by this factor for each width of the view that it is away.
FAR = 0.25
# Signals are from no thing in the world.
SIGNALS_FROM = -2


class SoundChoices(Protocol):
    """The chosen volume and sounds, by name."""

    def __getitem__(self, name: str) -> Any:
        """The value that was chosen."""
        ...


class SoundingRun(Protocol):
    """A run that can be heard."""

    @property
    def playback(self) -> Playback:
        """The run whose sounds are played."""
        ...

    @property
    def camera(self) -> Camera:
        """The camera of the world that is heard."""
        ...


# Samples that the mixer works on at a time: 12 ms.
BUFFER = 512
# What is there on Linux where a sound card is.
CARD = Path("/dev/snd/controlC0")


def may_have_sound() -> bool:
    """Whether to look for a sound device; on Linux the search itself would print lines where there is none."""
    if not sys.platform.startswith("linux") or os.environ.get("SDL_AUDIODRIVER") or os.environ.get("PULSE_SERVER"):
        return True
    runtime = Path(os.environ.get("XDG_RUNTIME_DIR", f"/run/user/{os.getuid()}"))
    servers = (runtime / "pulse" / "native", runtime / "pipewire-0")
    return any(path.exists() for path in (*servers, CARD))


class Device:
    """The mixer as an output of voices.

    Until `open` has found it, and after it is lost, what is asked of it is not done. No fault of it is ever told: who
    has no loudspeaker misses nothing.
    """

    def __init__(self) -> None:
        self._thread: threading.Thread | None = None
        self._loops: dict[Note, pygame.mixer.Sound] = {}
        self.is_open = False
        self._has_tried = False

    def open(self) -> None:
        """Look for a device, once, on a thread of its own: a sound server may take long to answer."""
        if not self._has_tried:
            self._has_tried = True
            if may_have_sound():
                self._thread = threading.Thread(target=self._open, daemon=True)
                self._thread.start()

    def wait(self) -> None:
        """Wait until the search is over."""
        if self._thread is not None:
            self._thread.join()

    def look_again(self) -> None:
        """Search for a device again at the next `open`, as one was plugged in or taken out."""
        if self._thread is None or not self._thread.is_alive():
            self._lose()
            self._has_tried = False

    def close(self) -> None:
        """Give the device back."""
        if self._thread is None or not self._thread.is_alive():
            self._lose()

    def _open(self) -> None:
        try:
            pygame.mixer.init(RATE, -16, 2, BUFFER, allowedchanges=0)
            pygame.mixer.set_num_channels(VOICES)
        except (pygame.error, NotImplementedError, OSError):
            return
        self.is_open = True

    def _lose(self) -> None:
        self.is_open = False
        self._loops.clear()
        try:
            pygame.mixer.quit()
        except (pygame.error, NotImplementedError):
            return

    # As an output.

    def play(self, channel: int, note: Note, sample: Sample, gains: tuple[float, float], loop: bool) -> None:
        """Begin a sample on a channel."""
        if not self.is_open:
            return
        try:
            if not loop:
                # With its gains in it: those of a channel would come into force a moment after it has begun.
                pcm = np.round(sample.pcm[:, None] * np.array(gains)).astype(np.int16)
                pygame.mixer.Channel(channel).play(pygame.mixer.Sound(buffer=pcm.tobytes()))
                return
            if note not in self._loops:
                self._loops[note] = pygame.mixer.Sound(buffer=np.column_stack([sample.pcm] * 2).tobytes())
            mixed = pygame.mixer.Channel(channel)
            mixed.play(self._loops[note], -1, fade_ms=round(1000 * MOTOR_FADE))
            mixed.set_volume(*gains)
        except pygame.error:
            self._lose()

    def set_gains(self, channel: int, gains: tuple[float, float]) -> None:
        """Change how loud a channel is."""
        self._do(channel, lambda mixed: mixed.set_volume(*gains))

    def fade(self, channel: int, seconds: float) -> None:
        """Fade a channel out within so many seconds."""
        self._do(channel, lambda mixed: mixed.fadeout(round(1000 * seconds)))

    def is_busy(self, channel: int) -> bool:
        """Whether a channel still sounds."""
        return bool(self._do(channel, lambda mixed: mixed.get_busy()))

    def _do(self, channel: int, do: Callable[[pygame.mixer.Channel], object]) -> object:
        if not self.is_open:
            return None
        try:
            return do(pygame.mixer.Channel(channel))
        except pygame.error:
            self._lose()
            return None


class Sounds:
    """Listens to one run at a time; chosen: whether there is sound, and how loud. clock: now [s]."""

    def __init__(self, chosen: SoundChoices, clock: Callable[[], float], device: Device | None = None) -> None:
        self._chosen, self._clock = chosen, clock
        self.device = device or Device()
        self.bank = Bank()
        self.voices = Voices(self.device, self.bank)
        self._ear = SoundEvents()
        self._playback: Playback | None = None
        # Signals that are wanted, each with how soon [s].
        self._signals: list[tuple[float, Note]] = []
        # What this run is likely to need, made a piece a frame, so that no frame waits for it.
        self._ahead: list[Note] = []

    def update(self, run: SoundingRun | None, is_heard: bool) -> None:
        """Play the sounds of what happened in a frame.

        run: that on the screen; is_heard: nothing lies over it, and time passes in it.
        """
        now = self._clock()
        playback = None if run is None or not is_heard or self._chosen["sound"] == "off" else run.playback
        if playback is not self._playback:
            self._attend(playback, now)
        self._play_signals(now)
        if run is None or playback is None:
            return
        self.device.open()
        self.voices.volume = self._chosen["volume"]
        heard, self._ear.heard = self._ear.heard, []
        if self.device.is_open:
            world = playback.session.world
            camera = run.camera
            if self._ear.has_new_bodies:
                self._ahead = self._ear.likely_notes()
            if self._ahead:
                self.bank.make(self._ahead.pop())
            self.voices.play([cue_of(each, camera) for each in heard], now)
            self.voices.hum([cue_of(each, camera) for each in self._ear.motors(world)], now)

    def signal(self, kind: str, step: int = 0, after: float = 0.0) -> None:
        """Play a signal, in the middle and as loud as it is, so long [s] after this frame; see `signals`."""
        self._signals.append((self._clock() + after, Note(kind, step)))

    def _play_signals(self, now: float) -> None:
        due = [note for at, note in self._signals if at <= now]
        self._signals = [(at, note) for at, note in self._signals if at > now]
        if not due or self._chosen["sound"] == "off":
            return
        self.device.open()
        self.voices.volume = self._chosen["volume"]
        if self.device.is_open:
            self.voices.play([Cue(note, 1.0, 0.0, SIGNALS_FROM) for note in due], now)

    def _attend(self, playback: Playback | None, now: float) -> None:
        """Listen to another run, or to none."""
        if self._playback is not None:
            self._playback.listener = None
        self._playback = playback
        self.voices.quieten(now)
        self._ear.forget()
        if playback is not None:
            playback.listener = self._ear

    def look_again(self) -> None:
        """Search for a sound device again, as one was plugged in or taken out."""
        self.device.look_again()

    def close(self) -> None:
        """Fall silent for good."""
        self._attend(None, self._clock())
        self.device.close()


def cue_of(sounding: Sounding, camera: Camera) -> Cue:
    """The cue of a sound, with pan and loudness from its place on the screen."""
    left, _, width, _ = camera.viewport
    across = 2.0 * (camera.to_pixels(sounding.place)[0] - left) / max(width, 1) - 1.0
    away = max(abs(across) - 1.0, 0.0) / 2.0
    return Cue(
        sounding.note, sounding.loudness * FAR**away, min(max(across, -1.0), 1.0), sounding.source
    )  # fmt: skip
