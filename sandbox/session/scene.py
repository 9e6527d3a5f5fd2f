"""Scene: how a run stands: its level, what was done in it, and its state; from there it goes on to the very bits."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from sandbox.level.document.model import Level
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands.records import ScriptLine, to_record
from sandbox.session.events.moments import Moments, until
from sandbox.session.log import LogEntry
from sandbox.session.session import Session

# The last gestures before which a state is kept too, so that undoing them steps little again. Each is a state more in
# the file.
STATES_BEFORE = 2
_ADDED, _CUT = ("add_body", "add_particle", "add_spring"), "cut_springs"


@dataclass(frozen=True, eq=False)
class Standing:
    """A state of a run, with the number of its commands that led there."""

    commands: int
    state: Snapshot


@dataclass(frozen=True, eq=False)
class RunScene:
    """How a run stands. script: the commands that count; standings: some states, of which the last is the present one.

    moments: what happened in which tick, as far as it is known.
    """

    level: Level
    script: tuple[ScriptLine, ...]
    standings: tuple[Standing, ...]
    moments: Moments = field(default_factory=dict)

    @property
    def state(self) -> Snapshot:
        """The present state."""
        return self.standings[-1].state

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.state.tick

    @property
    def deeds(self) -> str:
        """What was done in it, in a few words."""
        return deeds_of(self.script)

    def follows(self, earlier: "RunScene") -> bool:
        """Whether it is the same run as another scene, or that run gone on."""
        return self.level == earlier.level and earlier.is_done_by(self.script[: len(earlier.script)])

    def is_done_by(self, script: Sequence[ScriptLine]) -> bool:
        """Whether just these commands were done in it."""
        return len(script) == len(self.script) and _plain(script) == _plain(self.script)

    def session(self) -> Session:
        """A run that stands so. What was held or driven is let go of, by commands that still wait.

        Raises CommandError where a command names what is not there.
        """
        session, done = Session(self.level), 0
        for standing in self.standings:
            session.come_to(standing.state, self.script[done : standing.commands])
            done = standing.commands
        session.history.moments = dict(self.moments)
        for entry in session.history.begun(session.tick):
            ending = entry.command.ending(session.world)
            if ending is not None:
                session.submit(ending, entry.gesture)
        return session


@dataclass
class SceneTaker:
    """Takes scenes of a run, again and again while it goes on."""

    session: Session
    # Lines of the commands by their orders, as most of them are in each scene.
    _lines: dict[int, ScriptLine] = field(default_factory=dict)

    def take(self) -> RunScene:
        """How the run stands now, without what was undone."""
        session, history = self.session, self.session.history
        counting = [entry for entry in history.timeline if entry.tick <= session.tick and entry.in_effect]
        script = tuple(self._line(entry) for entry in counting)
        firsts = [history.entries[gesture][0].order for gesture in history.done[-STATES_BEFORE:]]
        kept = {}
        for first in firsts:
            before = [frame for frame in history.keyframes if frame.order <= first and frame.tick <= session.tick]
            if before and before[-1].order + before[-1].tick > 0:
                frame = before[-1]
                kept[frame.tick, frame.order] = Standing(
                    sum(entry.order < frame.order for entry in counting), frame.snapshot
                )
        standings = [kept[key] for key in sorted(kept)]
        moments = until(history.moments, session.tick)
        return RunScene(session.level, script, (*standings, Standing(len(script), session.snapshot())), moments)

    def _line(self, entry: LogEntry) -> ScriptLine:
        if entry.order not in self._lines:
            record = to_record(entry.command, self.session.world)
            self._lines[entry.order] = ScriptLine(entry.tick, entry.gesture, record, entry.order)
        return self._lines[entry.order]


def deeds_of(script: Sequence[ScriptLine]) -> str:
    """What the commands of a script did, in a few words: "3 things added, 1 cut"."""
    gestures: dict[int, set[str]] = {}
    for line in script:
        gestures.setdefault(line.gesture, set()).add(str(line.record.get("type")))
    added = sum(not kinds.isdisjoint(_ADDED) for kinds in gestures.values())
    cuts = sum(_CUT in kinds for kinds in gestures.values())
    others = len(gestures) - added - cuts
    counted = ((added, "thing added", "things added"), (cuts, "cut", "cuts"), (others, "deed", "deeds"))
    parts = [f"{count:,} {one if count == 1 else more}" for count, one, more in counted if count > 0]
    return ", ".join(parts) or "nothing done"


def _plain(script: Sequence[ScriptLine]) -> list[tuple[int, int, dict[str, object]]]:
    return [(line.tick, line.gesture, line.record) for line in script]
