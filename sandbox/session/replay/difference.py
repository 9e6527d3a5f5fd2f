"""Difference: where two runs part, each a recording, or a level with the commands of the other or none."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.snapshot import hash_by_array, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.level_edits import edit_lines
from sandbox.session.replay.apart import Apart, apart_as_stored, apart_from_stored, apart_in_step
from sandbox.session.replay.divergence import Divergence, first_difference
from sandbox.session.replay.recording import Replay, ReplayError, TickHashes
from sandbox.session.replay.verify import recorded_run
from sandbox.session.session import Session


@dataclass(frozen=True)
class ComparedRun:
    """One of two runs. name: as a person calls it; replay: None of a level."""

    name: str
    level: Level
    replay: Replay | None

    @property
    def is_old(self) -> bool:
        """Whether it is a recording of another physics version, which cannot be run here as it was."""
        return self.replay is not None and not self.replay.is_of_this_physics

    def begin(self, other: "ComparedRun") -> Session:
        """A run of it from the beginning, where it has no commands with those of the other."""
        commands = self.replay or other.replay
        return Session(self.level, script=commands.script if commands else ())


@dataclass(frozen=True)
class RunDifference:
    """Where two runs part. level, commands: lines, none where they are equal; divergence: None where no tick differs.

    left, right: the runs at that tick, None of a recording to whose state this build does not come. ticks: compared.
    apart: how far particles are apart, None where a run is not known. versions: where a recording is of another physics
    version, so that stored states are compared and no bits, which ones, in a line; else "".
    """

    level: tuple[str, ...]
    commands: tuple[str, ...]
    divergence: Divergence | None
    left: Session | None
    right: Session | None
    ticks: int
    apart: Apart | None = None
    versions: str = ""

    @property
    def is_equal(self) -> bool:
        """Whether nothing differs."""
        is_apart = self.divergence is not None or (self.apart is not None and self.apart.first is not None)
        return not self.level and not self.commands and not is_apart

    def lines(self) -> list[str]:
        """All that differs, a line each."""
        found = [*self.level, *self.commands]
        apart = self.apart.told() if self.apart is not None else []
        if self.versions:
            return [self.versions, *found, *apart]
        if self.divergence is not None:
            return [*found, *apart, *self.divergence.lines("A", "B")]
        return [*found, f"equal in every bit of {self.ticks} ticks"]


def difference(
    first: ComparedRun, second: ComparedRun, ticks: int, progress: Callable[[int, int], None] | None = None
) -> RunDifference:
    """Compare two runs for a number of ticks, as far as recordings go. Raises ReplayError for commands that fail."""
    for side in (first, second):
        if side.replay is not None:
            ticks = min(ticks, side.replay.ticks)
    told = edit_lines(first.level, second.level)
    commands = _command_lines(first, second, ticks)
    sides = (first, second)
    if any(side.is_old for side in sides):
        apart = _apart_across(first, second, progress)
        return RunDifference(told, commands, None, None, None, ticks, apart, _versions(sides))
    try:
        for tick, hashes, sessions in _in_step(sides, ticks):
            if hashes[0].whole[: len(hashes[1].whole)] != hashes[1].whole[: len(hashes[0].whole)]:
                found = _located(sides, tick, hashes, sessions)
                known = found[1] is not None and found[2] is not None
                # From the beginning: checks follow a run from its first tick.
                both = apart_in_step(first.begin(second), second.begin(first), ticks) if known else None
                return RunDifference(told, commands, *found, ticks, both)
            if progress is not None:
                progress(tick, ticks)
    except CommandError as error:
        raise ReplayError(*error.faults) from None
    return RunDifference(told, commands, None, None, None, ticks)


def _apart_across(first: ComparedRun, second: ComparedRun, progress: Callable[[int, int], None] | None) -> Apart:
    """How far two runs are apart at the states that the older recording stores, or that both do."""
    if first.is_old and second.is_old:
        assert first.replay is not None and second.replay is not None
        return apart_as_stored(first.replay, second.replay)
    old, other = (first, second) if first.is_old else (second, first)
    assert old.replay is not None
    return apart_from_stored(old.replay, other.begin(old), progress=progress)


def _versions(sides: tuple[ComparedRun, ComparedRun]) -> str:
    here = [side.replay.physics_version if side.replay else PHYSICS_VERSION for side in sides]
    return f"physics version: {here[0]} -> {here[1]}; stored states are compared, not bits"


_Pair = tuple[Session | None, Session | None]


def _in_step(
    sides: tuple[ComparedRun, ComparedRun], ticks: int
) -> Iterator[tuple[int, tuple[TickHashes, TickHashes], _Pair]]:
    """Hashes of both after every tick: recordings have them, levels are run."""
    runs = tuple(None if side.replay else side.begin(other) for side, other in (sides, sides[::-1]))
    for tick in range(ticks + 1):
        hashes = []
        for side, run in zip(sides, runs, strict=True):
            if run is None:
                assert side.replay is not None
                hashes.append(side.replay.hashes[tick])
                continue
            with np.errstate(over="ignore", invalid="ignore"):
                while run.tick < tick:
                    run.advance()
            present = hash_by_array(run.world)
            hashes.append(
                TickHashes(state_hash(run.world, present), tuple(present.get(name, "") for name in BY_STORED))
            )
        yield tick, (hashes[0], hashes[1]), (runs[0], runs[1])


def _located(
    sides: tuple[ComparedRun, ComparedRun], tick: int, hashes: tuple[TickHashes, TickHashes], runs: _Pair
) -> tuple[Divergence, Session | None, Session | None]:
    """The first array that differs, its values, and both runs there."""
    pairs = zip(BY_STORED, hashes[0].arrays, hashes[1].arrays, strict=True)
    array = next((name for name, a, b in pairs if a[: len(b) or None] != b[: len(a) or None]), "settings")
    left, right = (run or recorded_run(side.replay, tick) if side.replay else run
                   for side, run in zip(sides, runs, strict=True))  # fmt: skip
    if array == "settings":
        return Divergence(tick, array, None, hashes[0].whole, hashes[1].whole, note="of the whole state"), left, right
    if left is None or right is None:
        lost = " and ".join(name for name, run in (("A", left), ("B", right)) if run is None)
        note = f"this build does not come to the recorded state of {lost}, so that the values are not known"
        return Divergence(tick, array, None, "unknown", "unknown", note=note), left, right
    wanted = getattr(left.world, BY_STORED[array].name)
    return first_difference(tick, array, wanted, right.world, left.world), left, right


def _command_lines(first: ComparedRun, second: ComparedRun, ticks: int) -> tuple[str, ...]:
    """The first command in which two recordings differ."""
    if first.replay is None or second.replay is None:
        return ()
    scripts = [[line for line in side.replay.script if line.tick <= ticks] for side in (first, second) if side.replay]
    for number in range(max(map(len, scripts))):
        a, b = (script[number] if number < len(script) else None for script in scripts)
        if a is None or b is None or (a.tick, a.record) != (b.tick, b.record):
            return f"command {number + 1} differs", f"A  {_told(a)}", f"B  {_told(b)}"
    return ()


def _told(line: ScriptLine | None) -> str:
    return "there is none" if line is None else f"tick {line.tick}: {line.record}"
