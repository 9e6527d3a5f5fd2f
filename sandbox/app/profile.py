"""Profile: where the time of a frame goes, for `sandbox play --profile`."""

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from statistics import mean

PARTS = ("events", "commands", "ticks", "springs", "particles", "ui", "flip", "frame")


class Profile:
    """Collects the wall time of each part of each frame."""

    def __init__(self) -> None:
        self.milliseconds: dict[str, list[float]] = defaultdict(list)

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Time what happens inside as a part of the frame."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.milliseconds[name].append(1e3 * (time.perf_counter() - start))

    def table(self, seconds: float) -> str:
        """Mean, 95th percentile and worst [ms] of every part, and the frames per second over so many seconds."""
        frames = len(self.milliseconds["frame"])
        lines = [f"{'part':<12}{'mean':>8}{'p95':>8}{'worst':>8}   ms"]
        for name in PARTS:
            times = sorted(self.milliseconds[name])
            if times:
                p95 = times[min(len(times) - 1, int(0.95 * len(times)))]
                lines.append(f"{name:<12}{mean(times):8.2f}{p95:8.2f}{times[-1]:8.2f}")
        lines.append(f"{frames} frames in {seconds:.1f} s: {frames / max(seconds, 1e-9):.1f} frames a second")
        return "\n".join(lines)
