"""Voices: which sounds play at once, how loud and from where; and a mixdown of them, for films, that plays nothing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sandbox.app.sound.waves import RATE, Bank, Note, Sample, level_of

# Sounds that play at once, at most; and this many of them motors.
VOICES, MOTORS = 12, 3
# Of the voices this many are kept free by letting the quietest fade [s]: a sound that is cut off clicks.
SPARE, CUT_FADE = 2, 0.03
# One thing makes no second sound of a kind within this time [s]; nor does any other the very same sound.
REST, SAME_REST = 0.09, 0.035
REST_OF = {"squeak": 0.6, "pluck": 0.25}
# New sounds of one frame, at most; and how much quieter each further one is.
NEW_PER_FRAME, FOLLOWING = 4, 0.8
# Quieter than this nothing is worth a voice.
SOFTEST_VOICE = 0.012
# The mixer may be behind by this [s]: what is still to come of a sound is counted from there.
LATENCY = 0.06
# Motors rise and fall within this many s, and change their note no sooner than this [s].
MOTOR_FADE, MOTOR_HOLD = 0.12, 0.15
# How far to a side what is at the edge of the view is heard.
WIDTH = 0.7


class Output(Protocol):
    """What plays samples on numbered channels; gains of the left and the right ear are 0..1."""

    def play(self, channel: int, note: Note, sample: Sample, gains: tuple[float, float], loop: bool) -> None:
        """Begin a sample; loop: for ever, rising within MOTOR_FADE."""
        ...

    def set_gains(self, channel: int, gains: tuple[float, float]) -> None:
        """Change how loud a channel is."""
        ...

    def fade(self, channel: int, seconds: float) -> None:
        """Fade a channel out within so many seconds."""
        ...

    def is_busy(self, channel: int) -> bool:
        """Whether a channel still sounds."""
        ...


@dataclass(frozen=True)
class Cue:
    """A sound that is wanted: loudness 0..1, pan -1..1 (left to right), source: whose it is."""

    note: Note
    loudness: float
    pan: float
    source: int


@dataclass(eq=False)
class _Voice:
    channel: int
    sample: Sample
    gain: float
    began: float
    note: Note

    def level(self, now: float) -> float:
        """The largest value that is still to come of it."""
        return self.gain * self.sample.left_after(now - self.began - LATENCY)


@dataclass(eq=False)
class _Hum:
    channel: int
    note: Note
    gain: float
    pan: float
    began: float


def ears(gain: float, pan: float) -> tuple[float, float]:
    """Gains of the left and the right ear, neither above gain."""
    return gain * min(1.0, 1.0 - WIDTH * pan), gain * min(1.0, 1.0 + WIDTH * pan)


class Voices:
    """Gives sounds to the channels of an output; volume 0..1."""

    def __init__(self, output: Output, bank: Bank) -> None:
        self._output, self._bank = output, bank
        self.volume = 1.0
        self._voices: list[_Voice] = []
        self._hums: dict[int, _Hum] = {}
        self._fading: dict[int, float] = {}
        # When each source last made a sound of each kind, and each note was last heard.
        self._last: dict[tuple[int, str] | Note, float] = {}

    # One frame.

    def play(self, cues: Sequence[Cue], now: float) -> int:
        """Begin what is wanted in a frame, the loudest first; now [s]. How many sounds began."""
        self._sweep(now)
        began, volume = 0, self.volume
        for each in sorted(cues, key=lambda one: -one.loudness * level_of(one.note.kind)):
            if began == NEW_PER_FRAME:
                break
            if self._is_too_soon(each, now):
                continue
            gain = min(volume * each.loudness * level_of(each.note.kind), self._headroom(now))
            if gain < SOFTEST_VOICE:
                continue
            channel = self._free_channel(now)
            if channel is None:
                break
            sample = self._bank[each.note]
            self._output.play(channel, each.note, sample, ears(gain, each.pan), loop=False)
            self._voices.append(_Voice(channel, sample, gain, now, each.note))
            self._last[each.source, each.note.kind] = self._last[each.note] = now
            began += 1
            volume *= FOLLOWING
        self._make_room(now)
        return began

    def hum(self, cues: Sequence[Cue], now: float) -> None:
        """Run the hum of these motors, the loudest first, and of no others."""
        loudest = {each.source: each for each in sorted(cues, key=lambda one: -one.loudness)[:MOTORS]}
        for source in [source for source in self._hums if source not in loudest]:
            self._let_go(self._hums.pop(source), now)
        for source, each in loudest.items():
            hum = self._hums.get(source)
            if hum is not None and hum.note != each.note and now - hum.began > MOTOR_HOLD:
                self._let_go(self._hums.pop(source), now)
                hum = None
            goal = self.volume * each.loudness * level_of("motor")
            if hum is None:
                channel = self._free_channel(now)
                gain = min(goal, self._headroom(now))
                if channel is not None and gain >= SOFTEST_VOICE:
                    self._output.play(channel, each.note, self._bank[each.note], ears(gain, each.pan), loop=True)
                    self._hums[source] = _Hum(channel, each.note, gain, each.pan, now)
            elif abs(goal - hum.gain) > 0.002 or abs(each.pan - hum.pan) > 0.02:
                # In small steps, which are not heard as such.
                hum.gain += max(min(goal - hum.gain, 0.02, max(self._headroom(now), 0.0)), -0.02)
                hum.pan += max(min(each.pan - hum.pan, 0.1), -0.1)
                self._output.set_gains(hum.channel, ears(hum.gain, hum.pan))

    def quieten(self, now: float, seconds: float = 0.12) -> None:
        """Fade all sounds out within so many seconds."""
        for channel in [*(voice.channel for voice in self._voices), *(hum.channel for hum in self._hums.values())]:
            self._output.fade(channel, seconds)
            self._fading[channel] = now + seconds + LATENCY
        self._voices.clear()
        self._hums.clear()

    @property
    def count(self) -> int:
        """Channels in use."""
        return len(self._voices) + len(self._hums) + len(self._fading)

    def total(self, now: float) -> float:
        """The largest value that all voices together can still reach; never above 1."""
        return sum(voice.level(now) for voice in self._voices) + sum(hum.gain for hum in self._hums.values())

    # Room.

    def _headroom(self, now: float) -> float:
        return 1.0 - self.total(now)

    def _is_too_soon(self, each: Cue, now: float) -> bool:
        mine = now - self._last.get((each.source, each.note.kind), -1e9)
        same = now - self._last.get(each.note, -1e9)
        return mine < REST_OF.get(each.note.kind, REST) or same < SAME_REST

    def _sweep(self, now: float) -> None:
        """Forget sounds that have ended."""
        self._voices = [voice for voice in self._voices if self._output.is_busy(voice.channel)]
        self._fading = {channel: until for channel, until in self._fading.items() if now < until}
        if len(self._last) > 500:
            self._last = {key: at for key, at in self._last.items() if now - at < 1.0}

    def _used(self) -> set[int]:
        hums = {hum.channel for hum in self._hums.values()}
        return {voice.channel for voice in self._voices} | hums | set(self._fading)

    def _free_channel(self, now: float) -> int | None:
        used = self._used()
        free = [channel for channel in range(VOICES) if channel not in used and not self._output.is_busy(channel)]
        return free[0] if free else None

    def _make_room(self, now: float) -> None:
        """Fade the quietest voices until some are free for what comes next."""
        while self._voices and len(self._used()) > VOICES - SPARE and not len(self._fading) >= SPARE:
            quietest = min(self._voices, key=lambda voice: voice.level(now))
            self._voices.remove(quietest)
            self._output.fade(quietest.channel, CUT_FADE)
            self._fading[quietest.channel] = now + CUT_FADE + LATENCY

    def _let_go(self, hum: _Hum, now: float) -> None:
        self._output.fade(hum.channel, MOTOR_FADE)
        self._fading[hum.channel] = now + MOTOR_FADE + LATENCY


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
        """Fade a channel out within a time [s]."""
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
