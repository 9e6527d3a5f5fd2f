"""verify: runs a replay again and names the first bit that differs; compare: the same, with the runs at that tick."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from sandbox.level.document.model import Level
from sandbox.level.reading.files import file_of
from sandbox.physics.snapshot import array_hash, canonical_bytes, hash_by_array, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.level_edits import edit_lines
from sandbox.session.replay.apart import Apart, Progress, apart_from_stored, apart_in_step
from sandbox.session.replay.divergence import Divergence, first_difference, settings_difference
from sandbox.session.replay.format import decode_array
from sandbox.session.replay.recorded_array import recorded_array
from sandbox.session.replay.recording import ByHand, Replay, ReplayError
from sandbox.session.session import Session

# Ticks between two calls of verify's `progress`.
PROGRESS_TICKS = 60
_OTHERWISE = "this build steps differently"


@dataclass(frozen=True)
class Comparison:
    """A run that diverged from its recording.

    actual: that run, at the tick of the divergence or later; expected: a run whose state at that tick is the recorded
    one, None where this build cannot give it. before, after: ticks of the stored states on either side, None without
    one. edits: in which its level is another, a line each. by_hand: what a program wrote into the recorded world
    before they part. apart: how far they come apart, None: not measured.
    """

    divergence: Divergence
    replay: Replay
    actual: Session
    expected: Session | None
    before: int | None
    after: int | None
    edits: tuple[str, ...] = ()
    by_hand: ByHand | None = None
    apart: Apart | None = None

    @property
    def telling_tick(self) -> int:
        """The tick that shows the difference best: where they are farthest apart, or else where they part."""
        return self.apart.tick if self.apart is not None and self.apart.is_visible else self.divergence.tick

    @property
    def telling_slots(self) -> tuple[int, int] | None:
        """The particle that is farthest away then, by its slots in both runs; None where no eye sees that."""
        return self.apart.slots if self.apart is not None and self.apart.is_visible else None

    def cause(self) -> str:
        """What is known of why they part, in a line: edits, or what was written by hand; else the first difference."""
        if self.edits:
            more = f" and {len(self.edits) - 1} more" if len(self.edits) > 1 else ""
            return f"{self.edits[0]}{more}"
        return str(self.by_hand) if self.by_hand else str(self.divergence)

    def lines(self) -> list[str]:
        """The difference in lines; if the recording does not hold the values at that tick, also its stored states
        around it. What is known of edits and distances comes first.
        """
        told = [*self.edits, *(self.apart.told() if self.apart is not None else [])]
        return [*told, *self.difference()]

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
    progress: Callable[[int, int], None] | None = None,
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
    progress: Callable[[int, int], None] | None = None,
) -> Comparison | None:
    """As `verify`, with both runs where they part."""
    if level is not None and start:
        raise ReplayError(f"{replay.source}: on another level it runs from the beginning, not from tick {start}")
    run = _Run(replay, level)
    session = run.session(start)
    last = replay.ticks if end is None else min(end, replay.ticks)
    while True:
        difference = _differing_array(replay, session.world)
        if difference:
            return run.locate(session, difference)
        if changed := _differing_state(replay, session.world, is_own=level is None):
            return run.comparison(session, changed, None)
        if session.tick >= last:
            break
        run.advance(session)
        if on_tick is not None:
            on_tick(session.world)
        if progress is not None and session.tick % PROGRESS_TICKS == 0:
            progress(session.tick - start, last - start)
    if last < replay.ticks:
        return None
    run.guard(session.apply_pending)
    present = state_hash(session.world)
    if replay.end_hash is not None and present != replay.end_hash:
        belied = Divergence(session.tick, "hash", None, replay.end_hash, present, note="at the end line")
        return run.comparison(session, belied, None)
    return None


def to_the_end(found: Comparison, progress: Progress | None = None) -> Comparison:
    """A comparison with how far its runs come apart; both are stepped on to the end of the recording.

    Where the level was edited both begin anew, so that its checks can be measured in both.
    """
    replay, expected, actual = found.replay, found.expected, found.actual
    if expected is None:
        return replace(found, apart=apart_from_stored(replay, actual, progress=progress))
    if found.edits:
        expected, actual = (Session(level, script=replay.script) for level in (replay.level, actual.level))
    elif expected.tick != actual.tick:
        return found
    apart = apart_in_step(expected, actual, replay.ticks, progress=progress)
    if replay.end_hash is not None and expected.tick == replay.ticks and state_hash(expected.world) != replay.end_hash:
        apart = replace(apart, lines=(*apart.lines, "measured to this build's run of the recording, which differs"))
    return replace(found, expected=expected, actual=actual, apart=apart)


def across_versions(replay: Replay, level: Level | None = None, progress: Progress | None = None) -> Comparison:
    """A recording of another physics version beside a run of its commands here, at the states that it stores."""
    run = _Run(replay, level)
    versions = str(replay.physics_version), str(PHYSICS_VERSION)
    found = run.comparison(run.session(0), Divergence(0, "physics_version", None, *versions), None)
    return to_the_end(found, progress)


def recorded_run(replay: Replay, tick: int) -> Session | None:
    """A run of a recording at one of its ticks, None where this build does not come to the recorded state there."""
    session = _run_anew(replay, tick)
    fits = session is not None and replay.hashes[tick].fits(state_hash(session.world))
    return session if fits else None


def _run_anew(replay: Replay, tick: int) -> Session | None:
    """A run of a recording at a tick, as this build steps it, None where a command fails before."""
    try:
        return _Run(replay, None).clean_session(tick)
    except ReplayError:
        return None


@dataclass(frozen=True)
class _Run:
    """A recording's commands, on the level that they were recorded on or on another."""

    replay: Replay
    level: Level | None

    def session(self, start: int) -> Session:
        """A session at a tick whose state is stored."""
        replay = self.replay
        if start == 0:
            return Session(self.level or replay.level, script=replay.script)
        return Session(replay.level, script=replay.script, start=replay.state(start))

    def advance(self, session: Session) -> None:
        """One tick. Raises ReplayError."""
        self.guard(session.advance)

    def guard(self, act: Callable[[], object]) -> None:
        """Act, and say of which recording a command cannot be carried out. Raises ReplayError."""
        try:
            act()
        except CommandError as error:
            raise ReplayError(*(f"{self.replay.source}: {fault}" for fault in error.faults)) from None

    def comparison(self, actual: Session, divergence: Divergence, expected: Session | None) -> Comparison:
        """Both runs, and the stored states on either side."""
        stored = self.replay.states
        before = max((tick for tick in stored if tick < divergence.tick), default=None)
        after = min((tick for tick in stored if tick >= divergence.tick), default=None)
        level = self.level
        edits = () if level is None else edit_lines(self.replay.level, level, file_of(level) or "level")
        by_hand = next((each for each in self.replay.written if each.tick < divergence.tick), None)
        return Comparison(divergence, self.replay, actual, expected, before, after, edits, by_hand)

    def locate(self, actual: Session, array: str) -> Comparison:
        """Find index and values by stepping the recorded run again, undisturbed, from the last stored state."""
        replay, tick, world = self.replay, actual.tick, actual.world
        anew = _run_anew(replay, tick)
        expected = anew if anew is not None and replay.hashes[tick].fits(state_hash(anew.world)) else None
        if array == "settings":
            found = self._located_settings(expected, world)
        elif expected is not None:
            wanted = getattr(expected.world, BY_STORED[array].name)
            found = first_difference(tick, array, wanted, world, expected.world)
        else:
            found = self._located_by_hash(actual, array) or self._located_later(tick, array, anew)
        compared = self.comparison(actual, found, expected)
        if compared.by_hand is None or expected is not None:
            return compared
        return replace(compared, divergence=replace(found, note=str(compared.by_hand)))

    def _located_settings(self, expected: Session | None, world: World) -> Divergence:
        """The settings that differ: as the recorded run has them, or the next state that is stored."""
        later = min((tick for tick in self.replay.states if tick >= world.tick), default=None)
        wanted = expected.world.settings if expected else None
        if wanted is None and later is not None:
            wanted = self.replay.states[later].settings
        found = None if wanted is None else settings_difference(world.tick, wanted, world.settings)
        hashes = self.replay.hashes[world.tick].whole, state_hash(world)
        return found or Divergence(world.tick, "settings", None, *hashes, note="of the whole state")

    def _located_by_hash(self, actual: Session, array: str) -> Divergence | None:
        """The same by the recorded hashes, where no other array differs, and that in a single number."""
        recorded, world = self.replay.hashes[actual.tick], actual.world
        present = hash_by_array(world)
        if [name for name in BY_STORED if recorded.differs(name, present)] != [array] or array not in present:
            return None

        def fits(digits: str) -> bool:
            changed = present | {array: digits}
            return not recorded.differs(array, changed) and recorded.fits(state_hash(world, changed))

        wanted = recorded_array(getattr(world, BY_STORED[array].name), fits)
        if wanted is None:
            return None
        found = first_difference(actual.tick, array, wanted, world)
        return replace(found, note=f"{_OTHERWISE}; what is expected is told by its hash")

    def _located_later(self, tick: int, array: str, anew: Session | None) -> Divergence:
        """The same from the next stored state, where this build does not come to the recorded one.

        anew: the recording as this build steps it, at the tick, which is stepped on.
        """
        replay = self.replay
        later = min((stored for stored in replay.states if stored >= tick), default=None)
        if later is None:
            note = f"{_OTHERWISE}, and no later state is stored to show the values"
            return Divergence(tick, array, None, "unknown", "unknown", note=note)
        try:
            recorded = replay.state(later)
            clean = None if self.level else self._stepped_on(anew, later)
            clean = clean or self.clean_session(later, tick - 1)
        except ReplayError:
            note = f"{_OTHERWISE}, and cannot reach the next stored state, tick {later}, to show the values"
            return Divergence(tick, array, None, "unknown", "unknown", note=note)
        found = first_difference(tick, array, getattr(recorded, BY_STORED[array].name), clean.world)
        return replace(found, tick=tick, note=_OTHERWISE, seen=later)

    def _stepped_on(self, session: Session | None, tick: int) -> Session | None:
        """A session at a later tick, None where an undo reaches back behind its beginning."""
        try:
            while session is not None and session.tick < tick:
                self.advance(session)
        except ReplayError:
            return None
        return session

    def clean_session(self, tick: int, verified: int | None = None) -> Session:
        """A fresh session at a tick, begun from the last state stored up to the verified tick, the one before it.

        It begins from the level where an undo reaches back behind that state, and where it is another level.
        Raises ReplayError.
        """
        known = tick - 1 if verified is None else verified
        stored = [] if self.level else [each for each in self.replay.states if each <= known]
        for start in (max(stored, default=0), 0):
            try:
                session = self.session(start)
                while session.tick < tick:
                    self.advance(session)
            except ReplayError:
                continue
            return session
        raise ReplayError(f"{self.replay.source}: tick {tick} cannot be reached")


def _differing_array(replay: Replay, world: World) -> str | None:
    """The first array in hashing order that differs from the recording, or None."""
    recorded, present = replay.hashes[world.tick], hash_by_array(world)
    if recorded.fits(state_hash(world, present)):
        return None
    return next((name for name in BY_STORED if recorded.differs(name, present)), "settings")


def _differing_state(replay: Replay, world: World, *, is_own: bool) -> Divergence | None:
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
        found = first_difference(world.tick, name, array, world)
        return replace(found, note=note)
    return None
