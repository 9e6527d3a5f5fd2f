"""The file of a scene: JSON Lines sealed as those of a recording, with a few states in place of a hash for each tick.

    {"format": "spring-sandbox/scene", "version": 1, "physics_version": ..., "level": {...}, ..., "chain": "..."}
    {"tick": 12, "gesture": 3, "command": {...}, "chain": "..."}       as in a recording
    {"tick": 600, "state": {...}, "settings": {...}, "chain": "..."}   after the commands above it
    {"end": true, "tick": 900, "hash": "...", "chain": "..."}          the hash of the last state

The first line also says when it was kept, the file of its level, and what was done, for lists of scenes.
"""

import datetime
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import one_line
from sandbox.level.format.limits import PARTICLE_LIMIT, SPRING_LIMIT
from sandbox.level.format.scan import scan
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Snapshot, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import decode_state, encode_state, header, seal, unseal
from sandbox.session.replay.line_reader import ReplayLines
from sandbox.session.replay.reader import (
    EndLine,
    FirstLine,
    SealedCommand,
    StateLine,
    level_of,
    parse_line,
    slots_of,
    state_limit_of,
)
from sandbox.session.replay.record import checked, json_object
from sandbox.session.replay.recording import ReplayError
from sandbox.session.scene import RunScene, Standing, deeds_of
from sandbox.version import __version__

FORMAT = "spring-sandbox/scene"
VERSION = 1
SUFFIX = ".scene.jsonl"
# States that a scene may hold.
STANDING_LIMIT = 16


class _SceneFirstLine(FirstLine):
    when: str
    source: str | None
    deeds: str


@dataclass(frozen=True)
class About:
    """What a scene's first line says: the level's name, when it was kept, what was done, the file of the level."""

    path: Path
    name: str
    when: datetime.datetime
    deeds: str
    source: Path | None


def scene_lines(scene: RunScene, source: Path | None) -> Iterator[bytes]:
    """The lines of a scene's file; source: the file of its level, if it has one."""
    first = header(scene.level, PHYSICS_VERSION, __version__) | {"format": FORMAT, "version": VERSION}
    when = datetime.datetime.now(datetime.UTC).isoformat()
    first |= {"when": when, "source": None if source is None else os.path.abspath(source), "deeds": scene.deeds}
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
    """Names of the arrays that are others than in an earlier state."""
    if before is None:
        return list(BY_STORED)
    pairs = {stored: (state.arrays[column.name], before.arrays[column.name]) for stored, column in BY_STORED.items()}
    return [stored for stored, (now, then) in pairs.items() if now is not then and now.tobytes() != then.tobytes()]


def begins_as_scene(path: str | os.PathLike[str]) -> bool:
    """Whether a file's first bytes are a scene's. Raises OSError."""
    with open(path, "rb") as file:
        return FORMAT.encode() in file.read(64)


def read_about(path: Path) -> About:
    """What a scene's first line says of it. Raises ReplayError."""
    head, _ = _read_header(str(path), next(iter(ReplayLines(path)), b""))
    when = datetime.datetime.fromisoformat(head.when).astimezone(datetime.UTC)
    name = one_line(str(head.level.get("name", "")))
    return About(path, name, when, one_line(head.deeds), None if head.source is None else Path(head.source))


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
    reading = _Reading(level, slots_of(level))
    lines.state_limit = state_limit_of(reading.slots)
    for number, line in enumerate(each, 2):
        where = f"{source}: line {number}"
        sealed = unseal(line, digest) if line.endswith(b"\n") else None
        if sealed is None:
            raise ReplayError(f"{where}: changed, damaged or cut off: its chain does not fit")
        digest = sealed
        reading.add(parse_line(where, line), number, where)
        lines.state_limit = state_limit_of(reading.slots)
    if not reading.has_ended:
        raise ReplayError(f"{source}: is cut off")
    about = About(
        path, level.name, datetime.datetime.fromisoformat(head.when).astimezone(datetime.UTC),
        deeds_of(reading.script), None if head.source is None else Path(head.source),
    )  # fmt: skip
    return RunScene(level, tuple(reading.script), tuple(reading.standings)), about


class _Reading:
    """What was read of a scene of a level, whose world has so many slots."""

    def __init__(self, level: Level, slots: int) -> None:
        self.level, self.slots = level, slots
        self.script: list[ScriptLine] = []
        self.standings: list[Standing] = []
        self.has_ended = False
        self._arrays: dict[str, str] = {}
        self._tick = 0

    def add(self, line: Any, number: int, where: str) -> None:
        """Take in one line. Raises ReplayError where it does not fit there."""
        if self.has_ended:
            raise ReplayError(f"{where}: follows the end line; cut it off")
        if not isinstance(line, (SealedCommand, StateLine, EndLine)):
            raise ReplayError(f"{where}: a scene has no line of this kind")
        if line.tick < self._tick:
            raise ReplayError(f"{where}: is of tick {line.tick}, after one of tick {self._tick}")
        self._tick = line.tick
        if isinstance(line, SealedCommand):
            self.script.append(ScriptLine(line.tick, line.gesture, line.command, number))
            self.slots += PARTICLE_LIMIT + SPRING_LIMIT if line.command.get("type") == "add_body" else 1
        elif isinstance(line, StateLine):
            self._add_state(line, where)
        else:
            self._end(line, where)

    def _add_state(self, line: StateLine, where: str) -> None:
        if len(self.standings) == STANDING_LIMIT:
            raise ReplayError(f"{where}: a scene has at most {STANDING_LIMIT} states")
        self._arrays = {**self._arrays, **line.state}
        joined = tuple(each.model_dump() for each in line.joined)
        try:
            state = decode_state(self.level, line.tick, self._arrays, WorldSettings(**dict(line.settings)), joined)
        except ValueError as error:
            raise ReplayError(f"{where}: {error}") from None
        driven = len(state.equipment.actuators.names)
        if len(state.actuator_value) != driven:
            raise ReplayError(f"{where}: state.part_value: there are {driven} driven parts")
        self.standings.append(Standing(len(self.script), state))

    def _end(self, line: EndLine, where: str) -> None:
        if not self.standings or self.standings[-1].commands < len(self.script):
            raise ReplayError(f"{where}: the last state is missing")
        if line.tick != self.standings[-1].state.tick or line.hash != state_hash(self.standings[-1].state):
            raise ReplayError(f"{where}: hash: is not that of the last state")
        self.has_ended = True


def _read_header(source: str, line: bytes) -> tuple[_SceneFirstLine, str]:
    where = f"{source}: line 1"
    if fault := scan(line):
        raise ReplayError(f"{where}: {fault[1]}")
    values = json_object(f"{where}: not a scene", line)
    if values.get("format") != FORMAT:
        raise ReplayError(f"{where}: not a scene: its format is not {FORMAT!r}")
    if values.get("version") != VERSION:
        raise ReplayError(f"{where}: scene version {values.get('version')!r:.40}; this program reads {VERSION}")
    digest = unseal(line, "")
    if digest is None:
        raise ReplayError(f"{where}: changed or damaged: its chain does not fit")
    head: _SceneFirstLine = checked(where, _SceneFirstLine, line)
    try:
        datetime.datetime.fromisoformat(head.when)
    except ValueError:
        raise ReplayError(f"{where}: when: is no time") from None
    return head, digest
