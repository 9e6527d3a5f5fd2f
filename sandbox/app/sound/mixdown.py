"""Mixdown: an output that plays nothing; it writes down what a mixer would have mixed, sample by sample."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.app.sound.bank import Note, Sample
from sandbox.app.sound.voices import MOTOR_FADE
from sandbox.app.sound.waves import RATE

Floats = NDArray[np.float64]
# Of the left and the right ear.
Gains = tuple[float, float]


@dataclass
class _Channel:
    """A sample that plays: its wave, the gains of both ears, where it is, whether it goes round, and how it fades."""

    wave: Floats
    gains: Floats
    at: int
    loop: bool
    gain: float
    slope: float


class Mixdown:
    """An output of voices by a clock of one's own; now [s]. most: the most channels that were busy at once."""

    def __init__(self) -> None:
        self.now = 0.0
        self.most = 0
        self.played: list[tuple[float, Note, Gains]] = []
        self._playing: dict[int, _Channel] = {}
        self._blocks: list[Floats] = []

    def play(self, channel: int, note: Note, sample: Sample, gains: Gains, loop: bool) -> None:
        """Begin a sample on a channel that is free; one that goes round fades in."""
        assert not self.is_busy(channel), "the channel is still in use"
        self.played.append((self.now, note, gains))
        self._playing[channel] = _Channel(
            sample.pcm / 32767.0,
            np.array(gains),
            0,
            loop,
            0.0 if loop else 1.0,
            1.0 / (MOTOR_FADE * RATE) if loop else 0.0,
        )
        self.most = max(self.most, len(self._playing))

    def set_gains(self, channel: int, gains: Gains) -> None:
        """Change how loud a channel is in both ears."""
        if channel in self._playing:
            self._playing[channel].gains = np.array(gains)

    def fade(self, channel: int, seconds: float) -> None:
        """Let a channel fall silent within a time [s]."""
        if channel in self._playing:
            self._playing[channel].slope = -1.0 / (seconds * RATE)

    def is_busy(self, channel: int) -> bool:
        """Whether a channel plays."""
        return channel in self._playing

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        count = round((self.now + seconds) * RATE) - round(self.now * RATE)
        self.now += seconds
        block = np.zeros((count, 2))
        for number, channel in list(self._playing.items()):
            places, size = channel.at + np.arange(count), len(channel.wave)
            channel.at += count
            around = channel.wave[places % size]
            wave = around if channel.loop else np.where(places < size, around, 0.0)
            gain = np.clip(channel.gain + channel.slope * np.arange(1, count + 1), 0.0, 1.0)
            block += (wave * gain)[:, None] * channel.gains
            channel.gain = float(gain[-1]) if count else channel.gain
            if channel.gain == 0.0 or (not channel.loop and channel.at >= size):
                del self._playing[number]
        self._blocks.append(block)

    @property
    def mixed(self) -> Floats:
        """All that was heard (n, 2), 1 = full scale."""
        return np.concatenate(self._blocks) if self._blocks else np.zeros((0, 2))
