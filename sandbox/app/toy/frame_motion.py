"""FrameMotion: from where a window is, frame by frame, how the frame that holds its world accelerates, tick by tick."""

import math

# Time [s] within which the frame follows its window: a mouse jumps, what is held by a box must not.
FOLLOWS = 0.05
# The frame is no faster [m/s], accelerates no harder [m/s^2], and is never farther behind [m].
FASTEST, HARDEST, FARTHEST = 14.0, 400.0, 1.2
# Slower [m/s] and nearer [m] than this it stands.
STANDS, IS_THERE = 0.02, 0.002

Vector = tuple[float, float]


class FrameMotion:
    """A frame that follows its window; velocity [m/s], behind [m]: how far it has to go still."""

    def __init__(self) -> None:
        self.velocity: Vector = (0.0, 0.0)
        self.behind: Vector = (0.0, 0.0)
        self._place: tuple[int, int] | None = None

    @property
    def rests(self) -> bool:
        """Whether the frame stands where its window is."""
        return self.velocity == (0.0, 0.0) and self.behind == (0.0, 0.0)

    def see(self, place: tuple[int, int], zoom: float) -> bool:
        """Take in where the window is now [pixels], a metre being `zoom` pixels; whether it has moved."""
        before, self._place = self._place or place, place
        dx, dy = (place[0] - before[0]) / zoom, (before[1] - place[1]) / zoom
        x, y = self.behind[0] + dx, self.behind[1] + dy
        far = math.hypot(x, y)
        share = 1.0 if far <= FARTHEST else FARTHEST / far
        self.behind = (x * share, y * share)
        return place != before

    def forget(self, place: tuple[int, int]) -> None:
        """The window is there, without having been moved: nobody felt it."""
        self._place = place

    def nudge(self, dx: float, dy: float) -> None:
        """Move the frame by (dx, dy) [m] as if its window had moved."""
        self.behind = (self.behind[0] + dx, self.behind[1] + dy)

    def accelerate(self, tick_rate: float) -> Vector:
        """The acceleration [m/s^2] of the coming tick of 1 / tick_rate s.

        The frame goes where its window is, as fast as v = behind / FOLLOWS, but for the limits. Whatever it does, it
        comes to rest again, so that all accelerations together are none.
        """
        h = 1.0 / tick_rate
        (x, y), (vx, vy) = self.behind, self.velocity
        wanted_x, wanted_y = x / FOLLOWS, y / FOLLOWS
        if math.hypot(x, y) < IS_THERE and math.hypot(vx, vy) < STANDS:
            wanted_x = wanted_y = 0.0
        speed = math.hypot(wanted_x, wanted_y)
        if speed > FASTEST:
            wanted_x, wanted_y = wanted_x * FASTEST / speed, wanted_y * FASTEST / speed
        ax, ay = (wanted_x - vx) / h, (wanted_y - vy) / h
        strength = math.hypot(ax, ay)
        if strength > HARDEST:
            ax, ay = ax * HARDEST / strength, ay * HARDEST / strength
            vx, vy = vx + ax * h, vy + ay * h
        else:
            vx, vy = wanted_x, wanted_y
        self.velocity = (vx, vy)
        self.behind = (0.0, 0.0) if (vx, vy) == (0.0, 0.0) else (x - vx * h, y - vy * h)
        return ax, ay
