"""BestKeeping: the best runs of levels are kept as they are won, and recorded in the frames that follow."""

from sandbox.app.base.slice_queue import SliceQueue
from sandbox.app.run.playback import Playback
from sandbox.editor.storage.best_runs import Result, keep_result, record_best

# Wall time [s] of a frame in which a run is recorded again.
BUDGET = 0.004


class BestKeeping:
    """Keeps best runs; what is still to be recorded goes on by slices."""

    def __init__(self) -> None:
        self._works = SliceQueue()

    @property
    def moves(self) -> bool:
        """Whether a run is still being recorded."""
        return len(self._works) > 0

    def note(self, playback: Playback, result: Result) -> bool:
        """Take in the result of a run that was won at its present tick; whether it is the best one of its level.

        Raises OSError where it cannot be kept.
        """
        if not keep_result(playback.level, result):
            return False
        if playback.session.history.keyframes.first.tick == 0:
            scene = playback.present_scene()
            self._works.add(record_best(playback.level, scene.script, scene.tick))
        return True

    def update(self) -> None:
        """Let a frame pass."""
        self._works.go_on(BUDGET)

    def close(self) -> None:
        """Record all that is still to be recorded."""
        while self.moves:
            self._works.go_on(1.0)
