"""Waves: what things sound like, made of a few sines and a little noise; each in a millisecond or two.

Every wave is mono, its peak is 1, and it begins and ends at 0, so that none clicks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Wave = NDArray[np.float64]

# Samples a second.
RATE = 44_100
# The pentatonic scale, in semitones above its root: whatever things sound together, they sound well.
SCALE = (0, 2, 4, 7, 9)
# Pitch [Hz] of the lowest step, a C, and how many steps there are: five octaves.
LOWEST, STEPS = 65.41, 26
# From so much of its peak on a wave is let go, and this long [s] it fades then.
QUIET, FADE = 0.004, 0.008


@dataclass(frozen=True)
class Stuff:
    """What is heard of a stuff that is struck: its modes and the noise of the blow.

    pitch: of a thing of 1 m [Hz]. modes: frequency over the lowest, time [s] to fall to 1/e, strength. glide: how much
    higher it begins. noise: strength of the blow, below cut [Hz], over in this many s.
    """

    pitch: float
    modes: tuple[tuple[float, float, float], ...]
    glide: float
    noise: float
    cut: float
    blow: float = 0.012


# Modes of what is hard are those of a free bar (1 : 2.76 : 5.40 : 8.93), of what is soft about those of a drum.
STUFFS: dict[str, Stuff] = {
    "jelly": Stuff(130.0, ((1.0, 0.10, 1.0), (1.59, 0.05, 0.35)), 1.7, 0.35, 420.0, 0.02),
    "rubber": Stuff(165.0, ((1.0, 0.13, 1.0), (2.14, 0.06, 0.3)), 1.25, 0.3, 900.0),
    "cloth": Stuff(150.0, ((1.0, 0.05, 0.4),), 1.3, 1.0, 700.0, 0.03),
    "wood": Stuff(330.0, ((1.0, 0.07, 1.0), (2.76, 0.04, 0.5), (5.40, 0.02, 0.25)), 1.02, 0.5, 2600.0, 0.006),
    "stone": Stuff(280.0, ((1.0, 0.045, 1.0), (2.76, 0.025, 0.6), (5.40, 0.012, 0.3)), 1.05, 0.9, 3200.0, 0.009),
    "glass": Stuff(520.0, ((1.0, 0.09, 1.0), (2.76, 0.06, 0.6), (5.40, 0.03, 0.4)), 1.0, 0.3, 8000.0, 0.002),
    "metal": Stuff(
        440.0, ((1.0, 0.22, 1.0), (2.76, 0.15, 0.55), (5.40, 0.09, 0.35), (8.93, 0.05, 0.2)), 1.0, 0.25, 7000.0, 0.003
    ),
}


def pitch_of(step: int) -> float:
    """Frequency [Hz] of a step of the scale."""
    return float(LOWEST * 2.0 ** ((12 * (step // len(SCALE)) + SCALE[step % len(SCALE)]) / 12.0))


def step_of(frequency: float) -> int:
    """The step of the scale that is nearest to a frequency [Hz]."""
    pitches = np.array([pitch_of(step) for step in range(STEPS)])
    return int(np.argmin(np.abs(np.log(pitches / max(frequency, 1e-9)))))


def seconds(length: float) -> Wave:
    """Times [s] of the samples of a wave of that length [s]."""
    return np.arange(int(length * RATE)) / RATE


def noise(count: int, low: float, high: float, seed: int) -> Wave:
    """Noise between two frequencies [Hz], the same each time; its peak is 1."""
    # A length that is transformed fast.
    length = 1 << (count - 1).bit_length()
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(length))
    frequency = np.fft.rfftfreq(length, 1.0 / RATE)
    shape = frequency**4 / (frequency**4 + low**4) / (1.0 + (frequency / high) ** 4)
    made = np.fft.irfft(spectrum * shape, length)[:count]
    return np.asarray(made / np.abs(made).max())


def turns(frequency: Wave) -> Wave:
    """Angle [rad] of a sine whose frequency [Hz] changes."""
    return np.asarray(2.0 * np.pi * np.cumsum(frequency) / RATE)


def finished(wave: Wave, attack: float) -> Wave:
    """A wave with its peak at 1, that rises in `attack` [s] and is cut where it is too quiet to be missed."""
    loud = np.flatnonzero(np.abs(wave) > QUIET * np.abs(wave).max())
    wave = wave[: min(len(wave), int(loud[-1]) + int(FADE * RATE))].copy()
    rise, fall = max(int(attack * RATE), 2), int(FADE * RATE)
    wave[:rise] *= 0.5 - 0.5 * np.cos(np.pi * np.arange(rise) / rise)
    wave[-fall:] *= 0.5 + 0.5 * np.cos(np.pi * np.arange(1, fall + 1) / fall)
    return np.asarray(wave / np.abs(wave).max())


def thud(step: int, stuff: str) -> Wave:
    """The sound of a struck thing, made of one of STUFFS."""
    made, pitch = STUFFS[stuff], pitch_of(step)
    longest = max(decay for _, decay, _ in made.modes)
    t = seconds(5.6 * longest + 0.05)
    bend = 1.0 + (made.glide - 1.0) * np.exp(-t / 0.03)
    wave = np.zeros_like(t)
    for ratio, decay, strength in made.modes:
        if pitch * ratio < 0.4 * RATE:
            part = slice(0, int((5.6 * decay + 0.05) * RATE))
            wave[part] += strength * np.exp(-t[part] / decay) * np.sin(turns(pitch * ratio * bend[part]))
    blow = t[: int(7.0 * made.blow * RATE)]
    wave[: len(blow)] += made.noise * noise(len(blow), 30.0, made.cut, step) * np.exp(-blow / made.blow)
    return finished(wave, 0.0012 if stuff in ("glass", "metal", "wood", "stone") else 0.003)


def pluck(step: int) -> Wave:
    """A string that is plucked, by the method of Karplus and Strong (1983)."""
    pitch = pitch_of(step)
    period = max(round(RATE / pitch), 2)
    # A string that is plucked by a soft finger: little above the first overtones.
    block = noise(period, 1.0, 9.0 * pitch, step)
    block -= np.linspace(block[0], block[-1], period)
    block -= block.mean()
    before, blocks = block[-1], []
    # Time [s] to a thousandth: high strings fall silent sooner.
    ring = min(1.6, 90.0 / pitch + 0.5)
    loss = 0.5 * 0.001 ** (1.0 / (pitch * ring))
    for _ in range(int(0.85 * ring * RATE / period)):
        blocks.append(block)
        delayed = np.concatenate([[before], block[:-1]])
        before, block = block[-1], loss * (block + delayed)
    wave = np.concatenate(blocks)
    return finished(wave - wave.mean(), 0.002)


def snap(step: int) -> Wave:
    """A break: three cracks close to each other, and a short tone that falls."""
    t, pitch = seconds(0.2), pitch_of(step)
    rng = np.random.default_rng(step)
    wave = 0.5 * np.exp(-t / 0.018) * np.sin(turns(pitch * (1.0 + 1.5 * np.exp(-t / 0.012))))
    hiss = noise(len(t), 700.0, min(5.0 * pitch + 2000.0, 9000.0), step)
    for at, strength in zip((0.0, *rng.uniform(0.008, 0.05, 2)), (1.0, 0.6, 0.35), strict=True):
        after = np.maximum(t - at, 0.0)
        wave += strength * hiss * np.where(t >= at, np.exp(-after / 0.009) * np.minimum(after / 0.0006, 1.0), 0.0)
    return finished(wave, 0.0008)


def splash(step: int) -> Wave:
    """A splash into water: a hiss that swells and dies down, and bubbles that ring ever higher."""
    t, pitch = seconds(0.5), pitch_of(step)
    rng = np.random.default_rng(step)
    rise = np.minimum(t / 0.02, 1.0)
    wave = noise(len(t), 1.5 * pitch, 12.0 * pitch + 1500.0, step) * rise * np.exp(-t / 0.09)
    for at in rng.uniform(0.03, 0.22, 5):
        after = np.maximum(t - at, 0.0)
        own = pitch * rng.uniform(1.5, 4.0)
        wave += 0.22 * np.exp(-after / 0.03) * np.sin(turns(own * (1.0 + 3.0 * after))) * (t >= at)
    return finished(wave, 0.004)


def squeak(step: int) -> Wave:
    """A squeak of rubbing: a reedy tone that slides upward and trembles."""
    t, pitch = seconds(0.2), pitch_of(step)
    slide = pitch * (1.0 + 0.22 * np.sin(np.pi * t / 0.2) + 0.02 * np.sin(2.0 * np.pi * 38.0 * t))
    angle = turns(slide)
    wave = np.zeros_like(t)
    for number, strength in enumerate((1.0, 0.45, 0.3, 0.12, 0.08), 1):
        wave += strength * np.sin(number * angle)
    wave += 0.1 * noise(len(t), pitch, 6.0 * pitch, step)
    return finished(wave * np.sin(np.pi * t / 0.2) ** 1.5, 0.004)


def motor(step: int) -> Wave:
    """A motor that runs, for ever: its end goes on into its beginning."""
    pitch = pitch_of(step) / 2.0
    turns = max(round(0.5 * pitch), 1)
    count = round(turns * RATE / pitch)
    angle = 2.0 * np.pi * turns * np.arange(count) / count
    wave = np.zeros(count)
    for number in range(1, 13):
        wave += np.sin(number * angle + 0.7 * number * number) / number**1.3
    # Gears: a flutter that is whole in the loop as well.
    beats = max(round(0.5 * 11.0), 1)
    wave *= 1.0 + 0.18 * np.sin(2.0 * np.pi * beats * np.arange(count) / count)
    return np.asarray(wave / np.abs(wave).max())


# Partials of a small bell: frequency over the strike note, time [s] to fall to 1/e, strength.
_BELL = ((0.5, 0.9, 0.35), (1.0, 0.7, 1.0), (1.2, 0.55, 0.5), (2.0, 0.4, 0.55), (2.74, 0.25, 0.3), (3.76, 0.15, 0.2))
# Steps of the scale that are played one after the other, and from one to the next [s].
_RISE, _FALL, _BEAT, _SLOW_BEAT = (15, 17, 18, 20), (13, 12, 10), 0.11, 0.2
# The step of the first star's ping; each further star is as many steps higher.
STAR_STEP, STAR_RISE = 18, 2


def _note(pitch: float, decay: float, length: float, partials: tuple[float, ...] = (1.0, 0.3, 0.12)) -> Wave:
    """A plain tone that fades: sines of whole multiples of a pitch [Hz]."""
    t = seconds(length)
    wave = np.zeros_like(t)
    for number, strength in enumerate(partials, 1):
        wave += strength * np.exp(-t * number / decay) * np.sin(2.0 * np.pi * number * pitch * t)
    rise = max(int(0.003 * len(t) / length), 2)
    wave[:rise] *= np.linspace(0.0, 1.0, rise)
    return wave


def _tune(steps: tuple[int, ...], beat: float, decay: float) -> Wave:
    """Tones of steps of the scale, one after the other; the last one rings on."""
    every = int(len(seconds(1.0)) * beat)
    wave = np.zeros(every * (len(steps) - 1) + len(seconds(4.0 * decay)))
    for number, step in enumerate(steps):
        tone = _note(pitch_of(step), decay, 4.0 * decay)
        part = wave[number * every : number * every + len(tone)]
        part += tone[: len(part)]
    return wave


def bell() -> Wave:
    """A bell that is struck once."""
    t, strike = seconds(2.0), pitch_of(18)
    wave = np.zeros_like(t)
    for ratio, decay, strength in _BELL:
        wave += strength * np.exp(-t / decay) * np.sin(2.0 * np.pi * strike * ratio * t)
    return finished(wave, 0.002)


def coin() -> Wave:
    """Two short high tones, of which the second rings."""
    low, high = _note(pitch_of(22), 0.08, 0.5), _note(pitch_of(24), 0.2, 0.9)
    wave = np.zeros(len(high) + len(seconds(0.07)))
    wave[: len(low)] += 0.8 * low
    wave[-len(high) :] += high
    return finished(wave, 0.002)


def drum() -> Wave:
    """A drum that is struck once: a tone that falls, and the slap of the skin."""
    t = seconds(0.6)
    wave = np.exp(-t / 0.16) * np.sin(turns(62.0 + 90.0 * np.exp(-t / 0.035)))
    slap = seconds(0.1)
    wave[: len(slap)] += 0.5 * noise(len(slap), 60.0, 1800.0, 7) * np.exp(-slap / 0.018)
    return finished(wave, 0.002)


def buzzer() -> Wave:
    """A reed that says no."""
    t = seconds(0.45)
    wave = np.zeros_like(t)
    for number in range(1, 12, 2):
        wave += np.sin(2.0 * np.pi * number * 110.0 * t) / number
        wave += np.sin(2.0 * np.pi * number * 116.5 * t) / number
    return finished(wave * np.minimum(1.0, (0.45 - t) / 0.08), 0.006)


def won() -> Wave:
    """A run that is won: a chord that climbs."""
    return finished(_tune(_RISE, _BEAT, 0.4), 0.003)


def lost() -> Wave:
    """A run that is lost: three tones down."""
    return finished(_tune(_FALL, _SLOW_BEAT, 0.3), 0.004)


def star(step: int) -> Wave:
    """The sound of a star that is shown."""
    return finished(_note(pitch_of(step), 0.25, 1.0, (1.0, 0.15, 0.3)), 0.002)


# From one number of `Sample.left` to the next [s].
GRAIN = 0.01
LARGEST = 32_767


class Note(NamedTuple):
    """One of the sounds there are: its kind, the step of the scale, and for a thud the stuff that is struck."""

    kind: str
    step: int
    stuff: str = ""


MAKERS: dict[str, Callable[[Note], Wave]] = {
    "thud": lambda note: thud(note.step, note.stuff),
    "splash": lambda note: splash(note.step),
    "pluck": lambda note: pluck(note.step),
    "snap": lambda note: snap(note.step),
    "squeak": lambda note: squeak(note.step),
    "motor": lambda note: motor(note.step),
    "bell": lambda _: bell(),
    "coin": lambda _: coin(),
    "drum": lambda _: drum(),
    "buzzer": lambda _: buzzer(),
    "won": lambda _: won(),
    "lost": lambda _: lost(),
    "star": lambda note: star(note.step),
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
    """Keeps samples by their notes."""

    def __getitem__(self, note: Note) -> Sample:
        return _sample(note)

    def make(self, note: Note) -> None:
        """Make a sample before it is played."""
        self[note]


def note(kind: str, pitch: float, stuff: str = "") -> Note:
    """The note of a kind that is nearest to a pitch [Hz]."""
    return Note(kind, min(max(step_of(pitch), 0), STEPS - 1), stuff)


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
