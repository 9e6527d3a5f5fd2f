"""verify: runs a replay again and names the first bit that differs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.model import Level
from sandbox.physics.query import slot_name
from sandbox.physics.snapshot import canonical_bytes, hash_by_array, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.world import World
from sandbox.session.commands import CommandError
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

# Ticks between two calls of verify's `progress`.
PROGRESS_TICKS = 60


@dataclass(frozen=True)
class Divergence:
    """The first difference between a recording and its verification.

    array: a state array, or `settings`; index: into that array, an int or (slot, component), None where the array's
    length differs; name: of the particle or spring; note: where the difference was found, if not at `tick` itself.
    """

    tick: int
    array: str
    index: int | tuple[int, int] | None
    expected: Any
    actual: Any
    name: str = ""
    note: str = ""

    def __str__(self) -> str:
        index = "" if self.index is None else str(list(np.atleast_1d(self.index).tolist()))
        name = f" ({self.name})" if self.name else ""
        note = f"; {self.note}" if self.note else ""
        return f"tick {self.tick}: {self.array}{index}{name}: expected {self.expected!r}, got {self.actual!r}{note}"


def verify(
    replay: Replay,
    *,
    start: int = 0,
    level: Level | None = None,
    on_tick: Callable[[World], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Divergence | None:
    """Run a replay again and compare every tick; None where all bits are equal.

    start: the tick of a stored state to begin from instead of the level. level: to run the commands on, from its
    beginning, instead of the recorded one. on_tick: called with the world after every
    step, before it is compared. progress: called with ticks done and ticks in all. Raises ReplayError where the
    recording holds a command that cannot be carried out.
    """
    if level is not None and start:
        raise ReplayError(f"{replay.source}: on another level it runs from the beginning, not from tick {start}")
    run = _Run(replay, level)
    session = run.session(start)
    while True:
        difference = _compare(replay, session.world)
        if difference:
            return run.locate(session.tick, difference, session.world)
        if session.tick == replay.ticks:
            break
        run.advance(session)
        if on_tick is not None:
            on_tick(session.world)
        if progress is not None and session.tick % PROGRESS_TICKS == 0:
            progress(session.tick - start, replay.ticks - start)
    run.guard(session.apply_pending)
    if replay.end_hash is not None and state_hash(session.world) != replay.end_hash:
        return Divergence(
            session.tick, "hash", None, replay.end_hash, state_hash(session.world), note="at the end line"
        )
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

    def locate(self, tick: int, array: str, world: World) -> Divergence:
        """Find index and values by stepping again, undisturbed, from the last stored state that was verified."""
        replay = self.replay
        if array == "settings":
            return Divergence(tick, array, None, replay.hashes[tick].whole, state_hash(world))
        clean = self._clean_session(verified=tick - 1, tick=tick)
        if not replay.hashes[tick].differs(array, hash_by_array(clean.world)):
            return _first_difference(tick, array, getattr(clean.world, BY_STORED[array].name), world)
        steps = f"this {'build' if self.level is None else 'level'} steps differently"
        later = min((stored for stored in replay.states if stored >= tick), default=None)
        if later is None:
            note = f"{steps}, and no later state is stored to show the values"
            return Divergence(tick, array, None, "unknown", "unknown", note=note)
        try:
            clean = self._clean_session(verified=tick - 1, tick=later)
        except ReplayError:
            note = f"{steps}, and cannot reach the next stored state, tick {later}, to show the values"
            return Divergence(tick, array, None, "unknown", "unknown", note=note)
        recorded = replay.state(later)
        found = _first_difference(tick, array, getattr(recorded, BY_STORED[array].name), clean.world)
        note = f"{steps}; the values are those of the next stored state, tick {later}"
        return Divergence(tick, array, found.index, found.expected, found.actual, found.name, note)

    def _clean_session(self, verified: int, tick: int) -> Session:
        """A fresh session at a tick, begun from the last state stored up to the verified tick.

        It begins from the level where an undo reaches back behind that state, and where it is another level.
        """
        stored = [] if self.level else [tick for tick in self.replay.states if tick <= verified]
        for start in (max(stored, default=0), 0):
            try:
                session = self.session(start)
                while session.tick < tick:
                    self.advance(session)
            except ReplayError:
                continue
            return session
        raise ReplayError(f"{self.replay.source}: tick {tick} cannot be reached")


def _compare(replay: Replay, world: World) -> str | None:
    """The first array in hashing order that differs from the recording, or None."""
    recorded, present = replay.hashes[world.tick], hash_by_array(world)
    if state_hash(world, present) == recorded.whole:
        return None
    return next((name for name in BY_STORED if recorded.differs(name, present)), "settings")


def _first_difference(tick: int, array: str, expected: NDArray[Any], world: World) -> Divergence:
    actual: NDArray[Any] = getattr(world, BY_STORED[array].name)
    if len(expected) != len(actual):
        return Divergence(tick, array, None, f"{len(expected)} values", f"{len(actual)} values")
    size = actual.dtype.itemsize
    pairs = [np.frombuffer(canonical_bytes(side), dtype=f"V{size}") for side in (expected, actual)]
    flat = next((place for place, pair in enumerate(zip(*pairs, strict=True)) if pair[0] != pair[1]), None)
    if flat is None:
        return Divergence(tick, array, None, "equal", "equal", note="the two runs agree here")
    place = tuple(int(part) for part in np.unravel_index(flat, actual.shape))
    index = place[0] if len(place) == 1 else (place[0], place[1])
    name = slot_name(world, array, place[0])
    return Divergence(tick, array, index, expected[place].item(), actual[place].item(), name)
