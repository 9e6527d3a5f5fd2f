"""TickClock: turns the time that frames take into whole ticks, and the rest into the part between two ticks."""

from dataclasses import dataclass

# Frames that the loop draws at most [1/s].
FRAME_RATE = 60
# Longest frame [s] that is made up for; a longer one (a stopped window, a slow computer) is time that is lost.
LONGEST_FRAME = 0.1
# Speeds that a person can choose, real time first.
SPEEDS = (1.0, 0.5, 0.25, 0.125)


@dataclass
class TickClock:
    """Accumulates frame time; paused, it accumulates nothing but `step_once` still gives single ticks."""

    accumulator: float = 0.0
    speed: float = 1.0
    paused: bool = False
    single_steps: int = 0

    def ticks(self, frame_time: float, tick_rate: float) -> int:
        """How many ticks are due after a frame of frame_time [s]."""
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

    def step_once(self) -> None:
        """Pause, and ask for one tick."""
        self.paused = True
        self.single_steps += 1
