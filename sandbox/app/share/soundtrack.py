"""Soundtrack: what is heard in a film, mixed without playing it, as a WAV file."""

import wave
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sandbox.app.draw.camera import Camera
from sandbox.app.film.film import Film
from sandbox.app.sound.bank import Bank
from sandbox.app.sound.mixdown import Mixdown
from sandbox.app.sound.sound_events import SoundEvents
from sandbox.app.sound.sounds import cue_of
from sandbox.app.sound.voices import Voices
from sandbox.app.sound.waves import RATE

# What is never louder than this share of full scale is silence.
SILENCE = 1e-3
# Of this shape a picture is, as to where on it a sound is heard.
_SIZE = (1280, 720)


def write_soundtrack(film: Film, start: float, end: float, path: Path) -> Iterator[None]:
    """Write what is heard from start to end [s] of a film, a tick at a time; where nothing is, there is no file."""
    camera = Camera(viewport=(0, 0, *_SIZE))
    camera.fit(film.box)
    events, bank, mixdown = SoundEvents(), Bank(), Mixdown()
    voices = Voices(mixdown, bank)
    for world in film.states(start, end):
        if world is not None:
            events.hear(world)
            heard, events.heard = events.heard, []
            voices.play([cue_of(each, camera) for each in heard], mixdown.now)
            voices.hum([cue_of(each, camera) for each in events.motors(world)], mixdown.now)
            mixdown.advance(1.0 / film.rate)
        yield
    mixed = mixdown.mixed
    if not len(mixed) or float(np.abs(mixed).max()) < SILENCE:
        return
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes((np.clip(mixed, -1.0, 1.0) * 32767.0).astype("<i2").tobytes())
