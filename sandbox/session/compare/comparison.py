"""Compares two runs tick by tick, and keeps both where the first bit differs.

`verify` and `compare` run a recording again; `difference` takes any two recordings or levels.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.reading.files import file_of
from sandbox.physics.snapshot import array_hash, canonical_bytes, hash_by_array, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.distance import (
    Progress,
    TrajectoryDistance,
    distance_as_stored,
    distance_from_stored,
    distance_in_step,
)
from sandbox.session.compare.divergence import (
    Divergence,
    array_of_hash,
    first_difference,
    first_divergence,
    settings_difference,
)
from sandbox.session.level_edits import edit_lines
from sandbox.session.replay.format import decode_array
from sandbox.session.replay.recording import ByHand, Replay, ReplayError, TickHashes, faults_of
from sandbox.session.session import Session

# Ticks between two calls of verify's `progress`.
PROGRESS_TICKS = 60
_OTHERWISE = "this build steps differently"


@dataclass(frozen=True)
class Comparison:
    """A run that diverged from its recording.

    actual: that run, at the tick of the divergence or later; expected: a run whose state at that tick is the recorded
    one, None where this build cannot give it. edits: in which its level is another, a line each. by_hand: what a
    program wrote into the recorded world before they part. distance: how far they come apart, None: not measured.
    """

    divergence: Divergence
    replay: Replay
    actual: Session
    expected: Session | None
    edits: tuple[str, ...] = ()
    by_hand: ByHand | None = None
    distance: TrajectoryDistance | None = None

    @property
    def before(self) -> int | None:
        """The tick of the last stored state before the divergence."""
        return max((tick for tick in self.replay.states if tick < self.divergence.tick), default=None)

    @property
    def after(self) -> int | None:
        """The tick of the first stored state that is not before it."""
        return min((tick for tick in self.replay.states if tick >= self.divergence.tick), default=None)

    @property
    def telling_tick(self) -> int:
        """The tick that shows the difference best: where they are farthest apart, or else where they part."""
        return self.distance.tick if self.distance is not None and self.distance.is_visible else self.divergence.tick

    @property
    def telling_slots(self) -> tuple[int, int] | None:
        """Slots in both runs of the particle farthest away at `telling_tick`; None where no eye sees that."""
        return self.distance.slots if self.distance is not None and self.distance.is_visible else None

    def cause(self) -> str:
        """Why the runs part, in a line: edits, or arrays written by hand; else the first difference."""
        if self.edits:
            more = f" and {len(self.edits) - 1} more" if len(self.edits) > 1 else ""
            return f"{self.edits[0]}{more}"
        return str(self.by_hand) if self.by_hand else str(self.divergence)

    def lines(self) -> list[str]:
        """The difference in lines; if the recording does not hold the values at that tick, also its stored states
        around it. What is known of edits and distances comes first.
        """
        known = [*self.edits, *(self.distance.lines_of_all() if self.distance is not None else [])]
        return [*known, *self.difference()]

    def difference(self) -> list[str]:
        """The first difference alone, in lines; none across physics versions, where no bits are compared."""
        if not self.replay.is_of_this_physics:
            return []
        if self.expected is not None:
            return self.divergence.lines()
        last = "there is none before" if self.before is None else f"the last before is that of tick {self.before}"
        first = "there is none after" if self.after is None else f"the first after that of tick {self.after}"
        return [*self.divergence.lines(), f"of the stored states {last}, {first}"]


def verify(
    replay: Replay,
    *,
    start: int = 0,
    end: int | None = None,
    level: Level | None = None,
    on_tick: Callable[[World], None] | None = None,
    progress: Progress | None = None,
) -> Divergence | None:
    """Run a replay again and compare every tick; None where all bits are equal.

    start: the tick of a stored state to begin from instead of the level; end: the last tick to compare, in place of
    that of the recording. level: to run the commands on, from its beginning, instead of the recorded one. on_tick:
    called with the world after every step, before it is compared. progress: called with ticks done and ticks in all.
    Raises ReplayError where the recording holds a command that cannot be carried out.
    """
    found = compare(replay, start=start, end=end, level=level, on_tick=on_tick, progress=progress)
    return None if found is None else found.divergence


def compare(
    replay: Replay,
    *,
    start: int = 0,
    end: int | None = None,
    level: Level | None = None,
    on_tick: Callable[[World], None] | None = None,
    progress: Progress | None = None,
) -> Comparison | None:
    """As `verify`, with both runs where they part."""
    if level is not None and start:
        raise ReplayError(f"{replay.source}: on another level it runs from the beginning, not from tick {start}")
    session = _begun(replay, start, level)
    last = replay.ticks if end is None else min(end, replay.ticks)
    with faults_of(replay):
        while True:
            if not replay.hashes[session.tick].agrees(TickHashes.of(session.world)):
                return _located(replay, level, session)
            if belied := _belied_state(replay, session.world, is_own=level is None):
                return _comparison(replay, session, belied, None)
            if session.tick >= last:
                break
            session.advance()
            if on_tick is not None:
                on_tick(session.world)
            if progress is not None and session.tick % PROGRESS_TICKS == 0:
                progress(session.tick - start, last - start)
        if last < replay.ticks:
            return None
        session.apply_pending()
    present = state_hash(session.world)
    if replay.end_hash is None or present == replay.end_hash:
        return None
    belied = Divergence(session.tick, "hash", None, replay.end_hash, present, note="at the end line")
    return _comparison(replay, session, belied, None)


def to_the_end(found: Comparison, progress: Progress | None = None) -> Comparison:
    """A comparison with how far its runs come apart; both are stepped on to the end of the recording.

    Where the level was edited both begin anew, so that its checks can be measured in both.
    """
    replay, expected, actual = found.replay, found.expected, found.actual
    if expected is None:
        return replace(found, distance=distance_from_stored(replay, actual, progress=progress))
    if found.edits:
        expected, actual = (Session(level, script=replay.script) for level in (replay.level, actual.level))
    elif expected.tick != actual.tick:
        return found
    distance = distance_in_step(expected, actual, replay.ticks, progress=progress)
    if replay.end_hash is not None and expected.tick == replay.ticks and state_hash(expected.world) != replay.end_hash:
        more = "measured to this build's run of the recording, which differs"
        distance = replace(distance, lines=(*distance.lines, more))
    return replace(found, expected=expected, actual=actual, distance=distance)


def across_versions(replay: Replay, level: Level | None = None, progress: Progress | None = None) -> Comparison:
    """A recording of another physics version beside a run of its commands here, at the states that it stores."""
    versions = str(replay.physics_version), str(PHYSICS_VERSION)
    found = Divergence(0, "physics_version", None, *versions)
    return to_the_end(_comparison(replay, _begun(replay, 0, level), found, None), progress)


def recorded_run(replay: Replay, tick: int) -> Session | None:
    """A run of a recording at one of its ticks, None where this build does not come to the recorded state there."""
    session = _reached(replay, tick, tick - 1)
    fits = session is not None and replay.hashes[tick].fits(state_hash(session.world))
    return session if fits else None


def _begun(replay: Replay, start: int, level: Level | None = None) -> Session:
    """A recording's commands from a tick whose state is stored, or from the beginning, perhaps of another level."""
    if start == 0:
        return Session(replay.on(level), script=replay.script)
    return Session(replay.level, script=replay.script, start=replay.state(start))


def _reached(replay: Replay, tick: int, known: int, level: Level | None = None) -> Session | None:
    """A fresh run of a recording at a tick, None where this build cannot come there.

    It begins from the last state that is stored up to a tick that is known to be right. It begins from the level where
    an undo reaches back behind that state, and where it is another level.
    """
    stored = [] if level else [each for each in replay.states if each <= known]
    for start in dict.fromkeys((max(stored, default=0), 0)):
        try:
            session = _begun(replay, start, level)
        except ReplayError:
            continue
        if _stepped_on(session, tick):
            return session
    return None


def _stepped_on(session: Session, tick: int) -> bool:
    """Step a run on to a tick; whether it came there, where no command failed on the way."""
    try:
        while session.tick < tick:
            session.advance()
    except CommandError:
        return False
    return True


def _comparison(replay: Replay, actual: Session, found: Divergence, expected: Session | None) -> Comparison:
    level = actual.level
    edits = () if level is replay.level else edit_lines(replay.level, level, file_of(level) or "level")
    by_hand = next((each for each in replay.written if each.tick < found.tick), None)
    return Comparison(found, replay, actual, expected, edits, by_hand)


def _located(replay: Replay, level: Level | None, actual: Session) -> Comparison:
    """Find array, index and values where a run has another hash than its recording.

    The recorded run is stepped again, undisturbed, from the last stored state.
    """
    tick, world = actual.tick, actual.world
    recorded = replay.hashes[tick]
    anew = _reached(replay, tick, tick - 1)
    expected = anew if anew is not None and recorded.fits(state_hash(anew.world)) else None
    array = next(iter(recorded.unlike(TickHashes.of(world))), "settings")
    if expected is not None:
        found = first_divergence(expected.world, world) or _of_whole_state(tick, recorded.whole, state_hash(world))
        return _comparison(replay, actual, found, expected)
    if array == "settings":
        later = min((each for each in replay.states if each >= tick), default=None)
        known = None if later is None else settings_difference(tick, replay.states[later].settings, world.settings)
        found = known or _of_whole_state(tick, recorded.whole, state_hash(world))
    else:
        found = _located_by_hash(recorded, world, array) or _located_later(replay, level, tick, array, anew)
    compared = _comparison(replay, actual, found, None)
    if compared.by_hand is None:
        return compared
    return replace(compared, divergence=replace(found, note=str(compared.by_hand)))


def _of_whole_state(tick: int, expected: str, actual: str) -> Divergence:
    return Divergence(tick, "settings", None, expected, actual, note="of the whole state")


def _located_by_hash(recorded: TickHashes, world: World, array: str) -> Divergence | None:
    """The values by the recorded hashes, where no other array differs, and that in a single number."""
    present = hash_by_array(world)
    if recorded.unlike(TickHashes.of(world)) != [array] or array not in present:
        return None
    digits = recorded.arrays[list(BY_STORED).index(array)]

    def fits(other: str) -> bool:
        return other.startswith(digits) and recorded.fits(state_hash(world, present | {array: other}))

    expected = array_of_hash(getattr(world, BY_STORED[array].name), fits) if digits else None
    if expected is None:
        return None
    found = first_difference(world.tick, array, expected, world)
    return replace(found, note=f"{_OTHERWISE}; what is expected is told by its hash")


def _located_later(replay: Replay, level: Level | None, tick: int, array: str, anew: Session | None) -> Divergence:
    """The values at the next stored state, where this build does not come to the recorded one at a tick.

    anew: the recording as this build steps it, at that tick, which is stepped on.
    """
    unknown = Divergence(tick, array, None, "unknown", "unknown")
    later = min((stored for stored in replay.states if stored >= tick), default=None)
    if later is None:
        return replace(unknown, note=f"{_OTHERWISE}, and no later state is stored to show the values")
    try:
        recorded = replay.state(later)
    except ReplayError:
        clean = None
    else:
        is_there = anew is not None and level is None and _stepped_on(anew, later)
        clean = anew if is_there else _reached(replay, later, tick - 1, level)
    if clean is None:
        note = f"{_OTHERWISE}, and cannot reach the next stored state, tick {later}, to show the values"
        return replace(unknown, note=note)
    found = first_difference(tick, array, getattr(recorded, BY_STORED[array].name), clean.world)
    return replace(found, tick=tick, note=_OTHERWISE, seen=later)


def _belied_state(replay: Replay, world: World, *, is_own: bool) -> Divergence | None:
    """How a stored state belies the hash that stands at its tick, which is that of the world.

    is_own: whether the world's level is the recorded one; else it may have more or fewer rows that are as usual.
    """
    stored = replay.states.get(world.tick)
    for name, text in stored.arrays.items() if stored else ():
        column = BY_STORED.get(name)
        try:
            array = None if column is None else decode_array(column, text)
        except ValueError as error:
            raise ReplayError(f"{replay.source}: line {stored.line if stored else 0}: {error}") from None
        if column is None or array is None:
            continue
        present = getattr(world, column.name)
        if canonical_bytes(array) == canonical_bytes(present):
            continue
        if not is_own and array_hash(column, array) == array_hash(column, present):
            continue
        note = "the stored state is not the one whose hash stands at its tick: changed, and sealed again"
        return replace(first_difference(world.tick, name, array, world), note=note)
    return None


@dataclass(frozen=True)
class ComparedRun:
    """One of two runs. name: as a person calls it; replay: None of a level."""

    name: str
    level: Level
    replay: Replay | None

    @property
    def is_old(self) -> bool:
        """Whether the recording is of another physics version, which cannot be run here as it was."""
        return self.replay is not None and not self.replay.is_of_this_physics

    def beside(self, other: "ComparedRun") -> "ComparedRun":
        """It, where it is a level with the settings that the other, a recording, was run with. Raises ReplayError."""
        return self if self.replay or other.replay is None else replace(self, level=other.replay.on(self.level))

    def begin(self, other: "ComparedRun") -> Session:
        """A run of it from the beginning, where it has no commands with those of the other."""
        commands = self.replay or other.replay
        return Session(self.beside(other).level, script=commands.script if commands else ())


@dataclass(frozen=True)
class RunDifference:
    """The difference of two runs. level, commands: lines, none where they are equal; divergence: None: no tick differs.

    expected, actual: the runs at that tick, None of a recording to whose state this build does not come. ticks:
    compared. distance: of their particles, None where a run is not known. versions: where a recording is of another
    physics version, so that stored states are compared and no bits, which ones, in a line; else "".
    """

    level: tuple[str, ...]
    commands: tuple[str, ...]
    ticks: int
    divergence: Divergence | None = None
    expected: Session | None = None
    actual: Session | None = None
    distance: TrajectoryDistance | None = None
    versions: str = ""

    @property
    def is_equal(self) -> bool:
        """Whether nothing differs."""
        is_elsewhere = self.distance is not None and self.distance.first is not None
        return not (self.level or self.commands or self.divergence is not None or is_elsewhere)

    def lines(self) -> list[str]:
        """All differences, a line each."""
        known = [*self.level, *self.commands]
        distance = self.distance.lines_of_all() if self.distance is not None else []
        if self.versions:
            return [self.versions, *known, *distance]
        if self.divergence is not None:
            return [*known, *distance, *self.divergence.lines("A", "B")]
        return [*known, f"equal in every bit of {self.ticks} ticks"]


def difference(first: ComparedRun, second: ComparedRun, ticks: int, progress: Progress | None = None) -> RunDifference:
    """Compare two runs for a number of ticks, as far as recordings go. Raises ReplayError for commands that fail.

    Of recordings the hashes are compared, and only levels are run, until two differ.
    """
    first, second = sides = first.beside(second), second.beside(first)
    ticks = min([ticks, *(side.replay.ticks for side in sides if side.replay is not None)])
    equal = RunDifference(edit_lines(first.level, second.level), _command_lines(sides, ticks), ticks)
    if first.is_old or second.is_old:
        here = [side.replay.physics_version if side.replay else PHYSICS_VERSION for side in sides]
        versions = f"physics version: {here[0]} -> {here[1]}; stored states are compared, not bits"
        return replace(equal, distance=_distance_across(first, second, progress), versions=versions)
    runs = [None if side.replay else side.begin(other) for side, other in (sides, sides[::-1])]
    try:
        for tick in range(ticks + 1):
            one, other = (_hashes_at(side, run, tick) for side, run in zip(sides, runs, strict=True))
            if one.agrees(other):
                if progress is not None:
                    progress(tick, ticks)
                continue
            a, b = (recorded_run(side.replay, tick) if side.replay else run
                    for side, run in zip(sides, runs, strict=True))  # fmt: skip
            if a is not None and b is not None:
                found = first_divergence(a.world, b.world) or _of_whole_state(tick, one.whole, other.whole)
                # From the beginning: checks follow a run from its first tick.
                distance = distance_in_step(first.begin(second), second.begin(first), ticks)
                return replace(equal, divergence=found, expected=a, actual=b, distance=distance)
            lost = " and ".join(name for name, run in (("A", a), ("B", b)) if run is None)
            note = f"this build does not come to the recorded state of {lost}, so that the values are not known"
            array = next(iter(one.unlike(other)), "settings")
            found = Divergence(tick, array, None, "unknown", "unknown", note=note)
            return replace(equal, divergence=found, expected=a, actual=b)
    except CommandError as error:
        raise ReplayError(*error.faults) from None
    return equal


def _hashes_at(side: ComparedRun, run: Session | None, tick: int) -> TickHashes:
    """The hashes of a side after a tick: a recording has them, a level is run."""
    if side.replay is not None:
        return side.replay.hashes[tick]
    assert run is not None
    with np.errstate(over="ignore", invalid="ignore"):
        while run.tick < tick:
            run.advance()
    return TickHashes.of(run.world)


def _distance_across(first: ComparedRun, second: ComparedRun, progress: Progress | None) -> TrajectoryDistance:
    """How far two runs are apart at the states that the older recording stores, or that both do."""
    old, other = (first, second) if first.is_old else (second, first)
    assert old.replay is not None
    if other.is_old:
        assert other.replay is not None
        return distance_as_stored(old.replay, other.replay)
    return distance_from_stored(old.replay, other.begin(old), progress=progress)


def _command_lines(sides: tuple[ComparedRun, ComparedRun], ticks: int) -> tuple[str, ...]:
    """The first command in which two recordings differ."""
    scripts = [[line for line in side.replay.script if line.tick <= ticks] for side in sides if side.replay]
    if len(scripts) < len(sides):
        return ()

    def words(line: ScriptLine | None) -> str:
        return "there is none" if line is None else f"tick {line.tick}: {json.dumps(line.record)}"

    for number in range(max(map(len, scripts))):
        a, b = (script[number] if number < len(script) else None for script in scripts)
        if a is None or b is None or (a.tick, a.record) != (b.tick, b.record):
            return f"command {number + 1} differs", f"A  {words(a)}", f"B  {words(b)}"
    return ()
