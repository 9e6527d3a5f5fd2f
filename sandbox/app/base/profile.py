"""Profile: where the time of a frame goes, for `sandbox play --profile`."""

import time
from collections import defaultdict, deque
from collections.abc import Iterator
from contextlib import contextmanager

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
        """Note what a whole frame took [s]."""
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
