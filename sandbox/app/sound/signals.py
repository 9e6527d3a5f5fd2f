"""Signals: sounds that a level's rules ask for, and those of a run that is won or lost."""

import numpy as np

from sandbox.app.sound.waves import Wave, finished, noise, pitch_of, seconds, turns

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
    """A star that is shown."""
    return finished(_note(pitch_of(step), 0.25, 1.0, (1.0, 0.15, 0.3)), 0.002)
