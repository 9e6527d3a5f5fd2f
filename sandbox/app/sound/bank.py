"""Bank: the waves that have been made, as the mixer wants them; each is made when it is first wanted."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.sound import signals, waves
from sandbox.app.sound.waves import RATE, STEPS, Wave

# From one number of `Sample.left` to the next [s].
GRAIN = 0.01
LARGEST = 32_767


class Note(NamedTuple):
    """One of the sounds there are: its kind, the step of the scale, and for a thud the stuff that is struck."""

    kind: str
    step: int
    stuff: str = ""


MAKERS: dict[str, Callable[[Note], Wave]] = {
    "thud": lambda note: waves.thud(note.step, note.stuff),
    "splash": lambda note: waves.splash(note.step),
    "pluck": lambda note: waves.pluck(note.step),
    "snap": lambda note: waves.snap(note.step),
    "squeak": lambda note: waves.squeak(note.step),
    "motor": lambda note: waves.motor(note.step),
    "bell": lambda _: signals.bell(),
    "coin": lambda _: signals.coin(),
    "drum": lambda _: signals.drum(),
    "buzzer": lambda _: signals.buzzer(),
    "won": lambda _: signals.won(),
    "lost": lambda _: signals.lost(),
    "star": lambda note: signals.star(note.step),
}
# How loud each kind is beside the others: what lasts, and what is sharp to the ear, is softer.
LEVELS = {"thud": 0.8, "splash": 0.5, "pluck": 0.45, "snap": 0.85, "squeak": 0.16, "motor": 0.22}
# And the signals of rules and of the end of a run.
SIGNAL_LEVELS = {"bell": 0.5, "coin": 0.4, "drum": 0.8, "buzzer": 0.28, "won": 0.5, "lost": 0.5, "star": 0.35}


@dataclass(frozen=True, eq=False)
class Sample:
    """A wave in 16 bits (n,); left (k,): the largest value, 0..1, that comes GRAIN k [s] after it began."""

    pcm: NDArray[np.int16]
    left: NDArray[np.float64]

    def left_after(self, seconds: float) -> float:
        """The largest value, 0..1, that is still to come so long [s] after it began."""
        place = max(int(seconds / GRAIN), 0)
        return float(self.left[place]) if place < len(self.left) else 0.0


class Bank:
    """Samples by their notes."""

    def __getitem__(self, note: Note) -> Sample:
        return _sample(note)

    def make(self, note: Note) -> None:
        """Make a sample before it is wanted."""
        self[note]


def note(kind: str, pitch: float, stuff: str = "") -> Note:
    """The note of a kind that is nearest to a pitch [Hz]."""
    return Note(kind, min(max(waves.step_of(pitch), 0), STEPS - 1), stuff)


def level_of(kind: str) -> float:
    """How loud a kind of sound is beside the others, 0..1."""
    return LEVELS[kind] if kind in LEVELS else SIGNAL_LEVELS[kind]


@cache
def _sample(note: Note) -> Sample:
    wave = MAKERS[note.kind](note)
    mono = np.round(wave * LARGEST).astype(np.int16)
    size = int(GRAIN * RATE)
    padded = np.zeros(-(-len(wave) // size) * size)
    padded[: len(wave)] = np.abs(wave)
    peaks = padded.reshape(-1, size).max(axis=1)
    return Sample(mono, np.maximum.accumulate(peaks[::-1])[::-1])
