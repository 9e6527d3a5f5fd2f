"""Sounds: what is heard of the run on the screen."""

from collections.abc import Callable
from typing import Any, Protocol

from sandbox.app.draw.camera import Camera
from sandbox.app.run.playback import Playback
from sandbox.app.sound.bank import Bank, Note
from sandbox.app.sound.device import Device
from sandbox.app.sound.sound_events import SoundEvents, Sounding
from sandbox.app.sound.voices import Cue, Voices

# What is outside the view is quieter by this factor for each width of the view that it is away.
FAR = 0.25
# Signals are from no thing in the world.
SIGNALS_FROM = -2


class SoundChoices(Protocol):
    """What is chosen, by name."""

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
        """What part of the world is seen."""
        ...


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
        """Let what happened in a frame be heard.

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
        """Let a signal be heard, in the middle and as loud as it is, so long [s] after this frame; see `signals`."""
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
    """A sound where it is on the screen."""
    left, _, width, _ = camera.viewport
    across = 2.0 * (camera.to_pixels(sounding.place)[0] - left) / max(width, 1) - 1.0
    away = max(abs(across) - 1.0, 0.0) / 2.0
    return Cue(
        sounding.note, sounding.loudness * FAR**away, min(max(across, -1.0), 1.0), sounding.source
    )  # fmt: skip
