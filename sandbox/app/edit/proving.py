"""Proving: the solution beside the level that is edited, run again after each edit that a run can tell."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import ACCENT, DANGER, MUTED, Colour
from sandbox.editor.forecast import LARGEST
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.slices import work_for
from sandbox.session.level_edits import runs_alike
from sandbox.session.looking import Looking
from sandbox.session.outcome import outcome_text
from sandbox.session.replay.reader import read_in_slices
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.solution import Proof, Verdict, recorded_win, solution_of, solved_text

# Time [s] that a run may take of a frame, and a search, for which the person waits.
SLICE, LOOKING = 0.006, 0.012
NONE_YET = "No solution yet: play it, win, and keep the run as its solution."

TOO_LARGE = "The level is too large to be run beside the sheet: sandbox check --prove runs it."


class Proving:
    """Whether the solution of the level on the screen wins it: `text` says it, `done` is the part that is done, 0..1.

    run: what wins the level as it is now, None while that is not known. looking: the search for a way, None: there is
    none.
    """

    def __init__(self, screen: Editing) -> None:
        self._screen = screen
        self.verdict: Verdict | None = None
        self.run: Replay | None = None
        self.looking: Looking | None = None
        self._proof: Proof | None = None
        self._replay: Replay | None = None
        self._level: Level | None = None
        self._stamp: tuple[Path, int] | None = None
        self._work: Iterator[None] | None = None
        self._is_waiting = self._is_old = False

    @property
    def is_at_work(self) -> bool:
        """Whether a solution is run, or looked for."""
        return self.done is not None

    @property
    def _looks(self) -> bool:
        return self.looking is not None and self.looking.found is None and self.looking.done < 1.0

    @property
    def done(self) -> float | None:
        """How much of the work is done, 0..1; None: there is none."""
        if self._looks:
            return self.looking.done if self.looking else None
        if self._work is None and not self._is_waiting:
            return None
        return self._proof.done if self._proof is not None else 0.0

    @property
    def text(self) -> tuple[str, Colour]:
        """What there is to say of the solution, with its colour; "" of a level that nobody can win."""
        looking, level = self.looking, self._screen.document.level
        if not level.has_goal:
            return "", MUTED
        if looking is not None and looking.outcome is not None:
            won = outcome_text(looking.outcome, level.settings.tick_rate)
            return f"A way was found: {won}, in {looking.runs:,} runs.", ACCENT
        if self._looks and looking is not None:
            return f"Looking for a way: {looking.runs:,} runs, {100.0 * looking.done:.0f} %", MUTED
        if looking is not None:
            return f"No way was found in {looking.runs:,} runs.", DANGER
        if self.done is not None:
            return f"Running its solution again: {100.0 * self.done:.0f} %", MUTED
        if self.verdict is None:
            return NONE_YET, MUTED
        if not self.verdict.passed or self.verdict.outcome is None:
            return sentence(self.verdict.text), DANGER
        return solved_text(self.verdict.outcome, level.settings.tick_rate), ACCENT

    @property
    def _is_large(self) -> bool:
        return len(self._screen.scene.position) > LARGEST

    def look(self) -> None:
        """Look for a way to win the level, from the solution on that there is."""
        if self._is_large:
            self._screen.say(TOO_LARGE)
            return
        known = self._replay
        self.looking = Looking(self._screen.document.level, *((known.script, known.ticks) if known else ()))

    def stop(self) -> None:
        """Look no more."""
        self.looking = None

    def update(self, is_settled: bool) -> None:
        """Work for a moment; is_settled: the level has been as it is for a while."""
        level, path = self._screen.document.level, self._screen.level_file.path
        stamp = _stamp(path) if level.has_goal else None
        if level is not self._level or stamp != self._stamp:
            if self._level is None or stamp != self._stamp or not runs_alike(level, self._level):
                self._proof = self._work = self.verdict = self.run = self.looking = None
                self._replay = None if stamp != self._stamp else self._replay
                self._is_waiting = stamp is not None
            self._level, self._stamp = level, stamp
        if self._is_waiting and is_settled and stamp is not None:
            self._is_waiting, self._work = False, self._prove(level, stamp[0])
        if self._work is not None and work_for(self._work, SLICE):
            self._work = None
        if self.looking is not None and self._looks:
            work_for(self.looking.work, LOOKING)
        self._renew()

    def _prove(self, level: Level, path: Path) -> Iterator[None]:
        try:
            if self._replay is None:
                self._replay = yield from read_in_slices(path)
            replay, found = self._replay, recorded_win(level, self._replay)
            if found is not None:
                self.verdict, self.run = Verdict(True, "", found), replace(replay, level=level)
                return
            if self._is_large:
                self.verdict = Verdict(False, TOO_LARGE)
                return
            self._proof = Proof(level, replay)
            yield from self._proof.work
            self.verdict, self.run, self._is_old = self._proof.verdict, self._proof.run, True
        except (ReplayError, LevelError) as error:
            self.verdict = Verdict(False, f"{path.name}: {error.faults[0]}")

    def _renew(self) -> None:
        """Record the solution again once a level is saved that it has won by other bits."""
        screen, run = self._screen, self.run
        if self._is_old and run is not None and screen.history.is_saved and screen.level_file.path is not None:
            self._is_old = False
            screen.app.best.keep_solution(screen.level_file.path, run, lambda _: None)


def _stamp(path: Path | None) -> tuple[Path, int] | None:
    """The solution beside a level's file, and when it was written; None: there is none."""
    if path is None:
        return None
    try:
        return solution_of(path), solution_of(path).stat().st_mtime_ns
    except OSError:
        return None
