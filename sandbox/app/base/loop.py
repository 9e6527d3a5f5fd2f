"""TickClock: turns the time that frames take into whole ticks, and the rest into the part between two ticks."""

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
