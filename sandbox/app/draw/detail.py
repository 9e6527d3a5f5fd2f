"""Detail: how much is drawn: less while frames are late, and more again when they are in time."""

# Frames that take longer than this [s] are late: 50 of them in a second.
LATE = 0.020
# Of this many frames in a row, this many must be late before less is drawn.
FRAMES, MOST_LATE = 30, 15
# After this many frames in time more is tried; where that is late at once, only after twice as many, up to the last.
TRY_AFTER, TRY_AT_LAST = 240, 3840
# What is left out, in this order.
FULL, NO_SHADOWS, NO_EFFECTS = range(3)


class Detail:
    """The level of detail of a screen: FULL, then without shadows, then without dust and sparks as well."""

    def __init__(self) -> None:
        self.level = FULL
        self._frames = self._late = self._in_time = 0
        self._wait = TRY_AFTER
        self._is_trial = False

    def note(self, frame_time: float) -> None:
        """Take into account that a frame came so long [s] after the one before."""
        is_late = frame_time > LATE
        self._frames += 1
        self._late += is_late
        self._in_time = 0 if is_late else self._in_time + 1
        if self._frames >= FRAMES:
            if self._late >= MOST_LATE:
                self._draw_less()
            elif self._is_trial and self.level == FULL:
                self._wait, self._is_trial = TRY_AFTER, False
            self._frames = self._late = 0
        if self.level > FULL and self._in_time >= self._wait:
            self.level -= 1
            self._is_trial = True
            self._frames = self._late = self._in_time = 0

    def _draw_less(self) -> None:
        if self._is_trial:
            self._wait, self._is_trial = min(2 * self._wait, TRY_AT_LAST), False
        self.level = min(self.level + 1, NO_EFFECTS)
        self._in_time = 0
