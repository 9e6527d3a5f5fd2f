"""IdleCollector: Python's search for garbage, which takes several frames of large levels, while nobody waits."""

import gc

# It begins when nothing has happened for so long [s]: in the pauses of somebody who works, and not while they drag.
REST = 0.5
# New objects that are worth a search of them: a frame of a run makes less than a tenth.
ENOUGH = 10_000
# Of this many searches one looks at all objects: it takes 0.1 s and more where the history of a large level is long.
FULL_EVERY = 10


class IdleCollector:
    """Takes over from Python's own searches, which come in the midst of edits, until it is closed."""

    def __init__(self) -> None:
        self._was_enabled = gc.isenabled()
        self._rest = 0.0
        self._searches = 0
        self._full_is_due = False
        gc.disable()

    def update(self, frame_time: float, is_busy: bool) -> None:
        """Let frame_time [s] pass, in which something has happened or not."""
        self._rest = 0.0 if is_busy else self._rest + frame_time
        if self._rest < REST or not (self._full_is_due or gc.get_count()[0] >= ENOUGH):
            return
        self._searches += 1
        gc.collect(2 if self._full_is_due or self._searches % FULL_EVERY == 0 else 1)
        self._full_is_due = False

    def expect_old_garbage(self) -> None:
        """Look at all objects in the next pause: widgets hold each other, and those of a window 20 MB of pictures."""
        self._full_is_due = True

    def close(self) -> None:
        """Leave it to Python again."""
        if self._was_enabled:
            gc.enable()
