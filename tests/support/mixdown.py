"""An output that plays nothing: it writes down what a mixer would have mixed, sample by sample."""

import numpy as np

from sandbox.app.sound.voices import MOTOR_FADE
from sandbox.app.sound.waves import RATE


class Mixdown:
    """An output of voices by a clock of one's own; now [s]. most: the most channels that were busy at once."""

    def __init__(self):
        self.now = 0.0
        self.most = 0
        self.played = []
        self._playing = {}
        self._mixed = np.zeros((0, 2))

    def play(self, channel, note, sample, gains, loop):
        assert not self.is_busy(channel), "the channel is still in use"
        self.played.append((self.now, note, gains))
        self._playing[channel] = {
            "pcm": sample.pcm / 32767.0, "gains": np.array(gains), "at": 0, "loop": loop, "gain": 0.0 if loop else 1.0,
            "slope": 1.0 / (MOTOR_FADE * RATE) if loop else 0.0,
        }  # fmt: skip
        self.most = max(self.most, len(self._playing))

    def set_gains(self, channel, gains):
        if channel in self._playing:
            self._playing[channel]["gains"] = np.array(gains)

    def fade(self, channel, seconds):
        if channel in self._playing:
            self._playing[channel]["slope"] = -1.0 / (seconds * RATE)

    def is_busy(self, channel):
        return channel in self._playing

    def advance(self, seconds):
        """Let time pass."""
        count = round((self.now + seconds) * RATE) - round(self.now * RATE)
        self.now += seconds
        block = np.zeros((count, 2))
        for channel, voice in list(self._playing.items()):
            places = voice["at"] + np.arange(count)
            pcm, voice["at"] = voice["pcm"], voice["at"] + count
            wave = pcm[places % len(pcm)] if voice["loop"] else np.append(pcm, 0.0)[np.minimum(places, len(pcm))]
            gain = np.clip(voice["gain"] + voice["slope"] * np.arange(1, count + 1), 0.0, 1.0)
            block += (wave * gain)[:, None] * voice["gains"]
            voice["gain"] = float(gain[-1])
            if gain[-1] == 0.0 or (not voice["loop"] and voice["at"] >= len(pcm)):
                del self._playing[channel]
        self._mixed = np.concatenate([self._mixed, block])

    @property
    def mixed(self):
        """All that was heard (n, 2), 1 = full scale."""
        return self._mixed
