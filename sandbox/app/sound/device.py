"""Device: the mixer of the system, opened beside the window; where there is none, or it goes away, all is silent."""

import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.sound.bank import Note, Sample
from sandbox.app.sound.voices import MOTOR_FADE, VOICES
from sandbox.app.sound.waves import RATE

# Samples that the mixer works on at a time: 12 ms.
BUFFER = 512
# What is there on Linux where a sound card is.
CARD = Path("/dev/snd/controlC0")


def may_have_sound() -> bool:
    """Whether it is worth to look for a device; on Linux the search itself would print lines where there is none."""
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
        """End a channel within so long [s]."""
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
