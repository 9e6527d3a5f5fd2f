"""EarlierRuns: undo and redo beyond the beginning of a run: back to how the run stood that was there before it."""

from collections.abc import Callable
from dataclasses import replace

from sandbox.app.run.playback import Playback
from sandbox.session.scene import RunScene

BEGUN_AGAIN = "Back to the beginning. Ctrl+Z brings back what was there."
BROUGHT_BACK = "The run before is back, as it stood. Ctrl+Y goes on to the other one."


class EarlierRuns:
    """The runs of a level around the present one; before: how the one stood that was there last.

    show: shows another run in place of the present one. say: shows a line.
    """

    def __init__(
        self, before: RunScene | None, show: Callable[[Playback], object], say: Callable[[str], object]
    ) -> None:
        self.before, self._show, self._say = before, show, say
        # The run that was left by going back, and the revision of the one gone back to.
        self._after: tuple[Playback, int] | None = None

    def begin_again(self, playback: Playback, left: RunScene | None) -> None:
        """Another run takes the place of one that was left as it stood, None where nothing was done in it."""
        self._after = None
        if left is not None:
            self.before = left
            self._say(BEGUN_AGAIN)

    def can_undo(self, playback: Playback) -> bool:
        """Whether something was done in the run, or another was there before it."""
        return playback.session.can_undo or self.before is not None

    def can_redo(self, playback: Playback) -> bool:
        """Whether something was undone in the run, or another was left by going back to it."""
        return playback.session.can_redo or (self._after is not None and self._after[1] == playback.revision)

    def undo(self, playback: Playback) -> None:
        """Take the last gesture back, or bring back the run that was there before."""
        playback.apply_pending()
        before = self.before
        if playback.session.can_undo or before is None:
            playback.submit_undo()
            return
        earlier = Playback(before.level, first=before)
        earlier.clock = replace(playback.clock, speed=abs(playback.clock.speed), accumulator=0.0, single_steps=0)
        self.before, self._after = None, (playback, earlier.revision)
        self._show(earlier)
        self._say(BROUGHT_BACK)

    def redo(self, playback: Playback) -> None:
        """Make the gesture again that was undone last, or go on to the run that was left by going back."""
        playback.apply_pending()
        if playback.session.can_redo or not self.can_redo(playback) or self._after is None:
            playback.submit_redo()
            return
        after = self._after[0]
        self.before, self._after = playback.scene() or playback.first, None
        self._show(after)
