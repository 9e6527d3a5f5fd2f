"""Keeping: runs of the window are kept while they are played and as they were left, and the best run of each level."""

from collections.abc import Callable, Iterator
from pathlib import Path

from sandbox.app.base.loop import SliceQueue
from sandbox.app.run.playback import Playback
from sandbox.editor.storage.best_runs import Result, keep_result, record_best
from sandbox.editor.storage.scene_shelf import SceneShelf
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.slices import goes_on, telling
from sandbox.session.commands import CommandError
from sandbox.session.replay.recording import Replay
from sandbox.session.scene import RunScene
from sandbox.session.solution import keep_solution

# A run that goes on is kept so often [s]; after something was done in it, so soon.
EVERY, SOON = 2.0, 0.5


class SceneKeeping:
    """Keeps runs on the shelf; `before` is the one that left the screen last."""

    def __init__(self) -> None:
        self.shelf = SceneShelf()
        self.before: RunScene | None = None
        self._reported_fault: str | None = None
        self._saved: RunScene | None = None
        self._kept: tuple[Playback | None, int, int] = (None, 0, 0)
        self._seconds = 0.0

    def begin(self, playback: Playback, source: Path | None) -> RunScene | None:
        """Keep what is cut off from the history of a run too; how the run of the same level stood that was there."""
        playback.cut = lambda scene: self._set_aside(scene, source)
        return self.of_level(playback.level)

    def of_level(self, level: Level) -> RunScene | None:
        """How the run stood that left the screen last, if it was of this level."""
        return self.before if self.before is not None and self.before.level == level else None

    def follow(self, playback: Playback, source: Path | None, frame_time: float) -> None:
        """Keep the present run now and then; frame_time [s] since the last call."""
        present = playback, playback.revision, playback.session.tick
        self._seconds += frame_time
        soon = SOON if present[:2] != self._kept[:2] else EVERY
        if self._seconds < soon or present == self._kept:
            return
        self._seconds, self._kept = 0.0, present
        scene = playback.scene()
        if scene is not None and not self._is_saved(scene):
            self.shelf.note(scene, source)

    def set_aside(self, playback: Playback, source: Path | None) -> RunScene | None:
        """Keep how a run stands that leaves the screen; None: nothing was done in it."""
        scene = playback.scene()
        if scene is not None:
            self._set_aside(scene, source)
            self.before = scene
        return scene

    def is_saved(self, scene: RunScene | None) -> None:
        """Keep the present run no more while it is as the person saved it; None: it is not saved after all."""
        self._saved, self._kept = scene, (None, 0, 0)
        if scene is not None:
            self.shelf.give_up(scene)

    def _is_saved(self, scene: RunScene) -> bool:
        saved = self._saved
        return saved is not None and saved.is_done_by(scene.script) and saved.level == scene.level

    def _set_aside(self, scene: RunScene, source: Path | None) -> None:
        if not self._is_saved(scene):
            self.shelf.set_aside(scene, source)

    def fault(self) -> str | None:
        """A line, once, where runs cannot be kept."""
        fault, reported = self.shelf.fault, self._reported_fault
        self._reported_fault = fault
        return fault if fault != reported else None


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

    def keep_solution(self, path: Path, run: Replay, say: Callable[[str], None]) -> None:
        """Record a run as the solution of a level's file, and say so."""
        self._works.add(_kept(path, run, say))

    def update(self) -> None:
        """Go on with recording best runs for a part of a frame."""
        self._works.go_on(BUDGET)

    def close(self) -> None:
        """Record all that is still to be recorded."""
        while self.moves:
            self._works.go_on(1.0)


def _kept(path: Path, run: Replay, say: Callable[[str], None]) -> Iterator[bool]:
    """Record a run as a solution, a slice at a time."""
    try:
        verdict = yield from telling(keep_solution(path, run.script, run.ticks), goes_on)
        say(f"Kept as its solution: {verdict.text}." if verdict.passed else f"Not kept: {verdict.text}.")
    except (LevelError, CommandError) as error:
        say(f"Not kept: {error.faults[0]}.")
    except OSError as error:
        say(f"The solution cannot be kept: {error.strerror or error}.")
