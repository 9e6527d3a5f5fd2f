"""Scene: how a run stands: its level, what was done in it, and its state; from there it goes on to the very bits."""

import datetime
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.format.foreign import SCENE_FORMAT as FORMAT
from sandbox.level.format.level_error import one_line
from sandbox.physics.snapshot import Snapshot, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.records import ScriptLine, to_record
from sandbox.session.log import EventsByTick, LogEntry, until
from sandbox.session.replay.format import STATE_LIMIT, encode_state, header, seal, unseal
from sandbox.session.replay.format import VERSION as CHAINED
from sandbox.session.replay.reader import (
    EndLine,
    FirstLine,
    ReplayLines,
    RunReading,
    SealedCommand,
    SealedLine,
    StateLine,
    checked,
    level_of,
    opened,
    slots_of,
)
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session

# The last gestures before which a state is kept too, so that undoing them steps little again. Each is a state more in
# the file.
STATES_BEFORE = 2
_ADDED, _CUT = ("add_body", "add_particle", "add_spring"), "cut_springs"
VERSION = 1
SUFFIX = ".scene.jsonl"
# States that a scene may hold.
STANDING_LIMIT = 16
# What these may hold together [bytes]: of the largest world as many as are kept.
STANDING_BYTES = 240 * 2**20


@dataclass(frozen=True, eq=False)
class Standing:
    """A state of a run, with the number of its commands that led there."""

    commands: int
    state: Snapshot


@dataclass(frozen=True, eq=False)
class RunScene:
    """A run as it stands. script: the commands that count; standings: some states, the last is the present one.

    tick_events: what happened in which tick, as far as it is known.
    """

    level: Level
    script: tuple[ScriptLine, ...]
    standings: tuple[Standing, ...]
    tick_events: EventsByTick = field(default_factory=dict)

    @property
    def state(self) -> Snapshot:
        """The present state."""
        return self.standings[-1].state

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.state.tick

    @property
    def actions(self) -> str:
        """The actions of the run, in a few words."""
        return actions_in_words(self.script)

    def follows(self, earlier: "RunScene") -> bool:
        """Whether the scene is of the same run as another, or of that run gone on."""
        return self.level == earlier.level and earlier.is_done_by(self.script[: len(earlier.script)])

    def is_done_by(self, script: Sequence[ScriptLine]) -> bool:
        """Whether the run consists of just these commands."""
        return len(script) == len(self.script) and _plain(script) == _plain(self.script)

    def session(self) -> Session:
        """A run that stands so. What was held or driven is let go of, by commands that still wait.

        Raises CommandError where a command names what is not there.
        """
        session, done = Session(self.level), 0
        for standing in self.standings:
            session.come_to(standing.state, self.script[done : standing.commands])
            done = standing.commands
        session.history.tick_events = dict(self.tick_events)
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
        """The run as it stands, without undone commands."""
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
        tick_events = until(history.tick_events, session.tick)
        return RunScene(session.level, script, (*standings, Standing(len(script), session.snapshot())), tick_events)

    def _line(self, entry: LogEntry) -> ScriptLine:
        if entry.order not in self._lines:
            record = to_record(entry.command, self.session.world)
            self._lines[entry.order] = ScriptLine(entry.tick, entry.gesture, record, entry.order)
        return self._lines[entry.order]


def actions_in_words(script: Sequence[ScriptLine]) -> str:
    """The commands of a script in a few words: "3 things added, 1 cut"."""
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


class _SceneFirstLine(FirstLine):
    when: str
    source: str | None
    deeds: str


@dataclass(frozen=True)
class About:
    """The facts in a scene's first line: the level's name, when it was kept, the actions, the file of the level."""

    path: Path
    name: str
    when: datetime.datetime
    actions: str
    source: Path | None


def scene_lines(scene: RunScene, source: Path | None) -> Iterator[bytes]:
    """The lines of a scene's file; source: the file of its level, if it has one."""
    first = header(scene.level) | {"format": FORMAT, "version": VERSION}
    when = datetime.datetime.now(datetime.UTC).isoformat()
    first |= {"when": when, "source": None if source is None else os.path.abspath(source), "deeds": scene.actions}
    line, chain = seal(first, "")
    yield line
    done, before = 0, None
    for standing in scene.standings:
        for each in scene.script[done : standing.commands]:
            line, chain = seal({"tick": each.tick, "gesture": each.gesture, "command": each.record}, chain)
            yield line
        state, done = standing.state, standing.commands
        line, chain = seal({"tick": state.tick, **encode_state(state, _changed(state, before))}, chain)
        yield line
        before = state
    line, _ = seal({"end": True, "tick": scene.tick, "hash": state_hash(scene.state)}, chain)
    yield line


def _changed(state: Snapshot, before: Snapshot | None) -> list[str]:
    """Names of the arrays that differ from an earlier state."""
    if before is None:
        return list(BY_STORED)
    pairs = {stored: (state.arrays[column.name], before.arrays[column.name]) for stored, column in BY_STORED.items()}
    return [stored for stored, (now, then) in pairs.items() if now is not then and now.tobytes() != then.tobytes()]


def begins_as_scene(path: str | os.PathLike[str]) -> bool:
    """Whether a file's first bytes are a scene's. Raises OSError."""
    with open(path, "rb") as file:
        return FORMAT.encode() in file.read(64)


def read_about(path: Path) -> About:
    """The run of a scene's file as its first line describes it. Raises ReplayError."""
    head, _ = _read_header(str(path), next(iter(ReplayLines(path)), b""))
    return _about(path, head, one_line(str(head.level.get("name", ""))), one_line(head.deeds))


def _about(path: Path, head: _SceneFirstLine, name: str, actions: str) -> About:
    when = datetime.datetime.fromisoformat(head.when).astimezone(datetime.UTC)
    return About(path, name, when, actions, None if head.source is None else Path(head.source))


def read_scene(path: Path) -> tuple[RunScene, About]:
    """Read a scene's file. Raises ReplayError, naming file and line, for anything that `scene_lines` did not make."""
    source, lines = str(path), ReplayLines(path)
    each = iter(lines)
    head, digest = _read_header(source, next(each, b""))
    if head.physics_version != PHYSICS_VERSION:
        raise ReplayError(
            f"{source}: line 1: kept with physics version {head.physics_version}; this program has {PHYSICS_VERSION}, "
            "whose states differ: open it with the version that kept it"
        )
    level = level_of(source, head)
    reading = _SceneReading(slots_of(level), level=level)
    for _ in reading.read(source, lines, each, digest, CHAINED):
        pass
    if not reading.has_ended:
        raise ReplayError(f"{source}: is cut off")
    scene = RunScene(level, tuple(reading.script), tuple(reading.standings))
    return scene, _about(path, head, level.name, scene.actions)


@dataclass(kw_only=True)
class _SceneReading(RunReading):
    """Reads a scene of a level, line by line."""

    level: Level
    standings: list[Standing] = field(default_factory=list)
    _tick: int = 0
    _room: int = STANDING_BYTES

    def add(self, line: SealedLine, number: int, where: str) -> None:
        """Read one line. Raises ReplayError where it does not fit there."""
        if not isinstance(line, (SealedCommand, StateLine, EndLine)):
            raise ReplayError(f"{where}: a scene has no line of this kind")
        if line.tick < self._tick:
            raise ReplayError(f"{where}: is of tick {line.tick}, after one of tick {self._tick}")
        self._tick = line.tick
        super().add(line, number, where)
        if isinstance(line, StateLine):
            if len(self.standings) == STANDING_LIMIT:
                raise ReplayError(f"{where}: a scene has at most {STANDING_LIMIT} states")
            try:
                state = self.stored(line, number).of(self.level, line.tick, min(STATE_LIMIT, self._room))
            except ValueError as error:
                raise ReplayError(f"{where}: {error}") from None
            self._room -= sum(array.nbytes for array in state.arrays.values())
            self.standings.append(Standing(len(self.script), state))
        elif isinstance(line, EndLine):
            if not self.standings or self.standings[-1].commands < len(self.script):
                raise ReplayError(f"{where}: the last state is missing")
            last = self.standings[-1].state
            if line.tick != last.tick or line.hash != state_hash(last):
                raise ReplayError(f"{where}: hash: is not that of the last state")


def _read_header(source: str, line: bytes) -> tuple[_SceneFirstLine, str]:
    where = f"{source}: line 1"
    opened(where, line, "scene", FORMAT, (VERSION,))
    digest = unseal(line, "")
    if digest is None:
        raise ReplayError(f"{where}: changed or damaged: its chain does not fit")
    head: _SceneFirstLine = checked(where, _SceneFirstLine, line)
    try:
        datetime.datetime.fromisoformat(head.when)
    except ValueError:
        raise ReplayError(f"{where}: when: is no time") from None
    return head, digest
