"""What frames do with their time: whole ticks, slices of long work, and how long each part takes."""

import time
from collections import defaultdict, deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

# Frames that the loop draws at most [1/s].
FRAME_RATE = 60
# Longest frame [s] that is made up for; a longer one (a stopped window, a slow computer) is time that is lost.
LONGEST_FRAME = 0.1
# Speeds that a person can choose, real time first: slow motion, fast, and back in time.
SPEEDS = (1.0, 0.5, 0.25, 0.125)
FAST_SPEEDS = (1.0, 2.0, 4.0, 8.0)
BACKWARD_SPEEDS = (1.0, -1.0, -2.0, -4.0)


@dataclass
class TickClock:
    """Accumulates frame time; paused, it accumulates nothing but `step_once` still gives single ticks."""

    accumulator: float = 0.0
    speed: float = 1.0
    paused: bool = False
    single_steps: int = 0

    def ticks(self, frame_time: float, tick_rate: float) -> int:
        """How many ticks are due after a frame of frame_time [s]; back in time, less than none."""
        if self.paused:
            steps, self.single_steps = self.single_steps, 0
            self.accumulator = 0.0
            return steps
        self.accumulator += min(max(frame_time, 0.0), LONGEST_FRAME) * self.speed
        due = int(self.accumulator * tick_rate)
        self.accumulator -= due / tick_rate
        return due

    def alpha(self, tick_rate: float) -> float:
        """How far the present lies between the last two ticks, 0..1; paused, the last tick itself is shown."""
        return 1.0 if self.paused else min(max(self.accumulator * tick_rate, 0.0), 1.0)

    def next_speed(self, speeds: tuple[float, ...]) -> None:
        """Go on at the next of these speeds, round and round; from another speed, at the second."""
        place = speeds.index(self.speed) if self.speed in speeds else 0
        self.speed, self.accumulator = speeds[(place + 1) % len(speeds)], 0.0
        self.paused = False

    def step_once(self) -> None:
        """Pause, and ask for one tick."""
        self.paused = True
        self.single_steps += 1


class SliceQueue:
    """Work that goes on by slices; each work is an iterator that gives False where it has to wait."""

    def __init__(self) -> None:
        self._works: deque[Iterator[bool]] = deque()

    def __len__(self) -> int:
        return len(self._works)

    def add(self, work: Iterator[bool]) -> None:
        """Add a generator of work, behind the others."""
        self._works.append(work)

    def go_on(self, budget: float) -> None:
        """Work for about `budget` [s], or until every generator waits."""
        end, waiting = time.perf_counter() + budget, 0
        while waiting < len(self._works):
            went_on = next(self._works[0], None)
            if went_on is None:
                self._works.popleft()
            elif not went_on:
                self._works.rotate(-1)
                waiting += 1
            if time.perf_counter() > end:
                return


PARTS = ("events", "commands", "ticks", "stage", "things", "marks", "sound", "ui", "flip", "frame")
# This many times of each part are remembered: a minute, so that an app that is left open does not grow.
REMEMBERED = 3_600


class Profile:
    """Collects the wall time of each part of the last frames, and when things came about for the first time.

    frames: how many there have been.
    """

    def __init__(self) -> None:
        self.milliseconds: dict[str, deque[float]] = defaultdict(lambda: deque(maxlen=REMEMBERED))
        self.frames = 0
        # From one picture in the window to the next, what a person sees stand still: wall time [s], and how much of it
        # this thread itself was busy, which other programs do not lengthen.
        self.longest_stop = (0.0, 0.0)
        self.first_times: dict[str, float] = {}
        self._shown: tuple[float, float] | None = None

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Time what happens inside as a part of the frame."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.milliseconds[name].append(1e3 * (time.perf_counter() - start))

    def end_frame(self, seconds: float) -> None:
        """Note how long a whole frame took [s]."""
        self.milliseconds["frame"].append(1e3 * seconds)
        self.frames += 1

    def shown(self) -> None:
        """Note that the window shows a new picture now."""
        now = time.perf_counter(), time.thread_time()
        if self._shown is not None:
            self.longest_stop = max(self.longest_stop, (now[0] - self._shown[0], now[1] - self._shown[1]))
        self._shown = now

    def rested(self) -> None:
        """Note that nothing was to be shown until now."""
        self._shown = None

    def reached(self, what: str) -> None:
        """Note when something came about, the first time that it does."""
        self.first_times.setdefault(what, time.perf_counter())

    def table(self, began: float) -> str:
        """Mean, 95th percentile and worst [ms] of every part in the last minute; then what came when.

        began: when the program did [s of perf_counter].
        """
        seconds, frames = time.perf_counter() - began, self.frames
        lines = [f"{'part':<12}{'mean':>8}{'p95':>8}{'worst':>8}   ms"]
        for name in PARTS:
            times = sorted(self.milliseconds[name])
            if times:
                p95 = times[min(len(times) - 1, int(0.95 * len(times)))]
                lines.append(f"{name:<12}{sum(times) / len(times):8.2f}{p95:8.2f}{times[-1]:8.2f}")
        lines.append(f"{frames} frames in {seconds:.1f} s: {frames / max(seconds, 1e-9):.1f} frames a second")
        wall, busy = self.longest_stop
        lines.append(f"longest time without a new picture: {wall:.3f} s, {busy:.3f} s of it at work")
        lines += [f"{what}: after {when - began:.2f} s" for what, when in self.first_times.items()]
        return "\n".join(lines)
